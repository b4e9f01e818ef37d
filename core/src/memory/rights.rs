//! Decides who may write which data, and when (manual III-1.3, III-2.5, III-2.6, III-8.1).
//! All writes are allowed or refused here.

use gsk_messages::say;

use super::authority::Level;
use super::parameters::Parameters;
use crate::alarm::{Alarm, number};
use crate::mode::Mode;

/// Programs from this number need more than the operator's level.
const PROTECTED_FROM: u16 = 9000;

/// The state that the rights depend on.
#[derive(Clone, Copy, Debug)]
pub struct Rights<'a> {
    /// The active parameters.
    pub parameters: &'a Parameters,
    /// The active operation level.
    pub level: Level,
    /// The operating mode.
    pub mode: Mode,
    /// A program or an MDI block is running or held.
    pub operating: bool,
    /// A block is running.
    pub running: bool,
    /// An axis moves.
    pub moving: bool,
    /// An alarm is active.
    pub alarm: bool,
    /// The emergency stop is pressed.
    pub emergency_stop: bool,
    /// 参数开关: the parameter switch is on.
    pub parameter_switch: bool,
    /// 程序开关: the program switch is on.
    pub program_switch: bool,
    /// The machine protects the memory (KEY1, G46.3).
    pub protected: bool,
}

/// The reason why a write is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Another operating mode is needed.
    Mode,
    /// A program is running or held, or an axis moves.
    Running,
    /// An alarm is active, and 012.3 EAL = 0.
    Alarm,
    /// The parameter switch (参数开关) is off.
    ParameterSwitch,
    /// The program switch (程序开关) is off.
    ProgramSwitch,
    /// The operation level is too low.
    Level,
    /// 172.1, 172.2 or the signal KEY1 locks the data, or 012.4 hides the program.
    Locked,
}

impl Refusal {
    /// The alarm of a refused program operation; only [`Self::Level`] has one.
    pub fn alarm(self) -> Option<Alarm> {
        (self == Self::Level)
            .then(|| Alarm::new(number::PROGRAM_NUMBER).because(say::level_too_low()))
    }
}

const fn unless(allowed: bool, refusal: Refusal) -> Result<(), Refusal> {
    if allowed { Ok(()) } else { Err(refusal) }
}

/// The level that may send and receive a program through the serial port: above O9000 the
/// machine builder's.
const fn serial_level(number: u16) -> Level {
    if number <= PROTECTED_FROM {
        Level::OPERATOR
    } else {
        Level::BUILDER
    }
}

