//! Lists the keys of the GSK980MDi in its diagnosis numbers 016 to 024. A bit is 1 while its
//! key is pressed.

/// The names of the panel keys by diagnosis number; the first name is that of bit 7.
pub const KEYS: [(u16, [&str; 8]); 9] = [
    (16, ["VF1", "RST", "O", "N", "G", "7", "8", "9"]),
    (17, ["VF2", "X", "Y/&", "Z", "U/W", "4", "5", "6"]),
    (18, ["VF3", "H", "F/E", "R/V", "D/L", "1", "2", "3"]),
    (19, ["VF4", "I/A", "J/B", "K/C", "P/Q", "-", "0", "."]),
    (20, ["VF5", "M", "S", "T", "/,#", "BLK", "EOB", "IN"]),
    (
        21,
        ["VF6", "PGU", "PGD", "CHG", "INS/ALT", "DEL", "CAN", "OUT"],
    ),
    (
        22,
        ["VF7", "CRU", "RIGHT", "POS", "PRG", "OFT", "ALM", "SET"],
    ),
    (
        23,
        ["VF8", "CRD", "LEFT", "PAR", "DGN", "GRA", "PLC", "HELP"],
    ),
    (24, ["F1", "F2", "F3", "F4", "F5", "F6", "F7", "F8"]),
];

/// Returns the names of the keys that a diagnosis number with value `bits` shows as pressed.
/// Returns `None` if the number shows no keys.
pub fn pressed_keys(number: u16, bits: u8) -> Option<Vec<&'static str>> {
    let (_, keys) = KEYS.iter().find(|(own, _)| *own == number)?;
    let shown = keys.iter().enumerate();
    let shown = shown.filter(|(index, _)| bits >> (7 - index) & 1 == 1);
    Some(shown.map(|(_, key)| *key).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_keys() {
        assert_eq!(pressed_keys(16, 0b0100_1000), Some(vec!["RST", "G"]));
        assert_eq!(pressed_keys(24, 1), Some(vec!["F8"]));
        assert_eq!(pressed_keys(23, 0), Some(vec![]));
        assert_eq!(pressed_keys(15, 1), None);
        let mut names: Vec<_> = KEYS.iter().flat_map(|(_, keys)| keys).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), 72);
    }
}
