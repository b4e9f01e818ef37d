//! The program memory: stored programs, the program opened from a file, and the selection.

use core::ops::RangeInclusive;
use std::collections::BTreeMap;

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use super::dnc_buffer::DncBuffer;
use super::program_text::Program;
use crate::alarm::{Alarm, number};
use crate::command::ProgramId;
use crate::model::{ProgramCapacity, ProgramNaming};

/// The numbers that a program can have.
pub const PROGRAM_NUMBERS: RangeInclusive<u16> = 0..=9999;

/// The program memory: stored programs, the external program, and which one is selected.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ProgramMemory {
    stored: BTreeMap<u16, Program>,
    external: Option<Program>,
    /// The program that arrives through the serial port and runs meanwhile; `None` without
    /// one.
    #[serde(rename = "inflow")]
    dnc_buffer: Option<DncBuffer>,
    current: Option<ProgramId>,
    #[serde(default, skip_serializing_if = "ProgramCapacity::is_default")]
    capacity: ProgramCapacity,
}

impl ProgramMemory {
    /// Stores a program under its O number, replacing an existing one, and returns the number.
    /// Selects the program if none is selected.
    ///
    /// # Errors
    /// 074 without an O number, 068 and 072 if the memory is full.
    pub fn store(&mut self, text: impl Into<String>) -> Result<u16, Alarm> {
        let program = Program::new(text);
        let number = program.number().ok_or_else(|| {
            Alarm::new(number::PROGRAM_NUMBER).with_detail(say::program_number_missing())
        })?;
        self.insert_checked(number, program)?;
        Ok(number)
    }

    /// Stores a received program and returns its number. Does not replace an existing program.
    ///
    /// # Errors
    /// 073 if the number is in use, and those of [`Self::store`].
    pub fn receive(&mut self, text: impl Into<String>) -> Result<u16, Alarm> {
        let program = Program::new(text);
        match program.number() {
            Some(number) if self.stored.contains_key(&number) => {
                Err(Alarm::new(number::PROGRAM_STORED).with_detail(say::program_in_memory(number)))
            }
            _ => self.store(program.text()),
        }
    }

    /// Creates a program with the number `number` that only has its name, as the model writes it.
    ///
    /// # Errors
    /// 110 if the number is in use, 074 if it is out of range, 068 and 072 if the memory is
    /// full.
    pub fn create(&mut self, number: u16, naming: ProgramNaming) -> Result<(), Alarm> {
        self.check_number_free(number)?;
        let name = naming.name(number);
        self.insert_checked(number, Program::new(format!("{name};\n")))
    }

    /// Stores a copy of the program `from` under the number `to`.
    ///
    /// # Errors
    /// 071 if `from` is missing, 110 if `to` exists, 074 if `to` is out of range, 068 and 072
    /// if the memory is full.
    pub fn copy(&mut self, from: u16, to: u16) -> Result<(), Alarm> {
        let program = self
            .stored
            .get(&from)
            .ok_or_else(|| missing_program_alarm(from))?;
        let program = program.renumbered(to);
        self.check_number_free(to)?;
        self.insert_checked(to, program)
    }

    /// Stores a copy of the selected program, which may be the external one, under the number
    /// `to`.
    ///
    /// # Errors
    /// As [`Self::copy`].
    pub(crate) fn save_as(&mut self, to: u16) -> Result<(), Alarm> {
        let Some(program) = self.current.and_then(|id| self.get(id)) else {
            return Err(Alarm::new(number::NOT_FOUND).with_detail(say::program_not_selected()));
        };
        let program = program.renumbered(to);
        self.check_number_free(to)?;
        self.insert_checked(to, program)
    }

    /// Replaces the text of the stored program `number`.
    ///
    /// # Errors
    /// 071 if the program is missing, 068 if the memory is full.
    pub fn replace(&mut self, number: u16, program: Program) -> Result<(), Alarm> {
        if !self.stored.contains_key(&number) {
            return Err(missing_program_alarm(number));
        }
        let program = if program.number() == Some(number) {
            program
        } else {
            program.renumbered(number)
        };
        self.insert_checked(number, program)
    }

