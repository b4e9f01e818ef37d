//! Two pipes between the program and the holder of its port: the holder's standard
//! input and output. A pipe cannot be waited for with a time, nor asked whether its
//! other end is gone: a thread reads each.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::os::windows::process::CommandExt;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, unbounded};

/// Bytes that are read at once.
const AT_ONCE: usize = 4096;
/// What may wait for the pipe before nothing more is taken.
const MOST_WAITING: usize = 16 * AT_ONCE;
/// Such a process has no console that is seen, and no Ctrl-C comes from the program's.
const CREATE_NO_WINDOW: u32 = 0x0800_0000;

/// The program's end.
pub struct ToHolder {
    /// None behind [`ToHolder::hang_up`].
    outward: Option<Sender<Vec<u8>>>,
    /// Bytes that wait in `outward`.
    waiting: Arc<AtomicUsize>,
    inward: Receiver<Vec<u8>>,
}

impl ToHolder {
    /// Starts the holder, apart from the program's console.
    ///
    /// # Errors
    /// What the system says.
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

    /// What the holder says, when it says something within this time; else nothing.
    ///
    /// # Errors
    /// It is gone.
    pub fn hear(&mut self, within: Duration) -> io::Result<Vec<u8>> {
        match self.inward.recv_timeout(within) {
            Ok(bytes) => Ok(bytes),
            Err(RecvTimeoutError::Timeout) => Ok(Vec::new()),
            Err(RecvTimeoutError::Disconnected) => Err(ErrorKind::UnexpectedEof.into()),
        }
    }

    /// Hands over as much as is taken now.
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

    /// Nothing more is said: what waits is written, then the pipe is closed.
    pub fn hang_up(&mut self) {
        self.outward = None;
    }
}

/// Writes what is said until nothing more will be, or nobody takes it.
fn write_all(mut pipe: ChildStdin, said: &Receiver<Vec<u8>>, waiting: &AtomicUsize) {
    for bytes in said {
        if pipe.write_all(&bytes).is_err() {
            return;
        }
        waiting.fetch_sub(bytes.len(), Ordering::AcqRel);
    }
}

/// Reads until nothing more can come.
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

/// What the program has said, and whether it is gone.
#[derive(Default)]
struct Said {
    bytes: VecDeque<u8>,
    gone: bool,
}

/// [`Said`], and a bell for whoever waits for more.
#[derive(Default)]
struct Inward {
    said: Mutex<Said>,
    more: Condvar,
}

impl Inward {
    fn said(&self) -> MutexGuard<'_, Said> {
        self.said.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes it and rings the bell.
    fn change(&self, change: impl FnOnce(&mut Said)) {
        change(&mut self.said());
        self.more.notify_all();
    }
}

/// The holder's end.
pub struct ToProgram(Arc<Inward>);

impl ToProgram {
    /// The program that has started this process.
    ///
    /// # Errors
    /// Standard input is no such program.
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

    /// The same for another thread.
    ///
    /// # Errors
    /// None here.
    pub fn try_clone(&self) -> io::Result<Self> {
        Ok(Self(Arc::clone(&self.0)))
    }

    /// Whether the program says something within this time, or is gone.
    ///
    /// # Errors
    /// None here.
    pub fn has_said_within(&self, time: Duration) -> io::Result<bool> {
        let nothing = |said: &mut Said| said.bytes.is_empty() && !said.gone;
        let waited = self.0.more.wait_timeout_while(self.0.said(), time, nothing);
        let (_, waited) = waited.unwrap_or_else(PoisonError::into_inner);
        Ok(!waited.timed_out())
    }

    /// Whether the program is gone, whatever of it was not read yet.
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
