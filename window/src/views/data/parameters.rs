//! Shows the parameters: a list by number or by function, and the selected parameter with its
//! value, bits and help topic.

use egui::text::LayoutJob;
use egui::{
    CentralPanel, Color32, Grid, Label, Panel, Response, RichText, Role, ScrollArea, Sense,
    TextEdit, TextStyle, Ui, WidgetInfo, pos2, vec2,
};
use gsk_core::memory::{self, ControlParameters, EffectiveTime, ElectronicDisk, ParameterRow};
use gsk_help::{Subject, Topic, search_among, subject_name, topic};
use gsk_messages::{Language, say};

use super::data_values::DataValues;
use super::edit::{DataField, Drafts, is_state_parameter, parameter_text};
use super::{DataPage, ParameterKind, value_field};
use crate::focus;
use crate::help::show_article;
use crate::theme;

/// Height of a row of the list, points.
const ROW_HEIGHT: f32 = 22.0;
/// Width of a list below which a long meaning takes two lines, points.
const TWO_LINE_WIDTH: f32 = 760.0;
/// Height of a row in a narrow list, where a long meaning takes two lines, points.
const NARROW_ROW_HEIGHT: f32 = 38.0;
/// Widths of the columns, points: mark, number, name, value, delivered value. The meaning
/// takes the rest.
const COLUMN_WIDTHS: [f32; 5] = [14.0, 52.0, 118.0, 78.0, 78.0];
/// Width of the list, points, below which the names and the delivered values are omitted: the
/// meaning of a parameter is more important.
const NARROW_WIDTH: f32 = 560.0;
const NARROW_COLUMN_WIDTHS: [f32; 5] = [14.0, 52.0, 0.0, 78.0, 0.0];
/// Width of the view, points, from which the selected parameter is beside the list.
const SIDE_BY_SIDE_WIDTH: f32 = 700.0;
/// Width of the details of the selected parameter beside the list, points. The constants after
/// it are their share of the height below the list, and their height there while none is
/// selected (two lines), points.
const DETAILS_WIDTH: f32 = 330.0;
const DETAILS_HEIGHT_SHARE: f32 = 0.45;
const UNSELECTED_HEIGHT: f32 = 44.0;
/// Width of the field for a parameter value, points.
const VALUE_WIDTH: f32 = 110.0;

