//! The connection to the process that holds a port: a page has neither.

use std::io::{self, ErrorKind, Read, Write};
use std::process::{Child, Command};
use std::time::Duration;

/// The program's end of the connection; it never exists on a page.
pub enum ToHolder {}

impl ToHolder {
    /// Refuses to start a holder.
    ///
    /// # Errors
    /// Always.
    pub fn start(_holder: Command) -> io::Result<(Child, Self)> {
        Err(ErrorKind::Unsupported.into())
    }

    /// Returns the bytes of the holder.
    ///
    /// # Errors
    /// The holder is gone.
    pub fn hear(&mut self, _within: Duration) -> io::Result<Vec<u8>> {
        match *self {}
    }

    /// Sends as many bytes as the connection takes now.
    ///
    /// # Errors
    /// The holder is gone.
    pub fn say(&mut self, _bytes: &[u8]) -> io::Result<usize> {
        match *self {}
    }

    /// Ends sending.
    pub fn hang_up(&mut self) {
        match *self {}
    }
}

/// The holder's end of the connection; it never exists on a page.
pub enum ToProgram {}

impl ToProgram {
    /// Refuses: a page has no standard input.
    ///
    /// # Errors
    /// Always.
    pub fn at_standard_input() -> io::Result<Self> {
        Err(ErrorKind::Unsupported.into())
    }

    /// Returns the same end for another thread.
    ///
    /// # Errors
    /// The system refuses.
    pub fn try_clone(&self) -> io::Result<Self> {
        match *self {}
    }

    /// Whether bytes of the program arrive within this time.
    ///
    /// # Errors
    /// An error of the system.
    pub fn has_said_within(&self, _time: Duration) -> io::Result<bool> {
        match *self {}
    }

    /// Whether the program is gone, even if some of its bytes are unread.
    pub fn is_gone(&self) -> bool {
        match *self {}
    }
}

impl Read for ToProgram {
    fn read(&mut self, _buffer: &mut [u8]) -> io::Result<usize> {
        match *self {}
    }
}

impl Write for ToProgram {
    fn write(&mut self, _bytes: &[u8]) -> io::Result<usize> {
        match *self {}
    }

    fn flush(&mut self) -> io::Result<()> {
        match *self {}
    }
}
