//! Draws the pages of the LCD from the state of the control and the panel.

mod alarms;
mod diagnosis;
mod format;
mod frame;
mod graphic;
mod graphic_settings;
mod lists;
mod mdi;
mod models;
mod offsets;
mod parameters;
mod password;
mod password_entry;
mod plc;
pub(crate) mod plc_names;
mod position;
mod power_on;
mod program;
mod program_text;
mod settings;
mod taught;
mod view;

use gsk_core::cnc::Cnc;
use gsk_messages::Language;

pub use format::CoordinateFormat;
pub use frame::mode_message;
pub use graphic_settings::GraphicSettings;
pub(crate) use models::{model_parameter_numbers, teaches};
pub(crate) use parameters::PITCH_POINTS;
pub(crate) use parameters::data_numbers;
pub(crate) use parameters::state_numbers;
pub use password_entry::{Hint, PasswordEntry};
pub(crate) use plc::bit_item;
pub(crate) use plc::bit_item_of;
pub(crate) use plc::bit_items;
pub(crate) use plc::value_item;
pub(crate) use plc::value_item_of;
pub(crate) use plc::value_items;
pub use plc_names::{short as signal_name, signal_meaning};
pub use power_on::{POWER_ON_TICKS, draw as power_on};
pub(crate) use program::directory_screens;
pub(crate) use program_text::turned_page;
pub use taught::{TaughtPoint, TaughtProgram};
pub use view::BRIGHTNESS_STEPS;
pub use view::{
    Communication, EditorState, FLASH_TICKS, PageCursor, PageCursors, PageView, Udisk, UdiskFile,
};

use crate::face::face_of;
pub use crate::face::{PAGES, PageId, PageKey, PageRow};
use crate::screen::Screen;

/// Returns the language that the LCD is set to (184.0 CH_EN).
pub fn language(cnc: &Cnc) -> Language {
    if cnc.parameters().is_english() {
        Language::En
    } else {
        Language::Zh
    }
}

/// Draws a page, in the language that the LCD is set to.
pub fn draw(page: PageId, view: &PageView, cnc: &Cnc) -> Screen {
    draw_in(language(cnc), page, view, cnc)
}

/// Draws a page in the given language.
pub fn draw_in(language: Language, page: PageId, view: &PageView, cnc: &Cnc) -> Screen {
    let face = face_of(cnc.model().id());
    let mut screen = Screen::in_language(language, face.lcd);
    let target = &mut screen;
    frame::draw(target, page, view, cnc);
    match page {
        PageId::PosRel => position::relative(target, view, cnc),
        PageId::PosAbs => position::absolute(target, view, cnc),
        PageId::PosAll => position::overall(target, cnc),
        PageId::PosPrg => position::with_program(target, cnc),
        PageId::Prg => program::text(target, view, cnc),
        PageId::Mdi => mdi::draw(target, view, cnc),
        PageId::Dir => program::directory(target, view, cnc),
        PageId::Oft => offsets::offsets(target, view, cnc),
        PageId::Macro => offsets::variables(target, view, cnc),
        PageId::Msg => alarms::messages(target, cnc),
        PageId::Alm => alarms::alarms(target, cnc),
        PageId::SetCode => settings::codes(target, view, cnc),
        PageId::SetSwitch => settings::switches(target, view, cnc),
        PageId::Edisk => settings::disk(target, view),
        PageId::Password => password::draw(target, view, cnc),
        PageId::GraphPar => graphic::parameters(target, view),
        PageId::Graph => graphic::picture(target, view, cnc),
        PageId::ParBit => parameters::states(target, view, cnc),
        PageId::ParData => parameters::data(target, view, cnc),
        PageId::Pitch => parameters::pitch(target, view, cnc),
        PageId::Dgn => diagnosis::draw(target, view, cnc),
        PageId::PlcBits => plc::signals(target, view, cnc),
        PageId::PlcValues => plc::values(target, view, cnc),
        PageId::Softpanel => plc::soft_panel(target, cnc),
        PageId::Version => plc::version(target, cnc),
        PageId::Teach => models::teaching(target, view, cnc),
        PageId::ParModel => models::parameters(target, view, cnc),
        PageId::Inputs => models::inputs(target, view, cnc),
        PageId::Outputs => models::outputs(target, view, cnc),
        PageId::Udisk => models::udisk(target, view),
        PageId::Coordinates => models::coordinates(target, view, cnc),
        PageId::Reset => models::reset(target, view),
    }
    screen
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::model::{ControlModel, ModelId};
    use gsk_core::setup::Setup;
    use gsk_messages::{Id, Language};

    use crate::glyphs::text_columns;

    /// Returns a text of the message table without its placeholders.
    fn words(text: &str) -> String {
        let parts = text.split('{');
        let rests = parts.map(|part| part.split_once('}').map_or(part, |(_, rest)| rest));
        rests.collect()
    }

    /// Titles are alone in their row. Other English texts take at most the cells of the Chinese
    /// ones, so that every page keeps its layout.
    #[test]
    fn english_is_no_wider_than_chinese() {
        let faces = ModelId::ALL.into_iter().map(face_of);
        let titles: Vec<Id> = faces
            .flat_map(|face| face.pages)
            .map(|row| row.page.title().id())
            .collect();
        let mut count = 0;
        for id in Id::all() {
            if !id.name().starts_with("lcd_") || titles.contains(id) {
                continue;
            }
            let [english, chinese] =
                [Language::En, Language::Zh].map(|language| words(&id.template(language)));
            assert!(english.is_ascii(), "{english}");
            assert!(english.len() <= text_columns(&chinese), "{english}");
            count += 1;
        }
        assert!(count > 100, "the texts of the LCD are elsewhere now");
    }

    #[test]
    fn no_page_shows_chinese_in_english() {
        for model in [ModelId::Gsk980td, ModelId::Ncb08, ModelId::Hx31] {
            let mut setup = Setup::default();
            setup.memory.model = ControlModel::new(model);
            setup.memory.parameters.set_bit(184, 0, true).unwrap();
            let cnc = Cnc::new(setup);
            for row in face_of(model).pages {
                let screen = draw(row.page, &PageView::default(), &cnc);
                for line in screen.text().lines() {
                    // The ladder's header is in the language of its author.
                    let own = row.page == PageId::Version
                        && ["LADDER", "NOTE"].iter().any(|label| line.contains(label));
                    assert!(line.is_ascii() || own, "{model:?} {}: {line}", row.name);
                }
            }
        }
        assert!(power_on(Language::En, ModelId::default()).text().is_ascii());
    }
}
