//! Sends and receives programs as plain text, for controls and DNC programs without a file
//! protocol.

use std::path::Path;

use gsk_host::files::program_file;
use gsk_host::pc::{FilesError, folder};
use gsk_host::ports::Port;
use gsk_messages::say;
use gsk_transfer::{TextEvent, TextReader, TextWriter, parse_program_number, split_programs};
use web_time::{Duration, Instant};

use super::{CommandError, bar, output, print_received};
use crate::cli::{TransferReceiveTextArgs, TransferSendTextArgs};

/// Time for which opening a port that another program has just closed is retried.
const PORT_RETRY_TIME: Duration = Duration::from_millis(500);
/// Pause between two programs, in which the receiver stores the first one.
const PROGRAM_PAUSE: Duration = Duration::from_millis(300);

pub(super) fn send(args: &TransferSendTextArgs) -> Result<(), CommandError> {
    let (name, baud) = bar::select_port(&args.port)?;
    let texts = args.files.iter().map(|path| {
        let file = program_file::read(path)?;
        let writer = TextWriter::new(&file.text, args.line_end.to_line_end(), baud);
        writer.map_err(|error| {
            CommandError::from(FilesError::NotText {
                file: path.clone(),
                error,
            })
        })
    });
    let texts: Vec<TextWriter> = texts.collect::<Result<_, _>>()?;
    let mut port = Port::open_with_retry(&name, baud, PORT_RETRY_TIME)?;
    let start = Instant::now();
    for (path, mut writer) in args.files.iter().zip(texts) {
        send_one(&mut port, &mut writer, start, args.wait)?;
        output::print_message(&say::transfer_text_sent(
            path.display(),
            writer.total_bytes(),
        ));
        pause(&mut port, PROGRAM_PAUSE)?;
    }
    Ok(())
}

fn send_one(
    port: &mut Port,
    writer: &mut TextWriter,
    begun: Instant,
    timeout_s: u64,
) -> Result<(), CommandError> {
    let mut last_progress = Instant::now();
    loop {
        let bytes = port.read().map_err(FilesError::Gone)?;
        writer.receive(&bytes);
        let now = begun.elapsed();
        if writer.is_finished(now) {
            return Ok(());
        }
        let sent_count = port
            .write(writer.pending_bytes(now))
            .map_err(FilesError::Gone)?;
        writer.mark_sent(sent_count, now);
        if sent_count > 0 || writer.sent_bytes() == writer.total_bytes() {
            last_progress = Instant::now();
        } else if last_progress.elapsed() > Duration::from_secs(timeout_s) {
            return Err(FilesError::LineStopped(timeout_s).into());
        }
    }
}

fn pause(port: &mut Port, time: Duration) -> Result<(), CommandError> {
    let start = Instant::now();
    while start.elapsed() < time {
        port.read().map_err(FilesError::Gone)?;
    }
    Ok(())
}

pub(super) fn receive(args: &TransferReceiveTextArgs) -> Result<(), CommandError> {
    folder::make_folder(&args.folder)?;
    let (name, baud) = bar::select_port(&args.port)?;
    let mut port = Port::open_with_retry(&name, baud, PORT_RETRY_TIME)?;
    output::print_message(&say::transfer_text_waits());
    let text = receive_text(&mut port, baud, args.wait)?;
    let found = split_programs(&text);
    let name = |program: &str| match parse_program_number(program) {
        Some(number) => format!("O{number:04}.CNC"),
        None => "TEXT.CNC".to_owned(),
    };
    folder::refuse_existing(
        &args.folder,
        found.iter().map(|program| name(program)),
        args.overwrite,
    )?;
    for program in found {
        store_program(&args.folder, &name(program), program)?;
    }
    Ok(())
}

fn store_program(into: &Path, name: &str, program: &str) -> Result<(), CommandError> {
    let path = into.join(name);
    let text = format!("{}\n%\n", program.trim_end());
    folder::write_file(&path, text.as_bytes())?;
    print_received(name, &path, text.len());
    Ok(())
}

fn receive_text(port: &mut Port, baud: u32, timeout_s: u64) -> Result<String, CommandError> {
    let mut reader = TextReader::new(baud);
    let mut replies = Vec::new();
    let start = Instant::now();
    let mut last_byte_at = start;
    loop {
        let bytes = port.read().map_err(FilesError::Gone)?;
        if !bytes.is_empty() {
            last_byte_at = Instant::now();
        }
        reader.receive(&bytes, start.elapsed());
        let event = reader.advance(start.elapsed());
        replies.extend(reader.take_flow_control());
        let sent_count = port.write(&replies).map_err(FilesError::Gone)?;
        replies.drain(..sent_count);
        match event {
            None if last_byte_at.elapsed() > Duration::from_secs(timeout_s) => {
                return Err(FilesError::NothingReceived(timeout_s).into());
            }
            None | Some(TextEvent::Started) => {}
            Some(TextEvent::Complete(text)) => return Ok(text),
            Some(TextEvent::Noise) => return Err(FilesError::Noise.into()),
            Some(TextEvent::Interrupted) => return Err(FilesError::Broken.into()),
        }
    }
}
