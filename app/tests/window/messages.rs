//! What the message line and the LCD show: alarms and their remedies, reasons of keys without
//! effect, the state of a board.

use egui_kittest::kittest::Queryable;
use gsk_core::machine::LatheFault;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_host::kernel::{Command, OpenedProgram, StorePolicy};
use gsk_link::LinkState;

use super::is_shown;
use crate::common::WindowBench;
use crate::common::windows::ViewWindows;

#[test]
fn an_emergency_stop_with_a_known_position_shows_it() {
    let mut bench = WindowBench::new();
    bench.click("Emergency stop");
    let is_on_line =
        |bench: &WindowBench, text: &str| bench.harness.query_by_label_contains(text).is_some();
    assert!(is_on_line(&bench, "press it again to release"));
    let mut snapshot = bench.kernel.snapshot();
    let position_text = "machine coordinates X 1.000 Z -2.000 by the board's count, uncertain: the \
                 drives were without power";
    snapshot.alarm = snapshot
        .alarm
        .map(|alarm| alarm.with_detail(gsk_messages::say::as_written(position_text)));
    bench.console.snapshots.force_push(snapshot);
    bench.harness.step();
    bench.harness.step();
    assert!(is_on_line(&bench, "207: ") && is_on_line(&bench, position_text));
}

#[test]
fn a_waiting_program_shows_condition_and_block() {
    let folder = crate::common::folder::TempFolder::new("waits");
    folder.write("waits.CNC", "O0007\nG00 U-1\nT0202\nM30\n");
    let mut bench = WindowBench::new();
    bench.open(folder.0.join("waits.CNC").to_str().unwrap());
    let blocked = Command::Fault(LatheFault::TurretBlocked, true);
    bench.console.send(blocked);
    bench.click("Automatic mode");
    bench.click("Cycle start");
    bench.run(300);
    let shows_wait =
        |bench: &WindowBench| is_shown(bench, "O0007 line 3, waiting for: FIN (G4.3) of T02");
    assert!(!shows_wait(&bench), "a tool change takes its time");
    bench.click("Feed hold");
    assert!(shows_wait(&bench), "{}", bench.lcd());
    assert!(is_shown(&bench, ", then cycle start after a feed hold"));
}

#[test]
fn the_message_line_shows_block_and_reason_of_an_alarm() {
    let mut bench = WindowBench::new();
    bench.open("faulty/02-no-feed.CNC");
    bench.click("Automatic mode");
    bench.click("Cycle start");
    bench.run(2000);
    let line = bench.harness.query_by_label_contains("011: ");
    assert!(line.is_some(), "{}", bench.lcd());
    bench.click("Reset");
    bench.run(500);
    assert!(bench.harness.query_by_label_contains("011: ").is_none());
}

#[test]
fn a_handwheel_without_effect_shows_the_reason() {
    let mut bench = WindowBench::new();
    bench.click("Step or handwheel mode");
    bench.assert_lcd_contains("单步方式");
    bench.harness.key_press(egui::Key::CloseBracket);
    bench.run(200);
    let reason = "step mode (001.3 = 0)";
    assert!(bench.harness.query_by_label_contains(reason).is_some());

    let mut setup = Setup::default();
    setup.memory.parameters.set_bit(1, 3, true).unwrap();
    let mut bench = WindowBench::with_setup(setup);
    bench.click("Step or handwheel mode");
    bench.assert_lcd_contains("手轮方式");
    let u_before = bench.shown_u();
    bench.harness.key_press(egui::Key::CloseBracket);
    bench.run(500);
    assert_ne!(bench.shown_u(), u_before, "{}", bench.lcd());
    assert!(bench.harness.query_by_label_contains(reason).is_none());
}

