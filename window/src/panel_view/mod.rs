//! Draws the panel in the window (parts, LCD, accessible names) and handles the pointer on it.

pub mod faceplate_image;
pub mod lcd;
pub mod tips;

use egui::{
    Color32, Event, Painter, Pos2, Rect, RectAlign, Response, Role, Sense, Stroke, StrokeKind,
    Tooltip, TouchPhase, Ui, WidgetInfo, pos2, vec2,
};
use gsk_core::model::ModelId;
use gsk_help::{Subject, Topic, topic, topic_at, topic_of};
use gsk_panel::face::face_of;
use gsk_panel::faceplate::{self, FaceState, Outline, PanelColour, PanelPart, PartKind};
use gsk_panel::keys::{Bit, Key, STRIP};
use gsk_panel::screen::{COLUMNS, ROWS};

use super::{Command, StatusMessage, Window, theme};
use crate::input::panel_pointer::PlacedPanel;
use crate::placement::panel_placement::{self, PlacedArea};
use crate::screen_reader;
use gsk_messages::{Language, say};

/// A request of the user through the widget of a part of the panel.
enum PartRequest {
    /// A screen reader has pressed the key: press and release it.
    Tap(Key),
    /// Explain why the lamp at this Y bit is lit or dark.
    Explain(Bit),
}

/// Draws a coloured ring around a key of the panel.
fn draw_ring(painter: &Painter, placed: PlacedArea, part: &PanelPart, colour: Color32) {
    let rect = placed.part_rect(part);
    let width = (4.0 * placed.scale).max(2.0);
    let stroke = Stroke::new(width, colour);
    match part.outline {
        Outline::Round => {
            painter.circle_stroke(rect.center(), rect.width() / 2.0 + width, stroke);
        }
        Outline::Rounded(radius) => {
            let radius = radius * placed.scale;
            painter.rect_stroke(rect, radius, stroke, StrokeKind::Outside);
        }
    }
}

/// The position at which a mouse button or a finger goes down in an event; `None` for other
/// events.
fn pressed_at(event: &Event) -> Option<Pos2> {
    match event {
        Event::PointerButton {
            pos, pressed: true, ..
        }
        | Event::Touch {
            pos,
            phase: TouchPhase::Start,
            ..
        } => Some(*pos),
        _ => None,
    }
}

/// Whether a key only ever stops the machine. Such a key also works while help explains
/// pressed keys.
const fn is_stop_key(key: Key) -> bool {
    matches!(key, Key::EmergencyStop | Key::Reset | Key::FeedHold)
}

impl Window {
    /// Draws the panel and handles mouse and fingers on it.
    pub(super) fn show_panel(&mut self, ui: &mut Ui) {
        let placed = panel_placement::place_panel(ui.max_rect(), ui.pixels_per_point());
        // The housing continues between the sections to the edges of the pane.
        let [red, green, blue] = PanelColour::Housing.rgb();
        let housing = Color32::from_rgb(red, green, blue);
        theme::fill_unthemed(ui.painter(), ui.max_rect(), housing);
        self.show_areas(ui, &placed);
    }

    /// Draws the keys that stop the machine while the panel is not visible.
    pub(super) fn show_stop_keys(&mut self, ui: &mut Ui) {
        let placed = panel_placement::place_stop_keys(ui.max_rect(), ui.pixels_per_point());
        self.lcd.hide();
        self.show_areas(ui, &placed);
    }

    /// Returns the control model whose panel is shown.
    pub(super) fn panel_model(&self) -> ModelId {
        self.snapshot
            .as_ref()
            .map(|it| it.model)
            .unwrap_or_default()
    }

