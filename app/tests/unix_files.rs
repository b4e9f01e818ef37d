//! Links, access rights and pipes of Unix systems.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::PathBuf;
use std::process::Command;

use gsk_app::files::atomic::{self, Readers};
use gsk_app::files::kept::{Change, Kept};

fn folder(name: &str) -> PathBuf {
    let name = format!("gsk980td-{}-{name}", std::process::id());
    let folder = std::env::temp_dir().join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn nothing_is_written_through_a_link_and_secrets_are_the_owners() {
    let folder = folder("atomic-link");
    let (path, other) = (folder.join("a.ron"), folder.join("other"));
    fs::write(&other, "precious").unwrap();
    symlink(&other, folder.join(".a.ron.gsk980td-new")).unwrap();
    atomic::write_for(&path, b"secret", Readers::Owner).unwrap();
    assert_eq!(fs::read(&other).unwrap(), b"precious");
    let mode = fs::metadata(&path).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_pipe_is_not_waited_for() {
    let folder = folder("kept-pipe");
    let change = Change {
        name: "a".to_owned(),
        content: Some(b"1".to_vec()),
        readers: Readers::Any,
    };
    assert_eq!(Kept::open(&folder, false).commit(vec![change]), []);
    fs::remove_file(folder.join("a")).unwrap();
    let made = Command::new("mkfifo").arg(folder.join("a")).status();
    assert!(made.unwrap().success());
    let found = Kept::open(&folder, false).read("a", 1000);
    let said = found.damage.unwrap().said.to_string();
    assert!(said.contains("no plain file"), "{said}");
    assert_eq!(found.content.as_deref(), Some(b"1".as_slice()));
    fs::remove_dir_all(folder).unwrap();
}
