//! The panel inside the window: parts, LCD, accessible names, pointer.

use egui::{Pos2, Role, Sense, Ui, WidgetInfo};
use gsk_panel::faceplate::{self, FaceState, Part, What};
use gsk_panel::keys::{Key, STRIP};

use super::face::View;
use super::help::pc_name;
use super::texts::Text;
use super::{Command, Window};
use crate::cli::Language;

impl Window {
    /// Draws the panel and takes what mouse and fingers do to it.
    pub(super) fn panel(&mut self, ui: &mut Ui) {
        let room = ui.max_rect();
        let view = View::fit(room, ui.pixels_per_point());
        self.point(ui, view);
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
        };
        self.face.paint(&painter, view, &state);
        let mut taps = Vec::new();
        for part in faceplate::parts() {
            taps.extend(self.describe(ui, part, view, &state));
        }
        for key in taps {
            self.console.send(Command::Tap(key));
        }
        if let Some(picture) = &picture {
            let place = view.rect(faceplate::lcd());
            self.lcd
                .paint(&painter, place, &picture.screen, picture.brightness);
            let lcd = ui.interact(place, ui.scope_id().with("lcd"), Sense::HOVER);
            lcd.widget_info(|| WidgetInfo {
                current_text_value: Some(picture.screen.text()),
                ..WidgetInfo::labeled(Role::Terminal, true, Text::Lcd.of(self.settings.language))
            });
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
                response.widget_info(|| WidgetInfo {
                    selected,
                    ..WidgetInfo::labeled(Role::Button, true, name)
                });
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
                    Language::Zh => format!("{}灯", lamp.name_zh),
                    Language::En => format!("{} lamp", lamp.name_en),
                };
                let lit = lamp.lamp.of(state.y);
                let word = if lit { Text::Lit } else { Text::Dark };
                response.widget_info(|| WidgetInfo {
                    current_text_value: Some(word.of(language).to_owned()),
                    ..WidgetInfo::labeled(Role::Status, true, &name)
                });
                None
            }
            What::Handwheel => {
                let response = ui.interact(rect, ui.scope_id().with("handwheel"), Sense::DRAG);
                response.widget_info(|| WidgetInfo {
                    value: Some(f64::from(state.wheel)),
                    ..WidgetInfo::labeled(Role::Slider, true, Text::Handwheel.of(language))
                });
                response.on_hover_text(Text::HandwheelHint.of(language));
                None
            }
            _ => None,
        }
    }

    fn point(&mut self, ui: &Ui, view: View) {
        let own = ui.layer_id();
        let context = ui.ctx().clone();
        let room = ui.max_rect();
        let free = |at: Pos2| {
            room.contains(at) && context.layer_id_at(at).is_none_or(|layer| layer == own)
        };
        let events = ui.input(|input| input.events.clone());
        let done = self.pointing.follow(&events, view, &mut self.held, &free);
        self.send(&done.changes);
        if done.detents != 0 {
            self.console.send(Command::Turn(done.detents));
        }
    }
}
