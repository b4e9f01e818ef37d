//! Tests what a host of a FluidNC board sees on the serial line and at the pins.

use super::super::{GrblSettings, Variant};
use super::*;

const BANNER: &str = "\r\nGrbl 4.0 [FluidNC v4.0.4 (esp32-wifi) '$' for help]\r\n";
const HARD_X: (&str, &str) = ("axes/x/motor0/hard_limits", "true");
const HARD_Z: (&str, &str) = ("axes/z/motor0/hard_limits", "true");
const MUST_HOME: (&str, &str) = ("start/must_home", "true");

/// Returns a started board, after its banner, with these configuration items changed.
fn board(items: &[(&str, &str)]) -> GrblTwin {
    let mut twin = GrblTwin::new(Variant::FluidNc, GrblSettings::default());
    for (path, value) in items {
        twin.set_config_item(path, value).unwrap();
    }
    twin.advance(3_000 * MS);
    assert!(read_text(&mut twin).contains(BANNER));
    twin
}

fn read_text(twin: &mut GrblTwin) -> String {
    String::from_utf8(twin.read()).unwrap()
}

/// Writes bytes, advances the time by `ms`, and returns the bytes received.
fn exchange(twin: &mut GrblTwin, bytes: &[u8], ms: u64) -> String {
    twin.write(bytes);
    twin.advance(ms * MS);
    read_text(twin)
}

/// Returns the state that a status report names.
fn state(twin: &mut GrblTwin) -> String {
    let text = exchange(twin, b"?", 60);
    let begin = text.find('<').unwrap() + 1;
    text[begin..].split('|').next().unwrap().to_owned()
}

#[test]
fn build_info_has_no_option_figures() {
    let mut twin = board(&[]);
    let text = exchange(&mut twin, b"$I\n", 50);
    assert!(text.starts_with("[VER:4.0 FluidNC v4.0.4 (esp32-wifi) :]\r\n[OPT:PHS]\r\n"));
    assert!(
        text.ends_with("ok\r\n") && !text.contains("FIRMWARE"),
        "{text}"
    );
    let text = exchange(&mut twin, b"$CD\n", 1000);
    assert!(text.starts_with("board: Breakout\r\n"));
    assert!(text.ends_with("planner_blocks: 16\r\nok\r\n"));
}

#[test]
fn report_has_buffer_size_when_selected() {
    let mut twin = board(&[]);
    assert_eq!(exchange(&mut twin, b"$10\r\n", 20), "$10=1\r\nok\r\n");
    let text = exchange(&mut twin, b"?", 20);
    assert!(text.starts_with("<Idle|MPos:0.000,0.000,0.000|FS:0,0|WCO:"));
    assert_eq!(exchange(&mut twin, b"$10=3\r", 20), "ok\r\n");
    let text = exchange(&mut twin, b"?", 20);
    assert!(text.contains("0.000|Bf:15,128|FS:0,0|Ov:"), "{text}");
    assert_eq!(
        exchange(&mut twin, b"$10=4\r", 20),
        "error:80\r\n[MSG:ERR: This is error 80]\r\n"
    );
    twin.press_reset();
    twin.advance(2_000 * MS);
    assert!(twin.settings().value(10) > 2.0, "the mask is stored");
}

#[test]
fn a_line_moves_the_axis_by_the_items_of_its_tree() {
    let mut twin = board(&[]);
    assert_eq!(
        exchange(&mut twin, b"$/axes/x/steps_per_mm=200\n", 20),
        "ok\r\n"
    );
    assert_eq!(twin.config_item("axes/x/steps_per_mm"), Some("200.000000"));
    let text = exchange(&mut twin, b"$/axes/x/homing/cycles=1\n", 20);
    assert!(text.starts_with("error:3\r\n[MSG:ERR: "), "{text}");
    assert_eq!(
        exchange(&mut twin, b"g21 g90 g1 x10 (on) f600\n", 20),
        "ok\r\n"
    );
    assert_eq!(twin.state(), GrblState::Run);
    twin.advance(1_300 * MS);
    assert_eq!((twin.state(), twin.pulses()), (GrblState::Idle, [2000, 0]));
    // A restart clears it, a soft reset does not.
    exchange(&mut twin, &[0x18], 50);
    assert_eq!(twin.config_item("axes/x/steps_per_mm"), Some("200.000000"));
    twin.press_reset();
    twin.advance(2_000 * MS);
    assert_eq!(twin.config_item("axes/x/steps_per_mm"), Some("80.000000"));
}

