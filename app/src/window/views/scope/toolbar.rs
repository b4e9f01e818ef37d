//! The bar of the scope.

use egui::{ComboBox, RichText, Ui};

use super::trigger::{Mode, Source};
use super::{AVERAGES, SPANS, Scope};
use crate::cli::Language;
use crate::window::texts::say;

impl Scope {
    pub(super) fn toolbar(&mut self, ui: &mut Ui, language: Language) {
        ui.horizontal_wrapped(|ui| {
            let word = if self.running {
                say(language, "暂停", "Pause")
            } else {
                say(language, "继续", "Run")
            };
            let hint = say(language, "空格键", "Space");
            // Both words take the same room, so that nothing moves.
            let button = egui::Button::new(word).min_size(egui::vec2(64.0, 0.0));
            if ui.add(button).on_hover_text(hint).clicked() {
                self.toggle();
            }
            ui.separator();
            self.choose_span(ui, language);
            self.choose_average(ui, language);
            ui.separator();
            self.choose_trigger(ui, language);
            ui.separator();
            ui.checkbox(&mut self.autoscale, say(language, "自动量程", "Autoscale"))
                .on_hover_text(say(
                    language,
                    "A 键; 关闭后可在刻度上滚动或拖动",
                    "Key A; without it scroll or drag on a scale",
                ));
            let mut cursors = self.cursors.is_some();
            let hint = say(
                language,
                "C 键; 拖动, 或用 ← → (Shift: 1 ms), ↑ ↓ 换游标",
                "Key C; drag them, or use ← → (Shift: 1 ms), ↑ ↓ for the other one",
            );
            let response = ui.checkbox(&mut cursors, say(language, "游标", "Cursors"));
            if response.on_hover_text(hint).changed() {
                self.toggle_cursors();
            }
            ui.separator();
            let hint = say(
                language,
                "把所示时间段存为表格",
                "Saves the time shown as a table",
            );
            let export = ui.button(say(language, "导出 CSV…", "Export CSV…"));
            if export.on_hover_text(hint).clicked() {
                self.export(language, &ui.ctx().clone());
            }
        });
    }

    fn choose_span(&mut self, ui: &mut Ui, language: Language) {
        let name = say(language, "时间", "Span");
        let label = ui.label(name);
        let mut chosen = self.span;
        let shown = ComboBox::from_id_salt("span")
            .width(78.0)
            .selected_text(time(chosen))
            .show_ui(ui, |ui| {
                for span in SPANS {
                    ui.selectable_value(&mut chosen, span, time(span));
                }
            });
        shown.response.labelled_by(label.id);
        if chosen != self.span {
            let place = |span| SPANS.iter().position(|known| *known == span);
            let (Some(from), Some(to)) = (place(self.span), place(chosen)) else {
                return;
            };
            self.zoom(to as i32 - from as i32, 1.0);
        }
    }

    fn choose_average(&mut self, ui: &mut Ui, language: Language) {
        let label = ui.label(say(language, "平均", "Average"));
        let shown = ComboBox::from_id_salt("average")
            .width(64.0)
            .selected_text(time(self.over))
            .show_ui(ui, |ui| {
                for over in AVERAGES {
                    ui.selectable_value(&mut self.over, over, time(over));
                }
            });
        let hint = say(
            language,
            "速度与加速度取此时间内的平均值",
            "Speed and acceleration are averaged over this time",
        );
        shown.response.labelled_by(label.id).on_hover_text(hint);
    }

    fn choose_trigger(&mut self, ui: &mut Ui, language: Language) {
        let label = ui.label(say(language, "触发", "Trigger"));
        let mut mode = self.trigger.mode;
        let shown = ComboBox::from_id_salt("trigger mode")
            .width(72.0)
            .selected_text(mode_name(mode, language))
            .show_ui(ui, |ui| {
                for known in [Mode::Off, Mode::Each, Mode::Once] {
                    ui.selectable_value(&mut mode, known, mode_name(known, language));
                }
            });
        shown.response.labelled_by(label.id);
        let mut source = self.trigger.source;
        if mode != Mode::Off {
            let name = say(language, "触发源", "Trigger source");
            let shown = ComboBox::from_id_salt("trigger source")
                .width(118.0)
                .selected_text(self.source_name(source, language))
                .show_ui(ui, |ui| {
                    for known in self.sources() {
                        let name = self.source_name(known, language);
                        ui.selectable_value(&mut source, known, name);
                    }
                });
            shown.response.on_hover_text(name);
        }
        if (mode, source) != (self.trigger.mode, self.trigger.source) {
            self.trigger.mode = mode;
            self.trigger.source = source;
            self.go_on();
        }
        if mode != Mode::Off {
            let state = if !self.running {
                say(language, "停止", "stopped")
            } else if self.trigger.fired() {
                say(language, "已触发", "triggered")
            } else {
                say(language, "等待", "waiting")
            };
            ui.label(RichText::new(state).weak());
        }
    }

    fn sources(&self) -> Vec<Source> {
        let places = self.bits.iter().map(|channel| channel.place);
        let edges = places.flat_map(|place| [Source::BitRises(place), Source::BitFalls(place)]);
        [Source::Motion, Source::Spindle]
            .into_iter()
            .chain(edges)
            .collect()
    }

    fn source_name(&self, source: Source, language: Language) -> String {
        let bit = |place| {
            let known = self.bits.iter().find(|channel| channel.place == place);
            known.map_or_else(|| "?".to_owned(), |channel| channel.address.to_string())
        };
        match source {
            Source::Motion => say(language, "轴开始移动", "an axis starts").to_owned(),
            Source::Spindle => say(language, "主轴启动", "spindle starts").to_owned(),
            Source::BitRises(place) => format!("{} 0 → 1", bit(place)),
            Source::BitFalls(place) => format!("{} 1 → 0", bit(place)),
        }
    }
}

fn mode_name(mode: Mode, language: Language) -> &'static str {
    match mode {
        Mode::Off => say(language, "关", "off"),
        Mode::Each => say(language, "每次", "each"),
        Mode::Once => say(language, "一次", "once"),
    }
}

/// A time span in words.
fn time(ms: u64) -> String {
    if ms < 1000 {
        format!("{ms} ms")
    } else {
        format!("{} s", ms / 1000)
    }
}
