//! A virtual board behind a network address instead of a serial port, where there are
//! no pseudo terminals or the board is played on another computer.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream, ToSocketAddrs};
use std::thread;

use web_time::{Duration, Instant};

use super::{WAIT, closed, passes};

/// How such a port's name begins: `tcp:HOST:PORT`.
pub const PREFIX: &str = "tcp:";

/// How long a computer may take to answer.
const CONNECTS_WITHIN: Duration = Duration::from_secs(2);
/// Between two looks whether something has arrived.
const LOOK: Duration = Duration::from_millis(1);

/// A connection to whoever is at the other end.
pub struct Connection {
    stream: TcpStream,
    wait: Duration,
}

impl Connection {
    /// Connects with `HOST:PORT`.
    ///
    /// # Errors
    /// There is no such computer, or nobody listens there.
    pub fn open(address: &str) -> io::Result<Self> {
        let mut refused = ErrorKind::AddrNotAvailable.into();
        for address in address.to_socket_addrs()? {
            match TcpStream::connect_timeout(&address, CONNECTS_WITHIN) {
                Ok(stream) => return Self::of(stream),
                Err(error) => refused = error,
            }
        }
        Err(refused)
    }

    fn of(stream: TcpStream) -> io::Result<Self> {
        stream.set_nodelay(true)?;
        stream.set_nonblocking(true)?;
        Ok(Self { stream, wait: WAIT })
    }

    /// The same connection for somebody who waits so long for the first byte.
    ///
    /// # Errors
    /// The system gives none.
    pub fn reading(&self, wait: Duration) -> io::Result<Self> {
        let stream = self.stream.try_clone()?;
        Ok(Self { stream, wait })
    }
}

impl Read for Connection {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let begun = Instant::now();
        loop {
            match self.stream.read(buffer) {
                Err(error) if !passes(&error) => return Err(closed()),
                Err(_) if begun.elapsed() < self.wait => thread::sleep(LOOK),
                result => return result,
            }
        }
    }
}

impl Write for Connection {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.stream.write(bytes) {
            Err(error) if !passes(&error) => Err(closed()),
            result => result,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

/// Where a virtual board is offered: one partner at a time, the next one when it is gone.
pub struct Offer {
    listener: TcpListener,
    partner: Option<Connection>,
}

impl Offer {
    /// Listens at `HOST:PORT`; at port 0 the system chooses one.
    ///
    /// # Errors
    /// The address is none of this computer, or is in use.
    pub fn listen(address: &str) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self {
            listener,
            partner: None,
        })
    }

    /// The name of the port for whoever opens it.
    ///
    /// # Errors
    /// The system does not tell.
    pub fn name(&self) -> io::Result<String> {
        Ok(format!("{PREFIX}{}", self.listener.local_addr()?))
    }

    /// What the partner says; empty when there is none or it said nothing for 2 ms.
    ///
    /// # Errors
    /// The system lets nobody in.
    pub fn read(&mut self) -> io::Result<Vec<u8>> {
        let Some(partner) = self.partner()? else {
            thread::sleep(WAIT);
            return Ok(Vec::new());
        };
        let mut buffer = [0; 4096];
        match partner.read(&mut buffer) {
            Err(error) if passes(&error) => Ok(Vec::new()),
            Ok(count) if count > 0 => Ok(buffer[..count].to_vec()),
            _ => {
                self.partner = None;
                Ok(Vec::new())
            }
        }
    }

    /// Says something to the partner; without one it is lost, as on a wire.
    pub fn write(&mut self, mut bytes: &[u8]) {
        while let Some(partner) = &mut self.partner
            && !bytes.is_empty()
        {
            match partner.write(bytes) {
                Ok(count) => bytes = &bytes[count..],
                Err(error) if passes(&error) => thread::sleep(LOOK),
                Err(_) => self.partner = None,
            }
        }
    }

    fn partner(&mut self) -> io::Result<Option<&mut Connection>> {
        if self.partner.is_none() {
            self.partner = match self.listener.accept() {
                Ok((stream, _)) => Some(Connection::of(stream)?),
                Err(error) if passes(&error) => None,
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
        let mut offer = Offer::listen("127.0.0.1:0").unwrap();
        let name = offer.name().unwrap();
        for word in [b"one", b"two"] {
            let mut partner = Connection::open(name.strip_prefix(PREFIX).unwrap()).unwrap();
            partner.write_all(word).unwrap();
            let mut heard = Vec::new();
            while heard.len() < word.len() {
                heard.extend(offer.read().unwrap());
            }
            assert_eq!(heard, word);
            offer.write(b"ok");
            let mut answer = [0; 2];
            let mut reading = partner.reading(Duration::from_secs(10)).unwrap();
            assert_eq!(reading.read(&mut answer).unwrap(), 2);
            drop((partner, reading));
            while offer.partner.is_some() {
                assert!(offer.read().unwrap().is_empty());
            }
        }
    }

    #[test]
    fn an_end_that_has_gone_is_told() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let mut connection = Connection::open(&address).unwrap();
        drop(listener.accept().unwrap());
        let mut reading = connection.reading(Duration::from_secs(10)).unwrap();
        assert!(!matches!(reading.read(&mut [0; 9]), Ok(1..)));
        drop(listener);
        assert!(Connection::open(&address).is_err());
        // Said into the void once or twice, then refused.
        let refused = (0..1000).any(|_| {
            thread::sleep(LOOK);
            connection.write(b"?").is_err()
        });
        assert!(refused);
    }
}
