//! One end of a line with frames: delivers frames in order, each once, or reports that the
//! peer is lost.
//!
//! A frame without a reply within a second of its last bit is retransmitted, up to five times.
//! Two blocks of a file may be pending, so that the line is not idle during a reply. Every other
//! frame waits for the reply before it. The receiver accepts frames in the order of their
//! sequence numbers. A repeated frame gets its earlier reply. A gap makes the receiver request
//! the missing frame.

use std::collections::VecDeque;

use crate::PortTime;
use crate::frame::{
    FrameReader, MAX_FRAME_BYTES, ReaderOutput, TransferFrame, TransferRequest, VERSION,
    encode_reply,
};
use crate::transfer_fault::TransferFault;
use crate::wire_time::{PORT_LOOKAHEAD, WireTime};

/// Time limit for the reply to a frame, without transmission times.
const REPLY_TIMEOUT: PortTime = PortTime::from_secs(1);
const MAX_RETRANSMISSIONS: u8 = 5;
/// Greatest number of pending blocks of a file or entries of a directory.
const WINDOW: usize = 2;
/// Pause after which a partly received frame counts as damaged.
const FRAME_GAP_TIMEOUT: PortTime = PortTime::from_millis(200);
/// Shortest time between two requests for a missing frame.
const NAK_INTERVAL: PortTime = PortTime::from_millis(50);
/// Number of recent replies that are kept for repeated frames.
const KEPT_REPLIES: usize = 4;
/// Sequence number of the connect frame.
const CONNECT_SEQ: u8 = 0;
const FIRST_SEQ: u8 = 1;

/// An event that the station reports to its owner.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum StationEvent {
    /// The peer sends a request; the caller must call [`Station::reply`] next.
    Request(TransferRequest),
    /// The peer sends an unknown request; the station has already refused it.
    UnknownRequest,
    /// The peer replies to this request: accepted, or refused for a reason.
    Reply(TransferRequest, Result<(), TransferFault>),
    /// The peer no longer replies; the station has dropped all waiting frames.
    Lost,
}

/// A sent frame that waits for its reply.
#[derive(Clone, Debug)]
struct PendingFrame {
    seq: u8,
    request: TransferRequest,
    retransmission_count: u8,
    /// Time at which the last bit of the frame leaves the line.
    transmitted_at: PortTime,
    /// Time at which the reply is due.
    reply_due_at: PortTime,
    /// Whether the reply will be ignored because the transfer was aborted.
    is_abandoned: bool,
}

/// One end of a line: sends, receives and retransmits frames.
#[derive(Clone, Debug)]
pub(crate) struct Station {
    wire: WireTime,
    reader: FrameReader,
    /// Bytes of frames that the port has not taken yet.
    output: Vec<u8>,
    next_seq: u8,
    waiting: VecDeque<TransferRequest>,
    pending: VecDeque<PendingFrame>,
    /// Sequence number of the next frame of the peer; `None` without a connection.
    expected_seq: Option<u8>,
    /// Sequence number of the request that waits for [`Station::reply`]; `None` without one.
    unanswered_seq: Option<u8>,
    recent_replies: VecDeque<(u8, Result<(), TransferFault>)>,
    events: VecDeque<StationEvent>,
    /// Time of the last received byte.
    last_byte_at: PortTime,
    last_frame_at: PortTime,
    last_nak_at: Option<PortTime>,
    retransmissions: u64,
}

impl Station {
    /// Creates the station for a line of `baud` bits per second.
    pub(crate) fn new(baud: u32) -> Self {
        Self {
            wire: WireTime::new(baud),
            reader: FrameReader::default(),
            output: Vec::new(),
            next_seq: CONNECT_SEQ,
            waiting: VecDeque::new(),
            pending: VecDeque::new(),
            expected_seq: None,
            unanswered_seq: None,
            recent_replies: VecDeque::new(),
            events: VecDeque::new(),
            last_byte_at: PortTime::ZERO,
            last_frame_at: PortTime::ZERO,
            last_nak_at: None,
            retransmissions: 0,
        }
    }

    /// Queues a request to the peer.
    pub(crate) fn send(&mut self, request: TransferRequest) {
        self.waiting.push_back(request);
    }

    /// Drops all frames and queues a connect request.
    pub(crate) fn connect(&mut self) {
        self.clear_queues();
        self.expected_seq = None;
        self.next_seq = CONNECT_SEQ;
        self.send(TransferRequest::Connect { version: VERSION });
    }

    /// Drops all frames and ends the connection; sends nothing.
    pub(crate) fn disconnect(&mut self) {
        self.clear_queues();
        self.expected_seq = None;
    }

    pub(crate) const fn is_connected(&self) -> bool {
        self.expected_seq.is_some()
    }

    /// Whether a frame is partly received.
    pub(crate) const fn is_in_frame(&self) -> bool {
        self.reader.is_in_frame()
    }

    /// Drops waiting frames. Pending frames still arrive; their replies are ignored.
    pub(crate) fn abort(&mut self) {
        self.waiting.clear();
        for frame in &mut self.pending {
            frame.is_abandoned = true;
        }
    }

