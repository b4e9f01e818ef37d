//! Executes the solution of a lesson without a learner, and checks that its keys complete
//! every step.

use std::sync::Arc;

use gsk_history::machine_part::{MachinePart, NamedJob, PartInput};
use gsk_history::moment::MachineMoment;
use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::script::{Runner, ScriptProgress};

use crate::progress::CHECK_INTERVAL_TICKS;
use crate::{Lesson, LessonProgress};

/// Time in which a step may still complete after its last key, ms.
pub(super) const STEP_SETTLE_MS: u64 = 3_000;
/// Time limit for the keys of a step, ms.
const MAX_STEP_MS: u64 = 1_200_000;

/// The result of playing the solution of one step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StepResult {
    /// The solution completed the step after this time, ms.
    Done(u64),
    /// The step was complete before its first key, so it teaches nothing.
    DoneBefore,
    /// The solution did not complete the step, for this reason.
    Failed(Message),
}

/// Plays the solutions of a lesson. Returns the result of each step, up to the first that
/// fails.
///
/// # Errors
/// The preparation script of the lesson fails.
pub fn play_lesson(lesson: &Arc<Lesson>) -> Result<Vec<StepResult>, Message> {
    let mut machine = create_moment(lesson)?;
    let mut progress = LessonProgress::new(Arc::clone(lesson));
    let mut results = Vec::new();
    for step in 0..lesson.steps.len() {
        progress.check_machine(&machine.emulator);
        let result = play_step(lesson, step, &mut progress, &mut machine);
        let failed = matches!(result, StepResult::Failed(_));
        results.push(result);
        if failed {
            break;
        }
    }
    Ok(results)
}

/// The machine at the beginning of a step (from 0), after the solutions of all earlier steps.
///
/// # Errors
/// The solution does not reach the step.
pub fn machine_at_step(lesson: &Arc<Lesson>, step: usize) -> Result<Emulator, Message> {
    let mut machine = create_moment(lesson)?;
    let mut progress = LessonProgress::new(Arc::clone(lesson));
    for before in 0..step.min(lesson.steps.len()) {
        progress.check_machine(&machine.emulator);
        if let StepResult::Failed(why) = play_step(lesson, before, &mut progress, &mut machine) {
            return Err(why);
        }
    }
    Ok(machine.emulator)
}

/// The practice machine. It has the part only where a cut can break something, because cutting it
/// takes time.
fn create_moment(lesson: &Lesson) -> Result<MachineMoment, Message> {
    let mut part = MachinePart::default();
    if lesson.start.has_load_events() {
        part.apply(PartInput::Job(Some(Box::new(NamedJob {
            job: lesson.stock_and_tools(),
            name: Some(lesson.name.clone()),
        }))));
    }
    Ok(MachineMoment {
        emulator: lesson.start.create_machine()?,
        part,
    })
}

/// Cuts the part with the motion of the last tick.
fn cut_part(machine: &mut MachineMoment) {
    let collision = machine.part.follow_tick(machine.emulator.simulation());
    machine.set_cut_faults(collision.as_ref());
}

/// Plays the solution of step `step`, from 0, on the machine that the earlier steps have left.
fn play_step(
    lesson: &Arc<Lesson>,
    step: usize,
    progress: &mut LessonProgress,
    machine: &mut MachineMoment,
) -> StepResult {
    if progress.step() > step {
        return StepResult::DoneBefore;
    }
    let Some(current) = lesson.steps.get(step) else {
        return StepResult::DoneBefore;
    };
    // The earlier steps were completed, but one of them is undone again.
    let undone = (progress.step() < step).then(|| say::lesson_sent_back(progress.step() + 1));
    if let Some(why) = undone {
        return StepResult::Failed(why);
    }
    if let Some(why) = current
        .requirements
        .iter()
        .find_map(|need| need.unmet_message(&machine.emulator))
    {
        return StepResult::Failed(say::lesson_needs(why));
    }
    let start_ticks = machine.ticks();
    let mut runner = Runner::new(current.solution.clone());
    let mut settle_ticks = None;
    loop {
        if settle_ticks.is_none() {
            let before = machine.ticks();
            let played = runner.advance(&mut machine.emulator, 1);
            if machine.ticks() != before {
                cut_part(machine);
            }
            match played {
                ScriptProgress::Running => {}
                ScriptProgress::Failed(failure) => return StepResult::Failed(failure.message()),
                ScriptProgress::Finished | ScriptProgress::Effect(_) => {
                    settle_ticks = Some(machine.ticks() + STEP_SETTLE_MS);
                }
            }
        } else {
            machine.emulator.tick();
            cut_part(machine);
        }
        let now = machine.ticks();
        if now.is_multiple_of(CHECK_INTERVAL_TICKS) && progress.step() == step {
            progress.check_machine(&machine.emulator);
        }
        if settle_ticks.is_some() && progress.step() > step {
            return StepResult::Done(now - start_ticks);
        }
        if progress.step() < step {
            return StepResult::Failed(say::lesson_sent_back(progress.step() + 1));
        }
        if settle_ticks.is_some_and(|until| now >= until) || now - start_ticks > MAX_STEP_MS {
            let mut open = current.goals.iter();
            let why = open.find_map(|condition| condition.unmet_message(&machine.emulator));
            return StepResult::Failed(why.unwrap_or_else(say::lesson_before_too_long));
        }
    }
}
