//! The window without a display, operated through its accessible names as a screen reader
//! does: names, mouse, PC keys, and the text of the LCD.

use gsk_host::kernel::{Command, OpenedProgram, StorePolicy};

use crate::common::WindowBench;
use crate::common::windows::ViewWindows;
use egui::{ViewportCommand, ViewportEvent, ViewportId};
use egui_kittest::kittest::Queryable;
use gsk_core::command::ProgramId;
use gsk_core::machine::LatheFault;
use gsk_core::operation::RunState;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_link::LinkState;
use gsk_panel::keys::{KEYS, Key, KeyRole};

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

#[test]
fn every_key_has_a_unique_name() {
    let bench = WindowBench::new();
    for row in &KEYS {
        let count = bench.harness.query_all_by_label(row.name_en).count();
        assert_eq!(count, 1, "{} by its name «{}»", row.id, row.name_en);
    }
}

#[test]
fn machine_keys_reach_their_contact_and_light_their_lamp() {
    let mut bench = WindowBench::new();
    for (name, mode) in [
        ("Jog mode", "手动方式"),
        ("Edit mode", "编辑方式"),
        ("MDI mode", "录入方式"),
        ("Automatic mode", "自动方式"),
    ] {
        bench.click(name);
        bench.assert_lcd_contains(mode);
    }
    let lamp = Key::from_id("SBK").and_then(|key| key.row().lamp).unwrap();
    let lit = |bench: &WindowBench| lamp.is_set_in(&bench.kernel.emulator().lamps());
    assert!(!lit(&bench));
    bench.click("Single block");
    assert!(lit(&bench));
}

#[test]
fn a_held_mouse_button_holds_the_key() {
    let mut bench = WindowBench::new();
    bench.click("Jog mode");
    let center = bench
        .harness
        .get_by_label("Z axis, arrow left")
        .rect()
        .center();
    let button = |pressed| egui::Event::PointerButton {
        pos: center,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::default(),
    };
    bench.harness.event(egui::Event::PointerMoved(center));
    bench.harness.event(button(true));
    bench.run(50);
    let emulator = |bench: &WindowBench| bench.kernel.emulator().clone();
    for _ in 0..20 {
        bench.run(50);
    }
    assert!(emulator(&bench).cnc().is_moving(), "held: the axis moves");
    bench.harness.event(button(false));
    bench.run(1000);
    assert!(!emulator(&bench).cnc().is_moving(), "let go: it stands");
}

/// Jogs the axis, then the window loses the focus. The axis stops although the release never
/// arrives.
fn assert_stops_without_focus(hold_key: impl Fn(&WindowBench)) {
    let mut bench = WindowBench::new();
    bench.click("Jog mode");
    hold_key(&bench);
    for _ in 0..20 {
        bench.run(50);
    }
    let is_moving = |bench: &WindowBench| bench.kernel.emulator().cnc().is_moving();
    assert!(is_moving(&bench), "held: the axis moves");
    bench.harness.input_mut().focused = false;
    bench.run(1000);
    assert!(!is_moving(&bench), "nobody sees whether it is held");
    let stopped_pulses = bench.kernel.emulator().cnc().pulses();
    bench.harness.input_mut().focused = true;
    bench.run(1000);
    let current_pulses = bench.kernel.emulator().cnc().pulses();
    assert_eq!(
        current_pulses, stopped_pulses,
        "nor does it go on by itself"
    );
}

#[test]
fn a_held_jog_key_comes_up_when_the_window_loses_the_focus() {
    assert_stops_without_focus(|bench| {
        let control = egui::Modifiers::CTRL;
        bench
            .harness
            .key_down_modifiers(control, egui::Key::ArrowLeft);
    });
    assert_stops_without_focus(|bench| {
        let center = bench
            .harness
            .get_by_label("Z axis, arrow left")
            .rect()
            .center();
        bench.harness.event(egui::Event::PointerMoved(center));
        bench.harness.event(egui::Event::PointerButton {
            pos: center,
            button: egui::PointerButton::Primary,
            pressed: true,
            modifiers: egui::Modifiers::default(),
        });
    });
}

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
fn pc_keys_press_panel_keys() {
    let mut bench = WindowBench::new();
    bench
        .harness
        .key_press_modifiers(egui::Modifiers::CTRL, egui::Key::Num2);
    bench.run(300);
    bench.assert_lcd_contains("自动方式");
    bench.harness.key_press(egui::Key::F5);
    bench.run(300);
    bench.assert_lcd_contains("外部信息");
    bench.harness.get_by_label("Keys").click();
    bench.run(10);
    let map = bench.harness.query_by_label("PC keyboard and panel keys");
    assert!(map.is_some());
}

