//! Serial ports: a page has none.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::path::PathBuf;
use std::time::Duration;

use serialport::{Error, ErrorKind, SerialPortBuilder};

/// Error numbers of a port whose device was unplugged; a page has no ports.
pub const UNPLUGGED_ERRORS: [i32; 0] = [];

/// A serial port, which never exists on a page.
pub enum Serial {}

impl Serial {
    /// Does not open a port, because a page has none.
    ///
    /// # Errors
    ///
    /// Always returns an error.
    pub fn open(_builder: SerialPortBuilder) -> serialport::Result<Self> {
        let none = io::Error::from(io::ErrorKind::Unsupported);
        Err(Error::new(ErrorKind::NoDevice, none.to_string()))
    }

    /// Returns the same port for another thread; never called.
    ///
    /// # Errors
    /// The system refuses.
    pub fn try_clone(&self) -> serialport::Result<Self> {
        match *self {}
    }

    /// Sets the time for which a read and a write wait; never called.
    ///
    /// # Errors
    /// The port refuses it.
    pub fn set_timeout(&mut self, _wait: Duration) -> serialport::Result<()> {
        match *self {}
    }

    /// Discards the bytes that were not read; never called.
    pub fn discard_received(&self) {
        match *self {}
    }

    /// Returns the name of the port; `None` if it has none. Never called.
    pub fn name(&self) -> Option<String> {
        match *self {}
    }
}

impl Read for Serial {
    fn read(&mut self, _buffer: &mut [u8]) -> io::Result<usize> {
        match *self {}
    }
}

impl Write for Serial {
    fn write(&mut self, _bytes: &[u8]) -> io::Result<usize> {
        match *self {}
    }

    fn flush(&mut self) -> io::Result<()> {
        match *self {}
    }
}

/// Returns `None`: a page has no pseudo terminals.
pub const fn pseudo_terminal() -> Option<serialport::Result<(Serial, Serial)>> {
    None
}

/// Returns no names: a page has no ports.
pub const fn persistent_names() -> BTreeMap<PathBuf, PathBuf> {
    BTreeMap::new()
}

/// Returns false: a page has no ports.
pub const fn has_ports() -> bool {
    false
}