#[test]
fn every_window_shows_real_motion_and_the_state_of_the_board() {
    let mut bench = WindowBench::new();
    let windows = ViewWindows::enable(&bench);
    let badge = "REAL MOTION / 真实机床";
    assert!(!is_shown(&bench, badge));
    assert_eq!(bench.harness.state().title(), "GSK980TD");
    let mut snapshot = bench.kernel.snapshot();
    snapshot.board = Some(LinkState::Ready);
    bench.console.snapshots.force_push(snapshot);
    let shift = egui::Modifiers::SHIFT;
    for (open_count, key) in [egui::Key::F2, egui::Key::F3, egui::Key::F5]
        .into_iter()
        .enumerate()
    {
        bench.harness.key_press_modifiers(shift, key);
        for _ in 0..3 {
            bench.harness.step();
        }
        let drawn = windows.draw_frame(&mut bench);
        assert_eq!(drawn.len(), open_count + 1);
        for window in &drawn {
            assert!(window.label_center(badge).is_some(), "{:?}", window.labels);
            assert!(window.label_center("board: ready").is_some());
        }
        assert!(is_shown(&bench, badge));
    }
    assert!(bench.harness.state().title().contains("REAL MOTION"));
}

#[test]
fn after_an_alarm_the_hint_names_the_start_key() {
    let mut bench = WindowBench::new();
    assert!(is_shown(&bench, "Open a program, press"));
    bench.console.send(Command::Open(Box::new(OpenedProgram {
        name: "wrong.CNC".to_owned(),
        path: None,
        store_policy: StorePolicy::AskOperator,
        program: Program::new("O1\nG77\nM30\n"),
        subprograms: Vec::new(),
    })));
    bench.run(100);
    for key in ["Automatic mode", "Cycle start", "Reset"] {
        bench.click(key);
    }
    bench.run(500);
    assert!(is_shown(&bench, "Press [Cycle start 运行]"));
    bench.click("MDI mode");
    bench.run(50);
    assert!(is_shown(
        &bench,
        "Press [Auto 自动], then [Cycle start 运行]"
    ));
    assert!(!is_shown(&bench, "Open a program, press"));
}

#[test]
fn the_remedy_of_an_alarm_is_drawn_over_the_lcd_only() {
    let mut bench = WindowBench::new();
    bench.click("Emergency stop");
    bench.click("Emergency stop");
    bench.open("faulty/02-no-feed.CNC");
    bench.click("Automatic mode");
    bench.click("Cycle start");
    bench.run(2000);
    let line = bench.harness.get_by_label_contains("011: ").rect();
    bench
        .harness
        .hover_at(line.left_center() + egui::vec2(20.0, 0.0));
    for _ in 0..60 {
        bench.harness.step();
    }
    let tip = bench.harness.get_by_label_contains("Remedy: ").rect();
    let lcd = bench.harness.get_by_label("LCD").rect();
    assert!(lcd.expand(1.0).contains_rect(tip), "{tip:?} {lcd:?}");
}

#[test]
fn a_key_without_effect_shows_the_reason_until_a_key_acts() {
    let mut bench = WindowBench::new();
    for (mode, key, english) in [
        ("Jog mode", "Cycle start", "only in the modes"),
        (
            "Automatic mode",
            "Z axis, arrow left",
            "the axis keys act in",
        ),
        ("MDI mode", "Spindle forward", "manual and zero modes"),
        ("MDI mode", "Cycle start", "no MDI block is entered"),
    ] {
        bench.click(mode);
        bench.run(300);
        bench.click(key);
        bench.run(300);
        assert!(is_shown(&bench, english), "{key}: {}", bench.lcd());
        bench.click("Position pages");
        bench.run(300);
        assert!(!is_shown(&bench, english), "{key}");
    }
}

#[test]
fn a_ladder_message_is_shown_on_the_message_line() {
    let mut bench = WindowBench::new();
    // Without a chuck the example of the manual stops at its M12.
    bench.open("04-manual-example.CNC");
    bench.click("Automatic mode");
    bench.click("Cycle start");
    bench.run(8000);
    let line = bench
        .harness
        .query_by_label_contains("1013: Chuck function not active");
    assert!(line.is_some(), "{}", bench.lcd());
    assert!(bench.harness.query_by_label_contains("line 4").is_some());
    bench.click("Reset");
    bench.run(500);
    assert!(bench.harness.query_by_label_contains("1013: ").is_none());
}
