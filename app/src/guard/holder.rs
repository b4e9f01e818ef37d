//! The process that holds a port: it moves bytes, and stops the board when the program at
//! the other end of the connection is gone.

use std::io::{self, ErrorKind, Read, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use gsk_messages::Message;
use web_time::{Duration, Instant};

use super::frame::{self, Kind, Lease, Reader};
use super::now_ms;
use crate::platform::{self, ToProgram};
use crate::ports::Port;

/// How long to retry a port that a program has just closed.
const FREE_WITHIN: Duration = Duration::from_secs(1);
/// Time between two checks for bytes of the port.
const READ_WAIT: Duration = Duration::from_secs(1);
/// Size of a write, bytes: a port that is ready takes at least this number.
const AT_ONCE: usize = 256;
/// Longest time a port may take no bytes while the holder stops the board.
const STUCK: Duration = Duration::from_millis(500);
/// Times after the loss of the program at which the holder sends the stop bytes, ms. One
/// copy may be lost, and FluidNC carries out a line that it had received after the first
/// copy.
const STOPS: [u64; 5] = [0, 30, 100, 250, 600];
/// How long the holder reads the board's answer to the stop bytes: the next program that
/// opens the port would take it for its own.
const ANSWERS: Duration = Duration::from_millis(200);

/// Time between two checks whether the program renews its lease.
const LOOK: Duration = Duration::from_millis(50);

/// Why the holder moves no more bytes.
enum Gone {
    /// The program has closed the port.
    Closed,
    /// The program is gone, for any reason.
    Lost,
    /// The program runs, but has not renewed its lease, or its bytes came too late.
    Silent,
}

/// The board's answer to the stop bytes; `None`: the bytes go to the program.
type Answers = Arc<Mutex<Option<Vec<u8>>>>;

/// Standard input is not connected to a program that needs a holder.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub struct NoProgram(io::Error);

impl NoProgram {
    /// Returns the message for the operator.
    pub fn message(&self) -> Message {
        gsk_messages::say::port_no_holder_wanted(&self.0)
    }
}

/// Opens a port and holds it until the program at standard input is gone.
///
/// # Errors
/// Standard input is not connected to such a program.
pub fn hold(path: &str, baud: u32) -> Result<(), NoProgram> {
    let mut partner = ToProgram::at_standard_input().map_err(NoProgram)?;
    // The holder stops the board before it ends: it ignores termination signals.
    platform::outlive_ending();
    platform::name_process("gsk980td-port");
    let opened = Port::open_within(path, baud, FREE_WITHIN)
        .and_then(|port| Ok((port.reading(READ_WAIT)?, port)));
    let (inward, mut port) = match opened {
        Ok(opened) => opened,
        Err(cause) => {
            // The program knows the language of its user, this process does not.
            let said = serde_json::to_vec(&cause.message()).unwrap_or_default();
            let _ = say(&mut partner, Kind::Refused, &said);
            return Ok(());
        }
    };
    // Sent before any byte of the board. A program that does not receive it is gone; the
    // code below notices that.
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
        // The program has stopped the board itself.
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

/// Starts the thread that passes the board's bytes to the program.
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
                // A program that is gone receives nothing; the board continues to send.
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

/// Passes the program's bytes to the port until the program is gone.
fn carry(partner: &mut ToProgram, port: &mut Port, stop: &mut Vec<u8>) -> io::Result<Gone> {
    let mut reader = Reader::default();
    let mut buffer = [0; frame::MOST];
    let mut lease = Lease::default();
    let mut silent = Duration::ZERO;
    loop {
        // The holder's own sleep does not count: the program may have slept, too.
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
                // The remaining bytes of a program that is gone are obsolete.
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

/// Writes all bytes. When the port takes none, calls `give_up` with the time since it last
/// took some; true ends the write.
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

/// Sends the stop bytes to the board at the times in [`STOPS`].
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
