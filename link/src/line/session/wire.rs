//! Bytes to and from the board, and the lines it has not answered.
//!
//! The board is fed by counting characters: those of unanswered lines never exceed its
//! receive buffer. Real-time characters (`?`, `!`, Ctrl-X) are not counted.

use std::collections::VecDeque;

use crate::line::realtime::STATUS_QUERY;
use crate::{HostTime, Traffic};

/// No line of a board is longer.
const LINE_BYTES: usize = 512;

/// A line that the board has not answered.
#[derive(Clone, Debug)]
pub(super) struct Unanswered {
    bytes: usize,
    pub(super) is_segment: bool,
    pub(super) sent: HostTime,
}

/// The wire to a board that reads lines.
#[derive(Clone, Debug, Default)]
pub(super) struct Wire {
    outgoing: Vec<u8>,
    /// The line that is coming in.
    line: Vec<u8>,
    unanswered: VecDeque<Unanswered>,
    pub(super) traffic: Traffic,
}

impl Wire {
    /// Sends a line; its end is added where it is missing.
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

    /// Sends a character that acts at once, wherever the board is in its lines.
    pub(super) fn send_realtime(&mut self, byte: u8) {
        self.outgoing.push(byte);
    }

    /// Bytes to be written to the port.
    pub(super) fn tx(&self) -> &[u8] {
        &self.outgoing
    }

    /// So many of them were written.
    pub(super) fn consumed(&mut self, count: usize) {
        let count = count.min(self.outgoing.len());
        self.outgoing.drain(..count);
        self.traffic.sent += count as u64;
    }

    /// What has not been written never will be.
    pub(super) fn drop_outgoing(&mut self) {
        self.outgoing.clear();
    }

    /// What has not been written is withdrawn; whether lines are among it.
    pub(super) fn withdraw(&mut self) -> bool {
        let lines = self.outgoing.iter().any(|byte| *byte != STATUS_QUERY);
        self.outgoing.clear();
        lines
    }

    /// Takes a byte in; the line that ends with it, unless that is empty. What a line is
    /// too long by is lost.
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

    /// What came of a line that will never end is dropped.
    pub(super) fn drop_partial_line(&mut self) {
        self.line.clear();
    }

    /// The board has answered a line: the oldest.
    pub(super) fn answered(&mut self) -> Option<Unanswered> {
        self.unanswered.pop_front()
    }

    /// The oldest line that is not answered.
    pub(super) fn oldest(&self) -> Option<&Unanswered> {
        self.unanswered.front()
    }

    /// Whether the board has answered everything.
    pub(super) fn is_answered(&self) -> bool {
        self.unanswered.is_empty()
    }

    /// Whether nothing but motion waits for its answer.
    pub(super) fn only_segments(&self) -> bool {
        self.unanswered.iter().all(|line| line.is_segment)
    }

    /// Characters in the receive buffer of the board, at most.
    pub(super) fn characters(&self) -> usize {
        self.unanswered.iter().map(|line| line.bytes).sum()
    }

    /// No answer is waited for any more.
    pub(super) fn forget_unanswered(&mut self) {
        self.unanswered.clear();
    }

    /// While the computer was away nobody waited for answers.
    pub(super) fn skip_absence(&mut self, gap: HostTime) {
        for line in &mut self.unanswered {
            line.sent += gap;
        }
    }
}
