//! Stores the input of the password page and its response (manual III-2.5.1).

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// The response that the password page shows to the last entry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Hint {
    /// The password page shows no response.
    #[default]
    None,
    /// The entered password belongs to no operation level.
    Wrong,
    /// The two new passwords differ, or their length is not that of the old one.
    Different,
    /// The password was right, and its operation level is now in force.
    LevelEntered,
    /// The operator has lowered the operation level.
    LevelLeft,
    /// The password of the level was replaced by the new one.
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

/// The typed digits on the password page, with the response to the last entry.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PasswordEntry {
    /// The digits typed in 输入密码 (password), 更改密码 (new) and 确认密码 (new again).
    pub rows: [String; 3],
    /// The response that the page shows to the last entry.
    pub hint: Hint,
}

impl PasswordEntry {
    /// Clears all typed digits and the response.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}
