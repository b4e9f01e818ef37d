//! Requests about offsets, parameters, settings, disks and presets
//! (manual III-2.3, III-2.5, III-2.6, III-7).

use std::sync::Arc;

use gsk_messages::say;
use gsk_plc::Ladder;
use gsk_plc::address::{Area, ByteAddress};

use super::OffsetEntry;
use crate::alarm::{Alarm, number};
use crate::axis::SoftLimits;
use crate::cnc::{Cnc, TIMER_PRESETS};
use crate::memory::{
    Authority, ControlParameters, DiskContent, ElectronicDisk, ParameterError, SettingRow,
    ToolOffset, Variables, parameter,
};
use crate::motion::MotionLimits;
use crate::setup::TOOL_IN_POSITION;
use crate::spindle::SpindleAngle;
use crate::units::Axis;

/// The highest tool number that DGN.075 accepts.
const LAST_TOOL: u8 = 32;
/// Parameters that determine the scale of the spindle angle.
const ENCODER: [u16; 3] = [
    parameter::ENCODER_LINES,
    parameter::SPINDLE_TEETH,
    parameter::ENCODER_TEETH,
];
/// Number of millimetres in an inch.
const MM_PER_INCH: f64 = 25.4;

impl Cnc {
    /// Adds a word to the block of the MDI page; returns the alarm of an invalid word as error.
    pub(super) fn add_mdi_word(&mut self, word: &str) -> Result<(), Alarm> {
        let macro_b = self.are_variables_real();
        self.run.mdi.enter(word, &self.memory.parameters, macro_b)?;
        Ok(())
    }

    pub(super) fn set_variable(&mut self, number: u16, value: i64) -> Result<(), Alarm> {
        if self.rights().check_variables().is_ok() {
            self.memory.variables.set(number, value)?;
        }
        Ok(())
    }

    /// Sets a parameter within its range in the selected control model; returns an alarm as error
    /// if the value is out of range.
    pub(super) fn set_parameter(&mut self, number: u16, value: i32) -> Result<(), Alarm> {
        let record = self.memory.model.record();
        self.change_parameters(|parameters| parameters.set_for_model(record, number, value))
    }

    /// Sets a parameter that only the selected control model has; returns an alarm as error if
    /// the value is out of range or the model has no such parameter.
    pub(super) fn set_model_parameter(&mut self, number: u16, value: i32) -> Result<(), Alarm> {
        if self.rights().check_parameters().is_err() {
            return Ok(());
        }
        let outputs = self.program_outputs();
        let set = self.memory.model.set_parameter(number, value);
        set.map_err(|why| Alarm::new(number::OUT_OF_RANGE).with_detail(why))?;
        // Another assignment switches no output and is no edge of an input.
        self.set_program_outputs(outputs);
        self.plc.input_levels = self.edge_levels();
        Ok(())
    }

    /// Shifts the work zero so that the tool is at the coordinate `value`.
    pub(super) fn set_coordinate(&mut self, axis: Axis, value: f64) {
        if self.rights().check_offsets().is_err() || self.is_moving() {
            return;
        }
        let shift = self.position_absolute().get(axis) - value;
        *self.coordinates.frame.zero.get_mut(axis) += shift;
        self.send_frame();
    }

    pub(super) fn set_program_switch(&mut self, on: bool) {
        if self.rights().check_program_switch().is_ok() {
            self.switches.programs = on;
        }
    }

    /// Changes passwords or the operation level, if the operator is permitted to.
    pub(super) fn change_authority<R>(&mut self, change: impl FnOnce(&mut Authority) -> R) {
        if self.rights().check_password().is_ok() {
            change(&mut self.memory.authority);
        }
    }

    pub(super) fn load_ladder(&mut self, ladder: Arc<Ladder>) {
        if self.rights().check_ladder().is_ok() {
            self.plc.next_ladder = Some(ladder);
        }
    }