/// The page with the list of parameters and the selected parameter.
#[derive(Debug, Default)]
pub struct ParameterSheet {
    query: String,
    /// The last query and the help topics found for it.
    search_result: (String, Vec<&'static Topic>),
    /// Whether the list shows only values that differ from the delivered ones.
    shows_changed_only: bool,
    /// Number and bit of the selected parameter; the bit is `None` for the whole parameter.
    selected: Option<(u16, Option<u8>)>,
}

impl ParameterSheet {
    /// Draws the list of parameters and the selected parameter.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: Language,
        machine: &DataValues<'_>,
        page: DataPage,
        drafts: &mut Drafts,
    ) {
        let frame = egui::Frame::new().inner_margin(4.0);
        let details = match ui.available_width() >= SIDE_BY_SIDE_WIDTH {
            true => Panel::right("parameter beside").exact_size(DETAILS_WIDTH),
            false => {
                let height = match self.selected {
                    Some(_) => ui.available_height() * DETAILS_HEIGHT_SHARE,
                    None => UNSELECTED_HEIGHT,
                };
                Panel::bottom("parameter below").exact_size(height)
            }
        };
        details.resizable(false).frame(frame).show(ui, |ui| {
            // A scroll area would be higher than this text.
            if self.selected.is_none() {
                ui.label(say::data_choose().text(language));
                return;
            }
            ScrollArea::vertical()
                .id_salt("parameter")
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    self.show_details(ui, language, machine, drafts);
                    focus::scroll_to_focus(ui);
                });
        });
        CentralPanel::default()
            .frame(frame)
            .show(ui, |ui| self.show_list(ui, language, machine, page, drafts));
    }

    /// The rows of a page, or those of the search result if the operator has typed a query.
    fn find_rows(
        &mut self,
        page: DataPage,
        machine: &DataValues<'_>,
    ) -> Vec<&'static ParameterRow> {
        let mut rows: Vec<&ParameterRow> = if self.query.trim().is_empty() {
            match page {
                DataPage::Group(group) => group.rows().to_vec(),
                DataPage::Numbers(kind) => {
                    let parameters = memory::parameter_rows()
                        .iter()
                        .filter(|row| row.bit.is_none());
                    let is_of_kind = |row: &&ParameterRow| match kind {
                        ParameterKind::All => true,
                        ParameterKind::State => row.state,
                        ParameterKind::Data => !row.state,
                    };
                    parameters.filter(is_of_kind).collect()
                }
                DataPage::Offsets | DataPage::Pitch | DataPage::Variables => Vec::new(),
            }
        } else {
            if self.search_result.0 != self.query {
                let is_parameter =
                    |it: Subject<'_>| matches!(it, Subject::Parameter(_) | Subject::Bit(..));
                let found = search_among(&self.query, is_parameter);
                self.search_result = (self.query.clone(), found);
            }
            let found = self.search_result.1.iter();
            let row = |topic: &&Topic| match topic.subject {
                Subject::Parameter(number) => memory::parameter_row(number, None),
                Subject::Bit(number, bit) => memory::parameter_row(number, Some(bit)),
                _ => None,
            };
            found.filter_map(row).collect()
        };
        if self.shows_changed_only {
            rows.retain(|row| is_changed(row, machine));
        }
        rows
    }

    fn show_list(
        &mut self,
        ui: &mut Ui,
        language: Language,
        machine: &DataValues<'_>,
        page: DataPage,
        drafts: &Drafts,
    ) {
        let hint = say::data_search().text(language);
        let field = TextEdit::singleline(&mut self.query).hint_text(hint);
        let field = ui.add(field.desired_width(f32::INFINITY));
        let name = say::data_search_name().text(language);
        let query = self.query.clone();
        field.widget_info(|| WidgetInfo {
            current_text_value: Some(query.clone()),
            ..WidgetInfo::labeled(Role::TextInput, true, &name)
        });
        if field.has_focus() && ui.input(|input| input.key_pressed(egui::Key::Escape)) {
            self.query.clear();
        }
        let rows = self.find_rows(page, machine);
        ui.horizontal_wrapped(|ui| {
            let label = say::data_changed_only().text(language);
            ui.checkbox(&mut self.shows_changed_only, label);
            ui.weak(say::data_matches(rows.len()).text(language));
        });
        if rows.is_empty() && !self.query.trim().is_empty() {
            ui.label(say::data_nothing_found().text(language));
            return;
        }
        let headings = [
            None,
            Some(say::data_column_number()),
            Some(say::data_column_symbol()),
            Some(say::data_column_value()),
            Some(say::data_column_delivered()),
            Some(say::data_column_meaning()),
        ];
        let headings = headings.map(|it| it.map_or_else(String::new, |it| it.text(language)));
        let weak = ui.visuals().weak_text_color();
        let (bounds, _) =
            ui.allocate_exact_size(vec2(ui.available_width(), ROW_HEIGHT), Sense::HOVER);
        show_cells(ui, bounds, headings.map(|text| (text, weak)));
        let key_of = |row: &&ParameterRow| (row.number, row.bit);
        let selected = self.selected;
        let selected_row = rows.iter().position(|row| Some(key_of(row)) == selected);
        let name = say::data_list_name().text(language);
        let list = focus::FocusList::begin(ui, "parameter list", &name, rows.len(), selected_row);
        if let Some(row) = list.moved_row().and_then(|at| rows.get(at)) {
            self.selected = Some(key_of(row));
        }
        let height = row_height(ui.available_width());
        ScrollArea::vertical()
            .id_salt("parameters")
            .auto_shrink([false, false])
            .show_rows(ui, height, rows.len(), |ui, shown| {
                list.scroll_to_cursor(ui, shown.start, height);
                let rows = rows.iter().copied().enumerate();
                for (at, row) in rows.skip(shown.start).take(shown.len()) {
                    let response = self.show_row(ui, language, machine, drafts, row);
                    if list.show_cursor(ui, at, &response) {
                        self.selected = Some(key_of(&row));
                    }
                }
            });
    }

    fn show_row(
        &self,
        ui: &mut Ui,
        language: Language,
        machine: &DataValues<'_>,
        drafts: &Drafts,
        row: &'static ParameterRow,
    ) -> Response {
        let key = (row.number, row.bit);
        let field = DataField::Parameter(row.number);
        let has_draft = drafts.has_draft(field);
        let is_changed = is_changed(row, machine);
        let text = drafts.text(field, machine);
        let value = match row.bit {
            Some(bit) => {
                parse_bit(&text, bit).map_or_else(|| "?".to_owned(), |on| digit(on).into())
            }
            None => text,
        };
        let delivered = match row.bit {
            Some(_) => parameter_value(row, &machine.delivered).to_string(),
            None => parameter_text(row.number, parameter_value(row, &machine.delivered)),
        };
        let number = match row.bit {
            Some(bit) => format!("{:03}.{bit}", row.number),
            None => format!("{:03}", row.number),
        };
        let meaning = meaning(row, language);
        let width = ui.available_width();
        let (bounds, response) =
            ui.allocate_exact_size(vec2(width, row_height(width)), focus::ROW_SENSE);
        let is_selected = self.selected == Some(key);
        let description = match is_changed {
            true => format!(
                "{number} {} {value} {} {meaning}",
                row.symbol,
                say::data_differs().text(language)
            ),
            false => format!("{number} {} {value} {meaning}", row.symbol),
        };
        response.widget_info(|| {
            WidgetInfo::selected(Role::ListBoxOption, true, is_selected, &description)
        });
        let fill = match (is_selected, response.hovered()) {
            (true, _) => ui.visuals().selection.bg_fill,
            (false, true) => ui.visuals().widgets.hovered.weak_bg_fill,
            (false, false) => theme::NO_FILL,
        };
        ui.painter().rect_filled(bounds, 2.0, fill);
        let ink = theme::ROW_TEXT;
        let value_color = match (has_draft, is_changed) {
            (true, _) => theme::UNSAVED_TEXT,
            (false, true) => theme::DIFFERS,
            (false, false) => ink,
        };
        if is_changed {
            let middle = pos2(bounds.left() + COLUMN_WIDTHS[0] / 2.0, bounds.center().y);
            ui.painter().circle_filled(middle, 3.0, theme::DIFFERS);
        }
        let weak = ui.visuals().weak_text_color();
        let cells = [
            (String::new(), ink),
            (number, ink),
            (row.symbol.to_owned(), ink),
            (value, value_color),
            (delivered, weak),
            (meaning, ink),
        ];
        show_cells(ui, bounds, cells);
        response
    }

    /// Draws the fields and the description of the selected parameter.
    fn show_details(
        &self,
        ui: &mut Ui,
        language: Language,
        machine: &DataValues<'_>,
        drafts: &mut Drafts,
    ) {
        let Some((number, bit)) = self.selected else {
            return;
        };
        let Some(row) = memory::parameter_row(number, None) else {
            return;
        };
        let field = DataField::Parameter(number);
        ui.horizontal_wrapped(|ui| {
            ui.strong(say::help_parameter(format!("{number:03}")).text(language));
            value_field::show(ui, language, machine, drafts, field, VALUE_WIDTH);
            ui.label(row.unit);
        });
        let text = drafts.text(field, machine);
        if drafts.has_draft(field)
            && let Err(error) = field.parse(&text, machine)
        {
            ui.label(RichText::new(error.text(language)).color(theme::ERROR_TEXT));
        }
        if is_state_parameter(number) {
            show_bits(ui, language, machine, drafts, number);
        }
        ui.separator();
        for fact in model_facts(row, machine, language) {
            ui.label(RichText::new(fact).color(theme::BRIGHT_TEXT));
        }
        let subjects = [
            bit.map(|bit| Subject::Bit(number, bit)),
            Some(Subject::Parameter(number)),
        ];
        for subject in subjects.into_iter().flatten() {
            if let Some(topic) = topic(subject) {
                show_article(ui, topic, language);
            }
        }
    }
}

