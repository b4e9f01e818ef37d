//! The speed of the simulation: chosen in the top bar, used only while a program runs.

use crate::common::Bench;
use egui_kittest::kittest::Queryable;
use gsk_app::kernel::Command;
use gsk_app::pace::Speed;
use gsk_link::LinkState;

/// Chooses a speed by its name in the top bar.
fn choose(bench: &mut Bench, shown: &str, name: &str) {
    bench.harness.get_by_label(shown).click();
    bench.run(1);
    bench.harness.get_by_label(name).click();
    bench.run(50);
}

#[test]
fn only_a_program_that_runs_is_faster_than_a_real_lathe() {
    let mut bench = Bench::new();
    bench.open("01-stepped-shaft.CNC");
    choose(&mut bench, "Speed 1x", "100x");
    assert!(bench.harness.query_by_label("Speed 100x").is_some());
    assert_eq!(bench.kernel.speed(), Speed::REAL, "it stands");
    bench.click("Automatic mode");
    bench.click("Cycle start");
    assert_eq!(bench.kernel.speed(), Speed::Percent(10_000));
    bench.click("Feed hold");
    bench.run(500);
    assert_eq!(bench.kernel.speed(), Speed::REAL, "it is held");
    bench.click("Cycle start");
    assert_eq!(bench.kernel.speed(), Speed::Percent(10_000));
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
    assert!(bench.kernel.emulator().simulation.cnc.is_moving());
    assert_eq!(bench.kernel.speed(), Speed::REAL, "it is moved by hand");
}

#[test]
fn a_pulse_board_has_one_speed() {
    let mut bench = Bench::new();
    choose(&mut bench, "Speed 1x", "as fast as possible");
    let chosen = "Speed as fast as possible";
    assert!(bench.harness.query_by_label(chosen).is_some());
    let mut picture = bench.kernel.snapshot();
    picture.board = Some(LinkState::Ready);
    bench.console.pictures.force_push(picture);
    bench.harness.step();
    bench.harness.step();
    bench.harness.get_by_label("Speed 1x").click();
    bench.harness.step();
    bench.harness.step();
    assert!(bench.harness.query_by_label("100x").is_none(), "no menu");
}

#[test]
fn what_moves_is_handed_out_while_somebody_listens() {
    let mut bench = Bench::new();
    bench.open("01-stepped-shaft.CNC");
    let motion = |bench: &Bench| bench.harness.state().picture().unwrap().motion;
    assert_eq!(motion(&bench), None);
    bench.console.send(Command::Listen(true));
    bench.click("Automatic mode");
    let stands = motion(&bench).unwrap();
    assert_eq!(stands.spindle, 0.0);
    bench.click("Cycle start");
    for _ in 0..20 {
        bench.run(500);
    }
    let moves = motion(&bench).unwrap();
    assert_ne!(moves.slides, stands.slides);
    assert!(moves.spindle > 700.0, "S800: {moves:?}");
    bench.console.send(Command::Listen(false));
    bench.run(100);
    assert_eq!(motion(&bench), None);
}