    /// Draws the placed areas of the panel, with the LCD if it is among them.
    fn show_areas(&mut self, ui: &mut Ui, placed: &[PlacedArea]) {
        self.handle_pointer(ui, placed);
        let painter = ui.painter().clone();
        let snapshot = self.snapshot.take();
        self.reversed_keys = snapshot
            .as_ref()
            .map(|it| it.keys_reversed)
            .unwrap_or_default();
        let mut pressed: Vec<Key> = self.held_keys.keys().collect();
        if let Some(picture) = &snapshot {
            pressed.extend(&picture.pressed);
        }
        let state = FaceState {
            y: snapshot
                .as_ref()
                .map_or(&[], |picture| &picture.y_memory[..]),
            pressed: &pressed,
            lcd: None,
            wheel: snapshot.as_ref().map_or(0, |picture| picture.wheel),
            real: snapshot.as_ref().is_some_and(|it| it.board.is_some()),
            model: snapshot.as_ref().map(|it| it.model).unwrap_or_default(),
        };
        let model = state.model;
        self.faceplate.paint(&painter, placed, &state);
        let mut requests = Vec::new();
        for view in placed {
            for part in view.area.parts(state.model) {
                requests.extend(self.add_part_widget(ui, &part, *view, &state));
            }
        }
        for request in requests {
            match request {
                PartRequest::Tap(key) => {
                    self.held_keys.drop_waiting_latch();
                    self.console.send(Command::Tap(key));
                }
                PartRequest::Explain(lamp) => self.explain_bit(lamp),
            }
        }
        let lcd = panel_placement::lcd_rect(placed).zip(panel_placement::glass_rect(placed));
        if let (Some(picture), Some(lcd)) = (&snapshot, lcd) {
            let (bounds, _) = lcd;
            self.lcd
                .paint(&painter, lcd, &picture.screen, picture.brightness);
            let lcd = ui.interact(bounds, ui.scope_id().with("lcd"), Sense::HOVER);
            self.request_translation(lcd.hovered());
            lcd.widget_info(|| WidgetInfo {
                current_text_value: Some(picture.screen.text()),
                ..WidgetInfo::labeled(
                    Role::Terminal,
                    true,
                    say::window_lcd().text(self.settings.language),
                )
            });
            screen_reader::add_lcd_rows(ui, &lcd, bounds, &picture.screen);
            let tip = self
                .lcd_cell(self.pointer_position)
                .map(|(row, column)| tips::lcd_tip(picture, row, column, self.settings.language));
            if let Some(tip) = tip.filter(|tip| !tip.is_empty()) {
                let mut tooltip = Tooltip::for_enabled(&lcd);
                let row = self.lcd_row_rect(bounds);
                tooltip.popup = tooltip.popup.anchor(row);
                tooltip.show(|ui| {
                    // A tip as narrow as that of the cell before would break its words.
                    for line in tip {
                        ui.add(egui::Label::new(line).extend());
                    }
                });
            }
        }
        let mut marked = Vec::from_iter(self.views.lessons().next_key());
        if let Some(picture) = &snapshot {
            self.way_back = self.way_back.and_then(|way| way.follow(picture));
            marked.extend(self.way_back.iter().flat_map(|way| way.keys(picture)));
        }
        marked.extend(self.why.marked_key);
        for key in marked {
            if let Some(part) = faceplate::part_of(model, key)
                && let Some(view) = panel_placement::area_of_part(placed, part)
            {
                draw_ring(&painter, *view, part, theme::LESSON_RING);
            }
        }
        let latched = self.held_keys.latched_key();
        if let Some(part) = latched.and_then(|key| faceplate::part_of(model, key))
            && let Some(view) = panel_placement::area_of_part(placed, part)
        {
            draw_ring(&painter, *view, part, theme::LATCH_RING);
        }
        self.snapshot = snapshot;
    }

