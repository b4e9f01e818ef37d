//! Stores the results that seats hand in.

use std::path::{Path, PathBuf};

use gsk_exercise::result_file::{RESULT_EXTENSION, read_result};
use gsk_messages::Message;

use crate::files::atomic;
use crate::output::WriteError;
use crate::platform;

/// Greatest number of results with one name; the last one is overwritten.
const MAX_COPIES: u32 = 1000;

/// Stores a result as a file of a folder, beside earlier ones of the same learner. Returns its path.
///
/// # Errors
/// The bytes are not a result, or the file cannot be written.
pub(super) fn store_result(folder: &Path, learner: &str, bytes: &[u8]) -> Result<PathBuf, Message> {
    let result = read_result(bytes)?;
    let is_plain = |character: &char| character.is_alphanumeric() || "-_".contains(*character);
    let words = [result.head.report.task.as_str(), learner];
    let words = words.map(|word| word.chars().filter(is_plain).take(60).collect::<String>());
    let name = words.join("-");
    let path_of = |copy| match copy {
        1 => folder.join(format!("{name}.{RESULT_EXTENSION}")),
        _ => folder.join(format!("{name}-{copy}.{RESULT_EXTENSION}")),
    };
    let mut copies = 1..MAX_COPIES;
    let free = copies.find(|copy| !platform::is_taken(&path_of(*copy)));
    let path = path_of(free.unwrap_or(MAX_COPIES));
    std::fs::create_dir_all(folder)
        .and_then(|()| atomic::write(&path, bytes))
        .map_err(|error| WriteError::new(&path, error).message())?;
    Ok(path)
}
