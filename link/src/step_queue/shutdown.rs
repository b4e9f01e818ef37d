//! Why a board shuts down, which alarm that is, and what the operator does.

use gsk_messages::{Message, say};
use gsk_units::alarm;

/// Whose fault it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ShutdownCause {
    /// Steps came too late.
    Hurried,
    /// What the board was told was damaged on the way.
    Confused,
    /// The board was not told what it waited for.
    LeftAlone,
    /// The board itself.
    Broken,
}

impl ShutdownCause {
    /// The alarm, and what helps against it.
    fn to_alarm(self) -> (u16, Message) {
        match self {
            Self::Hurried => (alarm::STEPS_TOO_LATE, say::shutdown_steps_late()),
            Self::Confused => (alarm::LINK_PROTOCOL, say::shutdown_wire_failed()),
            Self::LeftAlone => (alarm::LINK_LOST, say::shutdown_computer_silent()),
            Self::Broken => (alarm::BOARD_FAULT, say::shutdown_board_failed()),
        }
    }
}

/// Texts by their beginning.
const TEXTS: [(&str, ShutdownCause); 9] = [
    ("Timer too close", ShutdownCause::Hurried),
    ("Stepper too far in past", ShutdownCause::Hurried),
    ("Rescheduled timer in the past", ShutdownCause::Hurried),
    ("Move queue overflow", ShutdownCause::Confused),
    ("Invalid count parameter", ShutdownCause::Confused),
    (
        "Can't reset time when stepper active",
        ShutdownCause::Confused,
    ),
    ("Command parser error", ShutdownCause::Confused),
    ("Invalid command", ShutdownCause::Confused),
    // "digital out event", "pwm event", "hard pwm event".
    ("Missed scheduling of next", ShutdownCause::LeftAlone),
];
/// What our own emergency stop is called.
const OWN_STOP: &str = "Command request";

/// The alarm of a shutdown and what helps; none: it was asked for.
pub(super) fn alarm(text: &str) -> Option<(u16, Message)> {
    if text == OWN_STOP {
        return None;
    }
    let known = TEXTS.iter().find(|(begin, _)| text.starts_with(begin));
    let cause = known.map_or(ShutdownCause::Broken, |(_, cause)| *cause);
    Some(cause.to_alarm())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_have_their_alarms() {
        let number = |text| alarm(text).map(|(number, _)| number);
        assert_eq!(number("Timer too close"), Some(612));
        assert_eq!(number("Missed scheduling of next pwm event"), Some(605));
        assert_eq!(number("Move queue overflow"), Some(608));
        assert_eq!(number("ADC out of range"), Some(607));
        assert_eq!(number("Command request"), None);
    }
}
