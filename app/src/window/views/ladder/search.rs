//! Searches the ladder as the manufacturer's tool does: for an address, an instruction or a
//! comment.

use egui::{RichText, Ui};
use gsk_core::plc::address::{BitAddress, ByteAddress};
use gsk_core::plc::{Ladder, PlcAddress};

use super::draw::comment;
use super::{LadderView, subjects};
use gsk_messages::{Language, say};

/// The search text and its results.
#[derive(Clone, Debug, Default)]
pub struct Search {
    text: String,
    subject: Option<PlcAddress>,
    /// Statements, as indices in the program.
    found: Vec<usize>,
    /// Index in `found` of the statement that is shown.
    at: usize,
    done: bool,
}

impl Search {
    /// Clears the results and keeps the text.
    pub fn clear(&mut self) {
        self.found.clear();
        self.subject = None;
        self.done = false;
    }

    /// The address that is searched for, if the text is an address.
    pub const fn subject(&self) -> Option<PlcAddress> {
        self.subject
    }

    /// Searches a ladder for the text.
    fn run(&mut self, ladder: &Ladder) {
        let text = self.text.trim().to_uppercase();
        self.subject = subject(&text);
        self.at = 0;
        self.done = true;
        self.found = match self.subject {
            Some(subject) => {
                let references = ladder.references(subject);
                references
                    .iter()
                    .map(|reference| reference.statement)
                    .collect()
            }
            None => by_words(ladder, &text),
        };
    }
}

/// The address that a text names.
fn subject(text: &str) -> Option<PlcAddress> {
    let bit = text.parse::<BitAddress>().ok().map(PlcAddress::Bit);
    bit.or_else(|| text.parse::<ByteAddress>().ok().map(PlcAddress::Byte))
}

/// Statements with this instruction name, or with an address whose comment contains the text.
fn by_words(ladder: &Ladder, text: &str) -> Vec<usize> {
    let about = |subject: &PlcAddress| {
        [Language::Zh, Language::En].into_iter().any(|language| {
            comment(ladder, *subject, language)
                .to_uppercase()
                .contains(text)
        })
    };
    let statements = ladder.statements().iter().enumerate();
    statements
        .filter(|(_, statement)| {
            statement.mnemonic.row().name == text || subjects(statement).iter().any(about)
        })
        .map(|(at, _)| at)
        .collect()
}

impl LadderView {
    pub(super) fn search_field(&mut self, ui: &mut Ui, language: Language, ladder: &Ladder) {
        let name = say::ladder_find().text(language);
        let field = egui::TextEdit::singleline(&mut self.search.text)
            .desired_width(196.0)
            .hint_text(say::ladder_find_hint().text(language));
        let response = ui.add(field);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &name));
        if response.changed() {
            self.search.done = false;
        }
        let entered =
            response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        if (ui.button(name).clicked() || entered) && !self.search.text.trim().is_empty() {
            if self.search.done {
                self.next_found(ladder, 1);
            } else {
                self.search.run(ladder);
                self.next_found(ladder, 0);
            }
            if entered {
                response.request_focus();
            }
        }
        let count = self.search.found.len();
        for (sign, words, way) in [
            ("◀", say::ladder_find_previous().text(language), -1),
            ("▶", say::ladder_find_next().text(language), 1),
        ] {
            let button = ui.add_enabled(count > 0, egui::Button::new(sign));
            button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, count > 0, &words));
            if button.on_hover_text(words).clicked() {
                self.next_found(ladder, way);
            }
        }
        if self.search.done {
            let words = if count == 0 {
                say::ladder_not_found().text(language)
            } else {
                format!("{} / {count}", self.search.at + 1)
            };
            ui.label(RichText::new(words).weak());
        }
    }

    /// Searches for an address as if the user had typed it.
    pub(super) fn look_for(&mut self, ladder: &Ladder, subject: PlcAddress) {
        self.search.text = subject.to_string();
        self.search.run(ladder);
    }

    fn next_found(&mut self, ladder: &Ladder, way: i64) {
        let count = self.search.found.len() as i64;
        if count == 0 {
            return;
        }
        let at = (self.search.at as i64 + way).rem_euclid(count);
        self.search.at = usize::try_from(at).unwrap_or(0);
        if let Some(statement) = self.search.found.get(self.search.at) {
            self.go_to(ladder, *statement);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Vec<usize> {
        let source = ".CMT X0.5 \"急停\" \"Emergency stop\"\nEND1\nLDI X0.5\nOUT R2.0\nLD R2.0\nOUT Y1.0\nEND2";
        let ladder = Ladder::compile(source).unwrap();
        let mut search = Search {
            text: text.to_owned(),
            ..Search::default()
        };
        search.run(&ladder);
        search.found
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