#[test]
fn startup_items_change_without_effect_until_restart() {
    let mut twin = board(&[]);
    twin.spindle_mut().full_speed_rpm = 1000.0;
    let map = b"$/10V/speed_map=0=0.00% 500=100.00%\n";
    assert_eq!(exchange(&mut twin, map, 20), "ok\r\n");
    assert_eq!(
        twin.config_item("10V/speed_map"),
        Some("0=0.00% 500=100.00%"),
        "in memory"
    );
    exchange(&mut twin, b"M3 S500\n", 3000);
    assert!((twin.spindle().rpm() - 500.0).abs() < 1.0);
}

#[test]
fn startup_requires_homing_after_its_banner() {
    let mut twin = GrblTwin::new(Variant::FluidNc, GrblSettings::default());
    twin.set_config_item(MUST_HOME.0, MUST_HOME.1).unwrap();
    // Early bytes are lost, later ones wait for the end of startup, which drops the line.
    assert!(!exchange(&mut twin, b"?", 200).contains('<'));
    let text = exchange(&mut twin, b"", 1000);
    assert!(text.contains("[MSG:INFO: FluidNC v4.0.4"), "{text}");
    assert_eq!(twin.state(), GrblState::Starting);
    let text = exchange(&mut twin, b"?$I\n", 1200);
    let order = [
        "<Starting|",
        BANNER,
        "[MSG:INFO: ALARM: Unhomed]",
        "ALARM:14",
    ];
    let places = order.map(|part| text.find(part).unwrap());
    assert!(places.is_sorted() && !text.contains("[VER"), "{text}");
    assert_eq!(state(&mut twin), "Alarm");
    assert_eq!(
        exchange(&mut twin, b"G1X1F100\n", 30).lines().next(),
        Some("error:9")
    );
    let text = exchange(&mut twin, b"$X\n", 30);
    assert_eq!(text, "[MSG:INFO: Caution: Unlocked]\r\nok\r\n");
    assert_eq!(state(&mut twin), "Idle");
}

#[test]
fn a_switch_operated_at_the_start_is_alarm_1_whatever_is_set() {
    let mut twin = GrblTwin::new(Variant::FluidNc, GrblSettings::default());
    twin.pins.limit_x = true;
    let text = exchange(&mut twin, b"", 3000);
    assert!(text.contains("active on startup:X]"), "{text}");
    assert!(text.find("ALARM:1\r\n") < text.find(BANNER), "{text}");
    assert_eq!(twin.state(), GrblState::Critical);
    assert_eq!(twin.blocked_motors(), [false; 2], "no hard limit");
}

#[test]
fn status_query_is_answered_during_an_alarm() {
    let mut twin = board(&[HARD_X]);
    twin.pins.limit_x = true;
    let text = exchange(&mut twin, b"", 20);
    assert_eq!(text, "[MSG:INFO: ALARM: Hard Limit]\r\nALARM:1\r\n");
    let text = exchange(&mut twin, b"$10\n$10\n?", 400);
    assert!(
        text.starts_with("<Alarm|") && !text.contains("$10"),
        "{text}"
    );
    let text = exchange(&mut twin, b"", 200);
    assert_eq!(
        text,
        "[MSG:ERR: Reset to continue]\r\n$10=1\r\nok\r\n$10=1\r\nok\r\n"
    );
}

#[test]
fn reset_loses_bytes_after_it_except_a_polled_line() {
    let mut twin = board(&[]);
    exchange(&mut twin, b"G1X40F1200\n", 500);
    let text = exchange(&mut twin, b"\x18$10\n$13\n$13\n", 700);
    let begin = "[MSG:INFO: ALARM: Abort Cycle]\r\nALARM:3\r\n";
    assert_eq!(text, format!("{begin}{BANNER}$10=1\r\nok\r\n"));
    assert_eq!(twin.state(), GrblState::Alarm);
}

#[test]
fn each_reset_has_its_banner() {
    let mut twin = board(&[]);
    assert_eq!(
        exchange(&mut twin, &[0x18, 0x18, 0x18], 50),
        BANNER.repeat(3)
    );
}

