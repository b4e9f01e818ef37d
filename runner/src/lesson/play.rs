//! Executes the solution of a lesson without a learner, and checks that its keys complete
//! every step.

use std::sync::Arc;

use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::script::{ScriptProgress, Runner};

use super::progress::LOOK;
use super::{Lesson, Progress};

/// Time for a step to complete after its last key, ms.
pub(super) const SETTLES: u64 = 3_000;
/// Time limit for the keys of a step, ms.
const LONGEST: u64 = 1_200_000;

/// The result of playing a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Its keys completed it, after this time, ms.
    Done(u64),
    /// It was complete before its first key, so it teaches nothing.
    DoneBefore,
    /// Its keys did not complete it, for this reason.
    Failed(Message),
}

/// Plays the solutions of a lesson. Returns the result of each step, up to the first that
/// fails.
///
/// # Errors
/// The preparation script of the lesson fails.
pub fn run(lesson: &Arc<Lesson>) -> Result<Vec<Outcome>, Message> {
    let mut machine = lesson.begins.machine()?;
    let mut progress = Progress::new(Arc::clone(lesson));
    let mut outcomes = Vec::new();
    for step in 0..lesson.steps.len() {
        progress.look(&machine);
        let outcome = play_step(lesson, step, &mut progress, &mut machine);
        let failed = matches!(outcome, Outcome::Failed(_));
        outcomes.push(outcome);
        if failed {
            break;
        }
    }
    Ok(outcomes)
}

/// The machine at the beginning of a step (from 0), after the solutions of all earlier steps.
///
/// # Errors
/// The solution does not reach the step.
pub fn machine_at(lesson: &Arc<Lesson>, step: usize) -> Result<Emulator, Message> {
    let mut machine = lesson.begins.machine()?;
    let mut progress = Progress::new(Arc::clone(lesson));
    for before in 0..step.min(lesson.steps.len()) {
        progress.look(&machine);
        if let Outcome::Failed(why) = play_step(lesson, before, &mut progress, &mut machine) {
            return Err(why);
        }
    }
    Ok(machine)
}

/// Plays one step on the machine that the earlier steps have left.
fn play_step(
    lesson: &Arc<Lesson>,
    step: usize,
    progress: &mut Progress,
    machine: &mut Emulator,
) -> Outcome {
    if progress.step() > step {
        return Outcome::DoneBefore;
    }
    let Some(wanted) = lesson.steps.get(step) else {
        return Outcome::DoneBefore;
    };
    // The earlier steps were completed, but one of them is undone again.
    let behind = (progress.step() < step).then(|| say::lesson_sent_back(progress.step() + 1));
    if let Some(why) = behind {
        return Outcome::Failed(why);
    }
    if let Some(why) = wanted.needs.iter().find_map(|need| need.said(machine)) {
        return Outcome::Failed(say::lesson_needs(why));
    }
    let begun = machine.ticks();
    let mut runner = Runner::new(wanted.solution.clone());
    let mut settled = None;
    loop {
        if settled.is_none() {
            match runner.advance(machine, 1) {
                ScriptProgress::Running => {}
                ScriptProgress::Failed(failure) => return Outcome::Failed(failure.message()),
                ScriptProgress::Finished | ScriptProgress::Effect(_) => {
                    settled = Some(machine.ticks() + SETTLES);
                }
            }
        } else {
            machine.tick();
        }
        let now = machine.ticks();
        if now.is_multiple_of(LOOK) && progress.step() == step {
            progress.look(machine);
        }
        if settled.is_some() && progress.step() > step {
            return Outcome::Done(now - begun);
        }
        if progress.step() < step {
            return Outcome::Failed(say::lesson_sent_back(progress.step() + 1));
        }
        if settled.is_some_and(|until| now >= until) || now - begun > LONGEST {
            let mut open = wanted.until.iter();
            let why = open.find_map(|condition| condition.said(machine));
            return Outcome::Failed(why.unwrap_or_else(say::lesson_before_too_long));
        }
    }
}
