//! A learner at his practice machine: tick by tick, with *Show me*, *Back* and *Begin again*.

use std::sync::Arc;

use gsk_messages::Message;
use gsk_panel::emulator::Emulator;
use gsk_panel::panel::KeyEvent;
use gsk_panel::script::{ScriptAction, ScriptLine, ScriptProgress, Runner, Script};

use super::play::{self, SETTLES};
use super::progress::LOOK;
use super::{Lesson, Progress, Remark, all_hold};

/// Between two keys that are shown, ms.
const SHOWN_REST: u64 = 600;
/// Before the first key of a step that follows another by itself, ms: it is read first.
const READ_REST: u64 = 1_500;

/// How far a lesson has come, for whoever shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct View {
    /// The step under way, counted from 0; as many as there are when all is done.
    pub step: usize,
    /// What is to be said of it.
    pub remark: Remark,
    /// What a later step needed and is gone: it sent the learner back to this one.
    pub sent_back: Option<Message>,
    /// The keys are being pressed for the learner.
    pub showing: bool,
    /// The machine was put to the beginning of the step, since it could not be shown from
    /// where the learner was.
    pub replaced: bool,
}

/// A step that is shown.
#[derive(Clone, Debug)]
struct Showing {
    runner: Runner,
    /// Which step.
    step: usize,
    /// It is played from the state that the lesson has there, not from the learner's.
    own_state: bool,
    /// All keys are pressed; until this tick the step may still come true.
    until: Option<u64>,
}

/// A lesson under way.
#[derive(Clone, Debug)]
pub struct Practice {
    lesson: Arc<Lesson>,
    progress: Progress,
    /// The machine at the beginning of every step up to this one.
    entries: Vec<Emulator>,
    showing: Option<Showing>,
    replaced: bool,
    /// A step that has come true by being shown leads on to the next one, which is shown,
    /// too.
    goes_on: bool,
}

impl Practice {
    /// Begins a lesson on a machine of its own.
    ///
    /// # Errors
    /// What the lesson does beforehand does not come out.
    pub fn begin(lesson: Arc<Lesson>) -> Result<(Self, Emulator), Message> {
        let machine = lesson.begins.machine()?;
        let practice = Self {
            progress: Progress::new(Arc::clone(&lesson)),
            lesson,
            entries: vec![machine.clone()],
            showing: None,
            replaced: false,
            goes_on: false,
        };
        Ok((practice, machine))
    }

    /// Begins a lesson on a machine of its own and shows it, step by step, to its end.
    ///
    /// # Errors
    /// What the lesson does beforehand does not come out.
    pub fn demonstrate(lesson: Arc<Lesson>) -> Result<(Self, Emulator), Message> {
        let (mut practice, machine) = Self::begin(lesson)?;
        practice.goes_on = true;
        practice.play(false);
        Ok((practice, machine))
    }

    /// The lesson.
    pub const fn lesson(&self) -> &Arc<Lesson> {
        &self.lesson
    }

    /// How far it has come.
    pub fn view(&self) -> View {
        View {
            step: self.progress.step(),
            remark: self.progress.remark(),
            sent_back: self.progress.sent_back().cloned(),
            showing: self.showing.is_some(),
            replaced: self.replaced,
        }
    }

    /// One millisecond of the machine.
    pub fn tick(&mut self, emulator: &mut Emulator) {
        match &mut self.showing {
            Some(showing) if showing.until.is_none() => {
                let before = emulator.ticks();
                let played = showing.runner.advance(emulator, 1);
                // A solution has no effects; a line that fails ends it.
                if !matches!(played, ScriptProgress::Running) {
                    showing.until = Some(emulator.ticks() + SETTLES);
                }
                if emulator.ticks() == before {
                    emulator.tick();
                }
            }
            _ => emulator.tick(),
        }
        if emulator.ticks().is_multiple_of(LOOK) {
            self.look(emulator);
        }
    }

    fn look(&mut self, emulator: &mut Emulator) {
        let before = self.progress.step();
        self.progress.look(emulator);
        let now = self.progress.step();
        if now != before {
            // Where a step began first it begins again; steps that came true at once begin
            // where this one does.
            self.entries.truncate(now + 1);
            self.entries.resize_with(now + 1, || emulator.clone());
            self.replaced &= self.showing.is_some();
        }
        let Some(showing) = &self.showing else {
            return;
        };
        let Some(until) = showing.until else {
            return;
        };
        if now > showing.step {
            self.showing = None;
            if self.goes_on {
                self.play(false);
            }
        } else if emulator.ticks() >= until {
            let again = !showing.own_state;
            self.showing = None;
            if again {
                self.show_from_own_state(emulator);
            }
        }
    }

    /// Presses the keys of this step for the learner: where he is, and if that does not
    /// lead on, from the state that the lesson has there.
    pub fn show_me(&mut self, emulator: &mut Emulator) {
        self.interrupt(emulator);
        let Some(step) = self.progress.current() else {
            return;
        };
        if all_hold(&step.needs, emulator) && self.progress.remark() == Remark::None {
            self.play(false);
        } else {
            self.show_from_own_state(emulator);
        }
    }

    /// Puts the machine to the state in which the lesson's own solution begins this step,
    /// and shows it from there.
    fn show_from_own_state(&mut self, emulator: &mut Emulator) {
        let step = self.progress.step();
        // A lesson whose solution does not come that far shows what it can.
        if let Ok(machine) = play::machine_at(&self.lesson, step) {
            *emulator = machine;
            self.progress.put(step);
            self.replaced = true;
        }
        self.play(true);
    }

    fn play(&mut self, own_state: bool) {
        let Some(step) = self.progress.current() else {
            return;
        };
        self.showing = Some(Showing {
            runner: Runner::new(slowly(&step.solution, self.goes_on)),
            step: self.progress.step(),
            own_state,
            until: None,
        });
    }

    /// The learner does something himself: nothing is shown any more.
    pub fn interrupt(&mut self, emulator: &mut Emulator) {
        if self.showing.take().is_some() {
            emulator.key(KeyEvent::ReleaseAll);
        }
    }

    /// Puts the machine to where the step before this one began.
    pub fn back(&mut self, emulator: &mut Emulator) {
        self.showing = None;
        let step = self.progress.step().saturating_sub(1);
        self.rewind(step, emulator);
    }

    /// Puts the machine to where the lesson begins.
    pub fn again(&mut self, emulator: &mut Emulator) {
        self.showing = None;
        self.rewind(0, emulator);
    }

    fn rewind(&mut self, step: usize, emulator: &mut Emulator) {
        self.entries.truncate(step + 1);
        if let Some(entry) = self.entries.get(step) {
            *emulator = entry.clone();
            emulator.key(KeyEvent::ReleaseAll);
        }
        self.progress.put(step);
        self.replaced = false;
    }
}

/// A solution at a pace that can be followed: a rest after every key, and one before the
/// first of them while its step is read.
fn slowly(solution: &Script, is_read: bool) -> Script {
    let first = solution.lines.first().filter(|_| is_read);
    let mut lines: Vec<ScriptLine> = first
        .map(|line| ScriptLine {
            action: ScriptAction::Wait(READ_REST),
            ..line.clone()
        })
        .into_iter()
        .collect();
    for line in &solution.lines {
        lines.push(line.clone());
        if matches!(line.action, ScriptAction::Press(_) | ScriptAction::Hold(..)) {
            lines.push(ScriptLine {
                action: ScriptAction::Wait(SHOWN_REST),
                ..line.clone()
            });
        }
    }
    Script { lines }
}
