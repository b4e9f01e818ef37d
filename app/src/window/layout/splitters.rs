//! The bars between panes: dragged with mouse or finger, a double click puts one back.

use egui::{Color32, CursorIcon, Role, Sense, Ui, WidgetInfo};

use super::Layouts;
use super::panes::Splitter;
use gsk_messages::{Language, say};

/// A bar at rest, and one that is held.
const REST: Color32 = Color32::from_gray(44);
const HELD: Color32 = Color32::from_rgb(88, 140, 196);

/// Draws the bars and moves the one that is dragged.
pub fn drag(ui: &Ui, splitters: &[Splitter], layouts: &mut Layouts, language: Language) {
    for splitter in splitters {
        let id = ui.scope_id().with(("splitter", splitter.split));
        let response = ui.interact(splitter.bar, id, Sense::CLICK | Sense::DRAG);
        response.widget_info(|| {
            let name = say::window_splitter(splitter.split).text(language);
            WidgetInfo::labeled(Role::Splitter, true, name)
        });
        let held = response.hovered() || response.dragged();
        if held {
            ui.ctx().set_cursor_icon(match splitter.beside {
                true => CursorIcon::ResizeHorizontal,
                false => CursorIcon::ResizeVertical,
            });
        }
        let fill = if held { HELD } else { REST };
        ui.painter().rect_filled(splitter.bar, 0.0, fill);
        if response.double_clicked() {
            layouts.set_share(splitter.split, None);
        } else if response.dragged()
            && let Some(at) = response.interact_pointer_pos()
        {
            layouts.set_share(splitter.split, Some(splitter.share(at)));
        }
    }
}
