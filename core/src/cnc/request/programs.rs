//! Requests about the program memory (manual III-5.1, III-8.1, III-8.2).

use super::check_allowed;
use crate::alarm::{Alarm, number};
use crate::cnc::Cnc;
use crate::command::ProgramId;
use crate::operation::{OperatingMode, RunState};
use crate::program::Program;

impl Cnc {
    pub(super) fn select_program(&mut self, program: ProgramId) -> Result<(), Alarm> {
        if self.run.automatic.is_operating() {
            return Ok(());
        }
        let hidden = match program {
            ProgramId::Stored(number) => self.rights().is_hidden(number),
            _ => false,
        };
        if hidden || self.memory.programs.get(program).is_none() {
            return Err(self.program_missing_alarm());
        }
        self.memory.programs.select(program);
        self.drop_stopped_run();
        self.run.cursor_line = 1;
        Ok(())
    }

    fn program_missing_alarm(&self) -> Alarm {
        Alarm::new(if self.run.mode == OperatingMode::Auto {
            number::PROGRAM_MISSING
        } else {
            number::NOT_FOUND
        })
    }

    /// The alarm for a search on the program page that found nothing; `sequence`: a
    /// sequence number was searched.
    pub(super) fn search_alarm(&self, sequence: bool) -> Alarm {
        Alarm::new(if sequence && self.run.mode == OperatingMode::Auto {
            number::SEQUENCE_MISSING
        } else {
            number::NOT_FOUND
        })
    }

    /// Moves the cursor to a line, from 1, of the selected program, if no program runs.
    pub(super) fn move_cursor(&mut self, line: u32) {
        if !self.run.automatic.is_operating() {
            self.drop_stopped_run();
            self.run.cursor_line = line.max(1);
        }
    }

    /// Stores a program text in the program memory and selects the program. Returns the alarm of
    /// the program memory as error.
    pub(super) fn store_program(&mut self, text: String) -> Result<(), Alarm> {
        if self.is_memory_protected() {
            return Ok(());
        }
        let number = self.memory.programs.store(text)?;
        if !self.rights().is_hidden(number) {
            self.select_program(ProgramId::Stored(number))?;
        }
        Ok(())
    }

    /// Opens a program outside the memory and selects it. Does nothing while a program runs.
    pub(super) fn open_external(&mut self, program: Program) -> Result<(), Alarm> {
        if self.run.automatic.is_operating() {
            return Ok(());
        }
        self.memory.programs.open_external(program);
        self.select_program(ProgramId::External)
    }

    pub(super) fn create_program(&mut self, number: u16) -> Result<(), Alarm> {
        if check_allowed(self.rights().check_program_edit(number))? {
            let naming = self.memory.model.record().program_naming();
            self.memory.programs.create(number, naming)?;
            self.select_changed_program(number);
            // After the name, where the first block goes.
            self.run.cursor_line = 2;
        }
        Ok(())
    }

    pub(super) fn save_program_as(&mut self, number: u16) -> Result<(), Alarm> {
        if check_allowed(self.rights().check_program_edit(number))? {
            self.memory.programs.save_as(number)?;
        }
        Ok(())
    }

    pub(super) fn rename_program(&mut self, number: u16) -> Result<(), Alarm> {
        let Some(ProgramId::Stored(from)) = self.memory.programs.selected() else {
            return Ok(());
        };
        if check_allowed(self.rights().check_program_edit(from))?
            && check_allowed(self.rights().check_program_edit(number))?
        {
            self.memory.programs.rename(from, number)?;
            self.select_changed_program(number);
        }
        Ok(())
    }

    pub(super) fn delete_program(&mut self, number: u16) -> Result<(), Alarm> {
        if check_allowed(self.rights().check_program_edit(number))? {
            let was_selected = self.memory.programs.selected() == Some(ProgramId::Stored(number));
            self.memory.programs.delete(number)?;
            if was_selected {
                self.invalidate_run();
            }
        }
        Ok(())
    }

    pub(super) fn delete_all_programs(&mut self) -> Result<(), Alarm> {
        if !check_allowed(self.rights().check_program_edit(0))? {
            return Ok(());
        }
        let numbers: Vec<u16> = self
            .memory
            .programs
            .iter()
            .map(|(number, _)| number)
            .collect();
        for number in numbers {
            if self.rights().check_program_edit(number).is_ok() {
                self.memory.programs.delete(number)?;
            }
        }
        self.invalidate_run();
        Ok(())
    }

    /// Stores the edited text of a program, even if the mode has changed since the text was typed.
    /// Returns the alarm of the program memory as error.
    pub(super) fn store_edited(&mut self, number: u16, program: Program) -> Result<(), Alarm> {
        if self.run.automatic.state == RunState::Run
            || !check_allowed(self.rights().check_program_store(number))?
        {
            return Ok(());
        }
        self.memory.programs.replace(number, program)?;
        if self.memory.programs.selected() == Some(ProgramId::Stored(number)) {
            let line = self.run.cursor_line;
            self.invalidate_run();
            self.run.cursor_line = line;
        }
        Ok(())
    }

    fn select_changed_program(&mut self, number: u16) {
        self.memory.programs.select(ProgramId::Stored(number));
        self.invalidate_run();
    }

    /// Drops the run because its program has changed: the next start begins at the first line.
    pub(super) fn invalidate_run(&mut self) {
        if self.run.automatic.is_operating() {
            self.stop_run(RunState::Reset);
        }
        self.drop_stopped_run();
        self.run.cursor_line = 1;
    }

    /// Drops the rest of a stopped run, because the cursor has moved.
    pub(super) fn drop_stopped_run(&mut self) {
        self.run.automatic.clear();
    }
}
