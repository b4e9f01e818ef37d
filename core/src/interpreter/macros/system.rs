//! Reads and writes the variables of macro B by their numbers.
//!
//! ```text
//!   #0                    null
//!   #1–#33                of the call                        levels
//!   #100–#199 #500–#999   of all programs; #200–#231 too     memory
//!   #1000–#1133           signals of the ladder
//!   #2001 #2101 #2201 #2301 and on   X, Z, R, T of the offsets 01 to 32
//!   #2500 #2600           X, Z of the offset 00, the shift of the work coordinates
//!   #3000                 an alarm                           statement
//!   #3001 #3002           timers, ms and h
//!   #3003 #3004           switch stops off
//!   #3005                 rows of the setting page
//!   #3011 #3012           date, time of day
//!   #3901 #3902           parts made, parts required
//!   #4001–#4004           G code of the groups 01 to 04      modal
//!   #4109 #4113 #4114 #4115 #4119 #4120   F M N O S T
//!   #5001 #5002           end of the last block              programmed
//!   #5021 #5022           position                           machine
//!   #5041 #5042           position, offset included          work
//!   #5081 #5082           tool offset in force
//! ```
//!
//! The axes of the lathe are 1, X as it is programmed, and 2, Z.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::{ProgramId, SourcePosition};
use crate::interpreter::exact::ExactPoint;
use crate::interpreter::host::Host;
use crate::interpreter::macros::formula::{self, FormulaValue};
use crate::interpreter::macros::levels::Levels;
use crate::interpreter::macros::variable::{MacroVariable, ReadError};
use crate::interpreter::macros::variable_access::{
    VariableReader, VariableWriter, with_formula_context,
};
use crate::interpreter::state::State;
use crate::memory::{Counters, Registers, SwitchedOff, Variables};
use crate::program::{FormulaCode, Program, ProgramBlock, Syntax};

/// The sources of the variables that formulas read: local variables, modal state, program and host.
pub(crate) struct VariableSources<'a, H> {
    pub(crate) levels: &'a Levels,
    /// The state after the previous block.
    pub(crate) state: State,
    pub(crate) source: SourcePosition,
    /// Whether only the variables #1 to #99 of the Huaxing lathes exist.
    pub(crate) has_huaxing_variables: bool,
    pub(crate) host: &'a H,
}

/// The variables of the host, for writing.
pub(crate) struct HostVariables<'a, H> {
    /// Whether only the variables #1 to #99 of the Huaxing lathes exist.
    pub(crate) has_huaxing_variables: bool,
    pub(crate) host: &'a mut H,
}

impl<H: Host> VariableReader for VariableSources<'_, H> {
    fn read_system(&self, number: u32) -> Result<FormulaValue, ReadError> {
        let host = self.host;
        if self.has_huaxing_variables {
            return match u16::try_from(number) {
                Ok(number @ 1..=99) => Ok(host.variables().huaxing_value(number)),
                _ => Err(unknown_huaxing_alarm(number)),
            };
        }
        match number {
            1000..=1133 => {
                let slot = MacroVariable::find(number as u16, host)?;
                Ok(Some(slot.read(host)? as f64))
            }
            2000..=2999 => read_offset(number, host).map(Some),
            3000..=3999 => read_machine(number, host).map(Some),
            4000..=4999 => self
                .read_modal(number)
                .ok_or_else(|| unknown_variable_alarm(number))
                .map(Some),
            5000..=5999 => self.read_position(number).map(Some),
            _ => Ok(host.variables().real_value(check_common(number)?)),
        }
    }

    fn has_local_variables(&self) -> bool {
        !self.has_huaxing_variables
    }
}

impl<H: Host> VariableWriter for HostVariables<'_, H> {
    fn write_system(&mut self, number: u32, value: FormulaValue) -> Result<(), ReadError> {
        match self.has_huaxing_variables {
            true => write_huaxing(number, value, self.host),
            false => write_host(number, value, self.host),
        }
    }

    fn has_local_variables(&self) -> bool {
        !self.has_huaxing_variables
    }
}

