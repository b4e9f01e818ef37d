//! `transfer`: the PC's side of the serial port (manual V), and a control without a window
//! for its other end.

mod bar;
mod control;
mod existing;
mod text;

use std::path::Path;

use gsk_messages::say;
use gsk_transfer::{FileName, Partition, PcCommand, RemotePath, TransferFile};

use super::{ALARM, CommandError, FINE, output};
use crate::cli::{
    ExistingFile, TransferBackupArgs, TransferCommand, TransferDeleteArgs, TransferListArgs,
    TransferPortArgs, TransferReceiveArgs, TransferRenameArgs, TransferRestoreArgs,
    TransferSendArgs, TransferWaitArgs,
};
use crate::pc::folder::{self, Chosen};
use crate::pc::{FilesError, Talk};
use bar::{connect, say_rate};
use existing::Settled;

/// Carries out a command of the serial port. Exit code 1 if the control refuses something or
/// does not answer.
pub fn transfer(command: &TransferCommand) -> Result<u8, CommandError> {
    let done = match command {
        TransferCommand::List(args) => list(args),
        TransferCommand::Send(args) => send(args),
        TransferCommand::Receive(args) => receive(args),
        TransferCommand::Delete(args) => delete(args),
        TransferCommand::Rename(args) => rename(args),
        TransferCommand::Backup(args) => backup(args),
        TransferCommand::Restore(args) => restore(args),
        TransferCommand::Wait(args) => wait(args),
        TransferCommand::SendText(args) => text::send(args),
        TransferCommand::ReceiveText(args) => text::receive(args),
        TransferCommand::Control(args) => return control::control(args),
    };
    match done {
        Ok(()) => Ok(FINE),
        Err(CommandError::Files(error)) if error.is_of_the_line() => {
            output::complain_of(&error.message());
            Ok(ALARM)
        }
        Err(error) => Err(error),
    }
}

/// Reports a refusal and lets the caller continue with the next file; returns any other
/// error.
fn goes_on(
    result: Result<(), impl Into<CommandError>>,
    failed: &mut bool,
) -> Result<(), CommandError> {
    match result.map_err(Into::into) {
        Err(CommandError::Files(error @ FilesError::Refused { .. })) => {
            output::complain_of(&error.message());
            *failed = true;
            Ok(())
        }
        result => result,
    }
}

/// The result of several files.
const fn ended(failed: bool) -> Result<(), CommandError> {
    match failed {
        true => Err(CommandError::Files(FilesError::Some)),
        false => Ok(()),
    }
}

fn list(args: &TransferListArgs) -> Result<(), CommandError> {
    let mut talk = connect(&args.port)?;
    let entries = talk.list(args.partition)?;
    talk.end();
    let lines = entries
        .iter()
        .map(|entry| format!("{:<12} {:>8}\n", entry.name.as_str(), entry.size));
    output::print(&lines.collect::<String>());
    Ok(())
}

fn send(args: &TransferSendArgs) -> Result<(), CommandError> {
    let files = args.files.iter().map(|word| folder::chosen(word));
    let files: Vec<Chosen> = files.collect::<Result<_, _>>()?;
    folder::each_once(&files)?;
    send_all(&args.port, &files, args.partition, args.on_existing)
}

fn restore(args: &TransferRestoreArgs) -> Result<(), CommandError> {
    let files = folder::of_folder(&args.folder)?;
    send_all(&args.port, &files, Partition::User, args.on_existing)
}

/// Sends files; reads all of them before the first one is sent.
fn send_all(
    port: &TransferPortArgs,
    files: &[Chosen],
    partition: Partition,
    on_existing: ExistingFile,
) -> Result<(), CommandError> {
    let read = files.iter().map(|file| folder::read(&file.path));
    let read: Vec<Vec<u8>> = read.collect::<Result<_, _>>()?;
    let mut talk = connect(port)?;
    let mut failed = false;
    for (done, (file, bytes)) in files.iter().zip(read).enumerate() {
        let new = TransferFile {
            remote_path: RemotePath {
                partition,
                name: file.name.clone(),
            },
            bytes,
            overwrite: on_existing == ExistingFile::Overwrite,
        };
        let sent = send_one(&mut talk, file, new, on_existing);
        if let Err(CommandError::Files(error @ (FilesError::Lost(_) | FilesError::Gone(_)))) = &sent
        {
            let said = say::transfer_unfinished(done, files.len(), error.message());
            output::complain_of(&said);
            return ended(true);
        }
        goes_on(sent, &mut failed)?;
    }
    say_rate(&talk);
    talk.end();
    ended(failed)
}

