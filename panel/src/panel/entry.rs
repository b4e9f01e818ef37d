//! Handles characters and the input line (manual III-1.2.4, III-1.3).

use gsk_core::cnc::{Cnc, ControlRequest};
use gsk_core::operation::OperatingMode;
use gsk_core::units::Axis;

use super::{INPUT_LENGTH, Panel};
use crate::keys::Key;
use crate::pages::PageId;

/// Greatest number of characters of a search. Further ones overwrite the last.
const SEARCH_LENGTH: usize = 5;

/// Returns whether a character can be typed: ASCII without the quotation mark, which no program
/// uses.
pub(crate) fn is_typable(character: char) -> bool {
    character == ' ' || character.is_ascii_graphic() && character != '"'
}

/// Whether a mode selects and searches programs on the program page: EDIT, teach-in and AUTO.
const fn lists_programs(mode: OperatingMode) -> bool {
    mode.edits() || matches!(mode, OperatingMode::Auto)
}

impl Panel {
    /// Handles a character typed on the PC keyboard, as if it had its own key.
    pub(super) fn type_character(
        &mut self,
        character: char,
        cnc: &Cnc,
        requests: &mut Vec<ControlRequest>,
    ) {
        let character = character.to_ascii_uppercase();
        if character == ';' {
            return self.act(Key::Eob, cnc, requests);
        }
        self.compound = None;
        self.view.flashing = None;
        if is_typable(character) {
            self.character(character, cnc, requests);
        }
    }

    /// Handles a character key. `first` and `second` are its characters. A compound key that
    /// was also the key before (`before`) replaces its character by the other one.
    pub(super) fn character_key(
        &mut self,
        key: Key,
        first: char,
        second: Option<char>,
        before: Option<Key>,
        cnc: &Cnc,
        requests: &mut Vec<ControlRequest>,
    ) {
        let in_text = self.edits(cnc) && !self.goes_to_input_line(first, cnc);
        if in_text && !self.is_held(Key::Cancel) {
            let again = before == Some(key);
            if let Some(second) = second.filter(|_| again)
                && self.alternate_in_text(key, (first, second), cnc, requests)
            {
                return;
            }
            self.type_into_text(first, second.map(|_| key), cnc, requests);
            return;
        }
        let entered = self.view.input.chars().last();
        if let (Some(second), true) = (second, before == Some(key))
            && let Some(last) = entered.filter(|last| [first, second].contains(last))
        {
            self.view.input.pop();
            self.view
                .input
                .push(if last == first { second } else { first });
            self.compound = Some(key);
            return;
        }
        let length = self.view.input.len();
        self.character(first, cnc, requests);
        if second.is_some() && self.view.input.len() > length {
            self.compound = Some(key);
        }
    }

    fn character(&mut self, character: char, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        if self.is_held(Key::Cancel) {
            return self.cancel_chord(character, requests);
        }
        if self.bit_command(character) || self.command_character(character, cnc, requests) {
            return;
        }
        match self.page {
            PageId::PosRel | PageId::PosAll => {
                self.view.flashing = match character {
                    'U' => Some(Axis::X),
                    'W' => Some(Axis::Z),
                    _ => None,
                };
            }
            PageId::Teach if self.is_teaching(cnc) => self.teaching_character(character),
            PageId::Graph => self.graphic_command(character, cnc),
            PageId::Prg if self.edits(cnc) && !self.goes_to_input_line(character, cnc) => {
                self.type_into_text(character, None, cnc, requests);
            }
            _ if self.takes_input(cnc) => self.append_to_input(character),
            _ => {}
        }
    }

