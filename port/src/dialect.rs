//! The dialects that the porter reads.

use gsk_messages::{Message, say};

/// A family of lathe programs that other controls or CAM systems read or write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForeignDialect {
    /// Fanuc 0T and later controls: a cycle has two blocks.
    Fanuc0t,
    /// Fanuc 10T and 15T: a cycle has one block.
    Fanuc10t,
    /// Programs of Haas lathes.
    Haas,
    /// Fanuc programs from the postprocessors of Fusion 360.
    Fusion,
    /// Programs of Mach3 Turn.
    Mach3,
    /// Programs of LinuxCNC lathes.
    LinuxCnc,
}

impl ForeignDialect {
    /// All dialects, in the order in which the command line lists them.
    pub const ALL: [Self; 6] = [
        Self::Fanuc0t,
        Self::Fanuc10t,
        Self::Haas,
        Self::Fusion,
        Self::Mach3,
        Self::LinuxCnc,
    ];

    /// Returns the word that selects the dialect on the command line, such as `haas`.
    pub const fn command_word(self) -> &'static str {
        match self {
            Self::Fanuc0t => "fanuc0t",
            Self::Fanuc10t => "fanuc-10t",
            Self::Haas => "haas",
            Self::Fusion => "fusion",
            Self::Mach3 => "mach3",
            Self::LinuxCnc => "linuxcnc",
        }
    }

    /// Returns the name of the dialect as users read it, such as `Fanuc 0T`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fanuc0t => "Fanuc 0T",
            Self::Fanuc10t => "Fanuc 10T/15T",
            Self::Haas => "Haas",
            Self::Fusion => "Fusion 360",
            Self::Mach3 => "Mach3",
            Self::LinuxCnc => "LinuxCNC",
        }
    }

    /// Returns the dialect that a word of the command line selects; `None` for other words.
    pub fn from_command_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.command_word() == word)
    }

    /// Whether a number without a point counts least increments unless an option selects
    /// otherwise.
    pub(crate) const fn counts_increments(self) -> bool {
        !matches!(self, Self::Mach3 | Self::LinuxCnc)
    }

    /// Whether `;` begins a comment; in the other dialects it ends a block.
    pub(crate) const fn has_semicolon_comments(self) -> bool {
        matches!(self, Self::Mach3 | Self::LinuxCnc)
    }
}

/// How a number without a decimal point is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlainNumbers {
    /// In least increments: `X1500` is X1.5.
    Increments,
    /// As written: `X15` is X15.
    AsWritten,
}

/// A set of G and M codes with their meaning. Fanuc has two sets, and the interpreters after RS-274
/// have their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CodeSet {
    /// The codes of Fanuc, G code system A.
    FanucA,
    /// The codes of Fanuc, G code system B.
    FanucB,
    /// The codes of Haas lathes.
    Haas,
    /// The codes of Mach3 Turn.
    Mach3,
    /// The codes of LinuxCNC lathes.
    LinuxCnc,
}

impl CodeSet {
    /// Returns the name of the set in the table of codes, such as `Fanuc A`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::FanucA => "Fanuc A",
            Self::FanucB => "Fanuc B",
            Self::Haas => "Haas",
            Self::Mach3 => "Mach3",
            Self::LinuxCnc => "LinuxCNC",
        }
    }

    /// Whether the set is that of an interpreter after RS-274: feed per minute at power-on, G90 and
    /// G91 for absolute and incremental words.
    pub(crate) const fn is_rs274(self) -> bool {
        matches!(self, Self::Mach3 | Self::LinuxCnc)
    }
}

/// Settings of the foreign control that its programs do not contain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PortOptions {
    /// How numbers without a decimal point are read; `None` selects the default of the dialect.
    pub plain_numbers: Option<PlainNumbers>,
    /// Whether lengths are inches before the first G20 or G21.
    pub starts_in_inches: bool,
}

/// A word that changed its meaning or could not be ported, with its line.
#[derive(Clone, Debug, PartialEq)]
pub struct PortFinding {
    /// Line of the foreign text, from 1.
    pub line: u32,
    /// The foreign word as written.
    pub word: String,
    /// Whether the block was not ported. It stops the ported program with alarm 500.
    pub is_refused: bool,
    /// What differs on this control, or why there is no equivalent.
    pub note: Message,
}

impl PortFinding {
    /// Returns the message about the word, without its line.
    pub fn message(&self) -> Message {
        match self.is_refused {
            true => say::ported_refused(&self.word, self.note.clone()),
            false => say::ported_changed(&self.word, self.note.clone()),
        }
    }
}
