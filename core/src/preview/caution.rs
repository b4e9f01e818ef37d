//! What the control takes without an alarm and yet is likely a slip.

use core::mem::discriminant;

use gsk_messages::{Message, say};

use super::facts::Facts;
use super::{Turning, Walk};
use crate::command::{Command, Source};
use crate::units::Feed;

/// Feeds per minute below this were likely meant per revolution, mm/min.
const LEAST_FEED: f64 = 1.0;

/// A kind of slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Slip {
    /// A cut under G98 slower than 1 mm/min.
    SlowFeed,
    /// A cut while the spindle stands.
    SpindleStands,
    /// A cut after a T word, without a tool offset in force.
    NoOffset,
    /// G28, and nobody has said where the work lies on the machine.
    MachineZero,
    /// The program does not end where its G50 says that it begins. X and Z as they
    /// are programmed.
    EndElsewhere {
        /// Where G50 says the tool is.
        set: (f64, f64),
        /// Where the tool is at the end, in the same coordinates.
        end: (f64, f64),
    },
}

/// A likely slip and its block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Caution {
    /// What.
    pub slip: Slip,
    /// Where it was met first.
    pub source: Source,
}

impl Caution {
    /// In words, with the line.
    pub fn sentence(&self) -> Message {
        say::in_line(self.source.line, self.slip.message())
    }
}

impl Slip {
    /// Its name, for tools that sort what is found.
    pub const fn id(self) -> &'static str {
        match self {
            Self::SlowFeed => "slow-feed",
            Self::SpindleStands => "spindle-stands",
            Self::NoOffset => "no-offset",
            Self::MachineZero => "machine-zero",
            Self::EndElsewhere { .. } => "end-elsewhere",
        }
    }

    /// In words.
    pub fn message(self) -> Message {
        match self {
            Self::SlowFeed => say::caution_feed_slow(),
            Self::SpindleStands => say::caution_spindle_stands(),
            Self::NoOffset => say::caution_no_offset(),
            Self::MachineZero => say::caution_machine_zero(),
            Self::EndElsewhere { set, end } => {
                say::caution_end_elsewhere(set.0, set.1, end.0, end.1)
            }
        }
    }
}

impl Walk<'_> {
    /// Looks at a cut that is about to be made.
    pub(super) fn look_at_cut(&mut self, command: &Command, feed: Option<Feed>) {
        let source = command.source;
        let of_feed = Facts::MOTION.and(Facts::FEED).and(Facts::PER);
        if matches!(feed, Some(Feed::PerMinute(rate)) if rate < LEAST_FEED)
            && self.is_sure_of(of_feed)
        {
            self.caution(Slip::SlowFeed, source);
        }
        if self.spindle.turning() == Turning::Stopped
            && self.is_sure_of(Facts::MOTION.and(Facts::TURNING))
        {
            self.caution(Slip::SpindleStands, source);
        }
        if command.modal.offset == 0
            && !self.so_far.tools.is_empty()
            && self.is_sure_of(Facts::MOTION.and(Facts::TOOL))
        {
            self.caution(Slip::NoOffset, source);
        }
    }

    pub(super) fn caution(&mut self, slip: Slip, source: Source) {
        let cautions = &mut self.so_far.cautions;
        let same = |caution: &Caution| discriminant(&caution.slip) == discriminant(&slip);
        if !cautions.iter().any(same) {
            cautions.push(Caution { slip, source });
        }
    }
}
