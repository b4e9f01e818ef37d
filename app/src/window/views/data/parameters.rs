//! Shows the parameters: a list by number or by function, and the selected parameter with its
//! value, bits and help topic.

use egui::{
    CentralPanel, Color32, Grid, Label, Panel, Response, RichText, Role, ScrollArea, Sense,
    TextEdit, TextStyle, TextWrapMode, Ui, WidgetInfo, WidgetText, pos2, vec2,
};
use gsk_core::memory::{self, Disk, Effective, ParameterRow};
use gsk_help::{Subject, Topic, search_among, subject_name, topic};
use gsk_messages::{Language, say};

use super::edit::{Drafts, Spot, is_state, parameter_text};
use super::values::Values;
use super::{Kind, Page, TYPED, field};
use crate::window::focus;
use crate::window::help::show_article;

/// Height of a row of the list, points.
const LINE: f32 = 22.0;
/// Widths of the columns, points: mark, number, name, value, delivered value.
const COLUMNS: [f32; 5] = [14.0, 52.0, 118.0, 78.0, 78.0];
/// Below this width, points, the list omits the names and the delivered values: the meaning of
/// a parameter is more important.
const NARROW: f32 = 560.0;
const NARROW_COLUMNS: [f32; 5] = [14.0, 52.0, 0.0, 78.0, 0.0];
/// From this width of the view, points, the selected parameter is beside the list.
const BESIDE: f32 = 700.0;
/// Size of the selected parameter: its width beside the list, its share of the height below
/// the list, and its height there while none is selected (two lines), points.
const DETAILS: f32 = 330.0;
const SHARE: f32 = 0.45;
const UNCHOSEN: f32 = 44.0;
/// Width of the field of a value, points.
const VALUE: f32 = 110.0;

/// Colour of a value that differs from the delivered one.
const OTHER: Color32 = Color32::from_rgb(120, 190, 255);

