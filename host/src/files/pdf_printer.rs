//! Prints a page as a PDF file, by a browser that is installed on this computer.

use std::path::{Path, PathBuf};

use gsk_messages::{Message, say};

use crate::output::WriteError;
use crate::platform;

/// Prints a page, which loads nothing, as a PDF file.
///
/// # Errors
/// No browser that prints without a window is installed, or it does not write the file.
pub fn print_page(page: &str, target: &Path) -> Result<(), Message> {
    let failed = |error| WriteError::new(target, error).message();
    let target = std::path::absolute(target).map_err(failed)?;
    let work = work_folder(&target);
    std::fs::create_dir_all(&work).map_err(failed)?;
    let printed = print_in(&work, page, &target);
    // Without it the next start overwrites what remains.
    let _ = std::fs::remove_dir_all(&work);
    printed
}

/// The folder for page and profile of the browser, beside the target.
fn work_folder(target: &Path) -> PathBuf {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    target.with_file_name(format!(".{name}.tmp"))
}

fn print_in(work: &Path, page: &str, target: &Path) -> Result<(), Message> {
    let source = work.join("sheet.html");
    let failed = |error| WriteError::new(&source, error).message();
    std::fs::write(&source, page).map_err(failed)?;
    let written = work.join("sheet.pdf");
    let browser = platform::print_with_browser(&source, &written, &work.join("profile"));
    let browser = browser.ok_or_else(say::sheet_no_browser)?;
    std::fs::rename(&written, target).map_err(|_| say::sheet_no_pdf(browser, target.display()))
}
