//! One end of the line: frames arrive in their order, each once, or it is told that the
//! other end is lost.
//!
//! A frame is answered within a second of its last bit, or goes out again, five times.
//! Two blocks of a file may be under way, so that the wire does not rest while an answer
//! comes back; everything else waits for the answer before it. The receiver takes frames
//! in the order of their numbers only: one that comes twice gets the answer it got, one
//! that comes too early makes it ask for the one that is missing.

use std::collections::VecDeque;

use crate::HostTime;
use crate::fault::Fault;
use crate::frame::{Body, Frame, LONGEST, Piece, Reader, VERSION, encode_answer};
use crate::wire_time::{LEAD, WireTime};

/// How long an answer may take.
const ANSWER_WITHIN: HostTime = HostTime::from_secs(1);
/// So often a frame goes out again.
const RETRIES: u8 = 5;
/// Blocks of a file, or entries of a list, under way.
const WINDOW: usize = 2;
/// A frame whose bytes stop for so long will not end.
const STALE: HostTime = HostTime::from_millis(200);
/// Between two complaints.
const COMPLAINTS: HostTime = HostTime::from_millis(50);
/// Answers that may be asked for again.
const REMEMBERED: usize = 4;
/// The number of the frame that connects, and of the first one after it.
const CONNECT_SEQ: u8 = 0;
const FIRST_SEQ: u8 = 1;

/// What has happened on the line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Event {
    /// The other side asks; [`Station::answer`] is to be called before anything else.
    Asked(Body),
    /// It asks for what nobody understands; it has been answered.
    Strange,
    /// It has answered.
    Answered(Body, Result<(), Fault>),
    /// It does not answer any more; all that was to be said to it is dropped.
    Lost,
}

/// A frame that has not been answered.
#[derive(Clone, Debug)]
struct UnderWay {
    seq: u8,
    body: Body,
    tries: u8,
    /// When its last bit leaves.
    leaves: HostTime,
    /// When it is to be answered.
    due: HostTime,
    /// Nobody waits for its answer any more.
    dropped: bool,
}

/// One end of the line.
#[derive(Clone, Debug)]
pub(crate) struct Station {
    wire: WireTime,
    reader: Reader,
    /// Bytes for the port.
    out: Vec<u8>,
    next: u8,
    waiting: VecDeque<Body>,
    under_way: VecDeque<UnderWay>,
    /// The number that comes next; none without a connection.
    expected: Option<u8>,
    /// The frame that waits for its answer.
    asked: Option<u8>,
    answers: VecDeque<(u8, Result<(), Fault>)>,
    events: VecDeque<Event>,
    /// When the last byte came, and the last frame.
    heard_at: HostTime,
    framed_at: HostTime,
    complained: Option<HostTime>,
    retries: u64,
}

impl Station {
    /// At a line of so many bits a second.
    pub(crate) fn new(baud: u32) -> Self {
        Self {
            wire: WireTime::new(baud),
            reader: Reader::default(),
            out: Vec::new(),
            next: CONNECT_SEQ,
            waiting: VecDeque::new(),
            under_way: VecDeque::new(),
            expected: None,
            asked: None,
            answers: VecDeque::new(),
            events: VecDeque::new(),
            heard_at: HostTime::ZERO,
            framed_at: HostTime::ZERO,
            complained: None,
            retries: 0,
        }
    }

    /// Something is to be said.
    pub(crate) fn send(&mut self, body: Body) {
        self.waiting.push_back(body);
    }

    /// The other side is to be spoken to from the beginning.
    pub(crate) fn connect(&mut self) {
        self.forget();
        self.expected = None;
        self.next = CONNECT_SEQ;
        self.send(Body::Connect { version: VERSION });
    }

    /// The other side has said goodbye.
    pub(crate) fn disconnect(&mut self) {
        self.forget();
        self.expected = None;
    }

    pub(crate) const fn is_connected(&self) -> bool {
        self.expected.is_some()
    }

    /// A frame has begun to come and not ended.
    pub(crate) const fn is_within(&self) -> bool {
        self.reader.is_within()
    }

    /// What has not begun to be said is not said; what is under way arrives, and its
    /// answer is nobody's.
    pub(crate) fn break_off(&mut self) {
        self.waiting.clear();
        for frame in &mut self.under_way {
            frame.dropped = true;
        }
    }

