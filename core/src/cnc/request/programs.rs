//! Requests about the program memory (manual III-5.1, III-8.1, III-8.2).

use super::allowed;
use crate::alarm::{Alarm, number};
use crate::cnc::Cnc;
use crate::command::ProgramId;
use crate::operation::{Mode, RunState};
use crate::program::Program;

impl Cnc {
    pub(super) fn select(&mut self, program: ProgramId) -> Result<(), Alarm> {
        if self.run.automatic.operating() {
            return Ok(());
        }
        let hidden = match program {
            ProgramId::Stored(number) => self.rights().hides(number),
            _ => false,
        };
        if hidden || self.memory.programs.get(program).is_none() {
            return Err(self.not_found_program());
        }
        self.memory.programs.select(program);
        self.forget_run();
        self.run.cursor_line = 1;
        Ok(())
    }

    fn not_found_program(&self) -> Alarm {
        Alarm::new(if self.run.mode == Mode::Auto {
            number::PROGRAM_MISSING
        } else {
            number::NOT_FOUND
        })
    }

    /// The alarm for a search on the program page that found nothing.
    pub(super) fn not_found(&self, sequence: bool) -> Alarm {
        Alarm::new(if sequence && self.run.mode == Mode::Auto {
            number::SEQUENCE_MISSING
        } else {
            number::NOT_FOUND
        })
    }

    pub(super) fn create_program(&mut self, number: u16) -> Result<(), Alarm> {
        if allowed(self.rights().program(number))? {
            self.memory.programs.create(number)?;
            self.show_changed(number);
            // After the name, where the first block goes.
            self.run.cursor_line = 2;
        }
        Ok(())
    }

    pub(super) fn save_program_as(&mut self, number: u16) -> Result<(), Alarm> {
        if allowed(self.rights().program(number))? {
            self.memory.programs.save_as(number)?;
        }
        Ok(())
    }

    pub(super) fn rename_program(&mut self, number: u16) -> Result<(), Alarm> {
        let Some(ProgramId::Stored(from)) = self.memory.programs.current() else {
            return Ok(());
        };
        if allowed(self.rights().program(from))? && allowed(self.rights().program(number))? {
            self.memory.programs.rename(from, number)?;
            self.show_changed(number);
        }
        Ok(())
    }

    pub(super) fn delete_program(&mut self, number: u16) -> Result<(), Alarm> {
        if allowed(self.rights().program(number))? {
            let was_selected = self.memory.programs.current() == Some(ProgramId::Stored(number));
            self.memory.programs.delete(number)?;
            if was_selected {
                self.void_run();
            }
        }
        Ok(())
    }

    pub(super) fn delete_all_programs(&mut self) -> Result<(), Alarm> {
        if !allowed(self.rights().program(0))? {
            return Ok(());
        }
        let numbers: Vec<u16> = self
            .memory
            .programs
            .iter()
            .map(|(number, _)| number)
            .collect();
        for number in numbers {
            if self.rights().program(number).is_ok() {
                self.memory.programs.delete(number)?;
            }
        }
        self.void_run();
        Ok(())
    }

    /// Stores a text that was typed while that was permitted; the mode may have changed
    /// since.
    pub(super) fn store_edited(&mut self, number: u16, program: Program) -> Result<(), Alarm> {
        if self.run.automatic.state == RunState::Run
            || !allowed(self.rights().program_memory(number))?
        {
            return Ok(());
        }
        self.memory.programs.replace(number, program)?;
        if self.memory.programs.current() == Some(ProgramId::Stored(number)) {
            let line = self.run.cursor_line;
            self.void_run();
            self.run.cursor_line = line;
        }
        Ok(())
    }

    fn show_changed(&mut self, number: u16) {
        self.memory.programs.select(ProgramId::Stored(number));
        self.void_run();
    }

    /// Ends a held run that cannot be resumed: the next start begins at the head.
    pub(super) fn void_run(&mut self) {
        if self.run.automatic.operating() {
            self.stop_run(RunState::Reset);
        }
        self.forget_run();
        self.run.cursor_line = 1;
    }

    /// Drops the rest of a stopped run, because the cursor has moved.
    pub(super) fn forget_run(&mut self) {
        self.run.automatic.clear();
    }
}
