//! Draws the self-test picture (manual III-3.1).

use gsk_core::model::ModelId;
use gsk_messages::{Language, say};

use crate::face::face_of;
use crate::screen::Screen;

/// Duration of the self-test picture, ticks (ms).
pub const POWER_ON_TICKS: u64 = 3000;

/// Draws the self-test picture with the name of the control model.
pub fn draw(language: Language, model: ModelId) -> Screen {
    let mut screen = Screen::in_language(language, face_of(model).lcd);
    screen.put(4, 13, model.name());
    screen.put_message(6, 10, &say::lcd_lathe_cnc());
    screen.put_message(9, 8, &say::lcd_maker());
    screen.put_message(12, 8, &say::lcd_self_test());
    screen
}
