//! The questions of the first start, answered with mouse and keyboard.

use gsk_window::layout::WindowLayout;
use gsk_window::view::ViewId;

use crate::common::WindowBench;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use gsk_core::machine::LatheFault;
use gsk_core::model::ModelId;
use gsk_core::operation::RunState;
use gsk_host::kernel::Command;
use gsk_messages::Language;
use gsk_panel::keys::Key as PanelKey;

fn open_questions() -> WindowBench {
    let mut bench = WindowBench::new();
    let window = bench.harness.state_mut();
    window.set_model(ModelId::Gsk980td, true);
    window.open_first_start();
    bench.run(50);
    bench
}

fn click(bench: &mut WindowBench, label: &str) {
    bench.harness.get_by_label(label).click();
    bench.run(50);
    bench.run(50);
}

#[test]
fn each_purpose_opens_its_layout() {
    for (purpose, layout, views) in [
        (
            "I am learning",
            WindowLayout::Learner,
            &[ViewId::Machine, ViewId::Lesson][..],
        ),
        (
            "I check programs",
            WindowLayout::Programmer,
            &[ViewId::Program, ViewId::Machine],
        ),
        ("I own a lathe", WindowLayout::Panel, &[ViewId::Link]),
    ] {
        let mut bench = open_questions();
        assert!(bench.harness.query_by_label("Cycle start").is_none());
        click(&mut bench, "Begin");
        assert!(
            bench
                .harness
                .query_by_label("What do you want to do?")
                .is_some(),
            "without an answer it does not begin"
        );
        let missing = "Still missing: choose above what you want to do";
        assert!(bench.harness.query_by_label(missing).is_some());
        click(&mut bench, purpose);
        click(&mut bench, "Begin");
        assert!(bench.harness.query_by_label("Cycle start").is_some());
        let window = bench.harness.state_mut();
        let layouts = &window.settings().layouts;
        assert_eq!(layouts.current(), layout, "{purpose}");
        for view in views {
            assert!(layouts.docked().contains(view), "{purpose}: {view:?}");
        }
        assert_eq!(
            window.take_requested_model(),
            None,
            "the control stays as it is"
        );
    }
}

/// Runs until the tool is in the bar; false if that takes too long.
fn cuts(bench: &mut WindowBench) -> bool {
    (0..600).any(|_| {
        std::thread::sleep(core::time::Duration::from_millis(5));
        bench.run(100);
        let cnc = bench.kernel.emulator().cnc();
        let position = cnc.position_machine() - cnc.frame().zero;
        cnc.run_state() == RunState::Run && position.x < 27.0 && position.z < 2.0
    })
}

#[test]
fn a_sample_card_begins_anew_after_a_reset_in_the_cut_and_after_a_crash() {
    let mut bench = open_questions();
    for label in ["I am learning", "Begin", "stepped shaft"] {
        click(&mut bench, label);
    }
    assert!(cuts(&mut bench), "{}", bench.lcd_of_kernel());
    bench.run(5000);
    bench.console.send(Command::Tap(PanelKey::Reset));
    bench.run(500);
    // The tool is in the bar: rapid into it.
    for (key, down) in [(PanelKey::Jog, true), (PanelKey::Jog, false)] {
        bench.console.send(Command::Key { key, down });
        bench.run(100);
    }
    for key in [PanelKey::Rapid, PanelKey::XUp] {
        bench.console.send(Command::Key { key, down: true });
        bench.run(2000);
        bench.console.send(Command::Key { key, down: false });
        bench.run(100);
    }
    let crashed = bench.harness.query_by_label("Free the lathe").is_some();
    assert!(crashed, "{}", bench.lcd_of_kernel());
    let lathe = bench.kernel.emulator().lathe();
    assert!(lathe.has_fault(LatheFault::DriveX), "only X has moved");
    assert!(!lathe.has_fault(LatheFault::DriveZ));
    let show = |bench: &mut WindowBench| bench.click("Lessons");
    if bench.harness.query_by_label("stepped shaft").is_none() {
        show(&mut bench);
    }
    for label in ["stepped shaft", "bushing (001.4 = 1)"] {
        click(&mut bench, label);
        for _ in 0..300 {
            std::thread::sleep(core::time::Duration::from_millis(2));
            bench.run(100);
        }
        let cnc = bench.kernel.emulator().cnc();
        assert_eq!(cnc.run_state(), RunState::Run, "{}", bench.lcd_of_kernel());
        assert_eq!(cnc.alarms(), [], "{label}");
        assert!(bench.harness.query_by_label_contains("is free").is_none());
        assert!(bench.harness.query_by_label("Free the lathe").is_none());
        bench.console.send(Command::Tap(PanelKey::Reset));
        bench.run(500);
    }
}

#[test]
fn three_clicks_lead_from_the_first_start_to_a_cut() {
    let mut bench = open_questions();
    let clicks = ["I am learning", "Begin", "stepped shaft"];
    for label in clicks {
        click(&mut bench, label);
    }
    // Facing begins at X58 in a bar of 54 mm.
    assert!(cuts(&mut bench), "{}", bench.lcd_of_kernel());
    assert!(bench.harness.query_by_label("Machine picture").is_some());
}

#[test]
fn language_and_control_model_are_applied() {
    let mut bench = open_questions();
    click(&mut bench, "NC-B08");
    bench
        .harness
        .query_all_by_label("中文")
        .last()
        .expect("a language")
        .click();
    bench.run(50);
    bench.run(50);
    assert_eq!(bench.harness.state().settings().language, Language::Zh);
    click(&mut bench, "我要学习");
    click(&mut bench, "开始");
    let window = bench.harness.state_mut();
    assert_eq!(window.take_requested_model(), Some(ModelId::Ncb08));
}

#[test]
fn pc_keys_answer_and_do_not_reach_the_panel() {
    let mut bench = open_questions();
    let lcd_before = bench.lcd_of_kernel();
    for key in [Key::F3, Key::F7, Key::Enter] {
        bench.harness.key_press(key);
        bench.run(100);
    }
    assert_eq!(bench.lcd_of_kernel(), lcd_before, "no key of the panel");
    // From the language to the first purpose, and to its button.
    for _ in 0..2 {
        bench.harness.key_press(Key::Tab);
        bench.run(50);
    }
    bench.harness.key_press(Key::Space);
    bench.run(50);
    let can_begin = |bench: &WindowBench| bench.harness.query_by_label("Begin").is_some();
    assert!(can_begin(&bench));
    bench.harness.key_press(Key::Escape);
    bench.run(50);
    bench.run(50);
    assert!(bench.harness.query_by_label("Cycle start").is_some());
    assert!(!bench.harness.state().settings().first_start);
}

#[test]
fn the_menu_shows_the_questions_again_and_an_opened_view_ends_them() {
    let mut bench = WindowBench::new();
    click(&mut bench, "Layout");
    click(&mut bench, "First start…");
    assert!(
        bench
            .harness
            .query_by_label("What do you want to do?")
            .is_some()
    );
    bench.harness.key_press_modifiers(Modifiers::NONE, Key::F12);
    bench.run(100);
    assert!(
        bench
            .kernel
            .snapshot()
            .pressed
            .contains(&gsk_panel::keys::Key::EmergencyStop),
        "stops act everywhere"
    );
    click(&mut bench, "Lessons");
    assert!(bench.harness.query_by_label("Cycle start").is_some());
}
