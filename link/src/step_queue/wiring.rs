//! Builds the configuration of a board from the wiring in the machine file.

use core::fmt::Write;

use super::super::pin::PinName;
use super::super::{Input, LinkConfig, Output, contacts};
use super::commands::{COMMANDS, Command};
use super::dictionary::Dictionary;
use gsk_messages::{Message, say};
use gsk_units::PerAxis;
use thiserror::Error;

/// Time without a command after which the board disables the drives, ms.
const ENABLE_MS: u64 = 500;
/// Frequency of the pulse width modulation for the spindle voltage, Hz.
const SPEED_CYCLES: u64 = 1000;
/// Time for which a guard input must have its level, µs.
const GUARD_US: u64 = 20;
/// Pin number of a signal that is not wired.
const NO_PIN: i64 = 255;
/// Value of the spindle speed output for the full voltage, in boards without the constant
/// `PWM_MAX`.
const USUAL_FULL: u32 = 255;

/// A configured input pin of the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Switch {
    pub(super) input: Input,
    pub(super) oid: i64,
    /// Level of the pin when the switch is operated, 0 or 1.
    pub(super) level: i64,
}

/// A configured output pin of the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct OutputPin {
    pub(super) output: Output,
    pub(super) oid: i64,
    pub(super) inverted: bool,
}

/// The configuration of a board, with the object number (oid) of each stepper, stop group, input
/// and output.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Wiring {
    pub(super) axes: PerAxis<i64>,
    pub(super) groups: [i64; 2],
    pub(super) enable: OutputPin,
    pub(super) switches: Vec<Switch>,
    pub(super) outputs: Vec<OutputPin>,
    pub(super) index: Option<i64>,
    /// Object number of the spindle encoder; `None` without one.
    pub(super) spindle: Option<i64>,
    /// Object number of the handwheel; `None` without one.
    pub(super) wheel: Option<i64>,
    /// Value of the speed output that gives the full spindle voltage.
    pub(super) full: u32,
    /// The configuration messages for the board, without `finalize_config`.
    pub(super) messages: Vec<Vec<u8>>,
    /// CRC of the configuration, by which the link recognizes it in the board.
    pub(super) crc: u32,
}

struct Pin {
    number: i64,
    pull_up: bool,
    inverted: bool,
}

struct Writer<'a> {
    board: &'a Dictionary,
    oids: i64,
    text: String,
    messages: Vec<Vec<u8>>,
}

/// The reason why a board cannot have the wiring of the machine file. Each `key` is the path of a
/// setting in the section `link`.
#[derive(Debug, Error)]
#[error("{}", self.message())]
pub(super) enum WiringError {
    /// The board has no pin of this name.
    NoPin { key: String, pin: String },
    /// The board reserves the pin for this purpose.
    Reserved {
        key: String,
        pin: String,
        purpose: String,
    },
}

impl WiringError {
    /// Returns the message that names the pin and why the board cannot use it.
    pub(super) fn message(&self) -> Message {
        match self {
            Self::NoPin { key, pin } => say::board_pin_missing(key, pin),
            Self::Reserved { key, pin, purpose } => say::board_pin_reserved(key, pin, purpose),
        }
    }
}

impl Writer<'_> {
    fn oid(&mut self) -> i64 {
        self.oids += 1;
        self.oids - 1
    }

    fn pin(&self, key: &str, name: &str) -> Result<Pin, WiringError> {
        let pin = PinName::read(name);
        let number = self.board.pin(pin.name);
        let number = number.ok_or_else(|| WiringError::NoPin {
            key: key.to_owned(),
            pin: pin.name.to_owned(),
        })?;
        if let Some(purpose) = self.board.reserved(pin.name) {
            return Err(WiringError::Reserved {
                key: key.to_owned(),
                pin: pin.name.to_owned(),
                purpose: purpose.to_owned(),
            });
        }
        Ok(Pin {
            number: number.into(),
            pull_up: pin.pull_up,
            inverted: pin.inverted,
        })
    }

    fn add(&mut self, command: Command, arguments: &[i64]) {
        let mut arguments_left = arguments.iter();
        for word in COMMANDS[command as usize].2.split(' ') {
            match (word.split_once('='), arguments_left.len()) {
                // Writing to a `String` cannot fail.
                (Some((name, _)), 1..) => {
                    let value = arguments_left.next().copied().unwrap_or_default();
                    let _ = write!(self.text, " {name}={value}");
                }
                _ => self.text.push_str(word),
            }
        }
        self.text.push('\n');
        self.messages.push(self.board.message(command, arguments));
    }
}