fn send_one(
    talk: &mut Talk,
    file: &Chosen,
    new: TransferFile,
    on_existing: ExistingFile,
) -> Result<(), CommandError> {
    let size = new.bytes.len();
    let settled = existing::send(talk, new, on_existing)?;
    output::say(&match settled {
        Settled::Sent => say::transfer_sent(file.path.display(), &file.name, size),
        Settled::Skipped => say::transfer_skipped(&file.name),
    });
    Ok(())
}

fn receive(args: &TransferReceiveArgs) -> Result<(), CommandError> {
    let names = args.names.iter().map(|name| name.as_str().to_owned());
    folder::keep_apart(&args.into, names, args.overwrite)?;
    receive_all(&args.port, &args.names, args.partition, &args.into)
}

fn receive_all(
    port: &TransferPortArgs,
    names: &[FileName],
    partition: Partition,
    into: &Path,
) -> Result<(), CommandError> {
    let mut talk = connect(port)?;
    let failed = fetch(&mut talk, names, partition, into)?;
    say_rate(&talk);
    talk.end();
    ended(failed)
}

/// Receives files and writes each one at once. Returns whether the control refused one.
fn fetch(
    talk: &mut Talk,
    names: &[FileName],
    partition: Partition,
    into: &Path,
) -> Result<bool, CommandError> {
    folder::make(into)?;
    let mut failed = false;
    for name in names {
        let place = RemotePath {
            partition,
            name: name.clone(),
        };
        let got = talk.receive(place).and_then(|bytes| {
            let path = into.join(name.as_str());
            folder::write(&path, &bytes)?;
            say_got(name.as_str(), &path, bytes.len());
            Ok(())
        });
        goes_on(got, &mut failed)?;
    }
    Ok(failed)
}

fn backup(args: &TransferBackupArgs) -> Result<(), CommandError> {
    let mut talk = connect(&args.port)?;
    let entries = talk.list(Partition::User)?;
    let names: Vec<FileName> = entries.into_iter().map(|entry| entry.name).collect();
    let written = names.iter().map(|name| name.as_str().to_owned());
    folder::keep_apart(&args.folder, written, args.overwrite)?;
    let failed = fetch(&mut talk, &names, Partition::User, &args.folder)?;
    say_rate(&talk);
    talk.end();
    ended(failed)
}

fn delete(args: &TransferDeleteArgs) -> Result<(), CommandError> {
    let mut talk = connect(&args.port)?;
    let mut failed = false;
    for name in &args.names {
        let place = RemotePath {
            partition: args.partition,
            name: name.clone(),
        };
        let deleted = talk.change(name, PcCommand::Delete(place));
        let deleted = deleted.map(|()| output::say(&say::transfer_deleted(name)));
        goes_on(deleted, &mut failed)?;
    }
    talk.end();
    ended(failed)
}

fn rename(args: &TransferRenameArgs) -> Result<(), CommandError> {
    let mut talk = connect(&args.port)?;
    let from = RemotePath {
        partition: args.partition,
        name: args.from.clone(),
    };
    let to = args.to.clone();
    talk.change(&args.from, PcCommand::Rename { from, to })?;
    talk.end();
    output::say(&say::transfer_renamed(&args.from, &args.to));
    Ok(())
}

fn wait(args: &TransferWaitArgs) -> Result<(), CommandError> {
    folder::make(&args.folder)?;
    let mut talk = match connect(&args.port) {
        Ok(talk) => talk,
        // The control connects when it has something to send.
        Err(CommandError::Files(FilesError::Lost(_))) => bar::open(&args.port)?,
        Err(error) => return Err(error),
    };
    output::say(&say::transfer_waits());
    let mut count = 0;
    while args.files.is_none_or(|most| count < most) {
        let Some(file) = talk.idle()? else { continue };
        let name = file.remote_path.name.as_str();
        let path = match args.overwrite {
            true => args.folder.join(name),
            false => folder::free(&args.folder, name),
        };
        folder::write(&path, &file.bytes)?;
        say_got(name, &path, file.bytes.len());
        count += 1;
    }
    talk.end();
    Ok(())
}

/// Reports a received file.
fn say_got(name: &str, path: &Path, size: usize) {
    output::say(&say::transfer_got(name, path.display(), size));
}