/// The list and the selected parameter.
#[derive(Debug, Default)]
pub struct Parameters {
    question: String,
    /// The last query and the topics found.
    found: (String, Vec<&'static Topic>),
    /// Whether the list shows only values that differ from the delivered ones.
    changed: bool,
    /// Number and bit of the selected parameter.
    chosen: Option<(u16, Option<u8>)>,
}

impl Parameters {
    /// Draws the list and the selected parameter.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: Language,
        machine: &Values<'_>,
        page: Page,
        drafts: &mut Drafts,
    ) {
        let frame = egui::Frame::new().inner_margin(4.0);
        let details = match ui.available_width() >= BESIDE {
            true => Panel::right("parameter beside").exact_size(DETAILS),
            false => {
                let height = match self.chosen {
                    Some(_) => ui.available_height() * SHARE,
                    None => UNCHOSEN,
                };
                Panel::bottom("parameter below").exact_size(height)
            }
        };
        details.resizable(false).frame(frame).show(ui, |ui| {
            // A scroll area would be higher than this text.
            if self.chosen.is_none() {
                ui.label(say::data_choose().text(language));
                return;
            }
            ScrollArea::vertical()
                .id_salt("parameter")
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    self.details(ui, language, machine, drafts);
                    focus::follow(ui);
                });
        });
        CentralPanel::default()
            .frame(frame)
            .show(ui, |ui| self.list(ui, language, machine, page, drafts));
    }

    /// The rows of a page, or the search result.
    fn rows(&mut self, page: Page, machine: &Values<'_>) -> Vec<&'static ParameterRow> {
        let mut rows: Vec<&ParameterRow> = if self.question.trim().is_empty() {
            match page {
                Page::Group(group) => group.rows().to_vec(),
                Page::Numbers(kind) => {
                    let whole = memory::rows().iter().filter(|row| row.bit.is_none());
                    let of_kind = |row: &&ParameterRow| match kind {
                        Kind::All => true,
                        Kind::State => row.state,
                        Kind::Data => !row.state,
                    };
                    whole.filter(of_kind).collect()
                }
                Page::Offsets | Page::Pitch | Page::Variables => Vec::new(),
            }
        } else {
            if self.found.0 != self.question {
                let parameter =
                    |it: Subject<'_>| matches!(it, Subject::Parameter(_) | Subject::Bit(..));
                let found = search_among(&self.question, parameter);
                self.found = (self.question.clone(), found);
            }
            let found = self.found.1.iter();
            let row = |topic: &&Topic| match topic.subject {
                Subject::Parameter(number) => memory::row(number, None),
                Subject::Bit(number, bit) => memory::row(number, Some(bit)),
                _ => None,
            };
            found.filter_map(row).collect()
        };
        if self.changed {
            rows.retain(|row| differs(row, machine));
        }
        rows
    }

    fn list(
        &mut self,
        ui: &mut Ui,
        language: Language,
        machine: &Values<'_>,
        page: Page,
        drafts: &Drafts,
    ) {
        let hint = say::data_search().text(language);
        let field = TextEdit::singleline(&mut self.question).hint_text(hint);
        let field = ui.add(field.desired_width(f32::INFINITY));
        let name = say::data_search_name().text(language);
        let question = self.question.clone();
        field.widget_info(|| WidgetInfo {
            current_text_value: Some(question.clone()),
            ..WidgetInfo::labeled(Role::TextInput, true, &name)
        });
        if field.has_focus() && ui.input(|input| input.key_pressed(egui::Key::Escape)) {
            self.question.clear();
        }
        let rows = self.rows(page, machine);
        ui.horizontal_wrapped(|ui| {
            let words = say::data_changed_only().text(language);
            ui.checkbox(&mut self.changed, words);
            ui.weak(say::data_matches(rows.len()).text(language));
        });
        if rows.is_empty() && !self.question.trim().is_empty() {
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
        let (place, _) = ui.allocate_exact_size(vec2(ui.available_width(), LINE), Sense::HOVER);
        put(ui, place, headings.map(|text| (text, weak)));
        let own = |row: &&ParameterRow| (row.number, row.bit);
        let chosen = self.chosen;
        let chosen = rows.iter().position(|row| Some(own(row)) == chosen);
        let name = say::data_list_name().text(language);
        let list = focus::List::begin(ui, "parameter list", &name, rows.len(), chosen);
        if let Some(row) = list.moved().and_then(|at| rows.get(at)) {
            self.chosen = Some(own(row));
        }
        ScrollArea::vertical()
            .id_salt("parameters")
            .auto_shrink([false, false])
            .show_rows(ui, LINE, rows.len(), |ui, shown| {
                list.follow(ui, shown.start, LINE);
                let rows = rows.iter().copied().enumerate();
                for (at, row) in rows.skip(shown.start).take(shown.len()) {
                    let response = self.row(ui, language, machine, drafts, row);
                    if list.row(ui, at, &response) {
                        self.chosen = Some(own(&row));
                    }
                }
            });
    }

    fn row(
        &self,
        ui: &mut Ui,
        language: Language,
        machine: &Values<'_>,
        drafts: &Drafts,
        row: &'static ParameterRow,
    ) -> Response {
        let own = (row.number, row.bit);
        let spot = Spot::Parameter(row.number);
        let typed = drafts.has(spot);
        let other = differs(row, machine);
        let text = drafts.text(spot, machine);
        let value = match row.bit {
            Some(bit) => bit_of(&text, bit).map_or_else(|| "?".to_owned(), |on| digit(on).into()),
            None => text,
        };
        let delivered = match row.bit {
            Some(_) => row.factory(Disk::N0).to_string(),
            None => parameter_text(row.number, row.factory(Disk::N0)),
        };
        let number = match row.bit {
            Some(bit) => format!("{:03}.{bit}", row.number),
            None => format!("{:03}", row.number),
        };
        let meaning = meaning(row, language);
        let (place, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), LINE), focus::ROW);
        let chosen = self.chosen == Some(own);
        let said = match other {
            true => format!(
                "{number} {} {value} {} {meaning}",
                row.symbol,
                say::data_differs().text(language)
            ),
            false => format!("{number} {} {value} {meaning}", row.symbol),
        };
        response.widget_info(|| WidgetInfo::selected(Role::ListBoxOption, true, chosen, &said));
        let fill = match (chosen, response.hovered()) {
            (true, _) => ui.visuals().selection.bg_fill,
            (false, true) => ui.visuals().widgets.hovered.weak_bg_fill,
            (false, false) => Color32::TRANSPARENT,
        };
        ui.painter().rect_filled(place, 2.0, fill);
        let ink = Color32::from_gray(215);
        let of_value = match (typed, other) {
            (true, _) => TYPED,
            (false, true) => OTHER,
            (false, false) => ink,
        };
        if other {
            let middle = pos2(place.left() + COLUMNS[0] / 2.0, place.center().y);
            ui.painter().circle_filled(middle, 3.0, OTHER);
        }
        let weak = ui.visuals().weak_text_color();
        let cells = [
            (String::new(), ink),
            (number, ink),
            (row.symbol.to_owned(), ink),
            (value, of_value),
            (delivered, weak),
            (meaning, ink),
        ];
        put(ui, place, cells);
        response
    }

    /// Draws the selected parameter.
    fn details(&self, ui: &mut Ui, language: Language, machine: &Values<'_>, drafts: &mut Drafts) {
        let Some((number, bit)) = self.chosen else {
            return;
        };
        let Some(row) = memory::row(number, None) else {
            return;
        };
        let spot = Spot::Parameter(number);
        ui.horizontal_wrapped(|ui| {
            ui.strong(say::help_parameter(format!("{number:03}")).text(language));
            field::show(ui, language, machine, drafts, spot, VALUE);
            ui.label(row.unit);
        });
        let text = drafts.text(spot, machine);
        if drafts.has(spot)
            && let Err(said) = spot.read(&text, machine)
        {
            ui.label(RichText::new(said.text(language)).color(super::WRONG));
        }
        if is_state(number) {
            bits(ui, language, machine, drafts, number);
        }
        ui.separator();
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
fn bits(ui: &mut Ui, language: Language, machine: &Values<'_>, drafts: &mut Drafts, number: u16) {
    let spot = Spot::Parameter(number);
    let text = drafts.text(spot, machine);
    // While the typed text is invalid, the boxes show the current value.
    let readable = (0..8).all(|bit| bit_of(&text, bit).is_some());
    let byte = match readable {
        true => u8::from_str_radix(&text, 2).unwrap_or(0),
        false => machine.parameters.byte(number),
    };
    Grid::new("bits")
        .num_columns(2)
        .striped(true)
        .show(ui, |ui| {
            for bit in (0..8).rev() {
                let row = memory::row(number, Some(bit));
                let mut on = byte >> bit & 1 != 0;
                let label = format!("{bit} {}", row.map_or("***", |row| row.symbol));
                let meaning = match row {
                    Some(_) => subject_name(Subject::Bit(number, bit), language),
                    None => say::data_bit_unused().text(language),
                };
                let check = ui.checkbox(&mut on, RichText::new(label).monospace());
                let called = format!("{number:03}.{bit} {meaning}");
                check.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, on, &called));
                if check.changed() {
                    let changed = byte & !(1 << bit) | u8::from(on) << bit;
                    drafts.set(spot, format!("{changed:08b}"));
                    drafts.left(spot, machine);
                }
                ui.vertical(|ui| {
                    ui.set_width(ui.available_width());
                    ui.add(Label::new(meaning).wrap());
                    let late = row.map(|row| row.effective);
                    if matches!(late, Some(Effective::AtPowerOn { .. })) {
                        let words = say::help_at_power_on().text(language);
                        ui.label(RichText::new(words).color(OTHER));
                    }
                });
                ui.end_row();
            }
        });
}

