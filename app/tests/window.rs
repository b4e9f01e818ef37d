//! The window without a display, operated through its accessible names as a screen reader
//! does: names, mouse, PC keys, and the text of the LCD.

use crate::common::Bench;
use crate::common::windows::Windows;
use egui::{ViewportCommand, ViewportEvent, ViewportId};
use egui_kittest::kittest::Queryable;
use gsk_app::kernel::{Command, Opened, Storing};
use gsk_core::command::ProgramId;
use gsk_core::machine::Fault;
use gsk_core::operation::RunState;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_link::LinkState;
use gsk_panel::keys::{KEYS, Key, KeyRole};

#[test]
fn a_program_is_opened_started_and_stopped_by_the_emergency_stop() {
    let mut bench = Bench::new();
    bench.open("01-stepped-shaft.CNC");
    bench.lcd_shows("O0001");
    let before = bench.shown_u();

    bench.click("Automatic mode");
    bench.lcd_shows("自动方式");
    bench.click("Cycle start");
    bench.run(10_000);
    assert_ne!(bench.shown_u(), before, "X stands:\n{}", bench.lcd());

    bench.click("Emergency stop");
    bench.lcd_shows("准备未绪");
    bench.lcd_shows("207");
    bench.click("Position pages");
    let stopped = bench.shown_u();
    bench.run(1000);
    assert_eq!(bench.shown_u(), stopped);

    bench.click("Emergency stop");
    bench.run(500);
    assert!(!bench.lcd().contains("准备未绪"), "it is released");
    bench.run(1000);
    assert_eq!(bench.shown_u(), stopped, "nothing moves by itself");
}

#[test]
fn every_key_is_there_by_name() {
    let bench = Bench::new();
    for row in &KEYS {
        let count = bench.harness.query_all_by_label(row.name_en).count();
        assert_eq!(count, 1, "{} by its name «{}»", row.id, row.name_en);
    }
}

#[test]
fn machine_keys_reach_their_contact_and_light_their_lamp() {
    let mut bench = Bench::new();
    for (name, mode) in [
        ("Jog mode", "手动方式"),
        ("Edit mode", "编辑方式"),
        ("MDI mode", "录入方式"),
        ("Automatic mode", "自动方式"),
    ] {
        bench.click(name);
        bench.lcd_shows(mode);
    }
    let lamp = Key::from_id("SBK").and_then(|key| key.row().lamp).unwrap();
    let lit = |bench: &Bench| lamp.is_set_in(&bench.kernel.emulator().lamps());
    assert!(!lit(&bench));
    bench.click("Single block");
    assert!(lit(&bench));
}

#[test]
fn a_held_mouse_button_holds_the_key() {
    let mut bench = Bench::new();
    bench.click("Jog mode");
    let place = bench
        .harness
        .get_by_label("Z axis, arrow left")
        .rect()
        .center();
    let button = |pressed| egui::Event::PointerButton {
        pos: place,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::default(),
    };
    bench.harness.event(egui::Event::PointerMoved(place));
    bench.harness.event(button(true));
    bench.run(50);
    let emulator = |bench: &Bench| bench.kernel.emulator().clone();
    for _ in 0..20 {
        bench.run(50);
    }
    assert!(
        emulator(&bench).simulation.cnc.is_moving(),
        "held: the axis moves"
    );
    bench.harness.event(button(false));
    bench.run(1000);
    assert!(
        !emulator(&bench).simulation.cnc.is_moving(),
        "let go: it stands"
    );
}

/// Jogs the axis, then the window loses the focus. The axis stops although the release never
/// arrives.
fn ends_without_focus(hold: impl Fn(&Bench)) {
    let mut bench = Bench::new();
    bench.click("Jog mode");
    hold(&bench);
    for _ in 0..20 {
        bench.run(50);
    }
    let moves = |bench: &Bench| bench.kernel.emulator().simulation.cnc.is_moving();
    assert!(moves(&bench), "held: the axis moves");
    bench.harness.input_mut().focused = false;
    bench.run(1000);
    assert!(!moves(&bench), "nobody sees whether it is held");
    let stood = bench.kernel.emulator().simulation.cnc.pulses();
    bench.harness.input_mut().focused = true;
    bench.run(1000);
    let stands = bench.kernel.emulator().simulation.cnc.pulses();
    assert_eq!(stands, stood, "nor does it go on by itself");
}