    /// How much waits to be said.
    pub(crate) fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// Nothing waits, and everything has been answered.
    pub(crate) fn is_quiet(&self) -> bool {
        self.waiting.is_empty() && self.under_way.is_empty() && self.out.is_empty()
    }

    /// Frames that went out again, so far.
    pub(crate) const fn retries(&self) -> u64 {
        self.retries
    }

    /// Bytes that were part of no frame, so far.
    pub(crate) const fn noise(&self) -> u64 {
        self.reader.noise()
    }

    /// How long an answer may take at this rate: it may stand after a frame of its side,
    /// and a frame before it on ours.
    pub(crate) fn answer_within(&self) -> HostTime {
        ANSWER_WITHIN + self.wire.bytes(2 * LONGEST)
    }

    /// Longer than the other side waits before it gives up.
    pub(crate) fn given_up_after(&self) -> HostTime {
        self.answer_within() * (u32::from(RETRIES) + 2)
    }

    /// No frame has ever come.
    pub(crate) const fn framed_never(&self) -> bool {
        self.framed_at.is_zero()
    }

    /// Since when no frame has come.
    pub(crate) fn silent_for(&self, now: HostTime) -> HostTime {
        now.saturating_sub(self.framed_at)
    }

    /// Since when nothing at all has come.
    pub(crate) fn quiet_for(&self, now: HostTime) -> HostTime {
        now.saturating_sub(self.heard_at)
    }

    /// The bytes that may go to the port now.
    pub(crate) fn due(&self, now: HostTime) -> &[u8] {
        &self.out[..self.wire.due(self.out.len(), now)]
    }

    /// So many of them have gone.
    pub(crate) fn sent(&mut self, count: usize) {
        self.out.drain(..count.min(self.out.len()));
    }

    /// Bytes have come.
    pub(crate) fn hear(&mut self, bytes: &[u8], now: HostTime) {
        if !bytes.is_empty() {
            self.heard_at = now;
            self.reader.give(bytes);
        }
    }

    /// What has happened next. Whoever is asked answers before anything else is heard.
    pub(crate) fn next_event(&mut self, now: HostTime) -> Option<Event> {
        self.repeat(now);
        loop {
            if let Some(event) = self.events.pop_front() {
                return Some(event);
            }
            if self.asked.is_some() {
                break;
            }
            if self.reader.is_within() && now.saturating_sub(self.heard_at) > STALE {
                self.reader.give_up();
            }
            match self.reader.next() {
                Some(Piece::Frame(frame)) => {
                    self.framed_at = now;
                    match frame {
                        Frame::Answer { seq, result } => self.answered(seq, result, now),
                        Frame::Body { seq, body } => self.asked(seq, body, now),
                    }
                }
                Some(Piece::Damaged) => self.complain(now),
                None => break,
            }
        }
        self.begin(now);
        None
    }

    /// Answers what was asked.
    pub(crate) fn answer(&mut self, result: Result<(), Fault>, now: HostTime) {
        let Some(seq) = self.asked.take() else {
            return;
        };
        self.expected = Some(seq.wrapping_add(1));
        if self.answers.len() == REMEMBERED {
            self.answers.pop_front();
        }
        self.answers.push_back((seq, result));
        self.put(&encode_answer(seq, result), now);
    }

    /// Everything that was to be said is dropped, said or not.
    fn forget(&mut self) {
        self.waiting.clear();
        self.under_way.clear();
        self.answers.clear();
        self.asked = None;
    }

    fn put(&mut self, bytes: &[u8], now: HostTime) -> HostTime {
        self.out.extend_from_slice(bytes);
        self.wire.give(bytes.len(), now)
    }

    /// Says what may be said now.
    pub(crate) fn begin(&mut self, now: HostTime) {
        while let Some(body) = self.waiting.front() {
            let is_block = |body: &Body| matches!(body, Body::Data(_) | Body::Entry { .. });
            let beside = self.under_way.len() < WINDOW
                && is_block(body)
                && self.under_way.iter().all(|frame| is_block(&frame.body));
            if !self.under_way.is_empty() && !beside {
                return;
            }
            let Some(body) = self.waiting.pop_front() else {
                return;
            };
            let seq = match body {
                Body::Connect { .. } => CONNECT_SEQ,
                _ => self.next,
            };
            self.next = seq.wrapping_add(1);
            let leaves = self.put(&body.encode(seq), now);
            self.under_way.push_back(UnderWay {
                seq,
                body,
                tries: 0,
                leaves,
                due: leaves + self.answer_within(),
                dropped: false,
            });
        }
    }

