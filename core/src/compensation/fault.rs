//! Errors of compensation C with their alarms (manual, appendix 3).

use gsk_messages::{Message, say};

use crate::alarm::{Alarm, number};
use crate::command::SourcePosition;

/// The reason why compensation C refuses a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CompensationFault {
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

impl CompensationFault {
    pub(crate) const fn number(self) -> u16 {
        match self {
            Self::StartOnArc => number::NOSE_START_ON_ARC,
            Self::Call => number::NOSE_CALL,
            Self::DivisionByZero => number::NOSE_DIVISION_BY_ZERO,
            Self::ArcEnd => number::NOSE_ARC_END,
            Self::NoResult => number::NOSE_NO_RESULT,
            Self::SamePoint => number::NOSE_SAME_POINT,
            Self::CenterAtStart => number::NOSE_CENTER_AT_START,
            Self::CenterAtEnd => number::NOSE_CENTER_AT_END,
            Self::SmallArc => number::NOSE_SMALL_ARC,
            Self::NoMeetingOfArcs => number::NOSE_ARC_TO_ARC,
            Self::SharpCorner => number::NOSE_SHARP_CORNER,
            Self::CancelOnArc => number::NOSE_CANCEL_ON_ARC,
            Self::Interference => number::NOSE_INTERFERENCE,
            Self::NoMeetingLineArc => number::NOSE_LINE_TO_ARC,
            Self::NoMeetingArcLine => number::NOSE_ARC_TO_LINE,
        }
    }

    fn reason(self) -> Message {
        match self {
            Self::StartOnArc => say::nose_start_on_arc(),
            Self::Call => say::nose_on_at_call(),
            Self::DivisionByZero => say::nose_no_direction(),
            Self::ArcEnd => say::arc_end_off_circle(),
            Self::NoResult => say::nose_no_result(),
            Self::SamePoint => say::nose_move_without_length(),
            Self::CenterAtStart => say::arc_center_at_start(),
            Self::CenterAtEnd => say::arc_center_at_end(),
            Self::SmallArc => say::nose_larger_than_arc(),
            Self::NoMeetingOfArcs => say::nose_arcs_do_not_meet(),
            Self::SharpCorner => say::nose_corner_too_sharp(),
            Self::CancelOnArc => say::nose_cancel_on_arc(),
            Self::Interference => say::nose_interferes(),
            Self::NoMeetingLineArc => say::nose_line_misses_arc(),
            Self::NoMeetingArcLine => say::nose_arc_misses_line(),
        }
    }

    /// Whether the fault concerns a move together with the previous move, which is then not
    /// started.
    pub(crate) const fn is_between_moves(self) -> bool {
        !matches!(
            self,
            Self::StartOnArc | Self::Call | Self::ArcEnd | Self::CancelOnArc
        )
    }

    /// Returns the alarm of this fault, without a position in the program.
    pub(crate) fn alarm(self) -> Alarm {
        Alarm::new(self.number()).with_detail(self.reason())
    }

    /// Returns the alarm of a fault at the corner of two moves. Its position is the block `first`,
    /// which is not started, or the block `second` if the words of that block alone are wrong.
    pub(super) fn corner_alarm(self, first: SourcePosition, second: SourcePosition) -> Alarm {
        let position = match self {
            Self::SamePoint | Self::CenterAtStart | Self::CenterAtEnd | Self::SmallArc => second,
            _ => first,
        };
        let mut alarm = self.alarm().with_source(position);
        if first.line != second.line {
            alarm.detail = Some(say::of_two_lines(self.reason(), first.line, second.line));
        }
        alarm
    }
}
