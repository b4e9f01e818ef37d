//! Plays an operator script on the machine of a task and records it.

use gsk_history::machine_part::PartInput;
use gsk_history::moment::{HistoryInput, MachineMoment, RecordedInput, state_hash};
use gsk_history::recording::{FORMAT, RecordingEncoder, RecordingEvent};
use gsk_messages::{Message, say};
use gsk_panel::emulator::{EmulatorInput, StampedInput};
use gsk_panel::script::{Runner, Script, ScriptAction, ScriptError, ScriptProgress};

use crate::task::ExerciseTask;

/// Interval between two hashes in a recording, ticks.
const HASH_INTERVAL_TICKS: u64 = 10_000;

/// A script that solves a task, checked for what an operator can do.
#[derive(Clone, Debug)]
pub struct SolutionScript {
    script: Script,
}

impl SolutionScript {
    /// Reads a script.
    ///
    /// # Errors
    /// A line is invalid, or no operator can do what it does.
    pub fn read(text: &str) -> Result<Self, Message> {
        let script = Script::parse(text)
            .map_err(|errors| say::several(errors.iter().map(ScriptError::message)))?;
        let is_by_operator = |action: &ScriptAction| {
            matches!(
                action,
                ScriptAction::Press(_)
                    | ScriptAction::Hold(..)
                    | ScriptAction::Down(_)
                    | ScriptAction::Up(_)
                    | ScriptAction::Type(_)
                    | ScriptAction::Turn(..)
                    | ScriptAction::Power(_)
                    | ScriptAction::Fault(_, false)
                    | ScriptAction::Wait(_)
                    | ScriptAction::WaitFor(..)
                    | ScriptAction::Expect(_)
            )
        };
        let mut lines = script.lines.iter();
        if let Some(line) = lines.find(|line| !is_by_operator(&line.action)) {
            let rule = say::exercise_not_by_operator(&line.text);
            return Err(say::in_line(line.number, rule));
        }
        Ok(Self { script })
    }
}

/// Records a machine in memory.
struct MemoryRecorder {
    encoder: RecordingEncoder,
    bytes: Vec<u8>,
}

impl MemoryRecorder {
    fn new() -> Self {
        let mut bytes = Vec::new();
        let encoder = RecordingEncoder::new(&mut bytes);
        Self { encoder, bytes }
    }

    fn add(&mut self, event: &RecordingEvent) -> Result<(), Message> {
        self.encoder
            .encode(event, &mut self.bytes)
            .map_err(say::as_written)
    }

    fn add_inputs(&mut self, inputs: Vec<StampedInput>) -> Result<(), Message> {
        for StampedInput { tick, input } in inputs {
            let input = HistoryInput::Machine(input);
            self.add(&RecordingEvent::Input(Box::new(RecordedInput {
                tick,
                input,
            })))?;
        }
        Ok(())
    }

    fn add_hash(&mut self, moment: &MachineMoment) -> Result<(), Message> {
        match state_hash(&moment.emulator) {
            Some(hash) => self.add(&RecordingEvent::Hash {
                tick: moment.ticks(),
                hash,
            }),
            None => Ok(()),
        }
    }
}

/// Plays a script on the machine of a task and returns the recording. `program_version` is the
/// version of the program that records.
///
/// # Errors
/// The start state cannot be created, or a line of the script fails.
pub fn record_solution(
    task: &ExerciseTask,
    solution: &SolutionScript,
    program_version: &str,
) -> Result<Vec<u8>, Message> {
    let mut moment = task.create_start()?;
    let mut recorder = MemoryRecorder::new();
    recorder.add(&RecordingEvent::Start {
        format: FORMAT,
        program: program_version.to_owned(),
    })?;
    let part: Vec<PartInput> = moment.part.inputs_for_uncut().into();
    recorder.add(&RecordingEvent::State {
        emulator: Box::new(moment.emulator.clone()),
        part,
    })?;
    moment.emulator.record_inputs();
    let end = moment.ticks() + task.time_limit_ms;
    let mut runner = Runner::new(solution.script.clone());
    loop {
        // Only the actions that are due: the tick itself cuts the part, too.
        let progress = runner.advance(&mut moment.emulator, 0);
        recorder.add_inputs(moment.emulator.take_inputs())?;
        match progress {
            ScriptProgress::Running => {}
            ScriptProgress::Failed(failure) => return Err(failure.message()),
            ScriptProgress::Finished | ScriptProgress::Effect(_) => break,
        }
        if moment.ticks() >= end {
            break;
        }
        let collision = moment.tick();
        let simulation = moment.emulator.simulation();
        let faults = collision.and_then(|finding| moment.part.crash_faults(&finding, simulation));
        for fault in faults.into_iter().flatten() {
            moment.emulator.apply(EmulatorInput::Fault(fault, true));
        }
        recorder.add_inputs(moment.emulator.take_inputs())?;
        if moment.ticks().is_multiple_of(HASH_INTERVAL_TICKS) {
            recorder.add(&RecordingEvent::Reached(moment.ticks()))?;
            recorder.add_hash(&moment)?;
        }
    }
    recorder.add_hash(&moment)?;
    recorder.add(&RecordingEvent::End(moment.ticks()))?;
    Ok(recorder.bytes)
}
