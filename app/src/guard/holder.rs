//! The process that holds a port: it carries bytes, and stops the board when the
//! program at the other end of the tie is gone.

use std::io::{self, ErrorKind, Read, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use gsk_messages::Message;
use web_time::{Duration, Instant};

use super::frame::{self, Kind, Lease, Reader};
use super::now_ms;
use crate::platform::{self, ToProgram};
use crate::ports::Port;

/// A port that another process holds may be that of a program that has just ended.
const FREE_WITHIN: Duration = Duration::from_secs(1);
/// Between two looks whether the port says something.
const READ_WAIT: Duration = Duration::from_secs(1);
/// Bytes that are written at once: whoever can take some takes so many.
const AT_ONCE: usize = 256;
/// How long a port may take none while the board is being stopped.
const STUCK: Duration = Duration::from_millis(500);
/// When the board is told to stop after the program has gone, ms. Once may be lost, and
/// FluidNC carries out a line that it had taken behind the first one.
const STOPS: [u64; 5] = [0, 30, 100, 250, 600];
/// What the board answers to that is taken away for so long: whoever opens the port next
/// would take it for an answer of his own.
const ANSWERS: Duration = Duration::from_millis(200);

/// Between two looks whether the program still renews its lease.
const LOOK: Duration = Duration::from_millis(50);

/// Why nothing more is carried.
enum Gone {
    /// The program has closed the port.
    Closed,
    /// It is gone, whatever the reason.
    Lost,
    /// It is there and has not renewed its lease, or what it said came too late.
    Silent,
}

/// What the board answers while it is being stopped; None: it goes to the program.
type Answers = Arc<Mutex<Option<Vec<u8>>>>;

/// Standard input is no program that wants a port held.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub struct NoProgram(io::Error);

impl NoProgram {
    /// What is said of it.
    pub fn message(&self) -> Message {
        gsk_messages::say::port_no_holder_wanted(&self.0)
    }
}

/// Opens a port and holds it until the program at standard input is gone.
///
/// # Errors
/// Standard input is no such program.
pub fn hold(path: &str, baud: u32) -> Result<(), NoProgram> {
    let mut partner = ToProgram::at_standard_input().map_err(NoProgram)?;
    // The board is stopped before this process goes, whatever it is told.
    platform::outlive_ending();
    platform::name_process("gsk980td-port");
    let opened = Port::open_within(path, baud, FREE_WITHIN)
        .and_then(|port| Ok((port.reading(READ_WAIT)?, port)));
    let (inward, mut port) = match opened {
        Ok(opened) => opened,
        Err(cause) => {
            // The program speaks the language of its user, and not this one.
            let said = serde_json::to_vec(&cause.message()).unwrap_or_default();
            let _ = say(&mut partner, Kind::Refused, &said);
            return Ok(());
        }
    };
    // Before anything the board says; whoever does not hear it is gone already, and that
    // is noticed below.
    let _ = say(&mut partner, Kind::Open, &[]);
    let answers = Answers::default();
    let reads = partner
        .try_clone()
        .and_then(|partner| listen(inward, partner, Arc::clone(&answers)));
    if let Err(error) = reads {
        tell_gone(&mut partner, &error);
        return Ok(());
    }
    let mut stop = Vec::new();
    match carry(&mut partner, &mut port, &mut stop) {
        // It has stopped the board by itself.
        Ok(Gone::Closed) => {}
        Ok(Gone::Lost) => stop_board(&mut port, &stop),
        Ok(Gone::Silent) => {
            *lock(&answers) = Some(Vec::new());
            stop_board(&mut port, &stop);
            let answered = lock(&answers).take().unwrap_or_default();
            let _ = say(&mut partner, Kind::Stopped, &answered);
        }
        Err(error) => tell_gone(&mut partner, &error),
    }
    Ok(())
}

fn say(partner: &mut ToProgram, kind: Kind, content: &[u8]) -> io::Result<()> {
    let mut bytes = Vec::new();
    frame::put(&mut bytes, kind, content);
    partner.write_all(&bytes)
}

fn tell_gone(partner: &mut ToProgram, error: &io::Error) {
    let number = error.raw_os_error().unwrap_or(0);
    let _ = say(partner, Kind::Gone, &number.to_le_bytes());
}

fn lock(answers: &Answers) -> MutexGuard<'_, Option<Vec<u8>>> {
    answers.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What the board says goes to the program, in a thread of its own.
fn listen(mut port: Port, mut partner: ToProgram, answers: Answers) -> io::Result<()> {
    let listen = move || {
        loop {
            let read = port.read();
            if let (Ok(bytes), Some(answered)) = (&read, &mut *lock(&answers)) {
                answered.extend(bytes);
                continue;
            }
            match read {
                Ok(bytes) if bytes.is_empty() => {}
                // A program that is gone hears nothing; the board goes on speaking.
                Ok(bytes) => drop(say(&mut partner, Kind::Data, &bytes)),
                Err(error) => {
                    tell_gone(&mut partner, &error);
                    // Without a port there is nothing to hold.
                    std::process::exit(0);
                }
            }
        }
    };
    thread::Builder::new()
        .stack_size(1 << 17)
        .spawn(listen)
        .map(drop)
}

/// Carries what the program says to the port until it is gone.
fn carry(partner: &mut ToProgram, port: &mut Port, stop: &mut Vec<u8>) -> io::Result<Gone> {
    let mut reader = Reader::default();
    let mut buffer = [0; frame::MOST];
    let mut lease = Lease::default();
    let mut silent = Duration::ZERO;
    loop {
        // Its own absence is not counted: then the program may have been away, too.
        if !partner.has_said_within(LOOK)? {
            silent += LOOK;
            let longest = Duration::from_millis(lease.silent_ms.into());
            if !longest.is_zero() && silent >= longest {
                return Ok(Gone::Silent);
            }
            continue;
        }
        silent = Duration::ZERO;
        match partner.read(&mut buffer) {
            Ok(0) => return Ok(Gone::Lost),
            Ok(count) => reader.give(&buffer[..count]),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(_) => return Ok(Gone::Lost),
        }
        loop {
            match reader.take() {
                // What a program that is gone has left says nothing any more.
                Ok(Some((Kind::Dated, _))) if partner.is_gone() => {}
                Ok(Some((Kind::Dated, content))) => {
                    let Some((at, bytes)) = frame::dated(&content) else {
                        return Ok(Gone::Lost);
                    };
                    let age = now_ms().saturating_sub(at);
                    if lease.stale_ms > 0 && age > lease.stale_ms.into() {
                        return Ok(Gone::Silent);
                    }
                    write(port, bytes, |_| partner.is_gone())?;
                }
                Ok(Some((Kind::Lease, content))) => {
                    let Some(renewed) = Lease::from_bytes(&content) else {
                        return Ok(Gone::Lost);
                    };
                    lease = renewed;
                }
                Ok(Some((Kind::Stop, bytes))) => *stop = bytes,
                Ok(Some((Kind::End, _))) => return Ok(Gone::Closed),
                Ok(None) => break,
                Ok(Some(_)) | Err(_) => return Ok(Gone::Lost),
            }
        }
    }
}

/// Writes all of it, unless it is given up: asked whenever the port takes nothing, with
/// the time since it last did.
fn write(port: &mut Port, mut bytes: &[u8], give_up: impl Fn(Duration) -> bool) -> io::Result<()> {
    let mut taken = Instant::now();
    while !bytes.is_empty() {
        let count = port.write(&bytes[..bytes.len().min(AT_ONCE)])?;
        if count > 0 {
            taken = Instant::now();
        } else if give_up(taken.elapsed()) {
            return Ok(());
        }
        bytes = &bytes[count..];
    }
    Ok(())
}

/// Tells the board to stop at these times.
fn stop_board(port: &mut Port, stop: &[u8]) {
    if stop.is_empty() {
        return;
    }
    let begun = Instant::now();
    for ms in STOPS {
        thread::sleep(Duration::from_millis(ms).saturating_sub(begun.elapsed()));
        if write(port, stop, |stuck| stuck >= STUCK).is_err() {
            return;
        }
    }
    thread::sleep(ANSWERS);
}