    /// Returns the number of requests that are not sent yet.
    pub(crate) fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// Whether the port has taken all bytes and the peer has replied to all requests.
    pub(crate) fn is_drained(&self) -> bool {
        self.waiting.is_empty() && self.pending.is_empty() && self.output.is_empty()
    }

    /// Returns the number of retransmitted frames so far.
    pub(crate) const fn retransmissions(&self) -> u64 {
        self.retransmissions
    }

    /// Returns the number of received bytes that were not part of a valid frame.
    pub(crate) const fn noise(&self) -> u64 {
        self.reader.noise()
    }

    /// Returns the longest time for a reply at this rate. The reply may wait for a frame of the
    /// peer and for a frame of this side.
    pub(crate) fn reply_timeout(&self) -> PortTime {
        REPLY_TIMEOUT + self.wire.transmission_time(2 * MAX_FRAME_BYTES)
    }

    /// Returns the time without a frame after which the peer has certainly given up.
    pub(crate) fn abandon_after(&self) -> PortTime {
        self.reply_timeout() * (u32::from(MAX_RETRANSMISSIONS) + 2)
    }

    /// Whether no frame has ever been received.
    pub(crate) const fn has_received_no_frame(&self) -> bool {
        self.last_frame_at.is_zero()
    }

    /// Returns the time since the last received frame.
    pub(crate) fn time_since_frame(&self, now: PortTime) -> PortTime {
        now.saturating_sub(self.last_frame_at)
    }

    /// Returns the time since the last received byte.
    pub(crate) fn time_since_byte(&self, now: PortTime) -> PortTime {
        now.saturating_sub(self.last_byte_at)
    }

    /// Returns the bytes that the port may take now.
    pub(crate) fn pending_bytes(&self, now: PortTime) -> &[u8] {
        &self.output[..self.wire.sendable(self.output.len(), now)]
    }

    /// Removes the first `count` bytes of [`Self::pending_bytes`]: the port has taken them.
    pub(crate) fn mark_sent(&mut self, count: usize) {
        self.output.drain(..count.min(self.output.len()));
    }

    /// Takes bytes that the port received at time `now`.
    pub(crate) fn receive(&mut self, bytes: &[u8], now: PortTime) {
        if !bytes.is_empty() {
            self.last_byte_at = now;
            self.reader.push_bytes(bytes);
        }
    }

    /// Returns the next event; `None` if none is left. The caller must reply to a request
    /// before it reads the next event.
    pub(crate) fn next_event(&mut self, now: PortTime) -> Option<StationEvent> {
        self.retransmit_overdue(now);
        loop {
            if let Some(event) = self.events.pop_front() {
                return Some(event);
            }
            if self.unanswered_seq.is_some() {
                break;
            }
            if self.reader.is_in_frame()
                && now.saturating_sub(self.last_byte_at) > FRAME_GAP_TIMEOUT
            {
                self.reader.skip_byte();
            }
            match self.reader.next() {
                Some(ReaderOutput::Frame(frame)) => {
                    self.last_frame_at = now;
                    match frame {
                        TransferFrame::Reply { seq, result } => self.handle_reply(seq, result, now),
                        TransferFrame::Request { seq, request } => {
                            self.handle_request(seq, request, now);
                        }
                    }
                }
                Some(ReaderOutput::Damaged) => self.request_missing_frame(now),
                None => break,
            }
        }
        self.send_waiting(now);
        None
    }

    /// Queues the reply to the request that [`Self::next_event`] has returned.
    pub(crate) fn reply(&mut self, result: Result<(), TransferFault>, now: PortTime) {
        let Some(seq) = self.unanswered_seq.take() else {
            return;
        };
        self.expected_seq = Some(seq.wrapping_add(1));
        if self.recent_replies.len() == KEPT_REPLIES {
            self.recent_replies.pop_front();
        }
        self.recent_replies.push_back((seq, result));
        self.queue_bytes(&encode_reply(seq, result), now);
    }

    fn clear_queues(&mut self) {
        self.waiting.clear();
        self.pending.clear();
        self.recent_replies.clear();
        self.unanswered_seq = None;
    }

    fn queue_bytes(&mut self, bytes: &[u8], now: PortTime) -> PortTime {
        self.output.extend_from_slice(bytes);
        self.wire.queue(bytes.len(), now)
    }

    /// Sends waiting frames as far as [`WINDOW`] allows.
    pub(crate) fn send_waiting(&mut self, now: PortTime) {
        while let Some(request) = self.waiting.front() {
            let is_block = |request: &TransferRequest| {
                matches!(
                    request,
                    TransferRequest::Data(_) | TransferRequest::Entry { .. }
                )
            };
            let fits_window = self.pending.len() < WINDOW
                && is_block(request)
                && self.pending.iter().all(|frame| is_block(&frame.request));
            if !self.pending.is_empty() && !fits_window {
                return;
            }
            let Some(request) = self.waiting.pop_front() else {
                return;
            };
            let seq = match request {
                TransferRequest::Connect { .. } => CONNECT_SEQ,
                _ => self.next_seq,
            };
            self.next_seq = seq.wrapping_add(1);
            let transmitted_at = self.queue_bytes(&request.encode(seq), now);
            self.pending.push_back(PendingFrame {
                seq,
                request,
                retransmission_count: 0,
                transmitted_at,
                reply_due_at: transmitted_at + self.reply_timeout(),
                is_abandoned: false,
            });
        }
    }

