//! The warning bar in every window that the keys move a real machine, with the state of its
//! board.

use egui::{Frame, Margin, Panel, RichText, Ui};
use gsk_link::LinkState;

use gsk_messages::{Language, Message, say};

use crate::theme;

/// The warning that the keys move a real machine, in both languages.
fn warning_text() -> String {
    let texts = [Language::En, Language::Zh].map(|it| say::window_real_motion().text(it));
    texts.join(" / ")
}

pub fn state_name(state: LinkState) -> Message {
    match state {
        LinkState::Off => say::link_page_state_off(),
        LinkState::Opening => say::link_page_state_opening(),
        LinkState::Identify => say::link_page_state_identify(),
        LinkState::Configure => say::link_page_state_configure(),
        LinkState::Locked => say::link_page_state_locked(),
        LinkState::Ready => say::link_page_state_ready(),
        LinkState::Moving => say::link_page_state_moving(),
        LinkState::Homing => say::link_page_state_homing(),
        LinkState::Verify => say::link_page_state_verify(),
        LinkState::Tripped => say::link_page_state_tripped(),
        LinkState::Fault => say::link_page_state_fault(),
        LinkState::Lost => say::link_page_state_lost(),
    }
}

/// Height of the warning bar of a real machine, points.
const BAR_HEIGHT: f32 = 30.0;

/// Draws the warning bar at the top of a window, if a board moves the slides. `id_suffix`
/// makes its widget id unique.
pub fn show(ui: &mut Ui, id_suffix: &str, board: Option<LinkState>, language: Language) {
    let Some(state) = board else { return };
    let ground = match state {
        LinkState::Off | LinkState::Lost => theme::MACHINE_DISCONNECTED_GROUND,
        _ => theme::MACHINE_CONNECTED_GROUND,
    };
    let frame = Frame::new()
        .fill(ground)
        .inner_margin(Margin::symmetric(10, 0));
    let panel = Panel::top(format!("real motion {id_suffix}"))
        .exact_size(BAR_HEIGHT)
        .frame(frame)
        .show_separator_line(false);
    panel.show(ui, |ui| {
        ui.horizontal_centered(|ui| {
            let white = |text: &str| RichText::new(text).color(theme::MACHINE_BAR_TEXT).strong();
            ui.label(white(&warning_text()).size(theme::MACHINE_WARNING_SIZE));
            ui.add_space(14.0);
            let state_text = say::window_board_state(state_name(state)).text(language);
            ui.label(white(&state_text).size(theme::LARGE_SIZE));
        });
    });
}

/// Formats the title of a window, with the warning before it if a board moves the slides.
pub fn window_title(title: &str, board: Option<LinkState>) -> String {
    match board {
        Some(_) => format!("{} - {title}", warning_text()),
        None => title.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_is_called_as_in_the_log() {
        for at in [
            LinkState::Off,
            LinkState::Opening,
            LinkState::Identify,
            LinkState::Configure,
            LinkState::Locked,
            LinkState::Ready,
            LinkState::Moving,
            LinkState::Homing,
            LinkState::Verify,
            LinkState::Tripped,
            LinkState::Fault,
            LinkState::Lost,
        ] {
            assert_eq!(state_name(at).text(Language::En), at.name());
        }
    }
}
