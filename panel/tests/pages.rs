//! Draws pages in states that the cases of every page (`tests/cases/pages/`) do not show, and
//! with extreme values.

#![expect(clippy::unwrap_used, reason = "the helpers of a test may fail it")]

mod common;

use gsk_core::cnc::ControlRequest;
use gsk_core::operation::OperatingMode;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::program::{Program, ProgramEditor};
use gsk_core::setup::Setup;
use gsk_core::simulation::{RunUntilResult, Simulation, StopCondition};
use gsk_core::units::Axis;
use gsk_panel::pages::{self, GraphicSettings, PAGES, PageId, PageView};
use gsk_panel::raster;
use gsk_panel::screen::{CellStyle, ROWS, Screen};

use common::{
    AUTO, CYCLE_START, EDIT, FEED_HOLD, HANDWHEEL, JOG, SINGLE_BLOCK, lathe, lathe_from, press,
    ticks,
};

/// The 15 lines of 40 columns between bars, so that blanks at their ends count.
fn framed(screen: &Screen) -> String {
    let lines: Vec<String> = screen
        .text()
        .lines()
        .map(|line| format!("|{line}|"))
        .collect();
    assert_eq!(lines.len(), ROWS);
    lines.join("\n")
}

fn shown(page: PageId, view: &PageView, simulation: &Simulation) -> String {
    framed(&pages::draw(page, view, &simulation.cnc))
}

/// The graphic extents of the acceptance program.
fn graphic_view() -> PageView {
    let mut view = PageView::default();
    view.graphic = GraphicSettings {
        zx: true,
        max_x: 150_000,
        max_z: 200_000,
        min_x: -10_000,
        min_z: -10_000,
        drawing: true,
        ..view.graphic
    };
    view.graphic.recompute();
    view
}

#[test]
fn positions_by_mode() {
    let mut simulation = lathe();
    let mut view = PageView::default();
    press(&mut simulation, JOG);
    insta::assert_snapshot!("pos-rel-in-jog", shown(PageId::PosRel, &view, &simulation));
    press(&mut simulation, HANDWHEEL);
    assert_eq!(simulation.cnc.mode(), OperatingMode::Step);
    view.spindle_override = true;
    insta::assert_snapshot!("pos-abs-in-step", shown(PageId::PosAbs, &view, &simulation));
    insta::assert_snapshot!("pos-all-by-hand", shown(PageId::PosAll, &view, &simulation));
}

#[test]
fn a_program_block_by_block() {
    let mut simulation = lathe();
    let view = PageView::default();
    press(&mut simulation, AUTO);
    press(&mut simulation, SINGLE_BLOCK);
    while simulation.cnc.cursor().sequence != Some(80) {
        press(&mut simulation, CYCLE_START);
        assert_eq!(
            simulation.run_until(StopCondition::Stopped, 60_000),
            RunUntilResult::Reached
        );
    }
    ticks(&mut simulation, 2000);
    for page in [PageId::PosPrg, PageId::Prg, PageId::Mdi] {
        let name = format!("{}-block-n80", page.name());
        insta::assert_snapshot!(name, shown(page, &view, &simulation));
    }
    let screen = pages::draw(PageId::PosRel, &view, &simulation.cnc);
    let rates = [
        "编程速率:    1000   G功能码: G01, G98   ",
        "实际速率:    1000   加工件数:      0    ",
    ];
    assert_eq!([screen.row(10), screen.row(11)], rates);
    let screen = pages::draw(PageId::Prg, &view, &simulation.cnc);
    let inverse = (0..ROWS).filter(|row| screen.cell(*row, 0).style == CellStyle::Inverse);
    assert_eq!(inverse.collect::<Vec<usize>>(), [7]);
}

#[test]
fn feed_hold_shows_what_is_left() {
    let mut simulation = lathe();
    press(&mut simulation, AUTO);
    press(&mut simulation, CYCLE_START);
    while simulation.cnc.cursor().sequence != Some(80) {
        simulation.tick();
    }
    ticks(&mut simulation, 100);
    press(&mut simulation, FEED_HOLD);
    ticks(&mut simulation, 1000);
    let screen = pages::draw(PageId::PosAll, &PageView::default(), &simulation.cnc);
    assert!(screen.row(14).starts_with("     暂停           自动方式"));
    let value = |row: usize| -> f64 {
        let row = screen.row(row);
        row.split_whitespace().last().unwrap().parse().unwrap()
    };
    let (absolute, remaining) = (value(3), value(8));
    assert!(remaining > 1.0 && (absolute + remaining - 40.0).abs() < 0.0011);
    assert_eq!(value(9).to_bits(), 0.0_f64.to_bits());
}

#[test]
fn words_keyed_in() {
    let mut simulation = lathe();
    let mut view = PageView::default();
    for word in ["G50", "X50", "Z100"] {
        let request = ControlRequest::AddMdiWord(word.to_owned());
        simulation.cnc.request(request).unwrap();
    }
    view.input = "S1".to_owned();
    insta::assert_snapshot!("mdi-with-words", shown(PageId::Mdi, &view, &simulation));
}

#[test]
fn alarms() {
    let mut setup = Setup::default();
    setup
        .memory
        .programs
        .store("O0001;\nG1 X10;\nM30;\n")
        .unwrap();
    let mut simulation = Simulation::new(setup);
    ticks(&mut simulation, 200);
    press(&mut simulation, AUTO);
    press(&mut simulation, CYCLE_START);
    ticks(&mut simulation, 500);
    let view = PageView::default();
    insta::assert_snapshot!("alm-with-an-alarm", shown(PageId::Alm, &view, &simulation));
}

