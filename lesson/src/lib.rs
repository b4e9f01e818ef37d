//! Guided lessons: steps on the real state of a practice machine, from data files.
//!
//! A file defines the initial state of the machine. For each step it gives the instruction,
//! the keys to mark, the conditions that complete it, and a solution by keys alone.
//! [`Lesson::read`] parses a file, [`Practice`] follows a learner through it, [`solution_player`]
//! executes its solution.

mod demonstration_file;
mod file;
mod key_cue;
mod library;
mod practice;
mod practice_machine;
mod progress;
pub mod solution_player;

use std::borrow::Cow;

use gsk_messages::{Language, Message, add_key_names, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;
use gsk_panel::script::{Expectation, Script, UnmetExpectation};
use gsk_workpiece::job::Job;
use serde::{Deserialize, Serialize};

pub use demonstration_file::{
    Demonstration, demonstrations, find_demonstration, read_demonstrations,
};
pub use file::LessonError;
pub use library::{LESSONS, built_in_lessons};
pub use practice::{Practice, PracticeView};
pub use practice_machine::{LessonStart, LessonStartFile};
pub use progress::{LessonProgress, LessonRemark};

/// A text in Chinese and English.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonText {
    /// The text in Chinese.
    pub zh: String,
    /// The text in English.
    pub en: String,
}

impl LessonText {
    /// The version of the text in `language`. English adds the names of the keys.
    pub fn in_language(&self, language: Language) -> Cow<'_, str> {
        match language {
            Language::Zh => Cow::Borrowed(&self.zh),
            Language::En => add_key_names(&self.en),
        }
    }
}

/// A lesson that was parsed without errors.
#[derive(Clone, Debug)]
pub struct Lesson {
    /// Name of the lesson's file without the extension; identifies the lesson.
    pub name: String,
    /// Title of the lesson, shown in the list of lessons.
    pub title: LessonText,
    /// Summary of what the lesson teaches, shown in the list of lessons.
    pub about: LessonText,
    /// Initial state of the practice machine.
    pub start: LessonStart,
    /// Stock and tools of the practice machine; `None` for the usual bar and tools.
    pub job: Option<Job>,
    /// The steps in their order, at least one.
    pub steps: Vec<LessonStep>,
}

impl Lesson {
    /// Stock and tools of the practice machine, at a known place: those of the lesson, or the
    /// usual ones.
    pub fn stock_and_tools(&self) -> Job {
        let own = self.job.clone();
        let job = own.unwrap_or_else(practice_machine::usual_job);
        Job {
            zero: job.zero.or_else(|| Some(self.start.part_zero())),
            ..job
        }
    }
}

/// A step of a lesson.
#[derive(Clone, Debug)]
pub struct LessonStep {
    /// The instruction: what to do, and why.
    pub text: LessonText,
    /// Help for a learner who does not complete the step.
    pub hint: LessonText,
    /// Keys of the step. The panel marks the one to press next.
    pub keys: Vec<Key>,
    /// Conditions that must hold during the step. If one of them does not hold, the learner
    /// goes back to the step that establishes it.
    pub requirements: Vec<LessonCondition>,
    /// Conditions that together complete the step.
    pub goals: Vec<LessonCondition>,
    /// Frequent mistakes, each with its text. The learner sees the text of the first mistake
    /// that applies.
    pub mistakes: Vec<LessonMistake>,
    /// Operator script that completes the step, with keys and the handwheel alone.
    pub solution: Script,
}

/// A frequent mistake and the text that is shown for it.
#[derive(Clone, Debug)]
pub struct LessonMistake {
    /// Conditions that detect the mistake when all of them hold.
    pub conditions: Vec<LessonCondition>,
    /// The text that the learner sees after the mistake.
    pub text: LessonText,
}

/// A condition on the state of the machine, in the syntax after `expectation` in an operator
/// script.
#[derive(Clone, Debug, PartialEq)]
pub struct LessonCondition {
    /// The condition as written in the lesson file.
    pub text: String,
    expectation: Expectation,
}

impl LessonCondition {
    /// Whether the condition holds now.
    pub fn is_met(&self, emulator: &Emulator) -> bool {
        self.unmet(emulator).is_none()
    }

    /// Expected and current value if the condition does not hold; `None` if it holds.
    pub fn unmet(&self, emulator: &Emulator) -> Option<UnmetExpectation> {
        self.expectation.check(emulator).err()
    }

    /// The message with the expected and the current value if the condition does not hold;
    /// `None` if it holds.
    pub fn unmet_message(&self, emulator: &Emulator) -> Option<Message> {
        let unmet = self.unmet(emulator)?;
        Some(say::subject_reason(&self.text, unmet.message()))
    }
}

/// Whether all conditions hold.
fn are_all_met(conditions: &[LessonCondition], emulator: &Emulator) -> bool {
    conditions
        .iter()
        .all(|condition| condition.is_met(emulator))
}

#[cfg(test)]
mod tests;
