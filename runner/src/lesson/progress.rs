//! Finds the learner's step in a lesson from the state of the machine alone.

use std::sync::Arc;

use gsk_messages::Message;
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;

use super::{Lesson, Step, all_hold};

/// Ticks between two checks of the machine.
pub(super) const LOOK: u64 = 20;
/// Number of successive checks at which a requirement must be missing before the learner is
/// sent back: 0.2 s, because a change of mode takes a moment.
const GONE: u32 = 10;

/// What to show about the learner's state, besides the step itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Remark {
    /// Nothing.
    #[default]
    None,
    /// A frequent mistake of the step, by its index from 0.
    Wrong(usize),
    /// The power is off.
    PowerOff,
    /// The emergency stop is latched.
    EmergencyStop,
    /// This alarm is active.
    Alarm(u16),
    /// The step requires a state that no earlier step restores.
    Stuck,
}

/// How far a learner has come in a lesson.
#[derive(Clone, Debug)]
pub struct Progress {
    lesson: Arc<Lesson>,
    step: usize,
    remark: Remark,
    /// Number of successive checks at which a requirement was missing.
    gone: u32,
    /// Why the learner was sent back to this step.
    sent_back: Option<Message>,
}

impl Progress {
    /// Starts before the first step.
    pub const fn new(lesson: Arc<Lesson>) -> Self {
        Self {
            lesson,
            step: 0,
            remark: Remark::None,
            gone: 0,
            sent_back: None,
        }
    }

    /// Current step, from 0; the number of steps when all are complete.
    pub const fn step(&self) -> usize {
        self.step
    }

    /// The current step; `None` when all are complete.
    pub fn current(&self) -> Option<&Step> {
        self.lesson.steps.get(self.step)
    }

    /// What to show now.
    pub const fn remark(&self) -> Remark {
        self.remark
    }

    /// The lost requirement of a later step, if it sent the learner back to this one.
    pub(super) const fn sent_back(&self) -> Option<&Message> {
        self.sent_back.as_ref()
    }

    /// Puts the learner at a step.
    pub(super) fn put(&mut self, step: usize) {
        self.step = step.min(self.lesson.steps.len());
        self.remark = Remark::None;
        self.gone = 0;
        self.sent_back = None;
    }

    /// Checks the machine. Advances where a step is complete. Goes back where a requirement of
    /// the step is lost and an earlier step restores it.
    pub fn look(&mut self, emulator: &Emulator) {
        let lesson = Arc::clone(&self.lesson);
        while let Some(step) = lesson.steps.get(self.step) {
            if !has_come_true(step, emulator) {
                break;
            }
            self.put(self.step + 1);
        }
        let Some(step) = lesson.steps.get(self.step) else {
            self.remark = Remark::None;
            return;
        };
        let ready = all_hold(&step.needs, emulator);
        self.gone = if ready { 0 } else { self.gone + 1 };
        if self.gone >= GONE
            && let Some(back) = self.brings_back(emulator)
        {
            let mut unmet = step.needs.iter().filter_map(|need| need.unmet(emulator));
            let why = unmet.next().map(|unmet| unmet.message());
            self.put(back);
            self.sent_back = why;
        }
        let Some(step) = lesson.steps.get(self.step) else {
            return;
        };
        let stuck = match self.gone >= GONE {
            true => Remark::Stuck,
            false => Remark::None,
        };
        self.remark = remark(step, emulator).unwrap_or(stuck);
    }

    /// The last step before this one whose requirements hold and whose goals do not. A
    /// completed step would advance at once, in an endless loop.
    fn brings_back(&self, emulator: &Emulator) -> Option<usize> {
        let mut before = self.lesson.steps[..self.step].iter();
        before.rposition(|step| all_hold(&step.needs, emulator) && !all_hold(&step.until, emulator))
    }
}

/// Whether a step is complete. A slide that is still moving has not reached its position.
fn has_come_true(step: &Step, emulator: &Emulator) -> bool {
    let passes = emulator.simulation.cnc.is_moving()
        && step.until.iter().any(|wanted| wanted.expect.is_position());
    !passes && all_hold(&step.until, emulator)
}

/// The remark on the state of the machine in a step. Mistakes of the step come first.
fn remark(step: &Step, emulator: &Emulator) -> Option<Remark> {
    let own = step.wrong.iter();
    let mut own = own.map(|wrong| all_hold(&wrong.when, emulator));
    if let Some(index) = own.position(|holds| holds) {
        return Some(Remark::Wrong(index));
    }
    let panel = &emulator.panel;
    if !panel.powered() {
        return Some(Remark::PowerOff);
    }
    if panel.emergency_stop() && !step.keys.contains(&Key::EmergencyStop) {
        return Some(Remark::EmergencyStop);
    }
    let alarm = emulator.simulation.cnc.alarms().first()?;
    // In a step about alarms the alarm is the subject.
    let mut conditions = step.needs.iter().chain(&step.until);
    let about = conditions.any(|condition| condition.text.starts_with("alarm "))
        || step.keys.contains(&Key::Reset);
    (!about).then_some(Remark::Alarm(alarm.number))
}
