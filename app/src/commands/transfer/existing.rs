//! Sends a file whose name the control already has: overwrites, renames the old file, or
//! skips (manual V-3.3).

use std::io::{self, BufRead, IsTerminal, Write};

use gsk_messages::{Message, say};
use gsk_transfer::{FileName, PcCommand, TransferFault, TransferFile};

use super::CommandError;
use crate::cli::ExistingFile;
use crate::output;
use crate::pc::{self, FilesError, PcError, Talk};

/// The outcome of sending a file.
pub(super) enum Settled {
    Sent,
    Skipped,
}

/// How the conflict of names is resolved.
enum Choice {
    Overwrite,
    Rename(FileName),
    Skip,
}

/// Sends a file and resolves a conflict of names.
pub(super) fn send(
    talk: &mut Talk,
    file: TransferFile,
    on_existing: ExistingFile,
) -> Result<Settled, CommandError> {
    match talk.send(file.clone()) {
        Err(PcError::Files(FilesError::Refused {
            fault: TransferFault::Exists,
            ..
        })) => {}
        result => return Ok(result.map(|()| Settled::Sent)?),
    }
    match choice(talk, &file, on_existing)? {
        Choice::Overwrite => {
            let file = TransferFile {
                overwrite: true,
                ..file
            };
            talk.send(file)?;
        }
        Choice::Rename(to) => {
            let from = file.remote_path.clone();
            talk.change(
                &file.remote_path.name,
                PcCommand::Rename {
                    from,
                    to: to.clone(),
                },
            )?;
            output::say(&say::transfer_renamed(&file.remote_path.name, to));
            talk.send(file)?;
        }
        Choice::Skip => return Ok(Settled::Skipped),
    }
    Ok(Settled::Sent)
}

fn choice(
    talk: &mut Talk,
    file: &TransferFile,
    on_existing: ExistingFile,
) -> Result<Choice, CommandError> {
    let name = &file.remote_path.name;
    Ok(match on_existing {
        ExistingFile::Overwrite => Choice::Overwrite,
        ExistingFile::Skip => Choice::Skip,
        ExistingFile::Rename => Choice::Rename(free_name(talk, file)?),
        ExistingFile::Ask if !io::stdin().is_terminal() => {
            return Err(FilesError::NobodyToAsk(name.clone()).into());
        }
        ExistingFile::Ask => asked(name)?,
    })
}

/// The next free program number.
fn free_name(talk: &mut Talk, file: &TransferFile) -> Result<FileName, CommandError> {
    let name = &file.remote_path.name;
    let entries = talk.list(file.remote_path.partition)?;
    pc::free_name(name, &entries).ok_or_else(|| FilesError::NoFreeName(name.clone()).into())
}

/// Prompts the operator at the terminal until the answer is valid.
fn asked(name: &FileName) -> Result<Choice, CommandError> {
    loop {
        let answer = answer(&say::transfer_exists_ask(name))?;
        match answer.to_ascii_lowercase().as_str() {
            "o" => return Ok(Choice::Overwrite),
            "s" => return Ok(Choice::Skip),
            "r" => {}
            _ => continue,
        }
        loop {
            let new = self::answer(&say::transfer_rename_ask(name))?;
            if new.is_empty() {
                return Ok(Choice::Skip);
            }
            match FileName::new(&new) {
                Ok(new) => return Ok(Choice::Rename(new)),
                Err(error) => output::complain_of(&error.message()),
            }
        }
    }
}

fn answer(question: &Message) -> Result<String, CommandError> {
    let mut out = io::stderr().lock();
    // A terminal that cannot show the question cannot be read either.
    let _ = write!(out, "{}", output::worded(question)).and_then(|()| out.flush());
    let mut line = String::new();
    let read = io::stdin().lock().read_line(&mut line);
    match read.map_err(CommandError::Gone)? {
        0 => Err(CommandError::Gone(io::ErrorKind::UnexpectedEof.into())),
        _ => Ok(line.trim().to_owned()),
    }
}
