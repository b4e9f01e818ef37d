//! Variables of macro B besides #0 to #33, by their numbers.
//!
//! ```text
//!   #100–#199 #500–#999         of all programs
//!   #1000–#1133                 signals of the ladder: inputs are 0, outputs are kept
//!   #2001–#2400 #10001–#13400   offsets                        memory
//!   #2500–#2906 #7001–#7945     zeros of the work              memory
//!   #3001 #3003–#3005 #3901     timer, switches of the run, parts
//!   #4001–#4016 #4102–#4120     modal codes and words          state
//!   #5001–#5105                 positions                      state
//! ```

use std::collections::BTreeMap;

use gsk_core::alarm::{Alarm, number};
use gsk_core::command::Source;
use gsk_core::interpreter::System;
use gsk_messages::say;

use crate::axes::Axes;
use crate::memory::{Column, MillMemory, parameter};
use crate::modal::{Hole, WorkZero};
use crate::space::{Axis, Length, Position};
use crate::state::State;

/// Variables that programs write.
pub(crate) type Common = BTreeMap<u32, f64>;

/// What variables are read from.
pub(crate) struct Known<'a> {
    pub(crate) state: &'a mut State,
    pub(crate) memory: &'a mut MillMemory,
    pub(crate) common: &'a mut Common,
    pub(crate) source: Source,
    /// The program that runs.
    pub(crate) program: u16,
    /// Machine time, s.
    pub(crate) now: f64,
    pub(crate) parts: u32,
    /// Where the tool is, its radius compensated.
    pub(crate) machine: Position,
}

/// A variable of the memory.
enum Place {
    Offset(u16, Column),
    External(Axis),
    Zero(WorkZero, Axis),
}

/// Parts of a second in the timer #3001: it counts 16 ms, and begins anew behind 65535.
const TIMER: u64 = 65_536;

/// The axis of a last digit: 4 is the fourth, where the machine has it, 5 the fifth.
fn axis(digit: u32, axes: Axes) -> Option<Axis> {
    let axis = Axis::ALL.get(digit.checked_sub(1)? as usize).copied()?;
    let further = Axis::FURTHER.contains(&axis);
    (!further || axes.further(axis).is_some()).then_some(axis)
}

/// The offset or the zero of a number.
fn place(number: u32, axes: Axes) -> Option<Place> {
    let offset = |first: u32, column| Some(Place::Offset((number - first) as u16, column));
    match number {
        2001..=2200 => offset(2000, Column::LengthWear),
        2201..=2400 => offset(2200, Column::Length),
        10_001..=10_400 => offset(10_000, Column::LengthWear),
        11_001..=11_400 => offset(11_000, Column::Length),
        12_001..=12_400 => offset(12_000, Column::RadiusWear),
        13_001..=13_400 => offset(13_000, Column::Radius),
        2500..=2999 => {
            let axis = axis((number - 2400) / 100, axes)?;
            match number % 100 {
                0 => Some(Place::External(axis)),
                zero @ 1..=6 => Some(Place::Zero(WorkZero(zero as u8 - 1), axis)),
                _ => None,
            }
        }
        7001..=7959 => {
            let (zero, digit) = ((number - 7001) / 20, (number - 7000) % 20);
            let zero = WorkZero(WorkZero::FIRST_ADDITIONAL + u8::try_from(zero).ok()?);
            Some(Place::Zero(zero, axis(digit, axes)?))
        }
        _ => None,
    }
}

fn unknown(variable: u32) -> Alarm {
    let detail = say::variable_of_macro_unknown(variable);
    Alarm::new(number::BAD_VARIABLE).because(detail)
}

/// Whether programs share a variable.
const fn is_common(number: u32) -> bool {
    matches!(number, 100..=199 | 500..=999)
}

/// Signals to the ladder, and switches of a run that change nothing here.
const fn is_kept(number: u32) -> bool {
    matches!(number, 1100..=1115 | 1132 | 1133 | 3003..=3005)
}

impl Known<'_> {
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
            4004 | 4012 | 4013 | 4017..=4022 => 0.0,
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
            // The offset is a part of it.
            5040 => self.state.axes.rolled(self.machine - zero).get(axis),
            5060 => self.state.skipped.get(axis),
            5080 => (frame - zero).get(axis),
            5100 => Length::ZERO,
            _ => return None,
        };
        Some(value.mm())
    }
}

impl System for Known<'_> {
    fn read(&self, variable: u32) -> Result<Option<f64>, Alarm> {
        if is_common(variable) {
            return Ok(self.common.get(&variable).copied());
        }
        if let Some(place) = place(variable, self.state.axes) {
            let value = match place {
                Place::Offset(offset, column) => *self.memory.offset(offset).column(column),
                Place::External(axis) => self.memory.external.get(axis),
                Place::Zero(zero, axis) => self.memory.zero(zero).get(axis),
            };
            return Ok(Some(value.mm()));
        }
        let value = match variable {
            1000..=1015 | 1032 => Some(0.0),
            3001 => Some(((self.now * 1000.0) as u64 / 16 * 16 % TIMER) as f64),
            3901 => Some(self.parts.into()),
            _ if is_kept(variable) => Some(self.common.get(&variable).copied().unwrap_or(0.0)),
            4000..=4999 => self.modal(variable),
            5000..=5999 => self.position(variable),
            _ => None,
        };
        value.map(Some).ok_or_else(|| unknown(variable))
    }

    fn write(&mut self, variable: u32, value: Option<f64>) -> Result<(), Alarm> {
        if is_common(variable) || is_kept(variable) {
            match value {
                Some(value) => self.common.insert(variable, value),
                None => self.common.remove(&variable),
            };
            return Ok(());
        }
        let Some(place) = place(variable, self.state.axes) else {
            // Known, and only read.
            self.read(variable)?;
            let detail = say::variable_of_macro_read_only(variable);
            return Err(Alarm::new(number::READ_ONLY).because(detail));
        };
        let length = Length::from_mm(value.unwrap_or(0.0)).rounded();
        match place {
            Place::Offset(offset, column) => {
                return self.memory.set_offset(offset.into(), column, length);
            }
            Place::External(axis) => self.memory.external.set(axis, length),
            Place::Zero(zero, axis) => {
                if let Some(point) = self.memory.zero_mut(zero) {
                    point.set(axis, length);
                }
            }
        }
        self.state.resync(self.memory);
        Ok(())
    }

    fn signed_angles(&self) -> bool {
        self.memory.bit(parameter::ANGLES, 7)
    }
}
