//! The browsers of this computer: opens a page in the one of the user, prints a page as PDF.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::platform::{PdfPrint, browser_candidates, open_file_command};

/// Writes a page into the folder for temporary files and opens it in the browser of the user.
/// Returns its path.
///
/// # Errors
/// The file cannot be written, or the system opens no program.
pub fn open_page_file(name: &str, page: &[u8]) -> io::Result<PathBuf> {
    // A separate folder: no other user has put a link there.
    let folder = std::env::temp_dir().join(format!("gsk980td-{}", std::process::id()));
    let path = folder.join(name);
    fs::create_dir_all(&folder)?;
    fs::write(&path, page)?;
    quiet(&mut open_file_command(&path)).spawn()?;
    Ok(path)
}

/// Prints a page, which loads nothing, as a PDF file by the first browser that is found.
///
/// # Errors
/// A file cannot be written.
pub fn print_page_as_pdf(page: &[u8], target: &Path) -> io::Result<PdfPrint> {
    let target = std::path::absolute(target)?;
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    // Page, profile and result of the browser, beside the target.
    let work = target.with_file_name(format!(".{name}.{}", std::process::id()));
    fs::create_dir_all(&work)?;
    let printed = print_in_folder(&work, page, &target);
    fs::remove_dir_all(&work)?;
    printed
}

fn print_in_folder(work: &Path, page: &[u8], target: &Path) -> io::Result<PdfPrint> {
    let (source, written) = (work.join("page.html"), work.join("page.pdf"));
    fs::write(&source, page)?;
    let file = |option: &str, path: &Path| format!("{option}={}", path.display());
    let options = [
        "--headless".to_owned(),
        "--disable-gpu".to_owned(),
        // A container and the root user have no sandbox; the page is ours and has no script.
        "--no-sandbox".to_owned(),
        "--no-first-run".to_owned(),
        "--no-pdf-header-footer".to_owned(),
        file("--user-data-dir", &work.join("profile")),
        file("--print-to-pdf", &written),
        source.display().to_string(),
    ];
    let browser = browser_candidates().into_iter().find(|browser| {
        let mut command = Command::new(browser);
        quiet(command.args(&options)).status().is_ok()
    });
    let Some(browser) = browser else {
        return Ok(PdfPrint::NoBrowser);
    };
    if !written.is_file() {
        return Ok(PdfPrint::Failed(browser.display().to_string()));
    }
    fs::rename(&written, target)?;
    Ok(PdfPrint::Written)
}

fn quiet(command: &mut Command) -> &mut Command {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
}
