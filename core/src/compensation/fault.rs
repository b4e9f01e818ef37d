//! What compensation C refuses, with its alarm (manual, appendix 3).

use crate::alarm::Alarm;
use crate::command::Source;

/// A refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    StartOnArc,
    Call,
    DivisionByZero,
    ArcEnd,
    NoResult,
    SamePoint,
    CenterAtStart,
    CenterAtEnd,
    SmallArc,
    NoMeetingOfArcs,
    SharpCorner,
    CancelOnArc,
    Interference,
    NoMeetingLineArc,
    NoMeetingArcLine,
}

impl Fault {
    pub(crate) const fn number(self) -> u16 {
        match self {
            Self::StartOnArc => 34,
            Self::Call => 36,
            Self::DivisionByZero => 46,
            Self::ArcEnd => 48,
            Self::NoResult => 49,
            Self::SamePoint => 50,
            Self::CenterAtStart => 51,
            Self::CenterAtEnd => 52,
            Self::SmallArc => 53,
            Self::NoMeetingOfArcs => 54,
            Self::SharpCorner => 55,
            Self::CancelOnArc => 56,
            Self::Interference => 57,
            Self::NoMeetingLineArc => 58,
            Self::NoMeetingArcLine => 59,
        }
    }

    const fn reason(self) -> &'static str {
        match self {
            Self::StartOnArc => {
                "the first move after G41 or G42 must be straight (G00 or G01), not an arc"
            }
            Self::Call => "cancel the compensation with G40 before M98, and before M99 returns",
            Self::DivisionByZero => "the two paths give no direction",
            Self::ArcEnd => {
                "the end point lies more than 0.010 mm off the circle about the programmed centre"
            }
            Self::NoResult => "the calculation of this corner gives no number",
            Self::SamePoint => "a move without length while the compensation is on",
            Self::CenterAtStart => "the centre of the arc is its start point",
            Self::CenterAtEnd => "the centre of the arc is its end point",
            Self::SmallArc => "the nose radius is greater than the radius of an inner arc",
            Self::NoMeetingOfArcs => "the two arcs, moved by the nose radius, have no intersection",
            Self::SharpCorner => "the two paths enclose less than 1 degree",
            Self::CancelOnArc => "the move that cancels with G40 must be straight, not an arc",
            Self::Interference => {
                "the nose is too large for this place: it would cut into the part"
            }
            Self::NoMeetingLineArc => {
                "line and following arc, moved by the nose radius, have no intersection"
            }
            Self::NoMeetingArcLine => {
                "arc and following line, moved by the nose radius, have no intersection"
            }
        }
    }

    /// Whether it was found between two moves: then the first one is not begun.
    pub(crate) const fn of_two_moves(self) -> bool {
        !matches!(
            self,
            Self::StartOnArc | Self::Call | Self::ArcEnd | Self::CancelOnArc
        )
    }

    /// The alarm, without its place.
    pub(crate) fn alarm(self) -> Alarm {
        Alarm::new(self.number()).because(self.reason())
    }

    /// The alarm of a corner: at the block that is not begun, or, when the words
    /// of the next one are wrong in themselves, at that.
    pub(super) fn at_corner(self, first: Source, second: Source) -> Alarm {
        let place = match self {
            Self::SamePoint | Self::CenterAtStart | Self::CenterAtEnd | Self::SmallArc => second,
            _ => first,
        };
        let mut alarm = self.alarm().at(place);
        if first.line != second.line {
            alarm.detail = Some(format!(
                "{} (lines {} and {})",
                self.reason(),
                first.line,
                second.line
            ));
        }
        alarm
    }
}
