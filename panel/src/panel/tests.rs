use gsk_core::model::ModelId;
use gsk_core::program::ProgramEditor;
use gsk_core::setup::Setup;
use gsk_core::units::Axis;
use gsk_core::units::Point;
use gsk_messages::Language;

use super::*;
use crate::emulator::{Emulator, WaitCondition};
use crate::pages::{PAGES, PageRow};

fn awake() -> Emulator {
    let mut emulator = Emulator::new(Setup::default());
    emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
    emulator
}

/// Presses a key too briefly for the ladder, so that only the display reacts.
fn tap(emulator: &mut Emulator, key: Key) {
    emulator.key_down(key);
    emulator.key_up(key);
    emulator.tick();
}

fn type_keys(emulator: &mut Emulator, text: &str) {
    for character in text.chars() {
        emulator.key(KeyEvent::Type(character));
    }
}

fn page(emulator: &Emulator) -> PageId {
    emulator.panel().page()
}

/// Returns the row of a page of the GSK980TD in the table of pages.
fn main_row(page: PageId) -> &'static PageRow {
    face_of(ModelId::Gsk980td).page(page).unwrap()
}

#[test]
fn a_walk_over_all_pages() {
    let mut emulator = awake();
    let mut seen = vec![page(&emulator)];
    for key in [
        Key::Position,
        Key::Program,
        Key::Offset,
        Key::Alarm,
        Key::Setting,
        Key::Setting,
        Key::Parameter,
        Key::Parameter,
        Key::Parameter,
        Key::Diagnosis,
        Key::Diagnosis,
        Key::Diagnosis,
        Key::Diagnosis,
        Key::Diagnosis,
    ] {
        tap(&mut emulator, key);
        let first = page(&emulator);
        seen.push(first);
        for _ in 0..8 {
            tap(&mut emulator, Key::PageDown);
            seen.push(page(&emulator));
            let [shown, opened] = [page(&emulator), first].map(main_row);
            assert_eq!(shown.key, opened.key);
            assert_eq!(shown.display, opened.display);
            let title = emulator.screen().row(0);
            assert!(
                title.starts_with(&page(&emulator).title().text(Language::Zh)),
                "{title}"
            );
        }
    }
    for row in &PAGES {
        assert!(seen.contains(&row.page), "{}", row.name);
    }
}

#[test]
fn page_keys_lead_back_to_the_first_page() {
    for row in &PAGES {
        let mut emulator = awake();
        emulator.show_page(row.page);
        tap(&mut emulator, Key::PageDown);
        tap(&mut emulator, Key::PageUp);
        assert_eq!(page(&emulator), row.page);
        tap(&mut emulator, Key::PageUp);
        tap(&mut emulator, Key::PageDown);
        assert_eq!(page(&emulator), row.page);
    }
}

#[test]
fn groups_remember_their_page_or_step_through_displays() {
    let mut emulator = awake();
    tap(&mut emulator, Key::PageUp);
    assert_eq!(page(&emulator), PageId::PosPrg);
    tap(&mut emulator, Key::Position);
    assert_eq!(page(&emulator), PageId::PosPrg, "the same key does nothing");
    tap(&mut emulator, Key::Setting);
    assert_eq!(page(&emulator), PageId::SetCode);
    tap(&mut emulator, Key::Setting);
    assert_eq!(page(&emulator), PageId::GraphPar);
    tap(&mut emulator, Key::Setting);
    assert_eq!(page(&emulator), PageId::SetCode);
    tap(&mut emulator, Key::Parameter);
    tap(&mut emulator, Key::Parameter);
    assert_eq!(page(&emulator), PageId::ParData);
    tap(&mut emulator, Key::Position);
    assert_eq!(page(&emulator), PageId::PosPrg, "last shown");
    tap(&mut emulator, Key::Parameter);
    assert_eq!(page(&emulator), PageId::ParBit, "first display");
}

