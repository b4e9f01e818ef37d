//! Finds the learner's step in a lesson from the state of the machine alone.

use std::sync::Arc;

use gsk_messages::Message;
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;

use crate::{Lesson, LessonStep, are_all_met};

/// Number of ticks between two checks of the machine.
pub(super) const CHECK_INTERVAL_TICKS: u64 = 20;
/// Number of successive checks at which a requirement must be missing before the learner is
/// sent back: 0.2 s, because a change of mode takes a moment.
const LOST_CHECK_LIMIT: u32 = 10;

/// A remark about the learner's state, to show besides the step itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LessonRemark {
    /// There is no remark to show.
    #[default]
    None,
    /// The learner made a frequent mistake of the step, given by its index from 0.
    Mistake(usize),
    /// The power of the machine is off.
    PowerOff,
    /// The emergency stop is latched, and the step is not about it.
    EmergencyStop,
    /// The alarm with this number is active.
    Alarm(u16),
    /// The step requires a state that no earlier step restores; the learner must begin again.
    Stuck,
}

/// The progress of a learner in a lesson.
#[derive(Clone, Debug)]
pub struct LessonProgress {
    lesson: Arc<Lesson>,
    step: usize,
    remark: LessonRemark,
    /// Number of successive checks at which a requirement was missing, up to now.
    lost_checks: u32,
    /// The lost requirement because of which the learner was sent back to this step; `None` if
    /// he was not sent back.
    sent_back: Option<Message>,
}

impl LessonProgress {
    /// Starts the lesson at its first step.
    pub const fn new(lesson: Arc<Lesson>) -> Self {
        Self {
            lesson,
            step: 0,
            remark: LessonRemark::None,
            lost_checks: 0,
            sent_back: None,
        }
    }

    /// Current step, from 0; equals the number of steps when all are complete.
    pub const fn step(&self) -> usize {
        self.step
    }

    /// The current step; `None` when all are complete.
    pub fn current(&self) -> Option<&LessonStep> {
        self.lesson.steps.get(self.step)
    }

    /// Returns the remark about the learner's state to show besides the step.
    pub const fn remark(&self) -> LessonRemark {
        self.remark
    }

    /// The lost requirement of a later step because of which the learner was sent back to this
    /// one; `None` if he was not sent back.
    pub(super) const fn sent_back(&self) -> Option<&Message> {
        self.sent_back.as_ref()
    }

    /// Continues the lesson at `step`, from 0, and clears the remark.
    pub(super) fn set_step(&mut self, step: usize) {
        self.step = step.min(self.lesson.steps.len());
        self.remark = LessonRemark::None;
        self.lost_checks = 0;
        self.sent_back = None;
    }

    /// Checks the machine against the current step. Advances if the step is complete. Goes
    /// back if a requirement of the step is lost and an earlier step restores it.
    pub fn check_machine(&mut self, emulator: &Emulator) {
        let lesson = Arc::clone(&self.lesson);
        while let Some(step) = lesson.steps.get(self.step) {
            if !is_complete(step, emulator) {
                break;
            }
            self.set_step(self.step + 1);
        }
        let Some(step) = lesson.steps.get(self.step) else {
            self.remark = LessonRemark::None;
            return;
        };
        let ready = are_all_met(&step.requirements, emulator);
        self.lost_checks = if ready { 0 } else { self.lost_checks + 1 };
        if self.lost_checks >= LOST_CHECK_LIMIT
            && let Some(back) = self.find_restoring_step(emulator)
        {
            let mut unmet = step
                .requirements
                .iter()
                .filter_map(|need| need.unmet(emulator));
            let why = unmet.next().map(|unmet| unmet.message());
            self.set_step(back);
            self.sent_back = why;
        }
        let Some(step) = lesson.steps.get(self.step) else {
            return;
        };
        let stuck = match self.lost_checks >= LOST_CHECK_LIMIT {
            true => LessonRemark::Stuck,
            false => LessonRemark::None,
        };
        self.remark = find_remark(step, emulator).unwrap_or(stuck);
    }

    /// The last earlier step whose requirements hold and whose goals do not, from 0; `None` if
    /// there is none. A step that is already complete would advance at once, in an endless
    /// loop.
    fn find_restoring_step(&self, emulator: &Emulator) -> Option<usize> {
        let mut before = self.lesson.steps[..self.step].iter();
        before.rposition(|step| {
            are_all_met(&step.requirements, emulator) && !are_all_met(&step.goals, emulator)
        })
    }
}

/// Whether the goals of a step are met. A slide that is still moving has not reached its
/// position.
fn is_complete(step: &LessonStep, emulator: &Emulator) -> bool {
    let is_passing = emulator.cnc().is_moving()
        && step
            .goals
            .iter()
            .any(|wanted| wanted.expectation.is_position());
    !is_passing && are_all_met(&step.goals, emulator)
}

/// The remark on the machine's state in a step; a mistake of the step takes precedence. `None`
/// if there is nothing to remark.
fn find_remark(step: &LessonStep, emulator: &Emulator) -> Option<LessonRemark> {
    let mistakes = step.mistakes.iter();
    let mut mistakes = mistakes.map(|wrong| are_all_met(&wrong.conditions, emulator));
    if let Some(index) = mistakes.position(|holds| holds) {
        return Some(LessonRemark::Mistake(index));
    }
    let panel = emulator.panel();
    if !panel.powered() {
        return Some(LessonRemark::PowerOff);
    }
    if panel.emergency_stop() && !step.keys.contains(&Key::EmergencyStop) {
        return Some(LessonRemark::EmergencyStop);
    }
    let alarm = emulator.cnc().alarms().first()?;
    // In a step about alarms the alarm is the subject.
    let mut conditions = step.requirements.iter().chain(&step.goals);
    let is_subject = conditions.any(|condition| condition.text.starts_with("alarm "))
        || step.keys.contains(&Key::Reset);
    (!is_subject).then_some(LessonRemark::Alarm(alarm.number))
}