#[test]
fn a_reset_in_motion_lets_the_pulses_run_out_and_keeps_the_count() {
    let mut twin = board(&[]);
    exchange(&mut twin, b"G1X100F3000\n", 1500);
    let before = twin.pulses()[0];
    exchange(&mut twin, &[0x18], 700);
    let way = (twin.pulses()[0] - before) as f64 / 80.0;
    // 120 ms at 50 mm/s.
    assert!((way - 6.0).abs() < 0.2, "{way}");
    let place = format!("MPos:{:.3},", twin.pulses()[0] as f64 / 80.0);
    assert!(exchange(&mut twin, b"?", 20).contains(&place));
}

#[test]
fn a_hold_takes_120_ms_and_its_ramp_and_no_line_is_read_in_it() {
    let mut twin = board(&[]);
    exchange(&mut twin, b"G1X100F1200\n", 800);
    let at = twin.now();
    twin.write(b"!");
    while twin.state() != (GrblState::Hold { complete: true }) {
        twin.advance(MS);
    }
    // 20 mm/s at 100 mm/s².
    let seconds = (twin.now() - at) as f64 * 1e-9;
    assert!((seconds - 0.32).abs() < 0.02, "{seconds}");
    assert_eq!(exchange(&mut twin, b"$10\n", 200), "");
    let stopped_at = twin.pulses();
    let text = exchange(&mut twin, &[0x18], 100);
    assert_eq!(text, format!("{BANNER}$10=1\r\nok\r\n"));
    assert_eq!((twin.state(), twin.pulses()), (GrblState::Idle, stopped_at));
}

#[test]
fn commands_wait_for_the_end_of_motion_but_items_do_not() {
    let mut twin = board(&[]);
    exchange(&mut twin, b"G1X10F600\n", 30);
    let shown = exchange(&mut twin, b"$/axes/homing_runs\n", 50);
    assert_eq!(shown, "$/axes/homing_runs=2\r\nok\r\n");
    assert_eq!(exchange(&mut twin, b"$I\n", 300), "");
    assert_eq!(state(&mut twin), "Run");
    assert!(exchange(&mut twin, b"", 1500).ends_with("ok\r\n"));
}

#[test]
fn realtime_characters_wait_while_lines_wait() {
    let mut twin = board(&[]);
    for k in 1..=20 {
        exchange(&mut twin, format!("G1X{k}F600\n").as_bytes(), 5);
    }
    twin.advance(20 * MS);
    read_text(&mut twin);
    let mut longest = 0;
    for _ in 0..20 {
        twin.write(b"?");
        let at = twin.now();
        while !read_text(&mut twin).contains('<') {
            twin.advance(MS);
        }
        longest = longest.max((twin.now() - at) / MS);
        twin.advance(7 * MS);
    }
    // 51 ms, doubled if the poller takes the next line in between.
    assert!((51..=104).contains(&longest), "{longest}");
}

#[test]
fn after_a_hard_limit_blocks_are_ok_and_never_carried_out() {
    let mut twin = board(&[HARD_X, HARD_Z]);
    exchange(&mut twin, b"G1X20F1200\nG1X40\n", 500);
    twin.pins.limit_x = true;
    let text = exchange(&mut twin, b"", 600);
    assert!(text.contains("ALARM:1\r\n") && text.contains("Reset to continue"));
    let stopped_at = twin.pulses();
    assert_eq!(twin.state(), GrblState::Critical);
    assert_eq!(state(&mut twin), "Alarm");
    assert_eq!(exchange(&mut twin, b"G1Z-5\n", 100), "ok\r\n");
    // Commands that wait for the end of motion wait forever, including `$X`.
    assert_eq!(exchange(&mut twin, b"$X\n", 2000), "");
    assert_eq!(twin.pulses(), stopped_at);
    assert_eq!(exchange(&mut twin, &[0x18], 100), BANNER);
    assert_eq!(twin.state(), GrblState::Idle);
    assert_eq!(
        exchange(&mut twin, b"$X\n", 100),
        "ok\r\n",
        "nothing to unlock"
    );
}

#[test]
fn a_motor_at_its_switch_is_counted_and_does_not_move() {
    let mut twin = board(&[HARD_X]);
    twin.pins.limit_x = true;
    exchange(&mut twin, b"", 600);
    exchange(&mut twin, &[0x18], 100);
    assert_eq!(twin.blocked_motors(), [true, false]);
    exchange(&mut twin, b"G1X-1Z-1F600\n", 1000);
    assert_eq!((twin.state(), twin.pulses()), (GrblState::Idle, [0, -80]));
    assert!(exchange(&mut twin, b"?", 20).contains("MPos:-1.000,0.000,-1.000"));
    // After the switch opens, the motor is free without an alarm.
    twin.pins.limit_x = false;
    assert_eq!(exchange(&mut twin, b"G1X-2\n", 1000), "ok\r\n");
    assert_eq!(twin.pulses(), [-80, -80]);
}

