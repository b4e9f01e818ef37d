//! Draws the area between the bars: the panel and the docked views in panes, together or as
//! tabs.

use egui::{Align, Button, Color32, Layout, Ui, UiBuilder};
use gsk_messages::say;

use super::layout::{self, InTurn, Pane};
use super::views::header;
use super::{Window, focus, placing};

/// Background of the tab bar.
const GROUND: Color32 = Color32::from_gray(40);
/// Least size of a tab, points.
const BUTTON: egui::Vec2 = egui::vec2(64.0, 34.0);

impl Window {
    /// Draws the panel and the docked views, each in its pane.
    pub(super) fn panes(&mut self, ui: &mut Ui) {
        let language = self.settings.language;
        let pixels_per_point = ui.pixels_per_point();
        let key = match self.settings.fingers {
            true => placing::FINGER,
            false => 0.0,
        };
        let layouts = &mut self.settings.layouts;
        layouts.begin(ui.max_rect(), pixels_per_point);
        let arranged = layouts.arrange(ui.max_rect(), pixels_per_point, key);
        let panel_is_shown = arranged.panes.iter().any(|(pane, _)| *pane == Pane::Panel);
        if let Some(turns) = &arranged.turns {
            let front = arranged.panes.first().map(|(pane, _)| *pane);
            self.turns(ui, turns, front);
            if !panel_is_shown {
                let mut bar = child(ui, "stops", turns.bar);
                self.stops(&mut bar);
            }
        }
        for (pane, place) in arranged.panes {
            let mut ui = child(ui, &format!("{pane:?}"), place);
            let Pane::View(view) = pane else {
                self.panel(&mut ui);
                continue;
            };
            let asked = self.views.show_docked(&mut ui, view, language);
            match asked {
                Some(header::Asked::Float) => self.settings.layouts.float(view),
                Some(header::Asked::Close) => self.settings.layouts.toggle(view),
                Some(header::Asked::Dock) | None => {}
            }
        }
        if let Some(view) = self.views.take_wanted() {
            self.show_view(view);
        }
        let layouts = &mut self.settings.layouts;
        layout::drag(ui, &arranged.splitters, layouts, language);
    }

    /// Draws the tab bar that switches between the panes.
    fn turns(&mut self, ui: &mut Ui, turns: &InTurn, front: Option<Pane>) {
        let language = self.settings.language;
        ui.painter().rect_filled(turns.bar, 0.0, GROUND);
        let bar = turns.bar.shrink2(egui::vec2(8.0, 0.0));
        let inside = UiBuilder::new()
            .id_salt("turns")
            .max_rect(bar)
            .layout(Layout::left_to_right(Align::Center));
        let stops = placing::stops(turns.bar, ui.pixels_per_point());
        let stops = stops.last().map_or(bar.right(), |stop| stop.whole().left());
        let layouts = &mut self.settings.layouts;
        ui.scope_builder(inside, |ui| {
            let scroll = egui::ScrollArea::horizontal()
                .max_width((stops - bar.left() - 8.0).max(0.0))
                .scroll_bar_visibility(egui::scroll_area::ScrollBarVisibility::AlwaysHidden);
            scroll.show(ui, |ui| {
                for pane in &turns.all {
                    let (name, view) = match pane {
                        Pane::Panel => (say::window_turn_panel(), None),
                        Pane::View(view) => ((view.row().name)(), Some(*view)),
                    };
                    let entry = Button::selectable(front == Some(*pane), name.text(language));
                    if ui.add(entry.min_size(BUTTON)).clicked() {
                        layouts.bring(view);
                    }
                }
                ui.separator();
                let entry = Button::new(say::window_turn_together().text(language));
                let hint = say::window_turn_together_hint().text(language);
                let entry = ui.add(entry.min_size(BUTTON)).on_hover_text(hint);
                if entry.clicked() {
                    layouts.keep_together(&turns.together);
                }
                focus::follow(ui);
            });
        });
    }
}

/// Creates a child region of the window for a pane.
fn child(ui: &mut Ui, name: &str, place: egui::Rect) -> Ui {
    let inside = UiBuilder::new().id_salt(name).max_rect(place);
    let mut ui = ui.new_child(inside);
    ui.set_clip_rect(ui.clip_rect().intersect(place));
    ui
}