#[test]
fn screens_of_a_list_come_before_the_next_page() {
    let mut emulator = awake();
    tap(&mut emulator, Key::Offset);
    let item = |emulator: &Emulator| emulator.panel().view().cursors.get(page(emulator)).item;
    for first in [8, 16, 24, 32] {
        tap(&mut emulator, Key::PageDown);
        assert_eq!((page(&emulator), item(&emulator)), (PageId::Oft, first));
    }
    tap(&mut emulator, Key::PageDown);
    assert_eq!((page(&emulator), item(&emulator)), (PageId::Macro, 0));
    tap(&mut emulator, Key::PageUp);
    assert_eq!((page(&emulator), item(&emulator)), (PageId::Oft, 32));
    emulator.show_page(PageId::PlcBits);
    tap(&mut emulator, Key::PageDown);
    assert_eq!(item(&emulator), 16);
    tap(&mut emulator, Key::PageDown);
    assert_eq!(item(&emulator), 30, "Y0 begins a screen");
    tap(&mut emulator, Key::PageUp);
    tap(&mut emulator, Key::PageUp);
    tap(&mut emulator, Key::PageUp);
    assert_eq!(pages::bit_item(item(&emulator)).to_string(), "R0992");
    tap(&mut emulator, Key::PageDown);
    assert_eq!(item(&emulator), 0);
    tap(&mut emulator, Key::Up);
    assert_eq!(pages::bit_item(item(&emulator)).to_string(), "R0999");
}

#[test]
fn editing_shows_the_program_page_only() {
    let mut emulator = awake();
    emulator.show_page(PageId::Dir);
    emulator.press(Key::Edit);
    assert_eq!(page(&emulator), PageId::Prg);
    emulator.show_page(PageId::PosRel);
    tap(&mut emulator, Key::Program);
    assert_eq!(page(&emulator), PageId::Prg);
    tap(&mut emulator, Key::PageDown);
    assert_eq!(page(&emulator), PageId::Prg);
}

#[test]
fn the_input_line_takes_twenty_characters_and_cancel_removes_one() {
    let mut emulator = awake();
    emulator.press(Key::Mdi);
    emulator.show_page(PageId::Mdi);
    type_keys(&mut emulator, "N0001");
    tap(&mut emulator, Key::Cancel);
    assert_eq!(emulator.panel().view().input, "N000");
    type_keys(&mut emulator, &"7".repeat(40));
    assert_eq!(emulator.panel().view().input.len(), INPUT_LENGTH);
    tap(&mut emulator, Key::Reset);
    assert!(emulator.panel().view().input.is_empty());
    type_keys(&mut emulator, "x1");
    assert_eq!(emulator.panel().view().input, "X1");
    emulator.press(Key::Auto);
    assert!(
        emulator.panel().view().input.is_empty(),
        "a mode change clears"
    );
    type_keys(&mut emulator, "X1");
    assert!(
        emulator.panel().view().input.is_empty(),
        "MDI reads in MDI only"
    );
}

#[test]
fn words_of_a_block_are_entered_in_mdi() {
    let mut emulator = awake();
    emulator.press(Key::Mdi);
    emulator.show_page(PageId::Mdi);
    type_keys(&mut emulator, "G50");
    tap(&mut emulator, Key::Input);
    type_keys(&mut emulator, "X50");
    tap(&mut emulator, Key::Input);
    assert_eq!(emulator.cnc().mdi_block().text(), "G50 X50");
    emulator.press(Key::CycleStart);
    emulator.run_until(&WaitCondition::Stopped, 1000);
    assert!((emulator.cnc().position_absolute().x - 25.0).abs() < 1e-9);
}

#[test]
fn compound_keys_alternate_without_another_key_between() {
    let mut emulator = awake();
    emulator.press(Key::Mdi);
    emulator.show_page(PageId::Mdi);
    let mut after = |key: Key| {
        tap(&mut emulator, key);
        emulator.panel().view().input.clone()
    };
    assert_eq!(after(Key::P), "P");
    assert_eq!(after(Key::P), "Q");
    assert_eq!(after(Key::P), "P");
    assert_eq!(after(Key::U), "PU");
    assert_eq!(after(Key::U), "PD");
    assert_eq!(after(Key::Digit1), "PD1");
    assert_eq!(after(Key::U), "PD1U");
    assert_eq!(after(Key::Cancel), "PD1");
    assert_eq!(after(Key::U), "PD1U");
    tap(&mut emulator, Key::Reset);
    type_keys(&mut emulator, "PP");
    assert_eq!(emulator.panel().view().input, "PP", "typed letters stay");
}

