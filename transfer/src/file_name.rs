//! File names and partitions of the control: 8.3 names of letters and digits (manual V-3.5).

use core::fmt;

use gsk_messages::{Message, say};

/// Greatest number of characters before and after the point.
const MAX_PART_CHARS: [usize; 2] = [8, 3];

/// A partition of the control's file memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Partition {
    /// `USER`: programs and data.
    #[default]
    User,
    /// `USER1`: the second partition.
    User1,
    /// `USER2`: the third partition.
    User2,
}

impl Partition {
    /// All partitions in the order of their codes on the wire.
    pub const ALL: [Self; 3] = [Self::User, Self::User1, Self::User2];

    /// Returns the name of the partition, for instance `USER1`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::User => "USER",
            Self::User1 => "USER1",
            Self::User2 => "USER2",
        }
    }

    /// Returns the code of the partition in frames, from 0.
    pub(crate) const fn code(self) -> u8 {
        self as u8
    }

    /// Returns the partition with a code in frames; `None` for an unknown code.
    pub(crate) fn from_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }
}

/// Error: this file name is not allowed at the control.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct FileNameError(pub String);

impl FileNameError {
    /// Returns the message that the name is a device name of Windows or not a valid file name.
    pub fn message(&self) -> Message {
        match is_device_name(&self.0) {
            true => say::transfer_name_device(&self.0),
            false => say::transfer_name(&self.0),
        }
    }
}

/// Whether Windows takes a file name for a device, whatever its ending: `CON`, `nul.txt`,
/// `COM1.CNC`. Windows cannot store a file with such a name.
pub fn is_device_name(name: &str) -> bool {
    let stem = name.split(['.', ':']).next().unwrap_or(name);
    let stem = stem.trim_end_matches(' ').to_ascii_uppercase();
    let numbered = |port: &str| {
        let number = stem.strip_prefix(port);
        number.is_some_and(|it| {
            matches!(it, "0" | "¹" | "²" | "³") || matches!(it.as_bytes(), [b'1'..=b'9'])
        })
    };
    matches!(
        stem.as_str(),
        "CON" | "PRN" | "AUX" | "NUL" | "CONIN$" | "CONOUT$"
    ) || numbered("COM")
        || numbered("LPT")
}

/// A file name at the control: 1 to 8 letters and digits, optionally a point and 1 to 3 more. The
/// case is ignored.
#[derive(Clone, Debug, Eq)]
pub struct FileName(String);

impl FileName {
    /// Creates a file name if the control allows `name`.
    ///
    /// # Errors
    /// The name is not a valid 8.3 name, or is a device name of Windows.
    pub fn new(name: &str) -> Result<Self, FileNameError> {
        let (stem, ending) = name.split_once('.').unwrap_or((name, "x"));
        let is_valid = |part: &str, max_chars| {
            (1..=max_chars).contains(&part.len()) && part.bytes().all(|b| b.is_ascii_alphanumeric())
        };
        let is_device = is_device_name(stem);
        match !is_device && is_valid(stem, MAX_PART_CHARS[0]) && is_valid(ending, MAX_PART_CHARS[1])
        {
            true => Ok(Self(name.to_owned())),
            false => Err(FileNameError(name.to_owned())),
        }
    }

    /// Builds the file name of a program: `O0007.CNC`.
    pub fn from_program(number: u16) -> Self {
        Self(format!("O{number:04}.CNC"))
    }

    /// Returns the program number of a name like `O0007.CNC` (at most four digits); `None` for
    /// other names.
    pub fn program_number(&self) -> Option<u16> {
        let (stem, ending) = self.0.split_once('.')?;
        let digits = stem.strip_prefix(['O', 'o'])?;
        let is_program = (1..=4).contains(&digits.len()) && ending.eq_ignore_ascii_case("CNC");
        is_program.then(|| digits.parse().ok())?
    }

    /// Returns the name, with upper and lower case as it was created.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl PartialEq for FileName {
    fn eq(&self, other: &Self) -> bool {
        self.0.eq_ignore_ascii_case(&other.0)
    }
}

impl fmt::Display for FileName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_follow_8_3_rule() {
        for name in ["O0001.CNC", "ParaW.par", "20041223.jpg", "A", "a.b"] {
            assert!(FileName::new(name).is_ok(), "{name}");
        }
        for name in [
            "",
            ".CNC",
            "A.",
            "123456789.CNC",
            "A.CNCX",
            "轴.CNC",
            "A B.CNC",
            "../a",
            "A.B.C",
        ] {
            assert!(FileName::new(name).is_err(), "{name}");
        }
    }

    #[test]
    fn devices_of_windows_are_no_files() {
        for name in [
            "CON", "con.CNC", "Aux.par", "NUL.cnc", "PRN", "COM1.CNC", "lpt9", "COM0",
        ] {
            let refused = FileName::new(name).expect_err(name).to_string();
            assert!(refused.contains("device"), "{refused}");
        }
        for name in [
            "CONE.CNC",
            "COM.CNC",
            "COM10.CNC",
            "NULL",
            "LPTX.par",
            "AUX1",
        ] {
            assert!(FileName::new(name).is_ok(), "{name}");
        }
        assert!(is_device_name("CON .nc") && is_device_name("aux.job.ron"));
        assert!(!is_device_name("") && !is_device_name(".con"));
    }

    #[test]
    fn program_number_is_parsed_from_name() {
        let number = |name| {
            FileName::new(name)
                .ok()
                .and_then(|name| name.program_number())
        };
        assert_eq!(number("O0331.CNC"), Some(331));
        assert_eq!(number("o7.cnc"), Some(7));
        assert_eq!(number("O12345.CNC"), None);
        assert_eq!(number("O+1.CNC"), None);
        assert_eq!(number("ParaW.par"), None);
        assert_eq!(number("O.CNC"), None);
        assert_eq!(FileName::from_program(7).as_str(), "O0007.CNC");
        assert_eq!(
            FileName::new("paraw.PAR").ok(),
            FileName::new("ParaW.par").ok()
        );
    }
}
