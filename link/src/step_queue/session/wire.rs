//! Sends messages to the board and reads its blocks.

use crate::Traffic;
use crate::step_queue::block::Reader;
use crate::step_queue::commands::Command;
use crate::step_queue::dictionary::Dictionary;
use crate::step_queue::send_queue::{Mark, QueuedMessage, SendQueue};

/// The serial traffic with a Klipper board: dictionary, reader and send queue.
#[derive(Clone, Debug)]
pub(super) struct StepQueueWire {
    pub(super) dictionary: Dictionary,
    pub(super) reader: Reader,
    pub(super) send_queue: SendQueue,
    pub(super) traffic: Traffic,
}

impl StepQueueWire {
    pub(super) fn new() -> Self {
        Self {
            dictionary: Dictionary::default(),
            reader: Reader::default(),
            send_queue: SendQueue::new(),
            traffic: Traffic::default(),
        }
    }

    /// Forgets the dictionary and all messages, and starts to query the sequence number that the
    /// board expects.
    pub(super) fn begin(&mut self) {
        self.dictionary = Dictionary::default();
        self.reader.forget();
        self.send_queue.begin();
    }

    /// Returns the counters of the serial traffic.
    pub(super) const fn traffic(&self) -> Traffic {
        let mut traffic = self.traffic;
        traffic.lines = self.send_queue.blocks;
        traffic.resent = self.send_queue.resent;
        traffic.garbage = self.reader.garbage;
        traffic
    }

    /// Returns the bytes to be written to the port.
    pub(super) fn tx(&self) -> &[u8] {
        &self.send_queue.outgoing
    }

    /// Removes the first `count` bytes, which the port has written.
    pub(super) fn consumed(&mut self, count: usize) {
        let count = count.min(self.send_queue.outgoing.len());
        self.send_queue.outgoing.drain(..count);
        self.traffic.sent += count as u64;
    }

    fn plain(&self, command: Command, arguments: &[i64]) -> QueuedMessage {
        QueuedMessage::plain(self.dictionary.message(command, arguments))
    }

    /// Queues a command after the waiting messages.
    pub(super) fn send(&mut self, command: Command, arguments: &[i64]) {
        let message = self.plain(command, arguments);
        self.send_queue.push(message);
    }

    /// Queues a command before the waiting messages.
    pub(super) fn send_urgent(&mut self, command: Command, arguments: &[i64]) {
        let message = self.plain(command, arguments);
        self.send_queue.push_urgent(message);
    }

    /// Queues a command before the waiting messages. The command is dropped if it would arrive
    /// after the board clock `due`, ticks.
    pub(super) fn send_urgent_until(&mut self, command: Command, arguments: &[i64], due: u64) {
        let message = QueuedMessage {
            due: Some(due),
            ..self.plain(command, arguments)
        };
        self.send_queue.push_urgent(message);
    }

    /// Queues a query before the waiting messages. `mark` is its kind: replies to older queries of
    /// this kind no longer count.
    pub(super) fn send_query(&mut self, command: Command, arguments: &[i64], mark: Mark) {
        let message = QueuedMessage {
            mark: Some(mark),
            ..self.plain(command, arguments)
        };
        self.send_queue.push_urgent(message);
    }

    /// Queues a command of the motion. The link stops the axes if the command cannot arrive before
    /// the board clock `due`, ticks.
    pub(super) fn send_timed(&mut self, command: Command, arguments: &[i64], due: u64) {
        let message = QueuedMessage {
            due: Some(due),
            motion: true,
            vital: true,
            ..self.plain(command, arguments)
        };
        self.send_queue.push(message);
    }

    /// Queues a run of steps of an axis (0 for X, 1 for Z); its first step is at the board clock
    /// `due`, ticks.
    pub(super) fn send_steps(&mut self, axis: usize, arguments: &[i64], due: u64) {
        let message = QueuedMessage {
            due: Some(due),
            motion: true,
            axis: Some(axis),
            vital: true,
            ..self.plain(Command::QueueStep, arguments)
        };
        self.send_queue.push(message);
    }

    /// Queues a command. The link stops the axes if the command cannot arrive before the board
    /// clock `due`, ticks. A stop does not drop the command. `mark` is the kind of a query; `None`
    /// for other commands.
    pub(super) fn send_vital(
        &mut self,
        command: Command,
        arguments: &[i64],
        due: u64,
        mark: Option<Mark>,
    ) {
        let message = QueuedMessage {
            due: Some(due),
            vital: true,
            mark,
            ..self.plain(command, arguments)
        };
        self.send_queue.push(message);
    }
}
