//! The connection to the process that holds a port: a page has neither.

use std::io::{self, ErrorKind, Read, Write};
use std::process::{Child, Command};
use std::time::Duration;

/// The program's end of the connection; it never exists on a page.
pub enum HolderConnection {}

impl HolderConnection {
    /// Does not start a holder process, because a page has none.
    ///
    /// # Errors
    ///
    /// Always returns an error.
    pub fn start(_holder: Command) -> io::Result<(Child, Self)> {
        Err(ErrorKind::Unsupported.into())
    }

    /// Returns the bytes of the holder; never called.
    ///
    /// # Errors
    /// The holder is gone.
    pub fn receive(&mut self, _within: Duration) -> io::Result<Vec<u8>> {
        match *self {}
    }

    /// Sends bytes to the holder; never called.
    ///
    /// # Errors
    /// The holder is gone.
    pub fn send(&mut self, _bytes: &[u8]) -> io::Result<usize> {
        match *self {}
    }

    /// Closes the sending direction; never called.
    pub fn end_sending(&mut self) {
        match *self {}
    }
}

/// The holder's end of the connection; it never exists on a page.
pub enum ProgramConnection {}

impl ProgramConnection {
    /// Refuses: a page has no standard input.
    ///
    /// # Errors
    /// Always.
    pub fn from_standard_input() -> io::Result<Self> {
        Err(ErrorKind::Unsupported.into())
    }

    /// Returns the same end for another thread; never called.
    ///
    /// # Errors
    /// The system refuses.
    pub fn try_clone(&self) -> io::Result<Self> {
        match *self {}
    }

    /// Whether bytes of the program arrive; never called.
    ///
    /// # Errors
    /// An error of the system.
    pub fn has_bytes_within(&self, _time: Duration) -> io::Result<bool> {
        match *self {}
    }

    /// Whether the program is gone; never called.
    pub fn is_gone(&self) -> bool {
        match *self {}
    }
}

impl Read for ProgramConnection {
    fn read(&mut self, _buffer: &mut [u8]) -> io::Result<usize> {
        match *self {}
    }
}

impl Write for ProgramConnection {
    fn write(&mut self, _bytes: &[u8]) -> io::Result<usize> {
        match *self {}
    }

    fn flush(&mut self) -> io::Result<()> {
        match *self {}
    }
}
