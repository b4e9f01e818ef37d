//! The PC's side: one order after the other, each with its outcome.

use std::collections::VecDeque;

use gsk_messages::{Message, say};

use crate::HostTime;
use crate::fault::Fault;
use crate::file::{Entry, Incoming, LARGEST, NewFile, Outgoing, Progress};
use crate::frame::{Body, Place, VERSION};
use crate::name::{FileName, Partition};
use crate::station::{Event, Station};

/// Bytes without a frame that make a wrong rate likely.
const GARBAGE: u64 = 4;

/// What the control is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Order {
    /// To answer at all.
    Connect,
    /// The files of a partition.
    Directory(Partition),
    /// To take a file.
    Put(NewFile),
    /// To send a file.
    Get(Place),
    /// To delete a file.
    Delete(Place),
    /// To give a file another name.
    Rename {
        /// Where it stands.
        from: Place,
        /// The new name.
        to: FileName,
    },
    /// To forget this PC.
    Bye,
}

/// What has come of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It is done.
    Done,
    /// The files of the partition.
    Listed(Vec<Entry>),
    /// The file.
    Got(NewFile),
    /// The control refuses it.
    Refused(Fault),
    /// The control has sent a file by itself.
    Pushed(NewFile),
    /// There is no connection, or none any more; nothing is under way.
    Lost(Loss),
}

/// Why there is no connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum Loss {
    /// Nothing answers at all.
    Silent,
    /// Something comes, but no answer.
    Noise,
    /// It answered once, and does not any more.
    Broken,
    /// The control has begun anew meanwhile.
    Forgotten,
}

impl Loss {
    /// What is said of it.
    pub fn message(self) -> Message {
        match self {
            Self::Silent => say::transfer_loss_silent(),
            Self::Noise => say::transfer_loss_noise(),
            Self::Broken => say::transfer_loss_broken(),
            Self::Forgotten => say::transfer_loss_forgotten(),
        }
    }
}

/// What is under way.
#[derive(Clone, Debug)]
enum Activity {
    /// Nothing: the control may send by itself.
    Idle,
    /// One answer ends it.
    Asking,
    /// Entries come, once the question is answered.
    Listing(Vec<Entry>),
    Sending(Outgoing),
    /// A file was asked for.
    Getting(Place),
}

/// The PC's side.
#[derive(Clone, Debug)]
pub struct PcSide {
    station: Station,
    activity: Activity,
    incoming: Option<Incoming>,
    outcomes: VecDeque<Outcome>,
}

impl PcSide {
    /// At a line of so many bits a second.
    pub fn new(baud: u32) -> Self {
        Self {
            station: Station::new(baud),
            activity: Activity::Idle,
            incoming: None,
            outcomes: VecDeque::new(),
        }
    }

    /// Gives an order; the one before it has had its outcome.
    pub fn order(&mut self, order: Order) {
        let ask = |station: &mut Station, body| {
            station.send(body);
            Activity::Asking
        };
        let station = &mut self.station;
        self.activity = match order {
            Order::Connect => {
                self.incoming = None;
                station.connect();
                Activity::Asking
            }
            Order::Directory(partition) => {
                station.send(Body::Directory(partition));
                Activity::Listing(Vec::new())
            }
            Order::Put(file) => Activity::Sending(Outgoing::begin(file, station)),
            Order::Get(place) => {
                station.send(Body::Get(place.clone()));
                Activity::Getting(place)
            }
            Order::Delete(place) => ask(station, Body::Delete(place)),
            Order::Rename { from, to } => ask(station, Body::Rename { from, to }),
            Order::Bye => ask(station, Body::Bye),
        };
    }

    /// Whether no order is under way.
    pub const fn is_idle(&self) -> bool {
        matches!(self.activity, Activity::Idle)
    }

    /// Bytes have come.
    pub fn hear(&mut self, bytes: &[u8], now: HostTime) {
        self.station.hear(bytes, now);
    }

    /// Bytes for the port; [`Self::sent`] says how many it has taken.
    pub fn due(&self, now: HostTime) -> &[u8] {
        self.station.due(now)
    }

    /// The port has taken so many.
    pub fn sent(&mut self, count: usize) {
        self.station.sent(count);
    }

    /// All that was to be said has been said and answered.
    pub fn is_quiet(&self) -> bool {
        self.station.is_quiet()
    }

    /// Frames that went out again, so far (重试次数).
    pub const fn retries(&self) -> u64 {
        self.station.retries()
    }

    /// How far the file under way has come; none while there is none.
    pub fn progress(&self) -> Option<Progress> {
        match (&self.activity, &self.incoming) {
            (Activity::Sending(outgoing), _) => Some(outgoing.progress()),
            (_, Some(incoming)) => Some(incoming.progress()),
            _ => None,
        }
    }

