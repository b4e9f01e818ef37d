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

/// Bits 1 and 0 of 600: M type A and B.
const TYPE_A: i32 = 0b10;
const TYPE_B: i32 = 0b11;

/// Runs 100 mm at 0.1 mm a turn; returns the time without the stops, as the speed, r/min.
fn speed_with(parameters: &[(u16, i32)], speed: u32) -> f64 {
    let text = |x: u32| format!("G95 M03 S{speed}\nG01 X{x} F0.1\nM30\n");
    let (short, long) = (
        time_s(parameters, &text(100)),
        time_s(parameters, &text(200)),
    );
    100.0 / 0.1 * 60.0 / (long - short)
}

/// A spindle of three gears of 1000, 2000 and 4000 r/min whose motor turns up to half its speed.
fn gears(gear_type: i32) -> Vec<(u16, i32)> {
    let mut all = vec![(3712, 1), (600, gear_type)];
    all.extend([(3741, 1000), (3742, 2000), (3743, 4000), (3744, 4000)]);
    all.extend([(3735, 819), (3736, 4095 / 2)]);
    all
}

#[test]
fn the_motor_clamps_limit_the_speed_of_each_gear() {
    // 002:1207-1213: 3735 and 3736, the least and greatest motor speed of 4095.
    let all = gears(TYPE_A);
    for (programmed, turns) in [(100, 200.0), (300, 300.0), (1500, 1500.0), (3000, 2000.0)] {
        let found = speed_with(&all, programmed);
        let expected = f64::min(turns, 4000.0 * 2047.0 / 4095.0);
        assert!((found - expected).abs() < 0.1, "{programmed}: {found}");
    }
    // 002:1031-1040: with 600.1 = 0 the ladder has the gear, the clamps do not act.
    let t_type = gears(0);
    assert!((speed_with(&t_type, 100) - 100.0).abs() < 1e-6);
    assert!((speed_with(&t_type, 3000) - 3000.0).abs() < 1e-6);
}

#[test]
fn type_b_changes_gear_at_its_own_speeds() {
    // 002:1227-1243: 3751 to 3753, the motor speed at a change of gear.
    let mut all = gears(TYPE_B);
    all.extend([(3751, 4095 / 4), (3752, 4095 / 4), (3753, 4095 / 4)]);
    // 300 r/min is above 249 in gear 1, so gear 2 runs, at not less than 400 r/min.
    assert!((speed_with(&all, 300) - 400.0).abs() < 0.1);
    assert!((speed_with(&gears(TYPE_A), 300) - 300.0).abs() < 0.1);
}

#[test]
fn a_gear_change_waits_for_its_strobe() {
    // 002:1161: 3010, the delay of SF at a change of gear of M type.
    let text = "M03 S400\nG01 X10 F500\nS450\nX20\nS800\nX30\nS100\nX40\nM30\n";
    let mut with_delay = gears(TYPE_A);
    with_delay.push((3010, 700));
    let waited = time_s(&with_delay, text) - time_s(&gears(TYPE_A), text);
    // Twice: to gear 2 and back, each with a stop of the contour.
    assert!((1.4..1.8).contains(&waited), "{waited}");
    // As delivered the ladder changes gears.
    assert_time(time_s(&[(3010, 700)], text), time_s(&[], text));
}

#[test]
fn cuts_stop_with_the_spindle() {
    // 002:797-798 (174.7), 002:1250 (4901).
    let refused = |parameters: &[(u16, i32)], text: &str| {
        let (preview, _) = run_program(&with(parameters), text, &[]);
        let alarm = preview.alarm.map(|alarm| {
            let line = alarm.source.map_or(0, |source| source.line);
            (alarm.number, line)
        });
        (alarm, preview.time_s)
    };
    let bit = (174, 0b1000_0000);
    let stopped = "S500 M03\nG01 X10 F500\nM05\nG00 X20\nG02 X30 R10\nM30\n";
    let (alarm, time) = refused(&[bit], stopped);
    assert_eq!(alarm, Some((98, 5)));
    let (alarm, later) = refused(&[bit, (4901, 2500)], stopped);
    assert_eq!(alarm, Some((98, 5)));
    assert_time(later - time, 2.5);
    assert_eq!(refused(&[], stopped).0, None);
    // Holes too; rapids, threads with a spindle and a probe need none.
    assert_eq!(
        refused(&[bit], "G81 X5 Z-5 R2 F100\nM30\n").0,
        Some((98, 1))
    );
    assert_eq!(refused(&[bit], "M03\nG01 X5 F100\nM30\n").0, Some((98, 2)));
    assert_eq!(refused(&[bit], "G00 X5\nG31 X10 F100\nM30\n").0, None);
}

#[test]
fn the_cs_axis_has_a_time_constant_of_its_own() {
    // 002:771 (060), 002:1244 (3760 = 4: the fourth axis).
    let axes = [(1010, 4)];
    let cs = [(1010, 4), (3760, 4), (60, 900)];
    for text in ["G00 A360\nM30\n", "G01 A90 F500\nM30\n"] {
        let longer = time_s(&cs, text) - time_s(&axes, text);
        assert_time(longer, 0.9 - 0.1);
    }
    // Other axes keep theirs.
    let other = "G00 X100\nG01 X0 F500\nM30\n";
    assert_time(time_s(&cs, other), time_s(&axes, other));
}

#[test]
fn the_first_tool_pocket_is_below_the_last() {
    // 002:1259-1262: 5025 must be smaller than 5026, or an alarm is raised.
    let alarm = |parameters: &[(u16, i32)]| {
        let (preview, _) = run_program(&with(parameters), "T3 M06\nG00 X5\nM30\n", &[]);
        preview.alarm.map(|alarm| alarm.number)
    };
    assert_eq!(alarm(&[]), None);
    assert_eq!(alarm(&[(5025, 1), (5026, 24)]), None);
    assert_eq!(alarm(&[(5025, 24), (5026, 24)]), Some(32));
    assert_eq!(alarm(&[(5025, 5)]), Some(32));
}

#[test]
fn a_changed_work_zero_waits_for_its_code() {
    // 002:903-906 (540.1): at once, or with the next code that selects a zero.
    let text = "G54\n#2501=30\nG00 X10\nG54 X10\nG55 X0\n#2502=7\nG54 X5\nM30\n";
    let machine = |zeros: i32| {
        let (preview, moves) = run_program(&with(&[(540, zeros)]), text, &[]);
        assert_eq!(preview.alarm, None);
        let machine = |made: &MillMove| made.to.mm()[0] + made.zero.mm()[0];
        moves.iter().map(machine).collect::<Vec<f64>>()
    };
    // G54 has X30 after the statement; its second choice moves there.
    assert_eq!(machine(0b10), [40.0, 0.0, 35.0]);
    assert_eq!(machine(0), [10.0, 40.0, 0.0, 35.0]);
}