    /// Adds the accessible name and the tool tip of a part. Returns a tap of its key by a screen
    /// reader, or the question why its lamp is lit or not.
    fn add_part_widget(
        &self,
        ui: &Ui,
        part: &PanelPart,
        placed: PlacedArea,
        state: &FaceState<'_>,
    ) -> Option<PartRequest> {
        let language = self.settings.language;
        let rect = placed.to_window(part.rect);
        match part.what {
            PartKind::Key(key) => {
                let row = face_of(state.model).key(key)?;
                // The sense has no FOCUSABLE: Tab and Space must never press a machine key.
                let response = ui.interact(
                    rect,
                    ui.scope_id().with(key.id()),
                    Sense::CLICK | Sense::DRAG,
                );
                let name = match language {
                    Language::Zh => row.name_zh,
                    Language::En => row.name_en,
                };
                let lit = row.lamp.map(|lamp| lamp.is_set_in(state.y));
                let selected = if key == Key::EmergencyStop {
                    Some(state.pressed.contains(&key))
                } else {
                    lit
                };
                let is_latched = self.held_keys.latched_key() == Some(key);
                response.widget_info(|| WidgetInfo {
                    selected,
                    current_text_value: is_latched
                        .then(|| say::window_key_is_kept().text(language)),
                    ..WidgetInfo::labeled(Role::Button, true, name)
                });
                if is_latched {
                    screen_reader::add_state(
                        ui,
                        &response,
                        &say::window_key_is_kept().text(language),
                    );
                }
                let by_screen_reader =
                    response.clicked() && response.interact_pointer_pos().is_none();
                let reversed = self.reversed_keys;
                self.show_part_tip(&response, part.what, |ui| {
                    tips::show_key_tip(ui, language, row, reversed);
                });
                by_screen_reader.then_some(PartRequest::Tap(key))
            }
            PartKind::Strip(index) => {
                let lamp = STRIP.get(index).filter(|lamp| lamp.fitted)?;
                let response = ui.interact(rect, ui.scope_id().with(lamp.id), Sense::CLICK);
                let name = match language {
                    Language::Zh => lamp.name_zh,
                    Language::En => lamp.name_en,
                };
                let name = say::window_lamp(name).text(language);
                let lit = lamp.lamp.is_set_in(state.y);
                let state_text = match lit {
                    true => say::window_lamp_on(),
                    false => say::window_lamp_off(),
                };
                response.widget_info(|| WidgetInfo {
                    current_text_value: Some(state_text.text(language)),
                    ..WidgetInfo::labeled(Role::Status, true, &name)
                });
                screen_reader::add_state(ui, &response, &state_text.text(language));
                self.show_part_tip(&response, part.what, |ui| {
                    tips::show_lamp_tip(ui, language, lamp, lit);
                });
                (response.clicked()).then_some(PartRequest::Explain(lamp.lamp))
            }
            PartKind::Handwheel => {
                let response = ui.interact(rect, ui.scope_id().with("handwheel"), Sense::DRAG);
                response.widget_info(|| WidgetInfo {
                    value: Some(f64::from(state.wheel)),
                    ..WidgetInfo::labeled(
                        Role::Slider,
                        true,
                        say::window_handwheel().text(language),
                    )
                });
                self.show_part_tip(&response, part.what, |ui| {
                    ui.label(say::window_handwheel_hint().text(language));
                });
                None
            }
            _ => None,
        }
    }

    /// Shows the tip of a part while the pointer rests on it, unless the operator has pressed or
    /// turned the part since the pointer arrived. The tip extends to the left: the pane at the
    /// right of the panel has the text of a lesson.
    fn show_part_tip(&self, response: &Response, part: PartKind, content: impl FnOnce(&mut Ui)) {
        if self.used_part == Some(part) {
            return;
        }
        let mut tip = Tooltip::for_enabled(response);
        let middle = response.ctx.content_rect().center().x;
        if response.rect.center().x > middle / 2.0 {
            tip.popup = tip.popup.align(RectAlign::BOTTOM_END);
        }
        tip.show(content);
    }

    /// Stores the part that a press or the wheel uses, until the pointer leaves the part.
    fn follow_used_part(&mut self, events: &[Event], placed: PlacedPanel<'_>) {
        let part = self
            .pointer_position
            .and_then(|at| panel_placement::part_at(placed.areas, placed.model, at))
            .map(|part| part.what);
        let is_used = events
            .iter()
            .any(|event| matches!(event, Event::MouseWheel { .. }) || pressed_at(event).is_some());
        self.used_part = part.filter(|_| is_used || self.used_part == part);
    }

