//! Draws the tables of a ladder: messages, comments, initial data (manual PLC-III 4 and 5).

use egui::{
    Align, Label, Layout, Panel, RichText, ScrollArea, Sense, TextEdit, Ui, UiBuilder, vec2,
};
use gsk_core::plc::{Ladder, PlcAddress};
use gsk_host::kernel::monitor::MachineView;
use gsk_runner::ladder::address_comment;

use super::directive::LadderTable;
use super::draft::LadderDraft;
use super::{LadderView, compiler_text, operand_value};
use crate::focus;
use crate::theme;
use gsk_messages::{Language, Message, say};

/// Height of a table row, points.
const ROW_HEIGHT: f32 = 22.0;

/// Heading and width in points of a column. The last column takes the remaining width.
type TableColumn = (Message, f32);

impl LadderView {
    pub(super) fn show_messages(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        self.show_row_editor(ui, language, LadderTable::Messages);
        let ladder = self.drawn_ladder(machine);
        let columns = [
            (say::ladder_column_message_address(), 110.0),
            (say::ladder_column_message_number(), 90.0),
            (say::ladder_column_state(), 70.0),
            (say::ladder_column_message_text(), 0.0),
        ];
        let messages = ladder.messages();
        let clicked = show_table(ui, language, &columns, messages.len(), |index| {
            let Some(message) = messages.get(index) else {
                return Vec::new();
            };
            let on = machine.plc.memory().bit(message.bit);
            let colour = if on { theme::FORCED } else { theme::ROW_TEXT };
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
            self.row_fields = vec![message.bit.to_string(), number, message.text.clone()];
            self.show_first_use(&ladder, PlcAddress::Bit(message.bit));
        }
    }

    pub(super) fn show_comments(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        self.show_row_editor(ui, language, LadderTable::Comments);
        let ladder = self.drawn_ladder(machine);
        let columns = [
            (say::ladder_column_address(), 110.0),
            (say::ladder_column_uses(), 60.0),
            (say::ladder_column_chinese_comment(), 260.0),
            (say::ladder_column_english_comment(), 0.0),
        ];
        let comments = ladder.comments();
        let clicked = show_table(ui, language, &columns, comments.len(), |index| {
            let Some(comment) = comments.get(index) else {
                return Vec::new();
            };
            let uses = self
                .use_counts
                .binary_search_by_key(&comment.subject, |(subject, _)| *subject);
            let uses = uses
                .ok()
                .and_then(|at| self.use_counts.get(at))
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
            self.row_fields = vec![comment.subject.to_string(), zh, en];
            self.show_first_use(&ladder, comment.subject);
        }
    }

    pub(super) fn show_start_values(
        &mut self,
        ui: &mut Ui,
        language: Language,
        machine: &MachineView,
    ) {
        self.show_row_editor(ui, language, LadderTable::StartValues);
        let ladder = self.drawn_ladder(machine);
        let columns = [
            (say::ladder_column_address(), 110.0),
            (say::ladder_column_initial_value(), 120.0),
            (say::ladder_column_value_now(), 140.0),
            (say::ladder_column_comment(), 0.0),
        ];
        let values = ladder.start_values();
        let clicked = show_table(ui, language, &columns, values.len(), |index| {
            let Some(start) = values.get(index) else {
                return Vec::new();
            };
            let now = operand_value::format_value(start.address, 1, machine.plc.memory());
            let words = address_comment(&ladder, PlcAddress::Byte(start.address), language);
            vec![
                RichText::new(start.address.to_string()).monospace(),
                RichText::new(start.value.to_string()).monospace(),
                RichText::new(now).monospace().color(theme::LADDER_LIVE),
                RichText::new(words),
            ]
        });
        if let Some(start) = clicked.and_then(|index| values.get(index)) {
            self.row_fields = vec![start.address.to_string(), start.value.to_string()];
            self.show_first_use(&ladder, PlcAddress::Byte(start.address));
        }
    }

    /// Shows the first use of an address in the rungs, except while the ladder is edited.
    fn show_first_use(&mut self, ladder: &Ladder, subject: PlcAddress) {
        if self.is_editing {
            return;
        }
        self.search_address(ladder, subject);
        if let Some(first) = ladder.references(subject).first() {
            self.select_statement(ladder, first.statement);
        }
    }

    /// Draws the fields of the row that was clicked, or of a new row, with buttons that write
    /// and delete it.
    fn show_row_editor(&mut self, ui: &mut Ui, language: Language, kind: LadderTable) {
        let names: Vec<String> = kind
            .field_names()
            .iter()
            .map(|it| it.text(language))
            .collect();
        self.row_fields.resize(names.len(), String::new());
        if !self.is_editing {
            return;
        }
        let mut list = None;
        let panel = Panel::bottom("row editor").frame(crate::views::side_frame());
        panel.show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                for (at, (name, text)) in names.iter().zip(&mut self.row_fields).enumerate() {
                    ui.label(RichText::new(name).weak());
                    let is_text =
                        at > 0 && kind != LadderTable::StartValues && names.len() - at < 3;
                    let is_long = is_text && !(kind == LadderTable::Messages && at == 1);
                    let width = if is_long { 260.0 } else { 90.0 };
                    let response = ui.add(TextEdit::singleline(text).desired_width(width));
                    response.widget_info(|| {
                        egui::WidgetInfo::labeled(egui::Role::TextInput, true, name)
                    });
                }
                let source = self.draft.as_ref().map_or("", LadderDraft::text);
                let write = say::ladder_write_row().text(language);
                let hint = say::ladder_write_row_hint().text(language);
                if ui.button(write).on_hover_text(hint).clicked() {
                    list = Some(kind.with_row(source, &self.row_fields));
                }
                if ui.button(say::ladder_delete_row().text(language)).clicked() {
                    let address = self.row_fields.first().map_or("", String::as_str);
                    list = Some(Ok(kind.without_row(source, address)));
                }
            });
            if let Some(complaint) = &self.row_error {
                ui.label(RichText::new(complaint).color(theme::LADDER_ERROR_TEXT));
            }
        });
        if let Some(list) = list {
            self.row_error = match list {
                Ok(list) => self.take_list(list, language),
                Err(wrong) => Some(wrong.text(language)),
            };
        }
    }

    /// Takes a changed list into the draft if it compiles; otherwise returns the first error.
    pub(super) fn take_list(&mut self, list: String, language: Language) -> Option<String> {
        if let Err(errors) = Ladder::compile(&list) {
            let first = errors.errors.first();
            return Some(first.map_or_else(String::new, |error| {
                compiler_text::finding_text(error, language)
            }));
        }
        if let Some(draft) = &mut self.draft {
            draft.set_text(list, None);
        }
        None
    }
}