#[test]
fn to_unlock_out_of_an_alarm_frees_the_motor() {
    let mut twin = board(&[HARD_X, MUST_HOME]);
    exchange(&mut twin, b"$X\n", 100);
    twin.pins.limit_x = true;
    exchange(&mut twin, b"", 600);
    assert_eq!(exchange(&mut twin, b"$X\n", 100), "ok\r\n");
    assert_eq!(twin.state(), GrblState::Critical, "only a reset ends it");
    let text = exchange(&mut twin, &[0x18], 700);
    let alarm = "[MSG:INFO: ALARM: Unhomed]\r\nALARM:14\r\n";
    assert_eq!(text, format!("{alarm}{BANNER}"));
    assert!(exchange(&mut twin, b"$X\n", 100).ends_with("ok\r\n"));
    assert_eq!(
        (twin.state(), twin.blocked_motors()),
        (GrblState::Idle, [false; 2])
    );
    assert_eq!(exchange(&mut twin, b"G1X-1F600\n", 1000), "ok\r\n");
    assert_eq!(twin.pulses(), [-80, 0]);
}

#[test]
fn a_hold_leaves_the_state_a_reset_alone_should_end() {
    let mut twin = board(&[HARD_X, MUST_HOME]);
    exchange(&mut twin, b"$X\n", 100);
    twin.pins.limit_x = true;
    exchange(&mut twin, b"", 600);
    exchange(&mut twin, b"!", 50);
    assert_eq!(state(&mut twin), "Hold:1");
    assert_eq!(exchange(&mut twin, &[0x18], 100), BANNER);
    assert_eq!(twin.state(), GrblState::Idle);
    let text = exchange(&mut twin, b"G1X-1F600\n", 700);
    assert!(
        text.contains("ok\r\n") && text.ends_with("ALARM:14\r\n"),
        "{text}"
    );
}

#[test]
fn the_emergency_stop_is_alarm_13() {
    let mut twin = board(&[]);
    exchange(&mut twin, b"M3S100\nG1X40F1200\n", 500);
    twin.pins.emergency = true;
    let text = exchange(&mut twin, b"", 600);
    assert!(text.contains("ALARM:13\r\n"), "{text}");
    assert_eq!(twin.state(), GrblState::Critical);
    assert_eq!(twin.outputs().0, 3, "the spindle turns until a reset");
    assert!(exchange(&mut twin, b"?", 20).contains("|Pn:E"));
    exchange(&mut twin, &[0x18], 50);
    assert_eq!((twin.state(), twin.outputs().0), (GrblState::Idle, 5));
    let mut twin = board(&[("10V/off_on_alarm", "true")]);
    exchange(&mut twin, b"M3S100\n", 100);
    twin.pins.emergency = true;
    exchange(&mut twin, b"", 20);
    assert_eq!(twin.outputs().0, 5);
}

#[test]
fn one_axis_is_homed_to_its_switch_and_answers_questions() {
    let mut twin = board(&[("axes/x/homing/mpos_mm", "7"), MUST_HOME]);
    twin.place_switches([3.0, 5.0]);
    assert_eq!(exchange(&mut twin, b"$HX\n", 200), "");
    assert_eq!(state(&mut twin), "Home");
    // 3 mm at 500, 1 mm off and on and off at 100 mm/min, settling between.
    let text = exchange(&mut twin, b"", 5000);
    assert!(text.ends_with("[MSG:Homed:X]\r\nok\r\n"), "{text}");
    let [x, z] = twin.pulses();
    assert!((158..=162).contains(&x) && z == 0, "{x} {z}");
    assert!(exchange(&mut twin, b"?", 20).contains("<Alarm|MPos:7.000,0.000,0.000"));
    let text = exchange(&mut twin, b"$HZ\n", 8000);
    assert!(text.ends_with("[MSG:Homed:Z]\r\nok\r\n"), "{text}");
    assert_eq!(state(&mut twin), "Idle");
    exchange(&mut twin, b"G90G1X8F600\n", 1000);
    assert_eq!(twin.pulses()[0], x + 80);
}

