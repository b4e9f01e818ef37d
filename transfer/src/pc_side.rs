//! Frame protocol at the PC: runs one command after another and reports each result.

use std::collections::VecDeque;

use gsk_messages::{Message, say};

use crate::PortTime;
use crate::file_name::{FileName, Partition};
use crate::frame::{RemotePath, TransferRequest, VERSION};
use crate::station::{Station, StationEvent};
use crate::transfer_fault::TransferFault;
use crate::transfer_file::{
    DirectoryEntry, IncomingFile, MAX_FILE_BYTES, OutgoingFile, TransferFile, TransferProgress,
};

/// Number of bytes without a frame from which on the rate is wrong.
const MIN_NOISE_BYTES: u64 = 4;

/// Command from the PC to the control.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PcCommand {
    /// Connects to the control.
    Connect,
    /// Lists the files of this partition.
    Directory(Partition),
    /// Sends a file to the control.
    Put(TransferFile),
    /// Receives the file with this path from the control.
    Get(RemotePath),
    /// Deletes the file with this path at the control.
    Delete(RemotePath),
    /// Renames a file at the control.
    Rename {
        /// Path of the file to rename.
        from: RemotePath,
        /// New name of the file.
        to: FileName,
    },
    /// Disconnects from the control.
    Bye,
}

/// Result of a command, or a file that the control sends on its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TransferOutcome {
    /// The control has carried out the command.
    Done,
    /// The control has listed the files of the requested partition.
    Listed(Vec<DirectoryEntry>),
    /// The control has sent the requested file.
    Got(TransferFile),
    /// The control refuses the command, for this reason.
    Refused(TransferFault),
    /// The control has sent this file without a command.
    Pushed(TransferFile),
    /// The connection is lost or was never made, for this reason. No command is running.
    Lost(ConnectionLoss),
}

/// Reason for a lost connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum ConnectionLoss {
    /// The PC has received no byte for too long.
    Silent,
    /// The PC receives bytes, but no valid frame.
    Noise,
    /// The control replied before and no longer does.
    Interrupted,
    /// The control has restarted and does not know the connection.
    PeerRestarted,
}

impl ConnectionLoss {
    /// Returns the message for the operator about the lost connection.
    pub fn message(self) -> Message {
        match self {
            Self::Silent => say::transfer_loss_silent(),
            Self::Noise => say::transfer_loss_noise(),
            Self::Interrupted => say::transfer_loss_broken(),
            Self::PeerRestarted => say::transfer_loss_forgotten(),
        }
    }
}

/// The reply or data that the PC waits for.
#[derive(Clone, Debug)]
enum Activity {
    /// No command; the control may send files.
    Idle,
    /// The PC waits for the one reply that ends the command.
    AwaitingReply,
    /// The PC collects the directory entries that follow the reply.
    Listing(Vec<DirectoryEntry>),
    Sending(OutgoingFile),
    /// The PC waits for the file with this path.
    Getting(RemotePath),
}

/// The PC's end of the frame protocol: runs one command at a time.
#[derive(Clone, Debug)]
pub struct PcSide {
    station: Station,
    activity: Activity,
    incoming: Option<IncomingFile>,
    outcomes: VecDeque<TransferOutcome>,
}

impl PcSide {
    /// Creates the PC's side for a line of `baud` bits per second.
    pub fn new(baud: u32) -> Self {
        Self {
            station: Station::new(baud),
            activity: Activity::Idle,
            incoming: None,
            outcomes: VecDeque::new(),
        }
    }

    /// Starts a command. The caller must have taken the result of the previous one.
    pub fn start(&mut self, command: PcCommand) {
        let send = |station: &mut Station, request| {
            station.send(request);
            Activity::AwaitingReply
        };
        let station = &mut self.station;
        self.activity = match command {
            PcCommand::Connect => {
                self.incoming = None;
                station.connect();
                Activity::AwaitingReply
            }
            PcCommand::Directory(partition) => {
                station.send(TransferRequest::Directory(partition));
                Activity::Listing(Vec::new())
            }
            PcCommand::Put(file) => Activity::Sending(OutgoingFile::announce(file, station)),
            PcCommand::Get(path) => {
                station.send(TransferRequest::Get(path.clone()));
                Activity::Getting(path)
            }
            PcCommand::Delete(path) => send(station, TransferRequest::Delete(path)),
            PcCommand::Rename { from, to } => send(station, TransferRequest::Rename { from, to }),
            PcCommand::Bye => send(station, TransferRequest::Bye),
        };
    }

