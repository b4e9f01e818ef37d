//! The forms and their names.

use gsk_messages::{Message, say};

/// A form: what is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FormKind {
    /// The face of the stock.
    Face,
    /// A cylinder or taper outside, with the edge at the front and the corner at the shoulder.
    Turn,
    /// The same inside a hole.
    Bore,
    /// An outline given point by point.
    Contour,
    /// Grooves outside or inside.
    Groove,
    /// The end of the part.
    PartOff,
    /// A thread outside or inside.
    Thread,
    /// A hole on the spindle axis.
    Drill,
    /// A centre hole.
    Center,
}

impl FormKind {
    /// All forms, in the order of the list.
    pub const ALL: [Self; 9] = [
        Self::Face,
        Self::Turn,
        Self::Bore,
        Self::Contour,
        Self::Groove,
        Self::PartOff,
        Self::Thread,
        Self::Drill,
        Self::Center,
    ];

    /// The word of the form on the command line.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Face => "face",
            Self::Turn => "turn",
            Self::Bore => "bore",
            Self::Contour => "contour",
            Self::Groove => "groove",
            Self::PartOff => "part-off",
            Self::Thread => "thread",
            Self::Drill => "drill",
            Self::Center => "centre",
        }
    }

    /// The form with this word, in upper or lower case; `None` if there is none.
    pub fn from_word(word: &str) -> Option<Self> {
        let mut all = Self::ALL.into_iter();
        all.find(|form| form.word().eq_ignore_ascii_case(word))
    }

    /// The name of the form.
    pub fn name(self) -> Message {
        match self {
            Self::Face => say::form_face(),
            Self::Turn => say::form_turn(),
            Self::Bore => say::form_bore(),
            Self::Contour => say::form_contour(),
            Self::Groove => say::form_groove(),
            Self::PartOff => say::form_part_off(),
            Self::Thread => say::form_thread(),
            Self::Drill => say::form_drill(),
            Self::Center => say::form_center(),
        }
    }

    /// What the form cuts, in a sentence.
    pub fn purpose(self) -> Message {
        match self {
            Self::Face => say::form_face_purpose(),
            Self::Turn => say::form_turn_purpose(),
            Self::Bore => say::form_bore_purpose(),
            Self::Contour => say::form_contour_purpose(),
            Self::Groove => say::form_groove_purpose(),
            Self::PartOff => say::form_part_off_purpose(),
            Self::Thread => say::form_thread_purpose(),
            Self::Drill => say::form_drill_purpose(),
            Self::Center => say::form_center_purpose(),
        }
    }
}
