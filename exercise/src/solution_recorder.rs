//! Records a solution in memory: the start state, the inputs of the operator, hashes.

use gsk_history::machine_part::PartInput;
use gsk_history::moment::{MachineMoment, RecordedInput, state_hash};
use gsk_history::recording::{
    FORMAT, RecordingEncoder, RecordingError, RecordingEvent, RecordingReader,
};
use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;

use crate::solution_replay::{JudgeError, replay_solution};
use crate::task::ExerciseTask;

/// Time between two hashes of the machine state in a recording, ticks of 1 ms.
const HASH_INTERVAL_TICKS: u64 = 10_000;

/// The recording of a solution that is being made.
#[derive(Debug)]
pub struct SolutionRecorder {
    encoder: RecordingEncoder,
    bytes: Vec<u8>,
}

impl SolutionRecorder {
    /// Begins a recording in the start state of a task. `program_version` is the version of this
    /// program.
    ///
    /// # Errors
    ///
    /// The state cannot be written.
    pub fn begin(start: &MachineMoment, program_version: &str) -> Result<Self, Message> {
        let mut bytes = Vec::new();
        let encoder = RecordingEncoder::new(&mut bytes);
        let mut recorder = Self { encoder, bytes };
        recorder.add(&RecordingEvent::Start {
            format: FORMAT,
            program: program_version.to_owned(),
        })?;
        let part: Vec<PartInput> = start.part.inputs_for_uncut();
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

    /// Adds inputs of the learner to the recording, the oldest first.
    ///
    /// # Errors
    ///
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

    /// Adds a hash of the machine state, if one is due after this tick.
    ///
    /// # Errors
    ///
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

    /// Continues an interrupted recording, and returns the recorder with the machine
    /// where the recording ends.
    ///
    /// # Errors
    /// The recording is damaged before its last frame, or no operator made it on the machine of
    /// the task.
    pub fn resume(
        task: &ExerciseTask,
        recording: &[u8],
    ) -> Result<(Self, MachineMoment), JudgeError> {
        let mut bytes = Vec::new();
        let encoder = RecordingEncoder::new(&mut bytes);
        let mut recorder = Self { encoder, bytes };
        let mut reader = RecordingReader::new(recording).map_err(JudgeError::Recording)?;
        loop {
            match reader.next_event() {
                // An end: of a solution that was handed in, but whose result was not written.
                // An incomplete frame: the last one, which a power failure cuts off.
                Ok(Some(RecordingEvent::End(_)) | None) | Err(RecordingError::Incomplete(_)) => {
                    break;
                }
                Ok(Some(event)) => recorder.add(&event).map_err(JudgeError::Start)?,
                Err(error) => return Err(JudgeError::Recording(error)),
            }
        }
        let start = task.create_start().map_err(JudgeError::Start)?;
        let end = replay_solution(start, (), &recorder.bytes)?.end;
        Ok((recorder, end.ok_or(JudgeError::Incomplete)?))
    }

    /// Returns the recording so far.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Records the current tick, so that an interrupted recording continues from it.
    ///
    /// # Errors
    ///
    /// The tick cannot be written.
    pub fn mark_tick(&mut self, emulator: &Emulator) -> Result<(), Message> {
        self.add(&RecordingEvent::Reached(emulator.ticks()))
    }

    /// Ends the recording in the current machine state and returns its bytes.
    ///
    /// # Errors
    ///
    /// The end cannot be written.
    pub fn finish(mut self, emulator: &Emulator) -> Result<Vec<u8>, Message> {
        self.add_hash(emulator)?;
        self.add(&RecordingEvent::End(emulator.ticks()))?;
        Ok(self.bytes)
    }
}
