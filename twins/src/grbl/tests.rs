//! Tests what a host sees on the serial line and at the pins.

use super::*;

/// Returns a Grbl board configured for a lathe, after its banner.
fn board(variant: Variant) -> GrblTwin {
    let mut settings = GrblSettings::default();
    let fields = if variant == Variant::Grbl { 3.0 } else { 511.0 };
    for (number, value) in [
        (10, fields),
        (110, 9000.0),
        (112, 9000.0),
        (120, 4000.0),
        (122, 4000.0),
        (11, 0.02),
    ] {
        settings.set(number, value).unwrap();
    }
    let mut twin = GrblTwin::new(variant, settings);
    twin.advance(2_000_000_000);
    assert!(read_text(&mut twin).starts_with("\r\nGrbl"));
    twin
}

fn read_text(twin: &mut GrblTwin) -> String {
    String::from_utf8(twin.read()).unwrap()
}

/// Writes bytes, advances the time by `ms`, and returns the bytes received.
fn exchange(twin: &mut GrblTwin, bytes: &[u8], ms: u64) -> String {
    twin.write(bytes);
    twin.advance(ms * 1_000_000);
    read_text(twin)
}

#[test]
fn ok_comes_when_the_line_is_read() {
    let mut twin = board(Variant::Grbl);
    assert_eq!(exchange(&mut twin, b"G21G90G1X10F600\n", 20), "ok\r\n");
    assert_eq!(twin.state(), GrblState::Run);
    twin.advance(1_100_000_000);
    assert_eq!(twin.state(), GrblState::Idle);
    assert_eq!(twin.pulses(), [2500, 0]);
}

#[test]
fn a_carriage_return_is_a_line_of_its_own() {
    let mut twin = board(Variant::Grbl);
    assert_eq!(exchange(&mut twin, b"G21\r\n", 20), "ok\r\nok\r\n");
}

#[test]
fn receive_buffer_overflow_loses_bytes_silently() {
    let mut twin = board(Variant::Grbl);
    let mut text = String::from("G21G90G1F1000\n");
    for k in 1..=60 {
        text.push_str(&format!("X{k}Z-{k}\n"));
    }
    let answers = exchange(&mut twin, text.as_bytes(), 8000);
    assert!(answers.matches("ok").count() < 55, "{answers}");
    assert_ne!(twin.pulses(), [60 * 250, -60 * 250]);
}

#[test]
fn realtime_characters_act_inside_comments() {
    let mut twin = board(Variant::Grbl);
    exchange(&mut twin, b"G90G1X10F600\n", 100);
    exchange(&mut twin, b"(hold! it)\n", 300);
    assert_eq!(twin.state(), GrblState::Hold { complete: true });
}

#[test]
fn reset_after_complete_hold_keeps_the_position() {
    let mut twin = board(Variant::Grbl);
    twin.settings.set(120, 200.0).unwrap();
    exchange(&mut twin, b"G90G1X40F1200\n", 800);
    let before = twin.pulses()[0];
    let at = twin.now();
    twin.write(b"!");
    while twin.state() != (GrblState::Hold { complete: true }) {
        twin.advance(1_000_000);
    }
    let seconds = (twin.now() - at) as f64 * 1e-9;
    let way = (twin.pulses()[0] - before) as f64 / 250.0;
    assert!(
        (seconds - 0.18).abs() < 0.01 && (way - 1.9).abs() < 0.1,
        "{seconds} {way}"
    );
    let stopped_at = twin.pulses();
    let answer = exchange(&mut twin, &[0x18], 50);
    assert!(
        answer.contains("Grbl 1.1h") && !answer.contains("ALARM"),
        "{answer}"
    );
    assert_eq!((twin.state(), twin.pulses()), (GrblState::Idle, stopped_at));
}

#[test]
fn a_reset_in_motion_is_alarm_3_and_locks() {
    let mut twin = board(Variant::Grbl);
    exchange(&mut twin, b"G90G1X40F1200\n", 300);
    let answer = exchange(&mut twin, &[0x18], 50);
    assert!(answer.starts_with("ALARM:3\r\n"), "{answer}");
    assert_eq!(exchange(&mut twin, b"G1X0F100\n", 20), "error:9\r\n");
    assert!(exchange(&mut twin, b"$X\n", 20).ends_with("ok\r\n"));
    assert_eq!(exchange(&mut twin, b"G1X0F100\n", 20), "ok\r\n");
}