/// Draws a table with `count` rows; `row` returns the texts of a row. Returns the index of the row
/// that was clicked; `None` without one.
pub(super) fn show_table(
    ui: &mut Ui,
    language: Language,
    columns: &[TableColumn],
    count: usize,
    row: impl Fn(usize) -> Vec<RichText>,
) -> Option<usize> {
    let mut clicked = None;
    ui.add_space(6.0);
    let heads = columns
        .iter()
        .map(|(head, _)| RichText::new(head.text(language)).weak());
    draw_row(ui, columns, heads.collect());
    ui.separator();
    let name = columns.iter().map(|(head, _)| head.text(language));
    let name = name.collect::<Vec<_>>().join("  ");
    let list = focus::FocusList::begin(ui, "table", &name, count, None);
    ScrollArea::vertical()
        .auto_shrink([false, false])
        .show_rows(ui, ROW_HEIGHT, count, |ui, rows| {
            list.scroll_to_cursor(ui, rows.start, ROW_HEIGHT);
            for index in rows {
                let texts = row(index);
                let name = texts
                    .iter()
                    .map(RichText::text)
                    .collect::<Vec<_>>()
                    .join("  ");
                let rect = draw_row(ui, columns, texts);
                let id = ui.scope_id().with(("row", index));
                let response = ui.interact(rect, id, focus::ROW_SENSE);
                let role = egui::Role::ListBoxOption;
                response.widget_info(|| egui::WidgetInfo::labeled(role, true, &name));
                if response.hovered() {
                    let shade = theme::row_hover();
                    ui.painter().rect_filled(rect, 2.0, shade);
                }
                if list.show_cursor(ui, index, &response) {
                    clicked = Some(index);
                }
            }
        });
    clicked.or(list.entered_row())
}

/// Draws one row of texts and returns its rectangle.
fn draw_row(ui: &mut Ui, columns: &[TableColumn], texts: Vec<RichText>) -> egui::Rect {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW_HEIGHT), Sense::HOVER);
    let mut left = rect.left() + 10.0;
    for ((_, width), text) in columns.iter().zip(texts) {
        let right = if *width > 0.0 {
            left + width
        } else {
            rect.right()
        };
        let cell = egui::Rect::from_x_y_ranges(left..=right - 6.0, rect.y_range());
        let content = UiBuilder::new()
            .max_rect(cell)
            .layout(Layout::left_to_right(Align::Center));
        ui.scope_builder(content, |ui| {
            ui.add(Label::new(text).truncate().selectable(false))
        });
        left = right;
    }
    rect
}