    /// Does what is to be done by now; the outcome of an order, or a file that the control
    /// has sent by itself.
    pub fn advance(&mut self, now: HostTime) -> Option<Outcome> {
        while let Some(event) = self.station.next_event(now) {
            match event {
                Event::Asked(body) => {
                    let result = self.asked(body);
                    self.station.answer(result, now);
                }
                Event::Answered(body, result) => self.answered(&body, result),
                Event::Lost => self.lost(now),
                Event::Strange => {}
            }
        }
        if let Activity::Sending(outgoing) = &mut self.activity {
            outgoing.go_on(&mut self.station);
        }
        self.station.begin(now);
        self.watch(now);
        self.outcomes.pop_front()
    }

    /// Gives up what the control was to send, when it says nothing any more.
    fn watch(&mut self, now: HostTime) {
        let comes = self.incoming.is_some()
            || matches!(self.activity, Activity::Listing(_) | Activity::Getting(_));
        if comes
            && self.station.is_quiet()
            && self.station.silent_for(now) > self.station.given_up_after()
        {
            self.incoming = None;
            self.station.disconnect();
            if self.is_idle() {
                // The control began it, and has said that it is broken.
                return;
            }
            self.end(Outcome::Lost(Loss::Broken));
        }
    }

    fn end(&mut self, outcome: Outcome) {
        self.activity = Activity::Idle;
        self.outcomes.push_back(outcome);
    }

    fn lost(&mut self, now: HostTime) {
        self.incoming = None;
        let connecting = matches!(self.activity, Activity::Asking) && self.station.framed_never();
        let loss = match connecting {
            // Half an answer, and nothing to the repetitions: the cable is out.
            true if self.station.noise() >= GARBAGE
                && self.station.quiet_for(now) < self.station.answer_within() * 2 =>
            {
                Loss::Noise
            }
            true => Loss::Silent,
            false => Loss::Broken,
        };
        self.end(Outcome::Lost(loss));
    }

    /// What the control asks for.
    fn asked(&mut self, body: Body) -> Result<(), Fault> {
        match body {
            // Another control, or this one anew, is about to send.
            Body::Connect { version } => {
                self.incoming = None;
                match version {
                    VERSION => Ok(()),
                    _ => Err(Fault::Content),
                }
            }
            Body::Bye => {
                self.incoming = None;
                Ok(())
            }
            Body::Entry { name, size } => match &mut self.activity {
                Activity::Listing(entries) => {
                    entries.push(Entry { name, size });
                    Ok(())
                }
                _ => Err(Fault::Sequence),
            },
            Body::End => match core::mem::replace(&mut self.activity, Activity::Idle) {
                Activity::Listing(entries) => {
                    self.end(Outcome::Listed(entries));
                    Ok(())
                }
                other => {
                    self.activity = other;
                    Err(Fault::Sequence)
                }
            },
            Body::Put(put) => {
                let wanted = match &self.activity {
                    Activity::Idle => true,
                    Activity::Getting(place) => *place == put.place,
                    _ => false,
                };
                if !wanted {
                    return Err(Fault::Busy);
                }
                if put.size > LARGEST {
                    return self.given_up_if(Err(Fault::Full));
                }
                self.incoming = Some(Incoming::new(put));
                Ok(())
            }
            Body::Data(bytes) => {
                let incoming = self.incoming.as_mut().ok_or(Fault::Sequence)?;
                let taken = incoming.take(&bytes);
                self.given_up_if(taken)
            }
            Body::Eof => {
                let incoming = self.incoming.take().ok_or(Fault::Sequence)?;
                match incoming.whole() {
                    Ok(file) if self.is_idle() => self.outcomes.push_back(Outcome::Pushed(file)),
                    Ok(file) => self.end(Outcome::Got(file)),
                    Err(fault) => return self.given_up_if(Err(fault)),
                }
                Ok(())
            }
            Body::Directory(_) | Body::Get(_) | Body::Delete(_) | Body::Rename { .. } => {
                Err(Fault::NoRight)
            }
        }
    }

    /// A file that comes otherwise than it was announced.
    fn given_up_if(&mut self, result: Result<(), Fault>) -> Result<(), Fault> {
        if let Err(fault) = result {
            self.incoming = None;
            if !self.is_idle() {
                self.end(Outcome::Refused(fault));
            }
        }
        result
    }

    fn answered(&mut self, body: &Body, result: Result<(), Fault>) {
        // Farewells need no good answer.
        let result = match body {
            Body::Bye => {
                self.station.disconnect();
                Ok(())
            }
            _ => result,
        };
        if result == Err(Fault::Sequence) && !matches!(self.activity, Activity::Idle) {
            self.station.disconnect();
            return self.end(Outcome::Lost(Loss::Forgotten));
        }
        match (&mut self.activity, result) {
            (Activity::Idle, _) | (Activity::Listing(_) | Activity::Getting(_), Ok(())) => {}
            (Activity::Asking, Ok(())) => self.end(Outcome::Done),
            (Activity::Sending(outgoing), result) => match outgoing.answered(body, result) {
                None => {}
                Some(ended) => {
                    self.station.break_off();
                    self.end(match ended {
                        Ok(()) => Outcome::Done,
                        Err(fault) => Outcome::Refused(fault),
                    });
                }
            },
            (_, Err(fault)) => self.end(Outcome::Refused(fault)),
        }
    }
}
