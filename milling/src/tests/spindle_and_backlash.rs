//! Tests of the parameters of spindle and backlash that change the time of a program.

use super::*;

/// Runs a program and returns its time, s.
fn time_s(parameters: &[(u16, i32)], text: &str) -> f64 {
    let (preview, _) = run_program(&with(parameters), text, &[]);
    assert_eq!(preview.alarm, None);
    preview.time_s
}

fn assert_time(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
}

#[test]
fn gears_limit_the_speed_of_an_analog_spindle() {
    // 002:1220-1226: 3741 to 3744, 3712 = 1 analog. 100 mm at 0.1 mm a turn.
    let text = "G95 M03 S4000\nG01 X100 F0.1\nM30\n";
    let speeds = [(3741, 500), (3742, 1000), (3743, 2000), (3744, 1500)];
    let as_programmed = time_s(&speeds, text);
    let mut analog = speeds.to_vec();
    analog.push((3712, 1));
    let limited = time_s(&analog, text);
    // 100 mm at 400 and at 200 mm/min; the stop at the end is the same.
    assert_time(
        limited - as_programmed,
        100.0 / 200.0 * 60.0 - 100.0 / 400.0 * 60.0,
    );
    let slow = "G95 M03 S1000\nG01 X100 F0.1\nM30\n";
    assert_time(time_s(&analog, slow), time_s(&[], slow));
}

#[test]
fn cuts_wait_for_the_speed_of_the_spindle() {
    // 002:799-800 (174.6), 002:1214-1218 (3740): a delay before the check at a cut.
    let text = "M03 S1000\nG00 X10\nG01 X20 F500\nX30\nG00 X0\nG01 X5\nS2000\nX10\nM30\n";
    let without = time_s(&[(3740, 400)], text);
    assert_time(without, time_s(&[], text));
    // The first cut, the one after the rapid and the one at 2000 r/min. That one stops before.
    let stop = time_s(&[], "G01 X5 F500\nG09 X10\nM30\n");
    let through = time_s(&[], "G01 X5 F500\nX10\nM30\n");
    let one_stop = stop - through;
    let with_check = time_s(&[(174, 0b0100_0000), (3740, 400)], text);
    let waited = with_check - without;
    assert!(
        waited >= 1.2 && waited <= 1.2 + one_stop.max(0.2),
        "{waited}"
    );
}

#[test]
fn a_reversal_takes_up_backlash_at_its_rate() {
    // 002:634-647: 010 = 8 is 8000 pulses a second; 034 in 0.001 mm.
    let text = "G00 X10\nX20\nX15\nY5\nX30\nM30\n";
    let none = time_s(&[], text);
    let with_x = [(10034, 80), (10, 0b1000)];
    // X turns round twice, 80 pulses each.
    assert_time(time_s(&with_x, text) - none, 2.0 * 80.0 / 8000.0);
    // 011.6 = 1: an eighth of the rate.
    let eighth = [(10034, 80), (10, 0b1000), (11, 0b0100_0000)];
    assert_time(time_s(&eighth, text) - none, 2.0 * 80.0 / 1000.0);
    // 011.7 = 1: mode B, with acceleration, during the motion.
    let mode_b = [(10034, 80), (10, 0b1000), (11, 0b1000_0000)];
    assert_time(time_s(&mode_b, text), none);
    // Z does not turn round.
    assert_time(time_s(&[(30034, 80), (10, 0b1000)], text), none);
}
