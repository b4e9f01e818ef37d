//! A pair of sockets between the program and the holder of its port; the holder has its
//! end as standard input.

use std::io::{self, ErrorKind, Read, Write};
use std::net::Shutdown;
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

/// Greatest number of bytes of one read.
const READ_BYTES: usize = 4096;

/// The program's end of the connection to the holder process.
pub struct HolderConnection(UnixStream);

impl HolderConnection {
    /// Starts the holder in a separate process group: Ctrl-C in the terminal goes to the
    /// program only.
    ///
    /// # Errors
    /// An error of the system.
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

    /// Returns the bytes of the holder that arrive within this time, or none.
    ///
    /// # Errors
    /// The holder is gone.
    pub fn receive(&mut self, within: Duration) -> io::Result<Vec<u8>> {
        let mut look = [PollFd::from_borrowed_fd(self.0.as_fd(), PollFlags::IN)];
        let within = Timespec::try_from(within).map_err(io::Error::other)?;
        match poll(&mut look, Some(&within)) {
            Ok(0) | Err(Errno::INTR) => return Ok(Vec::new()),
            Ok(_) => {}
            Err(error) => return Err(error.into()),
        }
        let mut buffer = [0; READ_BYTES];
        match self.0.read(&mut buffer) {
            Ok(0) => Err(ErrorKind::UnexpectedEof.into()),
            Ok(count) => Ok(buffer[..count].to_vec()),
            Err(error) if is_busy(&error) => Ok(Vec::new()),
            Err(error) => Err(error),
        }
    }

    /// Sends as many bytes to the holder as the connection accepts now; returns their number.
    ///
    /// # Errors
    /// The holder is gone.
    pub fn send(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.write(bytes) {
            Err(error) if is_busy(&error) => Ok(0),
            result => result,
        }
    }

    /// Closes the sending direction: the holder then knows that the program is gone.
    pub fn end_sending(&mut self) {
        // A holder that has ended needs no shutdown.
        let _ = self.0.shutdown(Shutdown::Write);
    }
}

/// Whether an error only means that the socket is busy.
fn is_busy(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

/// The holder process's end of the connection to the program.
pub struct ProgramConnection(UnixStream);

impl ProgramConnection {
    /// Connects to the program that has started this process.
    ///
    /// # Errors
    /// Standard input is not connected to the program.
    pub fn from_standard_input() -> io::Result<Self> {
        let stream = UnixStream::from(io::stdin().as_fd().try_clone_to_owned()?);
        stream.local_addr()?;
        Ok(Self(stream))
    }

    /// Returns another handle of the same end, for another thread.
    ///
    /// # Errors
    /// The system refuses.
    pub fn try_clone(&self) -> io::Result<Self> {
        self.0.try_clone().map(Self)
    }

    /// Whether bytes of the program arrive within this time, or it is gone.
    ///
    /// # Errors
    /// An error of the system.
    pub fn has_bytes_within(&self, time: Duration) -> io::Result<bool> {
        let mut look = [PollFd::from_borrowed_fd(self.0.as_fd(), PollFlags::IN)];
        let time = Timespec::try_from(time).map_err(io::Error::other)?;
        match poll(&mut look, Some(&time)) {
            Ok(count) => Ok(count > 0),
            Err(Errno::INTR) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    /// Whether the program is gone, even if some of its bytes are unread.
    pub fn is_gone(&self) -> bool {
        let mut look = [PollFd::from_borrowed_fd(self.0.as_fd(), PollFlags::empty())];
        poll(&mut look, Some(&Timespec::default())).is_ok()
            && look[0].revents().contains(PollFlags::HUP)
    }
}

impl Read for ProgramConnection {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl Write for ProgramConnection {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}