#[test]
fn escape_closes_a_menu_and_also_resets_only_during_motion() {
    let mut bench = WindowBench::new();
    let escape = |bench: &mut WindowBench| {
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
    assert_eq!(bench.kernel.snapshot().run_state, RunState::Run);
    assert!(escape(&mut bench), "a program runs");
    assert_eq!(bench.kernel.snapshot().run_state, RunState::Reset);
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
fn f1_explains_the_key_under_the_mouse() {
    let mut bench = WindowBench::new();
    let start = bench.harness.get_by_label("Cycle start").rect().center();
    bench.harness.hover_at(start);
    bench.run(10);
    bench.harness.key_press(egui::Key::F1);
    bench.run(10);
    let is_in_help =
        |bench: &WindowBench, text: &str| bench.harness.query_by_label_contains(text).is_some();
    assert!(is_in_help(&bench, "key CS  Cycle start"));
    assert!(is_in_help(&bench, "Contact: X25.0"));
    // A second F1 closes the help.
    bench.harness.key_press(egui::Key::F1);
    bench.run(10);
    assert!(!is_in_help(&bench, "key CS  Cycle start"));
}

#[test]
fn an_explained_key_is_not_pressed_unless_it_stops() {
    let mut bench = WindowBench::new();
    bench.harness.get_by_label("Help F1").click();
    bench.run(10);
    bench.harness.get_by_label("Explain").click();
    bench.run(10);
    bench.click("Automatic mode");
    bench.run(300);
    let is_in_help =
        |bench: &WindowBench, text: &str| bench.harness.query_by_label_contains(text).is_some();
    assert!(is_in_help(&bench, "key AUTO  Automatic mode"));
    bench.assert_lcd_contains("录入方式");
    bench.click("Emergency stop");
    bench.run(300);
    assert!(is_in_help(&bench, "key ESTOP  Emergency stop"));
    // The help no longer explains presses after it has been closed and opened again.
    for _ in 0..2 {
        bench.harness.get_by_label("Help F1").click();
        bench.run(10);
    }
    bench.click("Automatic mode");
    bench.run(300);
    bench.assert_lcd_contains("自动方式");
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

/// Whether the window shows a text.
fn is_shown(bench: &WindowBench, text: &str) -> bool {
    let mut all = bench.harness.query_all_by_label_contains(text);
    all.next().is_some()
}

/// Presses or releases a mouse button on a key.
fn mouse_button(bench: &mut WindowBench, name: &str, button: egui::PointerButton, pressed: bool) {
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
fn a_right_click_latches_overtravel_release_for_one_axis_key() {
    let mut bench = WindowBench::new();
    bench.click("Jog mode");
    let (left, right) = (egui::PointerButton::Primary, egui::PointerButton::Secondary);
    let held_keys = |bench: &WindowBench| {
        let panel = bench.kernel.emulator().panel();
        [Key::OvertravelRelease, Key::ZLeft].map(|key| panel.is_held(key))
    };
    let latched_text = "is kept for the next key";
    mouse_button(&mut bench, "Overtravel release", right, true);
    mouse_button(&mut bench, "Overtravel release", right, false);
    assert_eq!(
        held_keys(&bench),
        [false, false],
        "nothing is held for nothing"
    );
    assert!(is_shown(&bench, latched_text));
    let ring = bench.harness.get_by_label("Overtravel release").value();
    assert_eq!(ring.as_deref(), Some("kept for the next key"));
    mouse_button(&mut bench, "Z axis, arrow left", left, true);
    assert_eq!(held_keys(&bench), [true, true]);
    assert!(is_shown(&bench, latched_text));
    mouse_button(&mut bench, "Z axis, arrow left", left, false);
    assert_eq!(held_keys(&bench), [false, false]);
    assert!(!is_shown(&bench, latched_text));
    mouse_button(&mut bench, "Z axis, arrow left", left, true);
    assert_eq!(held_keys(&bench), [false, true], "for one use");
    mouse_button(&mut bench, "Z axis, arrow left", left, false);

    mouse_button(&mut bench, "Z axis, arrow left", right, true);
    assert_eq!(held_keys(&bench), [false, false]);
    assert!(is_shown(&bench, "this key makes the machine move"));
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
    assert!(is_shown(
        &bench,
        "Press [Auto 自动], then [Cycle start 运行]"
    ));
    assert!(!is_shown(&bench, "Open a program, press"));
}

#[test]
fn a_burst_of_keys_within_one_frame_arrives_complete() {
    let mut bench = WindowBench::new();
    bench.click("Edit mode");
    bench.click("Program pages");
    let type_burst = |bench: &mut WindowBench, text: &str| {
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
    type_burst(&mut bench, "O0007;");
    let text = "G01X11.5Z-1.25F120;G00X31.125Z1.5S600M03;";
    type_burst(&mut bench, text);
    bench.click("Automatic mode");
    let programs = bench.kernel.emulator().cnc().programs();
    let program = programs.get(ProgramId::Stored(7)).unwrap();
    let stored: String = program.text().split_whitespace().collect();
    assert!(stored.starts_with(&format!("O0007;{text}")), "{stored}");
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
        "It is not stored: the memory keeps its own O0001"
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
