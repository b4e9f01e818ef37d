//! Decides who may write which data, and when (manual III-1.3, III-2.5, III-2.6, III-8.1).
//! All writes are allowed or refused here.

use gsk_messages::say;

use super::authority::OperationLevel;
use super::parameters::ControlParameters;
use crate::alarm::{Alarm, number};
use crate::mode::OperatingMode;

/// Programs from this number need more than the operator's level.
const PROTECTED_FROM: u16 = 9000;

/// The state that the rights depend on.
#[derive(Clone, Copy, Debug)]
pub struct Rights<'a> {
    /// The active parameters.
    pub parameters: &'a ControlParameters,
    /// The active operation level.
    pub level: OperationLevel,
    /// The operating mode.
    pub mode: OperatingMode,
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
pub enum WriteRefusal {
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

impl WriteRefusal {
    /// The alarm of a refused program operation; only [`Self::Level`] has one.
    pub fn alarm(self) -> Option<Alarm> {
        (self == Self::Level)
            .then(|| Alarm::new(number::PROGRAM_NUMBER).with_detail(say::level_too_low()))
    }
}

const fn require(allowed: bool, refusal: WriteRefusal) -> Result<(), WriteRefusal> {
    if allowed { Ok(()) } else { Err(refusal) }
}

/// The level that may send and receive a program through the serial port: above O9000 the
/// machine builder's.
const fn serial_level(number: u16) -> OperationLevel {
    if number <= PROTECTED_FROM {
        OperationLevel::OPERATOR
    } else {
        OperationLevel::BUILDER
    }
}

impl Rights<'_> {
    fn require_level(&self, level: OperationLevel) -> Result<(), WriteRefusal> {
        require(self.level <= level, WriteRefusal::Level)
    }

    fn require_standstill(&self) -> Result<(), WriteRefusal> {
        require(!self.operating && !self.moving, WriteRefusal::Running)
    }

    fn require_mdi(&self) -> Result<(), WriteRefusal> {
        require(self.mode == OperatingMode::Mdi, WriteRefusal::Mode)
    }

    fn require_mdi_or_emergency_stop(&self) -> Result<(), WriteRefusal> {
        require(
            self.mode == OperatingMode::Mdi || self.emergency_stop,
            WriteRefusal::Mode,
        )
    }

    /// Whether 012.4 PRG9 hides a program.
    pub fn is_hidden(&self, program: u16) -> bool {
        self.parameters.are_upper_programs_hidden() && program >= PROTECTED_FROM
    }

