//! The panel inside the window: parts, LCD, accessible names, pointer.

use egui::{
    Color32, Event, Painter, Pos2, Role, Sense, Stroke, StrokeKind, TouchPhase, Ui, WidgetInfo,
};
use gsk_help::{Subject, Topic, on_screen, topic};
use gsk_panel::faceplate::{self, FaceState, Outline, Part, What};
use gsk_panel::keys::{Key, STRIP};
use gsk_panel::screen::{COLUMNS, ROWS};

use super::key_map::pc_name;
use super::placing::{self, View};
use super::{Command, Message, Window, reader};
use gsk_messages::{Language, say};

/// The ring around a key that is kept for the next one.
const RING: Color32 = Color32::from_rgb(255, 150, 0);

/// The ring around a key that a lesson asks for.
const ASKED: Color32 = Color32::from_rgb(60, 220, 255);

/// Draws a ring around a key.
fn ring(painter: &Painter, view: View, part: &Part, colour: Color32) {
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

/// Where a mouse button or a finger goes down.
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

/// Whether a key only ever stops the machine: it acts also while keys are explained.
const fn stops(key: Key) -> bool {
    matches!(key, Key::EmergencyStop | Key::Reset | Key::FeedHold)
}

impl Window {
    /// Draws the panel and takes what mouse and fingers do to it.
    pub(super) fn panel(&mut self, ui: &mut Ui) {
        let room = ui.max_rect();
        let views = placing::views(room, ui.pixels_per_point());
        self.point(ui, &views);
        let painter = ui.painter().clone();
        let picture = self.picture.take();
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
        };
        self.face.paint(&painter, &views, &state);
        let mut taps = Vec::new();
        for view in &views {
            for part in view.area.parts() {
                taps.extend(self.describe(ui, &part, *view, &state));
            }
        }
        for key in taps {
            self.held.forget_kept();
            self.console.send(Command::Tap(key));
        }
        let screen = views.first().map(|view| view.rect(faceplate::lcd()));
        if let (Some(picture), Some(place)) = (&picture, screen) {
            self.lcd
                .paint(&painter, place, &picture.screen, picture.brightness);
            let lcd = ui.interact(place, ui.scope_id().with("lcd"), Sense::HOVER);
            lcd.widget_info(|| WidgetInfo {
                current_text_value: Some(picture.screen.text()),
                ..WidgetInfo::labeled(
                    Role::Terminal,
                    true,
                    say::window_lcd().text(self.settings.language),
                )
            });
            reader::rows(ui, &lcd, place, &picture.screen);
        }
        for key in self.views.lessons().marked() {
            if let Some(part) = faceplate::part_of(key)
                && let Some(view) = placing::of_part(&views, part)
            {
                ring(&painter, *view, part, ASKED);
            }
        }
        if let Some(part) = self.held.kept().and_then(faceplate::part_of)
            && let Some(view) = placing::of_part(&views, part)
        {
            ring(&painter, *view, part, RING);
        }
        self.picture = picture;
    }

    /// Gives a part its accessible name; returns the key that a screen reader has
    /// pressed.
    fn describe(&self, ui: &Ui, part: &Part, view: View, state: &FaceState<'_>) -> Option<Key> {
        let language = self.settings.language;
        let rect = view.rect(part.rect);
        match part.what {
            What::Key(key) => {
                let row = key.row();
                // Without FOCUSABLE: Tab and Space must never press a machine key.
                let response = ui.interact(
                    rect,
                    ui.scope_id().with(key.id()),
                    Sense::CLICK | Sense::DRAG,
                );
                let name = match language {
                    Language::Zh => row.name_zh,
                    Language::En => row.name_en,
                };
                let lit = row.lamp.map(|lamp| lamp.of(state.y));
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
                if !row.pc.is_empty() {
                    response.on_hover_ui(|ui| {
                        ui.label(format!("{name}   [{}]", pc_name(row.pc)));
                    });
                }
                by_screen_reader.then_some(key)
            }
            What::Strip(index) => {
                let lamp = STRIP.get(index).filter(|lamp| lamp.fitted)?;
                let response = ui.interact(rect, ui.scope_id().with(lamp.id), Sense::HOVER);
                let name = match language {
                    Language::Zh => lamp.name_zh,
                    Language::En => lamp.name_en,
                };
                let name = say::window_lamp(name).text(language);
                let lit = lamp.lamp.of(state.y);
                let word = match lit {
                    true => say::window_lamp_on(),
                    false => say::window_lamp_off(),
                };
                response.widget_info(|| WidgetInfo {
                    current_text_value: Some(word.text(language)),
                    ..WidgetInfo::labeled(Role::Status, true, &name)
                });
                reader::state(ui, &response, &word.text(language));
                None
            }
            What::Handwheel => {
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

    /// The topic about what lies at a place of the window: a key, a lamp, what the LCD
    /// shows there.
    pub(super) fn pointed_at(&self, at: Pos2) -> Option<&'static Topic> {
        let (x, y) = placing::units(&self.placed, at)?;
        let lcd = faceplate::lcd();
        if lcd.contains(x, y) {
            let picture = self.picture.as_ref()?;
            let cell = |from: f32, size: f32, count: usize| (from / size * count as f32) as usize;
            let row = cell(y - lcd.y, lcd.h, ROWS);
            let column = cell(x - lcd.x, lcd.w, COLUMNS);
            return on_screen(picture.page, &picture.screen, row, column);
        }
        match faceplate::part_at(x, y)?.what {
            What::Key(key) => topic(Subject::Key(key.id())),
            What::Strip(index) => topic(Subject::Lamp(STRIP.get(index)?.id)),
            _ => None,
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
