//! Draws the tables of a ladder: messages, comments, initial data (manual PLC-III 4 and 5).

use egui::{
    Align, Color32, Label, Layout, Panel, RichText, ScrollArea, Sense, TextEdit, Ui, UiBuilder,
    vec2,
};
use gsk_core::plc::{Ladder, PlcAddress};

use super::directive::Table;
use super::draft::Draft;
use super::{LadderView, draw, value, words};
use crate::kernel::monitor::MachineView;
use crate::window::focus;
use gsk_messages::{Language, Message, say};

/// Height of a row, points.
const ROW: f32 = 22.0;

/// A column: heading and width, points. The last column takes the remaining width.
type Column = (Message, f32);

impl LadderView {
    pub(super) fn messages(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        self.row_editor(ui, language, Table::Messages);
        let ladder = self.shown(machine);
        let columns = [
            (say::ladder_column_message_address(), 110.0),
            (say::ladder_column_message_number(), 90.0),
            (say::ladder_column_state(), 70.0),
            (say::ladder_column_message_text(), 0.0),
        ];
        let messages = ladder.messages();
        let clicked = table(ui, language, &columns, messages.len(), |index| {
            let Some(message) = messages.get(index) else {
                return Vec::new();
            };
            let on = machine.plc.memory().bit(message.bit);
            let colour = if on {
                draw::HELD
            } else {
                Color32::from_gray(215)
            };
            [
                message.bit.to_string(),
                format!("{:04}", message.number),
                u8::from(on).to_string(),
                message.text.clone(),
            ]
            .into_iter()
            .map(|text| RichText::new(text).color(colour))
            .collect()
        });
        if let Some(message) = clicked.and_then(|index| messages.get(index)) {
            let number = message.number.to_string();
            self.row = vec![message.bit.to_string(), number, message.text.clone()];
            self.show_uses(&ladder, PlcAddress::Bit(message.bit));
        }
    }

    pub(super) fn comment_table(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        self.row_editor(ui, language, Table::Comments);
        let ladder = self.shown(machine);
        let columns = [
            (say::ladder_column_address(), 110.0),
            (say::ladder_column_uses(), 60.0),
            (say::ladder_column_chinese_comment(), 260.0),
            (say::ladder_column_english_comment(), 0.0),
        ];
        let comments = ladder.comments();
        let clicked = table(ui, language, &columns, comments.len(), |index| {
            let Some(comment) = comments.get(index) else {
                return Vec::new();
            };
            let uses = self
                .uses
                .binary_search_by_key(&comment.subject, |(subject, _)| *subject);
            let uses = uses
                .ok()
                .and_then(|at| self.uses.get(at))
                .map_or(0, |(_, count)| *count);
            vec![
                RichText::new(comment.subject.to_string()).monospace(),
                RichText::new(uses.to_string()).weak(),
                RichText::new(&comment.chinese),
                RichText::new(&comment.english),
            ]
        });
        if let Some(comment) = clicked.and_then(|index| comments.get(index)) {
            let (zh, en) = (comment.chinese.clone(), comment.english.clone());
            self.row = vec![comment.subject.to_string(), zh, en];
            self.show_uses(&ladder, comment.subject);
        }
    }

    pub(super) fn start_values(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        self.row_editor(ui, language, Table::StartValues);
        let ladder = self.shown(machine);
        let columns = [
            (say::ladder_column_address(), 110.0),
            (say::ladder_column_initial_value(), 120.0),
            (say::ladder_column_value_now(), 140.0),
            (say::ladder_column_comment(), 0.0),
        ];
        let values = ladder.start_values();
        let clicked = table(ui, language, &columns, values.len(), |index| {
            let Some(start) = values.get(index) else {
                return Vec::new();
            };
            let now = value::number(start.address, 1, machine.plc.memory());
            let words = draw::comment(&ladder, PlcAddress::Byte(start.address), language);
            vec![
                RichText::new(start.address.to_string()).monospace(),
                RichText::new(start.value.to_string()).monospace(),
                RichText::new(now).monospace().color(draw::LIVE),
                RichText::new(words),
            ]
        });
        if let Some(start) = clicked.and_then(|index| values.get(index)) {
            self.row = vec![start.address.to_string(), start.value.to_string()];
            self.show_uses(&ladder, PlcAddress::Byte(start.address));
        }
    }

    /// Shows the first use of an address, except while editing.
    fn show_uses(&mut self, ladder: &Ladder, subject: PlcAddress) {
        if self.editing {
            return;
        }
        self.look_for(ladder, subject);
        if let Some(first) = ladder.references(subject).first() {
            self.go_to(ladder, first.statement);
        }
    }