#[test]
fn relative_coordinates_are_cleared_with_the_flashing_letter() {
    let mut emulator = awake();
    let relative = |emulator: &Emulator| emulator.cnc().position_relative();
    assert!(relative(&emulator).x != 0.0 && relative(&emulator).z != 0.0);
    tap(&mut emulator, Key::U);
    assert_eq!(emulator.panel().view().flashing, Some(Axis::X));
    tap(&mut emulator, Key::Cancel);
    assert_eq!(relative(&emulator).x, 0.0);
    assert!(relative(&emulator).z != 0.0);
    assert_eq!(emulator.panel().view().flashing, None);
    tap(&mut emulator, Key::W);
    tap(&mut emulator, Key::O);
    tap(&mut emulator, Key::Cancel);
    assert!(
        relative(&emulator).z != 0.0,
        "another key ends the flashing"
    );
    emulator.key_down(Key::Cancel);
    tap(&mut emulator, Key::W);
    emulator.key_up(Key::Cancel);
    assert_eq!(relative(&emulator).z, 0.0, "as a chord");
}

#[test]
fn brightness_changes_while_a_letter_flashes() {
    let mut emulator = awake();
    tap(&mut emulator, Key::Up);
    assert_eq!(emulator.panel().view().brightness, 8);
    tap(&mut emulator, Key::U);
    tap(&mut emulator, Key::Up);
    tap(&mut emulator, Key::Up);
    assert_eq!(emulator.panel().view().brightness, 6);
    for _ in 0..20 {
        tap(&mut emulator, Key::Down);
    }
    assert_eq!(emulator.panel().view().brightness, 15);
    emulator.power_cycle();
    assert_eq!(
        emulator.panel().view().brightness,
        15,
        "kept over power-off"
    );
}

#[test]
fn the_password_page_is_not_entered_while_a_program_runs() {
    let mut emulator = awake();
    let walk = |emulator: &mut Emulator| {
        emulator.show_page(PageId::SetCode);
        let mut seen = Vec::new();
        for _ in 0..4 {
            tap(emulator, Key::PageDown);
            seen.push(page(emulator));
        }
        seen.contains(&PageId::Password)
    };
    assert!(walk(&mut emulator));
    emulator.load_program("O1", "G04 X60;\nM30;\n").unwrap();
    emulator.press(Key::Auto);
    emulator.press(Key::CycleStart);
    assert!(!walk(&mut emulator));
    // The page that is already shown takes no password.
    emulator.show_page(PageId::Password);
    let refused = emulator.panel().refuses(Key::Input, emulator.cnc());
    assert!(refused.is_some());
}

#[test]
fn counters_are_cleared_by_chords() {
    let mut emulator = awake();
    emulator.load_program("O1", "G0 X90;\nM30;\n").unwrap();
    emulator.press(Key::Auto);
    emulator.press(Key::CycleStart);
    emulator.run_until(&WaitCondition::Stopped, 60_000);
    let counters = |emulator: &Emulator| emulator.cnc().counters();
    assert_eq!(counters(&emulator).parts, 1);
    tap(&mut emulator, Key::N);
    assert_eq!(counters(&emulator).parts, 1);
    emulator.key_down(Key::Cancel);
    tap(&mut emulator, Key::N);
    tap(&mut emulator, Key::T);
    emulator.key_up(Key::Cancel);
    assert_eq!(counters(&emulator).parts, 0);
    assert_eq!(counters(&emulator).cutting_ms, 0);
}

