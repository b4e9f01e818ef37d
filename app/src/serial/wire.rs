//! Bytes between the kernel and a port, carried by a thread of its own: the kernel waits
//! for no port.

use std::io;
use std::thread;

use crossbeam::channel::{Receiver, Sender, TryRecvError, bounded};
use gsk_messages::Message;
use web_time::Duration;

use super::End;
use crate::ports::{self, Offer, Port, PortError};

/// Pieces that wait, either way.
const QUEUE: usize = 64;
/// Between two attempts to open a port.
const AGAIN: Duration = Duration::from_secs(1);
/// How often somebody looks meanwhile whether the program goes on.
const LOOK: Duration = Duration::from_millis(20);
/// So long a port that is opened anew at another rate may still be in use.
const IN_USE: Duration = Duration::from_millis(500);

/// What comes from the port.
pub(super) enum Heard {
    /// It is open, under this name.
    Opened(String),
    /// It is not, or no more; it is tried again.
    Gone(Message),
    /// Bytes.
    Bytes(Vec<u8>),
}

/// What goes to the port.
enum Order {
    Bytes(Vec<u8>),
    /// Bits a second from now on.
    Rate(u32),
}

/// The kernel's end.
#[derive(Debug)]
pub(super) struct Wire {
    to_port: Sender<Order>,
    from_port: Receiver<Heard>,
}

impl Wire {
    /// Starts the thread; the port is opened when it has its rate.
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

    /// From now on the port has this rate.
    pub(super) fn set_rate(&self, baud: u32) {
        // The thread empties the queue, or has ended.
        let _ = self.to_port.send(Order::Rate(baud));
    }

    /// Hands bytes over; how many are taken now.
    pub(super) fn give(&self, bytes: &[u8]) -> usize {
        match self.to_port.try_send(Order::Bytes(bytes.to_vec())) {
            Ok(()) => bytes.len(),
            Err(_) => 0,
        }
    }

    /// What has come.
    pub(super) fn heard(&self) -> Option<Heard> {
        self.from_port.try_recv().ok()
    }
}

/// An end of the line, open.
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

/// The thread.
struct Carrier {
    end: End,
    orders: Receiver<Order>,
    heard: Sender<Heard>,
    baud: Option<u32>,
    /// What the port has not taken yet.
    rest: Vec<u8>,
    /// Why it was not opened, as it was said last.
    told: Option<Message>,
}

impl Carrier {
    /// Opens the port and carries bytes until it is gone, or has another rate; none: the
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
            // An offered end is as fast as whoever takes it.
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

    /// Takes what is to be said, as long as the port keeps up; none: the program has ended.
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

    /// Waits with a port that is not open: what is said to it is lost, as with a cable
    /// that is out.
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
