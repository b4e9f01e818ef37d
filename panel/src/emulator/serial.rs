//! What somebody at the serial port does with the files of the memory.

use gsk_core::alarm::number;
use gsk_core::cnc::{Received, Request};
use gsk_core::program::Program;

use super::Emulator;
use crate::pages::Communication;
use crate::panel::{FileId, FileRefusal, SerialFile, file_of, read_data};

impl Emulator {
    /// What a port of the computer does from now on: the word on the LCD, and F213.
    pub fn show_line(&mut self, shown: Communication) {
        let mut requests = Vec::new();
        self.panel.show_line(shown, &mut requests);
        self.ask(requests);
    }

    /// The files that somebody at the port may see, programs first.
    pub fn files(&self) -> Vec<SerialFile> {
        let cnc = &self.simulation.cnc;
        let numbers = cnc.programs().iter().map(|(number, _)| number);
        let seen = numbers.filter(|number| !cnc.rights().hides(*number));
        seen.map(FileId::Program)
            .chain(FileId::DATA)
            .filter_map(|id| file_of(id, cnc))
            .collect()
    }

    /// Whether a file may come in; a level that is too low raises its alarm.
    ///
    /// # Errors
    /// What stands against it.
    pub fn may_take(&mut self, id: FileId, overwrite: bool) -> Result<(), FileRefusal> {
        self.store_edited();
        let cnc = &mut self.simulation.cnc;
        let FileId::Program(number) = id else {
            cnc.rights().receive_data()?;
            return if overwrite {
                Ok(())
            } else {
                Err(FileRefusal::Exists)
            };
        };
        if let Err(refusal) = cnc.rights().receive_program(number) {
            // What it raises stands on the alarm page.
            let _ = cnc.request(Request::AskToReceive(number));
            return Err(refusal.into());
        }
        match cnc.programs().stored(number) {
            Some(_) if !overwrite => Err(FileRefusal::Exists),
            _ => Ok(()),
        }
    }

    /// Takes a whole file, or nothing of it. A program gets the number of its name; one
    /// that is there is replaced, or raises 073.
    ///
    /// # Errors
    /// Why it is not taken.
    pub fn take_file(
        &mut self,
        id: FileId,
        file: SerialFile,
        overwrite: bool,
    ) -> Result<(), FileRefusal> {
        self.store_edited();
        let cnc = &mut self.simulation.cnc;
        let received = match id {
            FileId::Program(number) => {
                cnc.rights().receive_program(number)?;
                let program = Program::new(file.text);
                let program = match program.number() {
                    Some(own) if own == number => program,
                    _ => program.renumbered(number),
                };
                let text = program.text().to_owned();
                match overwrite {
                    true => Received::Replacement(text),
                    false => Received::Program(text),
                }
            }
            _ => {
                cnc.rights().receive_data()?;
                read_data(&file).map_err(FileRefusal::Unreadable)?
            }
        };
        self.carry_out(received)
    }

    /// A file for somebody who asks for it.
    ///
    /// # Errors
    /// There is none, or what stands against it.
    pub fn hand_out(&mut self, id: FileId) -> Result<SerialFile, FileRefusal> {
        self.store_edited();
        let cnc = &self.simulation.cnc;
        match id {
            FileId::Program(number) => cnc.rights().fetch_program(number)?,
            _ => cnc.rights().fetch_data()?,
        }
        file_of(id, cnc).ok_or(FileRefusal::Missing)
    }

    /// Deletes a program for somebody at the port.
    ///
    /// # Errors
    /// Why not.
    pub fn delete_file(&mut self, id: FileId) -> Result<(), FileRefusal> {
        let number = self.changeable(id)?;
        self.carry_out(Received::Deletion(number))
    }

    /// Gives a program another number for somebody at the port.
    ///
    /// # Errors
    /// Why not.
    pub fn rename_file(&mut self, from: FileId, to: FileId) -> Result<(), FileRefusal> {
        let from = self.changeable(from)?;
        let FileId::Program(to) = to else {
            return Err(FileRefusal::OnlyPrograms);
        };
        let cnc = &self.simulation.cnc;
        cnc.rights().receive_program(to)?;
        if cnc.programs().stored(to).is_some() {
            return Err(FileRefusal::Exists);
        }
        self.carry_out(Received::Renaming { from, to })
    }

    /// The number of a program that may be deleted or renamed.
    fn changeable(&mut self, id: FileId) -> Result<u16, FileRefusal> {
        self.store_edited();
        let FileId::Program(number) = id else {
            return Err(FileRefusal::OnlyPrograms);
        };
        let cnc = &self.simulation.cnc;
        cnc.rights().receive_program(number)?;
        match cnc.programs().stored(number) {
            Some(_) => Ok(number),
            None => Err(FileRefusal::Missing),
        }
    }

    fn carry_out(&mut self, received: Received) -> Result<(), FileRefusal> {
        let done = self.simulation.cnc.request(Request::Receive(received));
        done.map_err(|alarm| match alarm.number {
            number::PROGRAM_STORED => FileRefusal::Exists,
            _ => FileRefusal::Alarm(Box::new(alarm)),
        })
    }
}
