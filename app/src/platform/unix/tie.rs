//! A pair of sockets between the program and the holder of its port; the holder has
//! its end as standard input.

use std::io::{self, ErrorKind, Read, Write};
use std::net::Shutdown;
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

/// Bytes that are read at once.
const AT_ONCE: usize = 4096;

/// The program's end.
pub struct ToHolder(UnixStream);

impl ToHolder {
    /// Starts the holder, apart from the program's terminal: Ctrl-C there is for the
    /// program.
    ///
    /// # Errors
    /// What the system says.
    pub fn start(mut holder: Command) -> io::Result<(Child, Self)> {
        let (near, far) = UnixStream::pair()?;
        near.set_nonblocking(true)?;
        let child = holder
            .arg0("gsk980td")
            .stdin(Stdio::from(OwnedFd::from(far)))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .process_group(0)
            .spawn()?;
        Ok((child, Self(near)))
    }

    /// What the holder says, when it says something within this time; else nothing.
    ///
    /// # Errors
    /// It is gone.
    pub fn hear(&mut self, within: Duration) -> io::Result<Vec<u8>> {
        let mut look = [PollFd::from_borrowed_fd(self.0.as_fd(), PollFlags::IN)];
        let within = Timespec::try_from(within).map_err(io::Error::other)?;
        match poll(&mut look, Some(&within)) {
            Ok(0) | Err(Errno::INTR) => return Ok(Vec::new()),
            Ok(_) => {}
            Err(error) => return Err(error.into()),
        }
        let mut buffer = [0; AT_ONCE];
        match self.0.read(&mut buffer) {
            Ok(0) => Err(ErrorKind::UnexpectedEof.into()),
            Ok(count) => Ok(buffer[..count].to_vec()),
            Err(error) if passes(&error) => Ok(Vec::new()),
            Err(error) => Err(error),
        }
    }

    /// Hands over as much as is taken now.
    ///
    /// # Errors
    /// The holder is gone.
    pub fn say(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.write(bytes) {
            Err(error) if passes(&error) => Ok(0),
            result => result,
        }
    }

    /// Nothing more is said.
    pub fn hang_up(&mut self) {
        // Behind the holder's end it changes nothing.
        let _ = self.0.shutdown(Shutdown::Write);
    }
}

/// Whether the socket is only busy.
fn passes(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

/// The holder's end.
pub struct ToProgram(UnixStream);

impl ToProgram {
    /// The program that has started this process.
    ///
    /// # Errors
    /// Standard input is no such program.
    pub fn at_standard_input() -> io::Result<Self> {
        let stream = UnixStream::from(io::stdin().as_fd().try_clone_to_owned()?);
        stream.local_addr()?;
        Ok(Self(stream))
    }

    /// The same for another thread.
    ///
    /// # Errors
    /// The system gives none.
    pub fn try_clone(&self) -> io::Result<Self> {
        self.0.try_clone().map(Self)
    }

    /// Whether the program says something within this time, or is gone.
    ///
    /// # Errors
    /// What the system says.
    pub fn has_said_within(&self, time: Duration) -> io::Result<bool> {
        let mut look = [PollFd::from_borrowed_fd(self.0.as_fd(), PollFlags::IN)];
        let time = Timespec::try_from(time).map_err(io::Error::other)?;
        match poll(&mut look, Some(&time)) {
            Ok(count) => Ok(count > 0),
            Err(Errno::INTR) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    /// Whether the program is gone, whatever of it was not read yet.
    pub fn is_gone(&self) -> bool {
        let mut look = [PollFd::from_borrowed_fd(self.0.as_fd(), PollFlags::empty())];
        poll(&mut look, Some(&Timespec::default())).is_ok()
            && look[0].revents().contains(PollFlags::HUP)
    }
}

impl Read for ToProgram {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl Write for ToProgram {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}
