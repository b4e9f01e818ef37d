//! Draws the password page 密码设置: the operation level, and the passwords that change it (manual
//! III-2.5.1).

use gsk_core::cnc::Cnc;
use gsk_messages::say;

use super::view::PageView;
use crate::face::PageId;
use crate::screen::Screen;

/// Draws the password page: the level, the typed digits as stars, and the response.
pub fn draw(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let level = cnc.authority().level().number();
    screen.put_message(3, 1, &say::lcd_level(level));
    let [old, new, again] = view.password.rows.each_ref().map(|it| "*".repeat(it.len()));
    let rows = [
        say::lcd_enter_password(old),
        say::lcd_new_password(new),
        say::lcd_confirm_password(again),
    ];
    for (row, text) in (0..).zip(rows) {
        screen.put_message(5 + 2 * row, 1, &text);
    }
    let cursor = view.cursors.get(PageId::Password).item.min(3);
    screen.put(3 + 2 * cursor, 0, "_");
    let end = screen.put_message(11, 0, &say::lcd_hint());
    if let Some(hint) = view.password.hint.text() {
        screen.put_message(11, end, &hint);
    }
}