#[test]
fn after_a_hard_limit_there_is_silence_until_a_reset() {
    let mut twin = board(Variant::Grbl);
    twin.settings.set(21, 1.0).unwrap();
    exchange(&mut twin, b"G90G1X40F1200\n", 300);
    twin.pins.limit_x = true;
    assert!(exchange(&mut twin, b"", 20).starts_with("ALARM:1"));
    assert_eq!(exchange(&mut twin, b"?\n$I\n", 200), "");
    assert!(exchange(&mut twin, &[0x18], 50).contains("to unlock"));
}

#[test]
fn errors_latch_on_grblhal_only() {
    for (variant, then) in [(Variant::Grbl, "ok\r\n"), (Variant::GrblHal, "error:9\r\n")] {
        let mut twin = board(variant);
        assert_eq!(exchange(&mut twin, b"G99\n", 20), "error:20\r\n");
        assert_eq!(exchange(&mut twin, b"G1X1F100\n", 20), then);
        assert_eq!(exchange(&mut twin, b"\n", 20), "ok\r\n");
        assert_eq!(exchange(&mut twin, b"G1X2F100\n", 20), "ok\r\n");
    }
}

#[test]
fn board_with_homing_starts_locked() {
    let mut twin = board(Variant::Grbl);
    assert_eq!(exchange(&mut twin, b"$22=1\n", 40), "ok\r\n");
    twin.press_reset();
    twin.advance(2_000_000_000);
    assert!(read_text(&mut twin).contains("to unlock"));
    assert!(
        exchange(&mut twin, b"?", 20).starts_with("<Alarm|MPos:0.000,0.000,0.000|Bf:15,128|FS:0,0")
    );
}

#[test]
fn line_rate_is_limited() {
    let mut twin = board(Variant::Grbl);
    exchange(&mut twin, b"G90G93\n", 20);
    // Keep the buffer filled for two seconds, like a host that counts characters.
    let (mut sent, mut answered, mut x) = (Vec::new(), 0, 0.0);
    for _ in 0..2000 {
        while sent.iter().sum::<usize>() < 100 {
            x += 0.004;
            let line = format!("X{x:.3}F60000\n");
            sent.push(line.len());
            twin.write(line.as_bytes());
        }
        twin.advance(1_000_000);
        for _ in 0..read_text(&mut twin).matches('k').count() {
            sent.remove(0);
            answered += 1;
        }
    }
    assert!((850..=900).contains(&answered), "{answered}");
}

#[test]
fn homing_travels_to_the_switches_and_back_off_them() {
    for variant in [Variant::Grbl, Variant::GrblHal] {
        let mut twin = board(variant);
        exchange(&mut twin, b"$22=1\n", 40);
        twin.place_switches([3.0, 5.0]);
        // 5 mm and 3 mm at 500 mm/min, 1 mm off, back at 25 mm/min, off again.
        let fast = (5.0 + 3.0 + 2.0) / 500.0 * 60.0;
        let slow = 4.0 / 25.0 * 60.0;
        let before = ((fast + slow) * 1000.0) as u64 - 200;
        assert_eq!(exchange(&mut twin, b"$H\n", before), "");
        assert_eq!(twin.state(), GrblState::Home);
        assert_eq!(exchange(&mut twin, b"", 400), "ok\r\n");
        assert_eq!(twin.pulses(), [2 * 250, 4 * 250]);
        assert!(exchange(&mut twin, b"?", 20).starts_with("<Idle|MPos:-1.000,0.000,-1.000"));
    }
}

#[test]
fn a_switch_that_never_comes_is_alarm_9() {
    let mut twin = board(Variant::Grbl);
    exchange(&mut twin, b"$22=1\n", 40);
    exchange(&mut twin, b"$132=10\n", 40);
    let answer = exchange(&mut twin, b"$H\n", 2500);
    assert!(answer.starts_with("ALARM:9\r\n\r\nGrbl 1.1h"), "{answer}");
    assert_eq!(twin.pulses(), [0, 15 * 250]);
}

#[test]
fn switch_release_is_an_edge_on_grbl_only() {
    for (variant, again) in [(Variant::Grbl, true), (Variant::GrblHal, false)] {
        let mut twin = board(variant);
        exchange(&mut twin, b"$21=1\n", 40);
        twin.pins.limit_x = true;
        assert!(exchange(&mut twin, b"", 20).starts_with("ALARM:1"));
        exchange(&mut twin, &[0x18], 50);
        exchange(&mut twin, b"$X\n", 20);
        twin.pins.limit_x = false;
        assert_eq!(exchange(&mut twin, b"", 20).starts_with("ALARM:1"), again);
    }
}