    /// Retransmits all pending frames if the reply to the first one is overdue.
    fn retransmit_overdue(&mut self, now: PortTime) {
        if self
            .pending
            .front()
            .is_some_and(|frame| frame.reply_due_at <= now)
        {
            self.retransmit(0, now);
        }
    }

    /// Retransmits the pending frames from index `from` on. After [`MAX_RETRANSMISSIONS`] the
    /// peer is lost.
    fn retransmit(&mut self, from: usize, now: PortTime) {
        if self.pending[from].retransmission_count >= MAX_RETRANSMISSIONS {
            self.clear_queues();
            self.expected_seq = None;
            self.output.clear();
            self.events.push_back(StationEvent::Lost);
            return;
        }
        // If the port takes no bytes, do not queue more.
        let blocked = self.wire.idle_at() < now && !self.output.is_empty();
        let timeout = self.reply_timeout();
        for at in from..self.pending.len() {
            let bytes = match blocked {
                true => Vec::new(),
                false => self.pending[at].request.encode(self.pending[at].seq),
            };
            let transmitted_at = self.queue_bytes(&bytes, now);
            let frame = &mut self.pending[at];
            frame.retransmission_count += 1;
            frame.transmitted_at = transmitted_at;
            frame.reply_due_at = transmitted_at + timeout;
            self.retransmissions += 1;
        }
    }

    fn handle_reply(&mut self, seq: u8, result: Result<(), TransferFault>, now: PortTime) {
        let Some(at) = self.pending.iter().position(|frame| frame.seq == seq) else {
            return;
        };
        match result {
            Err(TransferFault::Damaged) => {
                // The peer cannot know a copy that has not arrived yet.
                if self.pending[at].transmitted_at <= now + PORT_LOOKAHEAD {
                    self.retransmit(at, now);
                }
            }
            // The reply to the frame before is lost and may be a refusal. That frame is
            // retransmitted in time.
            Err(_) if at > 0 => {}
            Err(_) => self.complete_first(result),
            // Frames are accepted in order: those before it are accepted, too.
            Ok(()) => (0..=at).for_each(|_| self.complete_first(Ok(()))),
        }
    }

    fn complete_first(&mut self, result: Result<(), TransferFault>) {
        let Some(frame) = self.pending.pop_front() else {
            return;
        };
        if matches!(frame.request, TransferRequest::Connect { .. }) && result.is_ok() {
            // The peer may have connected in the meantime.
            self.expected_seq.get_or_insert(FIRST_SEQ);
        }
        if !frame.is_abandoned {
            self.events
                .push_back(StationEvent::Reply(frame.request, result));
        }
    }

    fn handle_request(
        &mut self,
        seq: u8,
        request: Result<TransferRequest, TransferFault>,
        now: PortTime,
    ) {
        if matches!(request, Ok(TransferRequest::Connect { .. })) {
            self.restart_session();
        } else {
            let Some(expected) = self.expected_seq else {
                // Frames from before this connection are void.
                if self.pending.is_empty() {
                    self.queue_bytes(&encode_reply(seq, Err(TransferFault::Sequence)), now);
                }
                return;
            };
            match seq.wrapping_sub(expected) {
                0 => {}
                128.. => return self.repeat_reply(seq, now),
                _ => return self.request_missing_frame(now),
            }
        }
        self.unanswered_seq = Some(seq);
        match request {
            Ok(request) => self.events.push_back(StationEvent::Request(request)),
            Err(fault) => {
                self.reply(Err(fault), now);
                self.events.push_back(StationEvent::UnknownRequest);
            }
        }
    }

    /// Handles a connect request: sequence numbers start again in both directions.
    fn restart_session(&mut self) {
        let is_connect =
            |frame: &PendingFrame| matches!(frame.request, TransferRequest::Connect { .. });
        self.pending.retain(is_connect);
        self.waiting
            .retain(|request| matches!(request, TransferRequest::Connect { .. }));
        self.recent_replies.clear();
        self.next_seq = FIRST_SEQ;
    }

    fn repeat_reply(&mut self, seq: u8, now: PortTime) {
        let known = self.recent_replies.iter().find(|(known, _)| *known == seq);
        let result = known.map_or(Ok(()), |(_, result)| *result);
        self.queue_bytes(&encode_reply(seq, result), now);
    }

    /// Requests the expected frame from the peer again, at most once per [`NAK_INTERVAL`].
    fn request_missing_frame(&mut self, now: PortTime) {
        let Some(expected) = self.expected_seq else {
            return;
        };
        let is_recent = self.last_nak_at.is_some_and(|at| now < at + NAK_INTERVAL);
        if !is_recent {
            self.last_nak_at = Some(now);
            self.queue_bytes(&encode_reply(expected, Err(TransferFault::Damaged)), now);
        }
    }
}
