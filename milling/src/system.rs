//! Reads and writes the variables of macro B other than #0 to #33.
//!
//! ```text
//!   #100–#199 #500–#999         common to all programs
//!   #1000–#1133                 signals of the ladder: inputs read 0, outputs are stored
//!   #2001–#2400 #10001–#13400   offsets                        memory
//!   #2500–#2906 #7001–#7945     work zeros                     memory
//!   #3001 #3002                 timers, ms and h               machine time
//!   #3003 #3004 #3005           settings, bit 4 of #3005 is G20
//!   #3011 #3012                 date, time of day
//!   #3901 #3902                 parts made, parts required
//!   #4001–#4022 #4102–#4120     modal codes and words          state
//!   #5001–#5105                 positions                      state
//! ```

use std::collections::BTreeMap;

use gsk_core::alarm::{Alarm, number};
use gsk_core::command::SourcePosition;
use gsk_core::interpreter::{ReadError, VariableReader, VariableWriter};
use gsk_core::memory::{Counters, DayTime, Registers};
use gsk_messages::say;

use crate::axes::Axes;
use crate::memory::{MillMemory, MillOffsetColumn, MillOffsetMemory, parameter};
use crate::modal::{Hole, WorkZero};
use crate::space::{Length, MillAxis, MillPosition};
use crate::state::MillState;

/// The values of the variables that programs write, and of the counters of the control.
#[derive(Clone, Debug, Default)]
pub(crate) struct MillVariables {
    common: BTreeMap<u32, f64>,
    registers: Registers,
    /// Running time of the control (#3002) before the start of the program, ms.
    hours_before: i64,
    /// Number of parts made, variable #3901.
    pub(crate) parts: u32,
    required: u32,
}

impl MillVariables {
    /// Creates the variables for a run that starts at the clock time `day_time`.
    pub(crate) fn new(day_time: DayTime) -> Self {
        Self {
            registers: Registers::new(day_time),
            ..Self::default()
        }
    }

    /// Sets a common variable, which all programs share.
    pub(crate) fn set_common(&mut self, number: u32, value: f64) {
        self.common.insert(number, value);
    }
}

/// The state that system variables read: program, time, position and modal values.
pub(crate) struct VariableContext<'a> {
    pub(crate) state: &'a mut MillState,
    pub(crate) memory: &'a mut MillMemory,
    pub(crate) variables: &'a mut MillVariables,
    pub(crate) source: SourcePosition,
    /// Number of the running program (word O).
    pub(crate) program: u16,
    /// Machine time since the start of the program, s.
    pub(crate) now: f64,
    /// Position of the tool in machine coordinates, with cutter radius compensation.
    pub(crate) machine: MillPosition,
}

/// A system variable that is stored in the mill's memory.
enum StoredVariable {
    Offset(u16, MillOffsetColumn),
    External(MillAxis),
    Zero(WorkZero, MillAxis),
}

/// Number of milliseconds in an hour, the unit of variable #3002.
const HOUR_MS: f64 = 3.6e6;
/// Number of the bit of #3005 that is 1 in inches (G20).
const INCH: u8 = 4;

/// Returns the axis of a variable's last digit: 4 is the fourth, 5 the fifth; `None` if the
/// machine does not have it.
fn axis(digit: u32, axes: Axes) -> Option<MillAxis> {
    let axis = MillAxis::ALL.get(digit.checked_sub(1)? as usize).copied()?;
    let further = MillAxis::FURTHER.contains(&axis);
    (!further || axes.further(axis).is_some()).then_some(axis)
}

