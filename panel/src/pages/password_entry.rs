//! Stores the input of the password page and its response (manual III-2.5.1).

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// The response of the page to the last key.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Hint {
    /// None.
    #[default]
    None,
    /// No level has this password.
    Wrong,
    /// The two new passwords differ, or are not as long as the old one.
    Different,
    /// The level of the password is in force.
    LevelEntered,
    /// The level was left.
    LevelLeft,
    /// The password was replaced.
    Changed,
}

impl Hint {
    pub(super) fn text(self) -> Option<Message> {
        Some(match self {
            Self::None => return None,
            Self::Wrong => say::lcd_password_wrong(),
            Self::Different => say::lcd_passwords_differ(),
            Self::LevelEntered => say::lcd_level_changed(),
            Self::LevelLeft => say::lcd_level_given_up(),
            Self::Changed => say::lcd_password_changed(),
        })
    }
}

/// The input of the page.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PasswordEntry {
    /// 输入密码, 更改密码, 确认密码.
    pub rows: [String; 3],
    /// The response of the page.
    pub hint: Hint,
}

impl PasswordEntry {
    /// Clears all digits.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}
