//! Electronic gear ratio CMR/CMD (parameters 015 to 018; manual III-12.4).

use gsk_messages::{Message, say};

use crate::measurement::SlideTravel;

const MAX_FACTOR: i32 = 127;

/// An electronic gear ratio CMR/CMD that the parameters can store.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearRatio {
    /// The command multiplier CMR, 1 to 127.
    pub multiply: i32,
    /// The command divider CMD, 1 to 127.
    pub divide: i32,
    /// Error of the slide travel with this ratio, µm per metre.
    pub error_um_per_m: f64,
}

/// Mechanical data of an axis drive, from its nameplates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveTrain {
    /// Pulses per motor turn: 360 divided by the pulse angle in degrees.
    pub pulses_per_turn: f64,
    /// Screw lead: slide travel per screw turn, mm.
    pub lead: SlideTravel,
    /// Teeth of the wheel on the screw (ZM).
    pub screw_teeth: u32,
    /// Teeth of the wheel on the motor (ZD).
    pub motor_teeth: u32,
}

impl DriveTrain {
    /// Computes the exact ratio CMR/CMD = (δ · 360) / (α · L) · ZM / ZD, which may have no
    /// whole factors. `increment` is δ, the least output increment in mm.
    ///
    /// # Errors
    /// Returns a message if a value is not a finite number above 0.
    pub fn gear_ratio(&self, increment: SlideTravel) -> Result<f64, Message> {
        let lead = self.lead.0;
        let is_valid = self.pulses_per_turn > 0.0
            && lead > 0.0
            && self.pulses_per_turn.is_finite()
            && lead.is_finite();
        if !is_valid || self.screw_teeth == 0 || self.motor_teeth == 0 {
            return Err(say::commission_drive_numbers());
        }
        let tooth_ratio = f64::from(self.screw_teeth) / f64::from(self.motor_teeth);
        Ok(increment.0 * self.pulses_per_turn / lead * tooth_ratio)
    }
}

/// Finds the gear ratio with the smallest CMR and CMD whose relative error is at most
/// `tolerance`. If none is within the tolerance, finds the nearest one.
///
/// # Errors
/// Returns a message if the ratio is outside 1/127 to 127.
pub fn find_nearest_ratio(target_ratio: f64, tolerance: f64) -> Result<GearRatio, Message> {
    let largest = f64::from(MAX_FACTOR);
    if !(target_ratio.is_finite()
        && target_ratio >= 0.999 / largest
        && target_ratio <= 1.001 * largest)
    {
        return Err(say::commission_gear_out_of_reach(target_ratio, MAX_FACTOR));
    }
    let mut best = (1, 1, f64::INFINITY);
    for divide in 1..=MAX_FACTOR {
        let multiply = (target_ratio * f64::from(divide))
            .round()
            .clamp(1.0, largest);
        let relative_error = (multiply / (target_ratio * f64::from(divide)) - 1.0).abs();
        // A pair of larger numbers must be better by more than rounding.
        if relative_error < best.2 - 1e-12 {
            best = (multiply as i32, divide, relative_error);
        }
        if relative_error <= tolerance {
            break;
        }
    }
    let (multiply, divide, _) = best;
    let actual = f64::from(multiply) / f64::from(divide);
    Ok(GearRatio {
        multiply,
        divide,
        error_um_per_m: (actual / target_ratio - 1.0) * 1e6,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nameplate data as in the manual: 0.75 degrees, lead 6 mm, belt 1:2.
    #[test]
    fn nameplates_give_the_gear_ratio() {
        let drive = DriveTrain {
            pulses_per_turn: 480.0,
            lead: SlideTravel(6.0),
            screw_teeth: 40,
            motor_teeth: 20,
        };
        let target_ratio = drive.gear_ratio(SlideTravel(0.001)).unwrap();
        assert!((target_ratio - 0.16).abs() < 1e-12);
        let ratio = find_nearest_ratio(target_ratio, 0.0).unwrap();
        assert_eq!((ratio.multiply, ratio.divide), (4, 25));
        assert!(ratio.error_um_per_m.abs() < 1e-6);
        let none = DriveTrain {
            motor_teeth: 0,
            ..drive
        };
        assert!(none.gear_ratio(SlideTravel(0.001)).is_err());
    }

    #[test]
    fn inexact_ratio_reports_its_error() {
        let ratio = find_nearest_ratio(1.0 / 3.1717, 0.0).unwrap();
        let actual = f64::from(ratio.multiply) / f64::from(ratio.divide);
        assert!((actual * 3.1717 - 1.0 - ratio.error_um_per_m * 1e-6).abs() < 1e-12);
        for out in [0.0, 1e-3, 200.0, f64::NAN, f64::INFINITY] {
            assert!(find_nearest_ratio(out, 0.0).is_err());
        }
        assert_eq!(
            find_nearest_ratio(1.0, 0.0).map(|it| (it.multiply, it.divide)),
            Ok((1, 1))
        );
        // A measured ratio: the screw is long by 100 µm per metre.
        let simple = find_nearest_ratio(2.0002, 200e-6).map(|it| (it.multiply, it.divide));
        assert_eq!(simple, Ok((2, 1)));
    }
}