    /// Says again what was not answered in time.
    fn repeat(&mut self, now: HostTime) {
        if self.under_way.front().is_some_and(|frame| frame.due <= now) {
            self.say_again(0, now);
        }
    }

    /// Says the frames under way again from one on.
    fn say_again(&mut self, from: usize, now: HostTime) {
        if self.under_way[from].tries >= RETRIES {
            self.forget();
            self.expected = None;
            self.out.clear();
            self.events.push_back(Event::Lost);
            return;
        }
        // A port that takes nothing is not given more.
        let blocked = self.wire.free_at() < now && !self.out.is_empty();
        let within = self.answer_within();
        for at in from..self.under_way.len() {
            let bytes = match blocked {
                true => Vec::new(),
                false => self.under_way[at].body.encode(self.under_way[at].seq),
            };
            let leaves = self.put(&bytes, now);
            let frame = &mut self.under_way[at];
            frame.tries += 1;
            frame.leaves = leaves;
            frame.due = leaves + within;
            self.retries += 1;
        }
    }

    fn answered(&mut self, seq: u8, result: Result<(), Fault>, now: HostTime) {
        let Some(at) = self.under_way.iter().position(|frame| frame.seq == seq) else {
            return;
        };
        match result {
            Err(Fault::Damaged) => {
                // Of a copy that has not arrived yet it cannot speak.
                if self.under_way[at].leaves <= now + LEAD {
                    self.say_again(at, now);
                }
            }
            // The answer to the one before it is lost, and may be another refusal: that one
            // is said again in time.
            Err(_) if at > 0 => {}
            Err(_) => self.conclude(result),
            // Frames are taken in their order: those before it were.
            Ok(()) => (0..=at).for_each(|_| self.conclude(Ok(()))),
        }
    }

    fn conclude(&mut self, result: Result<(), Fault>) {
        let Some(frame) = self.under_way.pop_front() else {
            return;
        };
        if matches!(frame.body, Body::Connect { .. }) && result.is_ok() {
            // Unless it has connected meanwhile by itself.
            self.expected.get_or_insert(FIRST_SEQ);
        }
        if !frame.dropped {
            self.events.push_back(Event::Answered(frame.body, result));
        }
    }

    fn asked(&mut self, seq: u8, body: Result<Body, Fault>, now: HostTime) {
        if matches!(body, Ok(Body::Connect { .. })) {
            self.begin_anew();
        } else {
            let Some(expected) = self.expected else {
                // What was said before our own connection stood is void.
                if self.under_way.is_empty() {
                    self.put(&encode_answer(seq, Err(Fault::Sequence)), now);
                }
                return;
            };
            match seq.wrapping_sub(expected) {
                0 => {}
                128.. => return self.answer_again(seq, now),
                _ => return self.complain(now),
            }
        }
        self.asked = Some(seq);
        match body {
            Ok(body) => self.events.push_back(Event::Asked(body)),
            Err(fault) => {
                self.answer(Err(fault), now);
                self.events.push_back(Event::Strange);
            }
        }
    }

    /// The other side begins: numbers count anew on both ways.
    fn begin_anew(&mut self) {
        let connecting = |frame: &UnderWay| matches!(frame.body, Body::Connect { .. });
        self.under_way.retain(connecting);
        self.waiting
            .retain(|body| matches!(body, Body::Connect { .. }));
        self.answers.clear();
        self.next = FIRST_SEQ;
    }

    fn answer_again(&mut self, seq: u8, now: HostTime) {
        let known = self.answers.iter().find(|(known, _)| *known == seq);
        let result = known.map_or(Ok(()), |(_, result)| *result);
        self.put(&encode_answer(seq, result), now);
    }

    /// Asks for the frame that has not arrived whole.
    fn complain(&mut self, now: HostTime) {
        let Some(expected) = self.expected else {
            return;
        };
        let lately = self.complained.is_some_and(|at| now < at + COMPLAINTS);
        if !lately {
            self.complained = Some(now);
            self.put(&encode_answer(expected, Err(Fault::Damaged)), now);
        }
    }
}
