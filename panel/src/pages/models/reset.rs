//! Draws the page that clears programs and restores delivered values (系统置零).

use gsk_messages::say;

use crate::pages::view::PageView;
use crate::screen::Screen;

/// Draws the actions of the number keys, and the result of the last one.
pub fn draw(screen: &mut Screen, view: &PageView) {
    screen.put_message(3, 2, &say::lcd_reset_programs(1));
    screen.put_message(5, 2, &say::lcd_reset_parameters(2));
    screen.put_message(7, 2, &say::lcd_reset_coordinates(3));
    if let Some(done) = view.disk_done {
        let text = match done {
            true => say::lcd_disk_done(),
            false => say::lcd_disk_failed(),
        };
        screen.put_message(12, 0, &text);
    }
}
