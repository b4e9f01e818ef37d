//! The electronic gear (015–018; manual III-12.4).

use gsk_messages::{Message, say};

use crate::measurement::Travel;

/// The largest number of each side.
const LARGEST: i32 = 127;

/// Numerator and denominator: CMR over CMD.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// CMR, 1 to 127.
    pub multiply: i32,
    /// CMD, 1 to 127.
    pub divide: i32,
    /// How far the travel is off with it, µm a metre.
    pub off: f64,
}

/// A drive as its plates say it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Pulses of a turn of the motor: 360 over the pulse angle.
    pub pulses: f64,
    /// Slide travel of a turn of the screw.
    pub lead: Travel,
    /// Teeth of the wheel on the screw.
    pub screw_teeth: u32,
    /// Teeth of the wheel on the motor.
    pub motor_teeth: u32,
}

impl Drive {
    /// CMR / CMD = (δ · 360) / (α · L) · ZM / ZD. `increment`: δ, the least output increment.
    ///
    /// # Errors
    /// A number that is not above 0.
    pub fn ratio(&self, increment: Travel) -> Result<f64, Message> {
        let lead = self.lead.0;
        let fine = self.pulses > 0.0 && lead > 0.0 && self.pulses.is_finite() && lead.is_finite();
        if !fine || self.screw_teeth == 0 || self.motor_teeth == 0 {
            return Err(say::commission_drive_numbers());
        }
        let wheels = f64::from(self.screw_teeth) / f64::from(self.motor_teeth);
        Ok(increment.0 * self.pulses / lead * wheels)
    }
}

/// The ratio with the smallest numbers that is at most so far off, as a part of itself; where
/// none is, the one that comes nearest.
///
/// # Errors
/// It is out of reach of 1 to 127 on both sides.
pub fn nearest_ratio(wanted: f64, tolerance: f64) -> Result<Ratio, Message> {
    let largest = f64::from(LARGEST);
    if !(wanted.is_finite() && wanted >= 0.999 / largest && wanted <= 1.001 * largest) {
        return Err(say::commission_gear_out_of_reach(wanted, LARGEST));
    }
    let mut best = (1, 1, f64::INFINITY);
    for divide in 1..=LARGEST {
        let multiply = (wanted * f64::from(divide)).round().clamp(1.0, largest);
        let off = (multiply / (wanted * f64::from(divide)) - 1.0).abs();
        // A larger pair has to be better by more than the last bits.
        if off < best.2 - 1e-12 {
            best = (multiply as i32, divide, off);
        }
        if off <= tolerance {
            break;
        }
    }
    let (multiply, divide, _) = best;
    let made = f64::from(multiply) / f64::from(divide);
    Ok(Ratio {
        multiply,
        divide,
        off: (made / wanted - 1.0) * 1e6,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the manual's kind: 0.75 degrees, lead 6, belt 1 to 2.
    #[test]
    fn plates_give_the_ratio() {
        let drive = Drive {
            pulses: 480.0,
            lead: Travel(6.0),
            screw_teeth: 40,
            motor_teeth: 20,
        };
        let wanted = drive.ratio(Travel(0.001)).unwrap();
        assert!((wanted - 0.16).abs() < 1e-12);
        let ratio = nearest_ratio(wanted, 0.0).unwrap();
        assert_eq!((ratio.multiply, ratio.divide), (4, 25));
        assert!(ratio.off.abs() < 1e-6);
        let none = Drive {
            motor_teeth: 0,
            ..drive
        };
        assert!(none.ratio(Travel(0.001)).is_err());
    }

    #[test]
    fn a_ratio_between_has_its_error_told() {
        let ratio = nearest_ratio(1.0 / 3.1717, 0.0).unwrap();
        let made = f64::from(ratio.multiply) / f64::from(ratio.divide);
        assert!((made * 3.1717 - 1.0 - ratio.off * 1e-6).abs() < 1e-12);
        for out in [0.0, 1e-3, 200.0, f64::NAN, f64::INFINITY] {
            assert!(nearest_ratio(out, 0.0).is_err());
        }
        assert_eq!(
            nearest_ratio(1.0, 0.0).map(|it| (it.multiply, it.divide)),
            Ok((1, 1))
        );
        // As it is measured: a screw is long by 100 µm a metre.
        let simple = nearest_ratio(2.0002, 200e-6).map(|it| (it.multiply, it.divide));
        assert_eq!(simple, Ok((2, 1)));
    }
}
