//! Handles the soft keys below the LCD, as the table of the model's face defines them.

use gsk_core::cnc::{Cnc, ControlRequest};

use super::{INPUT_LENGTH, Panel};
use crate::face::{SoftAction, face_of};

impl Panel {
    /// Executes the action of the soft key at a position of the row that is shown.
    pub(super) fn soft_key(&mut self, position: u8, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        let face = face_of(cnc.model().id());
        let Some(shown) = face.page(self.page) else {
            return;
        };
        let bar = self.view.soft_bar;
        let mut keys = face.soft_bar(shown.key, bar);
        let Some(key) = keys.find(|key| key.position == position) else {
            return;
        };
        match key.action {
            SoftAction::Open(page) => {
                let opened = face.page(page);
                let again = opened.is_some_and(|row| row.display == shown.display);
                let page = if again {
                    face.neighbour(self.page, true)
                } else {
                    page
                };
                self.go_to(page, cnc);
            }
            SoftAction::CopyProgram | SoftAction::RenameProgram => {
                let Some(number) = program_number(&self.view.input) else {
                    return;
                };
                self.store_edited(requests);
                self.view.editor.editing = None;
                requests.push(match key.action {
                    SoftAction::CopyProgram => ControlRequest::SaveProgramAs(number),
                    _ => ControlRequest::RenameProgram(number),
                });
                self.clear_input();
            }
            SoftAction::NextBar => {
                self.view.soft_bar = (bar + 1) % face.soft_bars(shown.key);
            }
        }
    }
}

/// Parses a typed program name: a number, after `P` or `O`; `None` if invalid.
fn program_number(typed: &str) -> Option<u16> {
    let typed = typed.trim();
    let digits = typed.strip_prefix(['P', 'O']).unwrap_or(typed);
    let number = digits.parse().ok().filter(|number| *number > 0);
    number.filter(|_| digits.len() < INPUT_LENGTH)
}

#[cfg(test)]
mod tests {
    use super::program_number;

    #[test]
    fn names_of_programs() {
        assert_eq!(program_number("P12"), Some(12));
        assert_eq!(program_number("O0007"), Some(7));
        assert_eq!(program_number("33"), Some(33));
        for wrong in ["", "P", "P0", "X5", "P1.5", "99999"] {
            assert_eq!(program_number(wrong), None, "{wrong}");
        }
    }
}
