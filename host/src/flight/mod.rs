//! The flight recorder: writes the inputs of the machine into files while it runs, so that a
//! session can be replayed after the program has ended, also by a crash.
//!
//! The kernel collects the events; a task writes them. Once a second everything collected is
//! handed over, so that a killed program loses at most the last second.

mod disk;
pub mod solution_log;
mod unfinished;

use std::io;
use std::path::PathBuf;

use crossbeam::channel::{Receiver, Sender, TrySendError, bounded};
use gsk_history::board_exchange::{BoardStep, StampedStep};
use gsk_history::machine_part::{MachinePart, PartInput};
use gsk_history::moment::{HistoryInput, RecordedInput, state_hash};
use gsk_history::recording::{FORMAT, RecordingEncoder, RecordingEvent, join_exchange};
use gsk_messages::{Message, say};
use gsk_panel::emulator::{Emulator, StampedInput};
use tracing::error;

use crate::platform::{self, TaskHandle};
use disk::{DiskJob, RecordingDisk};
pub use unfinished::offer_unfinished;

/// Name of the folder in a data directory that holds the recordings.
pub const FOLDER: &str = "recordings";
/// Least interval between two hashes, ticks (ms of machine time).
const HASH_INTERVAL_TICKS: u64 = 10_000;
/// Size at which a recording in a folder continues in a new file, bytes.
const MAX_FILE_BYTES: usize = 5_000_000;
/// Size at which the exchange with a board is no longer recorded in a folder, bytes: 10
/// minutes of motion. It cannot continue in a new file, because the state of the link is in no file.
const MAX_BOARD_FILE_BYTES: usize = 15_000_000;
/// Number of parcels that wait for the disk; more are kept until the disk is faster.
const DISK_QUEUE: usize = 16;

/// The folder or file into which a recording is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RecordingTarget {
    /// The recordings are numbered files in this folder; the oldest are removed.
    Folder(PathBuf),
    /// The recording is this file, of any size.
    File(PathBuf),
}

/// Records all inputs of one machine, so that it can be replayed.
#[derive(Debug)]
pub struct FlightRecorder {
    target: RecordingTarget,
    encoder: Option<RecordingEncoder>,
    /// Recorded bytes that were not passed to the disk yet.
    pending: Vec<u8>,
    file_bytes: usize,
    /// Whether the current file has a state from which its inputs continue.
    has_state: bool,
    /// Whether the exchange with the board is recorded, from the opening of its link on.
    follows_board: bool,
    last_tick: u64,
    next_hash: u64,
    to_disk: Option<Sender<DiskJob>>,
    failures: Receiver<Message>,
    task: Option<TaskHandle>,
}

impl FlightRecorder {
    /// Starts to record; the first state is stored when the machine is first followed.
    ///
    /// # Errors
    /// The system starts no thread.
    pub fn start(target: RecordingTarget) -> io::Result<Self> {
        let (to_disk, from_kernel) = bounded(DISK_QUEUE);
        let (report, failures) = bounded(1);
        let mut disk = RecordingDisk::new(target.clone());
        let task = platform::start_task("recorder", move || {
            let Ok(job) = platform::receive(&from_kernel, None) else {
                return false;
            };
            match disk.execute(&job) {
                Ok(()) => true,
                Err(message) => {
                    let _ = report.try_send(message);
                    false
                }
            }
        })?;
        Ok(Self {
            target,
            encoder: None,
            pending: Vec::new(),
            file_bytes: 0,
            has_state: false,
            follows_board: false,
            last_tick: 0,
            next_hash: 0,
            to_disk: Some(to_disk),
            failures,
            task: Some(task),
        })
    }

    /// Decides whether the exchange with a board is recorded; call it before [`Self::follow`].
    /// `steps` are those since the last call. A recording that does not contain the opening of
    /// the link is interrupted while a board moves the slides.
    pub fn follow_board(&mut self, steps: &[StampedStep], has_board: bool) {
        let is_opening = |it: &StampedStep| matches!(it.step, BoardStep::Opened { .. });
        self.follows_board |= self.has_state && steps.iter().any(is_opening);
        if has_board && !self.follows_board {
            self.interrupt();
        }
    }

    /// Whether the exchange with a board is recorded.
    pub const fn follows_board(&self) -> bool {
        self.follows_board
    }

    /// Records the inputs that the machine has received since the last call, and the exchange
    /// with a board.
    pub fn follow(
        &mut self,
        machine: &Emulator,
        part: &MachinePart,
        inputs: &[RecordedInput],
        steps: &[StampedStep],
    ) {
        if self.to_disk.is_none() {
            return;
        }
        self.last_tick = machine.ticks();
        if !self.has_state {
            return self.store_state(machine, part);
        }
        let steps = if self.follows_board { steps } else { &[] };
        for event in join_exchange(inputs, steps) {
            self.add(&event);
        }
        if steps
            .last()
            .is_some_and(|last| last.step == BoardStep::Closed)
        {
            self.follows_board = false;
        }
    }