impl<H: Host> VariableSources<'_, H> {
    /// Copies a block with its formulas replaced by their values. Returns an error if a formula has
    /// no value or must wait, or if a value is out of range.
    pub(crate) fn evaluate_words(
        &self,
        block: &ProgramBlock,
        formulas: &[FormulaCode],
        syntax: Syntax,
    ) -> Result<ProgramBlock, ReadError> {
        let block = with_formula_context(self.levels, self, |context| {
            formula::evaluate_words(block, formulas, syntax, context)
        })?;
        if block.has_g(65) {
            let detail = say::macro_code_from_variable();
            return Err(Alarm::new(number::BAD_IN_MACRO).with_detail(detail).into());
        }
        Ok(block)
    }

    fn read_modal(&self, number: u32) -> Option<f64> {
        let modal = &self.state.modal;
        Some(match number {
            4001 => modal.motion.number().into(),
            4002 => {
                if modal.surface_speed {
                    96.0
                } else {
                    97.0
                }
            }
            4003 => {
                if modal.feed_per_revolution {
                    99.0
                } else {
                    98.0
                }
            }
            4004 => modal.nose_compensation.into(),
            4109 => modal.feed,
            4113 => modal.m.unwrap_or(0).into(),
            4114 => self.source.sequence.map_or(0, u32::from).into(),
            4115 => match self.source.program {
                ProgramId::Stored(number) => number.into(),
                _ => {
                    let program = self.host.programs().get(self.source.program);
                    program.and_then(Program::number).unwrap_or(0).into()
                }
            },
            4119 => modal.spindle,
            4120 => (u16::from(modal.tool) * 100 + u16::from(modal.offset)).into(),
            _ => return None,
        })
    }

    fn read_position(&self, number: u32) -> Result<f64, ReadError> {
        let (state, host) = (&self.state, self.host);
        let machine = || match host.is_settled() {
            true => Ok(ExactPoint::from_point(host.machine_position())),
            false => Err(ReadError::Wait),
        };
        let point = match number {
            5001 | 5002 => state.position,
            5021 | 5022 => machine()?,
            5041 | 5042 => machine()? - state.zero,
            5081 | 5082 => state.offset,
            _ => return Err(unknown_variable_alarm(number)),
        };
        let radius = host.parameters().is_radius_programming();
        let millionths = match (number % 10, radius) {
            (1, true) => point.x / 2,
            (1, false) => point.x,
            _ => point.z,
        };
        Ok(millionths as f64 / 1e6)
    }
}

/// Checks that `number` is that of a variable common to all programs, and returns it. Returns an
/// alarm as error if it is not.
fn check_common(number: u32) -> Result<u16, ReadError> {
    let common = u16::try_from(number).ok();
    let common = common.filter(|it| Variables::has_real(*it));
    common.ok_or_else(|| unknown_variable_alarm(number))
}

/// The alarm for a variable number that the Huaxing lathes do not have.
pub(crate) fn unknown_huaxing_alarm(number: u32) -> ReadError {
    Alarm::new(number::BAD_VARIABLE)
        .with_detail(say::variable_of_huaxing_unknown(number))
        .into()
}

/// Sets a variable of the Huaxing lathes. Returns an alarm as error for an unknown number.
fn write_huaxing(number: u32, value: FormulaValue, host: &mut impl Host) -> Result<(), ReadError> {
    match u16::try_from(number) {
        Ok(number @ 1..=99) => {
            host.variables_mut().set_huaxing_value(number, value)?;
            Ok(())
        }
        _ => Err(unknown_huaxing_alarm(number)),
    }
}

fn unknown_variable_alarm(number: u32) -> ReadError {
    Alarm::new(number::BAD_VARIABLE)
        .with_detail(say::variable_of_macro_unknown(number))
        .into()
}

