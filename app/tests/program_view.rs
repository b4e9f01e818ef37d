//! The program view: typing, alarms of the text, files, and the memory of the control.

use std::path::{Path, PathBuf};
use std::time::Duration;

use gsk_host::kernel::Command;

use crate::common::WindowBench;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use gsk_core::cnc::ControlRequest;
use gsk_core::command::ProgramId;

/// A window with the program view.
fn open_view() -> WindowBench {
    let mut bench = WindowBench::new();
    let shift = Modifiers::SHIFT;
    bench.harness.key_press_modifiers(shift, Key::F11);
    bench.run(1);
    bench
}

fn is_shown(bench: &WindowBench, text: &str) -> bool {
    bench.harness.query_all_by_label_contains(text).count() > 0
}

/// Waits for the result of a thread.
#[track_caller]
fn wait_for(
    bench: &mut WindowBench,
    description: &str,
    mut is_met: impl FnMut(&WindowBench) -> bool,
) {
    for _ in 0..1000 {
        bench.run(1);
        if is_met(bench) {
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("no {description}");
}

#[track_caller]
fn wait_for_text(bench: &mut WindowBench, text: &str) {
    wait_for(bench, text, |bench| is_shown(bench, text));
}

/// The text in the editor.
fn editor_text(bench: &WindowBench) -> String {
    let field = bench.harness.get_by_label("Program text");
    field.value().unwrap_or_default()
}

/// Types at the end of the text.
fn type_at_end(bench: &mut WindowBench, typed: &str) {
    bench.harness.get_by_label("Program text").focus();
    bench.run(1);
    bench
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::End);
    bench.run(1);
    for (index, line) in typed.split('\n').enumerate() {
        if index > 0 {
            bench.harness.key_press(Key::Enter);
            bench.run(1);
        }
        if !line.is_empty() {
            let event = egui::Event::Text(line.to_owned());
            bench.harness.event(event);
            bench.run(1);
        }
    }
}

/// A temporary file. It is removed when it is dropped.
struct TempProgram(PathBuf);

impl TempProgram {
    fn new(name: &str, bytes: &[u8]) -> Self {
        let folder =
            std::env::temp_dir().join(format!("gsk980td-view-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(name), bytes).unwrap();
        Self(folder.join(name))
    }
}

impl Drop for TempProgram {
    fn drop(&mut self) {
        if let Some(folder) = self.0.parent() {
            let _ = std::fs::remove_dir_all(folder);
        }
    }
}

fn open_file(bench: &mut WindowBench, path: &Path) {
    let context = bench.harness.ctx.clone();
    bench.harness.state_mut().open(&context, path.to_path_buf());
}

#[test]
fn alarms_are_shown_below_the_text_while_it_is_typed() {
    let mut bench = open_view();
    type_at_end(&mut bench, "O0007\nG00 X40 Z2\nG01 Z-30");
    wait_for_text(&mut bench, "P/S 011 ");
    assert!(is_shown(&bench, "line 3: G01 Z-30"));
    assert!(is_shown(&bench, "Remedy: "));
    type_at_end(&mut bench, " F100\nM30\n");
    wait_for_text(&mut bench, "1 tool, cuts X 40 to 40, Z -30 to 2, no alarm");
    assert!(!is_shown(&bench, "P/S 011 "));
    bench.harness.get_by_label("Undo").click();
    bench.run(1);
    bench.run(1);
    assert_ne!(
        editor_text(&bench),
        "O0007\nG00 X40 Z2\nG01 Z-30 F100\nM30\n"
    );
}

#[test]
fn a_file_keeps_its_encoding_and_line_ends() {
    // The comment is (粗车) in GBK.
    let begin = b"O0008 (\xB4\xD6\xB3\xB5)\r\nG00 X20 Z2\r\n";
    let file = TempProgram::new("gbk.CNC", &[&begin[..], b"M30\r\n"].concat());
    let mut bench = open_view();
    open_file(&mut bench, &file.0);
    wait_for_text(&mut bench, "gbk.CNC (GB18030)");
    assert_eq!(editor_text(&bench), "O0008 (粗车)\nG00 X20 Z2\nM30\n");
    type_at_end(&mut bench, "(车)");
    assert!(is_shown(&bench, "● gbk.CNC"));
    bench
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::S);
    wait_for_text(&mut bench, "Saved");
    assert!(!is_shown(&bench, "● gbk.CNC"));
    let wanted = [&begin[..], b"M30\r\n(\xB3\xB5)"].concat();
    assert_eq!(std::fs::read(&file.0).unwrap(), wanted);
}

#[test]
fn unsaved_text_is_discarded_only_after_a_question() {
    let file = TempProgram::new("other.CNC", b"O0009\nM30\n");
    let mut bench = open_view();
    type_at_end(&mut bench, "O0007\nM30");
    open_file(&mut bench, &file.0);
    wait_for_text(&mut bench, "are not saved and would be lost");
    bench.harness.get_by_label("Continue editing").click();
    bench.run(1);
    bench.run(1);
    assert_eq!(editor_text(&bench), "O0007\nM30");
    open_file(&mut bench, &file.0);
    wait_for_text(&mut bench, "are not saved and would be lost");
    bench.harness.get_by_label("Do not save").click();
    wait_for(&mut bench, "other text", |bench| {
        editor_text(bench) == "O0009\nM30\n"
    });
}

#[test]
fn a_text_is_stored_in_the_control_only_with_the_rights() {
    let mut bench = open_view();
    let stored = |bench: &WindowBench| {
        let programs = bench.kernel.emulator().cnc().programs();
        let program = programs.get(ProgramId::Stored(7));
        program.map(|program| program.text().to_owned())
    };
    type_at_end(&mut bench, "O0007\nG00 X10\nM30\n");
    let switch = |on| Command::Request(Box::new(ControlRequest::SetProgramSwitch(on)));
    bench.console.send(switch(false));
    bench.harness.get_by_label("Store in the control").click();
    wait_for_text(&mut bench, "the program switch");
    assert_eq!(stored(&bench), None);
    bench.console.send(switch(true));
    bench.harness.get_by_label("Store in the control").click();
    wait_for_text(&mut bench, "stored in the control as O0007");
    assert_eq!(stored(&bench).as_deref(), Some("O0007\nG00 X10\nM30\n"));
    assert!(!is_shown(&bench, "● O0007"));
}

#[test]
fn blocks_are_found_by_number_and_by_text() {
    let mut bench = open_view();
    type_at_end(&mut bench, "O0007\nN10 G00 X10\nN20 G01 X20 F100\nM30\n");
    let type_into = |bench: &mut WindowBench, field: &str, typed_text: &str| {
        bench.harness.get_by_label(field).focus();
        bench.run(1);
        bench
            .harness
            .event(egui::Event::Text(typed_text.to_owned()));
        bench.run(1);
        bench.harness.key_press(Key::Enter);
        bench.run(1);
        bench.run(1);
    };
    type_into(&mut bench, "Go to", "N20");
    bench.harness.event(egui::Event::Text("(here)".to_owned()));
    bench.run(1);
    assert!(
        editor_text(&bench).contains("N10 G00 X10\n(here)\nM30"),
        "{}",
        editor_text(&bench)
    );
    type_into(&mut bench, "Find", "g00");
    bench.harness.event(egui::Event::Text("G02".to_owned()));
    bench.run(1);
    assert!(
        editor_text(&bench).contains("N10 G02 X10"),
        "{}",
        editor_text(&bench)
    );
    type_into(&mut bench, "Go to", "N99");
    assert!(is_shown(&bench, "N99"));
}

#[test]
fn a_very_long_text_is_shown_read_only() {
    let lines: String = (0..60_000)
        .map(|line| format!("N{:04} G00 X{line}\n", line % 9999))
        .collect();
    let file = TempProgram::new("large.CNC", lines.as_bytes());
    let mut bench = open_view();
    open_file(&mut bench, &file.0);
    wait_for_text(&mut bench, "shown, not edited");
    assert!(bench.harness.query_by_label("Program text").is_none());
}

#[test]
fn the_emergency_stop_key_works_while_a_text_is_typed() {
    let mut bench = open_view();
    type_at_end(&mut bench, "G00 X10\n");
    bench.harness.key_press(Key::F12);
    bench.run(50);
    let pressed = bench.kernel.emulator().panel().pressed();
    assert!(pressed.contains(&gsk_panel::keys::Key::EmergencyStop));
    assert_eq!(editor_text(&bench), "G00 X10\n");
}

#[test]
fn pointing_at_a_word_shows_its_meaning() {
    let mut bench = open_view();
    type_at_end(&mut bench, "G71 U2 R1\n");
    let field = bench.harness.get_by_label("Program text").rect();
    // Next to the margin with the marks and three digits of the line number.
    let word = field.left_top() + egui::vec2(68.0, 12.0);
    bench.harness.hover_at(word);
    for _ in 0..60 {
        bench.harness.step();
    }
    assert!(is_shown(&bench, "G71: roughing along Z"));
}