/// Returns the offset that a variable number refers to in this type of memory; `None` if it
/// refers to none (manual 001, tables 2.2).
fn offset_variable(number: u32, memory: MillOffsetMemory) -> Option<StoredVariable> {
    let has_radius = memory == MillOffsetMemory::C;
    let has_one_column = memory == MillOffsetMemory::A;
    let (first, column) = match number {
        2001..=2400 if has_one_column => (2000, MillOffsetColumn::Length),
        2001..=2200 => (2000, MillOffsetColumn::LengthWear),
        2201..=2400 => (2200, MillOffsetColumn::Length),
        10_001..=10_400 => (10_000, MillOffsetColumn::LengthWear),
        11_001..=11_400 if !has_one_column => (11_000, MillOffsetColumn::Length),
        12_001..=12_400 if has_radius => (12_000, MillOffsetColumn::RadiusWear),
        13_001..=13_400 if has_radius => (13_000, MillOffsetColumn::Radius),
        _ => return None,
    };
    Some(StoredVariable::Offset((number - first) as u16, column))
}

/// Returns the offset or work zero that a variable number refers to; `None` if it is neither.
fn stored_variable(number: u32, axes: Axes, memory: MillOffsetMemory) -> Option<StoredVariable> {
    match number {
        2001..=2400 | 10_001..=13_400 => offset_variable(number, memory),
        2500..=2999 => {
            let axis = axis((number - 2400) / 100, axes)?;
            match number % 100 {
                0 => Some(StoredVariable::External(axis)),
                zero @ 1..=6 => Some(StoredVariable::Zero(WorkZero(zero as u8 - 1), axis)),
                _ => None,
            }
        }
        7001..=7959 => {
            let (zero, digit) = ((number - 7001) / 20, (number - 7000) % 20);
            let zero = WorkZero(WorkZero::FIRST_ADDITIONAL + u8::try_from(zero).ok()?);
            Some(StoredVariable::Zero(zero, axis(digit, axes)?))
        }
        _ => None,
    }
}

fn unknown(variable: u32) -> Alarm {
    let detail = say::variable_of_macro_unknown(variable);
    Alarm::new(number::BAD_VARIABLE).with_detail(detail)
}

/// Whether the variable is a common one, which all programs share.
const fn is_common(number: u32) -> bool {
    matches!(number, 100..=199 | 500..=999)
}

/// Number of the variable that contains all outputs to the ladder as bits.
const OUTPUTS: u32 = 1132;

/// Returns the least and greatest value of a variable that is a signal to the ladder, or a
/// setting without effect here; `None` for others.
const fn stored_range(number: u32) -> Option<(i64, i64)> {
    Some(match number {
        1100..=1115 => (i64::MIN, i64::MAX),
        OUTPUTS => (0, 0xFFFF),
        1133 => (-99_999_999, 99_999_999),
        3003 => (0, 3),
        3004 => (0, 7),
        3005 => (0, 0x3FF),
        _ => return None,
    })
}

impl VariableContext<'_> {
    fn modal(&self, variable: u32) -> Option<f64> {
        let modal = &self.state.modal;
        let transform = &self.state.transform;
        Some(match variable {
            4001 => modal.motion.code().into(),
            4002 => modal.plane_code().into(),
            4003 => (90 + u8::from(modal.incremental)).into(),
            4005 => (94 + u8::from(modal.per_revolution)).into(),
            4006 => (21 - u8::from(modal.inch)).into(),
            4007 => modal.cutter_code().into(),
            4008 => modal.length_code().into(),
            4009 => modal.hole.map_or(80, Hole::code).into(),
            4010 => (98 + u8::from(modal.to_r)).into(),
            4011 => (50 + u8::from(transform.scaling.is_some())).into(),
            4014 if modal.zero.0 < WorkZero::FIRST_ADDITIONAL => (54 + modal.zero.0).into(),
            // G54.1.
            4014 => 54.0,
            4015 => {
                if modal.exact_stop {
                    61.0
                } else {
                    64.0
                }
            }
            4016 => (69 - u8::from(transform.rotation.is_some())).into(),
            // Groups without codes.
            4004 | 4012 | 4013 | 4017..=4022 | 4102 => 0.0,
            4107 => modal.d.into(),
            4109 => modal.feed,
            4111 => modal.h.into(),
            4113 => modal.m.into(),
            4114 => self.source.sequence.map_or(0, u32::from).into(),
            4115 => self.program.into(),
            4119 => modal.speed,
            4120 => modal.called.into(),
            _ => return None,
        })
    }

    fn position(&self, variable: u32) -> Option<f64> {
        let axis = axis(variable % 10, self.state.axes)?;
        let frame = self.state.frame(self.memory);
        let zero = self.state.zero(self.memory);
        let value = match variable / 10 * 10 {
            5000 => self.state.work(self.memory).get(axis),
            5020 => self.machine.get(axis),
            // Includes the offset.
            5040 => self.state.axes.wrapped(self.machine - zero).get(axis),
            5060 => self.state.skipped.get(axis),
            5080 => (frame - zero).get(axis),
            5100 => Length::ZERO,
            _ => return None,
        };
        Some(value.mm())
    }
}