impl Rights<'_> {
    fn level_at_most(&self, level: Level) -> Result<(), Refusal> {
        unless(self.level <= level, Refusal::Level)
    }

    fn at_rest(&self) -> Result<(), Refusal> {
        unless(!self.operating && !self.moving, Refusal::Running)
    }

    fn mdi(&self) -> Result<(), Refusal> {
        unless(self.mode == Mode::Mdi, Refusal::Mode)
    }

    fn mdi_or_emergency_stop(&self) -> Result<(), Refusal> {
        unless(self.mode == Mode::Mdi || self.emergency_stop, Refusal::Mode)
    }

    /// Whether 012.4 PRG9 hides a program.
    pub fn hides(&self, program: u16) -> bool {
        self.parameters.hides_upper_programs() && program >= PROTECTED_FROM
    }

    /// Checks editing, creating, deleting, renaming or copying a program.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn program(&self, number: u16) -> Result<(), Refusal> {
        unless(self.mode.edits(), Refusal::Mode)?;
        unless(!self.running, Refusal::Running)?;
        unless(
            !self.alarm || self.parameters.edits_in_alarm(),
            Refusal::Alarm,
        )?;
        self.program_memory(number)
    }

    /// Checks storing text that was typed while editing was allowed.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn program_memory(&self, number: u16) -> Result<(), Refusal> {
        unless(self.program_switch, Refusal::ProgramSwitch)?;
        let locked =
            self.protected || self.parameters.program_switch_masked() || self.hides(number);
        unless(!locked, Refusal::Locked)?;
        self.level_at_most(if number < PROTECTED_FROM {
            Level::OPERATOR
        } else {
            Level::WORKSHOP
        })
    }

    fn may_send(&self) -> Result<(), Refusal> {
        unless(self.mode == Mode::Edit, Refusal::Mode)?;
        unless(!self.operating, Refusal::Running)
    }

    /// Checks sending a program through the serial port (manual III-9.8.2).
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn send_program(&self, number: u16) -> Result<(), Refusal> {
        self.may_send()?;
        unless(self.program_switch, Refusal::ProgramSwitch)?;
        unless(!self.hides(number), Refusal::Locked)?;
        self.level_at_most(serial_level(number))
    }

    /// Checks sending parameters, offsets or the pitch table.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn send_data(&self) -> Result<(), Refusal> {
        self.may_send()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// Checks sending a program that the partner on the serial port requests: in any mode,
    /// at standstill (manual III-9.5, III-9.8.2).
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn fetch_program(&self, number: u16) -> Result<(), Refusal> {
        self.at_rest()?;
        unless(self.program_switch, Refusal::ProgramSwitch)?;
        unless(!self.hides(number), Refusal::Locked)?;
        self.level_at_most(serial_level(number))
    }

    /// Checks sending parameters, offsets or the pitch table that the partner requests.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn fetch_data(&self) -> Result<(), Refusal> {
        self.at_rest()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        self.level_at_most(Level::WORKSHOP)
    }

    fn may_receive(&self) -> Result<(), Refusal> {
        self.at_rest()?;
        unless(!self.protected, Refusal::Locked)
    }

    /// Checks receiving a program through the serial port.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn receive_program(&self, number: u16) -> Result<(), Refusal> {
        self.may_receive()?;
        unless(self.program_switch, Refusal::ProgramSwitch)?;
        let locked = self.parameters.program_switch_masked() || self.hides(number);
        unless(!locked, Refusal::Locked)?;
        self.level_at_most(serial_level(number))
    }

    /// Checks receiving parameters, offsets or the pitch table through the serial port.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn receive_data(&self) -> Result<(), Refusal> {
        self.may_receive()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        unless(!self.parameters.parameter_switch_masked(), Refusal::Locked)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// Checks writing tool offsets.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn offsets(&self) -> Result<(), Refusal> {
        unless(!self.protected, Refusal::Locked)?;
        self.level_at_most(Level::OPERATOR)
    }

    /// Checks writing macro variables.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn variables(&self) -> Result<(), Refusal> {
        self.mdi()?;
        unless(!self.operating, Refusal::Running)?;
        self.level_at_most(Level::OPERATOR)
    }

    /// Checks writing rows of the setting page.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn settings(&self) -> Result<(), Refusal> {
        self.mdi()?;
        self.at_rest()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// Checks operating the parameter switch (参数开关).
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn parameter_switch(&self) -> Result<(), Refusal> {
        unless(!self.operating, Refusal::Running)?;
        unless(!self.parameters.parameter_switch_masked(), Refusal::Locked)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// Checks operating the program switch (程序开关).
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn program_switch(&self) -> Result<(), Refusal> {
        unless(!self.operating, Refusal::Running)?;
        unless(!self.parameters.program_switch_masked(), Refusal::Locked)?;
        self.level_at_most(Level::OPERATOR)
    }

    /// Checks writing parameters and the pitch table.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn parameters(&self) -> Result<(), Refusal> {
        self.mdi_or_emergency_stop()?;
        self.at_rest()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        let locked = self.protected || self.parameters.parameter_switch_masked();
        unless(!locked, Refusal::Locked)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// Checks loading and saving the electronic disks.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn disks(&self) -> Result<(), Refusal> {
        self.mdi_or_emergency_stop()?;
        self.at_rest()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        unless(!self.protected, Refusal::Locked)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// Checks writing 坐标选择 of the graphic, presets of the PLC, and the tool in position
    /// (DGN.075).
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn machine_data(&self) -> Result<(), Refusal> {
        self.mdi()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        unless(!self.protected, Refusal::Locked)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// Checks loading a ladder with its messages, comments and initial data (manual PLC-III
    /// 6.1).
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn ladder(&self) -> Result<(), Refusal> {
        unless(self.mode == Mode::Edit, Refusal::Mode)?;
        self.at_rest()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        unless(!self.protected, Refusal::Locked)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// Checks opening the password page.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn password(&self) -> Result<(), Refusal> {
        unless(!self.operating, Refusal::Running)
    }
}

#[cfg(test)]
#[path = "rights_tests.rs"]
mod tests;
