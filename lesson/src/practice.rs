//! Follows a learner on his practice machine, tick by tick, with *Show me*, *Back* and *Begin
//! again*.

use std::sync::Arc;

use gsk_messages::Message;
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;
use gsk_panel::panel::KeyEvent;
use gsk_panel::script::{Runner, Script, ScriptAction, ScriptLine, ScriptProgress};

use crate::key_cue::KeyCue;
use crate::progress::CHECK_INTERVAL_TICKS;
use crate::solution_player::{self, STEP_SETTLE_MS};
use crate::{Lesson, LessonProgress, LessonRemark, are_all_met};

/// Pause between two demonstrated keys, ms.
const KEY_PAUSE_MS: u64 = 600;
/// Pause before the first key of a step that follows automatically, ms: the learner reads the
/// text first.
const READING_PAUSE_MS: u64 = 1_500;

/// The state of a lesson that the window shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PracticeView {
    /// Current step, from 0; equals the number of steps when all are complete.
    pub step: usize,
    /// The remark about the learner's state to show besides the step.
    pub remark: LessonRemark,
    /// The key to press or to release now; `None` if the learner waits or turns the handwheel.
    pub next_key: Option<Key>,
    /// The requirement of a later step that was lost, so the learner was sent back to this
    /// one; `None` if he was not sent back.
    pub sent_back: Option<Message>,
    /// Whether a demonstration is pressing the keys for the learner.
    pub showing: bool,
    /// Whether the machine was reset to the beginning of the step, because the step could not
    /// be shown from the learner's state.
    pub replaced: bool,
}

/// A step that is demonstrated.
#[derive(Clone, Debug)]
struct StepDemonstration {
    runner: Runner,
    step: usize,
    /// Whether the step is demonstrated from the state that the lesson's own solution reaches,
    /// instead of the learner's state.
    uses_lesson_state: bool,
    /// Tick until which the step may still complete, set when all keys are pressed; `None`
    /// while keys are still to be pressed.
    settle_ticks: Option<u64>,
    /// Number of alarms when the demonstration began.
    alarms_before: usize,
}

/// A lesson in progress.
#[derive(Clone, Debug)]
pub struct Practice {
    lesson: Arc<Lesson>,
    progress: LessonProgress,
    cue: KeyCue,
    /// The machine at the beginning of each step, up to the current one.
    step_starts: Vec<Emulator>,
    showing: Option<StepDemonstration>,
    replaced: bool,
    /// Whether the next step is demonstrated too when the demonstrated step completes.
    continues: bool,
}

impl Practice {
    /// Starts a lesson on a new practice machine. The caller keeps the machine and passes it
    /// to every call.
    ///
    /// # Errors
    /// The preparation script of the lesson fails.
    pub fn begin(lesson: Arc<Lesson>) -> Result<(Self, Emulator), Message> {
        let machine = lesson.start.create_machine()?;
        let practice = Self {
            progress: LessonProgress::new(Arc::clone(&lesson)),
            cue: KeyCue::begin(lesson.steps.first(), machine.panel()),
            lesson,
            step_starts: vec![machine.clone()],
            showing: None,
            replaced: false,
            continues: false,
        };
        Ok((practice, machine))
    }

    /// Starts a lesson on a new practice machine and demonstrates all steps to the end.
    ///
    /// # Errors
    /// The preparation script of the lesson fails.
    pub fn demonstrate(lesson: Arc<Lesson>) -> Result<(Self, Emulator), Message> {
        let (mut practice, machine) = Self::begin(lesson)?;
        practice.continues = true;
        practice.start_showing(false, &machine);
        Ok((practice, machine))
    }

    /// The lesson in progress.
    pub const fn lesson(&self) -> &Arc<Lesson> {
        &self.lesson
    }

    /// The state of the lesson to show: step, remark and demonstration.
    pub fn view(&self) -> PracticeView {
        PracticeView {
            step: self.progress.step(),
            remark: self.progress.remark(),
            next_key: self.cue.next_key(),
            sent_back: self.progress.sent_back().cloned(),
            showing: self.showing.is_some(),
            replaced: self.replaced,
        }
    }

    /// Simulates one millisecond of the machine, presses the keys of a demonstration, and
    /// checks the progress.
    pub fn tick(&mut self, emulator: &mut Emulator) {
        match &mut self.showing {
            Some(showing) if showing.settle_ticks.is_none() => {
                let before = emulator.ticks();
                let played = showing.runner.advance(emulator, 1);
                // The keys may not fit the state in which the learner has left the machine.
                let is_alarmed = !showing.uses_lesson_state
                    && emulator.cnc().alarms().len() > showing.alarms_before;
                if is_alarmed {
                    emulator.key(KeyEvent::ReleaseAll);
                }
                // A solution has no effects. A line that fails ends it.
                if is_alarmed || !matches!(played, ScriptProgress::Running) {
                    showing.settle_ticks = Some(emulator.ticks() + STEP_SETTLE_MS);
                }
                if emulator.ticks() == before {
                    emulator.tick();
                }
            }
            _ => emulator.tick(),
        }
        self.cue.follow(emulator.panel());
        if emulator.ticks().is_multiple_of(CHECK_INTERVAL_TICKS) {
            self.update_progress(emulator);
        }
    }

