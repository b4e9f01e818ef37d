//! The wires between a board and the machine, as the machine file names them.

use serde::{Deserialize, Serialize};

use super::pin::PinName;

/// The wiring of one axis. Pins have the board's names; `^` before a name enables the
/// pull-up, `!` inverts the level. An empty name means that the pin is not wired.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LinkAxis {
    /// Whether the direction is inverted: in a line board by $3, with timed steps in
    /// addition to the `!` of the pin.
    pub invert_direction: bool,
    /// Name of the step pin.
    pub step: String,
    /// Name of the direction pin.
    pub dir: String,
    /// Length of a step pulse, µs, 1–255.
    pub step_pulse_us: u32,
    /// Least time between the last pulse in one direction and the first in the other,
    /// µs, 1–1000.
    pub dir_setup_us: u32,
    /// Greatest pulse rate, 1/s, 1000–1 000 000. `None`: the known rate of the processor.
    pub max_rate: Option<u32>,
    /// Pin of the limit switches of the axis.
    pub limit: String,
    /// Pin of the deceleration switch of the axis for the machine zero return.
    pub dec: String,
    /// Pin of the zero signal (one-turn signal) of the drive.
    pub zero: String,
    /// Whether the homing switch of a line board is at the negative end of the board's
    /// axis ($23).
    pub home_negative: bool,
    /// Machine coordinate at the end of homing with a limit switch, mm (X as a diameter),
    /// ±9999.999.
    pub home_at: f64,
    /// Encoder of the motor or of the slide, for a board that compares it with the steps.
    pub encoder: AxisEncoderConfig,
}

/// The encoder of an axis.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AxisEncoderConfig {
    /// Pin of the signal A; B is at the next pin. Empty if not wired.
    pub pin: String,
    /// Number of counts, four for each line, 1–1 000 000 ...
    pub counts: u32,
    /// ... in this number of steps, 1–1 000 000.
    pub steps: u32,
    /// Greatest following error, steps, 1–100 000: above it the board stops.
    pub limit: u32,
}

impl Default for AxisEncoderConfig {
    fn default() -> Self {
        Self {
            pin: String::new(),
            counts: 1,
            steps: 1,
            limit: 200,
        }
    }
}

impl Default for LinkAxis {
    fn default() -> Self {
        Self {
            invert_direction: false,
            step: String::new(),
            dir: String::new(),
            step_pulse_us: 2,
            dir_setup_us: 10,
            max_rate: None,
            limit: String::new(),
            dec: String::new(),
            zero: String::new(),
            home_negative: false,
            home_at: 0.0,
            encoder: AxisEncoderConfig::default(),
        }
    }
}

impl LinkAxis {
    /// Whether a board with timed steps inverts the direction signal: either the setting or the `!`
    /// of the pin inverts it, but not both.
    pub(crate) fn is_direction_inverted(&self) -> bool {
        self.invert_direction != PinName::read(&self.dir).inverted
    }
}

/// The other pins of a board with timed steps, named like those of the axes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LinkIo {
    /// Pin of the output that enables the drives.
    pub enable: String,
    /// Pin of the input that reads the emergency stop chain; empty if not wired.
    pub estop: String,
    /// Pin of the input for the alarm of the drives; empty if not wired.
    pub drive_alarm: String,
    /// Pin of the output that turns the spindle clockwise (M03); empty if not wired.
    pub spindle_cw: String,
    /// Pin of the output that turns the spindle counterclockwise (M04); empty if not wired.
    pub spindle_ccw: String,
    /// Pin of the output for the spindle speed, pulse-width modulated for 0–10 V; empty if not
    /// wired.
    pub spindle_pwm: String,
    /// Pin of the output that switches the coolant (M08); empty if not wired.
    pub coolant: String,
    /// Pin of the input for the one-turn signal of the spindle; empty if not wired.
    pub index: String,
    /// Pin of the signal A of the spindle encoder, B is at the next pin: steps then follow the
    /// angle of the spindle. Empty if not wired.
    pub encoder: String,
    /// Counts of the spindle encoder per turn of the spindle: four for each line, 100–1 000 000.
    pub encoder_counts: u32,
    /// Pin of the signal A of the handwheel, B is at the next pin; empty if not wired.
    pub wheel: String,
    /// Counts of the handwheel per graduation, 1–100: four edges for most.
    pub wheel_counts: u32,
}

impl Default for LinkIo {
    fn default() -> Self {
        Self {
            enable: String::new(),
            estop: String::new(),
            drive_alarm: String::new(),
            spindle_cw: String::new(),
            spindle_ccw: String::new(),
            spindle_pwm: String::new(),
            coolant: String::new(),
            index: String::new(),
            encoder: String::new(),
            encoder_counts: 4096,
            wheel: String::new(),
            wheel_counts: 4,
        }
    }
}
