//! The list beside the plot: selects the traces and shows their readings.

use egui::{Align, Label, Layout, RichText, ScrollArea, Ui, UiBuilder, vec2};
use gsk_panel::pages::signal_meaning;

use super::trace::{Quantity, TRACES};
use super::{BitChannel, Cursors, Scope};
use crate::focus;
use crate::theme;
use gsk_messages::{Language, say};

/// Width of the list with one reading per trace, points. The constant after it is that with
/// two cursors.
const NARROW_WIDTH: f32 = 250.0;
const WIDE_WIDTH: f32 = 366.0;
/// Height of a line of text, points.
const LINE_HEIGHT: f32 = 21.0;
/// Width of the column of a measured value, points.
const READING_WIDTH: f32 = 80.0;

impl Scope {
    pub(super) const fn side_width(&self) -> f32 {
        if self.cursors.is_some() {
            WIDE_WIDTH
        } else {
            NARROW_WIDTH
        }
    }

    pub(super) fn show_side(&mut self, ui: &mut Ui, language: Language) {
        self.show_head(ui, language);
        ui.separator();
        ScrollArea::vertical()
            .auto_shrink([false, false])
            .show(ui, |ui| {
                for quantity in Quantity::ALL {
                    self.show_traces(ui, language, quantity);
                }
                ui.add_space(6.0);
                self.show_bits(ui, language);
                focus::scroll_to_focus(ui);
            });
    }

    /// Draws the heading of the readings: the times of the cursors or, without cursors, that
    /// the readings are at the right edge.
    fn show_head(&mut self, ui: &mut Ui, language: Language) {
        let Some(cursors) = self.cursors else {
            draw_line(
                ui,
                LINE_HEIGHT,
                |ui| {
                    ui.label(RichText::new(say::scope_shown().text(language)).weak());
                },
                |ui| {
                    let words = say::scope_at_right_edge().text(language);
                    ui.label(RichText::new(words).weak());
                },
            );
            return;
        };
        let [a, b] = cursors.ticks;
        let origin = self.origin_tick;
        let seconds = |tick: u64| (tick as f64 - origin as f64) / 1000.0;
        draw_line(
            ui,
            LINE_HEIGHT,
            |ui| {
                ui.label(RichText::new(say::scope_cursors().text(language)).weak());
            },
            |ui| {
                draw_reading(ui, RichText::new("B - A").weak());
                for (name, place) in [("B", 1), ("A", 0)] {
                    let colour = theme::SCOPE_CURSORS[place];
                    draw_reading(ui, RichText::new(name).color(colour).strong());
                }
            },
        );
        draw_line(
            ui,
            LINE_HEIGHT,
            |ui| {
                ui.label(say::scope_time_seconds().text(language));
            },
            |ui| {
                draw_reading(ui, format_figure(Some((b as f64 - a as f64) / 1000.0), 3));
                let mut at = [a, b];
                for place in [1, 0] {
                    let mut time = seconds(at[place]);
                    let entry = egui::DragValue::new(&mut time)
                        .speed(self.span_ms as f64 / 400_000.0)
                        .fixed_decimals(3);
                    let response = ui.add_sized([READING_WIDTH, LINE_HEIGHT], entry);
                    let name = ["A", "B"][place];
                    response.widget_info(|| {
                        let name = say::scope_time_of_cursor(name).text(language);
                        egui::WidgetInfo::labeled(egui::Role::SpinButton, true, name)
                    });
                    if response.changed() {
                        at[place] = (origin as f64 + time * 1000.0).round().max(0.0) as u64;
                    }
                }
                self.cursors = Some(Cursors {
                    ticks: at,
                    ..cursors
                });
            },
        );
    }

    fn show_traces(&mut self, ui: &mut Ui, language: Language, quantity: Quantity) {
        ui.add_space(4.0);
        ui.label(RichText::new(quantity.heading(language)).weak());
        for (index, trace) in TRACES.iter().enumerate() {
            if trace.quantity != quantity {
                continue;
            }
            let readings = self.cursor_readings(|scope, tick| {
                scope
                    .record
                    .as_ref()?
                    .trace_value(trace, tick, scope.average_ticks)
            });
            let shown = self.trace_enabled[index];
            let on = &mut self.trace_enabled[index];
            draw_line(
                ui,
                LINE_HEIGHT,
                |ui| {
                    let name = RichText::new(trace.name(language)).color(trace.colour());
                    let response = ui.checkbox(on, name);
                    let on = *on;
                    response.widget_info(|| {
                        let name = trace.full_name(language);
                        egui::WidgetInfo::selected(egui::Role::CheckBox, true, on, name)
                    });
                },
                |ui| {
                    for value in readings.iter().rev() {
                        let text = format_figure(*value, quantity.decimals());
                        draw_reading(ui, if shown { text } else { text.weak() });
                    }
                },
            );
        }
    }

