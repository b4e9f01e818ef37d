//! Frame protocol at the control: serves requests of the peer and sends the files of 输出 (output
//! key).

use std::collections::VecDeque;

use crate::PortTime;
use crate::file_name::{FileName, Partition};
use crate::frame::{PutRequest, RemotePath, TransferRequest, VERSION};
use crate::program_text::InvalidCharacter;
use crate::station::{Station, StationEvent};
use crate::transfer_fault::TransferFault;
use crate::transfer_file::{
    DirectoryEntry, IncomingFile, MAX_FILE_BYTES, OutgoingFile, TransferFile,
};

/// Least time for which the LCD shows 输入 (input) after a request.
const STATUS_HOLD_TIME: PortTime = PortTime::from_millis(300);
/// Number of bytes without a frame after which the peer uses another rate or protocol.
const MIN_NOISE_BYTES: u64 = 24;

/// The files of the control that the peer can access.
pub trait FileStore {
    /// Lists the names and sizes of all files in a partition.
    ///
    /// # Errors
    /// The reason why the partition cannot be listed.
    fn directory(&mut self, partition: Partition) -> Result<Vec<DirectoryEntry>, TransferFault>;

    /// Checks whether the peer may send the announced file.
    ///
    /// # Errors
    /// The reason for the refusal.
    fn check_put(&mut self, put: &PutRequest) -> Result<(), TransferFault>;

    /// Stores a complete file; on an error no part of the file is stored.
    ///
    /// # Errors
    /// The reason for the refusal.
    fn put(&mut self, file: &TransferFile) -> Result<(), TransferFault>;

    /// Returns the content of a file.
    ///
    /// # Errors
    /// The reason why the file cannot be read.
    fn get(&mut self, path: &RemotePath) -> Result<Vec<u8>, TransferFault>;

    /// Deletes a file.
    ///
    /// # Errors
    /// The reason for the refusal.
    fn delete(&mut self, path: &RemotePath) -> Result<(), TransferFault>;

    /// Gives the file at `from` the name `to`, in the same partition.
    ///
    /// # Errors
    /// The reason for the refusal.
    fn rename(&mut self, from: &RemotePath, to: &FileName) -> Result<(), TransferFault>;
}

/// Transfer status on the LCD (manual III-9.8.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PortStatus {
    /// No transfer is in progress.
    #[default]
    Idle,
    /// 输入: the control receives a file or a request.
    Receiving,
    /// 输出: the control sends its own files.
    Sending,
}

/// Result of a transfer at the control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ControlEvent {
    /// The peer has sent this file, and the control has stored it.
    Received(FileName),
    /// The control has sent this file, and the peer has received it completely.
    Sent(FileName),
    /// The peer refuses this file, for this reason; the remaining files are not sent.
    RejectedByPeer(FileName, TransferFault),
    /// The control refuses this file of the peer, for this reason.
    Refused(FileName, TransferFault),
    /// This program has a character that plain text cannot carry.
    InvalidCharacter(FileName, InvalidCharacter),
    /// Plain text carries only programs, and this file is not a program.
    OnlyPrograms(FileName),
    /// 串口未连接: the peer does not reply, or sends no valid frame.
    NotConnected,
    /// 通信出错: the transfer was interrupted.
    Interrupted,
}

/// The control's end of the frame protocol: serves the peer's requests and sends the files of
/// 输出 (output key).
#[derive(Clone, Debug)]
pub struct ControlSide {
    station: Station,
    incoming: Option<IncomingFile>,
    outgoing: Option<OutgoingFile>,
    /// Whether the peer has requested the outgoing file; otherwise 输出 (output key) sends it.
    is_outgoing_requested: bool,
    /// Files of 输出 (output key) that are not announced to the peer yet.
    to_send: VecDeque<TransferFile>,
    /// Whether the control has reconnected once to send the outgoing file again.
    has_reconnected: bool,
    is_listing: bool,
    receiving_until: PortTime,
    /// Number of noise bytes at the last received frame.
    noise: u64,
    events: VecDeque<ControlEvent>,
}

impl ControlSide {
    /// Creates the control's side for a line of `baud` bits per second.
    pub fn new(baud: u32) -> Self {
        Self {
            station: Station::new(baud),
            incoming: None,
            outgoing: None,
            is_outgoing_requested: false,
            to_send: VecDeque::new(),
            has_reconnected: false,
            is_listing: false,
            receiving_until: PortTime::ZERO,
            noise: 0,
            events: VecDeque::new(),
        }
    }

    /// Whether the peer has connected.
    pub const fn is_connected(&self) -> bool {
        self.station.is_connected()
    }

    /// Whether a frame is partly received.
    pub(crate) const fn is_in_frame(&self) -> bool {
        self.station.is_in_frame()
    }

