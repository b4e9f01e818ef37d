//! Names of files at the control: 8.3, letters and digits, in one of three partitions
//! (manual V-3.5).

use core::fmt;

use gsk_messages::{Message, say};

/// Longest name before the point, and ending after it.
const LONGEST: [usize; 2] = [8, 3];

/// A user partition of the control's store.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Partition {
    /// `USER`: programs and data.
    #[default]
    User,
    /// `USER1`.
    User1,
    /// `USER2`.
    User2,
}

impl Partition {
    /// All of them, by their code on the wire.
    pub const ALL: [Self; 3] = [Self::User, Self::User1, Self::User2];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::User => "USER",
            Self::User1 => "USER1",
            Self::User2 => "USER2",
        }
    }

    /// Its code on the wire.
    pub(crate) const fn code(self) -> u8 {
        self as u8
    }

    /// From its code.
    pub(crate) fn of(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }
}

/// A name that the control cannot have.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct NameError(pub String);

impl NameError {
    /// What is said of it.
    pub fn message(&self) -> Message {
        match is_device_name(&self.0) {
            true => say::transfer_name_device(&self.0),
            false => say::transfer_name(&self.0),
        }
    }
}

/// Whether Windows takes a file name for a device, whatever its ending: `CON`, `nul.txt`,
/// `COM1.CNC`. A file of such a name cannot be stored there.
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

/// A name of a file at the control: up to eight letters and digits, a point, up to three.
/// Capital and small letters are the same.
#[derive(Clone, Debug, Eq)]
pub struct FileName(String);

impl FileName {
    /// Checks a name.
    ///
    /// # Errors
    /// It has another form, or is the name of a device of Windows.
    pub fn new(name: &str) -> Result<Self, NameError> {
        let (stem, ending) = name.split_once('.').unwrap_or((name, "x"));
        let good = |part: &str, longest| {
            (1..=longest).contains(&part.len()) && part.bytes().all(|b| b.is_ascii_alphanumeric())
        };
        let stored = !is_device_name(stem);
        match stored && good(stem, LONGEST[0]) && good(ending, LONGEST[1]) {
            true => Ok(Self(name.to_owned())),
            false => Err(NameError(name.to_owned())),
        }
    }

    /// The name of a program.
    pub fn of_program(number: u16) -> Self {
        Self(format!("O{number:04}.CNC"))
    }

    /// The number of a program, when it is the name of one: `Onnnn.CNC`, at most four
    /// digits.
    pub fn program(&self) -> Option<u16> {
        let (stem, ending) = self.0.split_once('.')?;
        let digits = stem.strip_prefix(['O', 'o'])?;
        let few = (1..=4).contains(&digits.len()) && ending.eq_ignore_ascii_case("CNC");
        few.then(|| digits.parse().ok())?
    }

    /// As it is written.
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
    fn names_are_eight_and_three_letters_and_digits() {
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
    fn programs_are_known_by_their_names() {
        let number = |name| FileName::new(name).ok().and_then(|name| name.program());
        assert_eq!(number("O0331.CNC"), Some(331));
        assert_eq!(number("o7.cnc"), Some(7));
        assert_eq!(number("O12345.CNC"), None);
        assert_eq!(number("O+1.CNC"), None);
        assert_eq!(number("ParaW.par"), None);
        assert_eq!(number("O.CNC"), None);
        assert_eq!(FileName::of_program(7).as_str(), "O0007.CNC");
        assert_eq!(
            FileName::new("paraw.PAR").ok(),
            FileName::new("ParaW.par").ok()
        );
    }
}
