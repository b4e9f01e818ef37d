//! A crash without the machine view, and the way out of it.

use std::time::Duration;

use gsk_host::kernel::{Command, OpenedProgram, StorePolicy};
use gsk_window::layout::{Layouts, WindowLayout};

use crate::common::WindowBench;
use egui_kittest::kittest::{NodeT, Queryable};
use gsk_core::cnc::ControlRequest;
use gsk_core::machine::LatheFault;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_panel::keys::Key;

/// A rapid through the bar, after a turned step that shows how thick the bar is.
const TEXT: &str = "O0007\nG50 X100 Z100\nT0101 M03 S800\nG00 X42 Z2\n\
    G90 X36 Z-30 F300\nG00 X20 Z-20\nM30\n";

/// Runs until words are seen.
fn comes(bench: &mut WindowBench, words: &str) -> bool {
    (0..500).any(|_| {
        std::thread::sleep(Duration::from_millis(5));
        bench.run(100);
        let mut seen = bench.harness.query_all_by_label_contains(words);
        seen.next().is_some()
    })
}

/// A program under way in a window with the panel alone.
fn started() -> WindowBench {
    started_with(TEXT)
}

fn started_with(text: &str) -> WindowBench {
    let mut bench = opened(text);
    start(&mut bench);
    bench
}

fn start(bench: &mut WindowBench) {
    for key in [Key::Auto, Key::CycleStart] {
        bench.console.send(Command::Tap(key));
        bench.run(200);
    }
}

/// A program that is opened, with its guessed job.
fn opened(text: &str) -> WindowBench {
    let size = egui::vec2(1280.0, 806.0);
    let mut bench = WindowBench::with_layouts(
        Setup::default(),
        Layouts::with_layout(WindowLayout::Panel),
        size,
    );
    bench.console.send(Command::Open(Box::new(OpenedProgram {
        name: "O7.CNC".to_owned(),
        path: None,
        store_policy: StorePolicy::RunOnly,
        program: Program::new(text),
        subprograms: Vec::new(),
    })));
    // Its job is guessed beside the window.
    for _ in 0..100 {
        std::thread::sleep(Duration::from_millis(5));
        bench.run(10);
    }
    bench
}

#[test]
fn a_crash_stops_the_lathe_with_the_machine_view_closed_and_one_button_leads_out() {
    let mut bench = started();
    assert!(comes(&mut bench, "CRASH"), "the rapid went through the bar");
    bench.run(500);
    let emulator = bench.kernel.emulator();
    assert!(!emulator.cnc().is_moving(), "the lathe goes on");
    assert!(!emulator.cnc().alarms().is_empty());
    // The crash stays on the line: its alarm says less.
    assert!(bench.harness.query_by_label_contains("CRASH").is_some());
    // A key that the alarm refuses, as everyone tries first: the way out stays.
    for key in [Key::Jog, Key::XDown, Key::Reset] {
        bench.console.send(Command::Tap(key));
        bench.run(300);
    }
    bench.click("Free the lathe");
    bench.run(1000);
    assert!(
        bench
            .harness
            .query_by_label_contains("The lathe is free")
            .is_some()
    );
    assert!(bench.harness.query_by_label("Free the lathe").is_none());
    let simulation = bench.kernel.emulator().simulation();
    assert_eq!(simulation.lathe.fault_count(), 0);
    assert_eq!(simulation.cnc.alarms(), []);
}

/// Number of messages in the history.
fn message_count(bench: &WindowBench) -> u32 {
    let mut shown = bench.harness.query_all_by_label_contains("Messages (");
    let label = shown
        .next()
        .and_then(|it| it.accesskit_node().label())
        .unwrap_or_default();
    let figure = label.trim_start_matches("Messages (").trim_end_matches(')');
    figure.parse().unwrap()
}

/// Volume of the part in the chuck, mm³.
fn part_volume(bench: &mut WindowBench) -> f64 {
    let console = bench.console.clone();
    let answer = std::thread::spawn(move || console.machine_copy());
    while !answer.is_finished() {
        std::thread::sleep(Duration::from_millis(2));
        bench.run(1);
    }
    let (_, part) = *answer.join().unwrap().unwrap();
    part.unwrap().machining().scene().part().volume()
}

#[test]
fn a_crash_is_one_message_of_the_history_and_new_stock_ends_it() {
    let mut bench = opened(TEXT);
    let before = message_count(&bench);
    start(&mut bench);
    assert!(comes(&mut bench, "CRASH"));
    bench.run(1000);
    assert_eq!(message_count(&bench), before + 1);
    bench.click("Free the lathe");
    bench.run(1000);
    let is_shown = |bench: &WindowBench| {
        let message = bench.harness.query_by_label_contains("The lathe is free");
        message.is_some()
    };
    assert!(is_shown(&bench));
    bench.console.send(Command::FreshStock);
    bench.run(300);
    assert!(!is_shown(&bench));
}

#[test]
fn a_program_that_ends_says_so_and_keeps_its_part_when_it_is_edited() {
    let text = TEXT.replace("G00 X20 Z-20\n", "");
    let mut bench = opened(&text);
    let stock = part_volume(&mut bench);
    start(&mut bench);
    let end = "Program O0007 has run to its end; parts counted: 1";
    assert!(comes(&mut bench, end));
    let cut = part_volume(&mut bench);
    assert!(cut < stock - 1000.0, "{cut} {stock}");
    let edited = text.replace("S800", "S900");
    let request = ControlRequest::StoreProgram(edited);
    bench.console.send(Command::Request(Box::new(request)));
    for _ in 0..100 {
        std::thread::sleep(Duration::from_millis(5));
        bench.run(10);
    }
    let program = bench.kernel.emulator().cnc().programs().stored(7).unwrap();
    assert!(program.text().contains("S900"));
    assert_eq!(part_volume(&mut bench).to_bits(), cut.to_bits());
}

#[test]
fn a_crash_goes_through_where_it_is_not_to_stop_the_lathe() {
    let mut bench = started();
    bench.console.send(Command::CrashStops(false));
    assert!(comes(&mut bench, "COLLISION"));
    assert!(bench.harness.query_by_label("Free the lathe").is_none());
    assert_eq!(bench.kernel.emulator().lathe().fault_count(), 0);
}

#[test]
fn a_cut_above_the_limits_breaks_the_insert_if_it_is_switched_on() {
    // 1.25 mm a turn: more than the nose of 0.8 mm.
    let text = TEXT.replace("F300", "F1000").replace("G00 X20 Z-20\n", "");
    let mut bench = started_with(&text);
    bench.run(20_000);
    assert_eq!(bench.kernel.emulator().lathe().fault_count(), 0, "off");

    let mut bench = opened(&text);
    bench.console.send(Command::Overload(true));
    start(&mut bench);
    assert!(comes(&mut bench, "OVERLOAD: the insert of T01 breaks"));
    let broken = LatheFault::InsertBroken;
    assert!(bench.kernel.emulator().lathe().has_fault(broken));
    bench.click("Free the lathe");
    bench.run(500);
    assert!(!bench.kernel.emulator().lathe().has_fault(broken));
    assert!(bench.harness.query_by_label("Free the lathe").is_none());
}