    /// Returns a copy with the data that survive power-off: the stored programs, and which one is
    /// selected.
    #[must_use]
    pub fn retained(&self) -> Self {
        let is_stored = |id: &ProgramId| matches!(id, ProgramId::Stored(_));
        Self {
            stored: self.stored.clone(),
            external: None,
            dnc_buffer: None,
            current: self.current.filter(is_stored),
            capacity: self.capacity,
        }
    }

    /// Limits what is stored from now on. Programs beyond it, from an earlier version, remain.
    pub(crate) const fn set_capacity(&mut self, capacity: ProgramCapacity) {
        self.capacity = capacity;
    }

    /// Stores an unfinished text while it is being typed, without checks and capacity limits.
    pub fn overlay(&mut self, number: u16, program: Program) {
        self.stored.insert(number, program);
    }

    /// Changes the number of a program from `from` to `to`; it remains selected if it was.
    ///
    /// # Errors
    /// As [`Self::copy`].
    pub fn rename(&mut self, from: u16, to: u16) -> Result<(), Alarm> {
        let program = self
            .stored
            .get(&from)
            .ok_or_else(|| missing_program_alarm(from))?;
        let program = program.renumbered(to);
        self.check_number_free(to)?;
        self.stored.remove(&from);
        self.stored.insert(to, program);
        if self.current == Some(ProgramId::Stored(from)) {
            self.current = Some(ProgramId::Stored(to));
        }
        Ok(())
    }

    /// Deletes a stored program. If it was selected, selects the next one.
    ///
    /// # Errors
    /// 071 if the program is missing.
    pub fn delete(&mut self, number: u16) -> Result<(), Alarm> {
        self.stored
            .remove(&number)
            .ok_or_else(|| missing_program_alarm(number))?;
        self.select_existing();
        Ok(())
    }

    /// Deletes all stored programs whose numbers are in a range.
    pub fn delete_range(&mut self, numbers: &RangeInclusive<u16>) {
        self.stored.retain(|number, _| !numbers.contains(number));
        self.select_existing();
    }

    /// Opens a program outside the memory, e.g. a file, and closes an earlier one. It does not
    /// count towards the capacity.
    pub fn open_external(&mut self, program: Program) {
        self.external = Some(program);
        self.select_existing();
    }

    /// The external program; `None` if none is open.
    pub const fn external(&self) -> Option<&Program> {
        self.external.as_ref()
    }

    /// The program that arrives through the serial port; `None` outside DNC operation.
    pub const fn dnc_buffer(&self) -> Option<&DncBuffer> {
        self.dnc_buffer.as_ref()
    }

    /// Sets the buffer of a program that arrives through the serial port; `None` ends DNC
    /// operation.
    pub(crate) fn set_dnc_buffer(&mut self, inflow: Option<DncBuffer>) {
        self.dnc_buffer = inflow;
    }

    pub(crate) const fn dnc_buffer_mut(&mut self) -> Option<&mut DncBuffer> {
        self.dnc_buffer.as_mut()
    }

    /// Whether further text of the program `id` may arrive; `false` for all but the DNC
    /// program.
    pub(crate) fn has_more(&self, id: ProgramId) -> bool {
        id == ProgramId::Dnc && self.dnc_buffer.as_ref().is_some_and(DncBuffer::has_more)
    }

    /// Whether it makes sense to wait for a block after the last one of the program `id`;
    /// `false` for all but the DNC program.
    pub(crate) fn can_bring_block(&self, id: ProgramId) -> bool {
        id == ProgramId::Dnc
            && self
                .dnc_buffer
                .as_ref()
                .is_some_and(DncBuffer::can_bring_block)
    }

    /// The program `id`; `None` if it is missing. The MDI block is not part of the memory.
    pub fn get(&self, id: ProgramId) -> Option<&Program> {
        match id {
            ProgramId::Stored(number) => self.stored.get(&number),
            ProgramId::External => self.external.as_ref(),
            ProgramId::Dnc => self.dnc_buffer.as_ref().map(DncBuffer::window),
            ProgramId::Mdi => None,
        }
    }

