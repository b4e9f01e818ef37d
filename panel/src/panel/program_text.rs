//! Handles the program page: selecting, searching and editing programs (manual III-5.1,
//! III-8.1, III-8.2).

use gsk_core::cnc::{Cnc, ControlRequest};
use gsk_core::command::ProgramId;
use gsk_core::operation::OperatingMode;
use gsk_core::program::{Completion, Program, ProgramEditor};

use super::Panel;
use crate::keys::Key;
use crate::pages::{PageId, turned_page};

/// Typed after `O-`, these digits mean all programs.
const ALL_PROGRAMS: [&str; 2] = ["999", "9999"];

impl Panel {
    /// Returns whether keys change a program text: they do on the program page in EDIT and
    /// teach-in.
    pub(super) fn edits(&self, cnc: &Cnc) -> bool {
        self.page == PageId::Prg && cnc.mode().edits()
    }

    /// Returns whether a typed character goes into the editor's input line instead of the
    /// text: in a search, or for a program number.
    pub(super) fn goes_to_input_line(&self, character: char, cnc: &Cnc) -> bool {
        let editor = &self.view.editor;
        let editing = editor.editing.as_ref();
        let in_comment = editing.is_some_and(ProgramEditor::is_in_comment);
        // GOTO, ROUND, OR.
        let in_statement =
            cnc.are_variables_real() && editing.is_some_and(ProgramEditor::is_in_statement);
        let names_program = character == 'O' && !in_comment && !in_statement;
        editor.searching || !self.view.input.is_empty() || names_program
    }

    /// Types a character into the program text. `key`: the compound key that was pressed,
    /// whose other character may replace this one; `None` for other keys.
    pub(super) fn type_into_text(
        &mut self,
        character: char,
        key: Option<Key>,
        cnc: &Cnc,
        requests: &mut Vec<ControlRequest>,
    ) {
        let alter = self.view.editor.alter;
        let after_cursor = cnc.parameters().inserts_after_cursor();
        let typed = self.edit(cnc, requests, |editing| {
            if alter {
                editing.overwrite(character, key.is_some())
            } else if after_cursor {
                editing.insert_after_cursor(character)
            } else {
                editing.insert(character)
            }
        });
        if typed {
            self.compound = key;
        }
    }

    /// Replaces the character just typed by the other one (`first` and `second`) of the
    /// compound key. Returns `false` if the text changed otherwise in the meantime.
    pub(super) fn alternate_in_text(
        &mut self,
        key: Key,
        (first, second): (char, char),
        cnc: &Cnc,
        requests: &mut Vec<ControlRequest>,
    ) -> bool {
        let Some(editing) = &self.view.editor.editing else {
            return false;
        };
        // With insertion after the cursor, the cursor is on the typed character, except at the
        // end of a block.
        let after_cursor =
            cnc.parameters().inserts_after_cursor() && editing.char_at_cursor().is_some();
        let alter = self.view.editor.alter || after_cursor;
        let entered = if alter {
            editing.char_at_cursor()
        } else {
            editing.char_before_cursor()
        };
        let other = match entered {
            Some(entered) if entered == first => second,
            Some(entered) if entered == second => first,
            _ => return false,
        };
        let done = self.edit(cnc, requests, |editing| {
            if alter {
                editing.overwrite(other, true)
            } else {
                editing.replace_before(other)
            }
        });
        if done {
            self.compound = Some(key);
        }
        done
    }

    /// Handles EOB, DEL, INS/ALT, CHG, CAN and OUT on the program page in EDIT.
    pub(super) fn edit_key(&mut self, key: Key, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        let input = self.view.input.clone();
        if let Some(number) = input.strip_prefix('O').filter(|_| key != Key::Cancel) {
            let number = number.to_owned();
            self.program_command(key, &number, requests);
            return;
        }
        let completion = completion(cnc);
        match key {
            Key::Cancel if !input.is_empty() => {
                self.view.input.pop();
            }
            Key::Cancel if !self.view.editor.searching => {
                self.edit(cnc, requests, ProgramEditor::backspace);
            }
            Key::Eob if !self.view.editor.searching => {
                self.edit(cnc, requests, |editing| editing.end_block(completion));
            }
            Key::Delete if self.view.editor.searching => {
                self.delete_range(&input, cnc, requests);
            }
            Key::Delete => {
                self.edit(cnc, requests, ProgramEditor::delete);
            }
            Key::Insert if !self.view.editor.searching => {
                self.view.editor.alter = !self.view.editor.alter;
            }
            _ => {}
        }
    }

