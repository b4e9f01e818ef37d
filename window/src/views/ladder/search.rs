//! Searches the ladder as GSKCC does: for an address, an instruction or a comment, with a list of
//! the matches; goes to a row (manual PLC-III 3.2.2).

use egui::{Panel, RichText, Ui};
use gsk_core::plc::{Ladder, PlcAddress};
use gsk_messages::{Language, Message, say};
use gsk_runner::ladder::{LadderMatches, SearchDirection, search_ladder};

use super::LadderView;
use super::tables::show_table;
use crate::widgets::field_menu::field_menu;

/// The search text of the ladder view and its results.
#[derive(Clone, Debug, Default)]
pub struct LadderSearch {
    text: String,
    scope: SearchScope,
    found: LadderMatches,
    /// Index of the match that is shown.
    shown_index: usize,
    is_done: bool,
    /// Row to go to, and optionally a column, as typed.
    go_to_entry: String,
}

/// The part of the ladder that is searched, relative to the selected rung.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum SearchScope {
    #[default]
    All,
    Up,
    Down,
}

impl SearchScope {
    const ALL: [Self; 3] = [Self::All, Self::Up, Self::Down];

    fn name(self) -> Message {
        match self {
            Self::All => say::ladder_search_all(),
            Self::Up => say::ladder_search_up(),
            Self::Down => say::ladder_search_down(),
        }
    }
}

impl LadderSearch {
    /// Clears the search results but keeps the search text.
    pub fn clear(&mut self) {
        self.found = LadderMatches::default();
        self.is_done = false;
    }

    /// The address that is searched for; `None` if the text is not an address.
    pub const fn searched_address(&self) -> Option<PlcAddress> {
        self.found.address
    }

    /// Searches a ladder for the text and selects the first match. `row` is the selected rung.
    fn find_all(&mut self, ladder: &Ladder, row: u32) {
        let direction = match self.scope {
            SearchScope::All => SearchDirection::All,
            SearchScope::Up => SearchDirection::Up(row),
            SearchScope::Down => SearchDirection::Down(row),
        };
        self.found = search_ladder(ladder, &self.text, direction);
        self.shown_index = 0;
        self.is_done = true;
    }
}

/// Parses a row, and optionally a column: `12`, `12,3`.
fn parse_row(text: &str) -> Option<(u32, usize)> {
    let mut numbers = text.split([',', ' ', '，']).filter(|it| !it.is_empty());
    let row = numbers.next()?.parse().ok()?;
    let column = numbers.next().map_or(Ok(1), str::parse).ok()?;
    Some((row, column))
}

