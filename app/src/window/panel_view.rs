//! Draws the panel in the window (parts, LCD, accessible names) and handles the pointer on it.

use egui::{
    Color32, Event, Painter, Pos2, Role, Sense, Stroke, StrokeKind, TouchPhase, Ui, WidgetInfo,
};
use gsk_help::{Subject, Topic, topic, topic_at};
use gsk_panel::faceplate::{self, FaceState, Outline, PanelPart, PartKind};
use gsk_panel::keys::{Key, STRIP};
use gsk_panel::screen::{COLUMNS, ROWS};

use super::placing::{self, View};
use super::{Command, Message, Window, reader, tips};
use gsk_messages::{Language, say};

/// The ring around a latched key.
const RING: Color32 = Color32::from_rgb(255, 150, 0);

/// The ring around a key that a lesson asks the operator to press.
const ASKED: Color32 = Color32::from_rgb(60, 220, 255);

/// Draws a ring around a key.
fn ring(painter: &Painter, view: View, part: &PanelPart, colour: Color32) {
    let rect = view.rect(part.rect);
    let width = (4.0 * view.scale).max(2.0);
    let stroke = Stroke::new(width, colour);
    match part.outline {
        Outline::Round => {
            painter.circle_stroke(rect.center(), rect.width() / 2.0 + width, stroke);
        }
        Outline::Rounded(radius) => {
            let radius = radius * view.scale;
            painter.rect_stroke(rect, radius, stroke, StrokeKind::Outside);
        }
    }
}

/// The position at which a mouse button or a finger goes down.
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

/// Whether a key only ever stops the machine. It also works while help explains pressed keys.
const fn stops(key: Key) -> bool {
    matches!(key, Key::EmergencyStop | Key::Reset | Key::FeedHold)
}

impl Window {
    /// Draws the panel and handles mouse and fingers on it.
    pub(super) fn panel(&mut self, ui: &mut Ui) {
        let views = placing::views(ui.max_rect(), ui.pixels_per_point());
        self.areas(ui, &views);
    }

    /// Draws the keys that stop the machine while the panel is not visible.
    pub(super) fn stops(&mut self, ui: &mut Ui) {
        let views = placing::stops(ui.max_rect(), ui.pixels_per_point());
        self.lcd.hide();
        self.areas(ui, &views);
    }

    /// Draws the placed areas of the panel, with the LCD if it is among them.
    fn areas(&mut self, ui: &mut Ui, views: &[View]) {
        self.point(ui, views);
        let painter = ui.painter().clone();
        let picture = self.picture.take();
        self.reversed = picture
            .as_ref()
            .map(|it| it.keys_reversed)
            .unwrap_or_default();
        let mut pressed: Vec<Key> = self.held.keys().collect();
        if let Some(picture) = &picture {
            pressed.extend(&picture.pressed);
        }
        let state = FaceState {
            y: picture.as_ref().map_or(&[], |picture| &picture.y[..]),
            pressed: &pressed,
            lcd: None,
            wheel: picture.as_ref().map_or(0, |picture| picture.wheel),
            real: picture.as_ref().is_some_and(|it| it.board.is_some()),
            model: picture.as_ref().map(|it| it.model).unwrap_or_default(),
        };
        self.face.paint(&painter, views, &state);
        let mut taps = Vec::new();
        for view in views {
            for part in view.area.parts() {
                taps.extend(self.describe(ui, &part, *view, &state));
            }
        }
        for key in taps {
            self.held.forget_kept();
            self.console.send(Command::Tap(key));
        }
        let lcd = faceplate::lcd();
        let screen = views.iter().find(|view| view.area.rect.encloses(&lcd));
        let screen = screen.map(|view| view.rect(lcd));
        if let (Some(picture), Some(place)) = (&picture, screen) {
            self.lcd
                .paint(&painter, place, &picture.screen, picture.brightness);
            let lcd = ui.interact(place, ui.scope_id().with("lcd"), Sense::HOVER);
            self.translate(lcd.hovered());
            lcd.widget_info(|| WidgetInfo {
                current_text_value: Some(picture.screen.text()),
                ..WidgetInfo::labeled(
                    Role::Terminal,
                    true,
                    say::window_lcd().text(self.settings.language),
                )
            });
            reader::rows(ui, &lcd, place, &picture.screen);
            let tip = self
                .cell(self.pointer)
                .map(|(row, column)| tips::lcd(picture, row, column, self.settings.language));
            if let Some(tip) = tip.filter(|tip| !tip.is_empty()) {
                lcd.on_hover_ui_at_pointer(|ui| {
                    for line in tip {
                        ui.label(line);
                    }
                });
            }
        }
        for key in self.views.lessons().marked() {
            if let Some(part) = faceplate::part_of(key)
                && let Some(view) = placing::of_part(views, part)
            {
                ring(&painter, *view, part, ASKED);
            }
        }
        if let Some(part) = self.held.kept().and_then(faceplate::part_of)
            && let Some(view) = placing::of_part(views, part)
        {
            ring(&painter, *view, part, RING);
        }
        self.picture = picture;
    }