    /// Sets a tool offset as the offset page does (manual III-7): stores the value, computes the
    /// offset from a measured coordinate, adds the value, or takes the relative coordinate. Returns
    /// alarm 030 or 043 as error.
    pub(super) fn set_offset(&mut self, number: u8, entry: OffsetEntry) -> Result<(), Alarm> {
        if self.rights().check_offsets().is_err() {
            return Ok(());
        }
        let mut offset = self.memory.offsets.get(number);
        let (axis, value) = match entry {
            OffsetEntry::NoseRadius(r) => {
                offset.r = self.to_mm(r);
                return self.store_offset(number, offset);
            }
            OffsetEntry::StoredRadius(r) => {
                offset.r = r;
                return self.store_offset(number, offset);
            }
            OffsetEntry::NoseNumber(t) => {
                offset.t = t;
                return self.store_offset(number, offset);
            }
            OffsetEntry::RelativeCoordinate(_)
                if self.memory.parameters.is_counter_input_locked() =>
            {
                return Ok(());
            }
            OffsetEntry::RelativeCoordinate(axis) => (
                axis,
                self.to_offset(axis, self.position_relative().get(axis)),
            ),
            OffsetEntry::Change(axis, change) => {
                let old = match axis {
                    Axis::X => offset.x,
                    Axis::Z => offset.z,
                };
                (axis, old + self.to_mm(change))
            }
            OffsetEntry::Length(axis, value)
                if self.memory.parameters.can_type_measured_offsets() =>
            {
                (axis, self.measured_offset(axis, self.to_mm(value)))
            }
            OffsetEntry::Length(axis, value) => (axis, self.to_mm(value)),
            OffsetEntry::Stored(axis, value) => (axis, value),
        };
        match axis {
            Axis::X => offset.x = value,
            Axis::Z => offset.z = value,
        }
        self.store_offset(number, offset)
    }

    /// Stores an offset under a number. Number 000 exists only for the work shift (012.6 WSFT).
    /// Returns the alarm of a wrong number or value as error.
    fn store_offset(&mut self, number: u8, offset: ToolOffset) -> Result<(), Alarm> {
        if number == 0 && self.memory.parameters.has_work_shift() {
            self.memory.offsets.set_work_shift(offset)
        } else {
            self.memory.offsets.set(number, offset)
        }
    }

    /// Calculates an offset from a measured coordinate, mm: the displayed coordinate, plus the
    /// current offset (005.1 PPD), minus the measured coordinate.
    fn measured_offset(&self, axis: Axis, coordinate: f64) -> f64 {
        let radius = match axis {
            Axis::X if !self.memory.parameters.is_radius_programming() => coordinate / 2.0,
            Axis::X | Axis::Z => coordinate,
        };
        let in_force = if self.memory.parameters.g50_sets_relative() {
            self.coordinates.frame.offset.get(axis)
        } else {
            0.0
        };
        self.to_offset(axis, self.position_absolute().get(axis) + in_force - radius)
    }

    /// Converts slide travel (mm) to the scale of the offset page: X as a diameter unless
    /// 004.4 ORC = 1.
    fn to_offset(&self, axis: Axis, distance: f64) -> f64 {
        match axis {
            Axis::X if !self.memory.parameters.is_offset_radius() => distance * 2.0,
            Axis::X | Axis::Z => distance,
        }
    }

    fn to_mm(&self, value: f64) -> f64 {
        if self.memory.parameters.is_inch_machine() {
            value * MM_PER_INCH
        } else {
            value
        }
    }

    /// Changes parameters and applies them, if the operator is permitted to. Returns the alarm of
    /// an invalid value as error.
    pub(super) fn change_parameters(
        &mut self,
        change: impl FnOnce(&mut ControlParameters) -> Result<(), ParameterError>,
    ) -> Result<(), Alarm> {
        if self.rights().check_parameters().is_err() {
            return Ok(());
        }
        let mut changed = self.memory.parameters.clone();
        change(&mut changed)?;
        self.apply_parameters(changed);
        Ok(())
    }

    /// Applies new values of all parameters. Some of them take effect only at the next power-on;
    /// then alarm 000 is raised.
    pub(super) fn apply_parameters(&mut self, changed: ControlParameters) {
        let needs_power_cycle = changed.needs_power_cycle(&self.memory.parameters);
        let encoder = ENCODER
            .iter()
            .any(|&number| changed.value(number) != self.memory.parameters.value(number));
        self.memory.parameters = changed;
        let in_force = self.memory.parameters.active_values(&self.at_power_on);
        self.drives.limits = MotionLimits::from_model(&in_force, &self.memory.model);
        self.drives.soft_limits = SoftLimits::new(&in_force);
        self.drives
            .axis_chain
            .reconfigure(&in_force, &self.memory.pitch);
        self.spindle.control.reconfigure(&in_force);
        if encoder {
            self.spindle.angle = SpindleAngle::new(&in_force);
        }
        for (entry, parameter) in TIMER_PRESETS {
            let time = self.memory.parameters.timer_ms(parameter);
            self.plc.engine.memory_mut().set_dt(entry, time);
        }
        if needs_power_cycle {
            self.raise(Alarm::new(number::POWER_CYCLE).with_detail(say::parameter_at_power_on()));
        }
    }