impl Wiring {
    /// Builds the configuration of a board from the machine file and the dictionary of the board.
    /// `rate` is its clock rate, ticks per second.
    ///
    /// # Errors
    /// The board has no pin of a name, or reserves a pin.
    pub(super) fn new(
        config: &LinkConfig,
        board: &Dictionary,
        rate: u64,
    ) -> Result<Self, WiringError> {
        let mut writer = Writer {
            board,
            oids: 0,
            text: String::new(),
            messages: Vec::new(),
        };
        let axes = PerAxis::new(writer.oid(), writer.oid());
        for (oid, names, axis) in [
            (axes.x, ["x.step", "x.dir"], &config.x),
            (axes.z, ["z.step", "z.dir"], &config.z),
        ] {
            let step = writer.pin(names[0], &axis.step)?;
            let dir = writer.pin(names[1], &axis.dir)?;
            let pulse = u64::from(axis.step_pulse_us) * rate / 1_000_000;
            let inverted = i64::from(step.inverted);
            writer.add(
                Command::ConfigStepper,
                &[oid, step.number, dir.number, inverted, pulse as i64],
            );
        }
        let groups = [writer.oid(), writer.oid()];
        for oid in groups {
            writer.add(Command::ConfigTrsync, &[oid]);
        }
        let longest = rate * ENABLE_MS / 1000;
        let enable = writer.digital("io.enable", &config.io.enable, Output::Enable, longest)?;
        let switches = writer.switches(config)?;
        let mut outputs = Vec::new();
        for (key, name, output) in [
            (
                "io.spindle_cw",
                &config.io.spindle_cw,
                Output::SpindleForward,
            ),
            (
                "io.spindle_ccw",
                &config.io.spindle_ccw,
                Output::SpindleReverse,
            ),
            ("io.coolant", &config.io.coolant, Output::Coolant),
        ] {
            if !name.is_empty() {
                outputs.push(writer.digital(key, name, output, 0)?);
            }
        }
        let full = board.constant("PWM_MAX").unwrap_or(USUAL_FULL);
        if !config.io.spindle_pwm.is_empty() {
            let pin = writer.pin("io.spindle_pwm", &config.io.spindle_pwm)?;
            let oid = writer.oid();
            let off = if pin.inverted { i64::from(full) } else { 0 };
            let cycle = (rate / SPEED_CYCLES) as i64;
            writer.add(
                Command::ConfigPwmOut,
                &[oid, pin.number, cycle, off, off, 0],
            );
            outputs.push(OutputPin {
                output: Output::SpindleSpeed,
                oid,
                inverted: pin.inverted,
            });
        }
        let spindle = writer.encoders(config, axes)?;
        let mut index = None;
        if !config.io.index.is_empty() && spindle.is_none() {
            let pin = writer.pin("io.index", &config.io.index)?;
            let oid = writer.oid();
            writer.add(
                Command::ConfigCounter,
                &[oid, pin.number, i64::from(pin.pull_up)],
            );
            index = Some(oid);
        }
        let wheel = writer.wheel(config)?;
        if board.has(Command::ConfigGuard) {
            writer.guards(config, rate)?;
        }
        let mut messages = vec![board.message(Command::AllocateOids, &[writer.oids])];
        messages.append(&mut writer.messages);
        Ok(Self {
            axes,
            groups,
            enable,
            switches,
            outputs,
            index,
            spindle,
            wheel,
            full,
            messages,
            crc: crc32(writer.text.as_bytes()),
        })
    }
}

