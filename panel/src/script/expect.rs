//! Checks the expectations of scripts and reports what was found instead.

use core::ops::RangeInclusive;

use gsk_core::operation::OperatingMode;
use gsk_core::plc::address::{BitAddress, ByteAddress};
use gsk_messages::{Language, Message, say};

use super::state::ExpectedState;
use crate::emulator::{Emulator, fold_blanks};
use crate::keys::Bit;
use crate::why::{self, BitLog, CauseSubject};

/// Greatest difference between coordinates that are equal on the display, mm.
const TOLERANCE: f64 = 0.000_500_1;

/// One of the coordinate systems that the LCD shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoordinateSystem {
    /// 绝对坐标: the absolute coordinate system.
    Absolute,
    /// 机床坐标: the machine coordinate system.
    Machine,
    /// 相对坐标: the relative coordinate system; its zero is where the operator has cleared U and W.
    Relative,
}

impl CoordinateSystem {
    /// Returns X as displayed (diameter or radius) and Z in this system, mm.
    pub(super) fn shown(self, emulator: &Emulator) -> (f64, f64) {
        let cnc = emulator.cnc();
        let at = match self {
            Self::Absolute => cnc.position_absolute(),
            Self::Machine => cnc.position_machine(),
            Self::Relative => cnc.position_relative(),
        };
        match cnc.parameters().is_radius_programming() {
            true => (at.x, at.z),
            false => (at.x * 2.0, at.z),
        }
    }
}

/// An expectation of a script about control, panel or lathe.
#[derive(Clone, Debug, PartialEq)]
pub enum Expectation {
    /// Expects that this row of the LCD, from 0, contains this text. Runs of blanks count as one.
    Row(usize, String),
    /// Expects these displayed coordinates: system, X as displayed (diameter or radius), Z, mm.
    Position(CoordinateSystem, f64, f64),
    /// Expects the slides at this position: X as a diameter and Z, mm from the reference point.
    Slides(f64, f64),
    /// Expects that the numbers of command pulses since power-on, X and Z, are in these ranges.
    Pulses(RangeInclusive<i64>, RangeInclusive<i64>),
    /// Expects that the analog spindle output has this voltage, V.
    Volts(f64),
    /// Expects that the lamp with this name in the script, at this Y bit, is lit (`true`) or dark.
    Lamp(String, Bit, bool),
    /// Expects that an alarm or a message with this number is active.
    Alarm(u16),
    /// Expects that no alarm and no message is active.
    NoAlarm,
    /// Expects that the control is in this operating mode.
    Mode(OperatingMode),
    /// Expects that a bit of PLC memory has this value.
    Bit(BitAddress, bool),
    /// Expects that a byte of PLC memory, or an entry of timers, counters or data, has this value.
    Value(ByteAddress, i32),
    /// Expects a state of control, panel or lathe, as lessons do.
    State(ExpectedState),
    /// Expects that the chain of causes of a state has a line with this text, in English.
    Cause(CauseSubject, String),
    /// Expects that the inner expectation is not met.
    Not(Box<Expectation>),
}

