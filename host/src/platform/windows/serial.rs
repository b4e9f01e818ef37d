//! Serial ports. Windows has no pseudo terminals.

use std::collections::BTreeMap;
use std::io::{self, ErrorKind, Read, Write};
use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};

use serialport::{COMPort, ClearBuffer, SerialPort, SerialPortBuilder};

/// Error numbers of a port whose device was unplugged: access denied, bad command, general
/// failure, no such device, operation aborted, device not connected.
pub const UNPLUGGED_ERRORS: [i32; 6] = [5, 22, 31, 433, 995, 1167];

/// Time between two checks for arrived bytes.
const POLL_INTERVAL: Duration = Duration::from_millis(1);

/// An open port; closed when dropped.
///
/// A read that blocks in the system would block every write through the same port, so a
/// read polls for arrived bytes.
pub struct Serial {
    port: COMPort,
    wait: Duration,
}

impl Serial {
    /// Opens a port exclusively.
    ///
    /// # Errors
    /// The port cannot be opened.
    pub fn open(builder: SerialPortBuilder) -> serialport::Result<Self> {
        let port = builder.open_native()?;
        let wait = port.timeout();
        Ok(Self { port, wait })
    }

    /// Returns another handle of the same port, for another thread.
    ///
    /// # Errors
    /// The system refuses.
    pub fn try_clone(&self) -> serialport::Result<Self> {
        let port = self.port.try_clone_native()?;
        let wait = self.wait;
        Ok(Self { port, wait })
    }

    /// Sets the time for which a read waits for its first byte. The limit of a write remains the
    /// one at opening.
    ///
    /// # Errors
    /// Never.
    pub fn set_timeout(&mut self, wait: Duration) -> serialport::Result<()> {
        self.wait = wait;
        Ok(())
    }

    /// Discards the bytes that have arrived and were not read; a failure is ignored.
    pub fn discard_received(&self) {
        let _ = self.port.clear(ClearBuffer::Input);
    }

    /// Returns the name of the port; `None` if it has none.
    pub fn name(&self) -> Option<String> {
        self.port.name()
    }
}

impl Read for Serial {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let begun = Instant::now();
        // A device that is gone answers no query.
        let gone = |error| io::Error::new(ErrorKind::BrokenPipe, error);
        while self.port.bytes_to_read().map_err(gone)? == 0 {
            if begun.elapsed() >= self.wait {
                return Err(ErrorKind::TimedOut.into());
            }
            thread::sleep(POLL_INTERVAL);
        }
        self.port.read(buffer)
    }
}

impl Write for Serial {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.port.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.port.flush()
    }
}

/// Returns whether the system can have serial ports.
pub const fn has_ports() -> bool {
    true
}

/// Returns `None`: Windows has no pseudo terminals.
pub const fn pseudo_terminal() -> Option<serialport::Result<(Serial, Serial)>> {
    None
}

/// Returns no names: a port keeps its number on Windows.
pub const fn persistent_names() -> BTreeMap<PathBuf, PathBuf> {
    BTreeMap::new()
}