impl Writer<'_> {
    fn digital(
        &mut self,
        key: &str,
        name: &str,
        output: Output,
        longest: u64,
    ) -> Result<OutputPin, WiringError> {
        let pin = self.pin(key, name)?;
        let oid = self.oid();
        let off = i64::from(pin.inverted);
        self.add(
            Command::ConfigDigitalOut,
            &[oid, pin.number, off, off, longest as i64],
        );
        Ok(OutputPin {
            output,
            oid,
            inverted: pin.inverted,
        })
    }

    /// Configures the encoders of the spindle and of the axes. Returns the object number of the
    /// spindle encoder; `None` without one.
    fn encoders(
        &mut self,
        config: &LinkConfig,
        axes: PerAxis<i64>,
    ) -> Result<Option<i64>, WiringError> {
        let mut spindle = None;
        if !config.io.encoder.is_empty() {
            let pin = self.pin("io.encoder", &config.io.encoder)?;
            let index = match config.io.index.as_str() {
                "" => NO_PIN,
                name => self.pin("io.index", name)?.number,
            };
            let oid = self.oid();
            let counts = config.io.encoder_counts.into();
            self.add(Command::ConfigSpindle, &[oid, pin.number, index, counts]);
            spindle = Some(oid);
        }
        for (stepper, key, axis) in [
            (axes.x, "x.encoder.pin", &config.x),
            (axes.z, "z.encoder.pin", &config.z),
        ] {
            let encoder = &axis.encoder;
            if encoder.pin.is_empty() {
                continue;
            }
            let pin = self.pin(key, &encoder.pin)?;
            let oid = self.oid();
            let numbers = [encoder.counts, encoder.steps, encoder.limit].map(i64::from);
            let [counts, steps, limit] = numbers;
            self.add(
                Command::ConfigAxisEncoder,
                &[oid, pin.number, stepper, counts, steps, limit],
            );
        }
        Ok(spindle)
    }

    /// Configures the handwheel. Returns its object number; `None` without one.
    fn wheel(&mut self, config: &LinkConfig) -> Result<Option<i64>, WiringError> {
        if config.io.wheel.is_empty() {
            return Ok(None);
        }
        let pin = self.pin("io.wheel", &config.io.wheel)?;
        let oid = self.oid();
        self.add(Command::ConfigWheel, &[oid, pin.number]);
        Ok(Some(oid))
    }

    /// Configures emergency stop and drive alarm as guards: the board then shuts down without the
    /// host, and all its outputs go off.
    fn guards(&mut self, config: &LinkConfig, rate: u64) -> Result<(), WiringError> {
        for (key, name) in [
            ("io.estop", &config.io.estop),
            ("io.drive_alarm", &config.io.drive_alarm),
        ] {
            if name.is_empty() {
                continue;
            }
            let pin = self.pin(key, name)?;
            let oid = self.oid();
            let ticks = (rate * GUARD_US / 1_000_000) as i64;
            let level = i64::from(!pin.inverted);
            self.add(
                Command::ConfigGuard,
                &[oid, pin.number, pin.pull_up.into(), level, ticks],
            );
        }
        Ok(())
    }

    fn switches(&mut self, config: &LinkConfig) -> Result<Vec<Switch>, WiringError> {
        let own = [
            ("x.limit", &config.x.limit, Input::LimitX),
            ("z.limit", &config.z.limit, Input::LimitZ),
            ("io.estop", &config.io.estop, Input::EmergencyStop),
            ("io.drive_alarm", &config.io.drive_alarm, Input::DriveAlarm),
            ("x.dec", &config.x.dec, Input::DecelerationX),
            ("z.dec", &config.z.dec, Input::DecelerationZ),
            ("x.zero", &config.x.zero, Input::ZeroX),
            ("z.zero", &config.z.zero, Input::ZeroZ),
        ];
        let own = own.map(|(key, name, input)| (key, name.as_str(), input));
        let contacts = contacts::wired(&config.inputs).map(|(input, name)| ("inputs", name, input));
        let mut switches = Vec::new();
        for (key, name, input) in own.into_iter().chain(contacts) {
            if name.is_empty() {
                continue;
            }
            let pin = self.pin(key, name)?;
            let oid = self.oid();
            self.add(
                Command::ConfigEndstop,
                &[oid, pin.number, i64::from(pin.pull_up)],
            );
            switches.push(Switch {
                input,
                oid,
                level: i64::from(!pin.inverted),
            });
        }
        Ok(switches)
    }
}

/// Returns the CRC-32 (IEEE 802.3) of bytes.
fn crc32(bytes: &[u8]) -> u32 {
    let update = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            crc >> 1 ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 }
        })
    };
    !bytes.iter().fold(u32::MAX, update)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_crc_has_the_standard_check_value() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
    }
}