    /// Handles the input line `O` with a number and a key: creates, saves, renames or deletes
    /// the program.
    fn program_command(&mut self, key: Key, digits: &str, requests: &mut Vec<ControlRequest>) {
        let all = is_all_programs(digits);
        let number = typed_program_number(digits);
        let request = match (key, number) {
            (Key::Delete, _) if all => ControlRequest::DeleteAllPrograms,
            (Key::Delete, Some(number)) => ControlRequest::DeleteProgram(number),
            (Key::Eob, Some(number)) => {
                self.created = Some(number);
                ControlRequest::CreateProgram(number)
            }
            (Key::Change, Some(number)) => ControlRequest::SaveProgramAs(number),
            (Key::Insert, Some(number)) => ControlRequest::RenameProgram(number),
            _ => {
                self.clear_input();
                return;
            }
        };
        self.store_edited(requests);
        requests.push(request);
        self.clear_input();
    }

    /// Handles 删除 with `N` and a number in search state: deletes from the cursor to the end of
    /// the block with that number.
    fn delete_range(&mut self, input: &str, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        let Some(sequence) = input.strip_prefix('N').and_then(number) else {
            return;
        };
        if !self.has_edit_right(cnc, requests) {
            return;
        }
        if self.edit(cnc, requests, |editing| editing.delete_to(sequence.into())) {
            self.clear_input();
        } else {
            requests.push(ControlRequest::NotFound { sequence: true });
        }
    }

    /// Handles a cursor key on the program page. With `O` typed it selects a program, in
    /// search state it searches, in EDIT it moves the cursor.
    pub(super) fn program_cursor(
        &mut self,
        key: Key,
        cnc: &Cnc,
        requests: &mut Vec<ControlRequest>,
    ) {
        let input = self.view.input.clone();
        if self.view.editor.searching {
            self.search_text(&input, key, cnc, requests);
            return;
        }
        if let Some(rest) = input.strip_prefix('O') {
            match key {
                Key::Down if rest.is_empty() => {
                    // The letter remains, so that the next press selects the next program.
                    self.store_edited(requests);
                    requests.extend(next_program(cnc).map(ControlRequest::SelectProgram));
                }
                Key::Down => {
                    self.store_edited(requests);
                    requests.extend(typed_program_number(rest).map(ControlRequest::SelectProgram));
                    self.clear_input();
                }
                Key::Up => {
                    if let Some(editing) = self.editing(cnc) {
                        editing.move_to_head();
                    }
                    requests.push(ControlRequest::CursorTo(1));
                    self.clear_input();
                }
                _ => {}
            }
            return;
        }
        if cnc.mode().edits()
            && let Some(editing) = self.editing(cnc)
        {
            match key {
                Key::Up => editing.move_up(),
                Key::Down => editing.move_down(),
                Key::Left => editing.move_left(),
                _ => editing.move_right(),
            }
            self.cursor_moved(requests);
        }
    }

    /// Searches up to five typed characters after 转换, in the direction of the cursor key.
    fn search_text(
        &mut self,
        wanted: &str,
        key: Key,
        cnc: &Cnc,
        requests: &mut Vec<ControlRequest>,
    ) {
        let forward = match key {
            Key::Down => true,
            Key::Up => false,
            _ => return,
        };
        if wanted.is_empty() || cnc.mode() == OperatingMode::Auto && is_running(cnc) {
            return;
        }
        let found = self
            .editing(cnc)
            .is_some_and(|editing| editing.move_to_text(wanted, forward));
        if found {
            self.cursor_moved(requests);
        } else {
            let sequence = wanted.strip_prefix('N').and_then(number).is_some();
            requests.push(ControlRequest::NotFound { sequence });
        }
    }