    fn show_bits(&mut self, ui: &mut Ui, language: Language) {
        ui.label(RichText::new(say::scope_plc_bits().text(language)).weak());
        let mut removed = None;
        for (index, channel) in self.bit_channels.iter().enumerate() {
            let state = |scope: &Self, tick| {
                let sample = scope.record.as_ref()?.sample_at(tick)?;
                Some(f64::from(sample.bits >> channel.bit_index & 1))
            };
            let readings = self.cursor_readings(state);
            let readings = readings.get(..readings.len().min(2)).unwrap_or_default();
            draw_line(
                ui,
                LINE_HEIGHT,
                |ui| {
                    let words = say::scope_remove().text(language);
                    let button = ui.small_button("×").on_hover_text(&words);
                    let name = format!("{words} {}", channel.address);
                    button
                        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
                    if button.clicked() {
                        removed = Some(index);
                    }
                    let name = RichText::new(channel.address.to_string())
                        .color(theme::SCOPE_BIT)
                        .monospace();
                    ui.label(name);
                    let meaning = bit_meaning(channel, language);
                    ui.add(Label::new(RichText::new(&meaning).weak()).truncate())
                        .on_hover_text(&meaning);
                },
                |ui| {
                    for value in readings.iter().rev() {
                        let text = format_figure(*value, 0);
                        draw_cell(ui, 26.0, text);
                    }
                },
            );
        }
        if let Some(index) = removed {
            self.bit_channels.remove(index);
            self.start_probe();
        }
        ui.horizontal(|ui| {
            // An explicit id: the field moves when a bit is added.
            let entry = egui::TextEdit::singleline(&mut self.entry)
                .id_salt("bit address")
                .desired_width(110.0)
                .hint_text("X0.5  F1.0  G8.4");
            let response = ui.add(entry);
            let name = say::scope_bit_address().text(language);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &name));
            let entered =
                response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            let button = ui.button(say::window_add().text(language));
            if (button.clicked() || entered) && !self.entry.trim().is_empty() {
                self.add_bit(language);
                if entered {
                    response.request_focus();
                }
            }
        });
        if let Some(complaint) = &self.entry_error {
            ui.label(RichText::new(complaint).color(theme::SCOPE_ERROR_TEXT));
        }
    }

    /// The values at both cursors and their difference; without cursors only the value at the
    /// right edge. `value` returns that at a tick.
    fn cursor_readings(&self, value: impl Fn(&Self, u64) -> Option<f64>) -> Vec<Option<f64>> {
        let Some((_, end)) = self.visible_ticks() else {
            return vec![None];
        };
        let Some(cursors) = self.cursors else {
            return vec![value(self, end)];
        };
        let [a, b] = cursors.ticks.map(|tick| value(self, tick));
        let difference = a.zip(b).map(|(a, b)| b - a);
        vec![a, b, difference]
    }
}

/// The meaning of a watched bit in the signal table.
pub fn bit_meaning(channel: &BitChannel, language: Language) -> String {
    signal_meaning(channel.address, language).to_owned()
}

/// Draws a line with content at its left and at its right edge.
fn draw_line(ui: &mut Ui, height: f32, left: impl FnOnce(&mut Ui), right: impl FnOnce(&mut Ui)) {
    // The rest of the width is for the scroll bar.
    let size = vec2(ui.available_width() - 9.0, height);
    let (rect, _) = ui.allocate_exact_size(size, egui::Sense::HOVER);
    let content = UiBuilder::new()
        .max_rect(rect)
        .layout(Layout::right_to_left(Align::Center));
    ui.scope_builder(content, |ui| {
        right(ui);
        ui.with_layout(Layout::left_to_right(Align::Center), left);
    });
}

fn draw_reading(ui: &mut Ui, text: RichText) {
    draw_cell(ui, READING_WIDTH, text);
}

/// Draws a right-aligned text in a column of `width` points.
fn draw_cell(ui: &mut Ui, width: f32, text: RichText) {
    let layout = Layout::right_to_left(Align::Center);
    ui.allocate_ui_with_layout(vec2(width, LINE_HEIGHT), layout, |ui| {
        ui.set_min_width(width);
        ui.label(text);
    });
}

fn format_figure(value: Option<f64>, decimals: usize) -> RichText {
    let text = value.map_or_else(
        || "-".to_owned(),
        |value| {
            let text = format!("{value:.decimals$}");
            // A rounded zero has no sign.
            match text.strip_prefix('-') {
                Some(rest) if rest.bytes().all(|byte| matches!(byte, b'0' | b'.')) => {
                    rest.to_owned()
                }
                _ => text,
            }
        },
    );
    RichText::new(text).monospace()
}
