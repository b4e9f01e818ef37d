//! Who may write what, and when (manual III-1.3, III-2.5, III-2.6, III-8.1): the
//! one place where a write is allowed or refused.

use gsk_messages::say;

use super::authority::Level;
use super::parameters::Parameters;
use crate::alarm::{Alarm, number};
use crate::mode::Mode;

/// Programs from here on need more than the operator's level.
const PROTECTED_FROM: u16 = 9000;

/// The state that rights depend on.
#[derive(Clone, Copy, Debug)]
pub struct Rights<'a> {
    /// The parameters.
    pub parameters: &'a Parameters,
    /// The level in force.
    pub level: Level,
    /// The operating mode.
    pub mode: Mode,
    /// A program or an MDI block runs or is held.
    pub operating: bool,
    /// A block runs.
    pub running: bool,
    /// An axis moves.
    pub moving: bool,
    /// An alarm stands.
    pub alarm: bool,
    /// The emergency stop is open.
    pub emergency_stop: bool,
    /// 参数开关.
    pub parameter_switch: bool,
    /// 程序开关.
    pub program_switch: bool,
    /// Memory protection of the machine (KEY1, G46.3).
    pub protected: bool,
}

/// Why a write is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Another operating mode is needed.
    Mode,
    /// A program runs or is held, or an axis moves.
    Running,
    /// An alarm stands, and 012.3 EAL = 0.
    Alarm,
    /// 参数开关 is off.
    ParameterSwitch,
    /// 程序开关 is off.
    ProgramSwitch,
    /// The operation level is too low.
    Level,
    /// 172.1, 172.2 or the signal KEY1 locks it, or 012.4 hides the program.
    Locked,
}

impl Refusal {
    /// The alarm of a refused program operation; only the level has one.
    pub fn alarm(self) -> Option<Alarm> {
        (self == Self::Level)
            .then(|| Alarm::new(number::PROGRAM_NUMBER).because(say::level_too_low()))
    }
}

const fn unless(allowed: bool, refusal: Refusal) -> Result<(), Refusal> {
    if allowed { Ok(()) } else { Err(refusal) }
}

