//! Decides who may write which data, and when (manual III-1.3, III-2.5, III-2.6, III-8.1).
//! All writes are allowed or refused here.

use gsk_messages::say;

use super::authority::OperationLevel;
use super::parameters::ControlParameters;
use crate::alarm::{Alarm, number};
use crate::mode::OperatingMode;

/// Programs from this number on need more rights than the operator's level has.
const PROTECTED_FROM: u16 = 9000;

/// The state of the control on which write rights depend.
#[derive(Clone, Copy, Debug)]
pub struct Rights<'a> {
    /// The active values of the parameters.
    pub parameters: &'a ControlParameters,
    /// The operation level that is active.
    pub level: OperationLevel,
    /// The operating mode that is active.
    pub mode: OperatingMode,
    /// Whether a program or an MDI block is running or held.
    pub operating: bool,
    /// Whether a block of a program is running.
    pub running: bool,
    /// Whether any axis moves.
    pub moving: bool,
    /// Whether any alarm is active.
    pub alarm: bool,
    /// Whether the emergency stop is pressed.
    pub emergency_stop: bool,
    /// 参数开关: whether the parameter switch is on.
    pub parameter_switch: bool,
    /// 程序开关: whether the program switch is on.
    pub program_switch: bool,
    /// Whether the machine locks the memory (signal KEY1, G46.3).
    pub protected: bool,
}

/// The reason for which a write is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WriteRefusal {
    /// The write requires another operating mode.
    Mode,
    /// A program is running or held, or an axis is moving.
    Running,
    /// An alarm is active, and 012.3 EAL = 0 forbids editing meanwhile.
    Alarm,
    /// The write is refused because the parameter switch (参数开关) is off.
    ParameterSwitch,
    /// The write is refused because the program switch (程序开关) is off.
    ProgramSwitch,
    /// The write is refused because the operation level has too few rights.
    Level,
    /// The write is refused because 172.1, 172.2 or the signal KEY1 locks the data, or 012.4 hides
    /// the program.
    Locked,
}

impl WriteRefusal {
    /// The alarm of a refused operation on a program; `None` for all reasons but
    /// [`Self::Level`].
    pub fn alarm(self) -> Option<Alarm> {
        (self == Self::Level)
            .then(|| Alarm::new(number::PROGRAM_NUMBER).with_detail(say::level_too_low()))
    }
}

const fn require(allowed: bool, refusal: WriteRefusal) -> Result<(), WriteRefusal> {
    if allowed { Ok(()) } else { Err(refusal) }
}