    fn update_progress(&mut self, emulator: &mut Emulator) {
        let before = self.progress.step();
        self.progress.check_machine(emulator);
        let now = self.progress.step();
        if now != before {
            // A step starts again where it first started. Steps that completed at once start
            // where this one does.
            self.step_starts.truncate(now + 1);
            self.step_starts.resize_with(now + 1, || emulator.clone());
            self.replaced = false;
            self.begin_cue(emulator);
        }
        let Some(showing) = &self.showing else {
            return;
        };
        let Some(until) = showing.settle_ticks else {
            return;
        };
        if now > showing.step {
            self.showing = None;
            if self.continues {
                self.start_showing(false, emulator);
            }
        } else if emulator.ticks() >= until {
            let again = !showing.uses_lesson_state;
            self.showing = None;
            if again {
                self.show_from_lesson_state(emulator);
            }
        }
    }

    /// Demonstrates the current step from the learner's state. If that does not complete the
    /// step, demonstrates it from the state of the lesson's own solution.
    pub fn show_me(&mut self, emulator: &mut Emulator) {
        self.interrupt(emulator);
        let Some(step) = self.progress.current() else {
            return;
        };
        if are_all_met(&step.requirements, emulator) && self.progress.remark() == LessonRemark::None
        {
            self.start_showing(false, emulator);
        } else {
            self.show_from_lesson_state(emulator);
        }
    }

    /// Puts the machine into the state in which the lesson's own solution starts this step,
    /// and demonstrates the step from that state.
    fn show_from_lesson_state(&mut self, emulator: &mut Emulator) {
        let step = self.progress.step();
        // A lesson whose solution does not reach the step shows what it can.
        if let Ok(machine) = solution_player::machine_at_step(&self.lesson, step) {
            *emulator = machine;
            self.progress.set_step(step);
            self.replaced = true;
            self.begin_cue(emulator);
        }
        self.start_showing(true, emulator);
    }

    fn begin_cue(&mut self, emulator: &Emulator) {
        self.cue = KeyCue::begin(self.progress.current(), emulator.panel());
    }

    fn start_showing(&mut self, uses_lesson_state: bool, emulator: &Emulator) {
        let Some(step) = self.progress.current() else {
            return;
        };
        self.showing = Some(StepDemonstration {
            runner: Runner::new(slow_down(&step.solution, self.continues)),
            step: self.progress.step(),
            uses_lesson_state,
            settle_ticks: None,
            alarms_before: emulator.cnc().alarms().len(),
        });
    }

    /// Ends a demonstration and releases all keys, because the learner does something himself.
    pub fn interrupt(&mut self, emulator: &mut Emulator) {
        if self.showing.take().is_some() {
            emulator.key(KeyEvent::ReleaseAll);
        }
    }

    /// Resets the machine to the beginning of the step before this one.
    pub fn go_back(&mut self, emulator: &mut Emulator) {
        self.showing = None;
        let step = self.progress.step().saturating_sub(1);
        self.rewind(step, emulator);
    }

    /// Resets the machine to the beginning of the lesson.
    pub fn restart(&mut self, emulator: &mut Emulator) {
        self.showing = None;
        self.rewind(0, emulator);
    }

    fn rewind(&mut self, step: usize, emulator: &mut Emulator) {
        self.step_starts.truncate(step + 1);
        if let Some(entry) = self.step_starts.get(step) {
            *emulator = entry.clone();
            emulator.key(KeyEvent::ReleaseAll);
        }
        self.progress.set_step(step);
        self.begin_cue(emulator);
        self.replaced = false;
    }
}

/// Slows a solution down: adds a pause after every key, and with `has_reading_pause` another
/// pause before the first key while the learner reads the step.
fn slow_down(solution: &Script, has_reading_pause: bool) -> Script {
    let first = solution.lines.first().filter(|_| has_reading_pause);
    let mut lines: Vec<ScriptLine> = first
        .map(|line| ScriptLine {
            action: ScriptAction::Wait(READING_PAUSE_MS),
            ..line.clone()
        })
        .into_iter()
        .collect();
    for line in &solution.lines {
        lines.push(line.clone());
        if matches!(line.action, ScriptAction::Press(_) | ScriptAction::Hold(..)) {
            lines.push(ScriptLine {
                action: ScriptAction::Wait(KEY_PAUSE_MS),
                ..line.clone()
            });
        }
    }
    Script { lines }
}
