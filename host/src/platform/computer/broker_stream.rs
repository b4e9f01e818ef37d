//! The connection to a broker: TCP, with TLS if the address requests it.

use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpStream, ToSocketAddrs};

use gsk_messages::say;
use gsk_telemetry::{BrokerTransport, BrokerUrl};
use web_time::Duration;

use super::tls::{TlsSession, is_timeout};
use crate::platform::{BrokerBytes, BrokerFailure};

/// Longest time of an attempt to connect to one of the addresses of a name.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(2);
/// Longest time for which a slow broker takes no bytes.
const WRITE_TIMEOUT: Duration = Duration::from_secs(5);

/// An open connection. The TLS handshake takes place while bytes are read and written.
#[derive(Debug)]
pub struct BrokerStream {
    stream: TcpStream,
    /// `None` without encryption.
    tls: Option<TlsSession>,
}

impl BrokerStream {
    /// Connects to a broker. Reads wait at most `poll_interval`. `before_attempt` is called before
    /// each address of its name.
    ///
    /// # Errors
    /// The broker is not reached, or TLS cannot be set up.
    pub fn open(
        url: &BrokerUrl,
        poll_interval: Duration,
        mut before_attempt: impl FnMut(),
    ) -> Result<Self, BrokerFailure> {
        let tls = match url.transport {
            BrokerTransport::Tcp => None,
            BrokerTransport::Tls => Some(TlsSession::new(url)?),
            BrokerTransport::WebSocket | BrokerTransport::SecureWebSocket => {
                return Err(say::mqtt_web_socket_on_computer().into());
            }
        };
        let addresses = (url.host.as_str(), url.port).to_socket_addrs();
        let mut error = io::Error::from(io::ErrorKind::AddrNotAvailable);
        for address in addresses? {
            before_attempt();
            match TcpStream::connect_timeout(&address, CONNECT_TIMEOUT) {
                Ok(stream) => {
                    let set_up = stream
                        .set_nodelay(true)
                        .and_then(|()| stream.set_read_timeout(Some(poll_interval)))
                        .and_then(|()| stream.set_write_timeout(Some(WRITE_TIMEOUT)));
                    set_up?;
                    return Ok(Self { stream, tls });
                }
                Err(failed) => error = failed,
            }
        }
        Err(error.into())
    }

    /// Whether the broker can receive bytes: always without TLS, with it after the handshake.
    pub fn is_established(&self) -> bool {
        self.tls.as_ref().is_none_or(TlsSession::is_established)
    }

    /// Reads what the broker has sent, and waits for it at most the poll interval.
    ///
    /// # Errors
    /// The connection is lost, or TLS refuses the broker.
    pub fn read(&mut self, buffer: &mut [u8]) -> Result<BrokerBytes, BrokerFailure> {
        if let Some(tls) = &mut self.tls {
            return tls.read(&mut self.stream, buffer);
        }
        match self.stream.read(buffer) {
            Ok(0) => Ok(BrokerBytes::Closed),
            Ok(count) => Ok(BrokerBytes::Received(count)),
            Err(error) if is_timeout(&error) => Ok(BrokerBytes::Received(0)),
            Err(error) => Err(error.into()),
        }
    }

    /// Writes bytes; those before the end of a handshake are sent after it.
    ///
    /// # Errors
    /// The connection is lost.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), BrokerFailure> {
        match &mut self.tls {
            Some(tls) => tls.write(&mut self.stream, bytes),
            None => {
                self.stream.write_all(bytes)?;
                Ok(())
            }
        }
    }

    /// Closes the connection after everything that was written.
    pub fn close(mut self) {
        if let Some(tls) = &mut self.tls {
            tls.close(&mut self.stream);
        }
        // A broker that is gone has closed it before.
        let _ = self.stream.shutdown(Shutdown::Write);
    }
}
