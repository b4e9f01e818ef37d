//! The control's side: it answers what the other side asks for, and sends what 输出 was
//! pressed for.

use std::collections::VecDeque;

use crate::HostTime;
use crate::fault::Fault;
use crate::file::{Entry, Incoming, LARGEST, NewFile, Outgoing};
use crate::frame::{Body, Place, Put, VERSION};
use crate::name::{FileName, Partition};
use crate::station::{Event, Station};
use crate::text::NotText;

/// So long 输入 stands after a command, so that somebody sees it.
const SHOWN: HostTime = HostTime::from_millis(300);
/// Bytes without a frame after which nobody at the other end speaks this language.
const GARBAGE: u64 = 24;

/// The memory of the control, as the other side of the line sees it.
pub trait Store {
    /// The files of a partition.
    ///
    /// # Errors
    /// Why there is no list.
    fn directory(&mut self, partition: Partition) -> Result<Vec<Entry>, Fault>;

    /// Whether a file may come.
    ///
    /// # Errors
    /// Why not.
    fn may_put(&mut self, put: &Put) -> Result<(), Fault>;

    /// A whole file has come; it is taken as a whole, or nothing of it.
    ///
    /// # Errors
    /// Why it is not taken.
    fn put(&mut self, file: &NewFile) -> Result<(), Fault>;

    /// What a file holds.
    ///
    /// # Errors
    /// Why it is not handed out.
    fn get(&mut self, place: &Place) -> Result<Vec<u8>, Fault>;

    /// Deletes a file.
    ///
    /// # Errors
    /// Why not.
    fn delete(&mut self, place: &Place) -> Result<(), Fault>;

    /// Gives a file another name.
    ///
    /// # Errors
    /// Why not.
    fn rename(&mut self, from: &Place, to: &FileName) -> Result<(), Fault>;
}

/// What the LCD says of the port (manual III-9.8.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Status {
    /// Nothing.
    #[default]
    Idle,
    /// 输入: a file or a command comes in.
    Receiving,
    /// 输出: the control sends by itself.
    Sending,
}

/// What has come of something.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ControlEvent {
    /// A file stands in the memory now.
    Received(FileName),
    /// A file that was sent has arrived.
    Sent(FileName),
    /// The other side does not take a file, and nothing after it is sent.
    NotTaken(FileName, Fault),
    /// A file has come that the control does not take.
    Refused(FileName, Fault),
    /// A program has a character that goes over no line of text.
    NotText(FileName, NotText),
    /// As text only programs go over the line.
    OnlyPrograms(FileName),
    /// 串口未连接: nobody answers, or in no language that is known.
    NotConnected,
    /// 通信出错: it ended in the middle.
    Broken,
}

/// The control's side.
#[derive(Clone, Debug)]
pub struct ControlSide {
    station: Station,
    incoming: Option<Incoming>,
    outgoing: Option<Outgoing>,
    /// The file that goes out was asked for by the other side.
    asked_for: bool,
    /// Files that 输出 sends.
    to_send: VecDeque<NewFile>,
    /// The connection was made anew for the file that goes out.
    anew: bool,
    /// Entries of a list are going out.
    listing: bool,
    shown_until: HostTime,
    /// Bytes of noise when the last frame came.
    noise: u64,
    events: VecDeque<ControlEvent>,
}

impl ControlSide {
    /// At a line of so many bits a second.
    pub fn new(baud: u32) -> Self {
        Self {
            station: Station::new(baud),
            incoming: None,
            outgoing: None,
            asked_for: false,
            to_send: VecDeque::new(),
            anew: false,
            listing: false,
            shown_until: HostTime::ZERO,
            noise: 0,
            events: VecDeque::new(),
        }
    }

    /// Somebody has connected.
    pub const fn is_connected(&self) -> bool {
        self.station.is_connected()
    }

    /// A frame has begun and not ended.
    pub(crate) const fn is_within(&self) -> bool {
        self.station.is_within()
    }

