//! Number keys for a touch screen: they type into the field of the form that had the keyboard
//! last.

use egui::{Button, Context, Event, Id, Key, Modifiers, Response, RichText, Ui, vec2};
use gsk_messages::{Language, say};

use crate::theme;

/// Width and height of a key, points: wider than a fingertip.
const KEY_SIZE: egui::Vec2 = vec2(58.0, 46.0);
/// The keys, row by row.
const ROWS: [&str; 2] = ["12345.", "67890-"];
/// Height of the fields while the keys are shown, points.
pub const TOUCH_HEIGHT: f32 = 34.0;

/// The fields in which numbers are typed, in the order of the form.
#[derive(Clone, Default)]
struct KeyTargets {
    fields: Vec<Id>,
    /// The fields of the last frame.
    shown: Vec<Id>,
    last: Option<Id>,
    /// Whether the keys are shown in this frame.
    has_keys: bool,
    /// The field that gets the keyboard in the next frame: in the frame of a click it would
    /// lose it again, because the click is outside of it.
    wanted: Option<Id>,
    /// Whether the field gets the keyboard back from a number key, with its cursor.
    returns: bool,
    /// Whether the first number key replaces the value of the field.
    replaces: bool,
    /// What the field gets once it has the keyboard.
    pending: Vec<Event>,
}

fn change<T>(context: &Context, with: impl FnOnce(&mut KeyTargets) -> T) -> T {
    let id = Id::unique("form_number_keys");
    context.data_mut(|data| with(data.get_temp_mut_or_default::<KeyTargets>(id)))
}

/// Gives the keyboard to the field of the last number key, and what was typed. Called before
/// keys and fields are drawn.
pub fn begin_frame(ui: &Ui) {
    let (wanted, typed) = change(ui.ctx(), |targets| {
        targets.shown = std::mem::take(&mut targets.fields);
        targets.has_keys = false;
        let typed = std::mem::take(&mut targets.pending);
        (targets.wanted.take(), typed)
    });
    if let Some(field) = wanted {
        ui.memory_mut(|memory| memory.request_focus(field));
        ui.input_mut(|input| input.events.extend(typed));
    }
}

/// Whether the number keys type into this field, which may not have the keyboard meanwhile.
pub fn is_typed(ui: &Ui, field: Id) -> bool {
    change(ui.ctx(), |targets| {
        targets.has_keys && targets.last == Some(field)
    })
}

/// Registers a field in which numbers are typed. Returns whether it gets the keyboard back
/// from a number key.
pub fn register_field(ui: &Ui, field: &Response) -> bool {
    let (has_focus, gained_focus) = (field.has_focus(), field.gained_focus());
    change(ui.ctx(), |targets| {
        targets.fields.push(field.id);
        if has_focus {
            targets.replaces |= targets.last != Some(field.id);
            targets.last = Some(field.id);
        }
        gained_focus && std::mem::take(&mut targets.returns)
    })
}

/// Draws the keys.
pub fn show_keys(ui: &mut Ui, language: Language) {
    change(ui.ctx(), |targets| targets.has_keys = true);
    let names = [
        say::form_keypad_erase().text(language),
        say::form_keypad_next().text(language),
    ];
    ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
    for (row, special) in ROWS.iter().zip(&names) {
        ui.horizontal(|ui| {
            for key in row.chars() {
                let text = RichText::new(key).size(theme::KEY_TEXT_SIZE);
                if ui.add_sized(KEY_SIZE, Button::new(text)).clicked() {
                    type_event(ui.ctx(), Event::Text(key.to_string()));
                }
            }
            let size = vec2(KEY_SIZE.x * 1.8, KEY_SIZE.y);
            if ui.add_sized(size, Button::new(special)).clicked() {
                match special == &names[0] {
                    true => type_event(ui.ctx(), press(Key::Backspace, Modifiers::NONE)),
                    false => focus_next(ui.ctx()),
                }
            }
        });
    }
}

const fn press(key: Key, modifiers: Modifiers) -> Event {
    Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    }
}

/// Gives the keyboard back to the last field, or to the first one, and then the event.
fn type_event(context: &Context, event: Event) {
    change(context, |targets| {
        targets.returns = targets.last.is_some();
        if std::mem::take(&mut targets.replaces) || targets.last.is_none() {
            targets.pending.push(press(Key::A, Modifiers::COMMAND));
        }
        targets.pending.push(event);
        targets.last = targets.last.or_else(|| targets.shown.first().copied());
        targets.wanted = targets.last;
    });
    context.request_repaint();
}

/// Gives the keyboard to the field after the last one.
fn focus_next(context: &Context) {
    change(context, |targets| {
        targets.returns = false;
        let fields = &targets.shown;
        let at = (fields.iter()).position(|field| Some(*field) == targets.last);
        let next = at.map_or(0, |at| at + 1) % fields.len().max(1);
        targets.wanted = fields.get(next).copied();
    });
    context.request_repaint();
}
