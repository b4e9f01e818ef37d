//! Sends a file whose name the control already has: overwrites, renames the old file, or
//! skips (manual V-3.3).

use std::io::{self, BufRead, IsTerminal, Write};

use gsk_host::output;
use gsk_host::pc::{self, FilesError, PcError, TransferSession};
use gsk_messages::{Message, say};
use gsk_transfer::{FileName, PcCommand, TransferFault, TransferFile};

use super::CommandError;
use crate::cli::ExistingFile;

/// Whether a file was sent or skipped.
pub(super) enum SendOutcome {
    Sent,
    Skipped,
}

/// What to do with a file whose name is taken at the control.
enum ConflictChoice {
    Overwrite,
    Rename(FileName),
    Skip,
}

/// Sends a file. If its name is taken at the control, applies `on_existing`. Returns an error if
/// the transfer fails.
pub(super) fn send(
    talk: &mut TransferSession,
    file: TransferFile,
    on_existing: ExistingFile,
) -> Result<SendOutcome, CommandError> {
    match talk.send(file.clone()) {
        Err(PcError::Files(FilesError::Refused {
            fault: TransferFault::Exists,
            ..
        })) => {}
        result => return Ok(result.map(|()| SendOutcome::Sent)?),
    }
    match resolve_conflict(talk, &file, on_existing)? {
        ConflictChoice::Overwrite => {
            let file = TransferFile {
                overwrite: true,
                ..file
            };
            talk.send(file)?;
        }
        ConflictChoice::Rename(to) => {
            let from = file.remote_path.clone();
            talk.change(
                &file.remote_path.name,
                PcCommand::Rename {
                    from,
                    to: to.clone(),
                },
            )?;
            output::print_message(&say::transfer_renamed(&file.remote_path.name, to));
            talk.send(file)?;
        }
        ConflictChoice::Skip => return Ok(SendOutcome::Skipped),
    }
    Ok(SendOutcome::Sent)
}

fn resolve_conflict(
    talk: &mut TransferSession,
    file: &TransferFile,
    on_existing: ExistingFile,
) -> Result<ConflictChoice, CommandError> {
    let name = &file.remote_path.name;
    Ok(match on_existing {
        ExistingFile::Overwrite => ConflictChoice::Overwrite,
        ExistingFile::Skip => ConflictChoice::Skip,
        ExistingFile::Rename => ConflictChoice::Rename(free_name(talk, file)?),
        ExistingFile::Ask if !io::stdin().is_terminal() => {
            return Err(FilesError::NoTerminal(name.clone()).into());
        }
        ExistingFile::Ask => prompt_choice(name)?,
    })
}

/// Finds the next free program number for the program that has the name of `file`. Returns an error
/// if the directory cannot be read or no number is free.
fn free_name(talk: &mut TransferSession, file: &TransferFile) -> Result<FileName, CommandError> {
    let name = &file.remote_path.name;
    let entries = talk.list(file.remote_path.partition)?;
    pc::free_name(name, &entries).ok_or_else(|| FilesError::NoFreeName(name.clone()).into())
}

/// Prompts the operator for the action at a taken name, until the answer is valid. Returns an error
/// if the input ends.
fn prompt_choice(name: &FileName) -> Result<ConflictChoice, CommandError> {
    loop {
        let answer = prompt_line(&say::transfer_exists_ask(name))?;
        match answer.to_ascii_lowercase().as_str() {
            "o" => return Ok(ConflictChoice::Overwrite),
            "s" => return Ok(ConflictChoice::Skip),
            "r" => {}
            _ => continue,
        }
        loop {
            let new = prompt_line(&say::transfer_rename_ask(name))?;
            if new.is_empty() {
                return Ok(ConflictChoice::Skip);
            }
            match FileName::new(&new) {
                Ok(new) => return Ok(ConflictChoice::Rename(new)),
                Err(error) => output::report_error(&error.message()),
            }
        }
    }
}

fn prompt_line(question: &Message) -> Result<String, CommandError> {
    let mut out = io::stderr().lock();
    // A terminal that cannot show the question cannot be read either.
    let _ = write!(out, "{}", output::localize(question)).and_then(|()| out.flush());
    let mut line = String::new();
    let read = io::stdin().lock().read_line(&mut line);
    match read.map_err(CommandError::gone)? {
        0 => Err(CommandError::gone(io::ErrorKind::UnexpectedEof.into())),
        _ => Ok(line.trim().to_owned()),
    }
}
