//! A file whose name the control has already: it is overwritten, the one that is there is
//! renamed, or it is skipped (manual V-3.3).

use std::io::{self, BufRead, IsTerminal, Write};

use gsk_messages::{Message, say};
use gsk_transfer::{Fault, FileName, NewFile, Order};

use super::{CommandError, FilesError};
use crate::cli::ExistingFile;

use super::talk::Talk;

/// Numbers from here on need another level.
const PROTECTED_FROM: u16 = 9000;

/// What has become of a file.
pub(super) enum Settled {
    Sent,
    Skipped,
}

/// What is to be done about it.
enum Choice {
    Overwrite,
    Rename(FileName),
    Skip,
}

/// Sends a file, whatever stands in its way.
pub(super) fn send(
    talk: &mut Talk,
    file: NewFile,
    on_existing: ExistingFile,
) -> Result<Settled, CommandError> {
    match talk.send(file.clone()) {
        Err(CommandError::Files(FilesError::Refused {
            fault: Fault::Exists,
            ..
        })) => {}
        result => return result.map(|()| Settled::Sent),
    }
    match choice(talk, &file, on_existing)? {
        Choice::Overwrite => {
            let file = NewFile {
                overwrite: true,
                ..file
            };
            talk.send(file)?;
        }
        Choice::Rename(to) => {
            let from = file.place.clone();
            talk.change(
                &file.place.name,
                Order::Rename {
                    from,
                    to: to.clone(),
                },
            )?;
            super::output::say(&say::transfer_renamed(&file.place.name, to));
            talk.send(file)?;
        }
        Choice::Skip => return Ok(Settled::Skipped),
    }
    Ok(Settled::Sent)
}

fn choice(
    talk: &mut Talk,
    file: &NewFile,
    on_existing: ExistingFile,
) -> Result<Choice, CommandError> {
    let name = &file.place.name;
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

/// The next program number that is free.
fn free_name(talk: &mut Talk, file: &NewFile) -> Result<FileName, CommandError> {
    let none = || FilesError::NoFreeName(file.place.name.clone());
    let number = file.place.name.program().ok_or_else(none)?;
    let entries = talk.list(file.place.partition)?;
    let taken: Vec<u16> = entries
        .iter()
        .filter_map(|entry| entry.name.program())
        .collect();
    let numbers = (number..PROTECTED_FROM).chain(1..number);
    let mut free = numbers.filter(|number| !taken.contains(number));
    Ok(FileName::of_program(free.next().ok_or_else(none)?))
}

/// Asks somebody at the terminal until the answer is one.
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
                Err(error) => complain!("{error}"),
            }
        }
    }
}

fn answer(question: &Message) -> Result<String, CommandError> {
    let mut out = io::stderr().lock();
    // A terminal that shows no question takes no answer either.
    let _ = write!(out, "{question}").and_then(|()| out.flush());
    let mut line = String::new();
    let read = io::stdin().lock().read_line(&mut line);
    match read.map_err(CommandError::Gone)? {
        0 => Err(CommandError::Gone(io::ErrorKind::UnexpectedEof.into())),
        _ => Ok(line.trim().to_owned()),
    }
}
