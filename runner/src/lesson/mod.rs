//! Guided lessons: steps on the real state of a practice machine, from data files.
//!
//! A file says what the machine begins with, and of each step what to do, which keys to
//! mark, what must come true, and how it is done by keys alone. [`Lesson::read`] reads one,
//! [`Practice`] follows a learner through it, [`play`] carries its solution out.

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
    /// Chinese.
    pub zh: String,
    /// English.
    pub en: String,
}

impl Text {
    /// In a language.
    pub fn of(&self, language: Language) -> &str {
        match language {
            Language::Zh => &self.zh,
            Language::En => &self.en,
        }
    }
}

/// A lesson that was read without errors.
#[derive(Clone, Debug)]
pub struct Lesson {
    /// What it is called by: the name of its file without its ending.
    pub name: String,
    /// Its title.
    pub title: Text,
    /// What is learnt in it.
    pub about: Text,
    /// What the practice machine begins with.
    pub begins: Begins,
    /// Stock and tools in the practice machine.
    pub job: Option<Job>,
    /// Its steps, one at least.
    pub steps: Vec<Step>,
}

/// A step of a lesson.
#[derive(Clone, Debug)]
pub struct Step {
    /// What to do, and why.
    pub text: Text,
    /// What helps when it does not come true.
    pub hint: Text,
    /// The keys to mark on the panel.
    pub keys: Vec<Key>,
    /// What must hold while the step is worked on; where it does not, the learner is sent
    /// back to the step that brings it about.
    pub needs: Vec<Condition>,
    /// What must come true together.
    pub until: Vec<Condition>,
    /// What often goes wrong, with a sentence of its own; the first that holds is said.
    pub wrong: Vec<Wrong>,
    /// How it is done, by keys and the handwheel alone.
    pub solution: Script,
}

/// A mistake and what is said of it.
#[derive(Clone, Debug)]
pub struct Wrong {
    /// What holds then, together.
    pub when: Vec<Condition>,
    /// What is said.
    pub say: Text,
}

/// Something that holds or does not: what stands after `expect` in an operator script.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// As it is written.
    pub text: String,
    expect: Expectation,
}

impl Condition {
    /// Whether it holds.
    pub fn holds(&self, emulator: &Emulator) -> bool {
        self.unmet(emulator).is_none()
    }

    /// What is there instead.
    pub fn unmet(&self, emulator: &Emulator) -> Option<UnmetExpectation> {
        self.expect.check(emulator).err()
    }

    /// What is said of it when it does not hold.
    pub fn said(&self, emulator: &Emulator) -> Option<Message> {
        let unmet = self.unmet(emulator)?;
        Some(say::subject_reason(&self.text, unmet.message()))
    }
}

/// Whether all of them hold.
fn all_hold(conditions: &[Condition], emulator: &Emulator) -> bool {
    conditions.iter().all(|condition| condition.holds(emulator))
}

#[cfg(test)]
mod tests;
