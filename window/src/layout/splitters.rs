//! Draws the splitters between panes and moves them: mouse or finger drag one, a double click
//! restores its default position. With the focus, the cursor keys move it and Enter restores
//! it (WINDOW-27).

use egui::{CursorIcon, Key, Role, Sense, Ui, WidgetInfo};

use crate::focus;
use crate::theme;

use super::Layouts;
use super::panes::Splitter;
use gsk_messages::{Language, say};

/// Share of both sides by which a cursor key moves a splitter.
const KEY_STEP: f32 = 0.02;

/// Draws the splitters and moves the one that the operator drags.
pub fn show(ui: &Ui, splitters: &[Splitter], layouts: &mut Layouts, language: Language) {
    for splitter in splitters {
        let id = ui.scope_id().with(("splitter", splitter.split));
        let response = ui.interact(splitter.bar, id, Sense::click_and_drag());
        response.widget_info(|| {
            let name = match splitter.is_side_by_side {
                true => say::window_splitter_beside(splitter.split),
                false => say::window_splitter_above(splitter.split),
            };
            let share = f64::from((splitter.current_share() * 100.0).round());
            WidgetInfo {
                value: Some(share),
                ..WidgetInfo::labeled(Role::Splitter, true, name.text(language))
            }
        });
        let is_pointed_at = response.hovered() || response.dragged();
        let is_active = is_pointed_at || response.has_focus();
        if is_pointed_at {
            ui.ctx().set_cursor_icon(match splitter.is_side_by_side {
                true => CursorIcon::ResizeHorizontal,
                false => CursorIcon::ResizeVertical,
            });
        }
        let fill = if is_active {
            theme::SPLITTER_ACTIVE
        } else {
            theme::SPLITTER
        };
        ui.painter().rect_filled(splitter.bar, 0.0, fill);
        if response.has_focus() {
            focus::reserve_cursor_keys(ui, id);
            move_by_keys(ui, splitter, layouts);
        }
        if response.double_clicked() {
            layouts.set_share(splitter.split, None);
        } else if response.dragged()
            && let Some(at) = response.interact_pointer_pos()
        {
            layouts.set_share(splitter.split, Some(splitter.share_at(at)));
        }
    }
}

/// Moves the splitter that has the focus with those cursor keys that hold no panel key.
fn move_by_keys(ui: &Ui, splitter: &Splitter, layouts: &mut Layouts) {
    let (back, forward) = match splitter.is_side_by_side {
        true => (Key::ArrowLeft, Key::ArrowRight),
        false => (Key::ArrowUp, Key::ArrowDown),
    };
    let (mut moved_share, mut restores_default) = (0.0, false);
    focus::take_keys(ui, |key| {
        match key {
            Key::Enter | Key::Space => restores_default = true,
            key if key == back => moved_share -= KEY_STEP,
            key if key == forward => moved_share += KEY_STEP,
            key => return focus::is_cursor(key),
        }
        true
    });
    if restores_default {
        layouts.set_share(splitter.split, None);
    } else if moved_share != 0.0 {
        layouts.set_share(splitter.split, Some(splitter.current_share() + moved_share));
    }
}
