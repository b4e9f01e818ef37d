//! What the instructor may request, and why a seat refuses.

use gsk_core::machine::LatheFault;
use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// Greatest size of a request, bytes.
pub const MAX_REQUEST_BYTES: usize = 1024 * 1024;
/// Longest time for which a request keeps the LCD live, s.
const MAX_LCD_S: u16 = 60;
/// Greatest number of exercises of an exam.
const MAX_EXAM_TASKS: usize = 40;
/// Length of the hash of a PIN, hexadecimal digits.
const PIN_HASH_DIGITS: usize = 64;

/// The PIN of an exam, as its salted hash.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeatPin {
    /// Number that the hash covers with the PIN.
    pub salt: u64,
    /// The hash, hexadecimal.
    pub hash: String,
}

impl SeatPin {
    fn is_valid(&self) -> bool {
        self.hash.len() == PIN_HASH_DIGITS && self.hash.bytes().all(|it| it.is_ascii_hexdigit())
    }
}

/// A request of the instructor. There is none that presses a key.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "request", rename_all = "snake_case", deny_unknown_fields)]
pub enum SeatRequest {
    /// Publish the LCD for this time.
    Lcd {
        /// Time, s.
        seconds: u16,
    },
    /// Offer an exercise of the seat to the learner.
    Task {
        /// Name of the exercise.
        exercise: String,
    },
    /// Offer an exercise that the request contains.
    TaskFile {
        /// Name of the exercise.
        exercise: String,
        /// Its file `task.ron`.
        text: String,
        /// Its drawing, PNG in base64; `None` without one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        drawing: Option<String>,
    },
    /// Offer an exam to the learner.
    BeginExam {
        /// Names of its exercises, in their order.
        exercises: Vec<String>,
        /// The PIN with which the instructor ends it at the seat.
        pin: SeatPin,
    },
    /// End the exam that is under way, with its PIN. An exercise in progress is handed in.
    EndExam {
        /// The PIN.
        pin: SeatPin,
    },
    /// Set a fault of the simulated lathe.
    Fault {
        /// The fault.
        fault: LatheFault,
    },
    /// Clear all faults of the simulated lathe.
    ClearFaults,
    /// The instructor is coming: the request for help ends.
    Coming,
}

/// What a seat permits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SeatRights {
    /// Whether a board moves real slides.
    pub has_board: bool,
    /// Whether the learner allows faults.
    pub allows_faults: bool,
    /// Whether an exam is under way.
    pub is_in_exam: bool,
}

/// Why a seat refuses a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SeatRefusal {
    /// A board moves real slides.
    Board,
    /// The learner does not allow faults.
    Faults,
    /// An exam is under way.
    Exam,
    /// No exam is under way.
    NoExam,
    /// The exam has another PIN.
    Pin,
    /// An exercise is under way: its faults are its own.
    Exercise,
    /// The learner does not want to begin now.
    Learner,
    /// The seat does not have the exercise.
    Unknown,
    /// The seat is a page in a browser, which cannot store the recordings of an exam.
    Browser,
    /// The request is malformed.
    Malformed,
}

impl SeatRefusal {
    /// The reason as a message.
    pub fn message(self) -> Message {
        match self {
            Self::Board => say::class_refused_board(),
            Self::Faults => say::class_refused_faults(),
            Self::Exam => say::class_refused_exam(),
            Self::NoExam => say::class_refused_no_exam(),
            Self::Pin => say::class_refused_pin(),
            Self::Exercise => say::class_refused_exercise(),
            Self::Learner => say::class_refused_learner(),
            Self::Unknown => say::class_refused_unknown(),
            Self::Browser => say::class_refused_browser(),
            Self::Malformed => say::class_refused_malformed(),
        }
    }
}

impl SeatRequest {
    /// Parses a request.
    ///
    /// # Errors
    /// The bytes are not a request.
    pub fn parse(payload: &[u8]) -> Result<Self, SeatRefusal> {
        if payload.len() > MAX_REQUEST_BYTES {
            return Err(SeatRefusal::Malformed);
        }
        let request: Self = serde_json::from_slice(payload).map_err(|_| SeatRefusal::Malformed)?;
        let is_valid = match &request {
            Self::Lcd { seconds } => *seconds <= MAX_LCD_S,
            Self::Task { exercise } | Self::TaskFile { exercise, .. } => is_name(exercise),
            Self::BeginExam { exercises, pin } => {
                (1..=MAX_EXAM_TASKS).contains(&exercises.len())
                    && exercises.iter().all(|exercise| is_name(exercise))
                    && pin.is_valid()
            }
            Self::EndExam { pin } => pin.is_valid(),
            Self::Fault { .. } | Self::ClearFaults | Self::Coming => true,
        };
        is_valid.then_some(request).ok_or(SeatRefusal::Malformed)
    }

    /// The request as JSON.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// What is requested, as an answer names it; `None` if it needs no answer.
    pub fn subject(&self) -> Option<String> {
        match self {
            Self::Lcd { .. } | Self::Coming => None,
            Self::Task { exercise } | Self::TaskFile { exercise, .. } => Some(exercise.clone()),
            Self::BeginExam { .. } => Some("exam".to_owned()),
            Self::EndExam { .. } => Some("exam-end".to_owned()),
            Self::Fault { fault } => Some(fault.row().name.to_owned()),
            Self::ClearFaults => Some("clear-faults".to_owned()),
        }
    }