/// Sets a variable above #33. Returns an alarm as error for a value that the variable cannot
/// hold, for an unknown number and for a read-only variable; or a wait, for an output of the
/// ladder before every earlier command is finished.
fn write_host(number: u32, value: FormulaValue, host: &mut impl Host) -> Result<(), ReadError> {
    match number {
        2000..=2999 => write_offset(number, value, host)?,
        3011 | 3012 | 4000..=5999 => {
            let detail = say::variable_of_macro_read_only(number);
            return Err(Alarm::new(number::READ_ONLY).with_detail(detail).into());
        }
        1000..=1133 => {
            let variable = MacroVariable::find(number as u16, host)?;
            let whole = formula::round_half_away(value.unwrap_or(0.0)) as i64;
            variable.check(whole, host)?;
            variable.write(whole, host)?;
        }
        3000..=3999 => write_machine(number, value, host)?,
        _ => host
            .variables_mut()
            .set_real(check_common(number)?, value)?,
    }
    Ok(())
}

/// A column of the tool offset table that variables can read.
#[derive(Clone, Copy)]
enum OffsetTableField {
    X,
    Z,
    R,
    T,
}

/// Finds the row and the column of the offset table that a variable reads or writes. Returns an
/// alarm as error if the control has no such row.
fn find_offset_field(number: u32, host: &impl Host) -> Result<(u8, OffsetTableField), ReadError> {
    let field = match (number / 100, number % 100) {
        (20, row @ 1..=32) => (row as u8, OffsetTableField::X),
        (21, row @ 1..=32) => (row as u8, OffsetTableField::Z),
        (22, row @ 1..=32) => (row as u8, OffsetTableField::R),
        (23, row @ 1..=32) => (row as u8, OffsetTableField::T),
        (25, 0) if host.parameters().has_work_shift() => (0, OffsetTableField::X),
        (26, 0) if host.parameters().has_work_shift() => (0, OffsetTableField::Z),
        _ => return Err(unknown_variable_alarm(number)),
    };
    Ok(field)
}

/// Reads a value of the offset table as the offset page shows it: X, Z and R in mm, or T.
fn read_offset(number: u32, host: &impl Host) -> Result<f64, ReadError> {
    let (row, value) = find_offset_field(number, host)?;
    let offset = host.offsets().get(row);
    Ok(match value {
        OffsetTableField::X => offset.x,
        OffsetTableField::Z => offset.z,
        OffsetTableField::R => offset.r,
        OffsetTableField::T => offset.t.into(),
    })
}

/// Sets a value of the offset table. The value takes effect with the next T word of this
/// offset number.
fn write_offset(number: u32, value: FormulaValue, host: &mut impl Host) -> Result<(), ReadError> {
    let (row, field) = find_offset_field(number, host)?;
    check_settled(host)?;
    let value = value.unwrap_or(0.0);
    let mut offset = host.offsets().get(row);
    match field {
        OffsetTableField::X => offset.x = value,
        OffsetTableField::Z => offset.z = value,
        OffsetTableField::R => offset.r = value,
        OffsetTableField::T => offset.t = check_integer(number, value, i64::from(u8::MAX))? as u8,
    }
    match row {
        0 => host.offsets_mut().set_work_shift(offset)?,
        _ => host.offsets_mut().set(row, offset)?,
    }
    Ok(())
}

/// Number of the variable whose bits are rows of the setting page.
pub(crate) const SETTINGS_VARIABLE: u32 = 3005;
/// Number of milliseconds in an hour.
const HOUR_MS: f64 = 3.6e6;
/// Bit of #3005 for the parity row of the setting page; the next constants are those of other
/// rows.
const PARITY_BIT: u8 = 2;
const ISO_BIT: u8 = 3;
const INCH_BIT: u8 = 4;
const NUMBERING_BIT: u8 = 7;
const MAX_SETTINGS: i64 = 0x3FF;