impl LadderView {
    pub(super) fn show_search_field(&mut self, ui: &mut Ui, language: Language, ladder: &Ladder) {
        let name = say::ladder_find().text(language);
        let field = egui::TextEdit::singleline(&mut self.search.text)
            .desired_width(160.0)
            .hint_text(say::ladder_find_hint().text(language));
        let response = ui.add(field);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &name));
        if response.changed() {
            self.search.is_done = false;
        }
        let before = self.search.scope;
        egui::ComboBox::from_id_salt("search scope")
            .width(56.0)
            .selected_text(before.name().text(language))
            .show_ui(ui, |ui| {
                for scope in SearchScope::ALL {
                    let text = scope.name().text(language);
                    ui.selectable_value(&mut self.search.scope, scope, text);
                }
            });
        if self.search.scope != before {
            self.search.is_done = false;
        }
        let entered =
            response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        if (ui.button(name).clicked() || entered) && !self.search.text.trim().is_empty() {
            if self.search.is_done {
                self.show_match(ladder, 1);
            } else {
                let row = self.selected_row(ladder);
                self.search.find_all(ladder, row);
                self.show_match(ladder, 0);
            }
            if entered {
                response.request_focus();
            }
        }
        let count = self.search.found.matches.len();
        for (sign, words, step) in [
            ("◀", say::ladder_find_previous().text(language), -1),
            ("▶", say::ladder_find_next().text(language), 1),
        ] {
            let button = ui.add_enabled(count > 0, egui::Button::new(sign));
            button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, count > 0, &words));
            if button.on_hover_text(words).clicked() {
                self.show_match(ladder, step);
            }
        }
        if self.search.is_done {
            let words = if count == 0 {
                say::ladder_not_found().text(language)
            } else {
                format!("{} / {count}", self.search.shown_index + 1)
            };
            ui.label(RichText::new(words).weak());
        }
        ui.separator();
        field_menu(ui, say::ladder_go_to().text(language), |ui| {
            self.show_go_to_menu(ui, language, ladder);
        });
    }

    /// Draws 转到: a row and column, the start and the end of the program.
    fn show_go_to_menu(&mut self, ui: &mut Ui, language: Language, ladder: &Ladder) {
        let last = ladder.rung_count();
        let mut target = None;
        ui.horizontal(|ui| {
            let name = say::ladder_go_to_row().text(language);
            ui.label(&name);
            let field = egui::TextEdit::singleline(&mut self.search.go_to_entry)
                .desired_width(70.0)
                .hint_text(format!("1–{last}"));
            let response = ui.add(field);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &name));
            let entered =
                response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            let typed = parse_row(&self.search.go_to_entry);
            let go = egui::Button::new(say::ladder_go().text(language));
            if ui.add_enabled(typed.is_some(), go).clicked() || entered {
                target = typed;
            }
        });
        if ui
            .button(say::ladder_go_to_start().text(language))
            .clicked()
        {
            target = Some((1, 1));
        }
        if ui.button(say::ladder_go_to_end().text(language)).clicked() {
            target = Some((last, 1));
        }
        if let Some((row, column)) = target {
            self.go_to_row(ladder, row, column);
            ui.close();
        }
    }

    /// Selects the element in a row and column, both from 1, and scrolls to it. A row or column
    /// beyond the end is the last one.
    fn go_to_row(&mut self, ladder: &Ladder, row: u32, column: usize) {
        let row = row.clamp(1, ladder.rung_count().max(1));
        let Some(network) = ladder.network(row) else {
            return;
        };
        let count = network.statements().len();
        let at_column = |at: &usize| network.column(*at) == column;
        let at = (0..count).find(at_column).unwrap_or(match column {
            1 => 0,
            _ => count.saturating_sub(1),
        });
        self.select_statement(ladder, network.first + at);
    }

    /// Number of the selected rung; 1 without a selection.
    fn selected_row(&self, ladder: &Ladder) -> u32 {
        let selected = self.selected.and_then(|at| ladder.statements().get(at));
        selected.map_or(1, |statement| statement.rung)
    }

    /// Draws the list of the matches below the rungs. A click shows the match.
    pub(super) fn show_search_results(&mut self, ui: &mut Ui, language: Language, ladder: &Ladder) {
        let matches = &self.search.found.matches;
        if !self.search.is_done || matches.is_empty() {
            return;
        }
        let mut clicked = None;
        let mut is_closed = false;
        let results = Panel::bottom("ladder results")
            .default_size(140.0)
            .size_range(60.0..=300.0)
            .resizable(true)
            .frame(crate::views::side_frame());
        crate::focus::skip_resize_edge(ui, "ladder results");
        results.show(ui, |ui| {
            ui.horizontal(|ui| {
                let last = self.search.found.messages(&self.search.text).pop();
                ui.label(last.map_or_else(String::new, |last| last.text(language)));
                let name = say::ladder_search_close().text(language);
                let close = ui.small_button("×");
                close.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
                is_closed = close.on_hover_text(name).clicked();
            });
            let columns = [
                (say::ladder_column_match(), 60.0),
                (say::ladder_column_row(), 60.0),
                (say::ladder_column_column(), 60.0),
                (say::ladder_column_instruction(), 0.0),
            ];
            clicked = show_table(ui, language, &columns, matches.len(), |index| {
                let Some(found) = matches.get(index) else {
                    return Vec::new();
                };
                let statement = ladder.statements().get(found.statement);
                let statement = statement.map_or_else(String::new, ToString::to_string);
                let cells = [
                    (index + 1).to_string(),
                    found.row.to_string(),
                    found.column.to_string(),
                    statement,
                ];
                let is_shown = index == self.search.shown_index;
                let cell = |text| match is_shown {
                    true => RichText::new(text).monospace().strong(),
                    false => RichText::new(text).monospace(),
                };
                cells.into_iter().map(cell).collect()
            });
        });
        if let Some(index) = clicked {
            self.search.shown_index = index;
            self.show_match(ladder, 0);
        }
        if is_closed {
            self.search.clear();
        }
    }

    /// Searches for an address as if the user had typed it.
    pub(super) fn search_address(&mut self, ladder: &Ladder, subject: PlcAddress) {
        self.search.text = subject.to_string();
        self.search.scope = SearchScope::All;
        self.search.find_all(ladder, 1);
    }

    fn show_match(&mut self, ladder: &Ladder, step: i64) {
        let count = self.search.found.matches.len() as i64;
        if count == 0 {
            return;
        }
        let at = (self.search.shown_index as i64 + step).rem_euclid(count);
        self.search.shown_index = usize::try_from(at).unwrap_or(0);
        let shown = self.search.found.matches.get(self.search.shown_index);
        if let Some(statement) = shown.map(|found| found.statement) {
            self.select_statement(ladder, statement);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_typed_with_or_without_a_column() {
        assert_eq!(parse_row("12"), Some((12, 1)));
        assert_eq!(parse_row(" 8, 3 "), Some((8, 3)));
        assert_eq!(parse_row("8，2"), Some((8, 2)));
        assert_eq!(parse_row("x"), None);
        assert_eq!(parse_row(""), None);
    }
}