/// A bit of eight binary digits; `None` if the text has another form.
fn bit_of(text: &str, bit: u8) -> Option<bool> {
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

/// The meaning of a parameter. For a state parameter in Chinese it is the list of its bit
/// names: the Chinese manual describes only the bits.
fn meaning(row: &ParameterRow, language: Language) -> String {
    if language == Language::En {
        return row.meaning_en.to_owned();
    }
    let bits = memory::rows().iter();
    let bits = bits.filter(|it| it.number == row.number && it.bit.is_some());
    let names: Vec<&str> = bits.map(|it| it.symbol).collect();
    match row.bit.is_none() && !names.is_empty() {
        true => names.join(" "),
        false => row.meaning_zh.to_owned(),
    }
}

/// Whether the value of the control differs from the delivered one.
fn differs(row: &ParameterRow, machine: &Values<'_>) -> bool {
    let own = match row.bit {
        Some(bit) => i32::from(machine.parameters.bit(row.number, bit)),
        None => machine.parameters.value(row.number),
    };
    own != row.factory(Disk::N0)
}

/// Draws the texts of a row in its columns. A text that does not fit ends in an ellipsis.
fn put(ui: &Ui, place: egui::Rect, cells: [(String, Color32); 6]) {
    let mut left = place.left() + 2.0;
    let columns = match place.width() < NARROW {
        true => NARROW_COLUMNS,
        false => COLUMNS,
    };
    let widths = columns.into_iter().chain([f32::INFINITY]);
    for ((text, colour), width) in cells.into_iter().zip(widths) {
        let room = width.min(place.right() - left) - 6.0;
        if room > 8.0 && !text.is_empty() {
            let text = WidgetText::from(RichText::new(text).color(colour));
            let wrap = Some(TextWrapMode::Truncate);
            let galley = text.into_galley(ui, wrap, room, TextStyle::Body);
            let top = place.center().y - galley.size().y / 2.0;
            ui.painter().galley(pos2(left, top), galley, colour);
        }
        left += width;
    }
}
