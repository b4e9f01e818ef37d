//! The key that seals results: made once for each data folder.

use std::path::Path;

use gsk_exercise::seal::SealKey;
use gsk_host::files::atomic::{self, FileAccess};
use gsk_host::files::program_file;
use gsk_host::output::WriteError;
use gsk_host::platform;
use gsk_messages::say;

use super::super::{CommandError, output};

/// The secret key, as minisign reads it.
const SECRET_FILE: &str = "exercise.key";
/// The public key, as minisign reads it.
const PUBLIC_FILE: &str = "exercise.pub";

/// Reads the key of a data folder; makes it if there is none.
///
/// # Errors
/// The file is damaged or cannot be written, or the system gives no random numbers.
pub fn load_or_make(data: &Path) -> Result<SealKey, CommandError> {
    let path = data.join(SECRET_FILE);
    if platform::is_taken(&path) {
        let text = program_file::read(&path)?.text;
        let damaged = || say::exercise_key_damaged(path.display());
        return Ok(SealKey::from_text(&text).ok_or_else(damaged)?);
    }
    let (mut seed, mut number) = ([0; 32], [0; 8]);
    getrandom::fill(&mut seed)
        .and_then(|()| getrandom::fill(&mut number))
        .map_err(say::exercise_no_random)?;
    let key = SealKey::from_random(&seed, number);
    std::fs::create_dir_all(data).map_err(|error| WriteError::new(data, error))?;
    atomic::write_with_access(&path, key.to_text().as_bytes(), FileAccess::Owner)
        .map_err(|error| WriteError::new(&path, error))?;
    let public = data.join(PUBLIC_FILE);
    atomic::write(&public, key.public_key().to_text().as_bytes())
        .map_err(|error| WriteError::new(&public, error))?;
    let made = say::exercise_key_made(key.number(), data.display());
    complain!("{}", output::localize(&made));
    Ok(key)
}