/// The actual state, where it differs from the expected one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.message())]
pub enum UnmetExpectation {
    /// The row of the LCD, from 0, with its actual text.
    Row(usize, String),
    /// The actual coordinates X and Z as displayed, mm.
    Position(f64, f64),
    /// The actual position of the slides: X as a diameter and Z, mm.
    Slides(f64, f64),
    /// The actual numbers of pulses sent to the drives, X and Z.
    Pulses(i64, i64),
    /// The actual voltage of the analog spindle output, V.
    Volts(f64),
    /// The lamp's name, with `on` or `off` as its actual state.
    Lamp(String, &'static str),
    /// The alarms and messages that are actually active.
    Alarms(Vec<String>),
    /// The actual operating mode, as the LCD shows it.
    Mode(&'static str),
    /// A bit of PLC memory with its actual value (0 or 1).
    Bit(BitAddress, u8),
    /// A byte or entry of PLC memory with its actual value.
    Value(ByteAddress, i32),
    /// The chain of causes that was found instead, as text.
    Cause(String),
    /// The message about the actual state of control, panel or lathe.
    State(Message),
    /// The state that `not` excludes is present.
    Holds,
}

impl UnmetExpectation {
    /// Returns the message that shows the actual state instead of the expected one.
    pub fn message(&self) -> Message {
        match self {
            Self::Row(row, text) => say::script_row_reads(row, text),
            Self::Position(x, z) => say::script_position_is(x, z),
            Self::Slides(x, z) => say::script_slides_stand(x, z),
            Self::Pulses(x, z) => say::script_pulses_are(x, z),
            Self::Volts(volts) => say::script_volts_are(volts),
            Self::Lamp(lamp, state) => say::script_lamp_is(lamp, state),
            Self::Alarms(alarms) if alarms.is_empty() => say::script_no_alarm_stands(),
            Self::Alarms(alarms) => say::script_alarms(alarms.join(" | ")),
            Self::Mode(mode) => say::script_mode_is(mode),
            Self::Bit(address, value) => say::script_value_is(address, value),
            Self::Value(address, value) => say::script_value_is(address, value),
            Self::Cause(chain) => say::script_chain_is(chain),
            Self::State(seen) => seen.clone(),
            Self::Holds => say::script_holds(),
        }
    }
}

impl Expectation {
    /// Returns whether the expectation needs the times at which bits have changed.
    pub(super) fn needs_log(&self) -> bool {
        match self {
            Self::Cause(..) => true,
            Self::Not(expect) => expect.needs_log(),
            _ => false,
        }
    }

    /// Returns whether the expectation is about a position of the axes or slides.
    pub fn is_position(&self) -> bool {
        match self {
            Self::Position(..) | Self::Slides(..) | Self::State(ExpectedState::At(..)) => true,
            Self::Not(expect) => expect.is_position(),
            _ => false,
        }
    }

    /// Checks whether control, panel and lathe are as expected.
    ///
    /// # Errors
    ///
    /// Returns the actual state if it differs.
    pub fn check(&self, emulator: &Emulator) -> Result<(), UnmetExpectation> {
        self.check_with_log(emulator, &BitLog::default())
    }

    /// Checks the same with the times at which the bits of the PLC have changed.
    pub(super) fn check_with_log(
        &self,
        emulator: &Emulator,
        log: &BitLog,
    ) -> Result<(), UnmetExpectation> {
        let cnc = emulator.cnc();
        match self {
            Self::Row(row, text) => {
                let seen = emulator.screen().row(*row);
                let fits = fold_blanks(&seen).contains(&fold_blanks(text));
                verdict(fits, || {
                    UnmetExpectation::Row(*row, seen.trim_end().to_owned())
                })
            }
            Self::Position(coordinates, x, z) => {
                let seen = coordinates.shown(emulator);
                verdict(near(seen.0, *x) && near(seen.1, *z), || {
                    UnmetExpectation::Position(seen.0, seen.1)
                })
            }
            Self::Slides(x, z) => {
                let at = emulator.lathe().slide_position();
                verdict(near(at.x * 2.0, *x) && near(at.z, *z), || {
                    UnmetExpectation::Slides(at.x * 2.0, at.z)
                })
            }
            Self::Pulses(x, z) => {
                let seen = cnc.pulses();
                verdict(x.contains(&seen.x.0) && z.contains(&seen.z.0), || {
                    UnmetExpectation::Pulses(seen.x.0, seen.z.0)
                })
            }
            Self::Volts(volts) => {
                let seen = cnc.spindle_volts();
                verdict(near(seen, *volts), || UnmetExpectation::Volts(seen))
            }
            Self::Lamp(name, lamp, on) => {
                let seen = emulator.lamp(*lamp);
                verdict(seen == *on, || {
                    UnmetExpectation::Lamp(name.clone(), if seen { "on" } else { "off" })
                })
            }
            Self::Alarm(number) => verdict(
                active_alarms(emulator)
                    .iter()
                    .any(|(seen, _)| seen == number),
                || UnmetExpectation::Alarms(alarms(emulator)),
            ),
            Self::NoAlarm => verdict(active_alarms(emulator).is_empty(), || {
                UnmetExpectation::Alarms(alarms(emulator))
            }),
            Self::Mode(mode) => verdict(cnc.mode() == *mode, || {
                UnmetExpectation::Mode(cnc.mode().text())
            }),
            Self::Bit(address, on) => {
                let seen = cnc.plc().memory().bit(*address);
                verdict(seen == *on, || {
                    UnmetExpectation::Bit(*address, u8::from(seen))
                })
            }
            Self::Value(address, value) => {
                let memory = cnc.plc().memory();
                let seen = if address.area.is_entry() {
                    memory.long(*address)
                } else {
                    memory.byte(*address).into()
                };
                verdict(seen == *value, || UnmetExpectation::Value(*address, seen))
            }
            Self::State(state) => state.check(emulator).map_err(UnmetExpectation::State),
            Self::Cause(subject, text) => {
                let chain = why::explain(emulator, *subject, log);
                let mut links = chain.links().iter();
                let is_named = links.any(|link| link.text(Language::En).contains(text));
                verdict(is_named, || {
                    UnmetExpectation::Cause(chain.text(Language::En))
                })
            }
            Self::Not(expect) => {
                let is_met = expect.check_with_log(emulator, log).is_ok();
                verdict(!is_met, || UnmetExpectation::Holds)
            }
        }
    }
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < TOLERANCE
}

fn verdict(fits: bool, seen: impl FnOnce() -> UnmetExpectation) -> Result<(), UnmetExpectation> {
    if fits { Ok(()) } else { Err(seen()) }
}

/// Returns number and text of each active alarm and message.
fn active_alarms(emulator: &Emulator) -> Vec<(u16, String)> {
    let cnc = emulator.cnc();
    let alarms = cnc.alarms().iter();
    let mut all: Vec<_> = alarms
        .map(|alarm| (alarm.number, alarm.to_string()))
        .collect();
    let messages = cnc.plc_messages();
    all.extend(messages.map(|(number, text)| (number, format!("{number} {text}"))));
    all
}

fn alarms(emulator: &Emulator) -> Vec<String> {
    let active_alarms = active_alarms(emulator).into_iter();
    active_alarms.map(|(_, text)| text).collect()
}
