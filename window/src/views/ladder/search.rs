//! Searches the ladder as the manufacturer's tool does: for an address, an instruction or a
//! comment.

use egui::{RichText, Ui};
use gsk_core::plc::address::{BitAddress, ByteAddress};
use gsk_core::plc::{Ladder, PlcAddress};

use super::draw::address_comment;
use super::{LadderView, statement_addresses};
use gsk_messages::{Language, say};

/// The search text of the ladder view and its results.
#[derive(Clone, Debug, Default)]
pub struct LadderSearch {
    text: String,
    address: Option<PlcAddress>,
    /// The statements that were found, as indices in the program.
    matches: Vec<usize>,
    /// Index in `matches` of the statement that is shown.
    shown_index: usize,
    is_done: bool,
}

impl LadderSearch {
    /// Clears the search results but keeps the search text.
    pub fn clear(&mut self) {
        self.matches.clear();
        self.address = None;
        self.is_done = false;
    }

    /// The address that is searched for; `None` if the text is not an address.
    pub const fn searched_address(&self) -> Option<PlcAddress> {
        self.address
    }

    /// Searches a ladder for the text and selects the first match.
    fn find_all(&mut self, ladder: &Ladder) {
        let text = self.text.trim().to_uppercase();
        self.address = parse_address(&text);
        self.shown_index = 0;
        self.is_done = true;
        self.matches = match self.address {
            Some(subject) => {
                let references = ladder.references(subject);
                references
                    .iter()
                    .map(|reference| reference.statement)
                    .collect()
            }
            None => find_by_words(ladder, &text),
        };
    }
}

/// Parses an address of a bit or byte; `None` if the text is not one.
fn parse_address(text: &str) -> Option<PlcAddress> {
    let bit = text.parse::<BitAddress>().ok().map(PlcAddress::Bit);
    bit.or_else(|| text.parse::<ByteAddress>().ok().map(PlcAddress::Byte))
}

/// Indices of the statements with this instruction name, or with an address whose comment
/// contains the text.
fn find_by_words(ladder: &Ladder, text: &str) -> Vec<usize> {
    let about = |subject: &PlcAddress| {
        [Language::Zh, Language::En].into_iter().any(|language| {
            address_comment(ladder, *subject, language)
                .to_uppercase()
                .contains(text)
        })
    };
    let statements = ladder.statements().iter().enumerate();
    statements
        .filter(|(_, statement)| {
            statement.mnemonic.row().name == text
                || statement_addresses(statement).iter().any(about)
        })
        .map(|(at, _)| at)
        .collect()
}

impl LadderView {
    pub(super) fn show_search_field(&mut self, ui: &mut Ui, language: Language, ladder: &Ladder) {
        let name = say::ladder_find().text(language);
        let field = egui::TextEdit::singleline(&mut self.search.text)
            .desired_width(196.0)
            .hint_text(say::ladder_find_hint().text(language));
        let response = ui.add(field);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &name));
        if response.changed() {
            self.search.is_done = false;
        }
        let entered =
            response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        if (ui.button(name).clicked() || entered) && !self.search.text.trim().is_empty() {
            if self.search.is_done {
                self.show_match(ladder, 1);
            } else {
                self.search.find_all(ladder);
                self.show_match(ladder, 0);
            }
            if entered {
                response.request_focus();
            }
        }
        let count = self.search.matches.len();
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
    }

    /// Searches for an address as if the user had typed it.
    pub(super) fn search_address(&mut self, ladder: &Ladder, subject: PlcAddress) {
        self.search.text = subject.to_string();
        self.search.find_all(ladder);
    }

    fn show_match(&mut self, ladder: &Ladder, step: i64) {
        let count = self.search.matches.len() as i64;
        if count == 0 {
            return;
        }
        let at = (self.search.shown_index as i64 + step).rem_euclid(count);
        self.search.shown_index = usize::try_from(at).unwrap_or(0);
        if let Some(statement) = self.search.matches.get(self.search.shown_index) {
            self.select_statement(ladder, *statement);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Vec<usize> {
        let source = ".CMT X0.5 \"急停\" \"Emergency stop\"\nEND1\nLDI X0.5\nOUT R2.0\nLD R2.0\nOUT Y1.0\nEND2";
        let ladder = Ladder::compile(source).unwrap();
        let mut search = LadderSearch {
            text: text.to_owned(),
            ..LadderSearch::default()
        };
        search.find_all(&ladder);
        search.matches
    }

    #[test]
    fn addresses_instructions_and_comments_are_found() {
        assert_eq!(found("r2.0"), [2, 3]);
        assert_eq!(found("R2"), [2, 3]);
        assert_eq!(found("out"), [2, 4]);
        assert_eq!(found("急停"), [1]);
        assert_eq!(found("emergency"), [1]);
        assert_eq!(found("K7.7"), [0; 0]);
    }
}
