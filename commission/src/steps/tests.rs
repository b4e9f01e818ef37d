//! Tests of the commissioning steps.

use gsk_core::axis::gear_speed_limit;
use gsk_core::memory::{ControlParameters, PitchTable, parameter};
use gsk_core::units::Axis;

use super::*;
use crate::gear_ratio::DriveTrain;
use crate::measurement::SlideTravel;
use crate::parameter_change::{ParameterChange, Proposal};

fn changed(proposal: &Proposal) -> Vec<(u16, i32)> {
    let changes = proposal.changes.iter();
    changes
        .map(|change| match change {
            ParameterChange::Value { number, value } => (*number, *value),
            ParameterChange::Bit { number, bit, on } => (*number, i32::from(*on) << bit),
            ParameterChange::Pitch { .. } => panic!("no step but pitch"),
        })
        .collect()
}

#[test]
fn multiplying_gear_limits_rapid_rate() {
    let parameters = ControlParameters::default();
    let made = |commanded, measured| MeasuredMove {
        commanded: SlideTravel(commanded),
        measured: SlideTravel(measured),
    };
    let half = propose_gear_from_move(Axis::Z, made(-100.0, -50.0), &parameters).unwrap();
    assert_eq!(
        changed(&half),
        [
            (parameter::Z_MULTIPLIER, 2),
            (parameter::Z_RAPID, 3800),
            (parameter::ZERO_HIGH_SPEED, 3800)
        ]
    );
    let twice = propose_gear_from_move(Axis::X, made(100.0, 200.0), &parameters).unwrap();
    assert_eq!(changed(&twice), [(parameter::X_DIVISOR, 2)]);
    for (commanded, measured) in [(100.0, -100.0), (100.0, 0.0), (0.0, 0.0), (f64::NAN, 1.0)] {
        assert!(propose_gear_from_move(Axis::X, made(commanded, measured), &parameters).is_err());
    }
    // X: 0.0005 mm per increment, 5 mm per turn of 10000 pulses.
    let drive = DriveTrain {
        pulses_per_turn: 10_000.0,
        lead: SlideTravel(5.0),
        screw_teeth: 1,
        motor_teeth: 1,
    };
    let plates = propose_gear_from_drive(Axis::X, &drive, &parameters).unwrap();
    assert_eq!(changed(&plates), []);
}

/// Parameter 113 applies to both axes, and is twice the rate of X.
#[test]
fn reference_approach_stays_below_gear_limit() {
    let approach = |parameters: &ControlParameters, method| {
        let proposal = propose_reference(Axis::X, method, parameters).unwrap();
        let (mut then, mut none) = (parameters.clone(), PitchTable::default());
        for change in proposal.changes {
            change.apply(&mut then, &mut none).unwrap();
        }
        then.value(parameter::ZERO_HIGH_SPEED)
    };
    let mut parameters = ControlParameters::default();
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
fn proposals_match_manual_values() {
    let parameters = ControlParameters::default();
    let stepper = propose_acceleration(DriveKind::Stepper, &parameters).unwrap();
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
    let one = propose_reference(Axis::Z, ZeroMethod::OneSwitch, &parameters).unwrap();
    assert!(
        changed(&one).contains(&(7, 0b10))
            && changed(&one).contains(&(parameter::ZERO_HIGH_SPEED, 5000))
    );
    let none = propose_reference(Axis::X, ZeroMethod::NoSwitch, &parameters).unwrap();
    assert_eq!(changed(&none), [(14, 0)]);
}

#[test]
fn rapid_rate_keeps_following_error_reserve() {
    let parameters = ControlParameters::default();
    let lag = |measured, allowed| FollowingErrorReading {
        measured: SlideTravel(measured),
        allowed: SlideTravel(allowed),
    };
    let slower = propose_rapid_rate(Axis::Z, lag(3.0, 3.0), &parameters).unwrap();
    assert_eq!(changed(&slower), [(parameter::Z_RAPID, 6080)]);
    let fine = propose_rapid_rate(Axis::Z, lag(-1.0, 3.0), &parameters).unwrap();
    assert_eq!(changed(&fine), []);
    assert!(propose_rapid_rate(Axis::Z, lag(0.0, 3.0), &parameters).is_err());
}

#[test]
fn spindle_voltage_is_corrected_before_speed() {
    let mut parameters = ControlParameters::default();
    let read = SpindleSpeed {
        gear: 2,
        rpm: 2200.0,
        volts: Some(11.0),
    };
    assert!(propose_spindle(read, &parameters).is_err());
    parameters.set_bit(1, 4, true).unwrap();
    let right = propose_spindle(read, &parameters).unwrap();
    assert_eq!(
        changed(&right),
        [
            (parameter::SPINDLE_GAIN, 568),
            (parameter::GEAR_SPEED_1 + 1, 2000)
        ]
    );
    assert!(propose_spindle(SpindleSpeed { gear: 5, ..read }, &parameters).is_err());
}

#[test]
fn backlash_is_measured_without_compensation() {
    let mut parameters = ControlParameters::default();
    let reading = |a, b| BacklashReading {
        a: SlideTravel(a),
        b: SlideTravel(b),
    };
    let readings = [reading(0.0, 0.022), reading(1.001, 1.025)];
    let proposal = propose_backlash(Axis::X, &readings, &parameters).unwrap();
    assert_eq!(changed(&proposal), [(parameter::X_BACKLASH, 23)]);
    let notes = proposal
        .notes
        .iter()
        .map(ToString::to_string)
        .collect::<Vec<_>>();
    assert_eq!(notes, ["mean of 2 readings 23.0 µm, spread 2.0 µm"]);
    parameters.set(parameter::X_BACKLASH, 5).unwrap();
    assert!(propose_backlash(Axis::X, &readings, &parameters).is_err());
    assert_eq!(
        changed(&propose_backlash(Axis::X, &[], &parameters).unwrap()),
        [(parameter::X_BACKLASH, 0)]
    );
    assert!(propose_backlash(Axis::Z, &[reading(0.0, 3.0)], &parameters).is_err());
}