#[test]
fn all_axes_of_a_cycle_are_homed_together() {
    let mut twin = board(&[]);
    twin.place_switches([3.0, 5.0]);
    let text = exchange(&mut twin, b"$H\n", 6000);
    assert!(text.ends_with("[MSG:Homed:XZ]\r\nok\r\n"), "{text}");
    let mut twin = board(&[("axes/x/homing/cycle", "0"), ("axes/z/homing/cycle", "0")]);
    let text = exchange(&mut twin, b"$H\n", 100);
    assert!(
        text.starts_with("[MSG:ERR: ") && text.ends_with("ok\r\n"),
        "{text}"
    );
    assert_eq!(twin.state(), GrblState::Alarm);
    twin.remove_section("axes/x/homing");
    assert!(exchange(&mut twin, b"$HX\n", 100).starts_with("error:19"));
}

#[test]
fn failed_homing_is_answered_ok_and_leaves_planner_error() {
    let mut twin = board(&[("axes/x/max_travel_mm", "2")]);
    let text = exchange(&mut twin, b"$HX\n", 700);
    assert!(text.starts_with("<Home|"), "{text}");
    let alarm = "[MSG:INFO: ALARM: Homing Fail Approach]\r\nALARM:9\r\n";
    assert!(text.ends_with(alarm), "{text}");
    assert_eq!(exchange(&mut twin, b"", 300), "ok\r\n", "and no banner");
    assert_eq!(twin.state(), GrblState::Alarm);
    assert_eq!(twin.pulses(), [176, 0], "1.1 times the travel");
    // Without a reset the next move starts from the position before homing.
    exchange(&mut twin, b"$X\n", 100);
    exchange(&mut twin, b"G90G1X1F600\n", 1000);
    assert_eq!(twin.pulses(), [176 + 80, 0]);
    exchange(&mut twin, &[0x18], 100);
    exchange(&mut twin, b"G90G1X1F600\n", 1000);
    assert_eq!(twin.pulses(), [80, 0]);
}

#[test]
fn a_switch_that_does_not_open_is_alarm_8() {
    let mut twin = board(&[]);
    twin.pins.limit_x = true;
    twin.advance(10 * MS);
    let text = exchange(&mut twin, b"$HX\n", 2000);
    assert!(
        text.contains("ALARM:8\r\n") && text.ends_with("ok\r\n"),
        "{text}"
    );
    assert_eq!(twin.pulses(), [-80, 0]);
}

#[test]
fn a_reset_while_homing_is_alarm_6_and_the_line_is_not_answered() {
    let mut twin = board(&[]);
    exchange(&mut twin, b"$HX\n", 500);
    let stopped_at = twin.pulses();
    let text = exchange(&mut twin, &[0x18], 1000);
    let alarm = "[MSG:INFO: ALARM: Homing Fail Reset]\r\nALARM:6\r\n";
    assert_eq!(text, format!("{alarm}{BANNER}"));
    assert_eq!(twin.state(), GrblState::Alarm);
    let made = twin.pulses()[0] - stopped_at[0];
    // The poll is 51 ms after the one before.
    assert!(made <= 40, "{made}");
}

#[test]
fn axis_homed_without_motion_gets_its_position() {
    let mut twin = board(&[
        ("axes/x/homing/cycle", "-1"),
        ("axes/x/homing/mpos_mm", "12.5"),
    ]);
    assert_eq!(exchange(&mut twin, b"$HX\n", 100), "ok\r\n");
    assert!(exchange(&mut twin, b"?", 20).contains("MPos:12.500,"));
    assert_eq!(twin.pulses(), [0, 0]);
}

#[test]
fn a_switch_at_both_ends_is_alarm_12() {
    let mut twin = board(&[("axes/x/motor0/limit_all_pin", "gpio.21")]);
    twin.pins.limit_x = true;
    twin.advance(10 * MS);
    let text = exchange(&mut twin, b"$HX\n", 700);
    assert!(
        text.contains("ALARM:12\r\n") && text.ends_with("ok\r\n"),
        "{text}"
    );
}

#[test]
fn macro_characters_run_macros() {
    let mut twin = board(&[]);
    exchange(&mut twin, &[0x85, 0x90, 0xa0], 100);
    assert_eq!(twin.macro_count, 0);
    exchange(&mut twin, &[0x87, 0x8a], 100);
    assert_eq!(twin.macro_count, 2);
}

#[test]
fn any_line_ending_ends_one_line() {
    let mut twin = board(&[]);
    assert_eq!(
        exchange(&mut twin, b"G21\r\nG90\rG91\nG90\r\n", 50),
        "ok\r\n".repeat(4)
    );
}
