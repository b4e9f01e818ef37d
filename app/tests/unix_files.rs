//! Links, access rights and pipes of Unix systems.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::PathBuf;
use std::process::Command;

use gsk_host::files::atomic::{self, FileAccess};
use gsk_host::files::mirrored_files::{FileChange, MirroredFiles};

fn create_folder(name: &str) -> PathBuf {
    let name = format!("gsk980td-{}-{name}", std::process::id());
    let folder = std::env::temp_dir().join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn writes_do_not_follow_links_and_secrets_are_private() {
    let folder = create_folder("atomic-link");
    let (path, other) = (folder.join("a.ron"), folder.join("other"));
    fs::write(&other, "precious").unwrap();
    symlink(&other, folder.join(".a.ron.gsk980td-new")).unwrap();
    atomic::write_with_access(&path, b"secret", FileAccess::Owner).unwrap();
    assert_eq!(fs::read(&other).unwrap(), b"precious");
    let mode = fs::metadata(&path).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn reading_a_pipe_does_not_block() {
    let folder = create_folder("kept-pipe");
    let change = FileChange {
        name: "a".to_owned(),
        contents: Some(b"1".to_vec()),
        readers: FileAccess::Any,
    };
    assert_eq!(MirroredFiles::open(&folder, false).commit(vec![change]), []);
    fs::remove_file(folder.join("a")).unwrap();
    let status = Command::new("mkfifo").arg(folder.join("a")).status();
    assert!(status.unwrap().success());
    let found = MirroredFiles::open(&folder, false).read("a", 1000);
    let message = found.damage.unwrap().message.to_string();
    assert!(message.contains("not a regular file"), "{message}");
    assert_eq!(found.contents.as_deref(), Some(b"1".as_slice()));
    fs::remove_dir_all(folder).unwrap();
}
