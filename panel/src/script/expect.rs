//! What `expect` compares, and what it says when it is not so.

use core::ops::RangeInclusive;

use gsk_core::operation::Mode;
use gsk_core::plc::address::{BitAddress, ByteAddress};
use gsk_core::units::Point;

use crate::emulator::{Emulator, folded};
use crate::keys::Bit;

/// Coordinates are equal when they are shown alike.
const TOLERANCE: f64 = 0.000_500_1;

/// A set of coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinates {
    /// 绝对坐标.
    Absolute,
    /// 机床坐标.
    Machine,
    /// 相对坐标.
    Relative,
}

/// What should be.
#[derive(Clone, Debug, PartialEq)]
pub enum Expect {
    /// A row of the LCD contains a text, blanks folded.
    Row(usize, String),
    /// X as it is displayed (diameter or radius) and Z, mm.
    Position(Coordinates, f64, f64),
    /// Where the slides of the machine stand: X as a diameter and Z, mm from the
    /// reference point.
    Slides(f64, f64),
    /// The command pulses given out since the power was switched on.
    Pulses(RangeInclusive<i64>, RangeInclusive<i64>),
    /// The analog spindle output, V.
    Volts(f64),
    /// A lamp, by the name in the script, is on or off.
    Lamp(String, Bit, bool),
    /// An alarm or a message of this number stands.
    Alarm(u16),
    /// No alarm and no message stands.
    NoAlarm,
    /// The operating mode.
    Mode(Mode),
    /// A bit of PLC memory.
    Bit(BitAddress, bool),
    /// A byte or entry of PLC memory.
    Value(ByteAddress, i32),
}

/// What is there instead of what was expected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unmet {
    /// A row of the LCD.
    #[error("row {0} reads \"{1}\"")]
    Row(usize, String),
    /// Coordinates as the display counts them.
    #[error("the coordinates are {0:.3} {1:.3}")]
    Position(f64, f64),
    /// Places of the slides, X as a diameter.
    #[error("the slides stand at {0:.3} {1:.3}")]
    Slides(f64, f64),
    /// Pulses given to the drives.
    #[error("the pulses are {0} {1}")]
    Pulses(i64, i64),
    /// The analogue output for the spindle.
    #[error("the output is {0:.3} V")]
    Volts(f64),
    /// A lamp.
    #[error("the lamp {0} is {1}")]
    Lamp(String, &'static str),
    /// Alarms and messages that stand.
    #[error("{0}")]
    Alarms(String),
    /// The mode.
    #[error("the mode is {0}")]
    Mode(&'static str),
    /// A bit of PLC memory.
    #[error("{0} is {1}")]
    Bit(BitAddress, u8),
    /// A byte or entry of PLC memory.
    #[error("{0} is {1}")]
    Value(ByteAddress, i32),
}

impl Expect {
    /// Compares.
    ///
    /// # Errors
    /// What was seen instead.
    pub fn check(&self, emulator: &Emulator) -> Result<(), Unmet> {
        let cnc = &emulator.simulation.cnc;
        match self {
            Self::Row(row, text) => {
                let seen = emulator.screen().row(*row);
                let fits = folded(&seen).contains(&folded(text));
                verdict(fits, || Unmet::Row(*row, seen.trim_end().to_owned()))
            }
            Self::Position(coordinates, x, z) => {
                let at = match coordinates {
                    Coordinates::Absolute => cnc.position_absolute(),
                    Coordinates::Machine => cnc.position_machine(),
                    Coordinates::Relative => cnc.position_relative(),
                };
                let seen = Point::new(
                    if cnc.parameters().radius_programming() {
                        at.x
                    } else {
                        at.x * 2.0
                    },
                    at.z,
                );
                verdict(near(seen.x, *x) && near(seen.z, *z), || {
                    Unmet::Position(seen.x, seen.z)
                })
            }
            Self::Slides(x, z) => {
                let at = emulator.simulation.lathe.slides();
                verdict(near(at.x * 2.0, *x) && near(at.z, *z), || {
                    Unmet::Slides(at.x * 2.0, at.z)
                })
            }
            Self::Pulses(x, z) => {
                let seen = cnc.pulses();
                verdict(x.contains(&seen.x.0) && z.contains(&seen.z.0), || {
                    Unmet::Pulses(seen.x.0, seen.z.0)
                })
            }
            Self::Volts(volts) => {
                let seen = cnc.spindle_volts();
                verdict(near(seen, *volts), || Unmet::Volts(seen))
            }
            Self::Lamp(name, lamp, on) => {
                let seen = emulator.lamp(*lamp);
                verdict(seen == *on, || {
                    Unmet::Lamp(name.clone(), if seen { "on" } else { "off" })
                })
            }
            Self::Alarm(number) => verdict(
                standing(emulator).iter().any(|(seen, _)| seen == number),
                || Unmet::Alarms(alarms(emulator)),
            ),
            Self::NoAlarm => verdict(standing(emulator).is_empty(), || {
                Unmet::Alarms(alarms(emulator))
            }),
            Self::Mode(mode) => verdict(cnc.mode() == *mode, || Unmet::Mode(cnc.mode().text())),
            Self::Bit(address, on) => {
                let seen = cnc.plc().memory().bit(*address);
                verdict(seen == *on, || Unmet::Bit(*address, u8::from(seen)))
            }
            Self::Value(address, value) => {
                let memory = cnc.plc().memory();
                let seen = if address.area.is_entry() {
                    memory.long(*address)
                } else {
                    memory.byte(*address).into()
                };
                verdict(seen == *value, || Unmet::Value(*address, seen))
            }
        }
    }
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < TOLERANCE
}

fn verdict(fits: bool, seen: impl FnOnce() -> Unmet) -> Result<(), Unmet> {
    if fits { Ok(()) } else { Err(seen()) }
}

/// Alarms and messages that stand.
fn standing(emulator: &Emulator) -> Vec<(u16, String)> {
    let cnc = &emulator.simulation.cnc;
    let alarms = cnc.alarms().iter();
    let mut all: Vec<_> = alarms
        .map(|alarm| (alarm.number, alarm.to_string()))
        .collect();
    let messages = cnc.plc_messages();
    all.extend(messages.map(|(number, text)| (number, format!("{number} {text}"))));
    all
}

fn alarms(emulator: &Emulator) -> String {
    let texts: Vec<String> = standing(emulator)
        .into_iter()
        .map(|(_, text)| text)
        .collect();
    if texts.is_empty() {
        "no alarm stands".to_owned()
    } else {
        format!("alarms: {}", texts.join(" | "))
    }
}
