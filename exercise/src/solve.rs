//! Plays an operator script on the machine of a task and records it.

use gsk_history::moment::{HistoryInput, MachineMoment, RecordedInput};
use gsk_messages::{Message, say};
use gsk_panel::emulator::StampedInput;
use gsk_panel::script::{Runner, Script, ScriptAction, ScriptError, ScriptProgress};
use gsk_workpiece::region::Region;

use crate::solution_recorder::SolutionRecorder;
use crate::task::ExerciseTask;

/// A script that solves a task, checked to contain only actions that an operator can do.
#[derive(Clone, Debug)]
pub struct SolutionScript {
    script: Script,
}

impl SolutionScript {
    /// Reads and checks a script.
    ///
    /// # Errors
    ///
    /// A line is invalid, or contains an action that no operator can do.
    pub fn read(text: &str) -> Result<Self, Message> {
        let script = Script::parse(text)
            .map_err(|errors| say::several(errors.iter().map(ScriptError::message)))?;
        let is_by_operator = |action: &ScriptAction| {
            action.is_by_hand()
                || matches!(
                    action,
                    ScriptAction::Power(_)
                        | ScriptAction::Fault(_, false)
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

/// Plays a script on the machine of a task and returns the recording. `program_version` is the
/// version of this program.
///
/// # Errors
///
/// The start state cannot be created, or a line of the script fails.
pub fn record_solution(
    task: &ExerciseTask,
    solution: &SolutionScript,
    program_version: &str,
) -> Result<Vec<u8>, Message> {
    Ok(play_solution(task, solution, program_version)?.0)
}

/// Plays a script on the machine of a task and returns the half section of the part that it
/// makes; `None` if the task has no part.
///
/// # Errors
/// The start state cannot be created, or a line of the script fails.
pub fn make_part(
    task: &ExerciseTask,
    solution: &SolutionScript,
) -> Result<Option<Region>, Message> {
    let (_, end) = play_solution(task, solution, "")?;
    let machining = end.part.machining();
    Ok(machining.map(|machining| machining.scene().part().section().clone()))
}

fn play_solution(
    task: &ExerciseTask,
    solution: &SolutionScript,
    program_version: &str,
) -> Result<(Vec<u8>, MachineMoment), Message> {
    let mut moment = task.create_start()?;
    let mut recorder = SolutionRecorder::begin(&moment, program_version)?;
    moment.emulator.record_inputs();
    let end = moment.ticks() + task.time_limit_ms;
    let mut runner = Runner::new(solution.script.clone());
    loop {
        // Only the actions that are due: the tick itself cuts the part, too.
        let progress = runner.advance(&mut moment.emulator, 0);
        recorder.add_inputs(machine_inputs(&mut moment))?;
        match progress {
            ScriptProgress::Running => {}
            ScriptProgress::Failed(failure) => return Err(failure.message()),
            ScriptProgress::Finished | ScriptProgress::Effect(_) => break,
        }
        if moment.ticks() >= end {
            break;
        }
        let collision = moment.tick();
        moment.set_cut_faults(collision.as_ref());
        recorder.add_inputs(machine_inputs(&mut moment))?;
        recorder.follow_tick(&moment.emulator)?;
    }
    Ok((recorder.finish(&moment.emulator)?, moment))
}

fn machine_inputs(moment: &mut MachineMoment) -> Vec<RecordedInput> {
    let inputs = moment.emulator.take_inputs().into_iter();
    let recorded = inputs.map(|StampedInput { tick, input }| RecordedInput {
        tick,
        input: HistoryInput::Machine(input),
    });
    recorded.collect()
}
