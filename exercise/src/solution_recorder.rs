//! Records a solution in memory: the start state, the inputs of the operator, hashes.

use gsk_history::machine_part::PartInput;
use gsk_history::moment::{MachineMoment, RecordedInput, state_hash};
use gsk_history::recording::{FORMAT, RecordingEncoder, RecordingEvent};
use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;

/// Interval between two hashes in a recording, ticks.
const HASH_INTERVAL_TICKS: u64 = 10_000;

/// The recording of a solution as far as it has come.
#[derive(Debug)]
pub struct SolutionRecorder {
    encoder: RecordingEncoder,
    bytes: Vec<u8>,
}

impl SolutionRecorder {
    /// Begins in the start state of a task. `program_version` is the version of the program that
    /// records.
    ///
    /// # Errors
    /// The state cannot be written.
    pub fn begin(start: &MachineMoment, program_version: &str) -> Result<Self, Message> {
        let mut bytes = Vec::new();
        let encoder = RecordingEncoder::new(&mut bytes);
        let mut recorder = Self { encoder, bytes };
        recorder.add(&RecordingEvent::Start {
            format: FORMAT,
            program: program_version.to_owned(),
        })?;
        let part: Vec<PartInput> = start.part.inputs_for_uncut().into();
        recorder.add(&RecordingEvent::State {
            emulator: Box::new(start.emulator.clone()),
            part,
        })?;
        Ok(recorder)
    }

    fn add(&mut self, event: &RecordingEvent) -> Result<(), Message> {
        self.encoder
            .encode(event, &mut self.bytes)
            .map_err(say::as_written)
    }

    /// Adds inputs, the oldest first.
    ///
    /// # Errors
    /// An input cannot be written.
    pub fn add_inputs(
        &mut self,
        inputs: impl IntoIterator<Item = RecordedInput>,
    ) -> Result<(), Message> {
        for input in inputs {
            self.add(&RecordingEvent::Input(Box::new(input)))?;
        }
        Ok(())
    }

    /// Adds a hash of the machine if one is due after a tick.
    ///
    /// # Errors
    /// The hash cannot be written.
    pub fn follow_tick(&mut self, emulator: &Emulator) -> Result<(), Message> {
        if !emulator.ticks().is_multiple_of(HASH_INTERVAL_TICKS) {
            return Ok(());
        }
        self.add(&RecordingEvent::Reached(emulator.ticks()))?;
        self.add_hash(emulator)
    }

    fn add_hash(&mut self, emulator: &Emulator) -> Result<(), Message> {
        match state_hash(emulator) {
            Some(hash) => self.add(&RecordingEvent::Hash {
                tick: emulator.ticks(),
                hash,
            }),
            None => Ok(()),
        }
    }

    /// Ends the recording in a state and returns it.
    ///
    /// # Errors
    /// The end cannot be written.
    pub fn finish(mut self, emulator: &Emulator) -> Result<Vec<u8>, Message> {
        self.add_hash(emulator)?;
        self.add(&RecordingEvent::End(emulator.ticks()))?;
        Ok(self.bytes)
    }
}