    /// Moves the edit cursor by one screen, forward or back.
    pub(super) fn turn_text_page(
        &mut self,
        forward: bool,
        cnc: &Cnc,
        requests: &mut Vec<ControlRequest>,
    ) {
        if let Some(editing) = self.editing(cnc) {
            let line = turned_page(editing.program(), editing.cursor().0, forward);
            editing.move_to_line(line);
            self.cursor_moved(requests);
        }
    }

    /// Requests the control's cursor to follow the edit cursor. The next run starts there.
    fn cursor_moved(&mut self, requests: &mut Vec<ControlRequest>) {
        if let Some(editing) = &self.view.editor.editing {
            requests.push(ControlRequest::CursorTo(editing.cursor().0));
        }
    }

    /// Returns the editor of the selected program, opened at the control's cursor if it is not
    /// open; `None` if there is no program or it is hidden.
    fn editing(&mut self, cnc: &Cnc) -> Option<&mut ProgramEditor> {
        let hidden = stored_number(cnc).is_some_and(|number| cnc.rights().is_hidden(number));
        let program = current(cnc).filter(|_| !hidden)?;
        let line = cnc.cursor().line;
        let begun = || ProgramEditor::new(program.clone(), line);
        Some(self.view.editor.editing.get_or_insert_with(begun))
    }

    /// Returns whether the selected program may be edited. If not, the control reports the
    /// reason.
    fn has_edit_right(&self, cnc: &Cnc, requests: &mut Vec<ControlRequest>) -> bool {
        // A program outside the memory is read-only.
        let Some(number) = stored_number(cnc) else {
            return false;
        };
        match cnc.rights().check_program_edit(number) {
            Ok(()) => true,
            Err(_) => {
                requests.push(ControlRequest::CheckEdit(number));
                false
            }
        }
    }

    /// Changes the program text with `change`, if that is allowed and the memory has enough
    /// space. Returns whether the text changed.
    pub(super) fn edit(
        &mut self,
        cnc: &Cnc,
        requests: &mut Vec<ControlRequest>,
        change: impl FnOnce(&mut ProgramEditor) -> bool,
    ) -> bool {
        if !self.has_edit_right(cnc, requests) {
            return false;
        }
        let Some(number) = stored_number(cnc) else {
            return false;
        };
        let Some(editing) = self.editing(cnc) else {
            return false;
        };
        let mut changed = editing.clone();
        if !change(&mut changed) {
            return false;
        }
        let stored = editing.stored().characters();
        let grown = changed.program().characters().saturating_sub(stored);
        if grown > cnc.programs().free_characters() {
            // The memory refuses it with its alarm, and the text does not change.
            let program = changed.finish().clone();
            requests.push(ControlRequest::StoreEdited { number, program });
            return false;
        }
        *editing = changed;
        self.edited = Some(number);
        true
    }

    /// Returns number and text of the program in the editor, as it would be stored now; `None`
    /// without changes. The battery of the control's memory keeps every key press.
    pub fn edited(&self) -> Option<(u16, Program)> {
        let number = self.edited?;
        let editing = self.view.editor.editing.as_ref()?;
        editing
            .is_changed()
            .then(|| (number, editing.clone().finish().clone()))
    }

    /// Requests storing the program text if it has changed. Call it before another program,
    /// page or mode.
    pub(super) fn store_edited(&mut self, requests: &mut Vec<ControlRequest>) {
        let (Some(editing), Some(number)) = (&mut self.view.editor.editing, self.edited.take())
        else {
            return;
        };
        if !editing.is_changed() {
            return;
        }
        let program = editing.finish().clone();
        requests.push(ControlRequest::StoreEdited {
            number,
            program: program.clone(),
        });
        requests.push(ControlRequest::CursorTo(editing.cursor().0));
        editing.mark_saved(program);
    }