    /// Handles a character key pressed while 取消 is held: clears a coordinate or a counter.
    fn cancel_chord(&self, character: char, requests: &mut Vec<ControlRequest>) {
        let relative = matches!(self.page, PageId::PosRel | PageId::PosAll);
        let counters = matches!(self.page, PageId::PosRel | PageId::PosAbs);
        match character {
            'U' if relative => requests.push(ControlRequest::ZeroRelative(Axis::X)),
            'W' if relative => requests.push(ControlRequest::ZeroRelative(Axis::Z)),
            'X' if self.page == PageId::PosAll => {
                requests.push(ControlRequest::SetMachineZero(Axis::X));
            }
            'Z' if self.page == PageId::PosAll => {
                requests.push(ControlRequest::SetMachineZero(Axis::Z));
            }
            'N' if counters => requests.push(ControlRequest::ClearParts),
            'T' if counters => requests.push(ControlRequest::ClearCuttingTime),
            _ => {}
        }
    }

    /// Moves the bit cursor for W and D (the key D/U enters U first). Returns whether it did.
    fn bit_command(&mut self, character: char) -> bool {
        let bits = matches!(self.page, PageId::ParBit | PageId::Dgn | PageId::PlcBits);
        if !bits || !self.view.input.is_empty() {
            return false;
        }
        match character {
            'W' => self.move_bit(true),
            'D' | 'U' => self.move_bit(false),
            _ => return false,
        }
        true
    }

    /// Returns whether the page has an input line in the current mode.
    pub(super) fn takes_input(&self, cnc: &Cnc) -> bool {
        match self.page {
            PageId::Prg => lists_programs(cnc.mode()),
            PageId::Mdi | PageId::GraphPar => cnc.mode() == OperatingMode::Mdi,
            PageId::Oft
            | PageId::SetCode
            | PageId::Macro
            | PageId::ParBit
            | PageId::ParData
            | PageId::Pitch
            | PageId::Dgn
            | PageId::PlcBits
            | PageId::PlcValues
            | PageId::ParModel
            | PageId::Inputs
            | PageId::Outputs
            | PageId::Coordinates => true,
            _ => false,
        }
    }

    fn append_to_input(&mut self, character: char) {
        if self.view.editor.searching && self.view.input.len() >= SEARCH_LENGTH {
            self.view.input.pop();
        }
        if self.view.input.len() < INPUT_LENGTH {
            self.view.input.push(character);
        }
    }

    /// Handles 输入: enters the input line as a value, a search or a password, and clears it.
    pub(super) fn commit_input(&mut self, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        match self.page {
            PageId::Password => return self.password_input(cnc, requests),
            // The cursor keys search on the program page.
            PageId::Prg => return,
            _ if self.view.input.is_empty() => return,
            PageId::GraphPar if cnc.mode() == OperatingMode::Mdi => self.set_graphic(cnc),
            _ if self.commit_value(cnc, requests) => {}
            _ => self.search_item(cnc),
        }
        self.clear_input();
    }

    /// Handles the key 转换: switches the contents of the page, or starts a search.
    pub(super) fn change_key(&mut self, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        match self.page {
            PageId::Prg if self.edits(cnc) && self.view.input.starts_with('O') => {
                self.edit_key(Key::Change, cnc, requests);
            }
            PageId::PosRel | PageId::PosAbs => {
                self.view.spindle_override = !self.view.spindle_override;
            }
            PageId::Dir => self.next_directory_screen(cnc),
            PageId::Prg if lists_programs(cnc.mode()) => {
                let searching = !self.view.editor.searching;
                self.clear_input();
                self.view.editor.searching = searching;
            }
            PageId::ParBit => {
                let cursor = self.view.cursors.get_mut(PageId::ParBit);
                cursor.bit_entry = !cursor.bit_entry;
            }
            _ => {}
        }
    }

    /// Handles a cursor key: moves in the program text or the list of the page.
    pub(super) fn cursor_key(&mut self, key: Key, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        if self.page == PageId::Prg && lists_programs(cnc.mode()) {
            self.program_cursor(key, cnc, requests);
            return;
        }
        match key {
            Key::Up => self.move_item(false, cnc),
            Key::Down => self.move_item(true, cnc),
            _ => {}
        }
    }
}
