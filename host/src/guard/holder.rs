//! The process that holds a port: it moves bytes, and stops the board when the program at
//! the other end of the connection is gone.

use std::io::{self, ErrorKind, Read, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use gsk_messages::Message;
use web_time::{Duration, Instant};

use super::frame::{self, FrameKind, GuardFrameReader, Lease};
use super::now_ms;
use crate::platform::{self, ProgramConnection};
use crate::ports::Port;

/// Time for which the holder retries to open a port that another program has just closed.
const OPEN_RETRY_TIME: Duration = Duration::from_secs(1);
/// Longest time that a read from the port waits for bytes.
const READ_WAIT: Duration = Duration::from_secs(1);
/// Size of a write, bytes: a port that is ready takes at least this number.
const WRITE_BYTES: usize = 256;
/// Longest time a port may take no bytes while the holder stops the board.
const STUCK_TIMEOUT: Duration = Duration::from_millis(500);
/// Times after the loss of the program at which the holder sends the stop bytes, ms. One
/// copy may be lost, and FluidNC carries out a line that it had received after the first
/// copy.
const STOP_TIMES_MS: [u64; 5] = [0, 30, 100, 250, 600];
/// Time for which the holder reads the board's answer to the stop bytes, because the next program
/// that opens the port would mistake it for an answer to its commands.
const ANSWER_TIME: Duration = Duration::from_millis(200);

/// Time between two checks whether the program renews its lease.
const LEASE_CHECK_INTERVAL: Duration = Duration::from_millis(50);

/// The reason why the holder process stopped passing bytes to the port.
enum RelayEnd {
    /// The program has closed the port.
    Closed,
    /// The program has ended without closing the port.
    Lost,
    /// The program runs, but has not renewed its lease, or its bytes came too late.
    Silent,
}

/// Collects the board's answer to the stop bytes; `None`: bytes of the board go to the
/// program.
type StopAnswer = Arc<Mutex<Option<Vec<u8>>>>;

/// The error for a standard input that is not connected to a program that needs a holder.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub struct NoProgram(io::Error);

impl NoProgram {
    /// Returns the message for the operator: why `hold-port` cannot start.
    pub fn message(&self) -> Message {
        gsk_messages::say::port_no_holder_wanted(&self.0)
    }
}

/// Opens a port and holds it until the program at standard input is gone.
///
/// # Errors
/// Standard input is not connected to such a program.
pub fn hold_port(path: &str, baud: u32) -> Result<(), NoProgram> {
    let mut partner = ProgramConnection::from_standard_input().map_err(NoProgram)?;
    // The holder stops the board before it ends: it ignores termination signals.
    platform::ignore_termination();
    platform::set_process_name("gsk980td-port");
    let opened = Port::open_with_retry(path, baud, OPEN_RETRY_TIME)
        .and_then(|port| Ok((port.clone_for_reading(READ_WAIT)?, port)));
    let (inward, mut port) = match opened {
        Ok(opened) => opened,
        Err(cause) => {
            // The program knows the language of its user, this process does not.
            let reason = serde_json::to_vec(&cause.message()).unwrap_or_default();
            let _ = send_frame(&mut partner, FrameKind::Refused, &reason);
            return Ok(());
        }
    };
    // Sent before any byte of the board. A program that does not receive it is gone; the
    // code below notices that.
    let _ = send_frame(&mut partner, FrameKind::Open, &[]);
    let answers = StopAnswer::default();
    let reads = partner
        .try_clone()
        .and_then(|partner| start_board_reader(inward, partner, Arc::clone(&answers)));
    if let Err(error) = reads {
        send_port_failure(&mut partner, &error);
        return Ok(());
    }
    let mut stop = Vec::new();
    match relay_program_bytes(&mut partner, &mut port, &mut stop) {
        // The program has stopped the board itself.
        Ok(RelayEnd::Closed) => {}
        Ok(RelayEnd::Lost) => stop_board(&mut port, &stop),
        Ok(RelayEnd::Silent) => {
            *lock_answer(&answers) = Some(Vec::new());
            stop_board(&mut port, &stop);
            let answered = lock_answer(&answers).take().unwrap_or_default();
            let _ = send_frame(&mut partner, FrameKind::Stopped, &answered);
        }
        Err(error) => send_port_failure(&mut partner, &error),
    }
    Ok(())
}

fn send_frame(partner: &mut ProgramConnection, kind: FrameKind, content: &[u8]) -> io::Result<()> {
    let mut bytes = Vec::new();
    frame::append_frame(&mut bytes, kind, content);
    partner.write_all(&bytes)
}

fn send_port_failure(partner: &mut ProgramConnection, error: &io::Error) {
    let number = error.raw_os_error().unwrap_or(0);
    let _ = send_frame(partner, FrameKind::Gone, &number.to_le_bytes());
}

fn lock_answer(answers: &StopAnswer) -> MutexGuard<'_, Option<Vec<u8>>> {
    answers.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Starts the thread that passes the board's bytes to the program, or to `answers` while the holder
/// stops the board. Returns an error if the system starts no thread.
fn start_board_reader(
    mut port: Port,
    mut partner: ProgramConnection,
    answers: StopAnswer,
) -> io::Result<()> {
    let listen = move || {
        loop {
            let read = port.read();
            if let (Ok(bytes), Some(answered)) = (&read, &mut *lock_answer(&answers)) {
                answered.extend(bytes);
                continue;
            }
            match read {
                Ok(bytes) if bytes.is_empty() => {}
                // A program that is gone receives nothing; the board continues to send.
                Ok(bytes) => drop(send_frame(&mut partner, FrameKind::Data, &bytes)),
                Err(error) => {
                    send_port_failure(&mut partner, &error);
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

/// Passes the program's bytes to the port until the program is gone or silent; keeps the stop
/// bytes that it sets in `stop`. Returns why it ended.
fn relay_program_bytes(
    partner: &mut ProgramConnection,
    port: &mut Port,
    stop: &mut Vec<u8>,
) -> io::Result<RelayEnd> {
    let mut reader = GuardFrameReader::default();
    let mut buffer = [0; frame::MAX_CONTENT];
    let mut lease = Lease::default();
    let mut silent = Duration::ZERO;
    loop {
        // The holder's own sleep does not count: the program may have slept, too.
        if !partner.has_bytes_within(LEASE_CHECK_INTERVAL)? {
            silent += LEASE_CHECK_INTERVAL;
            let longest = Duration::from_millis(lease.silent_ms.into());
            if !longest.is_zero() && silent >= longest {
                return Ok(RelayEnd::Silent);
            }
            continue;
        }
        silent = Duration::ZERO;
        match partner.read(&mut buffer) {
            Ok(0) => return Ok(RelayEnd::Lost),
            Ok(count) => reader.push_bytes(&buffer[..count]),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(_) => return Ok(RelayEnd::Lost),
        }
        loop {
            match reader.take_frame() {
                // The remaining bytes of a program that is gone are obsolete.
                Ok(Some((FrameKind::Dated, _))) if partner.is_gone() => {}
                Ok(Some((FrameKind::Dated, content))) => {
                    let Some((at, bytes)) = frame::split_dated(&content) else {
                        return Ok(RelayEnd::Lost);
                    };
                    let age = now_ms().saturating_sub(at);
                    if lease.stale_ms > 0 && age > lease.stale_ms.into() {
                        return Ok(RelayEnd::Silent);
                    }
                    write_all(port, bytes, |_| partner.is_gone())?;
                }
                Ok(Some((FrameKind::Lease, content))) => {
                    let Some(renewed) = Lease::from_bytes(&content) else {
                        return Ok(RelayEnd::Lost);
                    };
                    lease = renewed;
                }
                Ok(Some((FrameKind::Stop, bytes))) => *stop = bytes,
                Ok(Some((FrameKind::End, _))) => return Ok(RelayEnd::Closed),
                Ok(None) => break,
                Ok(Some(_)) | Err(_) => return Ok(RelayEnd::Lost),
            }
        }
    }
}

/// Writes all bytes. While the port accepts none, calls `give_up` with the time since it last
/// accepted some; `give_up` returns true to end the write. Returns an error if the port has failed.
fn write_all(
    port: &mut Port,
    mut bytes: &[u8],
    give_up: impl Fn(Duration) -> bool,
) -> io::Result<()> {
    let mut taken = Instant::now();
    while !bytes.is_empty() {
        let count = port.write(&bytes[..bytes.len().min(WRITE_BYTES)])?;
        if count > 0 {
            taken = Instant::now();
        } else if give_up(taken.elapsed()) {
            return Ok(());
        }
        bytes = &bytes[count..];
    }
    Ok(())
}

/// Sends the stop bytes to the board at the times in [`STOP_TIMES_MS`].
fn stop_board(port: &mut Port, stop: &[u8]) {
    if stop.is_empty() {
        return;
    }
    let begun = Instant::now();
    for ms in STOP_TIMES_MS {
        thread::sleep(Duration::from_millis(ms).saturating_sub(begun.elapsed()));
        if write_all(port, stop, |stuck| stuck >= STUCK_TIMEOUT).is_err() {
            return;
        }
    }
    thread::sleep(ANSWER_TIME);
}
