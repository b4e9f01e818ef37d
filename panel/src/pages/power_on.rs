//! Draws the self-test picture (manual III-3.1).

use gsk_core::model::ModelId;
use gsk_messages::{Language, say};

use crate::face::face_of;
use crate::screen::Screen;

/// Duration of the self-test picture, ticks (ms).
pub const POWER_ON_TICKS: u64 = 3000;

/// Draws the self-test picture with the name of the control model and of its maker.
pub fn draw(language: Language, model: ModelId) -> Screen {
    let face = face_of(model);
    let mut screen = Screen::in_language(language, face.lcd);
    screen.put(4, 13, model.plate_name());
    screen.put_message(6, 10, &say::lcd_lathe_cnc());
    if let Some(maker) = face.maker {
        screen.put_message(9, 8, &maker());
    }
    screen.put_message(12, 8, &say::lcd_self_test());
    screen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_sibling_names_the_maker_of_the_gsk980td() {
        let maker = |model| draw(Language::Zh, model).row(9).trim().to_owned();
        assert_eq!(maker(ModelId::Gsk980td), "广州数控设备有限公司");
        for model in [ModelId::Ncb08, ModelId::Hx31] {
            assert_eq!(maker(model), "", "{model:?}");
        }
    }
}