#[test]
fn emergency_stop() {
    let mut setup = Setup::default();
    let loop_contact = BitAddress::new(Area::X, 0, 5);
    setup.forced_inputs.push((loop_contact, false));
    let simulation = lathe_from(setup);
    let view = PageView::default();
    let page = shown(PageId::Alm, &view, &simulation);
    insta::assert_snapshot!("alm-emergency-stop", page);
}

#[test]
fn the_editor() {
    let mut simulation = lathe();
    press(&mut simulation, EDIT);
    let mut view = PageView::default();
    let long = "N0010 G71 U2 R1 (粗车外圆,每刀切深二毫米,退刀一毫米);\n";
    let text = format!("O0001;\n{}M30;\n", long.repeat(14));
    let mut editing = ProgramEditor::new(Program::new(text), 8);
    for _ in 0..33 {
        editing.move_right();
    }
    view.editor.editing = Some(editing);
    view.input = "O".to_owned();
    let screen = pages::draw(PageId::Prg, &view, &simulation.cnc);
    insta::assert_snapshot!("prg-editor", framed(&screen));
    let bars: Vec<(usize, usize)> = (0..ROWS)
        .flat_map(|row| (0..40).map(move |column| (row, column)))
        .filter(|(row, column)| screen.cell(*row, *column).style == CellStyle::Underline)
        .collect();
    // The screen begins with line 7: the six lines before it take eleven rows.
    assert_eq!(bars, [(4, 7), (4, 8)]);
}

#[test]
fn lists_follow_their_cursors() {
    let simulation = lathe();
    let mut view = PageView::default();
    let items = [
        (PageId::Oft, 32, 0),
        (PageId::ParBit, 3, 5),
        (PageId::ParData, 17, 0),
        (PageId::Pitch, 255, 0),
        (PageId::Dgn, 4, 5),
        (PageId::PlcBits, 31, 7),
        (PageId::PlcValues, 1000, 0),
        (PageId::GraphPar, 4, 0),
    ];
    for (page, item, bit) in items {
        let cursor = view.cursors.get_mut(page);
        (cursor.item, cursor.bit) = (item, bit);
        let name = format!("{}-item-{item}", page.name());
        insta::assert_snapshot!(name, shown(page, &view, &simulation));
    }
}

#[test]
fn flashing_is_missing_from_the_picture_only() {
    let simulation = lathe();
    let mut view = PageView {
        flashing: Some(Axis::X),
        ..PageView::default()
    };
    let bright = pages::draw(PageId::PosRel, &view, &simulation.cnc);
    view.ticks = pages::FLASH_TICKS;
    let dark = pages::draw(PageId::PosRel, &view, &simulation.cnc);
    assert_eq!(bright.text(), dark.text());
    let lit = |screen: &Screen, x: i32| {
        let dots = raster::bitmap(screen);
        (48..80).any(|y| (x..x + 16).any(|x| dots.get(x, y)))
    };
    assert!(lit(&bright, 32) && !lit(&dark, 32));
    view.ticks = 2 * pages::FLASH_TICKS;
    assert_eq!(pages::draw(PageId::PosRel, &view, &simulation.cnc), bright);
}

#[test]
fn the_letter_keyed_in_flashes_until_its_number_follows() {
    let simulation = lathe();
    let mut view = PageView {
        input: "O".to_owned(),
        ticks: pages::FLASH_TICKS,
        ..PageView::default()
    };
    let letter = pages::draw(PageId::Oft, &view, &simulation.cnc);
    view.input = "O1".to_owned();
    let number = pages::draw(PageId::Oft, &view, &simulation.cnc);
    let dots = |screen: &Screen| {
        let dots = raster::bitmap(screen);
        (208..224).any(|y| (40..48).any(|x| dots.get(x, y)))
    };
    assert!(!dots(&letter) && dots(&number));
    assert!(letter.row(13).starts_with("地址 O "));
}

#[test]
fn anything_in_the_view_can_be_drawn() {
    let mut simulation = lathe();
    simulation
        .cnc
        .request(ControlRequest::StoreProgram(format!(
            "O0002;{}",
            "中".repeat(5000)
        )))
        .unwrap();
    for mode in [None, Some(EDIT)] {
        if let Some(key) = mode {
            press(&mut simulation, key);
        }
        for extreme in [0, 1, usize::MAX] {
            let mut view = graphic_view();
            view.input = "编辑X".repeat(30);
            view.directory_screen = extreme;
            let extreme_line = u32::try_from(extreme).unwrap_or(u32::MAX);
            let current = simulation.cnc.programs().selected();
            let program = current.and_then(|id| simulation.cnc.programs().get(id));
            view.editor.editing =
                program.map(|program| ProgramEditor::new(program.clone(), extreme_line));
            view.graphic.scale = extreme_line;
            view.graphic.center_x = i32::MIN;
            for row in PAGES {
                let cursor = view.cursors.get_mut(row.page);
                (cursor.item, cursor.bit) = (extreme, extreme as u8);
                let screen = pages::draw(row.page, &view, &simulation.cnc);
                framed(&screen);
                raster::rgba(&screen, extreme as u8);
            }
        }
    }
}
