//! Draws the map of PC keys over the panel.

use egui::{Context, RichText, Vec2};
use gsk_core::model::ModelId;
use gsk_panel::face::face_of;
use gsk_panel::keys::{KeyRole, KeyRow};

use crate::layout::LAYOUTS;
use crate::placement::panel_placement::PlacedArea;
use crate::placement::stop_key_clearance;
use crate::theme;
use crate::view::{VIEWS, key_name};
use gsk_messages::{Language, say};

/// Preferred size of the key map, points. The constants after it are its minimum size, and the
/// size that frame and title add.
const MAP_SIZE: Vec2 = Vec2::new(980.0, 620.0);
const MIN_SIZE: Vec2 = Vec2::new(240.0, 120.0);
const FRAME_SIZE: Vec2 = Vec2::new(20.0, 48.0);

/// Draws the window with the key map. Returns false when the operator closes it.
pub fn show(context: &Context, language: Language, model: ModelId, placed: &[PlacedArea]) -> bool {
    let mut open = true;
    // The map covers no key that stops the machine.
    let area = stop_key_clearance::best_rect(
        context.content_rect(),
        &stop_key_clearance::stop_key_rects(placed),
        |room| room.width().min(MAP_SIZE.x) * room.height().min(MAP_SIZE.y),
    );
    let size = (area.size() - FRAME_SIZE).min(MAP_SIZE).max(MIN_SIZE);
    let window = egui::Window::new(say::window_keys_title().text(language))
        .id(egui::Id::unique("key map"))
        .collapsible(false)
        .resizable(false)
        .fixed_size(size)
        .pivot(egui::Align2::CENTER_CENTER)
        .fixed_pos(area.center())
        .constrain_to(area)
        .open(&mut open);
    window.show(context, |ui| {
        for text in [
            say::window_keys_characters(),
            say::window_keys_latch(),
            say::window_keys_wheel(),
        ] {
            ui.label(RichText::new(text.text(language)).color(theme::WEAK_TEXT));
        }
        let views = VIEWS
            .iter()
            .filter(|row| row.view.is_available())
            .filter_map(|row| Some((row.key?, row.name)));
        let layouts = LAYOUTS.iter().filter_map(|row| Some((row.key?, row.name)));
        let views = views
            .chain(layouts)
            .map(|(key, name)| format!("{}  {}", key_name(key), name().text(language)));
        let views = views.collect::<Vec<_>>().join("     ");
        ui.label(RichText::new(views).color(theme::QUIET_TEXT));
        egui::ScrollArea::vertical()
            .auto_shrink([false, false])
            .show(ui, |ui| {
                let columns = ((ui.available_width() / 300.0).floor() as usize).clamp(1, 3);
                let rows: Vec<&KeyRow> = listed_keys(model).collect();
                let length = rows.len().div_ceil(columns);
                ui.columns(columns, |columns| {
                    for (ui, rows) in columns.iter_mut().zip(rows.chunks(length.max(1))) {
                        show_table(ui, rows, language);
                    }
                });
            });
    });
    open
}

/// The rows of a model's key map. Letters, digits and signs press the key with their legend; one
/// line describes them all, so they have no rows.
fn listed_keys(model: ModelId) -> impl Iterator<Item = &'static KeyRow> {
    face_of(model)
        .keys()
        .filter(|row| !matches!(row.role, KeyRole::Character(..)) && !row.pc.is_empty())
}

fn show_table(ui: &mut egui::Ui, rows: &[&KeyRow], language: Language) {
    let id = rows.first().map_or("", |row| row.id);
    egui::Grid::new(("keys", id))
        .num_columns(2)
        .striped(true)
        .spacing([12.0, 2.0])
        .show(ui, |ui| {
            ui.strong(say::window_pc_key().text(language));
            ui.strong(say::window_panel_key().text(language));
            ui.end_row();
            for row in rows {
                ui.label(RichText::new(pc_name(row.pc)).monospace());
                let name = match language {
                    Language::Zh => row.name_zh,
                    Language::En => row.name_en,
                };
                ui.label(name);
                ui.end_row();
            }
        });
}

/// The name of a PC key as keyboards print it; `name` is that of the key table.
pub fn pc_name(name: &str) -> String {
    name.replace("ArrowUp", "↑")
        .replace("ArrowDown", "↓")
        .replace("ArrowLeft", "←")
        .replace("ArrowRight", "→")
        .replace("Escape", "Esc")
}
