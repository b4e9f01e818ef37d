//! The browsers of this computer: opens a page in the one of the user, prints a page as PDF.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use gsk_messages::{Message, say};

use crate::message_format::describe_io_error;
use crate::output::WriteError;
use crate::platform::{browser_candidates, open_file_command};

/// Writes a page into the folder for temporary files and opens it in the browser of the user.
/// Returns its path.
///
/// # Errors
/// The file cannot be written, or the system opens no program.
pub fn open_page_file(name: &str, page: &[u8]) -> Result<PathBuf, Message> {
    // A folder of its own: no other user has put a link there.
    let folder = std::env::temp_dir().join(format!("gsk980td-{}", std::process::id()));
    let path = folder.join(name);
    std::fs::create_dir_all(&folder)
        .and_then(|()| std::fs::write(&path, page))
        .map_err(|error| WriteError::new(&path, error).message())?;
    let mut command = open_file_command(&path);
    let started = quiet(&mut command).spawn();
    started.map_err(|error| say::sheet_not_opened(path.display(), describe_io_error(&error)))?;
    Ok(path)
}

/// Prints a page as PDF by the first browser that is found. Returns its name; `None` without one.
pub fn print_with_browser(page: &Path, pdf: &Path, profile: &Path) -> Option<String> {
    let file = |option: &str, path: &Path| format!("{option}={}", path.display());
    let options = [
        "--headless".to_owned(),
        "--disable-gpu".to_owned(),
        // A container and the root user have no sandbox; the page is our own and has no script.
        "--no-sandbox".to_owned(),
        "--no-first-run".to_owned(),
        "--no-pdf-header-footer".to_owned(),
        file("--user-data-dir", profile),
        file("--print-to-pdf", pdf),
        page.display().to_string(),
    ];
    browser_candidates().into_iter().find_map(|browser| {
        let mut command = Command::new(&browser);
        let status = quiet(command.args(&options)).status();
        status.is_ok().then(|| browser.display().to_string())
    })
}

fn quiet(command: &mut Command) -> &mut Command {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
}
