//! Where the focus of the keyboard goes with Tab.

mod list;

use egui::{Context, Event, EventFilter, FocusDirection, Id, Key, Memory, Response, Ui};

pub use list::{List, ROW, link, row, tick};

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

/// The keys of the cursor are this widget's own as long as it has the focus; to be called in
/// each picture in which it has. It takes those that nothing is held with out of the events.
pub fn keep_keys(ui: &Ui, id: Id) {
    hold(ui.ctx(), id, true);
    ui.data_mut(|data| data.insert_temp(place_of_keeper(), id));
    // The filter is in force from the next picture on: it comes before the next key.
    if !ui.memory(|memory| memory.had_focus_last_frame(id)) {
        ui.request_repaint();
    }
}

/// Takes keys that are pressed with nothing held out of the events: those that `take` says
/// it has made use of.
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

/// Whether the keys of the cursor belong to what has the focus, and not to the panel.
pub fn keeps_keys(context: &Context) -> bool {
    let focused = context.memory(Memory::focused);
    let keeper: Option<Id> = context.data(|data| data.get_temp(place_of_keeper()));
    focused.is_some() && focused == keeper
}

/// Leaves the keys of the cursor to the panel while a button has the focus: one key does one
/// thing (WINDOW-23). In a menu they go from entry to entry. To be called when everything is
/// drawn.
pub fn leave_keys(context: &Context) {
    if let Some(focused) = context.memory(Memory::focused)
        && !context.text_edit_focused()
        && !keeps_keys(context)
    {
        hold(context, focused, !egui::Popup::is_any_open(context));
    }
}

/// Says whether the keys of the cursor move the focus away.
fn hold(context: &Context, id: Id, held: bool) {
    let filter = EventFilter {
        horizontal_arrows: held,
        vertical_arrows: held,
        ..EventFilter::default()
    };
    context.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
}

fn place_of_keeper() -> Id {
    Id::unique("keeper")
}

/// Whether it is a key of the cursor.
pub const fn is_cursor(key: Key) -> bool {
    matches!(
        key,
        Key::ArrowUp | Key::ArrowDown | Key::ArrowLeft | Key::ArrowRight
    )
}

/// Whether an event presses a key of the cursor with something held, as axes are jogged.
pub fn jogs(event: &Event) -> bool {
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
