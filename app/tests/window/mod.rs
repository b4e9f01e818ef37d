//! The window without a display, operated through its accessible names as a screen reader
//! does: names, mouse, PC keys, and the text of the LCD.

use egui::{ViewportCommand, ViewportEvent, ViewportId};
use egui_kittest::kittest::Queryable;
use gsk_core::command::ProgramId;

use crate::common::WindowBench;

mod keys;
mod messages;

#[test]
fn a_program_is_opened_started_and_stopped_by_the_emergency_stop() {
    let mut bench = WindowBench::new();
    bench.open("01-stepped-shaft.CNC");
    bench.assert_lcd_contains("O0001");
    let u_before = bench.shown_u();

    bench.click("Automatic mode");
    bench.assert_lcd_contains("自动方式");
    bench.click("Cycle start");
    bench.run(10_000);
    assert_ne!(bench.shown_u(), u_before, "X stands:\n{}", bench.lcd());

    bench.click("Emergency stop");
    bench.assert_lcd_contains("准备未绪");
    bench.assert_lcd_contains("207");
    bench.click("Position pages");
    let u_after_stop = bench.shown_u();
    bench.run(1000);
    assert_eq!(bench.shown_u(), u_after_stop);

    bench.click("Emergency stop");
    bench.run(500);
    assert!(!bench.lcd().contains("准备未绪"), "it is released");
    bench.run(1000);
    assert_eq!(bench.shown_u(), u_after_stop, "nothing moves by itself");
}

/// Whether the window shows a text.
fn is_shown(bench: &WindowBench, text: &str) -> bool {
    let mut all = bench.harness.query_all_by_label_contains(text);
    all.next().is_some()
}

/// Clicks a button of the window by its text.
fn click(bench: &mut WindowBench, label: &str) {
    bench.harness.get_by_label(label).click();
    bench.run(20);
}

pub fn request_close(bench: &mut WindowBench) -> Vec<ViewportCommand> {
    let root = bench.harness.input_mut().viewports.entry(ViewportId::ROOT);
    root.or_default().events.push(ViewportEvent::Close);
    bench.harness.step();
    let commands = bench.harness.output().viewport_output[&ViewportId::ROOT]
        .commands
        .clone();
    let root = bench.harness.input_mut().viewports.entry(ViewportId::ROOT);
    root.or_default().events.clear();
    bench.harness.step();
    commands
}

#[test]
fn closing_asks_about_an_unsaved_text() {
    let mut bench = WindowBench::new();
    let shift = egui::Modifiers::SHIFT;
    bench.harness.key_press_modifiers(shift, egui::Key::F11);
    bench.run(1);
    assert_eq!(request_close(&mut bench), [], "nothing is typed");
    bench.harness.get_by_label("Program text").focus();
    bench.run(1);
    let typed = egui::Event::Text("G00 X10".to_owned());
    bench.harness.event(typed);
    bench.run(1);
    let commands = request_close(&mut bench);
    assert!(
        commands.contains(&ViewportCommand::CancelClose),
        "{commands:?}"
    );
    assert!(is_shown(&bench, "The program text is not saved"));
    bench.harness.get_by_label("Close without saving").click();
    bench.harness.step();
    let commands = &bench.harness.output().viewport_output[&ViewportId::ROOT].commands;
    assert!(commands.contains(&ViewportCommand::Close), "{commands:?}");
}

#[test]
fn closing_asks_while_a_program_runs_or_is_held() {
    let mut bench = WindowBench::new();
    assert_eq!(request_close(&mut bench), [], "nothing runs");
    bench.open("01-stepped-shaft.CNC");
    bench.click("Automatic mode");
    bench.click("Cycle start");
    for (key, question) in [
        ("Single block", "A program is running"),
        ("Feed hold", "A program is held"),
    ] {
        bench.click(key);
        let commands = request_close(&mut bench);
        assert!(
            commands.contains(&ViewportCommand::CancelClose),
            "{commands:?}"
        );
        assert!(is_shown(&bench, question), "{}", bench.lcd());
        click(&mut bench, "Do not close");
        assert!(!is_shown(&bench, question));
    }
    request_close(&mut bench);
    bench.harness.get_by_label("Stop and close").click();
    bench.harness.step();
    let commands = &bench.harness.output().viewport_output[&ViewportId::ROOT].commands;
    assert!(commands.contains(&ViewportCommand::Close), "{commands:?}");
    let commands_after = request_close(&mut bench);
    assert!(
        !commands_after.contains(&ViewportCommand::CancelClose),
        "{commands_after:?}"
    );
}

#[test]
fn an_opened_program_is_stored_and_never_overwrites_another() {
    let mut bench = WindowBench::new();
    click(&mut bench, "Samples");
    let entry = bench.harness.get_by_label_contains("stepped shaft");
    entry.click();
    let stored = "O0001, 4:";
    let mut wait_count = 0;
    while !is_shown(&bench, stored) {
        std::thread::sleep(std::time::Duration::from_millis(10));
        bench.run(1);
        wait_count += 1;
        assert!(wait_count < 1000, "not opened");
    }
    click(&mut bench, "中文");
    assert!(is_shown(&bench, "把刀，切削范围 X "));
    click(&mut bench, "English");

    let text = |bench: &WindowBench| {
        let programs = bench.kernel.emulator().cnc().programs();
        let program = programs.get(ProgramId::Stored(1));
        program
            .map(|program| program.text().to_owned())
            .unwrap_or_default()
    };
    let previous_text = text(&bench);
    bench.click("Edit mode");
    bench.click("Program pages");
    for key in ["Cursor down", "Address N", "Digit 7", "Automatic mode"] {
        bench.click(key);
    }
    let edited = text(&bench);
    assert_ne!(edited, previous_text, "typing changes it");

    // The file is opened again: the edited program is not discarded.
    bench.open("01-stepped-shaft.CNC");
    let question = "O0001 is already in the memory";
    let is_question_shown = (0..1000).any(|_| {
        std::thread::sleep(std::time::Duration::from_millis(10));
        bench.run(1);
        is_shown(&bench, question)
    });
    assert!(is_question_shown && text(&bench) == edited);
    click(&mut bench, "Keep it, only run the file");
    bench.run(50);
    assert!(is_shown(
        &bench,
        "It is not stored: the memory keeps its own program 0001"
    ));
    assert_eq!(text(&bench), edited);
    let programs = bench.kernel.emulator().cnc().programs();
    assert_eq!(programs.selected(), Some(ProgramId::External));
}

#[test]
fn an_opened_program_is_summarized_at_once() {
    let mut bench = WindowBench::new();
    let wait_for_text = |bench: &mut WindowBench, text: &str| {
        (0..1000).any(|_| {
            std::thread::sleep(std::time::Duration::from_millis(10));
            bench.run(1);
            is_shown(bench, text)
        })
    };
    bench.open("03-grooved-pin.CNC");
    let line = ", 2 tools, cuts X 24 to 36, Z -45 to 2, no alarm";
    assert!(wait_for_text(&mut bench, line));
    bench.open("faulty/02-no-feed.CNC");
    let failing = ": P/S 011 ";
    assert!(wait_for_text(&mut bench, failing));
    assert!(is_shown(&bench, ", line "));
    // The summary disappears when another program is selected.
    bench.click("Edit mode");
    bench.click("Program pages");
    for key in ["Address O", "Digit 3", "Cursor down"] {
        bench.click(key);
    }
    bench.run(500);
    assert!(!is_shown(&bench, failing), "{}", bench.lcd());
}
