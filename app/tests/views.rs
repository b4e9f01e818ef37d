//! The views beside the panel, driven through their accessible names.

mod common;

use common::Bench;
use egui_kittest::kittest::Queryable;
use gsk_core::machine::Fault;

/// Opens a view by its entry in the menu.
fn open(bench: &mut Bench, name: &str) {
    bench.harness.get_by_label("Views").click();
    bench.run(1);
    bench.harness.get_by_label_contains(name).click();
    bench.run(1);
}

#[test]
fn the_scope_is_opened_by_its_key_and_sees_an_axis_move() {
    let mut bench = Bench::new();
    assert!(bench.harness.query_by_label("Scope picture").is_none());
    let shift = egui::Modifiers::SHIFT;
    bench.harness.key_press_modifiers(shift, egui::Key::F2);
    bench.run(1);
    bench.run(500);
    assert!(bench.harness.query_by_label("Scope picture").is_some());

    let control = egui::Modifiers::CTRL;
    bench.harness.key_press_modifiers(control, egui::Key::Num6);
    bench.run(500);
    bench
        .harness
        .key_down_modifiers(control, egui::Key::ArrowLeft);
    bench.run(50);
    for _ in 0..20 {
        bench.run(50);
    }
    let rate = bench.kernel.emulator().simulation.cnc.jog_rate();
    assert!(rate > 0.0);
    let shown = format!("{:.1}", -rate);
    assert!(bench.harness.query_by_label(&shown).is_some(), "no {shown}");
    bench
        .harness
        .key_up_modifiers(control, egui::Key::ArrowLeft);
    bench.run(300);

    bench.harness.key_press_modifiers(shift, egui::Key::F2);
    bench.run(1);
    bench.run(1);
    assert!(bench.harness.query_by_label("Scope picture").is_none());
}

#[test]
fn a_bit_is_watched_and_a_wrong_address_is_refused_with_its_reason() {
    let mut bench = Bench::new();
    open(&mut bench, "Scope");
    let enter = |bench: &mut Bench, text: &str| {
        bench.harness.get_by_label("Bit address").focus();
        bench.run(1);
        bench.harness.get_by_label("Bit address").type_text(text);
        bench.run(1);
        bench.harness.get_by_label("Add").click();
        bench.run(1);
    };
    enter(&mut bench, "x20.5");
    assert!(bench.harness.query_by_label("X0020.5").is_some());
    enter(&mut bench, "Q7.9");
    assert!(
        bench
            .harness
            .query_by_label_contains("Not an address")
            .is_some()
    );
    bench.harness.get_by_label("Remove X0020.5").click();
    bench.run(1);
    bench.run(1);
    assert!(bench.harness.query_by_label("X0020.5").is_none());
}

#[test]
fn the_fault_bench_breaks_and_mends_the_lathe() {
    let mut bench = Bench::new();
    open(&mut bench, "Fault bench");
    bench.run(100);
    bench.run(100);
    let name = "alarm of the Z drive";
    bench.harness.get_by_label(name).click();
    bench.run(100);
    bench.run(100);
    let lathe = |bench: &Bench| bench.kernel.emulator().simulation.lathe.clone();
    assert!(lathe(&bench).has_fault(Fault::DriveZ));
    assert!(bench.kernel.emulator().simulation.cnc.in_alarm());

    bench.harness.get_by_label("X0000.5 0").click();
    bench.run(100);
    bench.run(100);
    let address = "X0.5".parse().unwrap();
    assert_eq!(lathe(&bench).forced_input(address), Some(false));

    bench.harness.get_by_label("Mend all").click();
    bench.run(100);
    bench.run(100);
    assert!(!lathe(&bench).has_fault(Fault::DriveZ));
    assert_eq!(lathe(&bench).forced_input(address), None);
}