    /// Returns the help topic about the key, lamp or LCD cell at a position in the window; `None`
    /// if there is none.
    pub(super) fn topic_at_position(&self, position: Pos2) -> Option<&'static Topic> {
        if let Some((row, column)) = self.lcd_cell(Some(position)) {
            let snapshot = self.snapshot.as_ref()?;
            let (model, page) = (snapshot.model, snapshot.page);
            return topic_at(model, page, &snapshot.screen, row, column);
        }
        match panel_placement::part_at(&self.placed_areas, self.panel_model(), position)?.what {
            PartKind::Key(key) => topic_of(self.panel_model(), Subject::Key(key.id())),
            PartKind::Strip(index) => topic(Subject::Lamp(STRIP.get(index)?.id)),
            _ => None,
        }
    }

    /// Row and column of the LCD, from 0, at a position in the window; `None` outside the LCD.
    fn lcd_cell(&self, position: Option<Pos2>) -> Option<(usize, usize)> {
        let lcd = panel_placement::lcd_rect(&self.placed_areas)?;
        let from_corner = position.filter(|at| lcd.contains(*at))? - lcd.min;
        let cell = |from: f32, size: f32, count: usize| {
            let cell = (from / size * count as f32) as usize;
            cell.min(count - 1)
        };
        let row = cell(from_corner.y, lcd.height(), ROWS);
        let column = cell(from_corner.x, lcd.width(), COLUMNS);
        Some((row, column))
    }

    /// The row of the LCD under the pointer, from the pointer to the right. A tip below it does
    /// not cover the value that it explains.
    fn lcd_row_rect(&self, lcd: Rect) -> Rect {
        let pointer = self.pointer_position.unwrap_or_else(|| lcd.center());
        let height = lcd.height() / ROWS as f32;
        let row = ((pointer.y - lcd.top()) / height).floor();
        let corner = pos2(pointer.x, lcd.top() + row * height);
        Rect::from_min_size(corner, vec2(1.0, height))
    }

    /// Sets whether the kernel sends the LCD in the other language, too, for the pointer on
    /// it.
    fn request_translation(&mut self, is_requested: bool) {
        if self.is_translation_requested != is_requested {
            self.is_translation_requested = is_requested;
            self.console.send(Command::Translate(is_requested));
        }
    }

    /// Opens help for a long press on a key or lamp. For one on the LCD shows its tip on the
    /// message line.
    fn handle_long_press(&mut self, ui: &Ui, events: &[Event], is_panel: &dyn Fn(Pos2) -> bool) {
        let now = ui.input(|input| input.time);
        let long_pressed = self.long_press.handle_events(events, now);
        if self.long_press.is_waiting() {
            let soon = std::time::Duration::from_millis(100);
            ui.ctx().request_repaint_after(soon);
        }
        let Some(at) = long_pressed.filter(|at| is_panel(*at)) else {
            return;
        };
        let model = self.panel_model();
        let part = panel_placement::part_at(&self.placed_areas, model, at);
        let key = part.and_then(PanelPart::key);
        if let (Some((row, column)), Some(picture)) = (self.lcd_cell(Some(at)), &self.snapshot) {
            let lines = tips::lcd_tip(picture, row, column, self.settings.language);
            self.message = Some(StatusMessage::Text(say::as_written(lines.join("   "))));
        }
        if key.is_none_or(tips::has_long_press_help)
            && let Some(about) = self.topic_at_position(at)
        {
            self.help.toggle(Some(about));
        }
    }

    fn handle_pointer(&mut self, ui: &Ui, placed: &[PlacedArea]) {
        let model = self.panel_model();
        let panel = PlacedPanel {
            areas: placed,
            model,
        };
        let own_layer = ui.layer_id();
        let context = ui.ctx().clone();
        let bounds = ui.max_rect();
        let is_panel = |at: Pos2| {
            bounds.contains(at)
                && context
                    .layer_id_at(at)
                    .is_none_or(|layer| layer == own_layer)
        };
        let mut events = ui.input(|input| input.events.clone());
        let pointer = ui.input(|input| input.pointer.latest_pos());
        self.pointer_position = pointer.filter(|at| is_panel(*at));
        self.placed_areas = placed.to_vec();
        self.follow_used_part(&events, panel);
        self.handle_long_press(ui, &events, &is_panel);
        if self.help.is_explaining() {
            events.retain(|event| {
                let Some(at) = pressed_at(event).filter(|at| is_panel(*at)) else {
                    return true;
                };
                if let Some(about) = self.topic_at_position(at) {
                    self.help.show_pressed(about);
                }
                panel_placement::part_at(placed, model, at)
                    .and_then(PanelPart::key)
                    .is_some_and(is_stop_key)
            });
        }
        let result = self
            .pointing
            .handle_events(&events, panel, &mut self.held_keys, &is_panel);
        self.send(&result.changes);
        if let Some(key) = result.not_latched {
            self.message = Some(StatusMessage::KeyNotLatched(key));
        }
        if result.detents != 0 {
            self.console.send(Command::Turn(result.detents));
        }
    }
}
