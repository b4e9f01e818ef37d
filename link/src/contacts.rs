//! Maps contacts of the control (X addresses) to pins of a board.

use std::collections::BTreeMap;

use super::pin::PinName;
use super::{FaultyLinkConfig, Input};

/// Contacts that `inputs` must not name, because they have a separate setting: byte and bit, name,
/// signal and path of that setting.
const SEPARATE: [((u8, u8), [&str; 3]); 3] = [
    ((0, 3), ["X0.3", "*DECX", "x.dec"]),
    ((0, 5), ["X0.5", "*ESP", "io.estop"]),
    ((1, 3), ["X1.3", "*DECZ", "z.dec"]),
];
/// Letters after `Pn:` in a line board's report that may be mapped to a contact.
const LETTERS: &str = "PDHRSE";

/// Parses a contact X0.0 to X3.7 into byte and bit; `None` for other texts.
fn address(text: &str) -> Option<(u8, u8)> {
    let (byte, bit) = text.strip_prefix('X')?.split_once('.')?;
    let (byte, bit) = (byte.parse().ok()?, bit.parse().ok()?);
    (byte <= 3 && bit <= 7).then_some((byte, bit))
}

/// Checks that each entry of `inputs` names a contact and a pin, and returns the first error.
/// `letters` tells that the board is a line board, whose pins are letters of its status report.
pub(super) fn check(
    inputs: &BTreeMap<String, String>,
    letters: bool,
) -> Result<(), FaultyLinkConfig> {
    for (key, pin) in inputs {
        let Some(address) = address(key) else {
            return Err(FaultyLinkConfig::NoContact);
        };
        if let Some((_, names)) = SEPARATE.iter().find(|(known, _)| *known == address) {
            let [contact, signal, field] = *names;
            return Err(FaultyLinkConfig::HasSetting {
                contact,
                signal,
                field,
            });
        }
        let PinName { name, pull_up, .. } = PinName::read(pin);
        if name.is_empty() {
            return Err(FaultyLinkConfig::ContactWithoutPin);
        }
        if letters && !(name.len() == 1 && LETTERS.contains(name)) {
            return Err(FaultyLinkConfig::NoLetter);
        }
        if letters && pull_up {
            return Err(FaultyLinkConfig::LetterPullUp);
        }
    }
    Ok(())
}

/// Returns the valid contacts of `inputs` with their pins, sorted by the name of the contact.
pub(super) fn wired(inputs: &BTreeMap<String, String>) -> impl Iterator<Item = (Input, &str)> {
    inputs.iter().filter_map(|(key, pin)| {
        let (byte, bit) = address(key)?;
        Some((Input::Contact { byte, bit }, pin.as_str()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(key: &str, pin: &str, letters: bool) -> Result<(), FaultyLinkConfig> {
        check(&BTreeMap::from([(key.to_owned(), pin.to_owned())]), letters)
    }

    #[test]
    fn entries_are_checked() {
        assert_eq!(checked("X1.4", "^!PD0", false), Ok(()));
        assert_eq!(checked("X1.5", "!H", true), Ok(()));
        assert!(checked("X1.5", "Q", true).is_err());
        assert_eq!(
            checked("X1.5", "^H", true),
            Err(FaultyLinkConfig::LetterPullUp)
        );
        assert!(checked("X4.0", "PD0", false).is_err());
        assert!(checked("Y1.0", "PD0", false).is_err());
        assert!(checked("X1.0", "^", false).is_err());
        let own = checked("X0.5", "PD0", false).map_err(|fault| fault.to_string());
        assert_eq!(
            own,
            Err("X0.5 is *ESP: name its pin in io.estop".to_owned())
        );
    }
}
