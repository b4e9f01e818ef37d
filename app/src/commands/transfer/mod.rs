//! `transfer`: the PC's side of the serial port (manual V), and a control without a window
//! for its other end.

mod bar;
mod control;
mod existing;
mod text;

use std::path::Path;

use gsk_host::pc::folder::{self, PcFile};
use gsk_host::pc::{FilesError, TransferSession};
use gsk_messages::say;
use gsk_transfer::{FileName, Partition, PcCommand, RemotePath, TransferFile};

use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::{
    ExistingFile, TransferBackupArgs, TransferCommand, TransferDeleteArgs, TransferListArgs,
    TransferPortArgs, TransferReceiveArgs, TransferRenameArgs, TransferRestoreArgs,
    TransferSendArgs, TransferWaitArgs,
};
pub(super) use bar::select_port;
use bar::{connect_to_control, print_rate};
use existing::SendOutcome;

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
        TransferCommand::Control(args) => return control::run_control(args),
    };
    match done {
        Ok(()) => Ok(EXIT_OK),
        Err(CommandError::Files(error)) if error.is_line_error() => {
            output::report_error(&error.message());
            Ok(EXIT_ALARM)
        }
        Err(error) => Err(error),
    }
}

/// Prints a refusal of the control, sets `failed` and returns `Ok`, so that the caller
/// continues with the next file; returns any other result unchanged.
fn report_refusal(
    result: Result<(), impl Into<CommandError>>,
    failed: &mut bool,
) -> Result<(), CommandError> {
    match result.map_err(Into::into) {
        Err(CommandError::Files(error @ FilesError::Refused { .. })) => {
            output::report_error(&error.message());
            *failed = true;
            Ok(())
        }
        result => result,
    }
}

/// Converts the flag that some of several files failed into a result.
const fn batch_result(failed: bool) -> Result<(), CommandError> {
    match failed {
        true => Err(CommandError::Files(FilesError::SomeFailed)),
        false => Ok(()),
    }
}

fn list(args: &TransferListArgs) -> Result<(), CommandError> {
    let mut talk = connect_to_control(&args.port)?;
    let entries = talk.list(args.partition)?;
    talk.close();
    let lines = entries
        .iter()
        .map(|entry| format!("{:<12} {:>8}\n", entry.name.as_str(), entry.size));
    output::print(&lines.collect::<String>());
    Ok(())
}

fn send(args: &TransferSendArgs) -> Result<(), CommandError> {
    let files = args.files.iter().map(|word| folder::parse_file_word(word));
    let files: Vec<PcFile> = files.collect::<Result<_, _>>()?;
    folder::refuse_duplicates(&files)?;
    send_all(&args.port, &files, args.partition, args.on_existing)
}

fn restore(args: &TransferRestoreArgs) -> Result<(), CommandError> {
    let files = folder::list_control_files(&args.folder)?;
    send_all(&args.port, &files, Partition::User, args.on_existing)
}

/// Reads all files, then sends them to the control. Returns an error if a file cannot be read or
/// the transfer fails.
fn send_all(
    port: &TransferPortArgs,
    files: &[PcFile],
    partition: Partition,
    on_existing: ExistingFile,
) -> Result<(), CommandError> {
    let read = files.iter().map(|file| folder::read_file(&file.path));
    let read: Vec<Vec<u8>> = read.collect::<Result<_, _>>()?;
    let mut talk = connect_to_control(port)?;
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
            let message = say::transfer_unfinished(done, files.len(), error.message());
            output::report_error(&message);
            return batch_result(true);
        }
        report_refusal(sent, &mut failed)?;
    }
    print_rate(&talk);
    talk.close();
    batch_result(failed)
}

fn send_one(
    talk: &mut TransferSession,
    file: &PcFile,
    new: TransferFile,
    on_existing: ExistingFile,
) -> Result<(), CommandError> {
    let size = new.bytes.len();
    let settled = existing::send(talk, new, on_existing)?;
    output::print_message(&match settled {
        SendOutcome::Sent => say::transfer_sent(file.path.display(), &file.name, size),
        SendOutcome::Skipped => say::transfer_skipped(&file.name),
    });
    Ok(())
}

