//! PLC addresses: area letter, byte or entry number, and bit.
//!
//! `X2.1`, `X002.1` and `X0002.1` name the same bit. Listings print four digits. Bits are 0
//! to 7.

use std::fmt;
use std::str::FromStr;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// A memory area of the PLC, named by its address letter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Area {
    /// Inputs of the machine and the operator panel, X0 to X29: machine to PLC.
    X,
    /// Outputs to the machine and lamps, Y0 to Y19: PLC to machine.
    Y,
    /// Signals from the control, F0 to F255: CNC to PLC.
    F,
    /// Signals to the control, G0 to G255: PLC to CNC.
    G,
    /// Internal relays, R0 to R999. The system owns R900 and up.
    R,
    /// Message requests, A0 to A24. Each bit requests one message.
    A,
    /// Keep relays, K0 to K39, retained. The system owns K30 and up.
    K,
    /// Data table of bytes, D0 to D999. D300 and up are retained.
    D,
    /// Timer values, T0 to T99, ms, 32 bits. T80 and up are retained.
    T,
    /// Counter values, C0 to C99, 32 bits, retained.
    C,
    /// Counter presets, DC0 to DC99, 32 bits, retained.
    Dc,
    /// Timer presets, DT0 to DT99, ms, 32 bits, retained.
    Dt,
}

impl Area {
    /// All areas, in the order of the PLC pages.
    pub const ALL: [Area; 12] = [
        Area::X,
        Area::Y,
        Area::F,
        Area::G,
        Area::R,
        Area::A,
        Area::K,
        Area::D,
        Area::T,
        Area::C,
        Area::Dc,
        Area::Dt,
    ];

    /// Returns the address letters: `X` to `D`, `T`, `C`, `DC` or `DT`.
    #[must_use]
    pub const fn letter(self) -> &'static str {
        match self {
            Area::X => "X",
            Area::Y => "Y",
            Area::F => "F",
            Area::G => "G",
            Area::R => "R",
            Area::A => "A",
            Area::K => "K",
            Area::D => "D",
            Area::T => "T",
            Area::C => "C",
            Area::Dc => "DC",
            Area::Dt => "DT",
        }
    }

    /// Returns the number of bytes (X Y F G R A K D) or of 32-bit entries (T C DC DT) in
    /// the area.
    #[must_use]
    pub const fn count(self) -> u16 {
        match self {
            Area::X => 30,
            Area::Y => 20,
            Area::F | Area::G => 256,
            Area::R | Area::D => 1000,
            Area::A => 25,
            Area::K => 40,
            Area::T | Area::C | Area::Dc | Area::Dt => 100,
        }
    }

    /// Returns whether the area consists of 32-bit entries: T, C, DC and DT.
    #[must_use]
    pub const fn is_entry(self) -> bool {
        matches!(self, Area::T | Area::C | Area::Dc | Area::Dt)
    }

    /// Returns whether the bits of the area have addresses: X Y F G R A K.
    #[must_use]
    pub(crate) const fn has_bits(self) -> bool {
        !self.is_entry() && !matches!(self, Area::D)
    }

    fn from_letter(letter: &str) -> Option<Area> {
        Area::ALL
            .into_iter()
            .find(|area| area.letter().eq_ignore_ascii_case(letter))
    }
}

impl fmt::Display for Area {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.letter())
    }
}

/// The address of one bit of PLC memory, `X2.1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct BitAddress {
    /// The area. T, C, D, DC and DT have no bit addresses.
    pub area: Area,
    /// Number of the byte in the area, from 0.
    pub byte: u16,
    /// Number of the bit in the byte, 0 to 7.
    pub bit: u8,
}

impl BitAddress {
    /// Creates the address of bit `byte.bit` in `area`, without a range check.
    ///
    /// Memory reads a bit outside the area as 0 and ignores a write to it.
    #[must_use]
    pub const fn new(area: Area, byte: u16, bit: u8) -> BitAddress {
        BitAddress { area, byte, bit }
    }

    /// Returns the address as operators write it, without leading zeros: `X2.1`.
    #[must_use]
    pub fn short_name(self) -> String {
        format!("{}{}.{}", self.area, self.byte, self.bit)
    }

    /// Returns the address of the byte that contains the bit.
    #[must_use]
    pub(crate) const fn byte_address(self) -> ByteAddress {
        ByteAddress::new(self.area, self.byte)
    }
}

impl fmt::Display for BitAddress {
    /// Writes the address as listings do: `X0002.1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{:04}.{}", self.area, self.byte, self.bit)
    }
}

/// The address of a byte of X Y F G R A K D (`R100`) or of a 32-bit entry of T C DC DT
/// (`DT3`).
///
/// For a value of two or four bytes it is the address of the lowest byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct ByteAddress {
    /// The area that contains the byte or entry.
    pub area: Area,
    /// Number of the byte or entry in the area, from 0.
    pub byte: u16,
}

impl ByteAddress {
    /// Creates the address of byte or entry `byte` in `area`, without a range check.
    #[must_use]
    pub const fn new(area: Area, byte: u16) -> ByteAddress {
        ByteAddress { area, byte }
    }

    /// Returns the address as operators write it, without leading zeros: `R100`.
    #[must_use]
    pub fn short_name(self) -> String {
        format!("{}{}", self.area, self.byte)
    }
}

impl fmt::Display for ByteAddress {
    /// Writes the address as listings do: `R0100`, `DT0003`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{:04}", self.area, self.byte)
    }
}

