//! Moves bytes between the kernel and a port in a separate thread, so that the kernel
//! never waits for a port.

use std::io;
use std::thread;

use crossbeam::channel::{Receiver, Sender, TryRecvError, bounded};
use gsk_messages::Message;
use web_time::Duration;

use super::End;
use crate::ports::{self, Offer, Port, PortError};

/// Capacity of the queues, chunks in each direction.
const QUEUE: usize = 64;
/// Time between two attempts to open a port.
const AGAIN: Duration = Duration::from_secs(1);
/// Time between two checks whether the program still runs.
const LOOK: Duration = Duration::from_millis(20);
/// How long to retry a port that is opened again at another rate.
const IN_USE: Duration = Duration::from_millis(500);

/// An event of the port.
pub(super) enum Heard {
    /// The port is open under this name.
    Opened(String),
    /// The port cannot be opened or has failed; the thread tries again.
    Gone(Message),
    Bytes(Vec<u8>),
}

/// A command for the port.
enum Order {
    Bytes(Vec<u8>),
    /// Rate from now on, bits a second.
    Rate(u32),
}

/// The kernel's end.
#[derive(Debug)]
pub(super) struct Wire {
    to_port: Sender<Order>,
    from_port: Receiver<Heard>,
}

impl Wire {
    /// Starts the thread; it opens the port once the rate is set.
    pub(super) fn open(end: End) -> io::Result<Self> {
        let (to_port, orders) = bounded(QUEUE);
        let (heard, from_port) = bounded(QUEUE);
        let mut carrier = Carrier {
            end,
            orders,
            heard,
            baud: None,
            rest: Vec::new(),
            told: None,
        };
        thread::Builder::new()
            .name("serial".to_owned())
            .spawn(move || while carrier.carry().is_some() {})?;
        Ok(Self { to_port, from_port })
    }

    /// Sets the rate of the port, bits a second.
    pub(super) fn set_rate(&self, baud: u32) {
        // The thread empties the queue, or has ended.
        let _ = self.to_port.send(Order::Rate(baud));
    }

    /// Queues bytes; returns how many are taken now.
    pub(super) fn give(&self, bytes: &[u8]) -> usize {
        match self.to_port.try_send(Order::Bytes(bytes.to_vec())) {
            Ok(()) => bytes.len(),
            Err(_) => 0,
        }
    }

    /// Returns the next event, if there is one.
    pub(super) fn heard(&self) -> Option<Heard> {
        self.from_port.try_recv().ok()
    }
}

/// An open end of the line.
enum Line {
    Port(Port),
    Offer(Offer),
}

impl Line {
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

/// The state of the thread.
struct Carrier {
    end: End,
    orders: Receiver<Order>,
    heard: Sender<Heard>,
    baud: Option<u32>,
    /// Bytes that the port has not taken yet.
    rest: Vec<u8>,
    /// The last reported reason why the port is not open.
    told: Option<Message>,
}

impl Carrier {
    /// Opens the port and moves bytes until it is gone, or has another rate; `None`: the
    /// program has ended.
    fn carry(&mut self) -> Option<()> {
        self.rest.clear();
        let mut line = loop {
            let Some(baud) = self.baud else {
                self.wait(LOOK)?;
                continue;
            };
            match self.open(baud) {
                Ok((line, name)) => {
                    self.told = None;
                    self.heard.send(Heard::Opened(name)).ok()?;
                    break line;
                }
                Err(error) => {
                    let said = error.message();
                    if self.told.as_ref() != Some(&said) {
                        self.told = Some(said.clone());
                        self.heard.send(Heard::Gone(said)).ok()?;
                    }
                    self.wait(AGAIN)?;
                }
            }
        };
        let baud = self.baud;
        loop {
            self.hear_orders()?;
            // An offered end has the rate of the program that opens it.
            if self.baud != baud && matches!(line, Line::Port(_)) {
                return Some(());
            }
            let done = line.write(&self.rest).and_then(|taken| {
                self.rest.drain(..taken);
                line.read()
            });
            match done {
                Ok(bytes) if bytes.is_empty() => {}
                Ok(bytes) => self.heard.send(Heard::Bytes(bytes)).ok()?,
                Err(error) => {
                    let said = ports::gone(&error);
                    self.told = Some(said.clone());
                    self.heard.send(Heard::Gone(said)).ok()?;
                    return self.wait(AGAIN);
                }
            }
        }
    }

    fn open(&self, baud: u32) -> Result<(Line, String), PortError> {
        let offered = |offer: Offer| {
            let name = offer.name()?;
            Ok((Line::Offer(offer), name))
        };
        match &self.end {
            End::Port(name) => {
                let port = Port::open_within(name, baud, IN_USE)?;
                Ok((Line::Port(port), name.clone()))
            }
            End::Terminal => offered(Offer::open(None)?),
            End::Listening(address) => offered(Offer::open(Some(address))?),
        }
    }

    /// Takes commands as long as the port keeps up; `None`: the program has ended.
    fn hear_orders(&mut self) -> Option<()> {
        while self.rest.is_empty() {
            match self.orders.try_recv() {
                Ok(Order::Bytes(bytes)) => self.rest = bytes,
                Ok(Order::Rate(baud)) => self.baud = Some(baud),
                Err(TryRecvError::Empty) => return Some(()),
                Err(TryRecvError::Disconnected) => return None,
            }
        }
        Some(())
    }

    /// Waits while the port is not open; bytes for it are lost, as with an unplugged
    /// cable. `None`: the program has ended.
    fn wait(&mut self, time: Duration) -> Option<()> {
        let mut waited = Duration::ZERO;
        while waited < time {
            loop {
                match self.orders.try_recv() {
                    Ok(Order::Bytes(_)) => {}
                    Ok(Order::Rate(baud)) => self.baud = Some(baud),
                    Err(TryRecvError::Empty) => break,
                    Err(TryRecvError::Disconnected) => return None,
                }
            }
            thread::sleep(LOOK);
            waited += LOOK;
        }
        Some(())
    }
}