impl VariableContext<'_> {
    /// Returns the machine time since the start of the program, ms.
    fn now_ms(&self) -> u64 {
        (self.now * 1000.0) as u64
    }

    /// Returns the stored value of a variable that is a signal or a setting.
    fn stored_value(&self, variable: u32) -> f64 {
        let value = |number: u32| self.variables.common.get(&number).copied().unwrap_or(0.0);
        match variable {
            1100..=1115 => f64::from(value(OUTPUTS) as u32 >> (variable - 1100) & 1),
            3005 => {
                let inch = u32::from(self.state.modal.inch) << INCH;
                f64::from(value(3005) as u32 & !(1 << INCH) | inch)
            }
            _ => value(variable),
        }
    }

    /// Stores the value of a signal or setting. Every value but 0 switches an output on.
    fn store_value(&mut self, variable: u32, value: i64) {
        let (variable, value) = match variable {
            1100..=1115 => {
                let bit = 1 << (variable - 1100);
                let others = self.stored_value(OUTPUTS) as i64 & !bit;
                (OUTPUTS, if value == 0 { others } else { others | bit })
            }
            _ => (variable, value),
        };
        if variable == 3005 {
            self.state.modal.inch = value >> INCH & 1 == 1;
        }
        self.variables.set_common(variable, value as f64);
    }

    /// Returns the value of a variable that is a timer, clock or counter; `None` for other
    /// variables.
    fn control(&self, variable: u32) -> Option<f64> {
        let variables = &self.variables;
        let now = self.now_ms();
        Some(match variable {
            3001 => variables.registers.timer(now) as f64,
            3002 => {
                let ms = variables.hours_before.saturating_add(now as i64);
                ms.rem_euclid(Counters::STARTED_LIMIT_MS as i64) as f64 / HOUR_MS
            }
            3011 => variables.registers.date(now).into(),
            3012 => variables.registers.time_of_day(now).into(),
            3901 => variables.parts.into(),
            3902 => variables.required.into(),
            _ => return None,
        })
    }

    /// Writes a timer or counter; `None` counts as 0. Returns `false` if the variable is
    /// neither. Errors: alarm 111 for a value out of range.
    fn write_control(&mut self, variable: u32, value: Option<f64>) -> Result<bool, Alarm> {
        let now = self.now_ms();
        let variables = &mut self.variables;
        let last = |count: u32| i64::from(count) - 1;
        match variable {
            3001 => {
                let ms = round_in_range(variable, value, (0, Registers::TIMER_GREATEST))?;
                variables.registers.set_timer(ms, now);
            }
            3002 => {
                let hours = value.unwrap_or(0.0);
                let greatest = (Counters::STARTED_LIMIT_MS - 1) as f64 / HOUR_MS;
                if !(0.0..=greatest).contains(&hours) {
                    return Err(out_of_range(variable, hours, greatest));
                }
                variables.hours_before = libm::round(hours * HOUR_MS) as i64 - now as i64;
            }
            3901 => {
                let parts = round_in_range(variable, value, (0, last(Counters::PART_COUNT_LIMIT)))?;
                variables.parts = parts as u32;
            }
            3902 => {
                let parts =
                    round_in_range(variable, value, (0, last(Counters::REQUIRED_PARTS_LIMIT)))?;
                variables.required = parts as u32;
            }
            _ => return Ok(false),
        }
        Ok(true)
    }
}

