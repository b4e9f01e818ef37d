//! Parses tool offsets, work zeros and the start position from the words of command line
//! options.

use gsk_core::units::parse_finite;
use gsk_messages::{Message, say};

use crate::axes::Axes;
use crate::memory::{MillMemory, MillOffsetColumn, MillOffsetMemory};
use crate::modal::WorkZero;
use crate::space::{Length, MillPosition};

/// The message about an invalid word of a tool offset, work zero or start position.
#[derive(Clone, Debug, PartialEq)]
pub struct MillWordError(pub Message);

impl MillMemory {
    /// Parses a tool offset, `1=H,D` in mm, optionally followed by the wear of both, and
    /// stores it: `1=V` in offset memory A, `1=V,W` in B.
    ///
    /// # Errors
    ///
    /// Returns a message if the word has another form or a value is out of range.
    pub fn take_offset(&mut self, word: &str) -> Result<(), MillWordError> {
        let wrong = || MillWordError(say::mill_offset_form(word));
        let (name, values) = word.split_once('=').ok_or_else(wrong)?;
        let number: i64 = name.trim().parse().map_err(|_| wrong())?;
        let columns: &[MillOffsetColumn] = match self.offset_memory {
            MillOffsetMemory::A => &[MillOffsetColumn::Length],
            MillOffsetMemory::B => &[MillOffsetColumn::Length, MillOffsetColumn::LengthWear],
            MillOffsetMemory::C => &[
                MillOffsetColumn::Length,
                MillOffsetColumn::Radius,
                MillOffsetColumn::LengthWear,
                MillOffsetColumn::RadiusWear,
            ],
        };
        let values = parse_lengths(values).ok_or_else(wrong)?;
        if values.len() > columns.len() {
            return Err(wrong());
        }
        for (column, value) in columns.iter().zip(values) {
            let set = self.set_offset(number, *column, value, false);
            set.map_err(|alarm| MillWordError(alarm.reason()))?;
        }
        Ok(())
    }

    /// Parses a work zero and stores it: `54=X,Y,Z`, `54.1P12=X,Y,Z`, or `0=X,Y,Z` for the
    /// external offset, machine coordinates in mm. Values of a fourth and fifth axis follow.
    ///
    /// # Errors
    ///
    /// Returns a message if the word has another form or a value is out of range.
    pub fn take_zero(&mut self, word: &str) -> Result<(), MillWordError> {
        let wrong = || MillWordError(say::mill_zero_form(word));
        let (name, values) = word.split_once('=').ok_or_else(wrong)?;
        let point = parse_position(self, values).ok_or_else(wrong)?;
        let name = name.trim().trim_start_matches('G');
        let zero = match name.split_once(".1P") {
            Some(("54", additional)) => match additional.parse() {
                Ok(number @ 1..=48_u8) => WorkZero(WorkZero::FIRST_ADDITIONAL + number - 1),
                _ => return Err(wrong()),
            },
            _ => match name.parse() {
                Ok(0_u8) => {
                    self.external = point;
                    return Ok(());
                }
                Ok(number @ 54..=59) => WorkZero(number - 54),
                _ => return Err(wrong()),
            },
        };
        if let Some(value) = self.zero_mut(zero) {
            *value = point;
        }
        Ok(())
    }
}

/// Parses a point: `X,Y,Z` in mm, optionally followed by the fourth and fifth axis of the
/// machine, mm or degrees. `None` if invalid.
pub(crate) fn parse_position(memory: &MillMemory, text: &str) -> Option<MillPosition> {
    let count = 3 + Axes::from_memory(memory).all_further().count();
    let values = parse_lengths(text)?;
    if !(3..=count).contains(&values.len()) {
        return None;
    }
    let mut point = MillPosition::default();
    for (axis, value) in Axes::from_memory(memory).all().zip(values) {
        point.set(axis, value);
    }
    Some(point)
}

/// Parses lengths in mm, separated by commas; `None` if one is invalid.
fn parse_lengths(text: &str) -> Option<Vec<Length>> {
    let number = |word: &str| {
        let value = parse_finite(word.trim())?;
        (value.abs() <= 99_999.999).then(|| Length::from_mm(value).rounded())
    };
    text.split(',').map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_offsets_and_zeros() {
        let mut memory = MillMemory::default();
        assert_eq!(memory.take_offset("3=120.5,6,0,-0.03"), Ok(()));
        assert_eq!(memory.tool_length(3), Length::from_mm(120.5));
        assert!((memory.cutter_radius(3) - 5.97).abs() < 1e-9);
        assert_eq!(memory.take_zero("54.1P48=1,2,3"), Ok(()));
        let zero = memory.zero(WorkZero(53));
        assert_eq!(zero.mm(), [1.0, 2.0, 3.0]);
        assert_eq!(memory.take_zero("0=1,0,0"), Ok(()));
        for wrong in ["0=1", "401=1", "1=1000", "1", "x=1", "1=nan", "1=1,2,3,4,5"] {
            assert!(memory.take_offset(wrong).is_err(), "{wrong}");
        }
        for wrong in [
            "53=1,2,3",
            "54=1,2",
            "54.1P49=0,0,0",
            "54.1P0=0,0,0",
            "54=inf,0,0",
        ] {
            assert!(memory.take_zero(wrong).is_err(), "{wrong}");
        }
    }
}
