//! The program view: typing, alarms of the text, files, and the memory of the control.

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::common::Bench;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use gsk_app::kernel::Command;
use gsk_core::cnc::Request;
use gsk_core::command::ProgramId;

/// A window with the program view.
fn with_view() -> Bench {
    let mut bench = Bench::new();
    let shift = Modifiers::SHIFT;
    bench.harness.key_press_modifiers(shift, Key::F11);
    bench.run(1);
    bench
}

fn says(bench: &Bench, words: &str) -> bool {
    bench.harness.query_all_by_label_contains(words).count() > 0
}

/// Waits for the result of a thread.
#[track_caller]
fn wait_for(bench: &mut Bench, what: &str, mut holds: impl FnMut(&Bench) -> bool) {
    for _ in 0..1000 {
        bench.run(1);
        if holds(bench) {
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("no {what}");
}

#[track_caller]
fn wait_to_say(bench: &mut Bench, words: &str) {
    wait_for(bench, words, |bench| says(bench, words));
}

/// The text in the editor.
fn text(bench: &Bench) -> String {
    let field = bench.harness.get_by_label("Program text");
    field.value().unwrap_or_default()
}

/// Types at the end of the text.
fn type_at_end(bench: &mut Bench, words: &str) {
    bench.harness.get_by_label("Program text").focus();
    bench.run(1);
    bench
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::End);
    bench.run(1);
    for (index, piece) in words.split('\n').enumerate() {
        if index > 0 {
            bench.harness.key_press(Key::Enter);
            bench.run(1);
        }
        if !piece.is_empty() {
            let event = egui::Event::Text(piece.to_owned());
            bench.harness.event(event);
            bench.run(1);
        }
    }
}

/// A temporary file. It is removed when it is dropped.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str, bytes: &[u8]) -> Self {
        let folder =
            std::env::temp_dir().join(format!("gsk980td-view-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(name), bytes).unwrap();
        Self(folder.join(name))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        if let Some(folder) = self.0.parent() {
            let _ = std::fs::remove_dir_all(folder);
        }
    }
}

fn open(bench: &mut Bench, path: &Path) {
    let context = bench.harness.ctx.clone();
    bench.harness.state_mut().open(&context, path.to_path_buf());
}

#[test]
fn alarms_stand_below_the_text_while_it_is_typed() {
    let mut bench = with_view();
    type_at_end(&mut bench, "O0007\nG00 X40 Z2\nG01 Z-30");
    wait_to_say(&mut bench, "P/S 011 ");
    assert!(says(&bench, "line 3: G01 Z-30"));
    assert!(says(&bench, "Way out: "));
    type_at_end(&mut bench, " F100\nM30\n");
    wait_to_say(&mut bench, "1 tool, X 40–40, Z -30–2, no alarm");
    assert!(!says(&bench, "P/S 011 "));
    bench.harness.get_by_label("Undo").click();
    bench.run(1);
    bench.run(1);
    assert_ne!(text(&bench), "O0007\nG00 X40 Z2\nG01 Z-30 F100\nM30\n");
}

#[test]
fn a_file_is_saved_in_its_own_encoding_with_its_own_line_ends() {
    // The comment is (粗车) in GBK.
    let begin = b"O0008 (\xB4\xD6\xB3\xB5)\r\nG00 X20 Z2\r\n";
    let file = Scratch::new("gbk.CNC", &[&begin[..], b"M30\r\n"].concat());
    let mut bench = with_view();
    open(&mut bench, &file.0);
    wait_to_say(&mut bench, "gbk.CNC (GB18030)");
    assert_eq!(text(&bench), "O0008 (粗车)\nG00 X20 Z2\nM30\n");
    type_at_end(&mut bench, "(车)");
    assert!(says(&bench, "● gbk.CNC"));
    bench
        .harness
        .key_press_modifiers(Modifiers::COMMAND, Key::S);
    wait_to_say(&mut bench, "Saved");
    assert!(!says(&bench, "● gbk.CNC"));
    let wanted = [&begin[..], b"M30\r\n(\xB3\xB5)"].concat();
    assert_eq!(std::fs::read(&file.0).unwrap(), wanted);
}

#[test]
fn typed_text_is_not_lost_without_a_question() {
    let file = Scratch::new("other.CNC", b"O0009\nM30\n");
    let mut bench = with_view();
    type_at_end(&mut bench, "O0007\nM30");
    open(&mut bench, &file.0);
    wait_to_say(&mut bench, "is not saved and would be lost");
    bench.harness.get_by_label("Go on typing").click();
    bench.run(1);
    bench.run(1);
    assert_eq!(text(&bench), "O0007\nM30");
    open(&mut bench, &file.0);
    wait_to_say(&mut bench, "is not saved and would be lost");
    bench.harness.get_by_label("Do not save").click();
    wait_for(&mut bench, "other text", |bench| {
        text(bench) == "O0009\nM30\n"
    });
}

#[test]
fn a_text_becomes_a_program_of_the_control_where_it_may() {
    let mut bench = with_view();
    let stored = |bench: &Bench| {
        let programs = bench.kernel.emulator().simulation.cnc.programs();
        let program = programs.get(ProgramId::Stored(7));
        program.map(|program| program.text().to_owned())
    };
    type_at_end(&mut bench, "O0007\nG00 X10\nM30\n");
    let switch = |on| Command::Ask(Box::new(Request::SetProgramSwitch(on)));
    bench.console.send(switch(false));
    bench.harness.get_by_label("Store in the control").click();
    wait_to_say(&mut bench, "the program switch");
    assert_eq!(stored(&bench), None);
    bench.console.send(switch(true));
    bench.harness.get_by_label("Store in the control").click();
    wait_to_say(&mut bench, "stored in the control as O0007");
    assert_eq!(stored(&bench).as_deref(), Some("O0007\nG00 X10\nM30\n"));
    assert!(!says(&bench, "● O0007"));
}

#[test]
fn blocks_are_found_by_number_and_by_text() {
    let mut bench = with_view();
    type_at_end(&mut bench, "O0007\nN10 G00 X10\nN20 G01 X20 F100\nM30\n");
    let typed = |bench: &mut Bench, field: &str, words: &str| {
        bench.harness.get_by_label(field).focus();
        bench.run(1);
        bench.harness.event(egui::Event::Text(words.to_owned()));
        bench.run(1);
        bench.harness.key_press(Key::Enter);
        bench.run(1);
        bench.run(1);
    };
    typed(&mut bench, "Go to", "N20");
    bench.harness.event(egui::Event::Text("(here)".to_owned()));
    bench.run(1);
    assert!(
        text(&bench).contains("N10 G00 X10\n(here)\nM30"),
        "{}",
        text(&bench)
    );
    typed(&mut bench, "Find", "g00");
    bench.harness.event(egui::Event::Text("G02".to_owned()));
    bench.run(1);
    assert!(text(&bench).contains("N10 G02 X10"), "{}", text(&bench));
    typed(&mut bench, "Go to", "N99");
    assert!(says(&bench, "N99"));
}

#[test]
fn a_text_of_many_lines_is_shown_and_not_edited() {
    let lines: String = (0..60_000)
        .map(|line| format!("N{:04} G00 X{line}\n", line % 9999))
        .collect();
    let file = Scratch::new("large.CNC", lines.as_bytes());
    let mut bench = with_view();
    open(&mut bench, &file.0);
    wait_to_say(&mut bench, "shown, not edited");
    assert!(bench.harness.query_by_label("Program text").is_none());
}

#[test]
fn the_emergency_stop_is_within_reach_while_a_text_is_typed() {
    let mut bench = with_view();
    type_at_end(&mut bench, "G00 X10\n");
    bench.harness.key_press(Key::F12);
    bench.run(50);
    let pressed = bench.kernel.emulator().panel.pressed();
    assert!(pressed.contains(&gsk_panel::keys::Key::EmergencyStop));
    assert_eq!(text(&bench), "G00 X10\n");
}

#[test]
fn the_pointer_says_what_a_word_means() {
    let mut bench = with_view();
    type_at_end(&mut bench, "G71 U2 R1\n");
    let field = bench.harness.get_by_label("Program text").rect();
    // Next to the line number with its three digits.
    let word = field.left_top() + egui::vec2(50.0, 12.0);
    bench.harness.hover_at(word);
    for _ in 0..60 {
        bench.harness.step();
    }
    assert!(says(&bench, "G71: roughing along Z"));
}
