//! Sends and receives programs as plain text, for controls and DNC programs without a file
//! protocol.

use std::path::Path;

use gsk_messages::say;
use gsk_transfer::{TextEvent, TextReader, TextWriter, parse_program_number, split_programs};
use web_time::{Duration, Instant};

use super::{CommandError, bar, output, say_got};
use crate::cli::{TransferReceiveTextArgs, TransferSendTextArgs};
use crate::files::program_file;
use crate::pc::{FilesError, folder};
use crate::ports::Port;

/// Time for which a port may stay busy after another program has closed it.
const IN_USE: Duration = Duration::from_millis(500);
/// Pause between two programs: the other end stores the first one.
const BETWEEN: Duration = Duration::from_millis(300);

pub(super) fn send(args: &TransferSendTextArgs) -> Result<(), CommandError> {
    let (name, baud) = bar::port(&args.port)?;
    let texts = args.files.iter().map(|path| {
        let file = program_file::read(path)?;
        let writer = TextWriter::new(&file.text, args.line_end.line_end(), baud);
        writer.map_err(|error| {
            CommandError::from(FilesError::NotText {
                file: path.clone(),
                error,
            })
        })
    });
    let texts: Vec<TextWriter> = texts.collect::<Result<_, _>>()?;
    let mut port = Port::open_within(&name, baud, IN_USE)?;
    let begun = Instant::now();
    for (path, mut writer) in args.files.iter().zip(texts) {
        send_one(&mut port, &mut writer, begun, args.wait)?;
        output::say(&say::transfer_text_sent(
            path.display(),
            writer.total_bytes(),
        ));
        pause(&mut port, BETWEEN)?;
    }
    Ok(())
}

fn send_one(
    port: &mut Port,
    writer: &mut TextWriter,
    begun: Instant,
    patience: u64,
) -> Result<(), CommandError> {
    let mut moved = Instant::now();
    loop {
        let heard = port.read().map_err(FilesError::Gone)?;
        writer.receive(&heard);
        let now = begun.elapsed();
        if writer.is_finished(now) {
            return Ok(());
        }
        let taken = port
            .write(writer.pending_bytes(now))
            .map_err(FilesError::Gone)?;
        writer.mark_sent(taken, now);
        if taken > 0 || writer.sent_bytes() == writer.total_bytes() {
            moved = Instant::now();
        } else if moved.elapsed() > Duration::from_secs(patience) {
            return Err(FilesError::HeldUp(patience).into());
        }
    }
}

fn pause(port: &mut Port, time: Duration) -> Result<(), CommandError> {
    let begun = Instant::now();
    while begun.elapsed() < time {
        port.read().map_err(FilesError::Gone)?;
    }
    Ok(())
}

pub(super) fn receive(args: &TransferReceiveTextArgs) -> Result<(), CommandError> {
    folder::make(&args.folder)?;
    let (name, baud) = bar::port(&args.port)?;
    let mut port = Port::open_within(&name, baud, IN_USE)?;
    output::say(&say::transfer_text_waits());
    let text = read(&mut port, baud, args.wait)?;
    let found = split_programs(&text);
    let name = |program: &str| match parse_program_number(program) {
        Some(number) => format!("O{number:04}.CNC"),
        None => "TEXT.CNC".to_owned(),
    };
    folder::keep_apart(
        &args.folder,
        found.iter().map(|program| name(program)),
        args.overwrite,
    )?;
    for program in found {
        store(&args.folder, &name(program), program)?;
    }
    Ok(())
}

fn store(into: &Path, name: &str, program: &str) -> Result<(), CommandError> {
    let path = into.join(name);
    let text = format!("{}\n%\n", program.trim_end());
    folder::write(&path, text.as_bytes())?;
    say_got(name, &path, text.len());
    Ok(())
}

fn read(port: &mut Port, baud: u32, patience: u64) -> Result<String, CommandError> {
    let mut reader = TextReader::new(baud);
    let mut replies = Vec::new();
    let begun = Instant::now();
    let mut heard_at = begun;
    loop {
        let heard = port.read().map_err(FilesError::Gone)?;
        if !heard.is_empty() {
            heard_at = Instant::now();
        }
        reader.receive(&heard, begun.elapsed());
        let event = reader.advance(begun.elapsed());
        replies.extend(reader.take_flow_control());
        let taken = port.write(&replies).map_err(FilesError::Gone)?;
        replies.drain(..taken);
        match event {
            None if heard_at.elapsed() > Duration::from_secs(patience) => {
                return Err(FilesError::Nothing(patience).into());
            }
            None | Some(TextEvent::Started) => {}
            Some(TextEvent::Complete(text)) => return Ok(text),
            Some(TextEvent::Noise) => return Err(FilesError::Noise.into()),
            Some(TextEvent::Interrupted) => return Err(FilesError::Broken.into()),
        }
    }
}
