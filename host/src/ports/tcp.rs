//! Network connections instead of serial ports: for a virtual board on a system without pseudo
//! terminals, and for boards on another computer.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream, ToSocketAddrs};
use std::thread;

use web_time::{Duration, Instant};

use super::{IO_TIMEOUT, closed_error, is_transient};

/// Prefix of the name of a network port: `tcp:HOST:PORT`.
pub const PREFIX: &str = "tcp:";

/// Longest time within which a computer must answer a connection request.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(2);
/// Time between two checks for arrived bytes.
const POLL_INTERVAL: Duration = Duration::from_millis(1);

/// A network connection to the program at the other end.
pub struct TcpConnection {
    stream: TcpStream,
    wait: Duration,
}

impl TcpConnection {
    /// Connects to the program that listens at `HOST:PORT`.
    ///
    /// # Errors
    /// The computer does not exist, or no program listens there.
    pub fn open(address: &str) -> io::Result<Self> {
        let mut refused = ErrorKind::AddrNotAvailable.into();
        for address in address.to_socket_addrs()? {
            match TcpStream::connect_timeout(&address, CONNECT_TIMEOUT) {
                Ok(stream) => return Self::from_stream(stream),
                Err(error) => refused = error,
            }
        }
        Err(refused)
    }

    fn from_stream(stream: TcpStream) -> io::Result<Self> {
        stream.set_nodelay(true)?;
        stream.set_nonblocking(true)?;
        Ok(Self {
            stream,
            wait: IO_TIMEOUT,
        })
    }

    /// Returns another handle of the same connection, for a reader that waits for the time `wait`
    /// for the first byte.
    ///
    /// # Errors
    /// The operating system refuses it.
    pub fn clone_for_reading(&self, wait: Duration) -> io::Result<Self> {
        let stream = self.stream.try_clone()?;
        Ok(Self { stream, wait })
    }
}

impl Read for TcpConnection {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let begun = Instant::now();
        loop {
            match self.stream.read(buffer) {
                Err(error) if !is_transient(&error) => return Err(closed_error()),
                Err(_) if begun.elapsed() < self.wait => thread::sleep(POLL_INTERVAL),
                result => return result,
            }
        }
    }
}

impl Write for TcpConnection {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.stream.write(bytes) {
            Err(error) if !is_transient(&error) => Err(closed_error()),
            result => result,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

/// A listener that offers a virtual board to one partner at a time, and to the next one when
/// that partner is gone.
pub struct TcpOffer {
    listener: TcpListener,
    partner: Option<TcpConnection>,
}

impl TcpOffer {
    /// Listens at `HOST:PORT`; with port 0 the system chooses one.
    ///
    /// # Errors
    /// The address does not belong to this computer, or is in use.
    pub fn listen(address: &str) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self {
            listener,
            partner: None,
        })
    }

    /// Returns the name of the port, `tcp:HOST:PORT`, under which another program opens it.
    ///
    /// # Errors
    /// The operating system does not report the address.
    pub fn name(&self) -> io::Result<String> {
        Ok(format!("{PREFIX}{}", self.listener.local_addr()?))
    }

    /// Returns the bytes of the partner that have arrived. Waits 2 ms for the first one; returns an
    /// empty vector if none arrives or no partner is connected.
    ///
    /// # Errors
    /// The operating system accepts no connection.
    pub fn read(&mut self) -> io::Result<Vec<u8>> {
        let Some(partner) = self.accept_partner()? else {
            thread::sleep(IO_TIMEOUT);
            return Ok(Vec::new());
        };
        let mut buffer = [0; 4096];
        match partner.read(&mut buffer) {
            Err(error) if is_transient(&error) => Ok(Vec::new()),
            Ok(count) if count > 0 => Ok(buffer[..count].to_vec()),
            _ => {
                self.partner = None;
                Ok(Vec::new())
            }
        }
    }

    /// Writes bytes to the partner; without a partner they are lost, as on a wire.
    pub fn write(&mut self, mut bytes: &[u8]) {
        while let Some(partner) = &mut self.partner
            && !bytes.is_empty()
        {
            match partner.write(bytes) {
                Ok(count) => bytes = &bytes[count..],
                Err(error) if is_transient(&error) => thread::sleep(POLL_INTERVAL),
                Err(_) => self.partner = None,
            }
        }
    }

    fn accept_partner(&mut self) -> io::Result<Option<&mut TcpConnection>> {
        if self.partner.is_none() {
            self.partner = match self.listener.accept() {
                Ok((stream, _)) => Some(TcpConnection::from_stream(stream)?),
                Err(error) if is_transient(&error) => None,
                Err(error) => return Err(error),
            };
        }
        Ok(self.partner.as_mut())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_partner_that_has_gone_makes_room_for_the_next_one() {
        let mut offer = TcpOffer::listen("127.0.0.1:0").unwrap();
        let name = offer.name().unwrap();
        for word in [b"one", b"two"] {
            let mut partner = TcpConnection::open(name.strip_prefix(PREFIX).unwrap()).unwrap();
            partner.write_all(word).unwrap();
            let mut received = Vec::new();
            while received.len() < word.len() {
                received.extend(offer.read().unwrap());
            }
            assert_eq!(received, word);
            offer.write(b"ok");
            let mut answer = [0; 2];
            let mut reading = partner.clone_for_reading(Duration::from_secs(10)).unwrap();
            assert_eq!(reading.read(&mut answer).unwrap(), 2);
            drop((partner, reading));
            while offer.partner.is_some() {
                assert!(offer.read().unwrap().is_empty());
            }
        }
    }

    #[test]
    fn an_end_that_has_gone_is_reported() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let mut connection = TcpConnection::open(&address).unwrap();
        drop(listener.accept().unwrap());
        let mut reading = connection
            .clone_for_reading(Duration::from_secs(10))
            .unwrap();
        assert!(!matches!(reading.read(&mut [0; 9]), Ok(1..)));
        drop(listener);
        assert!(TcpConnection::open(&address).is_err());
        // The system takes one or two writes without a receiver before it refuses.
        let refused = (0..1000).any(|_| {
            thread::sleep(POLL_INTERVAL);
            connection.write(b"?").is_err()
        });
        assert!(refused);
    }
}
