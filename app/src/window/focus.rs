//! Where the focus of the keyboard goes with Tab.

use egui::{FocusDirection, Memory, Response, Ui};

/// Room around what has come into view, points.
const AROUND: f32 = 4.0;

/// Scrolls what the focus has just come to into view. To be called when the content of a
/// scrolled area has been drawn.
pub fn follow(ui: &Ui) {
    let focused = ui.memory(Memory::focused);
    let response = focused.and_then(|id| ui.read_response(id));
    let Some(response) = response.filter(Response::gained_focus) else {
        return;
    };
    // A text that is larger than its area follows its cursor by itself.
    let (place, room) = (response.rect, ui.clip_rect());
    let has_room = place.width() <= room.width() && place.height() <= room.height();
    if has_room && !room.contains_rect(place) && ui.min_rect().contains(place.center()) {
        ui.scroll_to_rect(place.expand(AROUND), None);
    }
}

/// Passes the focus over the edge of a panel, which is for the mouse: it would do nothing
/// there, and be seen nowhere. To be called before the panel is drawn.
pub fn pass_over_edge(ui: &Ui, panel: &str) {
    let edge = ui.scope_id().with(panel).with("__resize");
    if ui.memory(|memory| memory.has_focus(edge)) {
        let direction = match ui.input(|input| input.modifiers.shift) {
            true => FocusDirection::Previous,
            false => FocusDirection::Next,
        };
        ui.memory_mut(|memory| memory.move_focus(direction));
    }
}
