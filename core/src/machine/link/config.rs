//! The section `link` of the machine file (RON).

use core::fmt;

use serde::{Deserialize, Serialize};

/// A pulse board and how it is wired.
///
/// ```
/// use gsk_core::machine::link::LinkConfig;
/// let link: LinkConfig = ron::from_str(r#"(port: "/dev/ttyUSB0", line: (max_rate: 30000))"#).unwrap();
/// assert_eq!(link.lookahead_ms, 150);
/// assert!(link.check().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LinkConfig {
    /// Serial device, best by its unchanging name under `/dev/serial/by-id/`.
    pub port: String,
    /// Bits a second.
    pub baud: u32,
    /// How far the kernel may run ahead of the board, ms, 50–400. Every hold is
    /// later by this.
    pub lookahead_ms: u32,
    /// Wiring of the cross slide.
    pub x: LinkAxis,
    /// Wiring of the carriage.
    pub z: LinkAxis,
    /// Boards that read lines (Grbl, grblHAL, FluidNC).
    pub line: LineConfig,
}

impl Default for LinkConfig {
    fn default() -> Self {
        Self {
            port: String::new(),
            baud: 115_200,
            lookahead_ms: 150,
            x: LinkAxis::default(),
            z: LinkAxis::default(),
            line: LineConfig::default(),
        }
    }
}

/// One axis at the board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LinkAxis {
    /// The direction pin is turned over in the board ($3).
    pub invert_direction: bool,
}

/// What only boards of the Grbl family need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LineConfig {
    /// Duration of a segment, ms, 5–40.
    pub period_ms: u32,
    /// The most pulses a second and axis the board makes without losing one.
    pub max_rate: u32,
    /// Length of a step pulse, µs ($0).
    pub step_pulse_us: u32,
    /// Limit switches open when operated ($5).
    pub invert_limits: bool,
}

impl Default for LineConfig {
    fn default() -> Self {
        Self {
            period_ms: 10,
            max_rate: 30_000,
            step_pulse_us: 10,
            invert_limits: false,
        }
    }
}

/// A value out of its range.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkConfigError {
    /// Name of the field.
    pub field: &'static str,
    /// Its value.
    pub value: u32,
    /// Least value allowed.
    pub least: u32,
    /// Greatest value allowed.
    pub most: u32,
}

impl fmt::Display for LinkConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            field,
            value,
            least,
            most,
        } = self;
        write!(f, "link: {field} = {value} is outside {least}–{most}")
    }
}

impl core::error::Error for LinkConfigError {}

impl LinkConfig {
    /// Checks the ranges.
    ///
    /// # Errors
    /// The first field out of its range.
    pub const fn check(&self) -> Result<(), LinkConfigError> {
        let ranges = [
            ("baud", self.baud, 9600, 4_000_000),
            ("lookahead_ms", self.lookahead_ms, 50, 400),
            ("line.period_ms", self.line.period_ms, 5, 40),
            ("line.max_rate", self.line.max_rate, 1000, 1_000_000),
            ("line.step_pulse_us", self.line.step_pulse_us, 3, 255),
        ];
        let mut index = 0;
        while index < ranges.len() {
            let (field, value, least, most) = ranges[index];
            if value < least || value > most {
                return Err(LinkConfigError {
                    field,
                    value,
                    least,
                    most,
                });
            }
            index += 1;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_name_their_field() {
        let config = LinkConfig {
            lookahead_ms: 20,
            ..LinkConfig::default()
        };
        let error = config.check().unwrap_err();
        assert_eq!(
            error.to_string(),
            "link: lookahead_ms = 20 is outside 50–400"
        );
    }
}