    /// Whether nothing waits to be sent and no file is incoming.
    pub(crate) fn is_drained(&self) -> bool {
        self.station.is_drained() && self.incoming.is_none() && self.to_send.is_empty()
    }

    /// Queues the control's own files for sending, one after another.
    pub fn send(&mut self, files: Vec<TransferFile>) {
        self.to_send.extend(files);
        if !self.station.is_connected() {
            self.station.connect();
        }
    }

    /// Aborts all transfers on 复位 (reset): drops incoming, outgoing and waiting files.
    pub fn abort(&mut self) {
        self.incoming = None;
        self.outgoing = None;
        self.to_send.clear();
        self.is_listing = false;
        self.station.abort();
    }

    /// Takes bytes that the port received at time `now`; [`Self::advance`] processes them.
    pub fn receive(&mut self, bytes: &[u8], now: PortTime) {
        self.station.receive(bytes, now);
    }

    /// Returns the bytes to send now; [`Self::mark_sent`] confirms how many the port has taken.
    pub fn pending_bytes(&self, now: PortTime) -> &[u8] {
        self.station.pending_bytes(now)
    }

    /// Removes the first `count` bytes of [`Self::pending_bytes`]: the port has taken them.
    pub fn mark_sent(&mut self, count: usize) {
        self.station.mark_sent(count);
    }

    /// Removes and returns the oldest event; `None` without one.
    pub fn next_event(&mut self) -> Option<ControlEvent> {
        self.events.pop_front()
    }

    /// Returns the transfer status for the LCD.
    pub fn status(&self, now: PortTime) -> PortStatus {
        if !self.to_send.is_empty() || (self.outgoing.is_some() && !self.is_outgoing_requested) {
            PortStatus::Sending
        } else if self.incoming.is_some() || self.outgoing.is_some() || now < self.receiving_until {
            PortStatus::Receiving
        } else {
            PortStatus::Idle
        }
    }

    /// Processes received frames, timeouts and waiting files up to `now`.
    pub fn advance(&mut self, now: PortTime, store: &mut dyn FileStore) {
        while let Some(event) = self.station.next_event(now) {
            self.noise = self.station.noise();
            match event {
                StationEvent::Request(request) => {
                    self.receiving_until = now + STATUS_HOLD_TIME;
                    let is_bye = request == TransferRequest::Bye;
                    let result = self.handle_request(request, store);
                    self.station.reply(result, now);
                    if is_bye {
                        self.handle_disconnect();
                    }
                }
                StationEvent::Reply(request, result) => self.handle_reply(&request, result),
                StationEvent::Lost => self.handle_lost(),
                StationEvent::UnknownRequest => {}
            }
        }
        self.send_next();
        if let Some(outgoing) = &mut self.outgoing {
            outgoing.continue_sending(&mut self.station);
        }
        self.station.send_waiting(now);
        if self.incoming.is_some()
            && self.station.time_since_frame(now) > self.station.abandon_after()
        {
            self.incoming = None;
            self.events.push_back(ControlEvent::Interrupted);
        }
        self.check_noise();
    }

    fn send_next(&mut self) {
        if self.outgoing.is_none()
            && self.station.is_connected()
            && let Some(file) = self.to_send.pop_front()
        {
            self.is_outgoing_requested = false;
            self.outgoing = Some(OutgoingFile::announce(file, &mut self.station));
        }
    }

    /// Executes a request of the peer and returns the reply.
    fn handle_request(
        &mut self,
        request: TransferRequest,
        store: &mut dyn FileStore,
    ) -> Result<(), TransferFault> {
        let busy = self.outgoing.is_some() || self.is_listing;
        match request {
            TransferRequest::Connect { version } => self.handle_connect(version),
            TransferRequest::Bye => {
                self.incoming = None;
                Ok(())
            }
            TransferRequest::Directory(_) | TransferRequest::Get(_) | TransferRequest::Put(_)
                if busy =>
            {
                Err(TransferFault::Busy)
            }
            TransferRequest::Directory(partition) => {
                let entries = store.directory(partition)?;
                for DirectoryEntry { name, size } in entries {
                    self.station.send(TransferRequest::Entry { name, size });
                }
                self.station.send(TransferRequest::End);
                self.is_listing = true;
                Ok(())
            }
            TransferRequest::Get(path) => {
                let bytes = store.get(&path)?;
                let file = TransferFile {
                    remote_path: path,
                    bytes,
                    overwrite: true,
                };
                self.is_outgoing_requested = true;
                self.outgoing = Some(OutgoingFile::announce(file, &mut self.station));
                Ok(())
            }
            TransferRequest::Put(put) => {
                self.incoming = None;
                let check = match put.size {
                    ..=MAX_FILE_BYTES => store.check_put(&put),
                    _ => Err(TransferFault::Full),
                };
                if let Err(fault) = check {
                    let name = put.remote_path.name.clone();
                    self.events.push_back(ControlEvent::Refused(name, fault));
                }
                check?;
                self.incoming = Some(IncomingFile::new(put));
                Ok(())
            }
            TransferRequest::Data(bytes) => {
                let incoming = self.incoming.as_mut().ok_or(TransferFault::Sequence)?;
                let taken = incoming.append(&bytes);
                if taken.is_err() {
                    self.incoming = None;
                    self.events.push_back(ControlEvent::Interrupted);
                }
                taken
            }
            TransferRequest::Eof => {
                let incoming = self.incoming.take().ok_or(TransferFault::Sequence)?;
                let name = incoming.put.remote_path.name.clone();
                let stored = incoming.finish().and_then(|file| store.put(&file));
                self.events.push_back(match stored {
                    Ok(()) => ControlEvent::Received(name),
                    Err(fault) => ControlEvent::Refused(name, fault),
                });
                stored
            }
            TransferRequest::Delete(path) => store.delete(&path),
            TransferRequest::Rename { from, to } => store.rename(&from, &to),
            TransferRequest::Entry { .. } | TransferRequest::End => Err(TransferFault::Sequence),
        }
    }

