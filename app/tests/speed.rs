//! The speed of the simulation: chosen in the top bar, used only while a program runs.

use gsk_host::kernel::Command;
use gsk_host::kernel::pace::RunSpeed;

use crate::common::WindowBench;
use egui_kittest::kittest::Queryable;
use gsk_link::LinkState;

/// Chooses a speed by its name in the top bar.
fn choose_speed(bench: &mut WindowBench, current: &str, name: &str) {
    bench.harness.get_by_label(current).click();
    bench.run(1);
    bench.harness.get_by_label(name).click();
    bench.run(50);
}

#[test]
fn only_a_running_program_is_faster_than_real_time() {
    let mut bench = WindowBench::new();
    bench.open("01-stepped-shaft.CNC");
    choose_speed(&mut bench, "Speed 1x", "100x");
    assert!(bench.harness.query_by_label("Speed 100x").is_some());
    assert_eq!(bench.kernel.speed(), RunSpeed::REAL, "it stands");
    bench.click("Automatic mode");
    bench.click("Cycle start");
    assert_eq!(bench.kernel.speed(), RunSpeed::Percent(10_000));
    bench.click("Feed hold");
    bench.run(500);
    assert_eq!(bench.kernel.speed(), RunSpeed::REAL, "it is held");
    bench.click("Cycle start");
    assert_eq!(bench.kernel.speed(), RunSpeed::Percent(10_000));
    bench.click("Reset");
    bench.click("Jog mode");
    let control = egui::Modifiers::CTRL;
    bench
        .harness
        .key_down_modifiers(control, egui::Key::ArrowLeft);
    bench.run(50);
    for _ in 0..10 {
        bench.run(50);
    }
    assert!(bench.kernel.emulator().cnc().is_moving());
    assert_eq!(bench.kernel.speed(), RunSpeed::REAL, "it is moved by hand");
}

#[test]
fn a_pulse_board_has_one_speed() {
    let mut bench = WindowBench::new();
    choose_speed(&mut bench, "Speed 1x", "as fast as possible");
    let label = "Speed as fast as possible";
    assert!(bench.harness.query_by_label(label).is_some());
    let mut snapshot = bench.kernel.snapshot();
    snapshot.board = Some(LinkState::Ready);
    bench.console.snapshots.force_push(snapshot);
    bench.harness.step();
    bench.harness.step();
    bench.harness.get_by_label("Speed 1x").click();
    bench.harness.step();
    bench.harness.step();
    assert!(bench.harness.query_by_label("100x").is_none(), "no menu");
}

#[test]
fn motion_is_sent_only_while_sound_is_on() {
    let mut bench = WindowBench::new();
    bench.open("01-stepped-shaft.CNC");
    let motion = |bench: &WindowBench| bench.harness.state().snapshot().unwrap().motion;
    assert_eq!(motion(&bench), None);
    bench.console.send(Command::PublishMotion(true));
    bench.click("Automatic mode");
    let at_rest = motion(&bench).unwrap();
    assert_eq!(at_rest.spindle_rpm, 0.0);
    bench.click("Cycle start");
    for _ in 0..20 {
        bench.run(500);
    }
    let in_motion = motion(&bench).unwrap();
    assert_ne!(in_motion.slides, at_rest.slides);
    assert!(in_motion.spindle_rpm > 700.0, "S800: {in_motion:?}");
    bench.console.send(Command::PublishMotion(false));
    bench.run(100);
    assert_eq!(motion(&bench), None);
}