    /// Draws the fields of the row that was clicked, or of a new row, with buttons that write
    /// and delete it.
    fn row_editor(&mut self, ui: &mut Ui, language: Language, kind: Table) {
        let names: Vec<String> = kind.fields().iter().map(|it| it.text(language)).collect();
        self.row.resize(names.len(), String::new());
        if !self.editing {
            return;
        }
        let mut list = None;
        let panel = Panel::bottom("row editor").frame(crate::window::views::side_frame());
        panel.show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                for (at, (name, text)) in names.iter().zip(&mut self.row).enumerate() {
                    ui.label(RichText::new(name).weak());
                    let texts = at > 0 && kind != Table::StartValues && names.len() - at < 3;
                    let long = texts && !(kind == Table::Messages && at == 1);
                    let width = if long { 260.0 } else { 90.0 };
                    let response = ui.add(TextEdit::singleline(text).desired_width(width));
                    response.widget_info(|| {
                        egui::WidgetInfo::labeled(egui::Role::TextInput, true, name)
                    });
                }
                let source = self.draft.as_ref().map_or("", Draft::text);
                let write = say::ladder_write_row().text(language);
                let hint = say::ladder_write_row_hint().text(language);
                if ui.button(write).on_hover_text(hint).clicked() {
                    list = Some(kind.with(source, &self.row));
                }
                if ui.button(say::ladder_delete_row().text(language)).clicked() {
                    let address = self.row.first().map_or("", String::as_str);
                    list = Some(Ok(kind.without(source, address)));
                }
            });
            if let Some(complaint) = &self.complaint {
                ui.label(RichText::new(complaint).color(super::edit::WRONG));
            }
        });
        if let Some(list) = list {
            self.complaint = match list {
                Ok(list) => self.take_list(list, language),
                Err(wrong) => Some(wrong.text(language)),
            };
        }
    }

    /// Takes a changed list into the draft if it compiles. Returns the first error otherwise.
    fn take_list(&mut self, list: String, language: Language) -> Option<String> {
        if let Err(errors) = Ladder::compile(&list) {
            let first = errors.errors.first();
            return Some(first.map_or_else(String::new, |error| words::finding(error, language)));
        }
        if let Some(draft) = &mut self.draft {
            draft.set(list, None);
        }
        None
    }
}

/// Draws a table. Returns the index of the row that was clicked.
fn table(
    ui: &mut Ui,
    language: Language,
    columns: &[Column],
    count: usize,
    row: impl Fn(usize) -> Vec<RichText>,
) -> Option<usize> {
    let mut clicked = None;
    ui.add_space(6.0);
    let heads = columns
        .iter()
        .map(|(head, _)| RichText::new(head.text(language)).weak());
    cells(ui, columns, heads.collect());
    ui.separator();
    let name = columns.iter().map(|(head, _)| head.text(language));
    let name = name.collect::<Vec<_>>().join("  ");
    let list = focus::List::begin(ui, "table", &name, count, None);
    ScrollArea::vertical()
        .auto_shrink([false, false])
        .show_rows(ui, ROW, count, |ui, rows| {
            list.follow(ui, rows.start, ROW);
            for index in rows {
                let texts = row(index);
                let name = texts
                    .iter()
                    .map(RichText::text)
                    .collect::<Vec<_>>()
                    .join("  ");
                let place = cells(ui, columns, texts);
                let id = ui.scope_id().with(("row", index));
                let response = ui.interact(place, id, focus::ROW);
                let role = egui::Role::ListBoxOption;
                response.widget_info(|| egui::WidgetInfo::labeled(role, true, &name));
                if response.hovered() {
                    let shade = Color32::from_white_alpha(10);
                    ui.painter().rect_filled(place, 2.0, shade);
                }
                if list.row(ui, index, &response) {
                    clicked = Some(index);
                }
            }
        });
    clicked.or(list.entered())
}

/// Draws one row of texts. Returns its rectangle.
fn cells(ui: &mut Ui, columns: &[Column], texts: Vec<RichText>) -> egui::Rect {
    let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::HOVER);
    let mut left = place.left() + 10.0;
    for ((_, width), text) in columns.iter().zip(texts) {
        let right = if *width > 0.0 {
            left + width
        } else {
            place.right()
        };
        let cell = egui::Rect::from_x_y_ranges(left..=right - 6.0, place.y_range());
        let content = UiBuilder::new()
            .max_rect(cell)
            .layout(Layout::left_to_right(Align::Center));
        ui.scope_builder(content, |ui| {
            ui.add(Label::new(text).truncate().selectable(false))
        });
        left = right;
    }
    place
}
