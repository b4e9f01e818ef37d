//! Why a board shuts down, and which alarm that is.

/// Texts by their beginning.
const TEXTS: [(&str, u16); 9] = [
    ("Timer too close", 612),
    ("Stepper too far in past", 612),
    ("Rescheduled timer in the past", 612),
    ("Move queue overflow", 608),
    ("Invalid count parameter", 608),
    ("Can't reset time when stepper active", 608),
    ("Command parser error", 608),
    ("Invalid command", 608),
    ("Missed scheduling of next", 605),
];
/// What our own emergency stop is called.
const ASKED_FOR: &str = "Command request";

/// The alarm of a shutdown; none: it was asked for.
pub(super) fn alarm(text: &str) -> Option<u16> {
    if text == ASKED_FOR {
        return None;
    }
    let known = TEXTS.iter().find(|(begin, _)| text.starts_with(begin));
    Some(known.map_or(607, |(_, number)| *number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_have_their_alarms() {
        assert_eq!(alarm("Timer too close"), Some(612));
        assert_eq!(
            alarm("Missed scheduling of next digital out event"),
            Some(605)
        );
        assert_eq!(alarm("Missed scheduling of next hard pwm event"), Some(605));
        assert_eq!(alarm("Move queue overflow"), Some(608));
        assert_eq!(alarm("ADC out of range"), Some(607));
        assert_eq!(alarm("Command request"), None);
    }
}