/// Draws the check boxes of a state parameter, bit 7 first.
fn show_bits(
    ui: &mut Ui,
    language: Language,
    machine: &DataValues<'_>,
    drafts: &mut Drafts,
    number: u16,
) {
    let field = DataField::Parameter(number);
    let text = drafts.text(field, machine);
    // While the typed text is invalid, the boxes show the current value.
    let is_valid = (0..8).all(|bit| parse_bit(&text, bit).is_some());
    let byte = match is_valid {
        true => u8::from_str_radix(&text, 2).unwrap_or(0),
        false => machine.parameters.byte(number),
    };
    Grid::new("bits")
        .num_columns(2)
        .striped(true)
        .show(ui, |ui| {
            for bit in (0..8).rev() {
                let row = memory::parameter_row(number, Some(bit));
                let mut is_on = byte >> bit & 1 != 0;
                let label = format!("{bit} {}", row.map_or("***", |row| row.symbol));
                let meaning = match row {
                    Some(_) => subject_name(Subject::Bit(number, bit), language),
                    None => say::data_bit_unused().text(language),
                };
                let check = ui.checkbox(&mut is_on, RichText::new(label).monospace());
                let description = format!("{number:03}.{bit} {meaning}");
                check.widget_info(|| {
                    WidgetInfo::selected(Role::CheckBox, true, is_on, &description)
                });
                if check.changed() {
                    let changed = byte & !(1 << bit) | u8::from(is_on) << bit;
                    drafts.set(field, format!("{changed:08b}"));
                    drafts.drop_if_unchanged(field, machine);
                }
                ui.vertical(|ui| {
                    ui.set_width(ui.available_width());
                    ui.add(Label::new(meaning).wrap());
                    let effective = row.map(|row| row.effective);
                    if matches!(effective, Some(EffectiveTime::AtPowerOn { .. })) {
                        let note = say::help_at_power_on().text(language);
                        ui.label(RichText::new(note).color(theme::DIFFERS));
                    }
                });
                ui.end_row();
            }
        });
}