    /// Sets a variable of macro B (a local variable only while no program runs) or of the Huaxing
    /// lathes; `None` makes it null. Returns the alarm of an invalid number or value as error.
    pub(super) fn set_macro_variable(
        &mut self,
        number: u16,
        value: Option<f64>,
    ) -> Result<(), Alarm> {
        if self.rights().check_variables().is_err() {
            return Ok(());
        }
        if self.memory.model.record().own_variables {
            return self.memory.variables.set_huaxing_value(number, value);
        }
        match u8::try_from(number) {
            Ok(local @ 1..=33) if !self.run.automatic.is_operating() => {
                let value = value.map(|value| Variables::check_real(number, value));
                self.run
                    .interpreter
                    .set_local_variable(local, value.transpose()?);
                Ok(())
            }
            Ok(1..=33) => Ok(()),
            _ => self.memory.variables.set_real(number, value),
        }
    }

    /// Sets a point of the pitch error table of an axis to `value`, in 0.001 mm, if the operator is
    /// permitted to.
    pub(super) fn set_pitch(&mut self, axis: Axis, point: u8, value: i16) -> Result<(), Alarm> {
        if self.rights().check_parameters().is_ok() {
            self.memory.pitch.set(axis, point, value)?;
            let in_force = self.memory.parameters.active_values(&self.at_power_on);
            self.drives
                .axis_chain
                .reconfigure(&in_force, &self.memory.pitch);
        }
        Ok(())
    }

    pub(super) fn set_setting(&mut self, setting: SettingRow, on: bool) {
        if self.rights().check_settings().is_err() {
            return;
        }
        self.memory.settings.set(setting, on);
        if setting == SettingRow::Inch {
            self.run.interpreter.set_inch_input(on);
            self.run.modal.inch = on;
        }
    }

    /// Switches 参数开关: on raises alarm 100, off clears it (manual III-2.5.1).
    pub(super) fn set_parameter_switch(&mut self, on: bool) {
        // Off is always the safe side: only a run in progress forbids it.
        let refused = if on {
            self.rights().check_parameter_switch().is_err()
        } else {
            self.run.automatic.is_operating()
        };
        if refused || self.switches.parameters == on {
            return;
        }
        self.switches.parameters = on;
        if on {
            self.raise(Alarm::new(number::PARAMETER_SWITCH));
        } else {
            self.cancel_switch_alarm();
        }
    }

    pub(super) fn cancel_switch_alarm(&mut self) {
        self.alarms.remove(number::PARAMETER_SWITCH);
    }

    pub(super) fn load_disk(&mut self, disk: ElectronicDisk) {
        if self.rights().check_disks().is_ok() {
            let content = self.memory.disks.load(disk, self.memory.model.record());
            self.memory.offsets = content.offsets;
            self.memory.pitch = content.pitch;
            self.apply_parameters(content.parameters);
        }
    }

    pub(super) fn save_disk(&mut self, disk: ElectronicDisk) {
        if self.rights().check_disks().is_ok() {
            let content = DiskContent {
                parameters: self.memory.parameters.clone(),
                offsets: self.memory.offsets.clone(),
                pitch: self.memory.pitch.clone(),
            };
            self.memory.disks.save(disk, content);
        }
    }

    /// Sets the number of the tool in position (DGN.075), after the tool post was turned manually
    /// with the power off. Returns an alarm as error if the number is out of range.
    pub(super) fn set_tool_in_position(&mut self, tool: u8) -> Result<(), Alarm> {
        if self.rights().check_machine_data().is_err() || self.run.automatic.is_operating() {
            return Ok(());
        }
        if tool > LAST_TOOL {
            let detail = say::tool_out_of_range(tool, LAST_TOOL);
            return Err(Alarm::new(number::OUT_OF_RANGE).with_detail(detail));
        }
        self.plc.engine.memory_mut().set_k(TOOL_IN_POSITION, tool);
        self.run.tool = (tool, 0);
        self.run.interpreter.set_tool(tool);
        self.remember_tool(tool);
        Ok(())
    }

    /// Sets a preset of the PLC, if the operator is permitted to. Timers that a data parameter
    /// presets are not changed. Returns an alarm as error if the value is out of range.
    pub(super) fn set_preset(&mut self, address: ByteAddress, value: i32) -> Result<(), Alarm> {
        let is_timer_parameter =
            |entry: u16| TIMER_PRESETS.iter().any(|(preset, _)| *preset == entry);
        let timer_of_parameter = address.area == Area::T && is_timer_parameter(address.byte);
        if self.rights().check_machine_data().is_err() || timer_of_parameter {
            return Ok(());
        }
        if value < 0 || address.area == Area::D && value > i32::from(u8::MAX) {
            let detail = say::preset_out_of_range(value, address);
            return Err(Alarm::new(number::OUT_OF_RANGE).with_detail(detail));
        }
        let memory = self.plc.engine.memory_mut();
        match address.area {
            Area::D => memory.set_byte(address, value as u8),
            Area::T => memory.set_dt(address.byte, value),
            Area::C => memory.set_dc(address.byte, value),
            _ => {}
        }
        Ok(())
    }
}
