//! The steps of commissioning.

use gsk_core::axis::gear_speed_limit;
use gsk_core::memory::{Parameters, PitchTable, parameter};
use gsk_core::units::Axis;

use super::*;
use crate::change::{Change, Proposal};
use crate::gear::Drive;
use crate::measurement::Travel;

fn changed(proposal: &Proposal) -> Vec<(u16, i32)> {
    let changes = proposal.changes.iter();
    changes
        .map(|change| match change {
            Change::Value { number, value } => (*number, *value),
            Change::Bit { number, bit, on } => (*number, i32::from(*on) << bit),
            Change::Pitch { .. } => panic!("no step but pitch"),
        })
        .collect()
}

#[test]
fn a_gear_that_multiplies_slows_the_rapid() {
    let parameters = Parameters::default();
    let made = |commanded, measured| GearMeasured {
        commanded: Travel(commanded),
        measured: Travel(measured),
    };
    let half = gear_measured(Axis::Z, made(-100.0, -50.0), &parameters).unwrap();
    assert_eq!(
        changed(&half),
        [
            (parameter::Z_MULTIPLIER, 2),
            (parameter::Z_RAPID, 3800),
            (parameter::ZERO_HIGH_SPEED, 3800)
        ]
    );
    let twice = gear_measured(Axis::X, made(100.0, 200.0), &parameters).unwrap();
    assert_eq!(changed(&twice), [(parameter::X_DIVISOR, 2)]);
    for (commanded, measured) in [(100.0, -100.0), (100.0, 0.0), (0.0, 0.0), (f64::NAN, 1.0)] {
        assert!(gear_measured(Axis::X, made(commanded, measured), &parameters).is_err());
    }
    // X: 0.0005 mm an increment, 5 mm a turn of 10000 pulses.
    let drive = Drive {
        pulses: 10_000.0,
        lead: Travel(5.0),
        screw_teeth: 1,
        motor_teeth: 1,
    };
    let plates = gear_from_drive(Axis::X, &drive, &parameters).unwrap();
    assert_eq!(changed(&plates), []);
}

/// 113 is that of both axes, and twice that of X.
#[test]
fn the_approach_to_the_zero_keeps_below_the_limit_of_the_gears() {
    let approach = |parameters: &Parameters, method| {
        let proposal = reference(Axis::X, method, parameters).unwrap();
        let (mut then, mut none) = (parameters.clone(), PitchTable::default());
        for change in proposal.changes {
            change.apply(&mut then, &mut none).unwrap();
        }
        then.value(parameter::ZERO_HIGH_SPEED)
    };
    let mut parameters = Parameters::default();
    let both = ZeroMethod::SwitchAndSignal;
    assert_eq!(approach(&parameters, both), 7600);
    parameters.set(parameter::Z_MULTIPLIER, 2).unwrap();
    let limit = gear_speed_limit(Axis::Z, &parameters).unwrap().floor() as i32;
    assert_eq!(approach(&parameters, both), limit);
    assert_eq!(
        approach(&parameters, ZeroMethod::OneSwitch),
        limit.min(5000)
    );
    parameters.set(parameter::Z_MULTIPLIER, 1).unwrap();
    parameters.set(parameter::X_MULTIPLIER, 4).unwrap();
    let limit = (2.0 * gear_speed_limit(Axis::X, &parameters).unwrap()).floor() as i32;
    assert_eq!(approach(&parameters, both), limit.min(7600));
}

#[test]
fn the_sets_of_the_manual() {
    let parameters = Parameters::default();
    let stepper = acceleration(DriveKind::Stepper, &parameters).unwrap();
    let stepper = changed(&stepper);
    for row in [
        (parameter::X_RAPID, 2500),
        (parameter::Z_RAPID, 5000),
        (parameter::X_RAPID_TIME, 450),
        (parameter::THREAD_TIME, 250),
        (parameter::THREAD_LOW_SPEED, 50),
        (parameter::FEED_TIME, 250),
    ] {
        assert!(stepper.contains(&row), "{row:?} in {stepper:?}");
    }
    let one = reference(Axis::Z, ZeroMethod::OneSwitch, &parameters).unwrap();
    assert!(
        changed(&one).contains(&(7, 0b10))
            && changed(&one).contains(&(parameter::ZERO_HIGH_SPEED, 5000))
    );
    let none = reference(Axis::X, ZeroMethod::NoSwitch, &parameters).unwrap();
    assert_eq!(changed(&none), [(14, 0)]);
}

#[test]
fn a_servo_keeps_a_fifth_in_reserve() {
    let parameters = Parameters::default();
    let lag = |seen, allowed| Lag {
        seen: Travel(seen),
        allowed: Travel(allowed),
    };
    let slower = largest_lag(Axis::Z, lag(3.0, 3.0), &parameters).unwrap();
    assert_eq!(changed(&slower), [(parameter::Z_RAPID, 6080)]);
    let fine = largest_lag(Axis::Z, lag(-1.0, 3.0), &parameters).unwrap();
    assert_eq!(changed(&fine), []);
    assert!(largest_lag(Axis::Z, lag(0.0, 3.0), &parameters).is_err());
}

#[test]
fn the_voltage_is_set_right_before_the_speed() {
    let mut parameters = Parameters::default();
    let read = SpindleSpeed {
        gear: 2,
        rpm: 2200.0,
        volts: Some(11.0),
    };
    assert!(spindle(read, &parameters).is_err());
    parameters.set_bit(1, 4, true).unwrap();
    let right = spindle(read, &parameters).unwrap();
    assert_eq!(
        changed(&right),
        [
            (parameter::SPINDLE_GAIN, 568),
            (parameter::GEAR_SPEED_1 + 1, 2000)
        ]
    );
    assert!(spindle(SpindleSpeed { gear: 5, ..read }, &parameters).is_err());
}

#[test]
fn the_play_is_measured_without_compensation() {
    let mut parameters = Parameters::default();
    let reading = |a, b| Backlash {
        a: Travel(a),
        b: Travel(b),
    };
    let readings = [reading(0.0, 0.022), reading(1.001, 1.025)];
    let play = backlash(Axis::X, &readings, &parameters).unwrap();
    assert_eq!(changed(&play), [(parameter::X_BACKLASH, 23)]);
    let said = play
        .notes
        .iter()
        .map(ToString::to_string)
        .collect::<Vec<_>>();
    assert_eq!(said, ["mean of 2 readings 23.0 µm, spread 2.0 µm"]);
    parameters.set(parameter::X_BACKLASH, 5).unwrap();
    assert!(backlash(Axis::X, &readings, &parameters).is_err());
    assert_eq!(
        changed(&backlash(Axis::X, &[], &parameters).unwrap()),
        [(parameter::X_BACKLASH, 0)]
    );
    assert!(backlash(Axis::Z, &[reading(0.0, 3.0)], &parameters).is_err());
}
