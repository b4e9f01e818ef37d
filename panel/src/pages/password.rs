//! 密码设置: the operation level, and the passwords that change it
//! (manual III-2.5.1).

use gsk_core::cnc::Cnc;
use serde::{Deserialize, Serialize};

use super::table::PageId;
use super::view::View;
use crate::screen::Screen;

/// What the page says about the last key.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Hint {
    /// Nothing.
    #[default]
    None,
    /// No level has this password.
    Wrong,
    /// The two new passwords differ, or are not as long as the old one.
    Different,
    /// The level of the password is in force.
    LevelEntered,
    /// The level is given up.
    LevelLeft,
    /// The password was replaced.
    Changed,
}

impl Hint {
    const fn text(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Wrong => "密码错误",
            Self::Different => "两次输入的密码不一致",
            Self::LevelEntered => "操作级别已改变",
            Self::LevelLeft => "已取消密码用户更改数据的权限",
            Self::Changed => "密码已更改",
        }
    }
}

/// What is keyed in on the page.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PasswordEntry {
    /// 输入密码, 更改密码, 确认密码.
    pub rows: [String; 3],
    /// What the page answers.
    pub hint: Hint,
}

impl PasswordEntry {
    /// Forgets every digit.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

/// Draws the page.
pub fn draw(screen: &mut Screen, view: &View, cnc: &Cnc) {
    let level = cnc.authority().level().number();
    screen.put(3, 1, &format!("操作级别    : {level}"));
    let labels = ["输入密码    : ", "更改密码    : ", "确认密码    : "];
    for ((row, label), digits) in (0..).zip(labels).zip(&view.password.rows) {
        let stars = "*".repeat(digits.len());
        screen.put(5 + 2 * row, 1, &format!("{label}{stars}"));
    }
    let cursor = view.cursors.get(PageId::Password).item.min(3);
    screen.put(3 + 2 * cursor, 0, "_");
    let end = screen.put(11, 0, "提示:");
    screen.put(11, end, view.password.hint.text());
}
