//! Guided lessons: steps on the real state of a practice machine, from data files.
//!
//! A file defines the initial state of the machine. For each step it gives the instruction,
//! the keys to mark, the conditions that complete it, and a solution by keys alone.
//! [`Lesson::read`] parses a file, [`Practice`] follows a learner through it, [`play`]
//! executes its solution.

mod file;
mod library;
mod machine;
pub mod play;
mod practice;
mod progress;
mod shown;

use gsk_messages::{Language, Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::keys::Key;
use gsk_panel::script::{Expectation, Script, UnmetExpectation};
use gsk_workpiece::job::Job;
use serde::{Deserialize, Serialize};

pub use file::LessonError;
pub use library::{LESSONS, built_in};
pub use machine::Begins;
pub use practice::{Practice, View};
pub use progress::{Progress, Remark};
pub use shown::{Demonstration, demonstration_named, demonstrations, read_demonstrations};

/// A text in both languages.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Text {
    /// The Chinese text.
    pub zh: String,
    /// The English text.
    pub en: String,
}

impl Text {
    /// The text in a language.
    pub fn of(&self, language: Language) -> &str {
        match language {
            Language::Zh => &self.zh,
            Language::En => &self.en,
        }
    }
}

/// A lesson that was parsed without errors.
#[derive(Clone, Debug)]
pub struct Lesson {
    /// Name of its file without the extension; it identifies the lesson.
    pub name: String,
    /// Title in the list of lessons.
    pub title: Text,
    /// What the lesson teaches, for the list of lessons.
    pub about: Text,
    /// Initial state of the practice machine.
    pub begins: Begins,
    /// Stock and tools of the practice machine; `None` for a lesson without cutting.
    pub job: Option<Job>,
    /// The steps, at least one.
    pub steps: Vec<Step>,
}

/// A step of a lesson.
#[derive(Clone, Debug)]
pub struct Step {
    /// The instruction: what to do, and why.
    pub text: Text,
    /// Help for a learner who does not complete the step.
    pub hint: Text,
    /// Keys to mark on the panel.
    pub keys: Vec<Key>,
    /// Conditions that must hold during the step. If one does not, the learner goes back to
    /// the step that establishes it.
    pub needs: Vec<Condition>,
    /// Conditions that together complete the step.
    pub until: Vec<Condition>,
    /// Frequent mistakes, each with its text. The first one that applies is shown.
    pub wrong: Vec<Wrong>,
    /// How to complete the step, with keys and the handwheel alone.
    pub solution: Script,
}

/// A frequent mistake and the text that is shown for it.
#[derive(Clone, Debug)]
pub struct Wrong {
    /// Conditions that together detect the mistake.
    pub when: Vec<Condition>,
    /// The text for the learner.
    pub say: Text,
}

/// A condition on the state of the machine, in the syntax after `expect` in an operator
/// script.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// The condition as written.
    pub text: String,
    expect: Expectation,
}

impl Condition {
    /// Whether the condition holds now.
    pub fn holds(&self, emulator: &Emulator) -> bool {
        self.unmet(emulator).is_none()
    }

    /// Expected and current value, if the condition does not hold.
    pub fn unmet(&self, emulator: &Emulator) -> Option<UnmetExpectation> {
        self.expect.check(emulator).err()
    }

    /// The message for the learner, if the condition does not hold.
    pub fn said(&self, emulator: &Emulator) -> Option<Message> {
        let unmet = self.unmet(emulator)?;
        Some(say::subject_reason(&self.text, unmet.message()))
    }
}

/// Whether all conditions hold.
fn all_hold(conditions: &[Condition], emulator: &Emulator) -> bool {
    conditions.iter().all(|condition| condition.holds(emulator))
}

#[cfg(test)]
mod tests;