#[test]
fn programs_are_selected_and_scanned() {
    let mut emulator = awake();
    for number in [3, 5, 1234] {
        let text = format!("O{number:04};\nN10 G0 X1;\nM30;\n");
        emulator.load_program("", &text).unwrap();
    }
    emulator.press(Key::Auto);
    emulator.show_page(PageId::Prg);
    let selected = |emulator: &Emulator| emulator.screen().row(0);
    type_keys(&mut emulator, "O0005");
    tap(&mut emulator, Key::Down);
    assert!(selected(&emulator).contains("O0005"));
    assert!(emulator.panel().view().input.is_empty());
    type_keys(&mut emulator, "O");
    tap(&mut emulator, Key::Down);
    assert!(selected(&emulator).contains("O1234"));
    tap(&mut emulator, Key::Down);
    assert!(selected(&emulator).contains("O0003"));
    tap(&mut emulator, Key::Reset);
    type_keys(&mut emulator, "O99");
    tap(&mut emulator, Key::Down);
    assert!(selected(&emulator).contains("O0003"), "not found: stays");
    assert_eq!(emulator.cnc().alarms()[0].number, 31);
}

#[test]
fn the_edit_cursor_walks_and_pages_through_the_text() {
    let mut emulator = awake();
    let mut text = "O0001;\n".to_owned();
    for block in 2..=30 {
        text.push_str(&format!("N{block:04} G0;\n"));
    }
    emulator.load_program("", &text).unwrap();
    emulator.press(Key::Edit);
    emulator.show_page(PageId::Prg);
    let line = |emulator: &Emulator| emulator.cnc().cursor().line;
    let mut after = |key: Key| {
        tap(&mut emulator, key);
        let editing = emulator.panel().view().editor.editing.as_ref();
        let cursor = editing.map(ProgramEditor::cursor).unwrap();
        assert_eq!(cursor.0, line(&emulator));
        cursor
    };
    assert_eq!(after(Key::PageUp), (2, 0), "the name is passed over");
    assert_eq!(after(Key::PageDown), (13, 0));
    assert_eq!(after(Key::PageDown), (25, 0));
    assert_eq!(after(Key::PageDown), (31, 0), "the last row");
    assert_eq!(after(Key::PageUp), (13, 0));
    assert_eq!(after(Key::Left), (12, 8));
    assert_eq!(after(Key::Right), (13, 0));
    assert_eq!(after(Key::Right), (13, 1));
    assert_eq!(after(Key::Up), (12, 1));
    emulator.press(Key::Reset);
    assert_eq!(line(&emulator), 1);
    let editing = emulator.panel().view().editor.editing.as_ref();
    assert_eq!(editing.map(ProgramEditor::cursor), Some((1, 0)));
}

#[test]
fn held_cursor_keys_repeat() {
    let mut emulator = awake();
    emulator.show_page(PageId::Pitch);
    let item = |emulator: &Emulator| emulator.panel().view().cursors.get(PageId::Pitch).item;
    emulator.key_down(Key::Down);
    emulator.key_down(Key::Down);
    assert_eq!(item(&emulator), 1, "the PC's own repetition is ignored");
    emulator.run(REPEAT_DELAY - 1);
    assert_eq!(item(&emulator), 1);
    emulator.run(1);
    assert_eq!(item(&emulator), 2);
    emulator.run(1000);
    assert_eq!(item(&emulator), 12);
    emulator.key_up(Key::Down);
    emulator.run(1000);
    assert_eq!(item(&emulator), 12);
}

#[test]
fn as_many_keys_as_parameter_119_says_are_accepted() {
    let mut emulator = awake();
    let keys = [Key::Digit1, Key::Digit2, Key::Digit3, Key::Digit4];
    for key in keys {
        emulator.key_down(key);
    }
    assert_eq!(emulator.panel().held(), &keys[..3]);
    emulator.key_down(Key::OvertravelRelease);
    emulator.key_down(Key::EmergencyStop);
    assert!(emulator.panel().is_held(Key::OvertravelRelease));
    assert!(emulator.panel().emergency_stop());
    emulator.key(KeyEvent::ReleaseAll);
    assert!(emulator.panel().held().is_empty());
    assert!(emulator.panel().emergency_stop(), "the mushroom stays in");
}