    /// Why a seat with these rights refuses the request; `None` if it does not.
    pub const fn refusal(&self, rights: SeatRights) -> Option<SeatRefusal> {
        match self {
            Self::Lcd { .. } | Self::Coming => None,
            _ if rights.has_board => Some(SeatRefusal::Board),
            Self::EndExam { .. } => None,
            _ if rights.is_in_exam => Some(SeatRefusal::Exam),
            Self::Fault { .. } | Self::ClearFaults if !rights.allows_faults => {
                Some(SeatRefusal::Faults)
            }
            _ => None,
        }
    }
}

/// Whether a text is the name of an exercise, and no path.
fn is_name(text: &str) -> bool {
    let is_plain = |character: char| character.is_alphanumeric() || "-_".contains(character);
    (1..=80).contains(&text.len()) && text.chars().all(is_plain)
}

/// The answer of a seat.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SeatAnswer {
    /// What was requested: the name of an exercise or a fault.
    pub subject: String,
    /// Why it is refused; `None` if it is accepted.
    pub refusal: Option<SeatRefusal>,
}

impl SeatAnswer {
    /// Parses an answer; `None` for malformed bytes.
    pub fn parse(payload: &[u8]) -> Option<Self> {
        let answer: Self = serde_json::from_slice(payload).ok()?;
        is_name(&answer.subject).then_some(answer)
    }

    /// The answer as JSON.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pin() -> SeatPin {
        SeatPin {
            salt: u64::MAX,
            hash: "0f".repeat(32),
        }
    }

    #[test]
    fn a_board_refuses_tasks_and_faults_and_no_request_presses_a_key() {
        let requests = [
            SeatRequest::Task {
                exercise: "shaft".to_owned(),
            },
            SeatRequest::TaskFile {
                exercise: "own".to_owned(),
                text: "()".to_owned(),
                drawing: Some("iVBORw0K".to_owned()),
            },
            SeatRequest::BeginExam {
                exercises: vec!["01-a".to_owned(), "b_2".to_owned()],
                pin: pin(),
            },
            SeatRequest::Fault {
                fault: LatheFault::TurretBlocked,
            },
            SeatRequest::ClearFaults,
        ];
        let rights = SeatRights {
            allows_faults: true,
            ..SeatRights::default()
        };
        for (index, request) in requests.iter().enumerate() {
            let read = SeatRequest::parse(request.to_json().as_bytes());
            assert_eq!(read.as_ref(), Ok(request));
            assert_eq!(request.refusal(rights), None);
            let with_board = SeatRights {
                has_board: true,
                ..rights
            };
            assert_eq!(request.refusal(with_board), Some(SeatRefusal::Board));
            let in_exam = SeatRights {
                is_in_exam: true,
                ..rights
            };
            assert_eq!(request.refusal(in_exam), Some(SeatRefusal::Exam));
            let strict = request.refusal(SeatRights::default());
            assert_eq!(strict, (index >= 3).then_some(SeatRefusal::Faults));
        }
        let end = SeatRequest::EndExam { pin: pin() };
        assert_eq!(
            SeatRequest::parse(end.to_json().as_bytes()),
            Ok(end.clone())
        );
        let in_exam = SeatRights {
            is_in_exam: true,
            ..SeatRights::default()
        };
        assert_eq!(end.refusal(in_exam), None);
        let with_board = SeatRights {
            has_board: true,
            ..in_exam
        };
        assert_eq!(end.refusal(with_board), Some(SeatRefusal::Board));
        for text in [
            r#"{"request":"begin_exam","exercises":[],"pin":{"salt":1,"hash":"00"}}"#,
            r#"{"request":"end_exam","pin":{"salt":1,"hash":"4711"}}"#,
            r#"{"request":"end_exam","pin":"4711"}"#,
            r#"{"request":"key","key":"CycleStart"}"#,
            r#"{"request":"task","exercise":"../../etc"}"#,
            r#"{"request":"task","exercise":"a","key":"x"}"#,
            r#"{"request":"task_file","exercise":"..","text":"()"}"#,
            r#"{"request":"task_file","exercise":"a/b","text":"()"}"#,
            r#"{"request":"task_file","exercise":"a\\b","text":"()"}"#,
            r#"{"request":"task_file","exercise":"C:","text":"()"}"#,
            r#"{"request":"task_file","exercise":"a","text":"()","path":"/tmp"}"#,
            r#"{"request":"lcd","seconds":3600}"#,
            r#"{"request":"fault","fault":"Everything"}"#,
            "",
            "null",
        ] {
            let read = SeatRequest::parse(text.as_bytes());
            assert_eq!(read, Err(SeatRefusal::Malformed), "{text}");
        }
        let chinese = r#"{"request":"task","exercise":"车外圆-1"}"#;
        assert!(SeatRequest::parse(chinese.as_bytes()).is_ok());
        let long = vec![b' '; MAX_REQUEST_BYTES + 1];
        assert_eq!(SeatRequest::parse(&long), Err(SeatRefusal::Malformed));
    }

    #[test]
    fn random_bytes_are_no_request_and_no_answer() {
        let mut seed = 3_u64;
        for _ in 0..10_000 {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let mut text = br#"{"request":"task","exercise":"shaft"}"#.to_vec();
            let at = (seed >> 40) as usize % text.len();
            text[at] = (seed >> 33) as u8;
            text.truncate((seed >> 20) as usize % (text.len() + 1));
            // Neither panics.
            let _ = SeatRequest::parse(&text);
            let _ = SeatAnswer::parse(&text);
        }
    }
}