    /// Gives a part its accessible name and tool tip. Returns the key if a screen reader has
    /// pressed it.
    fn describe(
        &self,
        ui: &Ui,
        part: &PanelPart,
        view: View,
        state: &FaceState<'_>,
    ) -> Option<Key> {
        let language = self.settings.language;
        let rect = view.rect(part.rect);
        match part.what {
            PartKind::Key(key) => {
                let row = key.row();
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
                let kept = self.held.kept() == Some(key);
                response.widget_info(|| WidgetInfo {
                    selected,
                    current_text_value: kept.then(|| say::window_key_is_kept().text(language)),
                    ..WidgetInfo::labeled(Role::Button, true, name)
                });
                if kept {
                    reader::state(ui, &response, &say::window_key_is_kept().text(language));
                }
                let by_screen_reader =
                    response.clicked() && response.interact_pointer_pos().is_none();
                let reversed = self.reversed;
                response.on_hover_ui(|ui| tips::key(ui, language, row, reversed));
                by_screen_reader.then_some(key)
            }
            PartKind::Strip(index) => {
                let lamp = STRIP.get(index).filter(|lamp| lamp.fitted)?;
                let response = ui.interact(rect, ui.scope_id().with(lamp.id), Sense::HOVER);
                let name = match language {
                    Language::Zh => lamp.name_zh,
                    Language::En => lamp.name_en,
                };
                let name = say::window_lamp(name).text(language);
                let lit = lamp.lamp.is_set_in(state.y);
                let word = match lit {
                    true => say::window_lamp_on(),
                    false => say::window_lamp_off(),
                };
                response.widget_info(|| WidgetInfo {
                    current_text_value: Some(word.text(language)),
                    ..WidgetInfo::labeled(Role::Status, true, &name)
                });
                reader::state(ui, &response, &word.text(language));
                response.on_hover_ui(|ui| tips::lamp(ui, language, lamp, lit));
                None
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
                response.on_hover_text(say::window_handwheel_hint().text(language));
                None
            }
            _ => None,
        }
    }

    /// The help topic about a position in the window: a key, a lamp, a cell of the LCD.
    pub(super) fn pointed_at(&self, at: Pos2) -> Option<&'static Topic> {
        if let Some((row, column)) = self.cell(Some(at)) {
            let picture = self.picture.as_ref()?;
            let (model, page) = (picture.model, picture.page);
            return topic_at(model, page, &picture.screen, row, column);
        }
        let (x, y) = placing::units(&self.placed, at)?;
        match faceplate::part_at(x, y)?.what {
            PartKind::Key(key) => topic(Subject::Key(key.id())),
            PartKind::Strip(index) => topic(Subject::Lamp(STRIP.get(index)?.id)),
            _ => None,
        }
    }

    /// Row and column of the LCD at a position in the window.
    fn cell(&self, at: Option<Pos2>) -> Option<(usize, usize)> {
        let (x, y) = placing::units(&self.placed, at?)?;
        let lcd = faceplate::lcd();
        let cell = |from: f32, size: f32, count: usize| (from / size * count as f32) as usize;
        let row = cell(y - lcd.y, lcd.h, ROWS);
        let column = cell(x - lcd.x, lcd.w, COLUMNS);
        lcd.contains(x, y).then_some((row, column))
    }

    /// Requests the LCD in the other language, too, while the pointer is on it.
    fn translate(&mut self, wanted: bool) {
        if self.translates != wanted {
            self.translates = wanted;
            self.console.send(Command::Translate(wanted));
        }
    }

    /// Opens help for a long press on the panel, or shows the tip of the LCD on the message
    /// line.
    fn press_long(&mut self, ui: &Ui, events: &[Event], free: &dyn Fn(Pos2) -> bool) {
        let now = ui.input(|input| input.time);
        let stayed = self.long_press.follow(events, now);
        if self.long_press.watches() {
            let soon = std::time::Duration::from_millis(100);
            ui.ctx().request_repaint_after(soon);
        }
        let Some(at) = stayed.filter(|at| free(*at)) else {
            return;
        };
        let key = placing::units(&self.placed, at);
        let key = key.and_then(|(x, y)| faceplate::part_at(x, y)?.key());
        if let (Some((row, column)), Some(picture)) = (self.cell(Some(at)), &self.picture) {
            let lines = tips::lcd(picture, row, column, self.settings.language);
            self.message = Some(Message::Said(say::as_written(lines.join("   "))));
        }
        if key.is_none_or(tips::explains_when_held)
            && let Some(about) = self.pointed_at(at)
        {
            self.help.ask(Some(about));
        }
    }

    fn point(&mut self, ui: &Ui, views: &[View]) {
        let own = ui.layer_id();
        let context = ui.ctx().clone();
        let room = ui.max_rect();
        let free = |at: Pos2| {
            room.contains(at) && context.layer_id_at(at).is_none_or(|layer| layer == own)
        };
        let mut events = ui.input(|input| input.events.clone());
        let pointer = ui.input(|input| input.pointer.latest_pos());
        self.pointer = pointer.filter(|at| free(*at));
        self.placed = views.to_vec();
        self.press_long(ui, &events, &free);
        if self.help.explains() {
            events.retain(|event| {
                let Some(at) = pressed_at(event).filter(|at| free(*at)) else {
                    return true;
                };
                if let Some(about) = self.pointed_at(at) {
                    self.help.explain(about);
                }
                placing::units(views, at)
                    .and_then(|(x, y)| faceplate::part_at(x, y)?.key())
                    .is_some_and(stops)
            });
        }
        let done = self.pointing.follow(&events, views, &mut self.held, &free);
        self.send(&done.changes);
        if let Some(key) = done.not_kept {
            self.message = Some(Message::NotKept(key));
        }
        if done.detents != 0 {
            self.console.send(Command::Turn(done.detents));
        }
    }
}
