//! `link flash`: copies firmware to a Raspberry Pi Pico in boot mode, which is a drive.

use std::path::{Path, PathBuf};

use gsk_host::message_format::{describe_io_error, join_on_one_line};
use gsk_host::platform;
use gsk_link::uf2::{self, INFO_FILE, PICO_BOARD_ID};
use gsk_messages::{Message, say};

use super::super::{CommandError, EXIT_OK, output};
use crate::cli::LinkFlashArgs;

/// Greatest length of a firmware file that is read, bytes: 16 MB of flash in blocks.
const MOST_FIRMWARE: u64 = 64 << 20;
/// Greatest length of the description of a drive that is read, bytes.
const MOST_INFO: u64 = 4096;

/// Copies the firmware and reports what was copied. Returns the exit code, or an error if nothing
/// was copied.
pub fn flash_board(args: &LinkFlashArgs) -> Result<u8, CommandError> {
    let copied = copy_firmware(&args.file, args.to.as_deref())?;
    output::print_message(&copied);
    Ok(EXIT_OK)
}

/// Copies a firmware file to the drive `to`, or to the only Pico in boot mode. Returns the message
/// that tells what was copied.
///
/// # Errors
/// The file is not a firmware for the Pico, there is no drive of a Pico in boot mode or several, or
/// an error of the system. Nothing is copied then.
fn copy_firmware(file: &Path, to: Option<&Path>) -> Result<Message, Message> {
    let wrong = |fault: Message| say::flash_file_wrong(file.display(), fault);
    let bytes =
        platform::read(file, MOST_FIRMWARE).map_err(|error| wrong(describe_io_error(&error)))?;
    let blocks = uf2::check_firmware(&bytes).map_err(|error| wrong(error.message()))?;
    let folder = match to {
        Some(folder) => check_drive(folder)?,
        None => find_drive()?,
    };
    let name = file.file_name().unwrap_or_default();
    let info = folder.join(INFO_FILE);
    platform::write_to_drive(&folder.join(name), &bytes, &info)
        .map_err(|error| say::flash_failed(folder.display(), describe_io_error(&error)))?;
    Ok(say::flash_copied(blocks, folder.display()))
}

/// Returns the board id of the drive of a board in boot mode; `None` for another folder.
fn board_of_drive(folder: &Path) -> Option<String> {
    let info = platform::read(&folder.join(INFO_FILE), MOST_INFO).ok()?;
    let info = String::from_utf8_lossy(&info).into_owned();
    uf2::board_id(&info).map(str::to_owned)
}

fn check_drive(folder: &Path) -> Result<PathBuf, Message> {
    match board_of_drive(folder) {
        None => Err(say::flash_not_a_volume(folder.display())),
        Some(board) if board != PICO_BOARD_ID => {
            Err(say::flash_wrong_board(folder.display(), board))
        }
        Some(_) => Ok(folder.to_owned()),
    }
}

fn find_drive() -> Result<PathBuf, Message> {
    let is_pico =
        |folder: &PathBuf| board_of_drive(folder).is_some_and(|board| board == PICO_BOARD_ID);
    let mut found: Vec<PathBuf> = platform::mounted_volumes();
    found.retain(is_pico);
    found.dedup();
    match found.as_slice() {
        [] => Err(say::flash_no_volume()),
        [folder] => Ok(folder.clone()),
        several => {
            let names = several
                .iter()
                .map(|folder| say::as_written(folder.display()));
            Err(say::flash_several_volumes(join_on_one_line(names)))
        }
    }
}
