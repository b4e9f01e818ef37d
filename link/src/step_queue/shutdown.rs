//! Why a board shuts down, which alarm that is, and what the operator does.

use gsk_units::alarm;

/// Alarms and what helps against them.
const HURRIED: (u16, &str) = (
    alarm::STEPS_TOO_LATE,
    "steps came too late: less load on the computer, a lower feed; then RESET and reference return",
);
const CONFUSED: (u16, &str) = (
    alarm::LINK_PROTOCOL,
    "the link or the wire failed: look at cable and earth; RESET and reference return",
);
const LEFT_ALONE: (u16, &str) = (
    alarm::LINK_LOST,
    "the computer or the wire was silent: look at both; RESET and reference return",
);
const BROKEN: (u16, &str) = (
    alarm::BOARD_FAULT,
    "the board failed by itself: see the text; RESET and reference return",
);
/// Texts by their beginning.
const TEXTS: [(&str, (u16, &str)); 9] = [
    ("Timer too close", HURRIED),
    ("Stepper too far in past", HURRIED),
    ("Rescheduled timer in the past", HURRIED),
    ("Move queue overflow", CONFUSED),
    ("Invalid count parameter", CONFUSED),
    ("Can't reset time when stepper active", CONFUSED),
    ("Command parser error", CONFUSED),
    ("Invalid command", CONFUSED),
    // "digital out event", "pwm event", "hard pwm event".
    ("Missed scheduling of next", LEFT_ALONE),
];
/// What our own emergency stop is called.
const ASKED_FOR: &str = "Command request";

/// The alarm of a shutdown and what helps; none: it was asked for.
pub(super) fn alarm(text: &str) -> Option<(u16, &'static str)> {
    if text == ASKED_FOR {
        return None;
    }
    let known = TEXTS.iter().find(|(begin, _)| text.starts_with(begin));
    Some(known.map_or(BROKEN, |(_, alarm)| *alarm))
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
