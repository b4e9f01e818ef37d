//! Finds the bits, parameters and keys that a message names.

use gsk_core::plc::address::BitAddress;

use crate::keys::{Key, all_rows};

/// The bits that a text names, as in `*SP (G8.5) is 0`.
pub(super) fn find_bits(text: &str) -> Vec<BitAddress> {
    let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '.'));
    let mut bits: Vec<BitAddress> = Vec::new();
    for bit in words.filter_map(|word| word.trim_end_matches('.').parse().ok()) {
        if !bits.contains(&bit) {
            bits.push(bit);
        }
    }
    bits
}

/// The parameters that a text names, each with its bit if it names one: `168.2 = 1`,
/// `parameter 084`, `(168 bit 2)`.
pub(super) fn find_parameters(text: &str) -> Vec<(u16, Option<u8>)> {
    let words: Vec<&str> = text
        .split(|c: char| !(c.is_ascii_alphanumeric() || c == '.'))
        .filter(|word| !word.is_empty())
        .collect();
    let mut found = Vec::new();
    for (at, word) in words.iter().enumerate() {
        let word = word.trim_end_matches('.');
        let (number, bit) = word.split_once('.').unwrap_or((word, ""));
        let is_number = number.len() == 3 && number.bytes().all(|digit| digit.is_ascii_digit());
        let Some(number) = number.parse::<u16>().ok().filter(|_| is_number) else {
            continue;
        };
        let named_bit = match words.get(at + 1..at + 3) {
            Some(["bit", bit]) => bit.parse().ok(),
            _ => bit.parse().ok(),
        };
        let follows_name = at > 0 && words[at - 1].eq_ignore_ascii_case("parameter");
        let parameter = match named_bit.filter(|bit: &u8| *bit < 8) {
            None if follows_name && bit.is_empty() => (number, None),
            Some(bit) => (number, Some(bit)),
            None => continue,
        };
        if !found.contains(&parameter) {
            found.push(parameter);
        }
    }
    found
}

/// The first key that a text names in brackets, by its legend alone or after its English name;
/// `None` without one.
pub(super) fn find_key(text: &str) -> Option<Key> {
    let (_, rest) = text.split_once('[')?;
    let (name, _) = rest.split_once(']')?;
    let is_named = |legend: &str| match name.strip_suffix(legend) {
        Some("") => true,
        Some(english) => english.ends_with(' '),
        None => false,
    };
    let found = all_rows().find(|row| is_named(row.name_zh) || is_named(&row.legend.concat()));
    found.map(|row| row.key)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::plc::address::Area;

    #[test]
    fn bits_parameters_and_keys_are_found_in_a_text() {
        let text = "feed hold: *SP (G8.5) is 0: the key [暂停], the pin X1.5; 172.5 = 0.";
        let bits = [
            BitAddress::new(Area::G, 8, 5),
            BitAddress::new(Area::X, 1, 5),
        ];
        assert_eq!(find_bits(text), bits);
        assert_eq!(find_parameters(text), [(172, Some(5))]);
        assert_eq!(find_key(text), Some(Key::FeedHold));
        assert_eq!(find_key("press [Jog 手动]"), Some(Key::Jog));
    }

    #[test]
    fn parameters_are_found_in_each_form_and_other_numbers_are_not() {
        assert_eq!(find_parameters("Chuck (168 bit 2)"), [(168, Some(2))]);
        assert_eq!(find_parameters("parameter 084 sets"), [(84, None)]);
        assert_eq!(find_parameters("alarm 207, 12.5 mm, 1000 r/min"), []);
        assert_eq!(find_key("no key ["), None);
    }
}