    /// The program that a call of `number` runs: the stored one, otherwise the external one if
    /// it has the number; `None` if it is missing.
    pub(crate) fn find_called(&self, number: u16) -> Option<ProgramId> {
        if self.stored.contains_key(&number) {
            return Some(ProgramId::Stored(number));
        }
        let external = self.external.as_ref()?;
        (external.number() == Some(number)).then_some(ProgramId::External)
    }

    /// The stored program with this number; `None` if it is missing.
    pub fn stored(&self, number: u16) -> Option<&Program> {
        self.stored.get(&number)
    }

    /// The selected program; `None` if none is selected.
    pub const fn selected(&self) -> Option<ProgramId> {
        self.current
    }

    /// Selects a program; returns `false` if it is missing.
    pub fn select(&mut self, id: ProgramId) -> bool {
        let found = self.get(id).is_some();
        if found {
            self.current = Some(id);
        }
        found
    }

    /// The stored programs with their numbers, by ascending number.
    pub fn iter(&self) -> impl Iterator<Item = (u16, &Program)> {
        self.stored
            .iter()
            .map(|(&number, program)| (number, program))
    }

    /// Returns the number of stored programs.
    pub fn count(&self) -> usize {
        self.stored.len()
    }

    /// Number of programs that can still be stored.
    pub fn free_count(&self) -> usize {
        self.capacity.programs.saturating_sub(self.count())
    }

    /// Number of characters of all stored programs together.
    pub fn characters(&self) -> usize {
        self.stored.values().map(Program::characters).sum()
    }

    /// Number of characters that can still be stored.
    pub fn free_characters(&self) -> usize {
        self.capacity.characters.saturating_sub(self.characters())
    }

    fn insert_checked(&mut self, number: u16, program: Program) -> Result<(), Alarm> {
        if !PROGRAM_NUMBERS.contains(&number) {
            return Err(Alarm::new(number::PROGRAM_NUMBER)
                .with_detail(say::program_number_out_of_range(number)));
        }
        let replaced = self.stored.get(&number);
        if replaced.is_none() && self.count() >= self.capacity.programs {
            return Err(Alarm::new(number::TOO_MANY_PROGRAMS)
                .with_detail(say::program_places_used(self.capacity.programs)));
        }
        let free = self.free_characters() + replaced.map_or(0, Program::characters);
        if program.characters() > free {
            let size = program.characters();
            return Err(
                Alarm::new(number::MEMORY_FULL).with_detail(say::program_too_large(size, free))
            );
        }
        self.stored.insert(number, program);
        self.current.get_or_insert(ProgramId::Stored(number));
        Ok(())
    }

    fn check_number_free(&self, number: u16) -> Result<(), Alarm> {
        if self.stored.contains_key(&number) {
            return Err(Alarm::new(number::PROGRAM_EXISTS).with_detail(say::program_exists(number)));
        }
        if !PROGRAM_NUMBERS.contains(&number) {
            return Err(Alarm::new(number::PROGRAM_NUMBER)
                .with_detail(say::program_number_out_of_range(number)));
        }
        Ok(())
    }

    /// If the selected program was removed, selects the next stored one, otherwise the last
    /// one, otherwise the external program.
    fn select_existing(&mut self) {
        if self.current.is_some_and(|id| self.get(id).is_some()) {
            return;
        }
        let after = match self.current {
            Some(ProgramId::Stored(number)) => self.stored.range(number..).next(),
            _ => None,
        };
        let next = after
            .or_else(|| self.stored.last_key_value())
            .map(|(&number, _)| number);
        let external = self.external.as_ref().map(|_| ProgramId::External);
        self.current = next.map(ProgramId::Stored).or(external);
    }
}

fn missing_program_alarm(number: u16) -> Alarm {
    Alarm::new(number::NOT_FOUND).with_detail(say::program_not_in_memory(number))
}
