//! Maps the shutdown reason of a board to an alarm and its remedy.

use gsk_messages::{Message, say};
use gsk_units::alarm;

/// The cause of a shutdown of the board's firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ShutdownCause {
    /// The firmware shut down because steps arrived too late.
    StepsLate,
    /// The firmware shut down because a command was damaged on the wire.
    DamagedCommand,
    /// The host did not renew an output or the lease in time.
    HostSilent,
    /// A guard input, that is the emergency stop or the drive alarm, is operated.
    Guard,
    /// An axis does not follow its steps.
    FollowingError,
    /// The spindle encoder is disturbed, or the axes cannot follow it.
    SpindleEncoder,
    /// The spindle did not stop or reverse in a tap.
    TapTooDeep,
    /// A fault of the board.
    BoardFault,
}

impl ShutdownCause {
    /// Returns the alarm number for the operator and the remedy.
    fn to_alarm(self) -> (u16, Message) {
        match self {
            Self::StepsLate => (alarm::STEPS_TOO_LATE, say::shutdown_steps_late()),
            Self::DamagedCommand => (alarm::LINK_PROTOCOL, say::shutdown_wire_failed()),
            Self::HostSilent => (alarm::LINK_LOST, say::shutdown_computer_silent()),
            Self::Guard => (alarm::EMERGENCY_STOP, say::shutdown_guard()),
            Self::FollowingError => (alarm::FOLLOWING_ERROR, say::shutdown_following_error()),
            Self::SpindleEncoder => (alarm::SPINDLE_ENCODER, say::shutdown_spindle_encoder()),
            Self::TapTooDeep => (alarm::SPINDLE_ENCODER, say::shutdown_tap_too_deep()),
            Self::BoardFault => (alarm::BOARD_FAULT, say::shutdown_board_failed()),
        }
    }
}

/// Beginnings of the board's shutdown texts, each with its cause.
const TEXTS: [(&str, ShutdownCause); 21] = [
    ("Timer too close", ShutdownCause::StepsLate),
    ("Stepper too far in past", ShutdownCause::StepsLate),
    ("Rescheduled timer in the past", ShutdownCause::StepsLate),
    ("Move queue overflow", ShutdownCause::DamagedCommand),
    ("Invalid count parameter", ShutdownCause::DamagedCommand),
    (
        "Can't reset time when stepper active",
        ShutdownCause::DamagedCommand,
    ),
    ("Command parser error", ShutdownCause::DamagedCommand),
    ("Invalid command", ShutdownCause::DamagedCommand),
    // "digital out event", "pwm event", "hard pwm event".
    ("Missed scheduling of next", ShutdownCause::HostSilent),
    // Those of our own firmware.
    ("Angle queue empty", ShutdownCause::StepsLate),
    ("Lease expired", ShutdownCause::HostSilent),
    (GUARD, ShutdownCause::Guard),
    ("Following error too large", ShutdownCause::FollowingError),
    ("Spindle encoder overrun", ShutdownCause::SpindleEncoder),
    (
        "Spindle index at another count",
        ShutdownCause::SpindleEncoder,
    ),
    ("Spindle reversed too far", ShutdownCause::SpindleEncoder),
    (
        "Axis cannot follow the spindle",
        ShutdownCause::SpindleEncoder,
    ),
    ("Tap beyond its last segment", ShutdownCause::TapTooDeep),
    ("Step clock not set", ShutdownCause::DamagedCommand),
    (
        "Angle entry without begin_angle",
        ShutdownCause::DamagedCommand,
    ),
    ("Lease for another", ShutdownCause::DamagedCommand),
];
/// The text of a shutdown by a guard input.
const GUARD: &str = "Guard input tripped";
/// The text of a shutdown by the link's own emergency stop.
const OWN_STOP: &str = "Command request";

/// Whether a guard input has caused a shutdown with this text.
pub(super) fn is_by_guard(text: &str) -> bool {
    text == GUARD
}

/// Returns the alarm number and the remedy for a shutdown with this text; `None` if the link has
/// requested the shutdown.
pub(super) fn alarm(text: &str) -> Option<(u16, Message)> {
    if text == OWN_STOP {
        return None;
    }
    let known = TEXTS.iter().find(|(begin, _)| text.starts_with(begin));
    let cause = known.map_or(ShutdownCause::BoardFault, |(_, cause)| *cause);
    Some(cause.to_alarm())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shutdown_texts_map_to_alarms() {
        let number = |text| alarm(text).map(|(number, _)| number);
        assert_eq!(number("Timer too close"), Some(612));
        assert_eq!(number("Missed scheduling of next pwm event"), Some(605));
        assert_eq!(number("Move queue overflow"), Some(608));
        assert_eq!(number("ADC out of range"), Some(607));
        assert_eq!(number("Guard input tripped"), Some(alarm::EMERGENCY_STOP));
        assert_eq!(number("Following error too large"), Some(613));
        assert_eq!(number("Spindle index at another count"), Some(614));
        assert_eq!(number("Command request"), None);
    }
}