    /// Handles a connect request: an outgoing file starts again from its beginning. Refuses
    /// another protocol version.
    fn handle_connect(&mut self, version: u8) -> Result<(), TransferFault> {
        if version != VERSION {
            return Err(TransferFault::Content);
        }
        self.incoming = None;
        self.is_listing = false;
        if let Some(outgoing) = self.outgoing.take()
            && !self.is_outgoing_requested
        {
            self.to_send.push_front(outgoing.into_file());
        }
        Ok(())
    }

    /// Handles the end of the connection: files of 输出 (output key) wait for the next peer.
    fn handle_disconnect(&mut self) {
        self.is_listing = false;
        self.station.disconnect();
        if let Some(outgoing) = self.outgoing.take()
            && !self.is_outgoing_requested
        {
            self.to_send.push_front(outgoing.into_file());
        }
        if !self.to_send.is_empty() {
            self.station.connect();
        }
    }

    fn handle_reply(&mut self, request: &TransferRequest, result: Result<(), TransferFault>) {
        match request {
            TransferRequest::Connect { .. } if result.is_err() => {
                self.abort();
                self.events.push_back(ControlEvent::NotConnected);
            }
            TransferRequest::End => self.is_listing = false,
            TransferRequest::Entry { .. } if result.is_err() => {
                self.is_listing = false;
                self.station.abort();
            }
            TransferRequest::Put(_) | TransferRequest::Data(_) | TransferRequest::Eof => {
                self.handle_file_reply(request, result);
            }
            _ => {}
        }
    }

    fn handle_file_reply(&mut self, request: &TransferRequest, result: Result<(), TransferFault>) {
        let ended = match &mut self.outgoing {
            Some(outgoing) => outgoing.handle_reply(request, result),
            // After an abort, replies to pending frames still arrive.
            None => return,
        };
        let Some(ended) = ended else {
            return;
        };
        let Some(outgoing) = self.outgoing.take() else {
            return;
        };
        let name = outgoing.file().remote_path.name.clone();
        self.station.abort();
        match ended {
            _ if self.is_outgoing_requested => {}
            Ok(()) => {
                self.has_reconnected = false;
                self.events.push_back(ControlEvent::Sent(name));
            }
            // The peer has lost the connection: reconnect once and start again.
            Err(TransferFault::Sequence) if !outgoing.is_accepted() && !self.has_reconnected => {
                self.has_reconnected = true;
                self.to_send.push_front(outgoing.into_file());
                self.station.connect();
            }
            Err(fault) => {
                self.has_reconnected = false;
                self.to_send.clear();
                self.events
                    .push_back(ControlEvent::RejectedByPeer(name, fault));
            }
        }
    }

    fn handle_lost(&mut self) {
        let has_started = self
            .outgoing
            .as_ref()
            .is_some_and(OutgoingFile::is_accepted)
            || self.incoming.is_some()
            || self.is_listing;
        self.abort();
        self.events.push_back(match has_started {
            true => ControlEvent::Interrupted,
            false => ControlEvent::NotConnected,
        });
    }

    /// Reports [`ControlEvent::NotConnected`] after [`MIN_NOISE_BYTES`] bytes without a frame
    /// while no peer is connected.
    fn check_noise(&mut self) {
        let noise = self.station.noise();
        if self.station.is_connected() {
            self.noise = noise;
        } else if noise - self.noise >= MIN_NOISE_BYTES {
            self.noise = noise;
            self.events.push_back(ControlEvent::NotConnected);
        }
    }
}
