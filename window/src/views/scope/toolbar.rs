//! The tool bar of the scope.

use egui::{ComboBox, RichText, Ui};

use super::trigger::{TriggerMode, TriggerSource};
use super::{AVERAGES_TICKS, SPANS_MS, Scope};
use crate::widgets::icons::{Icon, IconButton};
use gsk_messages::{Language, say};

impl Scope {
    pub(super) fn show_toolbar(&mut self, ui: &mut Ui, language: Language) {
        ui.horizontal_wrapped(|ui| {
            let (icon, name) = match self.is_running {
                true => (Icon::PAUSE, say::scope_pause()),
                false => (Icon::SAMPLE, say::scope_run()),
            };
            let button = IconButton {
                icon,
                name: name.text(language),
                hint: say::scope_space_key().text(language),
                is_selected: None,
            };
            if button.show(ui, false).clicked() {
                self.toggle_running();
            }
            ui.separator();
            self.choose_span(ui, language);
            self.choose_average(ui, language);
            ui.separator();
            self.choose_trigger(ui, language);
            ui.separator();
            ui.checkbox(&mut self.autoscale, say::scope_autoscale().text(language))
                .on_hover_text(say::scope_autoscale_hint().text(language));
            let mut cursors = self.cursors.is_some();
            let hint = say::scope_cursors_hint().text(language);
            let response = ui.checkbox(&mut cursors, say::scope_cursors().text(language));
            if response.on_hover_text(hint).changed() {
                self.toggle_cursors();
            }
            ui.separator();
            let export = IconButton {
                icon: Icon::EXPORT,
                name: say::scope_export().text(language),
                hint: say::scope_export_hint().text(language),
                is_selected: None,
            };
            if export.show(ui, false).clicked() {
                self.export(language, &ui.ctx().clone());
            }
        });
    }

    fn choose_span(&mut self, ui: &mut Ui, language: Language) {
        let name = say::scope_span().text(language);
        let label = ui.label(name);
        let mut chosen = self.span_ms;
        let shown = ComboBox::from_id_salt("span")
            .width(78.0)
            .selected_text(format_time(chosen))
            .show_ui(ui, |ui| {
                for span in SPANS_MS {
                    ui.selectable_value(&mut chosen, span, format_time(span));
                }
            });
        shown.response.labelled_by(label.id);
        if chosen != self.span_ms {
            let index_of = |span| SPANS_MS.iter().position(|known| *known == span);
            let (Some(from), Some(to)) = (index_of(self.span_ms), index_of(chosen)) else {
                return;
            };
            self.zoom_time(to as i32 - from as i32, 1.0);
        }
    }

    fn choose_average(&mut self, ui: &mut Ui, language: Language) {
        let label = ui.label(say::scope_average().text(language));
        let shown = ComboBox::from_id_salt("average")
            .width(64.0)
            .selected_text(format_time(self.average_ticks))
            .show_ui(ui, |ui| {
                for over in AVERAGES_TICKS {
                    ui.selectable_value(&mut self.average_ticks, over, format_time(over));
                }
            });
        let hint = say::scope_average_hint().text(language);
        shown.response.labelled_by(label.id).on_hover_text(hint);
    }

    fn choose_trigger(&mut self, ui: &mut Ui, language: Language) {
        let label = ui.label(say::scope_trigger().text(language));
        let mut mode = self.trigger.mode;
        let shown = ComboBox::from_id_salt("trigger mode")
            .width(72.0)
            .selected_text(mode_name(mode, language))
            .show_ui(ui, |ui| {
                for known in [TriggerMode::Off, TriggerMode::Each, TriggerMode::Once] {
                    ui.selectable_value(&mut mode, known, mode_name(known, language));
                }
            });
        shown.response.labelled_by(label.id);
        let mut source = self.trigger.source;
        if mode != TriggerMode::Off {
            let name = say::scope_trigger_source().text(language);
            let shown = ComboBox::from_id_salt("trigger source")
                .width(118.0)
                .selected_text(self.source_name(source, language))
                .show_ui(ui, |ui| {
                    for known in self.trigger_sources() {
                        let name = self.source_name(known, language);
                        ui.selectable_value(&mut source, known, name);
                    }
                });
            shown.response.on_hover_text(name);
        }
        if (mode, source) != (self.trigger.mode, self.trigger.source) {
            self.trigger.mode = mode;
            self.trigger.source = source;
            self.resume();
        }
        if mode != TriggerMode::Off {
            let state = if !self.is_running {
                say::scope_trigger_stopped().text(language)
            } else if self.trigger.has_fired() {
                say::scope_triggered().text(language)
            } else {
                say::scope_trigger_waits().text(language)
            };
            ui.label(RichText::new(state).weak());
        }
    }

    fn trigger_sources(&self) -> Vec<TriggerSource> {
        let indices = self.bit_channels.iter().map(|channel| channel.bit_index);
        let edges = indices.flat_map(|place| {
            [
                TriggerSource::BitRises(place),
                TriggerSource::BitFalls(place),
            ]
        });
        [TriggerSource::Motion, TriggerSource::Spindle]
            .into_iter()
            .chain(edges)
            .collect()
    }

    fn source_name(&self, source: TriggerSource, language: Language) -> String {
        let bit = |place| {
            let known = self
                .bit_channels
                .iter()
                .find(|channel| channel.bit_index == place);
            known.map_or_else(|| "?".to_owned(), |channel| channel.address.to_string())
        };
        match source {
            TriggerSource::Motion => say::scope_when_axis_starts().text(language),
            TriggerSource::Spindle => say::scope_when_spindle_starts().text(language),
            TriggerSource::BitRises(place) => format!("{} 0 → 1", bit(place)),
            TriggerSource::BitFalls(place) => format!("{} 1 → 0", bit(place)),
        }
    }
}

fn mode_name(mode: TriggerMode, language: Language) -> String {
    match mode {
        TriggerMode::Off => say::scope_trigger_off().text(language),
        TriggerMode::Each => say::scope_trigger_each().text(language),
        TriggerMode::Once => say::scope_trigger_once().text(language),
    }
}

/// Formats a time in ms; from 1000 ms on in s.
fn format_time(ms: u64) -> String {
    if ms < 1000 {
        format!("{ms} ms")
    } else {
        format!("{} s", ms / 1000)
    }
}