    /// Whether no command is running.
    pub const fn is_idle(&self) -> bool {
        matches!(self.activity, Activity::Idle)
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

    /// Whether all requests are sent and the control has replied to them.
    pub fn is_drained(&self) -> bool {
        self.station.is_drained()
    }

    /// Returns the number of retransmitted frames (重试次数).
    pub const fn retransmissions(&self) -> u64 {
        self.station.retransmissions()
    }

    /// Returns the progress of the file being sent or received; `None` without one.
    pub fn progress(&self) -> Option<TransferProgress> {
        match (&self.activity, &self.incoming) {
            (Activity::Sending(outgoing), _) => Some(outgoing.progress()),
            (_, Some(incoming)) => Some(incoming.progress()),
            _ => None,
        }
    }

    /// Processes received frames and timeouts up to `now`. Returns the result of the command,
    /// or a file that the control has sent; `None` without one.
    pub fn advance(&mut self, now: PortTime) -> Option<TransferOutcome> {
        while let Some(event) = self.station.next_event(now) {
            match event {
                StationEvent::Request(request) => {
                    let result = self.handle_request(request);
                    self.station.reply(result, now);
                }
                StationEvent::Reply(request, result) => self.handle_reply(&request, result),
                StationEvent::Lost => self.handle_lost(now),
                StationEvent::UnknownRequest => {}
            }
        }
        if let Activity::Sending(outgoing) = &mut self.activity {
            outgoing.continue_sending(&mut self.station);
        }
        self.station.send_waiting(now);
        self.check_timeout(now);
        self.outcomes.pop_front()
    }

    /// Ends a reception or a listing when the control has been silent for too long.
    fn check_timeout(&mut self, now: PortTime) {
        let expects_frames = self.incoming.is_some()
            || matches!(self.activity, Activity::Listing(_) | Activity::Getting(_));
        if expects_frames
            && self.station.is_drained()
            && self.station.time_since_frame(now) > self.station.abandon_after()
        {
            self.incoming = None;
            self.station.disconnect();
            if self.is_idle() {
                // The control began this transfer and reports the error itself.
                return;
            }
            self.finish(TransferOutcome::Lost(ConnectionLoss::Interrupted));
        }
    }

    fn finish(&mut self, outcome: TransferOutcome) {
        self.activity = Activity::Idle;
        self.outcomes.push_back(outcome);
    }

    fn handle_lost(&mut self, now: PortTime) {
        self.incoming = None;
        let is_connecting = matches!(self.activity, Activity::AwaitingReply)
            && self.station.has_received_no_frame();
        let loss = match is_connecting {
            // Part of a reply, and nothing after retransmissions: the cable is disconnected.
            true if self.station.noise() >= MIN_NOISE_BYTES
                && self.station.time_since_byte(now) < self.station.reply_timeout() * 2 =>
            {
                ConnectionLoss::Noise
            }
            true => ConnectionLoss::Silent,
            false => ConnectionLoss::Interrupted,
        };
        self.finish(TransferOutcome::Lost(loss));
    }

    /// Executes a request of the control and returns the reply.
    fn handle_request(&mut self, request: TransferRequest) -> Result<(), TransferFault> {
        match request {
            // A control that has restarted, or another one, is about to send.
            TransferRequest::Connect { version } => {
                self.incoming = None;
                match version {
                    VERSION => Ok(()),
                    _ => Err(TransferFault::Content),
                }
            }
            TransferRequest::Bye => {
                self.incoming = None;
                Ok(())
            }
            TransferRequest::Entry { name, size } => match &mut self.activity {
                Activity::Listing(entries) => {
                    entries.push(DirectoryEntry { name, size });
                    Ok(())
                }
                _ => Err(TransferFault::Sequence),
            },
            TransferRequest::End => match core::mem::replace(&mut self.activity, Activity::Idle) {
                Activity::Listing(entries) => {
                    self.finish(TransferOutcome::Listed(entries));
                    Ok(())
                }
                other => {
                    self.activity = other;
                    Err(TransferFault::Sequence)
                }
            },
            TransferRequest::Put(put) => {
                let is_expected = match &self.activity {
                    Activity::Idle => true,
                    Activity::Getting(path) => *path == put.remote_path,
                    _ => false,
                };
                if !is_expected {
                    return Err(TransferFault::Busy);
                }
                if put.size > MAX_FILE_BYTES {
                    return self.drop_incoming_on_error(Err(TransferFault::Full));
                }
                self.incoming = Some(IncomingFile::new(put));
                Ok(())
            }
            TransferRequest::Data(bytes) => {
                let incoming = self.incoming.as_mut().ok_or(TransferFault::Sequence)?;
                let taken = incoming.append(&bytes);
                self.drop_incoming_on_error(taken)
            }
            TransferRequest::Eof => {
                let incoming = self.incoming.take().ok_or(TransferFault::Sequence)?;
                match incoming.finish() {
                    Ok(file) if self.is_idle() => {
                        self.outcomes.push_back(TransferOutcome::Pushed(file));
                    }
                    Ok(file) => self.finish(TransferOutcome::Got(file)),
                    Err(fault) => return self.drop_incoming_on_error(Err(fault)),
                }
                Ok(())
            }
            TransferRequest::Directory(_)
            | TransferRequest::Get(_)
            | TransferRequest::Delete(_)
            | TransferRequest::Rename { .. } => Err(TransferFault::NoRight),
        }
    }

    /// If `result` is an error, drops the incoming file and ends the command as refused.
    /// Returns `result`.
    fn drop_incoming_on_error(
        &mut self,
        result: Result<(), TransferFault>,
    ) -> Result<(), TransferFault> {
        if let Err(fault) = result {
            self.incoming = None;
            if !self.is_idle() {
                self.finish(TransferOutcome::Refused(fault));
            }
        }
        result
    }

    fn handle_reply(&mut self, request: &TransferRequest, result: Result<(), TransferFault>) {
        // Any reply to a goodbye will do.
        let result = match request {
            TransferRequest::Bye => {
                self.station.disconnect();
                Ok(())
            }
            _ => result,
        };
        if result == Err(TransferFault::Sequence) && !matches!(self.activity, Activity::Idle) {
            self.station.disconnect();
            return self.finish(TransferOutcome::Lost(ConnectionLoss::PeerRestarted));
        }
        match (&mut self.activity, result) {
            (Activity::Idle, _) | (Activity::Listing(_) | Activity::Getting(_), Ok(())) => {}
            (Activity::AwaitingReply, Ok(())) => self.finish(TransferOutcome::Done),
            (Activity::Sending(outgoing), result) => match outgoing.handle_reply(request, result) {
                None => {}
                Some(ended) => {
                    self.station.abort();
                    self.finish(match ended {
                        Ok(()) => TransferOutcome::Done,
                        Err(fault) => TransferOutcome::Refused(fault),
                    });
                }
            },
            (_, Err(fault)) => self.finish(TransferOutcome::Refused(fault)),
        }
    }
}