fn read_machine(number: u32, host: &impl Host) -> Result<f64, ReadError> {
    let registers = host.registers();
    Ok(match number {
        3003 => registers.off.stop_bits().into(),
        3004 => registers.off.motion_bits().into(),
        3005 => {
            let settings = host.settings();
            let bit = |on: bool, bit: u8| u16::from(on) << bit;
            let rows = bit(settings.parity, PARITY_BIT)
                | bit(settings.iso, ISO_BIT)
                | bit(settings.inch, INCH_BIT)
                | bit(settings.numbering, NUMBERING_BIT);
            rows.into()
        }
        3902 => host.counters().required.into(),
        3001 | 3002 | 3011 | 3012 | 3901 => {
            check_settled(host)?;
            let now = host.now_ms();
            match number {
                3001 => registers.timer(now) as f64,
                3002 => host.started_ms() as f64 / HOUR_MS,
                3011 => registers.date(now).into(),
                3012 => registers.time_of_day(now).into(),
                _ => host.counters().parts.into(),
            }
        }
        _ => return Err(unknown_variable_alarm(number)),
    })
}

fn write_machine(number: u32, value: FormulaValue, host: &mut impl Host) -> Result<(), ReadError> {
    let value = value.unwrap_or(0.0);
    let (stops, motion) = SwitchedOff::GREATEST;
    let last = |count: u32| i64::from(count) - 1;
    match number {
        3001 => {
            let ms = check_integer(number, value, Registers::TIMER_GREATEST)?;
            check_settled(host)?;
            let now = host.now_ms();
            host.registers_mut().set_timer(ms, now);
        }
        3002 => {
            let greatest = (Counters::STARTED_LIMIT_MS - 1) as f64 / HOUR_MS;
            if !(0.0..=greatest).contains(&value) {
                let detail = say::variable_of_macro_out_of_range(number, value, greatest);
                return Err(Alarm::new(number::MACRO_RANGE).with_detail(detail).into());
            }
            check_settled(host)?;
            host.set_started_ms(formula::round_half_away(value * HOUR_MS) as u64);
        }
        3003 => {
            let bits = check_integer(number, value, stops.into())?;
            check_settled(host)?;
            host.registers_mut().off.set_stops(bits as u8);
        }
        3004 => {
            let bits = check_integer(number, value, motion.into())?;
            check_settled(host)?;
            host.registers_mut().off.set_motion(bits as u8);
        }
        3005 => {
            let bits = check_integer(number, value, MAX_SETTINGS)?;
            check_settled(host)?;
            let on = |bit: u8| bits >> bit & 1 == 1;
            let settings = host.settings_mut();
            settings.parity = on(PARITY_BIT);
            settings.iso = on(ISO_BIT);
            settings.inch = on(INCH_BIT);
            settings.numbering = on(NUMBERING_BIT);
        }
        3901 => {
            let parts = check_integer(number, value, last(Counters::PART_COUNT_LIMIT))?;
            check_settled(host)?;
            host.counters_mut().parts = parts as u32;
        }
        3902 => {
            let parts = check_integer(number, value, last(Counters::REQUIRED_PARTS_LIMIT))?;
            host.counters_mut().required = parts as u32;
        }
        _ => return Err(unknown_variable_alarm(number)),
    }
    Ok(())
}

/// Returns a wait until every earlier command is finished: a block must read the variables of
/// the machine when it runs, not when the reader reads it ahead.
fn check_settled(host: &impl Host) -> Result<(), ReadError> {
    match host.is_settled() {
        true => Ok(()),
        false => Err(ReadError::Wait),
    }
}

/// Rounds `value` to a whole number from 0 to `greatest`; alarm 111 outside.
fn check_integer(number: u32, value: f64, greatest: i64) -> Result<i64, ReadError> {
    let whole = formula::round_half_away(value) as i64;
    if (0..=greatest).contains(&whole) {
        return Ok(whole);
    }
    let detail = say::variable_of_macro_out_of_range(number, value, greatest);
    Err(Alarm::new(number::MACRO_RANGE).with_detail(detail).into())
}