fn receive(args: &TransferReceiveArgs) -> Result<(), CommandError> {
    let names = args.names.iter().map(|name| name.as_str().to_owned());
    folder::refuse_existing(&args.into, names, args.overwrite)?;
    receive_all(&args.port, &args.names, args.partition, &args.into)
}

fn receive_all(
    port: &TransferPortArgs,
    names: &[FileName],
    partition: Partition,
    into: &Path,
) -> Result<(), CommandError> {
    let mut talk = connect_to_control(port)?;
    let failed = fetch(&mut talk, names, partition, into)?;
    print_rate(&talk);
    talk.close();
    batch_result(failed)
}

/// Receives files and writes each one into the folder `into` at once. Returns true if the
/// control refused one.
fn fetch(
    talk: &mut TransferSession,
    names: &[FileName],
    partition: Partition,
    into: &Path,
) -> Result<bool, CommandError> {
    folder::make_folder(into)?;
    let mut failed = false;
    for name in names {
        let remote_path = RemotePath {
            partition,
            name: name.clone(),
        };
        let received = talk.receive(remote_path).and_then(|bytes| {
            let path = into.join(name.as_str());
            folder::write_file(&path, &bytes)?;
            print_received(name.as_str(), &path, bytes.len());
            Ok(())
        });
        report_refusal(received, &mut failed)?;
    }
    Ok(failed)
}

fn backup(args: &TransferBackupArgs) -> Result<(), CommandError> {
    let mut talk = connect_to_control(&args.port)?;
    let entries = talk.list(Partition::User)?;
    let names: Vec<FileName> = entries.into_iter().map(|entry| entry.name).collect();
    let written = names.iter().map(|name| name.as_str().to_owned());
    folder::refuse_existing(&args.folder, written, args.overwrite)?;
    let failed = fetch(&mut talk, &names, Partition::User, &args.folder)?;
    print_rate(&talk);
    talk.close();
    batch_result(failed)
}

fn delete(args: &TransferDeleteArgs) -> Result<(), CommandError> {
    let mut talk = connect_to_control(&args.port)?;
    let mut failed = false;
    for name in &args.names {
        let remote_path = RemotePath {
            partition: args.partition,
            name: name.clone(),
        };
        let deleted = talk.change(name, PcCommand::Delete(remote_path));
        let deleted = deleted.map(|()| output::print_message(&say::transfer_deleted(name)));
        report_refusal(deleted, &mut failed)?;
    }
    talk.close();
    batch_result(failed)
}

fn rename(args: &TransferRenameArgs) -> Result<(), CommandError> {
    let mut talk = connect_to_control(&args.port)?;
    let from = RemotePath {
        partition: args.partition,
        name: args.from.clone(),
    };
    let to = args.to.clone();
    talk.change(&args.from, PcCommand::Rename { from, to })?;
    talk.close();
    output::print_message(&say::transfer_renamed(&args.from, &args.to));
    Ok(())
}

fn wait(args: &TransferWaitArgs) -> Result<(), CommandError> {
    folder::make_folder(&args.folder)?;
    let mut talk = match connect_to_control(&args.port) {
        Ok(talk) => talk,
        // The control connects when it has something to send.
        Err(CommandError::Files(FilesError::Lost(_))) => bar::open_port(&args.port)?,
        Err(error) => return Err(error),
    };
    output::print_message(&say::transfer_waits());
    let mut count = 0;
    while args.files.is_none_or(|max_files| count < max_files) {
        let Some(file) = talk.poll()? else { continue };
        let name = file.remote_path.name.as_str();
        let path = match args.overwrite {
            true => args.folder.join(name),
            false => folder::free_path(&args.folder, name),
        };
        folder::write_file(&path, &file.bytes)?;
        print_received(name, &path, file.bytes.len());
        count += 1;
    }
    talk.close();
    Ok(())
}

/// Prints name, path and size in bytes of a received file.
fn print_received(name: &str, path: &Path, size: usize) {
    output::print_message(&say::transfer_got(name, path.display(), size));
}