/// Reads a bit out of a text of eight binary digits; `None` if the text has another form.
fn parse_bit(text: &str, bit: u8) -> Option<bool> {
    let at = 7_usize.checked_sub(usize::from(bit))?;
    let digits = text.as_bytes();
    let digit = (digits.len() == 8).then(|| digits.get(at)).flatten()?;
    match digit {
        b'0' => Some(false),
        b'1' => Some(true),
        _ => None,
    }
}

const fn digit(on: bool) -> &'static str {
    if on { "1" } else { "0" }
}

/// The meaning of a parameter in a language. For a state parameter in Chinese it is the list
/// of its bit names, because the Chinese manual describes only the bits.
fn meaning(row: &ParameterRow, language: Language) -> String {
    if language == Language::En {
        return row.meaning_en.to_owned();
    }
    let bits = memory::parameter_rows().iter();
    let bits = bits.filter(|it| it.number == row.number && it.bit.is_some());
    let names: Vec<&str> = bits.map(|it| it.symbol).collect();
    match row.bit.is_none() && !names.is_empty() {
        true => names.join(" "),
        false => row.meaning_zh.to_owned(),
    }
}

/// Whether the current value of a parameter differs from the delivered one.
fn is_changed(row: &ParameterRow, machine: &DataValues<'_>) -> bool {
    parameter_value(row, machine.parameters) != parameter_value(row, &machine.delivered)
}

/// The value of a parameter or of a bit.
fn parameter_value(row: &ParameterRow, parameters: &ControlParameters) -> i32 {
    match row.bit {
        Some(bit) => i32::from(parameters.bit(row.number, bit)),
        None => parameters.value(row.number),
    }
}

/// Range and delivered value of a parameter, where they differ from those of the GSK980TD.
fn model_facts(row: &ParameterRow, machine: &DataValues<'_>, language: Language) -> Vec<String> {
    let record = machine.record;
    let range = record.parameter_range(row.number);
    let range = range.map(|(low, high)| say::help_range(format_args!("{low}..{high}")));
    let value = machine.delivered.value(row.number);
    let is_own = value != row.factory_value(ElectronicDisk::N0);
    let delivered = is_own.then(|| say::help_as_delivered(parameter_text(row.number, value)));
    let facts = range.into_iter().chain(delivered);
    facts
        .map(|fact| format!("{}: {}", record.name(), fact.text(language)))
        .collect()
}

/// Height of a row in a list of this width.
const fn row_height(width: f32) -> f32 {
    match width < TWO_LINE_WIDTH {
        true => NARROW_ROW_HEIGHT,
        false => ROW_HEIGHT,
    }
}

/// Draws the texts of a row in its columns. The meaning, which is last, takes as many lines as
/// the row has. A text that does not fit ends in an ellipsis.
fn show_cells(ui: &Ui, bounds: egui::Rect, cells: [(String, Color32); 6]) {
    let mut left = bounds.left() + 2.0;
    let columns = match bounds.width() < NARROW_WIDTH {
        true => NARROW_COLUMN_WIDTHS,
        false => COLUMN_WIDTHS,
    };
    let widths = columns.into_iter().chain([f32::INFINITY]);
    for ((text, colour), width) in cells.into_iter().zip(widths) {
        let width_left = width.min(bounds.right() - left) - 6.0;
        if width_left > 8.0 && !text.is_empty() {
            let font = TextStyle::Body.resolve(ui.style());
            let mut job = LayoutJob::simple(text, font, colour, width_left);
            let is_meaning = width.is_infinite();
            job.wrap.max_rows = match is_meaning && bounds.height() >= NARROW_ROW_HEIGHT {
                true => 2,
                false => 1,
            };
            job.wrap.break_anywhere = !is_meaning;
            let galley = ui.fonts_mut(|fonts| fonts.layout_job(job));
            let top = bounds.center().y - galley.size().y / 2.0;
            ui.painter().galley(pos2(left, top), galley, colour);
        }
        left += width;
    }
}