#[test]
fn a_held_jog_key_comes_up_when_the_window_loses_the_focus() {
    ends_without_focus(|bench| {
        let control = egui::Modifiers::CTRL;
        bench
            .harness
            .key_down_modifiers(control, egui::Key::ArrowLeft);
    });
    ends_without_focus(|bench| {
        let place = bench
            .harness
            .get_by_label("Z axis, arrow left")
            .rect()
            .center();
        bench.harness.event(egui::Event::PointerMoved(place));
        bench.harness.event(egui::Event::PointerButton {
            pos: place,
            button: egui::PointerButton::Primary,
            pressed: true,
            modifiers: egui::Modifiers::default(),
        });
    });
}

#[test]
fn an_emergency_stop_that_knows_the_place_of_the_slides_says_it() {
    let mut bench = Bench::new();
    bench.click("Emergency stop");
    let line = |bench: &Bench, text: &str| bench.harness.query_by_label_contains(text).is_some();
    assert!(line(&bench, "press it again to release"));
    let mut picture = bench.kernel.snapshot();
    let place = "machine coordinates X 1.000 Z -2.000 by the board's count, uncertain: the \
                 drives were without power";
    picture.alarm = picture
        .alarm
        .map(|alarm| alarm.because(gsk_messages::say::as_written(place)));
    bench.console.pictures.force_push(picture);
    bench.harness.step();
    bench.harness.step();
    assert!(line(&bench, "207: ") && line(&bench, place));
}

#[test]
fn pc_keys_press_panel_keys() {
    let mut bench = Bench::new();
    bench
        .harness
        .key_press_modifiers(egui::Modifiers::CTRL, egui::Key::Num2);
    bench.run(300);
    bench.lcd_shows("自动方式");
    bench.harness.key_press(egui::Key::F5);
    bench.run(300);
    bench.lcd_shows("外部信息");
    bench.harness.get_by_label("Keys").click();
    bench.run(10);
    let map = bench.harness.query_by_label("PC keyboard and panel keys");
    assert!(map.is_some());
}

#[test]
fn escape_closes_a_menu_and_is_reset_at_once_only_while_something_may_be_stopped() {
    let mut bench = Bench::new();
    let escape = |bench: &mut Bench| {
        click(bench, "Views");
        assert!(bench.harness.query_by_label_contains("Fault").is_some());
        bench.harness.key_down(egui::Key::Escape);
        bench.run(40);
        assert!(bench.harness.query_by_label_contains("Fault").is_none());
        let pressed = bench.kernel.snapshot().pressed.contains(&Key::Reset);
        bench.harness.key_up(egui::Key::Escape);
        bench.run(100);
        pressed
    };
    assert!(!escape(&mut bench), "nothing moves");
    bench.harness.key_down(egui::Key::Escape);
    bench.run(40);
    assert!(bench.kernel.snapshot().pressed.contains(&Key::Reset));
    bench.harness.key_up(egui::Key::Escape);
    bench.open("01-stepped-shaft.CNC");
    bench.click("Automatic mode");
    bench.click("Cycle start");
    assert_eq!(bench.kernel.snapshot().run, RunState::Run);
    assert!(escape(&mut bench), "a program runs");
    assert_eq!(bench.kernel.snapshot().run, RunState::Reset);
}