/// The reason why a text is not a valid address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AddressError {
    /// The text is not an area letter, a number and an optional point with a bit.
    Malformed(String),
    /// The number is beyond the end of the area.
    OutOfRange {
        /// The text as written.
        text: String,
        /// The area that the text names.
        area: Area,
        /// Number of the last byte or entry of the area.
        last: u16,
    },
    /// The text names a bit of an area without bit addresses.
    NoBits(String),
    /// The text names a byte where the instruction needs a bit.
    Byte(String),
    /// The text names a bit where the instruction needs a byte or an entry.
    Bit(String),
}

impl AddressError {
    /// Returns the message about the error in the address, with the expected form.
    #[must_use]
    pub fn message(&self) -> Message {
        match self {
            Self::Malformed(text) => say::ladder_address_malformed(text),
            Self::OutOfRange { text, area, last } => {
                say::ladder_address_beyond_area(text, area, last)
            }
            Self::NoBits(text) => say::ladder_address_without_bits(text),
            Self::Byte(text) => say::ladder_bit_wanted(text),
            Self::Bit(text) => say::ladder_byte_wanted(text),
        }
    }
}

impl fmt::Display for AddressError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.message().fmt(f)
    }
}

impl std::error::Error for AddressError {}

/// An address text split into its parts, with or without a bit.
struct ParsedAddress {
    area: Area,
    byte: u16,
    bit: Option<u8>,
}

/// Splits a text at the first `mark`, an ASCII character; `None` without one.
///
/// `str::split_once` does the same, but its preparation takes longer than this search in a
/// short text.
pub(crate) fn split_once_at(text: &str, mark: u8) -> Option<(&str, &str)> {
    let at = text.bytes().position(|byte| byte == mark)?;
    Some((text.get(..at)?, text.get(at + 1..)?))
}

/// Parses a decimal number with any number of digits and leading zeros. Numbers beyond
/// `u32` saturate. Returns `None` for any other text.
pub(crate) fn parse_decimal(text: &str) -> Option<u32> {
    if text.is_empty() || !text.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let value = text.bytes().fold(0u32, |value, byte| {
        value
            .saturating_mul(10)
            .saturating_add(u32::from(byte - b'0'))
    });
    Some(value)
}

fn parse_address(text: &str) -> Result<ParsedAddress, AddressError> {
    let malformed = || AddressError::Malformed(text.to_owned());
    let end = text
        .find(|c: char| !c.is_ascii_alphabetic())
        .unwrap_or(text.len());
    let (letter, rest) = text.split_at(end);
    let area = Area::from_letter(letter).ok_or_else(malformed)?;
    let (number, bit) = match split_once_at(rest, b'.') {
        Some((number, bit)) => (number, Some(bit)),
        None => (rest, None),
    };
    let number = parse_decimal(number).ok_or_else(malformed)?;
    let bit = match bit {
        None => None,
        Some(bit) => match bit.as_bytes() {
            [digit @ b'0'..=b'7'] => Some(digit - b'0'),
            _ => return Err(malformed()),
        },
    };
    match u16::try_from(number) {
        Ok(byte) if byte < area.count() => Ok(ParsedAddress { area, byte, bit }),
        _ => Err(AddressError::OutOfRange {
            text: text.to_owned(),
            area,
            last: area.count() - 1,
        }),
    }
}

impl FromStr for BitAddress {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<BitAddress, AddressError> {
        let ParsedAddress { area, byte, bit } = parse_address(text)?;
        if !area.has_bits() {
            return Err(AddressError::NoBits(text.to_owned()));
        }
        let bit = bit.ok_or_else(|| AddressError::Byte(text.to_owned()))?;
        Ok(BitAddress { area, byte, bit })
    }
}

impl FromStr for ByteAddress {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<ByteAddress, AddressError> {
        let ParsedAddress { area, byte, bit } = parse_address(text)?;
        if bit.is_some() {
            return Err(AddressError::Bit(text.to_owned()));
        }
        Ok(ByteAddress { area, byte })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leading_zeros_and_case_do_not_matter() {
        for text in ["X2.1", "X002.1", "x0002.1", "X00000000000002.1"] {
            let bit: BitAddress = text.parse().unwrap();
            assert_eq!(bit, BitAddress::new(Area::X, 2, 1));
            assert_eq!(bit.to_string(), "X0002.1");
        }
        let preset: ByteAddress = "dt3".parse().unwrap();
        assert_eq!(preset.to_string(), "DT0003");
    }

    #[test]
    fn every_area_ends_at_its_last_address() {
        for area in Area::ALL {
            let last = format!("{area}{}", area.count() - 1);
            let beyond = format!("{area}{}", area.count());
            assert!(last.parse::<ByteAddress>().is_ok(), "{last}");
            assert!(beyond.parse::<ByteAddress>().is_err(), "{beyond}");
        }
    }

    #[test]
    fn invalid_addresses_are_refused() {
        for text in [
            "",
            "X",
            "X.",
            "X1.",
            "X1.8",
            "X1.77",
            "X-1.0",
            "Q1.0",
            "1.0",
            "X1.0.0",
            "X٣.0",
            "X99999999999999999999.0",
            "D5.0",
            "T1.0",
            "R5",
            "X１.0",
        ] {
            assert!(text.parse::<BitAddress>().is_err(), "{text}");
        }
        for text in ["R1000", "DC100", "X30", "R1.0", "DD1", "L5"] {
            assert!(text.parse::<ByteAddress>().is_err(), "{text}");
        }
    }
}