/// The level that moves a program through the serial port: above O9000 the machine
/// builder's.
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

    /// Editing, creating, deleting, renaming, copying a program.
    ///
    /// # Errors
    /// What stands against it.
    pub fn program(&self, number: u16) -> Result<(), Refusal> {
        unless(self.mode.edits(), Refusal::Mode)?;
        unless(!self.running, Refusal::Running)?;
        unless(
            !self.alarm || self.parameters.edits_in_alarm(),
            Refusal::Alarm,
        )?;
        self.program_memory(number)
    }

    /// Storing what was typed while it was allowed.
    ///
    /// # Errors
    /// What stands against it.
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

    /// Sending a program through the serial port (manual III-9.8.2).
    ///
    /// # Errors
    /// What stands against it.
    pub fn send_program(&self, number: u16) -> Result<(), Refusal> {
        self.may_send()?;
        unless(self.program_switch, Refusal::ProgramSwitch)?;
        unless(!self.hides(number), Refusal::Locked)?;
        self.level_at_most(serial_level(number))
    }

    /// Sending parameters, offsets or the pitch table.
    ///
    /// # Errors
    /// What stands against it.
    pub fn send_data(&self) -> Result<(), Refusal> {
        self.may_send()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// Handing a program out to whoever asks for it through the serial port: in any mode,
    /// at rest (manual III-9.5, III-9.8.2).
    ///
    /// # Errors
    /// What stands against it.
    pub fn fetch_program(&self, number: u16) -> Result<(), Refusal> {
        self.at_rest()?;
        unless(self.program_switch, Refusal::ProgramSwitch)?;
        unless(!self.hides(number), Refusal::Locked)?;
        self.level_at_most(serial_level(number))
    }

    /// Handing parameters, offsets or the pitch table out.
    ///
    /// # Errors
    /// What stands against it.
    pub fn fetch_data(&self) -> Result<(), Refusal> {
        self.at_rest()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        self.level_at_most(Level::WORKSHOP)
    }

    fn may_receive(&self) -> Result<(), Refusal> {
        self.at_rest()?;
        unless(!self.protected, Refusal::Locked)
    }

    /// Taking a program through the serial port.
    ///
    /// # Errors
    /// What stands against it.
    pub fn receive_program(&self, number: u16) -> Result<(), Refusal> {
        self.may_receive()?;
        unless(self.program_switch, Refusal::ProgramSwitch)?;
        let locked = self.parameters.program_switch_masked() || self.hides(number);
        unless(!locked, Refusal::Locked)?;
        self.level_at_most(serial_level(number))
    }

    /// Taking parameters, offsets or the pitch table through the serial port.
    ///
    /// # Errors
    /// What stands against it.
    pub fn receive_data(&self) -> Result<(), Refusal> {
        self.may_receive()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        unless(!self.parameters.parameter_switch_masked(), Refusal::Locked)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// Tool offsets.
    ///
    /// # Errors
    /// What stands against it.
    pub fn offsets(&self) -> Result<(), Refusal> {
        unless(!self.protected, Refusal::Locked)?;
        self.level_at_most(Level::OPERATOR)
    }

    /// Macro variables.
    ///
    /// # Errors
    /// What stands against it.
    pub fn variables(&self) -> Result<(), Refusal> {
        self.mdi()?;
        unless(!self.operating, Refusal::Running)?;
        self.level_at_most(Level::OPERATOR)
    }

    /// Rows of the setting page.
    ///
    /// # Errors
    /// What stands against it.
    pub fn settings(&self) -> Result<(), Refusal> {
        self.mdi()?;
        self.at_rest()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// 参数开关 itself.
    ///
    /// # Errors
    /// What stands against it.
    pub fn parameter_switch(&self) -> Result<(), Refusal> {
        unless(!self.operating, Refusal::Running)?;
        unless(!self.parameters.parameter_switch_masked(), Refusal::Locked)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// 程序开关 itself.
    ///
    /// # Errors
    /// What stands against it.
    pub fn program_switch(&self) -> Result<(), Refusal> {
        unless(!self.operating, Refusal::Running)?;
        unless(!self.parameters.program_switch_masked(), Refusal::Locked)?;
        self.level_at_most(Level::OPERATOR)
    }

    /// Parameters, the pitch table and the electronic disks.
    ///
    /// # Errors
    /// What stands against it.
    pub fn parameters(&self) -> Result<(), Refusal> {
        self.mdi_or_emergency_stop()?;
        self.at_rest()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        let locked = self.protected || self.parameters.parameter_switch_masked();
        unless(!locked, Refusal::Locked)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// The electronic disks.
    ///
    /// # Errors
    /// What stands against it.
    pub fn disks(&self) -> Result<(), Refusal> {
        self.mdi_or_emergency_stop()?;
        self.at_rest()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        unless(!self.protected, Refusal::Locked)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// 坐标选择 of the graphic, presets of the PLC, the tool in position (DGN.075).
    ///
    /// # Errors
    /// What stands against it.
    pub fn machine_data(&self) -> Result<(), Refusal> {
        self.mdi()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        unless(!self.protected, Refusal::Locked)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// A ladder with its messages, comments and initial data, taken over as a
    /// download is (manual PLC-III 6.1).
    ///
    /// # Errors
    /// What stands against it.
    pub fn ladder(&self) -> Result<(), Refusal> {
        unless(self.mode == Mode::Edit, Refusal::Mode)?;
        self.at_rest()?;
        unless(self.parameter_switch, Refusal::ParameterSwitch)?;
        unless(!self.protected, Refusal::Locked)?;
        self.level_at_most(Level::WORKSHOP)
    }

    /// The password page.
    ///
    /// # Errors
    /// What stands against it.
    pub fn password(&self) -> Result<(), Refusal> {
        unless(!self.operating, Refusal::Running)
    }
}

#[cfg(test)]
#[path = "rights_tests.rs"]
mod tests;