/// The level needed to send or receive the program `number` through the serial port: above
/// O9000 the machine builder's.
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

    /// Whether 012.4 PRG9 hides the program `program`.
    pub fn is_hidden(&self, program: u16) -> bool {
        self.parameters.are_upper_programs_hidden() && program >= PROTECTED_FROM
    }

    /// Checks whether the program `number` may be edited, created, deleted, renamed or copied.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_program_edit(&self, number: u16) -> Result<(), WriteRefusal> {
        require(self.mode.edits(), WriteRefusal::Mode)?;
        require(!self.running, WriteRefusal::Running)?;
        require(
            !self.alarm || self.parameters.can_edit_in_alarm(),
            WriteRefusal::Alarm,
        )?;
        self.check_program_store(number)
    }

    /// Checks whether text of the program `number`, typed while editing was allowed, may be
    /// stored.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
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

    /// Checks whether the operator may send the program `number` through the serial port
    /// (manual III-9.8.2).
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_send_program(&self, number: u16) -> Result<(), WriteRefusal> {
        self.require_send()?;
        require(self.program_switch, WriteRefusal::ProgramSwitch)?;
        require(!self.is_hidden(number), WriteRefusal::Locked)?;
        self.require_level(serial_level(number))
    }

    /// Checks whether the operator may send parameters, offsets or the pitch table through the
    /// serial port.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_send_data(&self) -> Result<(), WriteRefusal> {
        self.require_send()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks whether the control may send the program `number` because the other end of the
    /// serial port requests it: in any mode, at standstill (manual III-9.5, III-9.8.2).
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_fetch_program(&self, number: u16) -> Result<(), WriteRefusal> {
        self.require_standstill()?;
        require(self.program_switch, WriteRefusal::ProgramSwitch)?;
        require(!self.is_hidden(number), WriteRefusal::Locked)?;
        self.require_level(serial_level(number))
    }

    /// Checks whether the control may send parameters, offsets or the pitch table because the
    /// other end of the serial port requests them.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_fetch_data(&self) -> Result<(), WriteRefusal> {
        self.require_standstill()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    fn require_receive(&self) -> Result<(), WriteRefusal> {
        self.require_standstill()?;
        require(!self.protected, WriteRefusal::Locked)
    }

    /// Checks whether the program `number` may be received through the serial port.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_receive_program(&self, number: u16) -> Result<(), WriteRefusal> {
        self.require_receive()?;
        require(self.program_switch, WriteRefusal::ProgramSwitch)?;
        let locked = self.parameters.is_program_switch_masked() || self.is_hidden(number);
        require(!locked, WriteRefusal::Locked)?;
        self.require_level(serial_level(number))
    }

    /// Checks whether parameters, offsets or the pitch table may be received through the
    /// serial port.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_receive_data(&self) -> Result<(), WriteRefusal> {
        self.require_receive()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        require(
            !self.parameters.is_parameter_switch_masked(),
            WriteRefusal::Locked,
        )?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks whether tool offsets may be written.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_offsets(&self) -> Result<(), WriteRefusal> {
        require(!self.protected, WriteRefusal::Locked)?;
        self.require_level(OperationLevel::OPERATOR)
    }

    /// Checks whether macro variables may be written.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_variables(&self) -> Result<(), WriteRefusal> {
        self.require_mdi()?;
        require(!self.operating, WriteRefusal::Running)?;
        self.require_level(OperationLevel::OPERATOR)
    }

    /// Checks whether rows of the setting page may be written.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_settings(&self) -> Result<(), WriteRefusal> {
        self.require_mdi()?;
        self.require_standstill()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks whether the parameter switch (参数开关) may be switched.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_parameter_switch(&self) -> Result<(), WriteRefusal> {
        require(!self.operating, WriteRefusal::Running)?;
        require(
            !self.parameters.is_parameter_switch_masked(),
            WriteRefusal::Locked,
        )?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks whether the program switch (程序开关) may be switched.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_program_switch(&self) -> Result<(), WriteRefusal> {
        require(!self.operating, WriteRefusal::Running)?;
        require(
            !self.parameters.is_program_switch_masked(),
            WriteRefusal::Locked,
        )?;
        self.require_level(OperationLevel::OPERATOR)
    }

    /// Checks whether parameters and the pitch table may be written.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_parameters(&self) -> Result<(), WriteRefusal> {
        self.require_mdi_or_emergency_stop()?;
        self.require_standstill()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        let locked = self.protected || self.parameters.is_parameter_switch_masked();
        require(!locked, WriteRefusal::Locked)?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks whether the electronic disks may be loaded and saved.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_disks(&self) -> Result<(), WriteRefusal> {
        self.require_mdi_or_emergency_stop()?;
        self.require_standstill()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        require(!self.protected, WriteRefusal::Locked)?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks whether 坐标选择 (the axes) of the graphic, presets of the PLC, and the tool in
    /// position (DGN.075) may be written.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_machine_data(&self) -> Result<(), WriteRefusal> {
        self.require_mdi()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        require(!self.protected, WriteRefusal::Locked)?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks whether a ladder with its messages, comments and initial data may be loaded
    /// (manual PLC-III 6.1).
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_ladder(&self) -> Result<(), WriteRefusal> {
        require(self.mode == OperatingMode::Edit, WriteRefusal::Mode)?;
        self.require_standstill()?;
        require(self.parameter_switch, WriteRefusal::ParameterSwitch)?;
        require(!self.protected, WriteRefusal::Locked)?;
        self.require_level(OperationLevel::WORKSHOP)
    }

    /// Checks whether the password page may be opened.
    ///
    /// # Errors
    /// The reason of the first unmet condition.
    pub fn check_password(&self) -> Result<(), WriteRefusal> {
        require(!self.operating, WriteRefusal::Running)
    }
}

#[cfg(test)]
#[path = "rights_tests.rs"]
mod tests;
