//! The key that seals results: made once for each data folder.

use std::path::Path;

use gsk_exercise::seal::SealKey;
use gsk_messages::{Message, say};

use super::atomic::{self, FileAccess};
use super::program_file;
use crate::output::WriteError;
use crate::platform;

/// Name of the file with the secret key, in the format of minisign.
const SECRET_FILE: &str = "exercise.key";
/// Name of the file with the public key, in the format of minisign.
const PUBLIC_FILE: &str = "exercise.pub";

/// Reads the key of a data folder, or makes it if there is none. Returns it with a message about
/// a new key.
///
/// # Errors
/// The file is damaged or cannot be written, or the system gives no random numbers.
pub fn load_or_make(data: &Path) -> Result<(SealKey, Option<Message>), Message> {
    let path = data.join(SECRET_FILE);
    if platform::is_taken(&path) {
        let text = program_file::read(&path)
            .map_err(|error| error.message())?
            .text;
        let damaged = || say::exercise_key_damaged(path.display());
        let key = SealKey::from_text(&text).ok_or_else(damaged)?;
        return Ok((key, None));
    }
    let key = make()?;
    let not_written = |path: &Path| {
        let path = path.to_owned();
        move |error| WriteError::new(&path, error).message()
    };
    platform::make_folder(data).map_err(not_written(data))?;
    atomic::write_with_access(&path, key.to_text().as_bytes(), FileAccess::Owner)
        .map_err(not_written(&path))?;
    let public = data.join(PUBLIC_FILE);
    atomic::write(&public, key.public_key().to_text().as_bytes()).map_err(not_written(&public))?;
    let made = say::exercise_key_made(key.number(), data.display());
    Ok((key, Some(made)))
}

/// Makes a key.
///
/// # Errors
/// The system gives no random numbers.
pub fn make() -> Result<SealKey, Message> {
    let (mut seed, mut number) = ([0; 32], [0; 8]);
    getrandom::fill(&mut seed)
        .and_then(|()| getrandom::fill(&mut number))
        .map_err(say::exercise_no_random)?;
    Ok(SealKey::from_random(&seed, number))
}
