//! Explains why a page or text key would have no effect now.

use gsk_core::cnc::Cnc;
use gsk_core::command::ProgramId;
use gsk_core::operation::OperatingMode;
use gsk_messages::{Message, say};

use super::{KeyEvent, Panel};
use crate::face::face_of;
use crate::keys::{Key, KeyRole};
use crate::pages::PageId;

impl Panel {
    /// Returns why a key would have no effect if it were pressed now. Returns `None` if it
    /// acts, if the control reports the reason, or if it is neither a page nor a text key.
    pub fn refuses(&self, key: Key, cnc: &Cnc) -> Option<Message> {
        if !self.powered() {
            return (key != Key::EmergencyStop && key != Key::OvertravelRelease)
                .then(say::key_power_off);
        }
        if let Some(why) = self.limit_refusal(KeyEvent::Down(key), cnc) {
            return Some(why);
        }
        if self.in_self_test() {
            return None;
        }
        if face_of(cnc.model().id()).key(key).is_none() {
            return Some(say::key_missing_on_panel(key.id()));
        }
        match (key.row().role, key) {
            (_, Key::Input | Key::Delete) if self.is_teaching(cnc) => {
                cnc.is_moving().then(say::key_teaches_at_rest)
            }
            (KeyRole::Character(first, _), _) => self.refuses_entry(first, cnc),
            (_, Key::Input | Key::Output) if self.page() == PageId::Udisk => None,
            (_, Key::Insert | Key::Delete) if self.page() != PageId::Prg => {
                Some(say::key_edits_programs())
            }
            (_, Key::Insert | Key::Delete | Key::Eob | Key::Input)
                if self.page() == PageId::Prg =>
            {
                self.refuses_text(key == Key::Input, cnc)
            }
            (_, Key::Input) if self.page() == PageId::Password => {
                let refused = cnc.rights().check_password().is_err();
                refused.then(say::request_while_running)
            }
            (_, Key::Input) => self.refuses_value(cnc),
            (_, Key::Output) => self.refuses_output(cnc),
            _ => None,
        }
    }

    /// Returns why a character of the PC keyboard would have no effect now; `None` if it acts.
    pub(crate) fn refuses_character(&self, character: char, cnc: &Cnc) -> Option<Message> {
        let by_exercise = self.limit_refusal(KeyEvent::Type(character), cnc);
        by_exercise.or_else(|| self.refuses_entry(character, cnc))
    }

    fn refuses_entry(&self, character: char, cnc: &Cnc) -> Option<Message> {
        if !self.powered() || self.in_self_test() || self.is_held(Key::Cancel) {
            return None;
        }
        match self.page() {
            PageId::Prg if cnc.mode() == OperatingMode::Auto => None,
            PageId::Prg if self.edits(cnc) && self.goes_to_input_line(character, cnc) => None,
            PageId::Prg => self.refuses_text(false, cnc),
            PageId::Mdi if cnc.mode() != OperatingMode::Mdi => {
                Some(say::key_mdi_block_in_mdi_mode())
            }
            PageId::GraphPar if cnc.mode() != OperatingMode::Mdi => {
                Some(say::key_graphic_in_mdi_mode())
            }
            PageId::PosRel | PageId::PosAll if matches!(character, 'U' | 'W') => None,
            PageId::Teach if self.is_teaching(cnc) => None,
            PageId::Reset
            | PageId::Graph
            | PageId::SetSwitch
            | PageId::Edisk
            | PageId::Softpanel
            | PageId::Password => None,
            _ if self.takes_input(cnc) => None,
            _ => Some(say::key_nothing_on_this_page()),
        }
    }

    /// Returns why a key of the program text has no effect; `None` if it acts. `input`:
    /// whether the key is 输入.
    fn refuses_text(&self, input: bool, cnc: &Cnc) -> Option<Message> {
        match cnc.mode() {
            OperatingMode::Edit if input => None,
            OperatingMode::Edit => self.refuses_edit(cnc),
            OperatingMode::Auto if input => Some(say::key_program_is_chosen_with_o()),
            OperatingMode::Mdi => Some(say::key_mdi_block_on_page_mdi()),
            _ => Some(say::key_text_in_edit_mode()),
        }
    }

    fn refuses_edit(&self, cnc: &Cnc) -> Option<Message> {
        match cnc.programs().selected() {
            // [EOB] creates the typed program.
            None if self.view().input.starts_with('O') => None,
            None => Some(say::key_no_program_selected()),
            Some(ProgramId::External) if self.view().input.is_empty() => {
                Some(say::key_program_is_outside())
            }
            Some(_) => None,
        }
    }

    /// Returns the message that the typed value is invalid on this page, if the key 输入 would ignore
    /// it; otherwise `None`.
    fn refuses_value(&self, cnc: &Cnc) -> Option<Message> {
        let mut requests = Vec::new();
        let entered = !self.view().input.trim().is_empty();
        let dropped = entered && self.commit_value(cnc, &mut requests) && requests.is_empty();
        dropped.then(say::key_no_value_here)
    }

    fn refuses_output(&self, cnc: &Cnc) -> Option<Message> {
        let starts = cnc.parameters().output_key_starts();
        match cnc.mode() {
            OperatingMode::Mdi if !starts => Some(say::key_output_starts_with_parameter()),
            _ => None,
        }
    }
}
