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

/// Greatest number of bytes of one read.
const READ_BYTES: usize = 4096;
/// Limit of the bytes that wait to be written to the pipe.
const MAX_WAITING_BYTES: usize = 16 * READ_BYTES;
/// Flag for a process without a visible console, which the program's Ctrl-C does not reach.
const CREATE_NO_WINDOW: u32 = 0x0800_0000;

/// The program's end of the connection to the holder process.
pub struct HolderConnection {
    /// Sends bytes to the thread that writes the pipe; `None` after
    /// [`HolderConnection::end_sending`].
    outward: Option<Sender<Vec<u8>>>,
    /// Number of bytes that wait in `outward` to be written.
    waiting: Arc<AtomicUsize>,
    inward: Receiver<Vec<u8>>,
}

impl HolderConnection {
    /// Starts the holder, separate from the program's console.
    ///
    /// # Errors
    /// An error of the system.
    pub fn start(mut lock_holder: Command) -> io::Result<(Child, Self)> {
        let mut child = lock_holder
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .creation_flags(CREATE_NO_WINDOW)
            .spawn()?;
        let none = || io::Error::from(ErrorKind::BrokenPipe);
        let stdin = child.stdin.take().ok_or_else(none)?;
        let stdout = child.stdout.take().ok_or_else(none)?;
        let (outward, outgoing) = unbounded();
        let (incoming, inward) = unbounded();
        let waiting = Arc::new(AtomicUsize::new(0));
        let waiting_count = Arc::clone(&waiting);
        thread::Builder::new().spawn(move || write_all(stdin, &outgoing, &waiting_count))?;
        thread::Builder::new()
            .spawn(move || read_all(stdout, |bytes| drop(incoming.send(bytes))))?;
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
    pub fn receive(&mut self, within: Duration) -> io::Result<Vec<u8>> {
        match self.inward.recv_timeout(within) {
            Ok(bytes) => Ok(bytes),
            Err(RecvTimeoutError::Timeout) => Ok(Vec::new()),
            Err(RecvTimeoutError::Disconnected) => Err(ErrorKind::UnexpectedEof.into()),
        }
    }

    /// Sends as many bytes to the holder as the connection accepts now; returns their number.
    ///
    /// # Errors
    /// The holder is gone.
    pub fn send(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let room = MAX_WAITING_BYTES.saturating_sub(self.waiting.load(Ordering::Acquire));
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
    pub fn end_sending(&mut self) {
        self.outward = None;
    }
}

/// Writes bytes to the pipe until the sender is dropped, or the other end of the pipe is
/// closed.
fn write_all(mut pipe: ChildStdin, outgoing: &Receiver<Vec<u8>>, waiting: &AtomicUsize) {
    for bytes in outgoing {
        if pipe.write_all(&bytes).is_err() {
            return;
        }
        waiting.fetch_sub(bytes.len(), Ordering::AcqRel);
    }
}

/// Reads the pipe and passes the bytes to `on_bytes` until the other end is closed.
fn read_all(mut pipe: impl Read, mut on_bytes: impl FnMut(Vec<u8>)) {
    let mut buffer = [0; READ_BYTES];
    loop {
        match pipe.read(&mut buffer) {
            Ok(0) => return,
            Ok(count) => on_bytes(buffer[..count].to_vec()),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(_) => return,
        }
    }
}

/// Bytes of the program that were not read yet, and whether the program is gone.
#[derive(Default)]
struct ProgramBytes {
    bytes: VecDeque<u8>,
    gone: bool,
}

/// `ProgramBytes` shared by two threads, with a signal for the waiting one.
#[derive(Default)]
struct SharedProgramBytes {
    bytes: Mutex<ProgramBytes>,
    more: Condvar,
}

impl SharedProgramBytes {
    fn lock(&self) -> MutexGuard<'_, ProgramBytes> {
        self.bytes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the bytes with `update` and wakes the thread that waits for them.
    fn update(&self, update: impl FnOnce(&mut ProgramBytes)) {
        update(&mut self.lock());
        self.more.notify_all();
    }
}

/// The holder process's end of the connection to the program.
pub struct ProgramConnection(Arc<SharedProgramBytes>);

impl ProgramConnection {
    /// Connects to the program that has started this process.
    ///
    /// # Errors
    /// Standard input is not connected to the program.
    pub fn from_standard_input() -> io::Result<Self> {
        if io::IsTerminal::is_terminal(&io::stdin()) {
            return Err(ErrorKind::NotConnected.into());
        }
        let inward = Arc::new(SharedProgramBytes::default());
        let shared = Arc::clone(&inward);
        let read = move || {
            read_all(io::stdin().lock(), |bytes| {
                shared.update(|received| received.bytes.extend(bytes));
            });
            shared.update(|received| received.gone = true);
        };
        thread::Builder::new().spawn(read)?;
        Ok(Self(inward))
    }

    /// Returns another handle of the same end, for another thread.
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
    pub fn has_bytes_within(&self, time: Duration) -> io::Result<bool> {
        let nothing = |received: &mut ProgramBytes| received.bytes.is_empty() && !received.gone;
        let waited = self.0.more.wait_timeout_while(self.0.lock(), time, nothing);
        let (received, waited) = waited.unwrap_or_else(PoisonError::into_inner);
        drop(received);
        Ok(!waited.timed_out())
    }

    /// Whether the program is gone, even if some of its bytes are unread.
    pub fn is_gone(&self) -> bool {
        self.0.lock().gone
    }
}

impl Read for ProgramConnection {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let nothing = |received: &mut ProgramBytes| received.bytes.is_empty() && !received.gone;
        let waited = self.0.more.wait_while(self.0.lock(), nothing);
        let mut received = waited.unwrap_or_else(PoisonError::into_inner);
        received.bytes.read(buffer)
    }
}

impl Write for ProgramConnection {
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
