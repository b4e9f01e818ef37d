//! The sentence about a program that would start away from its last start point.

use gsk_host::kernel::Command;

use crate::common::WindowBench;
use egui_kittest::kittest::Queryable;
use gsk_core::operation::RunState;
use gsk_panel::keys::Key;

fn is_reported(bench: &WindowBench) -> bool {
    is_seen(bench, "the last start was")
}

fn is_seen(bench: &WindowBench, words: &str) -> bool {
    let mut all = bench.harness.query_all_by_label_contains(words);
    all.next().is_some()
}

fn tap(bench: &mut WindowBench, key: Key) {
    bench.console.send(Command::Tap(key));
    bench.run(300);
}

#[test]
fn a_start_after_reset_in_the_cut_is_explained_until_the_tool_is_back() {
    let mut bench = WindowBench::new();
    bench.open("01-stepped-shaft.CNC");
    tap(&mut bench, Key::Auto);
    assert!(!is_reported(&bench), "the first start may be anywhere");
    tap(&mut bench, Key::CycleStart);
    for _ in 0..100 {
        bench.run(200);
    }
    let cnc = bench.kernel.emulator().cnc();
    assert_eq!(cnc.run_state(), RunState::Run);
    tap(&mut bench, Key::Reset);
    bench.run(1000);
    // START would continue within the facing cycle: this comes first.
    assert!(
        is_seen(&bench, "in mid-program"),
        "{}",
        bench.lcd_of_kernel()
    );
    assert!(!is_reported(&bench));
    for key in [Key::Edit, Key::Reset, Key::Jog] {
        tap(&mut bench, key);
    }
    // As after a crash: the sentence about it goes with new stock, and the hint comes.
    for command in [Command::FreeLathe, Command::FreshStock] {
        bench.console.send(command);
        bench.run(500);
    }
    assert!(is_seen(&bench, "to see the way back"));
    tap(&mut bench, Key::Auto);
    assert!(!is_seen(&bench, "in mid-program"));
    assert!(is_reported(&bench), "{}", bench.lcd_of_kernel());
    let position = |bench: &WindowBench| bench.kernel.emulator().cnc().position_machine();
    let before = position(&bench);
    bench.click("Show the way back");
    bench.run(300);
    assert_eq!(position(&bench), before, "the button moves nothing");
    // The steps take the place of the report until the end of the way.
    let is_next =
        |bench: &WindowBench, what: &str| is_seen(bench, &format!("The way back: {what}"));
    assert!(is_next(&bench, "press"), "{}", bench.lcd_of_kernel());
    tap(&mut bench, Key::ProgramZero);
    for key in [Key::XDown, Key::ZRight] {
        assert!(is_next(&bench, "hold"), "{}", bench.lcd_of_kernel());
        bench.console.send(Command::Key { key, down: true });
        for _ in 0..150 {
            bench.run(200);
        }
        bench.console.send(Command::Key { key, down: false });
        bench.run(200);
    }
    assert!(is_next(&bench, "press"), "{}", bench.lcd_of_kernel());
    tap(&mut bench, Key::Auto);
    bench.run(300);
    assert!(
        !is_next(&bench, "") && !is_reported(&bench),
        "{}",
        bench.lcd_of_kernel()
    );
}
