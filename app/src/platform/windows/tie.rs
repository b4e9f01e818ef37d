//! Two pipes between the program and the holder of its port: the standard input and output
//! of the holder. A read of a pipe has no time limit, and a pipe does not report that its
//! other end is gone: a thread reads each of them.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::os::windows::process::CommandExt;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, unbounded};

/// Size of a read, bytes.
const AT_ONCE: usize = 4096;
/// Limit of the bytes that wait for the pipe.
const MOST_WAITING: usize = 16 * AT_ONCE;
/// A process without a visible console; the program's Ctrl-C does not reach it.
const CREATE_NO_WINDOW: u32 = 0x0800_0000;

/// The program's end of the connection.
pub struct ToHolder {
    /// `None` after [`ToHolder::hang_up`].
    outward: Option<Sender<Vec<u8>>>,
    /// Number of bytes that wait in `outward`.
    waiting: Arc<AtomicUsize>,
    inward: Receiver<Vec<u8>>,
}

impl ToHolder {
    /// Starts the holder, separate from the program's console.
    ///
    /// # Errors
    /// An error of the system.
    pub fn start(mut holder: Command) -> io::Result<(Child, Self)> {
        let mut child = holder
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .creation_flags(CREATE_NO_WINDOW)
            .spawn()?;
        let none = || io::Error::from(ErrorKind::BrokenPipe);
        let stdin = child.stdin.take().ok_or_else(none)?;
        let stdout = child.stdout.take().ok_or_else(none)?;
        let (outward, say) = unbounded();
        let (heard, inward) = unbounded();
        let waiting = Arc::new(AtomicUsize::new(0));
        let said = Arc::clone(&waiting);
        thread::Builder::new().spawn(move || write_all(stdin, &say, &said))?;
        thread::Builder::new().spawn(move || read_all(stdout, |bytes| drop(heard.send(bytes))))?;
        let tie = Self {
            outward: Some(outward),
            waiting,
            inward,
        };
        Ok((child, tie))
    }

    /// Returns the bytes of the holder that arrive within this time, or none.
    ///
    /// # Errors
    /// The holder is gone.
    pub fn hear(&mut self, within: Duration) -> io::Result<Vec<u8>> {
        match self.inward.recv_timeout(within) {
            Ok(bytes) => Ok(bytes),
            Err(RecvTimeoutError::Timeout) => Ok(Vec::new()),
            Err(RecvTimeoutError::Disconnected) => Err(ErrorKind::UnexpectedEof.into()),
        }
    }

    /// Sends as many bytes as the connection takes now; returns their number.
    ///
    /// # Errors
    /// The holder is gone.
    pub fn say(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let room = MOST_WAITING.saturating_sub(self.waiting.load(Ordering::Acquire));
        let count = bytes.len().min(room);
        if count == 0 {
            return Ok(0);
        }
        let outward = self.outward.as_ref().ok_or(ErrorKind::BrokenPipe)?;
        self.waiting.fetch_add(count, Ordering::AcqRel);
        let sent = outward.send(bytes[..count].to_vec());
        sent.map(|()| count)
            .map_err(|_| ErrorKind::BrokenPipe.into())
    }

    /// Ends sending: the waiting bytes are written, then the pipe is closed.
    pub fn hang_up(&mut self) {
        self.outward = None;
    }
}

/// Writes bytes until the sender is gone, or the reader of the pipe is.
fn write_all(mut pipe: ChildStdin, said: &Receiver<Vec<u8>>, waiting: &AtomicUsize) {
    for bytes in said {
        if pipe.write_all(&bytes).is_err() {
            return;
        }
        waiting.fetch_sub(bytes.len(), Ordering::AcqRel);
    }
}

/// Reads until the other end is closed.
fn read_all(mut pipe: impl Read, mut heard: impl FnMut(Vec<u8>)) {
    let mut buffer = [0; AT_ONCE];
    loop {
        match pipe.read(&mut buffer) {
            Ok(0) => return,
            Ok(count) => heard(buffer[..count].to_vec()),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(_) => return,
        }
    }
}

/// Bytes of the program, and whether it is gone.
#[derive(Default)]
struct Said {
    bytes: VecDeque<u8>,
    gone: bool,
}

/// Shared bytes, with a signal for a waiting reader.
#[derive(Default)]
struct Inward {
    said: Mutex<Said>,
    more: Condvar,
}

impl Inward {
    fn said(&self) -> MutexGuard<'_, Said> {
        self.said.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the bytes and wakes the reader.
    fn change(&self, change: impl FnOnce(&mut Said)) {
        change(&mut self.said());
        self.more.notify_all();
    }
}

/// The holder's end of the connection.
pub struct ToProgram(Arc<Inward>);

impl ToProgram {
    /// Connects to the program that has started this process.
    ///
    /// # Errors
    /// Standard input is not connected to the program.
    pub fn at_standard_input() -> io::Result<Self> {
        if io::IsTerminal::is_terminal(&io::stdin()) {
            return Err(ErrorKind::NotConnected.into());
        }
        let inward = Arc::new(Inward::default());
        let heard = Arc::clone(&inward);
        let read = move || {
            read_all(io::stdin().lock(), |bytes| {
                heard.change(|said| said.bytes.extend(bytes));
            });
            heard.change(|said| said.gone = true);
        };
        thread::Builder::new().spawn(read)?;
        Ok(Self(inward))
    }

    /// Returns the same end for another thread.
    ///
    /// # Errors
    /// Never.
    pub fn try_clone(&self) -> io::Result<Self> {
        Ok(Self(Arc::clone(&self.0)))
    }

    /// Whether bytes of the program arrive within this time, or it is gone.
    ///
    /// # Errors
    /// Never.
    pub fn has_said_within(&self, time: Duration) -> io::Result<bool> {
        let nothing = |said: &mut Said| said.bytes.is_empty() && !said.gone;
        let waited = self.0.more.wait_timeout_while(self.0.said(), time, nothing);
        let (_, waited) = waited.unwrap_or_else(PoisonError::into_inner);
        Ok(!waited.timed_out())
    }

    /// Whether the program is gone, even if some of its bytes are unread.
    pub fn is_gone(&self) -> bool {
        self.0.said().gone
    }
}

impl Read for ToProgram {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let nothing = |said: &mut Said| said.bytes.is_empty() && !said.gone;
        let waited = self.0.more.wait_while(self.0.said(), nothing);
        let mut said = waited.unwrap_or_else(PoisonError::into_inner);
        said.bytes.read(buffer)
    }
}

impl Write for ToProgram {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut out = io::stdout().lock();
        let count = out.write(bytes)?;
        out.flush()?;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stdout().flush()
    }
}
