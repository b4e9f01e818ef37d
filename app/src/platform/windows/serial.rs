//! Serial ports. There are no pseudo terminals.

use std::collections::BTreeMap;
use std::io::{self, ErrorKind, Read, Write};
use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};

use serialport::{COMPort, ClearBuffer, SerialPort, SerialPortBuilder};

/// Numbers of the system's errors when the device behind a port is no more: access
/// denied, bad command, general failure, no such device, operation aborted, device not
/// connected.
pub const PULLED: [i32; 6] = [5, 22, 31, 433, 995, 1167];

/// Between two looks whether something has arrived.
const LOOK: Duration = Duration::from_millis(1);

/// An open port; closed when dropped.
///
/// A read that waits in the system would hold up every write through the same port:
/// who waits looks again and again whether something has arrived.
pub struct Serial {
    port: COMPort,
    wait: Duration,
}

impl Serial {
    /// Opens a port for itself alone.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn open(builder: SerialPortBuilder) -> serialport::Result<Self> {
        let port = builder.open_native()?;
        let wait = port.timeout();
        Ok(Self { port, wait })
    }

    /// The same port for another thread.
    ///
    /// # Errors
    /// The system gives none.
    pub fn try_clone(&self) -> serialport::Result<Self> {
        let port = self.port.try_clone_native()?;
        let wait = self.wait;
        Ok(Self { port, wait })
    }

    /// From now on a read waits so long for the first byte. How long a write waits for
    /// room stays as it was when the port was opened.
    ///
    /// # Errors
    /// None here.
    pub fn wait_so_long(&mut self, wait: Duration) -> serialport::Result<()> {
        self.wait = wait;
        Ok(())
    }

    /// What has arrived and was not read is thrown away; a port that keeps it is used
    /// all the same.
    pub fn forget_arrived(&self) {
        let _ = self.port.clear(ClearBuffer::Input);
    }

    /// Its name.
    pub fn name(&self) -> Option<String> {
        self.port.name()
    }
}

impl Read for Serial {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let begun = Instant::now();
        // Of a device that is gone nothing can be asked.
        let gone = |error| io::Error::new(ErrorKind::BrokenPipe, error);
        while self.port.bytes_to_read().map_err(gone)? == 0 {
            if begun.elapsed() >= self.wait {
                return Err(ErrorKind::TimedOut.into());
            }
            thread::sleep(LOOK);
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

/// Whether there can be ports.
pub const fn has_ports() -> bool {
    true
}

/// Both ends of a pseudo terminal: Windows has none.
pub const fn pseudo_terminal() -> Option<serialport::Result<(Serial, Serial)>> {
    None
}

/// Ports and the unchanging names that point to them: a port keeps its number by itself.
pub const fn unchanging_names() -> BTreeMap<PathBuf, PathBuf> {
    BTreeMap::new()
}