#[test]
fn graphic_extents_are_entered_and_the_path_is_drawn() {
    let mut emulator = awake();
    emulator.press(Key::Mdi);
    emulator.show_page(PageId::GraphPar);
    for _ in 0..4 {
        tap(&mut emulator, Key::Down);
    }
    for value in ["150", "200", "-10", "-10"] {
        type_keys(&mut emulator, value);
        tap(&mut emulator, Key::Input);
        tap(&mut emulator, Key::Down);
    }
    let graphic = emulator.panel().view().graphic;
    assert_eq!(
        (graphic.scale, graphic.center_x, graphic.center_z),
        (71, 70_000, 95_000)
    );
    tap(&mut emulator, Key::PageDown);
    assert_eq!(page(&emulator), PageId::Graph);
    tap(&mut emulator, Key::S);
    emulator
        .load_program("O1", "G0 X100 Z100;\nG50 X20 Z20;\nG1 X30 F500;\nM30;\n")
        .unwrap();
    emulator.press(Key::Auto);
    emulator.press(Key::CycleStart);
    emulator.run_until(&WaitCondition::Stopped, 120_000);
    let trace = &emulator.panel().view().trace;
    // X and Z need the same time here, so that the rapid is one straight segment.
    assert_eq!(trace.segments().count(), 2);
    let last = trace.segments().last().unwrap();
    assert!(!last.rapid);
    assert!((last.from.x - 10.0).abs() < 0.1 && (last.to.x - 15.0).abs() < 1e-6);
    tap(&mut emulator, Key::R);
    assert!(emulator.panel().view().trace.is_empty());
    tap(&mut emulator, Key::T);
    assert!(!emulator.panel().view().graphic.drawing);
}

#[test]
fn bits_are_walked_and_items_searched() {
    let mut emulator = awake();
    emulator.show_page(PageId::ParBit);
    let cursor = |emulator: &Emulator| emulator.panel().view().cursors.get(PageId::ParBit);
    tap(&mut emulator, Key::U);
    assert_eq!(cursor(&emulator).bit, 7);
    tap(&mut emulator, Key::W);
    assert_eq!(cursor(&emulator).bit, 0);
    type_keys(&mut emulator, "P172");
    tap(&mut emulator, Key::Input);
    assert_eq!(
        pages::state_numbers().nth(cursor(&emulator).item),
        Some(172)
    );
}

#[test]
fn after_the_self_test_only_an_alarm_shows_the_alarm_page() {
    let mut emulator = Emulator::new(Setup::default());
    emulator.run(100);
    emulator.press(Key::EmergencyStop);
    emulator.run(200);
    assert!(emulator.cnc().is_in_alarm());
    let mut released = emulator.clone();
    released.press(Key::EmergencyStop);
    for (mut emulator, expected) in [(emulator, PageId::Alm), (released, PageId::PosRel)] {
        emulator.run_until(&WaitCondition::SelfTestOver, 5000);
        emulator.run(2);
        assert_eq!(page(&emulator), expected);
    }
}

#[test]
fn the_display_ignores_keys_during_the_self_test() {
    let mut emulator = Emulator::new(Setup::default());
    emulator.run(100);
    emulator.press(Key::Program);
    emulator.run_until(&WaitCondition::SelfTestOver, 5000);
    assert_eq!(page(&emulator), PageId::PosRel);
    let mut setup = Setup::default();
    setup.memory.parameters.set_bit(173, 2, true).unwrap();
    let mut waiting = Emulator::new(setup);
    waiting.power_cycle();
    waiting.run(2000);
    waiting.press(Key::Program);
    waiting.run(2000);
    assert!(waiting.panel().in_self_test());
    waiting.press(Key::Program);
    assert!(!waiting.panel().in_self_test());
}

#[test]
fn an_opened_program_fits_the_graphic_page_unless_extents_were_keyed_in() {
    let mut emulator = Emulator::new(Setup::default());
    emulator.fit_graphic(Point::new(-5.0, -10.0), Point::new(75.0, 200.0));
    let settings = emulator.panel().view().graphic;
    assert_eq!((settings.min_x, settings.max_x), (-10_000, 150_000));
    assert_eq!(
        (settings.scale, settings.zx, settings.drawing),
        (71, true, true)
    );
    emulator.fit_graphic(Point::new(0.0, 0.0), Point::new(1.0, 1.0));
    assert_eq!(emulator.panel().view().graphic, settings);
}