    /// Checks editing, creating, deleting, renaming or copying a program.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_program_edit(&self, number: u16) -> Result<(), WriteRefusal> {
        require(self.mode.edits(), WriteRefusal::Mode)?;
        require(!self.running, WriteRefusal::Running)?;
        require(
            !self.alarm || self.parameters.can_edit_in_alarm(),
            WriteRefusal::Alarm,
        )?;
        self.check_program_store(number)
    }

    /// Checks storing text that was typed while editing was allowed.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_program_store(&self, number: u16) -> Result<(), WriteRefusal> {
        require(self.program_switch, WriteRefusal::ProgramSwitch)?;
        let locked =
            self.protected || self.parameters.is_program_switch_masked() || self.is_hidden(number);
        require(!locked, WriteRefusal::Locked)?;
        self.require_level(if number < PROTECTED_FROM {
            OperationLevel::OPERATOR
        } else {
            OperationLevel::WORKSHOP
        })
    }

    fn require_send(&self) -> Result<(), WriteRefusal> {
        require(self.mode == OperatingMode::Edit, WriteRefusal::Mode)?;
        require(!self.operating, WriteRefusal::Running)
    }

    /// Checks sending a program through the serial port (manual III-9.8.2).
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_send_program(&self, number: u16) -> Result<(), WriteRefusal> {
        self.require_send()?;
        require(self.program_switch, WriteRefusal::ProgramSwitch)?;
        require(!self.is_hidden(number), WriteRefusal::Locked)?;
        self.require_level(serial_level(number))
    }

    /// Checks sending parameters, offsets or the pitch table.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_send_data(&self) -> Result<(), WriteRefusal> {
        self.require_send()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks sending a program that the partner on the serial port requests: in any mode,
    /// at standstill (manual III-9.5, III-9.8.2).
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_fetch_program(&self, number: u16) -> Result<(), WriteRefusal> {
        self.require_standstill()?;
        require(self.program_switch, WriteRefusal::ProgramSwitch)?;
        require(!self.is_hidden(number), WriteRefusal::Locked)?;
        self.require_level(serial_level(number))
    }

    /// Checks sending parameters, offsets or the pitch table that the partner requests.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_fetch_data(&self) -> Result<(), WriteRefusal> {
        self.require_standstill()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    fn require_receive(&self) -> Result<(), WriteRefusal> {
        self.require_standstill()?;
        require(!self.protected, WriteRefusal::Locked)
    }

    /// Checks receiving a program through the serial port.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_receive_program(&self, number: u16) -> Result<(), WriteRefusal> {
        self.require_receive()?;
        require(self.program_switch, WriteRefusal::ProgramSwitch)?;
        let locked = self.parameters.is_program_switch_masked() || self.is_hidden(number);
        require(!locked, WriteRefusal::Locked)?;
        self.require_level(serial_level(number))
    }

    /// Checks receiving parameters, offsets or the pitch table through the serial port.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_receive_data(&self) -> Result<(), WriteRefusal> {
        self.require_receive()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        require(
            !self.parameters.is_parameter_switch_masked(),
            WriteRefusal::Locked,
        )?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks writing tool offsets.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_offsets(&self) -> Result<(), WriteRefusal> {
        require(!self.protected, WriteRefusal::Locked)?;
        self.require_level(OperationLevel::OPERATOR)
    }

    /// Checks writing macro variables.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_variables(&self) -> Result<(), WriteRefusal> {
        self.require_mdi()?;
        require(!self.operating, WriteRefusal::Running)?;
        self.require_level(OperationLevel::OPERATOR)
    }

    /// Checks writing rows of the setting page.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_settings(&self) -> Result<(), WriteRefusal> {
        self.require_mdi()?;
        self.require_standstill()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks operating the parameter switch (参数开关).
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_parameter_switch(&self) -> Result<(), WriteRefusal> {
        require(!self.operating, WriteRefusal::Running)?;
        require(
            !self.parameters.is_parameter_switch_masked(),
            WriteRefusal::Locked,
        )?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks operating the program switch (程序开关).
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_program_switch(&self) -> Result<(), WriteRefusal> {
        require(!self.operating, WriteRefusal::Running)?;
        require(
            !self.parameters.is_program_switch_masked(),
            WriteRefusal::Locked,
        )?;
        self.require_level(OperationLevel::OPERATOR)
    }

    /// Checks writing parameters and the pitch table.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_parameters(&self) -> Result<(), WriteRefusal> {
        self.require_mdi_or_emergency_stop()?;
        self.require_standstill()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        let locked = self.protected || self.parameters.is_parameter_switch_masked();
        require(!locked, WriteRefusal::Locked)?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks loading and saving the electronic disks.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_disks(&self) -> Result<(), WriteRefusal> {
        self.require_mdi_or_emergency_stop()?;
        self.require_standstill()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        require(!self.protected, WriteRefusal::Locked)?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks writing 坐标选择 of the graphic, presets of the PLC, and the tool in position
    /// (DGN.075).
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_machine_data(&self) -> Result<(), WriteRefusal> {
        self.require_mdi()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        require(!self.protected, WriteRefusal::Locked)?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks loading a ladder with its messages, comments and initial data (manual PLC-III
    /// 6.1).
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_ladder(&self) -> Result<(), WriteRefusal> {
        require(self.mode == OperatingMode::Edit, WriteRefusal::Mode)?;
        self.require_standstill()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        require(!self.protected, WriteRefusal::Locked)?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks opening the password page.
    ///
    /// # Errors
    /// The first unmet condition.
    pub fn check_password(&self) -> Result<(), WriteRefusal> {
        require(!self.operating, WriteRefusal::Running)
    }
}

#[cfg(test)]
#[path = "rights_tests.rs"]
mod tests;