#[test]
fn a_program_that_waits_says_for_what_and_in_which_block() {
    let folder = crate::common::folder::Folder::new("waits");
    folder.write("waits.CNC", "O0007\nG00 U-1\nT0202\nM30\n");
    let mut bench = Bench::new();
    bench.open(folder.0.join("waits.CNC").to_str().unwrap());
    let blocked = Command::Fault(Fault::TurretBlocked, true);
    bench.console.send(blocked);
    bench.click("Automatic mode");
    bench.click("Cycle start");
    bench.run(300);
    let named = |bench: &Bench| says(bench, "O0007 line 3, waiting for: FIN (G4.3) of T02");
    assert!(!named(&bench), "a tool change takes its time");
    bench.click("Feed hold");
    assert!(named(&bench), "{}", bench.lcd());
    assert!(says(&bench, ", then cycle start after a feed hold"));
}

#[test]
fn f1_explains_what_the_mouse_points_at() {
    let mut bench = Bench::new();
    let start = bench.harness.get_by_label("Cycle start").rect().center();
    bench.harness.hover_at(start);
    bench.run(10);
    bench.harness.key_press(egui::Key::F1);
    bench.run(10);
    let shown = |bench: &Bench, text: &str| bench.harness.query_by_label_contains(text).is_some();
    assert!(shown(&bench, "key CS  Cycle start"));
    assert!(shown(&bench, "Contact: X25.0"));
    // A second F1 closes the help.
    bench.harness.key_press(egui::Key::F1);
    bench.run(10);
    assert!(!shown(&bench, "key CS  Cycle start"));
}

#[test]
fn a_key_that_is_to_be_explained_does_nothing_unless_it_stops() {
    let mut bench = Bench::new();
    bench.harness.get_by_label("Help F1").click();
    bench.run(10);
    bench.harness.get_by_label("Explain").click();
    bench.run(10);
    bench.click("Automatic mode");
    bench.run(300);
    let shown = |bench: &Bench, text: &str| bench.harness.query_by_label_contains(text).is_some();
    assert!(shown(&bench, "key AUTO  Automatic mode"));
    bench.lcd_shows("录入方式");
    bench.click("Emergency stop");
    bench.run(300);
    assert!(shown(&bench, "key ESTOP  Emergency stop"));
    // The help no longer explains presses after it has been closed and opened again.
    for _ in 0..2 {
        bench.harness.get_by_label("Help F1").click();
        bench.run(10);
    }
    bench.click("Automatic mode");
    bench.run(300);
    bench.lcd_shows("自动方式");
    assert!(
        bench
            .kernel
            .snapshot()
            .pressed
            .contains(&Key::EmergencyStop)
    );
}

#[test]
fn every_machine_key_has_its_contact() {
    for row in &KEYS {
        if let KeyRole::Machine(bit) = row.role {
            assert!(
                (20..=26).contains(&bit.byte),
                "{} has X{}",
                row.id,
                bit.byte
            );
        }
    }
}

