//! Formats numbers as the pages show them (manual III-2).

use gsk_core::cnc::Cnc;
use gsk_core::units::Axis;

/// Number of millimetres in an inch.
const INCH: f64 = 25.4;

/// Number of ten-thousandths of the F word in one displayed unit; the per-revolution display rounds
/// down to whole units.
const PER_REVOLUTION_UNIT: f64 = 100.0;

/// How coordinates are shown: X as diameter or radius, mm or inch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoordinateFormat {
    /// Whether X is shown as a diameter (001.2 = 0) instead of a radius.
    pub diameter: bool,
    /// Whether lengths are shown in inches with four decimals (004.0 SCW) instead of mm with
    /// three.
    pub inch: bool,
}

impl CoordinateFormat {
    /// Returns the format that the parameters of the control select.
    pub fn of(cnc: &Cnc) -> Self {
        Self {
            diameter: !cnc.parameters().is_radius_programming(),
            inch: cnc.parameters().is_inch_machine(),
        }
    }

    /// Formats a coordinate given in mm (X as a radius), as a diameter or in inches if set.
    pub fn coordinate(self, axis: Axis, value: f64) -> String {
        match axis {
            Axis::X if self.diameter => self.length(value * 2.0),
            _ => self.length(value),
        }
    }

    /// Converts a coordinate in the unit of the display to mm, X to a radius.
    pub(crate) fn to_mm(self, axis: Axis, shown: f64) -> f64 {
        let value = if self.inch { shown * INCH } else { shown };
        match axis {
            Axis::X if self.diameter => value / 2.0,
            _ => value,
        }
    }

    /// Formats a length given in mm; in inches if the format is inch.
    pub fn length(self, value: f64) -> String {
        if self.inch {
            decimals(value / INCH, 4)
        } else {
            decimals(value, 3)
        }
    }
}

/// Formats a number with `count` decimals; never as "-0.000".
fn decimals(value: f64, count: usize) -> String {
    let text = format!("{value:.count$}");
    let zero = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
    match text.strip_prefix('-') {
        Some(positive) if zero => positive.to_owned(),
        _ => text,
    }
}

/// Formats a length given in thousandths of a millimetre as millimetres with three decimals.
pub fn thousandths(value: i32) -> String {
    decimals(f64::from(value) / 1000.0, 3)
}

/// Formats a feed rate in mm/min without decimals, rounded down; `***` above 15000.
pub fn per_minute(rate: f64) -> String {
    if rate > 15_000.0 {
        return "***".to_owned();
    }
    format!("{:.0}", integer_part(rate))
}

/// Formats a feed rate given in mm/r, as hundredths of a millimetre rounded down; `***` above
/// 500 mm/r.
pub fn per_revolution(rate: f64) -> String {
    if rate > 500.0 {
        return "***".to_owned();
    }
    let units = (rate * 10_000.0).round();
    format!("{:.0}", (units / PER_REVOLUTION_UNIT).floor())
}

/// Returns the integer part. A value that is a rounding error below an integer counts as that
/// integer.
fn integer_part(value: f64) -> f64 {
    (value + 1e-6).floor()
}

/// Formats a jog rate in mm/min as the manual's table does: with one decimal below 20.
pub fn jog_rate(rate: f64) -> String {
    if rate > 0.0 && rate < 19.95 {
        format!("{rate:.1}")
    } else {
        format!("{rate:.0}")
    }
}

/// Formats the rapid override as a percentage; 0 is shown as `F0`.
pub fn rapid_override(percent: u8) -> String {
    match percent {
        0 => "F0".to_owned(),
        percent => format!("{percent}%"),
    }
}

/// Formats a duration given in milliseconds as `hh:mm:ss`. After 99:59:59 it restarts at 0.
pub fn clock(milliseconds: u64) -> String {
    let seconds = milliseconds / 1000;
    let (hours, minutes) = (seconds / 3600 % 100, seconds / 60 % 60);
    format!("{hours:02}:{minutes:02}:{:02}", seconds % 60)
}

/// Formats a byte as eight binary digits, bit 7 first.
pub fn byte(value: u8) -> String {
    format!("{value:08b}")
}

/// Formats the absolute value, rounded, with four digits; 9999 if greater.
pub fn four_digits(value: f64) -> String {
    format!("{:04.0}", value.abs().round().min(9999.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const METRIC: CoordinateFormat = CoordinateFormat {
        diameter: true,
        inch: false,
    };

    #[test]
    fn coordinates() {
        assert_eq!(METRIC.coordinate(Axis::X, 8.0), "16.000");
        assert_eq!(METRIC.coordinate(Axis::Z, -9999.999), "-9999.999");
        assert_eq!(METRIC.coordinate(Axis::Z, -0.0004), "0.000");
        assert_eq!(METRIC.coordinate(Axis::Z, -0.0006), "-0.001");
        let inch = CoordinateFormat {
            diameter: false,
            inch: true,
        };
        assert_eq!(inch.coordinate(Axis::X, 25.4), "1.0000");
    }

    #[test]
    fn rates_of_the_manual() {
        assert_eq!(per_revolution(20.2568), "2025");
        assert_eq!(per_revolution(10.0), "1000");
        assert_eq!(per_revolution(500.001), "***");
        assert_eq!(per_revolution(500.0), "50000");
        assert_eq!(per_minute(15_000.0), "15000");
        assert_eq!(per_minute(15_001.0), "***");
        assert_eq!(per_minute(100.0 * 0.7), "70");
        let rates = [0.0, 2.0, 3.2, 12.6, 20.0, 1260.0].map(jog_rate);
        assert_eq!(rates, ["0", "2.0", "3.2", "12.6", "20", "1260"]);
    }

    #[test]
    fn overrides_times_and_bytes() {
        assert_eq!(rapid_override(0), "F0");
        assert_eq!(rapid_override(25), "25%");
        assert_eq!(clock(19_688_999), "05:28:08");
        assert_eq!(clock(360_000_000), "00:00:00");
        assert_eq!(byte(0b0100_0001), "01000001");
        assert_eq!(four_digits(-300.2), "0300");
        assert_eq!(four_digits(12_000.0), "9999");
    }
}
