//! Moves bytes between the kernel and a port in a separate thread, so that the kernel
//! never waits for a port.

use std::io;
use std::thread;

use crossbeam::channel::{Receiver, Sender, TryRecvError, bounded};
use gsk_messages::Message;
use web_time::Duration;

use super::SerialEnd;
use crate::ports::{self, OfferedPort, Port, PortError};

/// Capacity of the queues between kernel and port, chunks in each direction.
const QUEUE_CAPACITY: usize = 64;
/// Time between two attempts to open a port.
const RETRY_INTERVAL: Duration = Duration::from_secs(1);
/// Time between two checks whether the program still runs, while the port is not open.
const CHECK_INTERVAL: Duration = Duration::from_millis(20);
/// Time for which opening a port that was closed to change its baud rate is retried.
const OPEN_RETRY_TIME: Duration = Duration::from_millis(500);

/// An event that the port's thread reports to the kernel.
pub(super) enum SerialPortEvent {
    /// The port is open under this name.
    Opened(String),
    /// The port cannot be opened or has failed for this reason; the thread tries again.
    Gone(Message),
    Bytes(Vec<u8>),
}

/// A command that the kernel sends to the port's thread.
enum SerialPortCommand {
    Bytes(Vec<u8>),
    /// Use this rate for further bytes, bits per second.
    Rate(u32),
}

/// The kernel's connection to the port's thread.
#[derive(Debug)]
pub(super) struct SerialPortHandle {
    to_port: Sender<SerialPortCommand>,
    from_port: Receiver<SerialPortEvent>,
}

impl SerialPortHandle {
    /// Starts the thread, which opens the port once the rate is set. Returns an error if the system
    /// starts no thread.
    pub(super) fn open(end: SerialEnd) -> io::Result<Self> {
        let (to_port, commands) = bounded(QUEUE_CAPACITY);
        let (events, from_port) = bounded(QUEUE_CAPACITY);
        let mut port_thread = SerialPortThread {
            end,
            commands,
            events,
            baud: None,
            unsent: Vec::new(),
            last_error: None,
        };
        thread::Builder::new()
            .name("serial".to_owned())
            .spawn(move || while port_thread.run().is_some() {})?;
        Ok(Self { to_port, from_port })
    }

    /// Sets the rate of the port, bits per second.
    pub(super) fn set_rate(&self, baud: u32) {
        // The thread empties the queue, or has ended.
        let _ = self.to_port.send(SerialPortCommand::Rate(baud));
    }

    /// Queues bytes to be sent; returns the number of bytes that the queue accepts now.
    pub(super) fn send(&self, bytes: &[u8]) -> usize {
        match self
            .to_port
            .try_send(SerialPortCommand::Bytes(bytes.to_vec()))
        {
            Ok(()) => bytes.len(),
            Err(_) => 0,
        }
    }

    /// Returns the next event; `None` if there is none now.
    pub(super) fn next_event(&self) -> Option<SerialPortEvent> {
        self.from_port.try_recv().ok()
    }
}

/// The opened port or offered address at the end of the line.
enum OpenEnd {
    Port(Port),
    Offer(OfferedPort),
}

impl OpenEnd {
    fn read(&mut self) -> io::Result<Vec<u8>> {
        match self {
            Self::Port(port) => port.read(),
            Self::Offer(offer) => offer.read(),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Port(port) => port.write(bytes),
            Self::Offer(offer) => offer.write_some(bytes),
        }
    }
}

/// The state of the thread that moves the bytes of the port.
struct SerialPortThread {
    end: SerialEnd,
    commands: Receiver<SerialPortCommand>,
    events: Sender<SerialPortEvent>,
    baud: Option<u32>,
    /// Bytes that wait until the port accepts them.
    unsent: Vec<u8>,
    /// The last reported reason why the port is not open; `None` without one.
    last_error: Option<Message>,
}

impl SerialPortThread {
    /// Opens the port and moves bytes until the port is gone or gets another rate; `None` if
    /// the program has ended.
    fn run(&mut self) -> Option<()> {
        self.unsent.clear();
        let mut line = loop {
            let Some(baud) = self.baud else {
                self.wait(CHECK_INTERVAL)?;
                continue;
            };
            match self.open(baud) {
                Ok((line, name)) => {
                    self.last_error = None;
                    self.events.send(SerialPortEvent::Opened(name)).ok()?;
                    break line;
                }
                Err(error) => {
                    let message = error.message();
                    if self.last_error.as_ref() != Some(&message) {
                        self.last_error = Some(message.clone());
                        self.events.send(SerialPortEvent::Gone(message)).ok()?;
                    }
                    self.wait(RETRY_INTERVAL)?;
                }
            }
        };
        let baud = self.baud;
        loop {
            self.receive_commands()?;
            // An offered end has the rate of the program that opens it.
            if self.baud != baud && matches!(line, OpenEnd::Port(_)) {
                return Some(());
            }
            let done = line.write(&self.unsent).and_then(|taken| {
                self.unsent.drain(..taken);
                line.read()
            });
            match done {
                Ok(bytes) if bytes.is_empty() => {}
                Ok(bytes) => self.events.send(SerialPortEvent::Bytes(bytes)).ok()?,
                Err(error) => {
                    let message = ports::failure_message(&error);
                    self.last_error = Some(message.clone());
                    self.events.send(SerialPortEvent::Gone(message)).ok()?;
                    return self.wait(RETRY_INTERVAL);
                }
            }
        }
    }

    fn open(&self, baud: u32) -> Result<(OpenEnd, String), PortError> {
        let offered = |offer: OfferedPort| {
            let name = offer.name()?;
            Ok((OpenEnd::Offer(offer), name))
        };
        match &self.end {
            SerialEnd::Port(name) => {
                let port = Port::open_with_retry(name, baud, OPEN_RETRY_TIME)?;
                Ok((OpenEnd::Port(port), name.clone()))
            }
            SerialEnd::Terminal => offered(OfferedPort::open(None)?),
            SerialEnd::Listening(address) => offered(OfferedPort::open(Some(address))?),
        }
    }

    /// Carries out commands until the queue is empty or the port has bytes left to write;
    /// `None` if the program has ended.
    fn receive_commands(&mut self) -> Option<()> {
        while self.unsent.is_empty() {
            match self.commands.try_recv() {
                Ok(SerialPortCommand::Bytes(bytes)) => self.unsent = bytes,
                Ok(SerialPortCommand::Rate(baud)) => self.baud = Some(baud),
                Err(TryRecvError::Empty) => return Some(()),
                Err(TryRecvError::Disconnected) => return None,
            }
        }
        Some(())
    }

    /// Waits for the time `time` while the port is not open; bytes to send are lost, as with
    /// an unplugged cable. `None` if the program has ended.
    fn wait(&mut self, time: Duration) -> Option<()> {
        let mut waited = Duration::ZERO;
        while waited < time {
            loop {
                match self.commands.try_recv() {
                    Ok(SerialPortCommand::Bytes(_)) => {}
                    Ok(SerialPortCommand::Rate(baud)) => self.baud = Some(baud),
                    Err(TryRecvError::Empty) => break,
                    Err(TryRecvError::Disconnected) => return None,
                }
            }
            thread::sleep(CHECK_INTERVAL);
            waited += CHECK_INTERVAL;
        }
        Some(())
    }
}