    /// Starts a file with the current state. The inputs up to now are part of it.
    fn store_state(&mut self, machine: &Emulator, part: &MachinePart) {
        if self.encoder.is_none() {
            self.encoder = Some(RecordingEncoder::new(&mut self.pending));
            self.add(&RecordingEvent::Start {
                format: FORMAT,
                program: env!("CARGO_PKG_VERSION").to_owned(),
            });
        }
        self.add(&RecordingEvent::State {
            emulator: Box::new(machine.clone()),
            part: part.inputs_for_uncut(),
        });
        self.has_state = true;
        // The first hash follows with the next hand-over: short recordings are compared, too.
        self.next_hash = machine.ticks() + 1;
    }

    /// Ends the recorded section, because a pulse board moves the slides and its exchange is not
    /// recorded. The next call of [`Self::follow`] begins another one.
    fn interrupt(&mut self) {
        self.follows_board = false;
        if self.has_state {
            self.add(&RecordingEvent::BoardLinked(self.last_tick));
            self.has_state = false;
        }
    }

    /// Ends the recorded section, because the machine went back to a past moment. The next call
    /// of [`Self::follow`] begins another one.
    pub fn begin_section(&mut self) {
        if self.has_state {
            self.add(&RecordingEvent::Reached(self.last_tick));
            self.has_state = false;
        }
    }

    fn add(&mut self, event: &RecordingEvent) {
        let Some(encoder) = &mut self.encoder else {
            return;
        };
        if let Err(error) = encoder.encode(event, &mut self.pending) {
            error!("an event is not recorded: {error}");
        }
    }

    /// Adds the hash of the state. It takes as long as two hundred ticks: in a fast run there
    /// is one a second.
    fn add_hash(&mut self, machine: &Emulator) {
        let tick = machine.ticks();
        if tick >= self.next_hash
            && let Some(hash) = state_hash(machine)
        {
            self.next_hash = tick + HASH_INTERVAL_TICKS;
            self.add(&RecordingEvent::Hash { tick, hash });
        }
    }

    /// Hands everything recorded over to the disk, with the hash of the machine if it is due.
    /// Call it once a second, after [`Self::follow`]. Returns the reason if the disk has
    /// failed; the recording has then ended.
    pub fn flush(&mut self, machine: &Emulator) -> Option<Message> {
        if let Ok(message) = self.failures.try_recv() {
            self.to_disk = None;
            return Some(say::flight_not_recorded(message));
        }
        if self.has_state && self.to_disk.is_some() {
            self.add(&RecordingEvent::Reached(self.last_tick));
            self.add_hash(machine);
        }
        self.hand_over();
        let limit = match self.follows_board {
            true => MAX_BOARD_FILE_BYTES,
            false => MAX_FILE_BYTES,
        };
        let is_full = matches!(self.target, RecordingTarget::Folder(_))
            && self.file_bytes > limit
            && self.pending.is_empty();
        if is_full {
            if self.follows_board {
                self.interrupt();
            }
            self.add(&RecordingEvent::End(self.last_tick));
            self.hand_over();
            self.encoder = None;
            self.has_state = false;
            self.file_bytes = 0;
        }
        None
    }

    /// Gives the pending bytes to the task, unless its queue is full.
    fn hand_over(&mut self) {
        let Some(to_disk) = self.to_disk.as_ref().filter(|_| !self.pending.is_empty()) else {
            return;
        };
        let bytes = core::mem::take(&mut self.pending);
        let length = bytes.len();
        let is_first = self.file_bytes == 0;
        match to_disk.try_send(DiskJob { is_first, bytes }) {
            Ok(()) => self.file_bytes += length,
            Err(TrySendError::Full(job) | TrySendError::Disconnected(job)) => {
                self.pending = job.bytes;
            }
        }
    }

    /// Ends the recording and waits until it is on the disk. `is_complete`: the session ends
    /// properly, not by a crash of the program.
    pub fn finish(mut self, is_complete: bool) {
        if self.has_state && is_complete {
            self.add(&RecordingEvent::End(self.last_tick));
        }
        if let Some(to_disk) = self.to_disk.take()
            && !self.pending.is_empty()
        {
            let is_first = self.file_bytes == 0;
            let bytes = core::mem::take(&mut self.pending);
            // A disk that has failed needs no more bytes.
            let _ = to_disk.send(DiskJob { is_first, bytes });
        }
        if let Some(task) = self.task.take() {
            task.finish();
        }
    }
}

/// Joins the inputs of machine and part, which do not depend on each other.
pub fn join_inputs(
    tick: u64,
    machine: Vec<StampedInput>,
    part: Vec<PartInput>,
) -> Vec<RecordedInput> {
    let machine = machine.into_iter().map(|stamped| RecordedInput {
        tick: stamped.tick,
        input: HistoryInput::Machine(stamped.input),
    });
    let part = part.into_iter().map(|input| RecordedInput {
        tick,
        input: HistoryInput::Part(input),
    });
    machine.chain(part).collect()
}

#[cfg(test)]
mod tests;
