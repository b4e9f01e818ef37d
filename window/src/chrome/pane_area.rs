//! Draws the area between the bars: the panel and the docked views in panes, together or as
//! tabs.

use egui::{Align, Button, Layout, Ui, UiBuilder};
use gsk_messages::say;
use gsk_panel::why::CauseSubject;

use super::timeline;
use crate::focus;
use crate::layout::{self, PaneTabs, Scales, WindowPane};
use crate::placement::panel_placement;
use crate::view::ViewId;
use crate::views::header;
use crate::{Window, help, theme};

/// Minimum size of a tab, points.
const MIN_TAB_SIZE: egui::Vec2 = egui::vec2(64.0, 34.0);

impl Window {
    /// Draws the panel and the docked views, each in its pane.
    pub(crate) fn show_panes(&mut self, ui: &mut Ui) {
        let language = self.settings.language;
        let pixels_per_point = ui.pixels_per_point();
        let mut scales = Scales::new(pixels_per_point);
        if self.settings.fingers {
            scales.min_key_size = panel_placement::FINGER_KEY_SIZE;
        }
        let layouts = &mut self.settings.layouts;
        layouts.choose_first_layout(ui.max_rect(), pixels_per_point);
        let mut arrangement = layouts.arrange(ui.max_rect(), scales);
        if self.settings.timeline {
            let snapshot = self.snapshot.as_ref();
            match arrangement.take_strip(timeline::HEIGHT) {
                Some(strip) => {
                    let mut ui = child_ui(ui, "time line", strip);
                    self.timeline.show(&mut ui, snapshot, language);
                }
                None => {
                    self.timeline.show(ui, snapshot, language);
                    scales.min_legend_height = panel_placement::MIN_LEGEND_HEIGHT_ABOVE_TIME_LINE;
                    arrangement = layouts.arrange(ui.available_rect_before_wrap(), scales);
                }
            }
        }
        let layouts = &mut self.settings.layouts;
        layouts.set_tabbed(arrangement.tabs.is_some());
        let panel_is_shown = arrangement
            .panes
            .iter()
            .any(|(pane, _)| *pane == WindowPane::Panel);
        if let Some(tabs) = &arrangement.tabs {
            let front = arrangement.panes.first().map(|(pane, _)| *pane);
            self.show_tabs(ui, tabs, front);
            if !panel_is_shown {
                let mut bar = child_ui(ui, "stops", tabs.bar);
                self.show_stop_keys(&mut bar);
            }
        }
        let pointed_view = pointed_view(ui, &arrangement.panes);
        for (pane, bounds) in arrangement.panes {
            let mut ui = child_ui(ui, &format!("{pane:?}"), bounds);
            let WindowPane::View(view) = pane else {
                self.show_panel(&mut ui);
                continue;
            };
            let request = self.views.show_docked(&mut ui, view, language);
            match request {
                Some(header::HeaderAction::Float) => self.settings.layouts.float(view),
                Some(header::HeaderAction::Close) => self.settings.layouts.toggle(view),
                Some(header::HeaderAction::Dock) | None => {}
            }
        }
        self.pointed_topic = pointed_view
            .and_then(|view| help::take_pointed_topic(ui.ctx()).or_else(|| view.topic()));
        if let Some(bit) = self.views.ladder().take_bit_to_explain() {
            self.explain_subject(CauseSubject::Bit(bit));
        }
        if let Some(view) = self.views.take_view_to_open() {
            self.show_view(view);
        }
        let layouts = &mut self.settings.layouts;
        layout::show(ui, &arrangement.splitters, layouts, language);
    }

    /// Draws the tab bar that switches between the panes.
    fn show_tabs(&mut self, ui: &mut Ui, tabs: &PaneTabs, front: Option<WindowPane>) {
        let language = self.settings.language;
        ui.painter()
            .rect_filled(tabs.bar, 0.0, theme::HEADER_GROUND);
        let bar = tabs.bar.shrink2(egui::vec2(8.0, 0.0));
        let inside = UiBuilder::new()
            .id_salt("turns")
            .max_rect(bar)
            .layout(Layout::left_to_right(Align::Center));
        let stop_keys = panel_placement::place_stop_keys(tabs.bar, ui.pixels_per_point());
        let stops = stop_keys
            .last()
            .map_or(bar.right(), |stop| stop.bounds().left());
        let layouts = &mut self.settings.layouts;
        ui.scope_builder(inside, |ui| {
            let scroll = egui::ScrollArea::horizontal()
                .max_width((stops - bar.left() - 8.0).max(0.0))
                .scroll_bar_visibility(egui::scroll_area::ScrollBarVisibility::AlwaysHidden);
            scroll.show(ui, |ui| {
                for pane in &tabs.all {
                    let (name, view) = match pane {
                        WindowPane::Panel => (say::window_turn_panel(), None),
                        WindowPane::View(view) => ((view.row().name)(), Some(*view)),
                    };
                    let entry = Button::selectable(front == Some(*pane), name.text(language));
                    if ui.add(entry.min_size(MIN_TAB_SIZE)).clicked() {
                        layouts.bring_to_front(view);
                    }
                }
                ui.separator();
                let entry = Button::new(say::window_turn_together().text(language));
                let hint = say::window_turn_together_hint().text(language);
                let entry = ui.add(entry.min_size(MIN_TAB_SIZE)).on_hover_text(hint);
                if entry.clicked() {
                    layouts.keep_together(&tabs.all_together);
                }
                focus::scroll_to_focus(ui);
            });
        });
    }
}

/// Returns the docked view under the pointer; `None` if there is none or a window covers it.
fn pointed_view(ui: &Ui, panes: &[(WindowPane, egui::Rect)]) -> Option<ViewId> {
    let at = ui.input(|input| input.pointer.latest_pos())?;
    let layer = ui.ctx().layer_id_at(at);
    let is_covered = layer.is_some_and(|layer| layer != ui.layer_id());
    let (pane, _) = panes.iter().find(|(_, bounds)| bounds.contains(at))?;
    match pane {
        WindowPane::View(view) if !is_covered => Some(*view),
        _ => None,
    }
}

/// Creates a child region of the window for a pane.
fn child_ui(ui: &mut Ui, name: &str, bounds: egui::Rect) -> Ui {
    let inside = UiBuilder::new().id_salt(name).max_rect(bounds);
    let mut ui = ui.new_child(inside);
    ui.set_clip_rect(ui.clip_rect().intersect(bounds));
    ui
}