    /// Nothing waits to be said, and nothing comes in.
    pub(crate) fn is_quiet(&self) -> bool {
        self.station.is_quiet() && self.incoming.is_none() && self.to_send.is_empty()
    }

    /// Sends files by itself, one after the other.
    pub fn send(&mut self, files: Vec<NewFile>) {
        self.to_send.extend(files);
        if !self.station.is_connected() {
            self.station.connect();
        }
    }

    /// 复位: what is under way is dropped at both ends.
    pub fn break_off(&mut self) {
        self.incoming = None;
        self.outgoing = None;
        self.to_send.clear();
        self.listing = false;
        self.station.break_off();
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

    /// What has come of something.
    pub fn next_event(&mut self) -> Option<ControlEvent> {
        self.events.pop_front()
    }

    /// What the LCD says.
    pub fn status(&self, now: HostTime) -> Status {
        if !self.to_send.is_empty() || (self.outgoing.is_some() && !self.asked_for) {
            Status::Sending
        } else if self.incoming.is_some() || self.outgoing.is_some() || now < self.shown_until {
            Status::Receiving
        } else {
            Status::Idle
        }
    }

    /// Does what is to be done by now.
    pub fn advance(&mut self, now: HostTime, store: &mut dyn Store) {
        while let Some(event) = self.station.next_event(now) {
            self.noise = self.station.noise();
            match event {
                Event::Asked(body) => {
                    self.shown_until = now + SHOWN;
                    let ends = body == Body::Bye;
                    let result = self.asked(body, store);
                    self.station.answer(result, now);
                    if ends {
                        self.left();
                    }
                }
                Event::Answered(body, result) => self.answered(&body, result),
                Event::Lost => self.lost(),
                Event::Strange => {}
            }
        }
        self.send_next();
        if let Some(outgoing) = &mut self.outgoing {
            outgoing.go_on(&mut self.station);
        }
        self.station.begin(now);
        if self.incoming.is_some() && self.station.silent_for(now) > self.station.given_up_after() {
            self.incoming = None;
            self.events.push_back(ControlEvent::Broken);
        }
        self.look_for_garbage();
    }

    /// The next file that 输出 was pressed for.
    fn send_next(&mut self) {
        if self.outgoing.is_none()
            && self.station.is_connected()
            && let Some(file) = self.to_send.pop_front()
        {
            self.asked_for = false;
            self.outgoing = Some(Outgoing::begin(file, &mut self.station));
        }
    }

    /// Whether the other side may have this, and what is to be done for it.
    fn asked(&mut self, body: Body, store: &mut dyn Store) -> Result<(), Fault> {
        let busy = self.outgoing.is_some() || self.listing;
        match body {
            Body::Connect { version } => self.connected(version),
            Body::Bye => {
                self.incoming = None;
                Ok(())
            }
            Body::Directory(_) | Body::Get(_) | Body::Put(_) if busy => Err(Fault::Busy),
            Body::Directory(partition) => {
                let entries = store.directory(partition)?;
                for Entry { name, size } in entries {
                    self.station.send(Body::Entry { name, size });
                }
                self.station.send(Body::End);
                self.listing = true;
                Ok(())
            }
            Body::Get(place) => {
                let bytes = store.get(&place)?;
                let file = NewFile {
                    place,
                    bytes,
                    overwrite: true,
                };
                self.asked_for = true;
                self.outgoing = Some(Outgoing::begin(file, &mut self.station));
                Ok(())
            }
            Body::Put(put) => {
                self.incoming = None;
                let may = match put.size {
                    ..=LARGEST => store.may_put(&put),
                    _ => Err(Fault::Full),
                };
                if let Err(fault) = may {
                    let name = put.place.name.clone();
                    self.events.push_back(ControlEvent::Refused(name, fault));
                }
                may?;
                self.incoming = Some(Incoming::new(put));
                Ok(())
            }
            Body::Data(bytes) => {
                let incoming = self.incoming.as_mut().ok_or(Fault::Sequence)?;
                let taken = incoming.take(&bytes);
                if taken.is_err() {
                    self.incoming = None;
                    self.events.push_back(ControlEvent::Broken);
                }
                taken
            }
            Body::Eof => {
                let incoming = self.incoming.take().ok_or(Fault::Sequence)?;
                let name = incoming.put.place.name.clone();
                let stored = incoming.whole().and_then(|file| store.put(&file));
                self.events.push_back(match stored {
                    Ok(()) => ControlEvent::Received(name),
                    Err(fault) => ControlEvent::Refused(name, fault),
                });
                stored
            }
            Body::Delete(place) => store.delete(&place),
            Body::Rename { from, to } => store.rename(&from, &to),
            Body::Entry { .. } | Body::End => Err(Fault::Sequence),
        }
    }

    /// The other side begins: a file that was on its way begins anew.
    fn connected(&mut self, version: u8) -> Result<(), Fault> {
        if version != VERSION {
            return Err(Fault::Content);
        }
        self.incoming = None;
        self.listing = false;
        if let Some(outgoing) = self.outgoing.take()
            && !self.asked_for
        {
            self.to_send.push_front(outgoing.into_file());
        }
        Ok(())
    }

    /// The other side has gone; what 输出 was pressed for goes to whoever comes next.
    fn left(&mut self) {
        self.listing = false;
        self.station.disconnect();
        if let Some(outgoing) = self.outgoing.take()
            && !self.asked_for
        {
            self.to_send.push_front(outgoing.into_file());
        }
        if !self.to_send.is_empty() {
            self.station.connect();
        }
    }

    fn answered(&mut self, body: &Body, result: Result<(), Fault>) {
        match body {
            Body::Connect { .. } if result.is_err() => {
                self.break_off();
                self.events.push_back(ControlEvent::NotConnected);
            }
            Body::End => self.listing = false,
            Body::Entry { .. } if result.is_err() => {
                self.listing = false;
                self.station.break_off();
            }
            Body::Put(_) | Body::Data(_) | Body::Eof => self.file_answered(body, result),
            _ => {}
        }
    }

    fn file_answered(&mut self, body: &Body, result: Result<(), Fault>) {
        let ended = match &mut self.outgoing {
            Some(outgoing) => outgoing.answered(body, result),
            // It has been broken off; what was under way still gets its answers.
            None => return,
        };
        let Some(ended) = ended else {
            return;
        };
        let Some(outgoing) = self.outgoing.take() else {
            return;
        };
        let name = outgoing.file().place.name.clone();
        self.station.break_off();
        match ended {
            _ if self.asked_for => {}
            Ok(()) => {
                self.anew = false;
                self.events.push_back(ControlEvent::Sent(name));
            }
            // It knows of no connection any more: from the beginning, once.
            Err(Fault::Sequence) if !outgoing.has_begun() && !self.anew => {
                self.anew = true;
                self.to_send.push_front(outgoing.into_file());
                self.station.connect();
            }
            Err(fault) => {
                self.anew = false;
                self.to_send.clear();
                self.events.push_back(ControlEvent::NotTaken(name, fault));
            }
        }
    }

    /// Nobody answers any more.
    fn lost(&mut self) {
        let begun = self.outgoing.as_ref().is_some_and(Outgoing::has_begun)
            || self.incoming.is_some()
            || self.listing;
        self.break_off();
        self.events.push_back(match begun {
            true => ControlEvent::Broken,
            false => ControlEvent::NotConnected,
        });
    }

    /// Bytes that are no frames, while nobody is connected.
    fn look_for_garbage(&mut self) {
        let noise = self.station.noise();
        if self.station.is_connected() {
            self.noise = noise;
        } else if noise - self.noise >= GARBAGE {
            self.noise = noise;
            self.events.push_back(ControlEvent::NotConnected);
        }
    }
}