fn out_of_range(variable: u32, value: f64, greatest: impl core::fmt::Display) -> Alarm {
    let detail = say::variable_of_macro_out_of_range(variable, value, greatest);
    Alarm::new(number::MACRO_RANGE).with_detail(detail)
}

/// Rounds a value to an integer in a range; `None` counts as 0. Errors: alarm 111 outside the
/// range.
fn round_in_range(
    variable: u32,
    value: Option<f64>,
    (least, most): (i64, i64),
) -> Result<i64, Alarm> {
    let value = value.unwrap_or(0.0);
    let whole = libm::round(value) as i64;
    match (least..=most).contains(&whole) {
        true => Ok(whole),
        false => Err(out_of_range(variable, value, most)),
    }
}

impl VariableReader for VariableContext<'_> {
    fn read_system(&self, variable: u32) -> Result<Option<f64>, ReadError> {
        if is_common(variable) {
            return Ok(self.variables.common.get(&variable).copied());
        }
        let memory = self.memory.offset_memory;
        if let Some(stored) = stored_variable(variable, self.state.axes, memory) {
            let value = match stored {
                StoredVariable::Offset(offset, column) => {
                    let column = self.memory.offset_memory.column(column);
                    *self.memory.offset(offset).column(column)
                }
                StoredVariable::External(axis) => self.memory.external.get(axis),
                StoredVariable::Zero(zero, axis) => self.memory.zero(zero).get(axis),
            };
            return Ok(Some(value.mm()));
        }
        let value = match variable {
            1000..=1015 | 1032 => Some(0.0),
            _ if stored_range(variable).is_some() => Some(self.stored_value(variable)),
            3000..=3999 => self.control(variable),
            4000..=4999 => self.modal(variable),
            5000..=5999 => self.position(variable),
            _ => None,
        };
        value.map(Some).ok_or_else(|| unknown(variable).into())
    }

    fn signed_angles(&self) -> bool {
        self.memory.bit(parameter::ANGLES, 7)
    }
}

impl VariableWriter for VariableContext<'_> {
    fn write_system(&mut self, variable: u32, value: Option<f64>) -> Result<(), ReadError> {
        if is_common(variable) {
            match value {
                Some(value) => self.variables.common.insert(variable, value),
                None => self.variables.common.remove(&variable),
            };
            return Ok(());
        }
        if let Some(range) = stored_range(variable) {
            let whole = round_in_range(variable, value, range)?;
            self.store_value(variable, whole);
            return Ok(());
        }
        if self.write_control(variable, value)? {
            return Ok(());
        }
        let memory = self.memory.offset_memory;
        let Some(stored) = stored_variable(variable, self.state.axes, memory) else {
            // The variable exists, but is read-only.
            self.read_system(variable)?;
            let detail = say::variable_of_macro_read_only(variable);
            return Err(Alarm::new(number::READ_ONLY).with_detail(detail).into());
        };
        let length = Length::from_mm(value.unwrap_or(0.0));
        let length = self.state.axes.rounded(MillAxis::X, length);
        match stored {
            StoredVariable::Offset(offset, column) => {
                self.memory
                    .set_offset(offset.into(), column, length, false)?;
                return Ok(());
            }
            StoredVariable::External(axis) => self.memory.external.set(axis, length),
            StoredVariable::Zero(zero, axis) => {
                let is_held = !self.memory.bit(parameter::ZEROS, 1);
                if is_held && zero == self.state.modal.zero && self.state.held_zero.is_none() {
                    self.state.held_zero = Some(self.memory.zero(zero));
                }
                if let Some(point) = self.memory.zero_mut(zero) {
                    point.set(axis, length);
                }
            }
        }
        self.state.resync(self.memory);
        Ok(())
    }
}
