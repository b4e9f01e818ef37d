//! Controls the keyboard focus: Tab, scrolling to the focus, and who gets the cursor keys.

mod list;

use egui::{Context, Event, EventFilter, FocusDirection, Id, Key, Memory, Response, Ui};

pub use list::{FocusList, ROW_SENSE, check_row, link_row, selectable_row};

/// Margin around a widget that is scrolled into view, points.
const SCROLL_MARGIN: f32 = 4.0;

/// Scrolls to the widget that has just gained the focus. The caller calls this function after
/// it has drawn the content of a scroll area.
pub fn scroll_to_focus(ui: &Ui) {
    let focused = ui.memory(Memory::focused);
    let response = focused.and_then(|id| ui.read_response(id));
    let Some(response) = response.filter(Response::gained_focus) else {
        return;
    };
    // A text that is larger than its area scrolls to its cursor itself.
    let (widget, visible) = (response.rect, ui.clip_rect());
    let fits = widget.width() <= visible.width() && widget.height() <= visible.height();
    if fits && !visible.contains_rect(widget) && ui.min_rect().contains(widget.center()) {
        ui.scroll_to_rect(widget.expand(SCROLL_MARGIN), None);
    }
}

/// Moves the focus past the resize edge of the panel named `panel`. The edge is for the mouse:
/// with the focus it would do nothing and be invisible. The caller calls this before it draws
/// the panel.
pub fn skip_resize_edge(ui: &Ui, panel: &str) {
    let edge = ui.scope_id().with(panel).with("__resize");
    if ui.memory(|memory| memory.has_focus(edge)) {
        let direction = match ui.input(|input| input.modifiers.shift) {
            true => FocusDirection::Previous,
            false => FocusDirection::Next,
        };
        ui.memory_mut(|memory| memory.move_focus(direction));
    }
}

/// Reserves the cursor keys for the widget `id` while it has the focus. The caller calls this
/// in each frame in which it has, and then removes the keys without modifiers from the events.
pub fn reserve_cursor_keys(ui: &Ui, id: Id) {
    lock_focus(ui.ctx(), id, true);
    ui.data_mut(|data| data.insert_temp(reserving_widget_id(), id));
    // The filter takes effect in the next frame: request one before the next key.
    if !ui.memory(|memory| memory.had_focus_last_frame(id)) {
        ui.request_repaint();
    }
}

/// Removes those pressed keys without modifiers from the events for which `take` returns true.
pub fn take_keys(ui: &Ui, mut take: impl FnMut(Key) -> bool) {
    ui.input_mut(|input| {
        input.events.retain(|event| match event {
            Event::Key {
                key,
                pressed: true,
                modifiers,
                ..
            } => modifiers.any() || !take(*key),
            _ => true,
        });
    });
}

/// Whether the focused widget has reserved the cursor keys from the panel.
pub fn are_cursor_keys_reserved(context: &Context) -> bool {
    let focused = context.memory(Memory::focused);
    let reserving_id: Option<Id> = context.data(|data| data.get_temp(reserving_widget_id()));
    focused.is_some() && focused == reserving_id
}

/// Leaves the cursor keys to the panel while a button has the focus, so that one key does one
/// thing (WINDOW-23). In an open menu they move between the entries. The caller calls this
/// after it has drawn everything.
pub fn release_cursor_keys(context: &Context) {
    if let Some(focused) = context.memory(Memory::focused)
        && !context.text_edit_focused()
        && !are_cursor_keys_reserved(context)
    {
        lock_focus(context, focused, !egui::Popup::is_any_open(context));
    }
}

/// Sets whether egui moves the focus with the cursor keys (`is_locked` false) or leaves them
/// to the widget (true).
fn lock_focus(context: &Context, id: Id, is_locked: bool) {
    let filter = EventFilter {
        horizontal_arrows: is_locked,
        vertical_arrows: is_locked,
        ..EventFilter::default()
    };
    context.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
}

fn reserving_widget_id() -> Id {
    Id::unique("keeper")
}

pub const fn is_cursor(key: Key) -> bool {
    matches!(
        key,
        Key::ArrowUp | Key::ArrowDown | Key::ArrowLeft | Key::ArrowRight
    )
}

/// Whether an event presses a cursor key with a modifier, which jogs an axis.
pub fn is_axis_key(event: &Event) -> bool {
    match event {
        Event::Key {
            key,
            pressed: true,
            modifiers,
            ..
        } => is_cursor(*key) && modifiers.any(),
        _ => false,
    }
}
