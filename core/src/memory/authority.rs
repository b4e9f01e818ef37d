//! Operation levels and their passwords (manual III-2.5.1).

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// An operation level, from 0 (all rights) to 5 (logged off).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct OperationLevel(u8);

impl OperationLevel {
    /// Machine builder: may send and receive programs above O9000 through the serial port.
    pub(crate) const BUILDER: Self = Self(2);
    /// Workshop: may change parameters and all programs. A new control has this level.
    pub(crate) const WORKSHOP: Self = Self(3);
    /// Operator: may change programs below O9000 and tool offsets.
    pub(crate) const OPERATOR: Self = Self(4);
    /// The level without any rights: the operator is logged off.
    pub const NONE: Self = Self(5);

    /// The number of the level, 0 to 5; a lower number has more rights.
    pub const fn number(self) -> u8 {
        self.0
    }

    /// The level after power-on if this level was active at power-off: at most the workshop's.
    const fn after_power_on(self) -> Self {
        if self.0 < Self::WORKSHOP.0 {
            Self::WORKSHOP
        } else {
            self
        }
    }

    /// Number of digits of the password for this level.
    const fn password_digits(self) -> usize {
        8 - self.0 as usize
    }
}

/// The active operation level, and the passwords of levels 0 to 4.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Plain", into = "Plain")]
pub struct Authority {
    level: OperationLevel,
    passwords: [String; 5],
}

#[derive(Clone, Serialize, Deserialize)]
#[serde(rename = "Authority")]
struct Plain {
    level: u8,
    passwords: [String; 5],
}

impl Default for Authority {
    fn default() -> Self {
        let first = |level: u8| "12345678"[..OperationLevel(level).password_digits()].to_owned();
        Self {
            level: OperationLevel::WORKSHOP,
            passwords: [0, 1, 2, 3, 4].map(first),
        }
    }
}

impl Authority {
    /// Returns the operation level that is active.
    pub const fn level(&self) -> OperationLevel {
        self.level
    }

    /// The level that `password` opens; `None` if no level has this password.
    pub fn level_for(&self, password: &str) -> Option<OperationLevel> {
        let level = self.passwords.iter().position(|own| own == password)?;
        u8::try_from(level).ok().map(OperationLevel)
    }

    /// Activates the level that `password` opens. Returns `false` if no level has this
    /// password.
    pub fn enter(&mut self, password: &str) -> bool {
        let level = self.level_for(password);
        self.level = level.unwrap_or(self.level);
        level.is_some()
    }

    /// Logs off: activates [`OperationLevel::NONE`].
    pub const fn log_off(&mut self) {
        self.level = OperationLevel::NONE;
    }

    /// Replaces the password `old` by `new`. Returns `false` if no level has `old`, or if
    /// `new` has another length or characters other than digits.
    pub fn change_password(&mut self, old: &str, new: &str) -> bool {
        let digits = new.bytes().all(|byte| byte.is_ascii_digit());
        let password = self.passwords.iter_mut().find(|own| *own == old);
        match password {
            Some(own) if digits && new.len() == own.len() => {
                new.clone_into(own);
                true
            }
            _ => false,
        }
    }

    /// Sets the level as power-on does: a level with more rights than the workshop's becomes
    /// the workshop's.
    pub const fn power_on(&mut self) {
        self.level = self.level.after_power_on();
    }
}

impl From<Authority> for Plain {
    fn from(authority: Authority) -> Self {
        Self {
            level: authority.level.0,
            passwords: authority.passwords,
        }
    }
}

impl TryFrom<Plain> for Authority {
    type Error = Message;

    fn try_from(plain: Plain) -> Result<Self, Message> {
        if plain.level > OperationLevel::NONE.0 {
            return Err(say::level_out_of_range(plain.level));
        }
        for (level, password) in (0..).zip(&plain.passwords) {
            let digits = password.bytes().all(|byte| byte.is_ascii_digit());
            if !digits || password.len() != OperationLevel(level).password_digits() {
                return Err(say::password_digits(
                    level,
                    OperationLevel(level).password_digits(),
                ));
            }
        }
        Ok(Self {
            level: OperationLevel(plain.level),
            passwords: plain.passwords,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passwords_open_their_levels() {
        let mut authority = Authority::default();
        assert_eq!(authority.level(), OperationLevel::WORKSHOP);
        for (password, level) in [("1234", 4), ("12345", 3), ("123456", 2), ("12345678", 0)] {
            assert!(authority.enter(password));
            assert_eq!(authority.level().number(), level);
        }
        assert!(!authority.enter("123") && !authority.enter(""));
        assert_eq!(authority.level().number(), 0, "a wrong one changes nothing");
        authority.log_off();
        assert_eq!(authority.level(), OperationLevel::NONE);
    }

    #[test]
    fn a_new_password_is_as_long_as_the_old_one() {
        let mut authority = Authority::default();
        assert!(!authority.change_password("1234", "99999"));
        assert!(!authority.change_password("0000", "9999"));
        assert!(!authority.change_password("1234", "99x9"));
        assert!(authority.change_password("1234", "9999"));
        assert_eq!(
            authority.level(),
            OperationLevel::WORKSHOP,
            "the level stays"
        );
        assert!(!authority.enter("1234") && authority.enter("9999"));
    }

    #[test]
    fn high_levels_do_not_outlast_the_power() {
        for (before, after) in [(0, 3), (1, 3), (2, 3), (3, 3), (4, 4), (5, 5)] {
            let mut authority = Authority {
                level: OperationLevel(before),
                ..Authority::default()
            };
            authority.power_on();
            assert_eq!(authority.level().number(), after);
        }
    }

    #[test]
    fn stored_values_are_checked() {
        let authority = Authority::default();
        let text = ron::to_string(&authority).unwrap();
        assert_eq!(ron::from_str::<Authority>(&text).unwrap(), authority);
        assert!(ron::from_str::<Authority>(&text.replace("level:3", "level:6")).is_err());
        assert!(ron::from_str::<Authority>(&text.replace("\"1234\"", "\"12\"")).is_err());
    }
}
