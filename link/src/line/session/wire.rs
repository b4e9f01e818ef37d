//! Bytes to and from a line board, and its unanswered lines.
//!
//! Flow control counts characters: unanswered lines never exceed the receive buffer of the
//! board. Real-time characters (`?`, `!`, Ctrl-X) do not count.

use std::collections::VecDeque;

use crate::line::realtime::STATUS_QUERY;
use crate::{HostTime, Traffic};

/// Greatest length of a line from the board, bytes; the rest of a longer line is dropped.
const LINE_BYTES: usize = 512;

/// A line that was sent and that the board has not answered yet.
#[derive(Clone, Debug)]
pub(super) struct Unanswered {
    bytes: usize,
    pub(super) is_segment: bool,
    pub(super) sent: HostTime,
}

/// The serial traffic with a line board: bytes to send, and unanswered lines.
#[derive(Clone, Debug, Default)]
pub(super) struct LineWire {
    outgoing: Vec<u8>,
    /// The received bytes of a line that is not complete yet.
    line: Vec<u8>,
    unanswered: VecDeque<Unanswered>,
    pub(super) traffic: Traffic,
}

impl LineWire {
    /// Queues a line for the port, with a line end if it has none, and counts it as unanswered.
    /// `is_segment`: the line is a motion segment.
    pub(super) fn send(&mut self, line: &str, is_segment: bool, now: HostTime) {
        self.outgoing.extend_from_slice(line.as_bytes());
        let ends = line.ends_with('\n');
        if !ends {
            self.outgoing.push(b'\n');
        }
        self.traffic.lines += 1;
        self.traffic.segments += u64::from(is_segment);
        self.unanswered.push_back(Unanswered {
            bytes: line.len() + usize::from(!ends),
            is_segment,
            sent: now,
        });
    }

    /// Queues a real-time character for the port.
    pub(super) fn send_realtime(&mut self, byte: u8) {
        self.outgoing.push(byte);
    }

    /// Returns the bytes to be written to the port.
    pub(super) fn tx(&self) -> &[u8] {
        &self.outgoing
    }

    /// Removes the first `count` bytes, which the port has written.
    pub(super) fn consumed(&mut self, count: usize) {
        let count = count.min(self.outgoing.len());
        self.outgoing.drain(..count);
        self.traffic.sent += count as u64;
    }

    /// Drops all bytes that the port has not written yet.
    pub(super) fn drop_outgoing(&mut self) {
        self.outgoing.clear();
    }

    /// Drops all bytes that the port has not taken. Returns true if they contained more than
    /// status queries.
    pub(super) fn withdraw(&mut self) -> bool {
        let lines = self.outgoing.iter().any(|byte| *byte != STATUS_QUERY);
        self.outgoing.clear();
        lines
    }

    /// Takes a byte from the board and returns the line that ends with this byte, without its line
    /// end; `None` for an empty or incomplete line. Characters beyond the greatest length are
    /// dropped.
    pub(super) fn receive(&mut self, byte: u8) -> Option<String> {
        match byte {
            b'\n' | b'\r' => {
                let line = core::mem::take(&mut self.line);
                (!line.is_empty()).then(|| String::from_utf8_lossy(&line).into_owned())
            }
            _ => {
                if self.line.len() < LINE_BYTES {
                    self.line.push(byte);
                }
                None
            }
        }
    }

    /// Drops the received bytes of a line that is not complete yet.
    pub(super) fn drop_partial_line(&mut self) {
        self.line.clear();
    }

    /// Removes and returns the oldest unanswered line; `None` without one.
    pub(super) fn answered(&mut self) -> Option<Unanswered> {
        self.unanswered.pop_front()
    }

    /// Returns the oldest unanswered line; `None` if the board has answered all lines.
    pub(super) fn oldest(&self) -> Option<&Unanswered> {
        self.unanswered.front()
    }

    /// Whether the board has answered all lines.
    pub(super) fn is_answered(&self) -> bool {
        self.unanswered.is_empty()
    }

    /// Whether all unanswered lines are segments of motion.
    pub(super) fn only_segments(&self) -> bool {
        self.unanswered.iter().all(|line| line.is_segment)
    }

    /// Returns the number of characters in all unanswered lines: the board's receive buffer holds
    /// at most these.
    pub(super) fn characters(&self) -> usize {
        self.unanswered.iter().map(|line| line.bytes).sum()
    }

    /// Discards the list of unanswered lines: no answers to them are expected any more.
    pub(super) fn forget_unanswered(&mut self) {
        self.unanswered.clear();
    }

    /// Extends the time limits by `gap`, the time during which the host was suspended.
    pub(super) fn skip_absence(&mut self, gap: HostTime) {
        for line in &mut self.unanswered {
            line.sent += gap;
        }
    }
}
