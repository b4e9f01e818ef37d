//! Tests of the commanded and the measured spindle speed.

use super::*;
use crate::command::SpindleCommand;
use crate::memory::ControlParameters;

/// A control with an analog spindle, 2000 r/min at 10 V in gear 1, and these parameter
/// changes.
fn control(changes: &[(u16, i32)]) -> SpindleControl {
    let mut parameters = ControlParameters::default();
    for (number, value) in [(1, 0b0001_0000), (37, 2000)].iter().chain(changes) {
        parameters.set(*number, *value).unwrap();
    }
    SpindleControl::new(&parameters)
}

fn tick(control: &mut SpindleControl, radius: f64, override_percent: u8) -> (f64, f64) {
    control.tick(&SpindleInputs {
        measured_rpm: None,
        encoder: 0,
        radius_mm: radius,
        override_percent,
    });
    (control.commanded_rpm(), control.volts())
}

#[test]
fn voltage_is_the_part_of_the_top_speed() {
    let mut control = control(&[]);
    control.command(SpindleCommand::Speed(1000.0));
    assert_eq!(tick(&mut control, 0.0, 100), (1000.0, 5.0));
    assert_eq!(tick(&mut control, 0.0, 120), (1200.0, 6.0));
    control.command(SpindleCommand::Speed(9999.0));
    assert_eq!(tick(&mut control, 0.0, 100).1, 10.0);
}

#[test]
fn gain_zero_point_and_switched_speeds() {
    let mut trimmed = control(&[(21, 500), (36, 512)]);
    trimmed.command(SpindleCommand::Speed(1000.0));
    let volts = tick(&mut trimmed, 0.0, 100).1;
    assert!((volts - (4.0 + 0.625)).abs() < 1e-12, "{volts}");
    let mut switched = control(&[(1, 0)]);
    switched.command(SpindleCommand::Speed(1000.0));
    assert_eq!(tick(&mut switched, 0.0, 100).1, 0.0);
}

#[test]
fn surface_speed_follows_the_radius() {
    // The examples of the manual: S50 at X3000; S200 at X400 and X600.
    let mut control = control(&[(43, 0)]);
    control.command(SpindleCommand::Surface(50.0));
    assert!((tick(&mut control, 1500.0, 100).0 - 5.305).abs() < 1e-3);
    control.command(SpindleCommand::Surface(200.0));
    assert!((tick(&mut control, 200.0, 100).0 - 159.155).abs() < 1e-3);
    assert!((tick(&mut control, -300.0, 100).0 - 106.103).abs() < 1e-3);
}

#[test]
fn surface_speed_keeps_its_limits() {
    let mut control = control(&[]);
    control.command(SpindleCommand::Surface(50.0));
    assert_eq!(tick(&mut control, 1500.0, 100).0, 99.0);
    assert_eq!(tick(&mut control, 0.0, 100).0, 2000.0);
    control.command(SpindleCommand::Limit(800.0));
    assert_eq!(tick(&mut control, 0.0, 120).0, 800.0);
    control.command(SpindleCommand::Limit(0.0));
    assert_eq!(tick(&mut control, 10.0, 100).0, 0.0);
    // G97 knows no limit; G96 finds it again.
    control.command(SpindleCommand::Speed(1500.0));
    assert_eq!(tick(&mut control, 10.0, 100).0, 1500.0);
    assert!(!control.is_surface_mode());
}

#[test]
fn gears_count_only_when_they_are_enabled() {
    let mut with = control(&[(38, 4000)]);
    assert!(with.begin_gear_change(2));
    with.end_gear_change();
    with.command(SpindleCommand::Speed(1000.0));
    assert_eq!(tick(&mut with, 0.0, 100).1, 2.5);
    let mut without = control(&[(38, 4000), (164, 0b0110_0100)]);
    without.begin_gear_change(2);
    without.end_gear_change();
    without.command(SpindleCommand::Speed(1000.0));
    assert_eq!((without.gear(), tick(&mut without, 0.0, 100).1), (1, 5.0));
}

#[test]
fn gear_change_and_jog_have_their_own_speed() {
    let mut control = control(&[]);
    control.command(SpindleCommand::Speed(500.0));
    assert!(control.begin_gear_change(2));
    assert_eq!(tick(&mut control, 0.0, 50).0, 1000.0);
    control.set_jog(true);
    assert_eq!(tick(&mut control, 0.0, 50).0, 1000.0);
    control.end_gear_change();
    control.set_jog(true);
    assert_eq!(tick(&mut control, 0.0, 50).0, 40.0);
    control.set_jog(false);
    assert_eq!(tick(&mut control, 0.0, 50).0, 250.0);
}

#[test]
fn measured_speed_is_smooth_and_returns_to_zero() {
    // Spindle 2 : 1 encoder: 333.3 r/min of the spindle are 666.6 of the encoder.
    let mut control = control(&[(110, 2), (111, 1)]);
    let per_tick = 666.6 / 60_000.0 * 4096.0;
    let mut inputs = SpindleInputs {
        measured_rpm: None,
        encoder: 0,
        radius_mm: 0.0,
        override_percent: 100,
    };
    for ticks in 0..2000 {
        inputs.encoder = -((f64::from(ticks) * per_tick) as i64);
        control.tick(&inputs);
        if ticks > 500 {
            assert!(
                (control.actual_rpm() + 333.3).abs() < 0.3,
                "{}",
                control.actual_rpm()
            );
        }
    }
    for _ in 0..500 {
        control.tick(&inputs);
    }
    assert_eq!(control.actual_rpm(), 0.0);
}

#[test]
fn an_encoder_outside_100_to_5000_lines_measures_nothing() {
    let mut parameters = ControlParameters::default();
    parameters.set(70, 50).unwrap();
    assert_eq!(Encoder::counts_per_turn(&parameters), None);
    let mut control = SpindleControl::new(&parameters);
    for encoder in 0..1000 {
        control.tick(&SpindleInputs {
            measured_rpm: None,
            encoder,
            radius_mm: 0.0,
            override_percent: 100,
        });
    }
    assert_eq!(control.actual_rpm(), 0.0);
}

#[test]
fn the_new_gear_applies_when_its_change_is_done() {
    // 037 = 2000 and 038 = 4000 r/min at 10 V; 067 = 500 r/min meanwhile.
    let mut control = control(&[(38, 4000), (67, 500)]);
    control.command(SpindleCommand::Speed(1000.0));
    assert!(control.begin_gear_change(2));
    assert_eq!((control.selected_gear(), control.gear()), (2, 1));
    assert_eq!(tick(&mut control, 0.0, 100).1, 2.5, "067 in the old gear");
    control.end_gear_change();
    assert_eq!((control.selected_gear(), control.gear()), (2, 2));
    assert_eq!(tick(&mut control, 0.0, 100).1, 2.5, "S in the new gear");
    assert!(!control.begin_gear_change(2), "nothing to change");
}

#[test]
fn an_abandoned_gear_change_is_repeated() {
    let mut control = control(&[]);
    assert!(control.begin_gear_change(1), "no output is on at power-on");
    control.end_gear_change();
    assert!(control.begin_gear_change(3));
    control.abandon_gear_change();
    assert_eq!((control.selected_gear(), control.gear()), (1, 1));
    assert!(control.begin_gear_change(1), "nobody knows what is engaged");
}