/// Returns a lathe board with a spindle that turns at `rpm`, and with `gain` in setting $90.
fn lathe(rpm: f64, gain: f64) -> GrblTwin {
    let mut settings = GrblSettings::with_encoder(1024);
    for (number, value) in [
        (10, 511.0),
        (90, gain),
        (91, 0.0),
        (110, 9000.0),
        (112, 9000.0),
        (120, 4000.0),
        (122, 4000.0),
    ] {
        settings.set(number, value).unwrap();
    }
    let mut twin = GrblTwin::new(Variant::GrblHal, settings);
    twin.spindle_mut().full_speed_rpm = rpm;
    twin.advance(2_000_000_000);
    assert!(twin.build_info().contains(",SS,"));
    twin.read();
    assert_eq!(
        exchange(&mut twin, b"G90G1G93F60\nM3S1000\n", 2000),
        "ok\r\nok\r\n"
    );
    twin
}

/// Returns the number of spindle turns between two Z positions, mm, in the last thread pass.
fn turns_between(twin: &GrblTwin, from: f64, to: f64) -> f64 {
    let trace = &twin.passes().last().unwrap().0;
    let at = |z: f64| {
        let pulses = (z * 250.0) as i64;
        trace.iter().find(|(at, _)| at[1] <= pulses).unwrap().1
    };
    at(to) - at(from)
}

#[test]
fn a_pass_waits_for_the_signal_and_is_answered_at_its_end() {
    let mut twin = lathe(300.0, 0.0);
    assert_eq!(
        exchange(&mut twin, b"G33Z-20K2\n", 100),
        "",
        "neither answer nor report"
    );
    assert_eq!(exchange(&mut twin, b"?", 50), "");
    let text = exchange(&mut twin, b"?", 400);
    assert!(text.contains("<Run|") && !text.contains("ok"), "{text}");
    assert_eq!(exchange(&mut twin, b"", 2000), "ok\r\n");
    assert_eq!(twin.pulses(), [0, -5000]);
    let begun = twin.passes()[0].0[0].1;
    assert!(begun.fract() < 0.01, "{begun}");
    let turns = turns_between(&twin, -4.0, -16.0);
    assert!((turns - 6.0).abs() < 0.005, "{turns}");
    // A segment without G1 is an error after a thread pass.
    assert!(exchange(&mut twin, b"Z-19F600\n", 50).contains("error:39"));
}

#[test]
fn gain_lengthens_the_thread_pass() {
    let mut twin = lathe(300.0, 1.0);
    exchange(&mut twin, b"G33Z-20K2\n", 3000);
    let turns = turns_between(&twin, -4.0, -16.0);
    assert!((12.0 / turns / 2.0 - 1.0165).abs() < 0.001, "{turns}");
}

#[test]
fn feed_hold_in_a_pass_acts_at_its_end() {
    let mut twin = lathe(300.0, 0.0);
    exchange(&mut twin, b"G33Z-20K2\n", 700);
    twin.write(b"!");
    assert!(exchange(&mut twin, b"?", 100).contains("<Run:1|"));
    twin.advance(2_500_000_000);
    assert_eq!(twin.state(), GrblState::Hold { complete: true });
    assert_eq!(twin.pulses(), [0, -5000]);
}

#[test]
fn stopped_spindle_is_an_error_or_an_alarm() {
    let mut twin = lathe(300.0, 0.0);
    twin.spindle_mut().blocked = true;
    assert_eq!(
        exchange(&mut twin, b"G33Z-20K2\n", 2000),
        "",
        "still turning"
    );
    let text = exchange(&mut twin, b"?\n", 4000);
    assert!(text.starts_with("ALARM:14"), "{text}");
    assert!(!text.contains("ok"), "no further line is read: {text}");
    let text = exchange(&mut twin, &[0x18], 100);
    assert!(
        text.contains("GrblHAL") && twin.state() == GrblState::Alarm,
        "{text}"
    );
    assert!(exchange(&mut twin, b"$X\n", 100).ends_with("ok\r\n"));
    assert_eq!(exchange(&mut twin, b"G33Z-20K2\n", 100), "error:41\r\n");
    assert_eq!(twin.pulses(), [0, 0]);
    let mut fast = lathe(9000.0, 0.0);
    assert_eq!(exchange(&mut fast, b"G33Z-20K2\n", 100), "error:43\r\n");
}

#[test]
fn a_reset_in_a_pass_is_alarm_3() {
    let mut twin = lathe(300.0, 0.0);
    exchange(&mut twin, b"G33Z-20K2\n", 1000);
    let text = exchange(&mut twin, &[0x18], 100);
    assert!(text.starts_with("ALARM:3"), "{text}");
    assert_eq!(twin.state(), GrblState::Alarm);
    let stopped_at = twin.pulses();
    twin.advance(1_000_000_000);
    assert_eq!(twin.pulses(), stopped_at);
    assert!(twin.spindle().rpm() < 1.0);
}
