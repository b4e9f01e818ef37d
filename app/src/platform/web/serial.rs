//! Serial ports: a page has none.

use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::path::PathBuf;
use std::time::Duration;

use serialport::{Error, ErrorKind, SerialPortBuilder};

/// There is no port that could be pulled.
pub const PULLED: [i32; 0] = [];

/// An open port; there is none.
pub enum Serial {}

impl Serial {
    /// Opens none.
    ///
    /// # Errors
    /// Always.
    pub fn open(_builder: SerialPortBuilder) -> serialport::Result<Self> {
        let none = io::Error::from(io::ErrorKind::Unsupported);
        Err(Error::new(ErrorKind::NoDevice, none.to_string()))
    }

    /// The same port for another thread.
    ///
    /// # Errors
    /// The system gives none.
    pub fn try_clone(&self) -> serialport::Result<Self> {
        match *self {}
    }

    /// From now on a read waits so long for the first byte, and a write for room.
    ///
    /// # Errors
    /// The port does not take it.
    pub fn wait_so_long(&mut self, _wait: Duration) -> serialport::Result<()> {
        match *self {}
    }

    /// What has arrived and was not read is thrown away.
    pub fn forget_arrived(&self) {
        match *self {}
    }

    /// Its name.
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

/// There are no pseudo terminals.
pub const fn pseudo_terminal() -> Option<serialport::Result<(Serial, Serial)>> {
    None
}

/// There are no ports.
pub const fn unchanging_names() -> BTreeMap<PathBuf, PathBuf> {
    BTreeMap::new()
}

/// Whether there can be ports: a page has none.
pub const fn has_ports() -> bool {
    false
}
