//! The process that holds a port: a page has neither.

use std::io::{self, ErrorKind, Read, Write};
use std::process::{Child, Command};
use std::time::Duration;

/// The program's end; there is none.
pub enum ToHolder {}

impl ToHolder {
    /// Never starts one.
    ///
    /// # Errors
    /// Always.
    pub fn start(_holder: Command) -> io::Result<(Child, Self)> {
        Err(ErrorKind::Unsupported.into())
    }

    /// What the holder says.
    ///
    /// # Errors
    /// It is gone.
    pub fn hear(&mut self, _within: Duration) -> io::Result<Vec<u8>> {
        match *self {}
    }

    /// Hands over as much as is taken now.
    ///
    /// # Errors
    /// The holder is gone.
    pub fn say(&mut self, _bytes: &[u8]) -> io::Result<usize> {
        match *self {}
    }

    /// Nothing more is said.
    pub fn hang_up(&mut self) {
        match *self {}
    }
}

/// The holder's end; there is none.
pub enum ToProgram {}

impl ToProgram {
    /// There is no standard input.
    ///
    /// # Errors
    /// Always.
    pub fn at_standard_input() -> io::Result<Self> {
        Err(ErrorKind::Unsupported.into())
    }

    /// The same for another thread.
    ///
    /// # Errors
    /// The system gives none.
    pub fn try_clone(&self) -> io::Result<Self> {
        match *self {}
    }

    /// Whether the program says something within this time.
    ///
    /// # Errors
    /// What the system says.
    pub fn has_said_within(&self, _time: Duration) -> io::Result<bool> {
        match *self {}
    }

    /// Whether the program is gone, whatever of it was not read yet.
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
