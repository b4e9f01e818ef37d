//! Messages to the board and blocks from it.

use crate::Traffic;
use crate::step_queue::block::Reader;
use crate::step_queue::commands::Command;
use crate::step_queue::dictionary::Dictionary;
use crate::step_queue::send_queue::{Mark, Message, SendQueue};

/// The wire to a board of timed steps.
#[derive(Clone, Debug)]
pub(super) struct Wire {
    pub(super) dictionary: Dictionary,
    pub(super) reader: Reader,
    pub(super) send_queue: SendQueue,
    pub(super) traffic: Traffic,
}

impl Wire {
    pub(super) fn new() -> Self {
        Self {
            dictionary: Dictionary::default(),
            reader: Reader::default(),
            send_queue: SendQueue::new(),
            traffic: Traffic::default(),
        }
    }

    /// Forgets the board: which block it expects is learned anew.
    pub(super) fn begin(&mut self) {
        self.dictionary = Dictionary::default();
        self.reader.forget();
        self.send_queue.begin();
    }

    /// Figures of the wire.
    pub(super) const fn traffic(&self) -> Traffic {
        let mut traffic = self.traffic;
        traffic.lines = self.send_queue.blocks;
        traffic.resent = self.send_queue.resent;
        traffic.garbage = self.reader.garbage;
        traffic
    }

    /// Bytes to be written to the port.
    pub(super) fn tx(&self) -> &[u8] {
        &self.send_queue.outgoing
    }

    /// So many of them were written.
    pub(super) fn consumed(&mut self, count: usize) {
        let count = count.min(self.send_queue.outgoing.len());
        self.send_queue.outgoing.drain(..count);
        self.traffic.sent += count as u64;
    }

    fn plain(&self, command: Command, arguments: &[i64]) -> Message {
        Message::plain(self.dictionary.message(command, arguments))
    }

    /// Whenever there is room.
    pub(super) fn send(&mut self, command: Command, arguments: &[i64]) {
        let message = self.plain(command, arguments);
        self.send_queue.push(message);
    }

    /// Before everything that waits.
    pub(super) fn send_urgent(&mut self, command: Command, arguments: &[i64]) {
        let message = self.plain(command, arguments);
        self.send_queue.push_urgent(message);
    }

    /// Before everything that waits, and without effect from this clock on.
    pub(super) fn send_urgent_until(&mut self, command: Command, arguments: &[i64], due: u64) {
        let message = Message {
            due: Some(due),
            ..self.plain(command, arguments)
        };
        self.send_queue.push_urgent(message);
    }

    /// A question whose reply must not be mistaken for an older one.
    pub(super) fn send_query(&mut self, command: Command, arguments: &[i64], mark: Mark) {
        let message = Message {
            mark: Some(mark),
            ..self.plain(command, arguments)
        };
        self.send_queue.push_urgent(message);
    }

    /// Something the board must have before a clock; dropped when motion is.
    pub(super) fn send_timed(&mut self, command: Command, arguments: &[i64], due: u64) {
        let message = Message {
            due: Some(due),
            motion: true,
            vital: true,
            ..self.plain(command, arguments)
        };
        self.send_queue.push(message);
    }

    /// Steps of an axis, the first at a clock.
    pub(super) fn send_steps(&mut self, axis: usize, arguments: &[i64], due: u64) {
        let message = Message {
            due: Some(due),
            motion: true,
            axis: Some(axis),
            vital: true,
            ..self.plain(Command::QueueStep, arguments)
        };
        self.send_queue.push(message);
    }

    /// Without it the axes must not move; no stop takes it back.
    pub(super) fn send_vital(
        &mut self,
        command: Command,
        arguments: &[i64],
        due: u64,
        mark: Option<Mark>,
    ) {
        let message = Message {
            due: Some(due),
            vital: true,
            mark,
            ..self.plain(command, arguments)
        };
        self.send_queue.push(message);
    }
}