#[test]
fn the_line_below_the_panel_says_where_and_why_of_an_alarm() {
    let mut bench = Bench::new();
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
fn a_handwheel_that_moves_nothing_says_why() {
    let mut bench = Bench::new();
    bench.click("Step or handwheel mode");
    bench.lcd_shows("单步方式");
    bench.harness.key_press(egui::Key::CloseBracket);
    bench.run(200);
    let why = "step mode (001.3 = 0)";
    assert!(bench.harness.query_by_label_contains(why).is_some());

    let mut setup = Setup::default();
    setup.memory.parameters.set_bit(1, 3, true).unwrap();
    let mut bench = Bench::with(setup);
    bench.click("Step or handwheel mode");
    bench.lcd_shows("手轮方式");
    let before = bench.shown_u();
    bench.harness.key_press(egui::Key::CloseBracket);
    bench.run(500);
    assert_ne!(bench.shown_u(), before, "{}", bench.lcd());
    assert!(bench.harness.query_by_label_contains(why).is_none());
}

/// Whether the window shows a text.
fn says(bench: &Bench, text: &str) -> bool {
    let mut all = bench.harness.query_all_by_label_contains(text);
    all.next().is_some()
}

/// Presses or releases a mouse button on a key.
fn mouse(bench: &mut Bench, name: &str, button: egui::PointerButton, pressed: bool) {
    let pos = bench.harness.get_by_label(name).rect().center();
    bench.harness.event(egui::Event::PointerMoved(pos));
    bench.harness.event(egui::Event::PointerButton {
        pos,
        button,
        pressed,
        modifiers: egui::Modifiers::default(),
    });
    bench.run(100);
}

#[test]
fn a_right_click_keeps_overtravel_release_for_one_axis_key_and_shows_it() {
    let mut bench = Bench::new();
    bench.click("Jog mode");
    let (left, right) = (egui::PointerButton::Primary, egui::PointerButton::Secondary);
    let held = |bench: &Bench| {
        let panel = &bench.kernel.emulator().panel;
        [Key::OvertravelRelease, Key::ZLeft].map(|key| panel.is_held(key))
    };
    let kept = "is kept for the next key";
    mouse(&mut bench, "Overtravel release", right, true);
    mouse(&mut bench, "Overtravel release", right, false);
    assert_eq!(held(&bench), [false, false], "nothing is held for nothing");
    assert!(says(&bench, kept));
    let ring = bench.harness.get_by_label("Overtravel release").value();
    assert_eq!(ring.as_deref(), Some("kept for the next key"));
    mouse(&mut bench, "Z axis, arrow left", left, true);
    assert_eq!(held(&bench), [true, true]);
    assert!(says(&bench, kept));
    mouse(&mut bench, "Z axis, arrow left", left, false);
    assert_eq!(held(&bench), [false, false]);
    assert!(!says(&bench, kept));
    mouse(&mut bench, "Z axis, arrow left", left, true);
    assert_eq!(held(&bench), [false, true], "for one use");
    mouse(&mut bench, "Z axis, arrow left", left, false);

    mouse(&mut bench, "Z axis, arrow left", right, true);
    assert_eq!(held(&bench), [false, false]);
    assert!(says(&bench, "this key makes the machine move"));
}

#[test]
fn every_window_of_a_linked_panel_says_real_motion_with_the_boards_state() {
    let mut bench = Bench::new();
    let windows = Windows::of(&bench);
    let badge = "REAL MOTION / 真实机床";
    assert!(!says(&bench, badge));
    assert_eq!(bench.harness.state().title(), "GSK980TD");
    let mut picture = bench.kernel.snapshot();
    picture.board = Some(LinkState::Ready);
    bench.console.pictures.force_push(picture);
    let shift = egui::Modifiers::SHIFT;
    for (open, key) in [egui::Key::F2, egui::Key::F3, egui::Key::F5]
        .into_iter()
        .enumerate()
    {
        bench.harness.key_press_modifiers(shift, key);
        for _ in 0..3 {
            bench.harness.step();
        }
        let shown = windows.look(&mut bench);
        assert_eq!(shown.len(), open + 1);
        for window in &shown {
            assert!(window.label(badge).is_some(), "{:?}", window.labels);
            assert!(window.label("board: ready").is_some());
        }
        assert!(says(&bench, badge));
    }
    assert!(bench.harness.state().title().contains("REAL MOTION"));
}

#[test]
fn after_the_alarm_of_a_program_the_hint_does_not_ask_for_another() {
    let mut bench = Bench::new();
    assert!(says(&bench, "Open a program, press"));
    bench.console.send(Command::Open(Box::new(Opened {
        name: "wrong.CNC".to_owned(),
        path: None,
        storing: Storing::Ask,
        program: Program::new("O1\nG77\nM30\n"),
        subprograms: Vec::new(),
    })));
    bench.run(100);
    for key in ["Automatic mode", "Cycle start", "Reset"] {
        bench.click(key);
    }
    bench.run(500);
    assert!(says(&bench, "Press [自动] AUTO, then [运行] START"));
    assert!(!says(&bench, "Open a program, press"));
}

#[test]
fn a_burst_of_keys_within_one_picture_arrives_whole() {
    let mut bench = Bench::new();
    bench.click("Edit mode");
    bench.click("Program pages");
    let burst = |bench: &mut Bench, text: &str| {
        for character in text.chars() {
            let name = character.to_string();
            let key = match character {
                ';' => egui::Key::Semicolon,
                '-' => egui::Key::Minus,
                '.' => egui::Key::Period,
                _ => egui::Key::from_name(&name).unwrap(),
            };
            for pressed in [true, false] {
                bench.harness.event(egui::Event::Key {
                    key,
                    physical_key: None,
                    pressed,
                    repeat: false,
                    modifiers: egui::Modifiers::default(),
                });
            }
        }
        bench.run(3000);
    };
    burst(&mut bench, "O0007;");
    let text = "G01X11.5Z-1.25F120;G00X31.125Z1.5S600M03;";
    burst(&mut bench, text);
    bench.click("Automatic mode");
    let programs = bench.kernel.emulator().simulation.cnc.programs();
    let program = programs.get(ProgramId::Stored(7)).unwrap();
    let stored: String = program.text().split_whitespace().collect();
    assert!(stored.starts_with(&format!("O0007;{text}")), "{stored}");
}

/// Clicks a button of the window by its text.
fn click(bench: &mut Bench, words: &str) {
    bench.harness.get_by_label(words).click();
    bench.run(20);
}

pub fn ask_to_close(bench: &mut Bench) -> Vec<ViewportCommand> {
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
fn closing_asks_while_a_typed_text_is_not_saved() {
    let mut bench = Bench::new();
    let shift = egui::Modifiers::SHIFT;
    bench.harness.key_press_modifiers(shift, egui::Key::F11);
    bench.run(1);
    assert_eq!(ask_to_close(&mut bench), [], "nothing is typed");
    bench.harness.get_by_label("Program text").focus();
    bench.run(1);
    let typed = egui::Event::Text("G00 X10".to_owned());
    bench.harness.event(typed);
    bench.run(1);
    let asked = ask_to_close(&mut bench);
    assert!(asked.contains(&ViewportCommand::CancelClose), "{asked:?}");
    assert!(says(&bench, "The program text is not saved"));
    bench.harness.get_by_label("Close without saving").click();
    bench.harness.step();
    let commands = &bench.harness.output().viewport_output[&ViewportId::ROOT].commands;
    assert!(commands.contains(&ViewportCommand::Close), "{commands:?}");
}

#[test]
fn closing_asks_while_a_program_runs_or_is_held() {
    let mut bench = Bench::new();
    assert_eq!(ask_to_close(&mut bench), [], "nothing runs");
    bench.open("01-stepped-shaft.CNC");
    bench.click("Automatic mode");
    bench.click("Cycle start");
    for (key, question) in [
        ("Single block", "A program is running"),
        ("Feed hold", "A program is held"),
    ] {
        bench.click(key);
        let asked = ask_to_close(&mut bench);
        assert!(asked.contains(&ViewportCommand::CancelClose), "{asked:?}");
        assert!(says(&bench, question), "{}", bench.lcd());
        click(&mut bench, "Do not close");
        assert!(!says(&bench, question));
    }
    ask_to_close(&mut bench);
    bench.harness.get_by_label("Stop and close").click();
    bench.harness.step();
    let commands = &bench.harness.output().viewport_output[&ViewportId::ROOT].commands;
    assert!(commands.contains(&ViewportCommand::Close), "{commands:?}");
    let again = ask_to_close(&mut bench);
    assert!(!again.contains(&ViewportCommand::CancelClose), "{again:?}");
}

#[test]
fn an_opened_program_is_stored_can_be_edited_and_never_overwrites_another() {
    let mut bench = Bench::new();
    click(&mut bench, "Samples");
    let entry = bench.harness.get_by_label_contains("stepped shaft");
    entry.click();
    let stored = "O0001, 4:";
    let mut waited = 0;
    while !says(&bench, stored) {
        std::thread::sleep(std::time::Duration::from_millis(10));
        bench.run(1);
        waited += 1;
        assert!(waited < 1000, "not opened");
    }
    click(&mut bench, "中文");
    assert!(says(&bench, "把刀, X "));
    click(&mut bench, "English");

    let text = |bench: &Bench| {
        let programs = bench.kernel.emulator().simulation.cnc.programs();
        let program = programs.get(ProgramId::Stored(1));
        program
            .map(|program| program.text().to_owned())
            .unwrap_or_default()
    };
    let before = text(&bench);
    bench.click("Edit mode");
    bench.click("Program pages");
    for key in ["Cursor down", "Address N", "Digit 7", "Automatic mode"] {
        bench.click(key);
    }
    let edited = text(&bench);
    assert_ne!(edited, before, "typing changes it");

    // The file is opened again: the edited program is not discarded.
    bench.open("01-stepped-shaft.CNC");
    let question = "O0001 is in the memory already";
    let waits = (0..1000).any(|_| {
        std::thread::sleep(std::time::Duration::from_millis(10));
        bench.run(1);
        says(&bench, question)
    });
    assert!(waits && text(&bench) == edited);
    click(&mut bench, "Keep it, only run the file");
    bench.run(50);
    assert!(says(
        &bench,
        "It is not stored: the memory keeps its own O0001"
    ));
    assert_eq!(text(&bench), edited);
    let programs = bench.kernel.emulator().simulation.cnc.programs();
    assert_eq!(programs.current(), Some(ProgramId::External));
}

#[test]
fn an_opened_program_says_at_once_what_it_does() {
    let mut bench = Bench::new();
    let waits_for = |bench: &mut Bench, words: &str| {
        (0..1000).any(|_| {
            std::thread::sleep(std::time::Duration::from_millis(10));
            bench.run(1);
            says(bench, words)
        })
    };
    bench.open("03-grooved-pin.CNC");
    let line = ", 2 tools, X 24–36, Z -45–2, no alarm";
    assert!(waits_for(&mut bench, line));
    bench.open("faulty/02-no-feed.CNC");
    let failing = ": P/S 011 ";
    assert!(waits_for(&mut bench, failing));
    assert!(says(&bench, ", line "));
    // The summary disappears when another program is selected.
    bench.click("Edit mode");
    bench.click("Program pages");
    for key in ["Address O", "Digit 3", "Cursor down"] {
        bench.click(key);
    }
    bench.run(500);
    assert!(!says(&bench, failing), "{}", bench.lcd());
}

#[test]
fn what_helps_against_an_alarm_is_shown_upon_the_lcd_and_on_no_key() {
    let mut bench = Bench::new();
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
    let tip = bench.harness.get_by_label_contains("Way out: ").rect();
    let lcd = bench.harness.get_by_label("LCD").rect();
    assert!(lcd.expand(1.0).contains_rect(tip), "{tip:?} {lcd:?}");
}

#[test]
fn a_key_that_does_nothing_says_why_until_one_acts() {
    let mut bench = Bench::new();
    for (mode, key, english) in [
        (
            "Jog mode",
            "Cycle start",
            "cycle start acts in AUTO and MDI",
        ),
        (
            "Automatic mode",
            "Z axis, arrow left",
            "the axis keys act in",
        ),
        ("MDI mode", "Spindle forward", "manual and zero modes"),
        ("MDI mode", "Cycle start", "no MDI block is keyed in"),
    ] {
        bench.click(mode);
        bench.run(300);
        bench.click(key);
        bench.run(300);
        assert!(says(&bench, english), "{key}: {}", bench.lcd());
        bench.click("Position pages");
        bench.run(300);
        assert!(!says(&bench, english), "{key}");
    }
}

#[test]
fn a_message_of_the_ladder_stands_on_the_line_below_the_panel() {
    let mut bench = Bench::new();
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
