//! An exam: exercises in a fixed order without help, which only the instructor pauses and ends.

use blake2::{Blake2b256, Digest};
use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// Least number of digits of a PIN.
const MIN_PIN_DIGITS: usize = 4;
/// Greatest number of digits of a PIN.
const MAX_PIN_DIGITS: usize = 12;

/// The instructor's PIN, stored as a salted hash. All PINs can be tried by reading the file: the
/// PIN only protects against the learner at the window.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExamPin {
    salt: u64,
    hash: String,
}

impl ExamPin {
    /// Creates the hash of a PIN; `None` if the PIN is not 4 to 12 digits. `salt` is a random
    /// number.
    pub fn new(pin: &str, salt: u64) -> Option<Self> {
        Self::is_valid(pin).then(|| Self {
            salt,
            hash: hash_pin(pin, salt),
        })
    }

    /// Creates a PIN from its hash, as the view of a class sends it.
    pub const fn from_hash(salt: u64, hash: String) -> Self {
        Self { salt, hash }
    }

    /// Returns the salt and the hash.
    pub fn as_hash(&self) -> (u64, &str) {
        (self.salt, &self.hash)
    }

    /// Returns whether a text has the form of a PIN: 4 to 12 digits.
    pub fn is_valid(pin: &str) -> bool {
        let is_long = (MIN_PIN_DIGITS..=MAX_PIN_DIGITS).contains(&pin.len());
        is_long && pin.bytes().all(|byte| byte.is_ascii_digit())
    }

    /// Returns whether `pin` is the stored PIN.
    pub fn is(&self, pin: &str) -> bool {
        hash_pin(pin, self.salt) == self.hash
    }
}

fn hash_pin(pin: &str, salt: u64) -> String {
    let mut hash = Blake2b256::new();
    hash.update(salt.to_le_bytes());
    hash.update(pin.as_bytes());
    let bytes: [u8; 32] = hash.finalize().into();
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// What happened during an exam apart from the work: pauses, interruptions and wrong PINs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExamNote {
    /// Number of pauses by the instructor.
    pub pauses: u32,
    /// Number of times the program was closed or stopped before the end of the exam, and continued.
    pub interruptions: u32,
    /// Number of wrong PINs that were entered.
    pub wrong_pins: u32,
}

impl ExamNote {
    /// Returns the pauses, interruptions and wrong PINs as a message.
    pub fn message(&self) -> Message {
        say::exam_note(self.pauses, self.interruptions, self.wrong_pins)
    }
}

/// An exam of one learner, with its progress.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exam {
    /// Name of the learner.
    pub learner: String,
    /// Names of the exercises of the exam, in their order.
    pub tasks: Vec<String>,
    /// The PIN with which the instructor pauses, continues and ends the exam.
    pub pin: ExamPin,
    /// Number of exercises that the learner has handed in.
    pub done: usize,
    /// Whether the instructor has paused the exam.
    pub is_paused: bool,
    /// Whether the exam has ended.
    pub is_over: bool,
    /// Pauses, interruptions and wrong PINs so far.
    pub note: ExamNote,
}

impl Exam {
    /// Creates an exam at its first exercise.
    pub const fn new(learner: String, tasks: Vec<String>, pin: ExamPin) -> Self {
        Self {
            learner,
            tasks,
            pin,
            done: 0,
            is_paused: false,
            is_over: false,
            note: ExamNote {
                pauses: 0,
                interruptions: 0,
                wrong_pins: 0,
            },
        }
    }

    /// Returns the name of the current exercise; `None` after the last one.
    pub fn current(&self) -> Option<&str> {
        let task = self.tasks.get(self.done).filter(|_| !self.is_over);
        task.map(String::as_str)
    }

    /// Returns whether `pin` is the PIN of the exam, and counts a wrong one.
    pub fn accepts(&mut self, pin: &str) -> bool {
        let is_right = self.pin.is(pin);
        self.note.wrong_pins += u32::from(!is_right);
        is_right
    }

    /// Pauses the exam (`true`) or continues it (`false`).
    pub const fn set_paused(&mut self, is_paused: bool) {
        if is_paused && !self.is_paused {
            self.note.pauses += 1;
        }
        self.is_paused = is_paused;
    }

    /// Continues with the next exercise; the exam is over after the last one.
    pub const fn finish_task(&mut self) {
        self.done += 1;
        self.is_over |= self.done >= self.tasks.len();
    }

    /// Writes the exam as text.
    ///
    /// # Errors
    /// It cannot be written as RON.
    pub fn to_text(&self) -> Result<String, Message> {
        ron::ser::to_string_pretty(self, ron::ser::PrettyConfig::default()).map_err(say::as_written)
    }

    /// Reads an exam from its text.
    ///
    /// # Errors
    ///
    /// The text cannot be read; the message names the line and the reason.
    pub fn from_text(text: &str) -> Result<Self, Message> {
        ron::from_str(text)
            .map_err(|wrong| say::in_line(wrong.span.start.line, say::as_written(wrong.code)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exam() -> Exam {
        let pin = ExamPin::new("4711", 7).expect("a PIN");
        Exam::new("Li".to_owned(), vec!["a".to_owned(), "b".to_owned()], pin)
    }

    #[test]
    fn only_the_pin_is_accepted_and_wrong_ones_are_noted() {
        let mut exam = exam();
        for wrong in ["", "471", "4712", "04711", "4711 "] {
            assert!(!exam.accepts(wrong));
        }
        assert!(exam.accepts("4711"));
        assert_eq!(exam.note.wrong_pins, 5);
        for unfit in ["123", "1234567890123", "12a4", ""] {
            assert_eq!(ExamPin::new(unfit, 0), None);
        }
        let other_salt = ExamPin::new("4711", 8).expect("a PIN");
        assert_ne!(other_salt, exam.pin);
    }

    #[test]
    fn an_exam_survives_its_file_and_ends_after_its_last_task() {
        let mut exam = exam();
        exam.set_paused(true);
        exam.set_paused(true);
        exam.set_paused(false);
        assert_eq!(exam.note.pauses, 1);
        assert_eq!(exam.current(), Some("a"));
        exam.finish_task();
        let text = exam.to_text().expect("a text");
        assert!(!text.contains("4711"));
        let mut read = Exam::from_text(&text).expect("an exam");
        assert_eq!(read, exam);
        assert_eq!(read.current(), Some("b"));
        read.finish_task();
        assert!(read.is_over && read.current().is_none());
        let damaged = text.replace("done: 1", "done: -1");
        let error = Exam::from_text(&damaged).expect_err("a negative number");
        assert!(error.to_string().contains("line 11"), "{error}");
    }
}