    /// Stores the program text when its page or mode is left. Moves the editor when the
    /// control shows another program or line.
    pub(super) fn follow_program(&mut self, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        if self.view.editor.editing.is_none() && self.created.is_none() {
            return;
        }
        if !self.edits(cnc) && self.edited.is_some() {
            self.store_edited(requests);
        }
        let cursor = (cnc.programs().selected(), cnc.cursor().line);
        let moved = self.followed.replace(cursor) != Some(cursor);
        let same = match (&self.view.editor.editing, current(cnc)) {
            (Some(editing), Some(program)) => editing.stored() == program,
            _ => false,
        };
        if !same && self.edited.is_none() {
            self.view.editor.editing = None;
        } else if moved
            && let Some(editing) = &mut self.view.editor.editing
            && editing.cursor().0 != cursor.1
        {
            editing.move_to_line(cursor.1);
        }
        if let Some(number) = self.created.take()
            && self.edits(cnc)
            && cnc.programs().selected() == Some(ProgramId::Stored(number))
            && let Some(program) = current(cnc).filter(|program| program.block_count() == 1)
        {
            let mut editing = ProgramEditor::new(program.clone(), 2);
            editing.number_block(completion(cnc));
            self.edited = editing.is_changed().then_some(number);
            self.view.editor.editing = Some(editing);
        }
    }
}

/// Returns the program that is selected; `None` if none is.
fn current(cnc: &Cnc) -> Option<&Program> {
    cnc.programs().get(cnc.programs().selected()?)
}

/// Returns the number of the selected program; `None` if it is not in the memory.
fn stored_number(cnc: &Cnc) -> Option<u16> {
    match cnc.programs().selected()? {
        ProgramId::Stored(number) => Some(number),
        _ => None,
    }
}

fn is_running(cnc: &Cnc) -> bool {
    cnc.rights().operating
}

/// Returns the characters that the editor adds to typed text (sequence numbers, decimal points), by
/// the settings of the control.
fn completion(cnc: &Cnc) -> Completion {
    let step = cnc.parameters().block_number_step();
    Completion {
        numbering: cnc.settings().numbering.then_some(step),
        points: cnc.parameters().is_point_appended(),
    }
}

/// Returns the number of the stored program after the selected one; after the last the first.
/// `None` if no program is stored.
fn next_program(cnc: &Cnc) -> Option<u16> {
    let rights = cnc.rights();
    let listed = cnc.programs().iter().map(|(number, _)| number);
    let numbers: Vec<u16> = listed.filter(|number| !rights.is_hidden(*number)).collect();
    let selected = stored_number(cnc);
    let after = numbers.iter().find(|number| Some(**number) > selected);
    after.or(numbers.first()).copied()
}

/// Returns whether the digits typed after `O` are `-999` or `-9999`, which mean every program.
pub(super) fn is_all_programs(digits: &str) -> bool {
    let digits = digits.strip_prefix('-');
    digits.is_some_and(|digits| ALL_PROGRAMS.contains(&digits))
}

/// Returns the typed number of a program, also one above 9999: the control refuses it with 074, or
/// does not find it. `None` if the text is not a number.
fn typed_program_number(digits: &str) -> Option<u16> {
    let number: u32 = digits.trim().parse().ok()?;
    Some(u16::try_from(number).unwrap_or(u16::MAX))
}

/// Parses a program or sequence number; `None` above 9999 or if it is not a number.
pub(super) fn number(digits: &str) -> Option<u16> {
    let number: u16 = digits.trim().parse().ok()?;
    (number <= 9999).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::{number, typed_program_number};

    #[test]
    fn numbers_of_programs_and_blocks() {
        assert_eq!(number("0012"), Some(12));
        assert_eq!(number("12345"), None);
        assert_eq!(number(""), None);
        assert_eq!(number("-5"), None);
        assert_eq!(typed_program_number("10000"), Some(10_000));
        assert_eq!(typed_program_number("-5"), None);
    }
}
