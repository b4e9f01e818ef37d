//! The operating example of the manual (chapter III-11), whose four tools are set by trial
//! cuts on the drawn part (manual II-4.4.2): cut, measure with the drawn caliper, type the
//! value, then turn the part. The test uses only the mouse and reads no tool length from the
//! simulation.

use std::path::PathBuf;
use std::time::Duration;

use gsk_window::layout::{Layouts, WindowLayout};

use crate::common::WindowBench;
use crate::common::mouse_operator::MouseOperator;
use egui::{Event, Pos2, pos2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable};
use gsk_core::setup::Setup;
use gsk_core::units::Point;

/// The blank of the example in the chuck, its zero at the rear face. The control does not know
/// the tool lengths.
const JOB: &str = "(
    stock: (form: Bar(diameter: 135), face: 178, length: 218, overhang: 188,
        chuck: (diameter: 250, length: 90, jaws: 30, jaw_height: 30)),
    tools: {
        1: (insert: Turning(letter: C, entering: 95, size: 15.875, nose: 0.8), tip: 3,
            holder: Shank(width: 25, length: 80)),
        2: (insert: Turning(letter: D, entering: 93, size: 15.875, nose: 0.4), tip: 3,
            holder: Shank(width: 25, length: 80)),
        3: (insert: Grooving(width: 3, nose: 0.1, reach: 18), tip: 4,
            holder: Shank(width: 25, length: 80)),
        4: (insert: Threading(angle: 60, nose: 0.1, height: 4), tip: 8,
            holder: Shank(width: 25, length: 80)),
    },
    zero: Some((x: -300, z: -400)),
    lengths: { 1: (x: 0, z: 0), 2: (x: -4, z: 1.5), 3: (x: 2, z: -3.25), 4: (x: -1.2, z: 0.6) },
)";

/// The example of the manual without the chuck codes: this lathe has no power chuck.
fn example_program() -> String {
    let sample = include_str!("../../assets/programs/04-manual-example.CNC");
    let lines = sample.lines().filter(|line| {
        let contains = |word: &str| line.contains(word);
        !(contains("G50") || contains("M12") || contains("M13"))
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Distance between two positions of the caliper, points; its reach is greater.
const CALIPER_STEP: f32 = 8.0;

struct TrialFolder(PathBuf);

impl Drop for TrialFolder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

struct TrialOperator {
    hand: MouseOperator,
    _folder: TrialFolder,
}

impl TrialOperator {
    /// Opens the window with the blank in the chuck and the program in the control.
    fn new() -> Self {
        let folder = std::env::temp_dir().join(format!("gsk980td-trial-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let folder = TrialFolder(folder);
        let program = folder.0.join("O0011.CNC");
        std::fs::write(&program, example_program()).unwrap();
        std::fs::write(folder.0.join("O0011.job.ron"), JOB).unwrap();
        let setup = Setup {
            start: Some(Point::new(0.0, 0.0)),
            referenced: true,
            ..Setup::default()
        };
        let size = vec2(1600.0, 900.0);
        let mut bench =
            WindowBench::with_layouts(setup, Layouts::with_layout(WindowLayout::Machine), size);
        let context = bench.harness.ctx.clone();
        bench.harness.state_mut().open(&context, program);
        let mut operator = Self {
            hand: MouseOperator::on_bench(bench),
            _folder: folder,
        };
        operator.wait_for_text("Stock and tools come from ");
        operator.hand.bench.click("Measure");
        let page = "press MDI\npress PRG\npress PGDN\nexpect row 1 \"(程序段值)\"\npress POS";
        operator.hand.run_script(page);
        operator
    }

    /// Waits until a text is shown.
    #[track_caller]
    fn wait_for_text(&mut self, text: &str) {
        let bench = &mut self.hand.bench;
        let is_shown = (0..500).any(|_| {
            std::thread::sleep(Duration::from_millis(10));
            bench.run(10);
            bench.harness.query_by_label_contains(text).is_some()
        });
        assert!(is_shown, "«{text}» is not seen");
    }

    /// Types blocks on the MDI page and runs each.
    #[track_caller]
    fn run_mdi(&mut self, blocks: &[&str]) {
        for block in blocks {
            let mut script = "press MDI\npress PRG\n".to_owned();
            for word in block.split(' ') {
                script += &format!("type {word}\npress IN\n");
            }
            script += "press CS\nwait 300ms\nwait idle 600s\nwait 300ms\nexpect alarm none\n";
            self.hand.run_script(&script);
        }
    }

    /// Types a value on the offset page.
    #[track_caller]
    fn enter_offset(&mut self, number: u8, value: &str) {
        self.hand.run_script(&format!(
            "press OFT\ntype P{number}\npress IN\ntype {value}\npress IN\n"
        ));
    }

    /// The text around `word` that the window shows with the pointer at a position.
    fn read_around(&mut self, position: Pos2, word: &str) -> Option<(String, String)> {
        let harness = &mut self.hand.bench.harness;
        harness.event(Event::PointerMoved(position));
        harness.step();
        harness.step();
        let found = harness.query_all_by_label_contains(word).next()?;
        let text = found.value().or_else(|| found.accesskit_node().label())?;
        let (before, after) = text.split_once(word)?;
        Some((before.to_owned(), after.to_owned()))
    }

    /// Moves the caliper from one point towards another until it measures `feature`. Returns
    /// position and value.
    #[track_caller]
    fn measure_along(&mut self, from: Pos2, to: Pos2, feature: &str) -> (Pos2, f64) {
        let steps = ((to - from).length() / CALIPER_STEP) as i32;
        let measured = (0..steps).find_map(|step| {
            let position = from + (to - from) * (step as f32 / steps as f32);
            Some((position, self.read_around(position, feature)?.1))
        });
        let (position, text) =
            measured.unwrap_or_else(|| panic!("no «{feature}» from {from} to {to}"));
        let value = text.split(',').next().unwrap_or_default();
        (position, value.trim().parse().unwrap())
    }

    /// Z of the front face at the diameter `at`, and the diameter of the part left of this
    /// face.
    #[track_caller]
    fn measure_part(&mut self, at_diameter: f32) -> (f64, f64) {
        self.hand.bench.run(400);
        let picture = self.hand.bench.harness.get_by_label("Machine picture");
        let picture = picture.rect().shrink(4.0);
        // The row of the diameter is interpolated between the coordinates of two other rows.
        let rows = [picture.top(), picture.bottom()];
        let [above, below] = rows.map(|row| {
            let (x, _) = self
                .read_around(pos2(picture.right(), row), "  Z ")
                .unwrap();
            x.trim_start_matches("X ").parse::<f32>().unwrap()
        });
        let row = egui::remap(at_diameter, above..=below, rows[0]..=rows[1]);
        let (right, left) = (pos2(picture.right(), row), pos2(picture.left(), row));
        let (face, z) = self.measure_along(right, left, "face at Z ");
        let column = pos2(face.x - 26.0, picture.top());
        let (_, diameter) = self.measure_along(column, pos2(column.x, row), "cylinder ⌀");
        (z, diameter)
    }
}

#[test]
fn a_part_made_after_trial_cuts_has_the_right_diameter() {
    let mut operator = TrialOperator::new();

    // Base tool: a face, a diameter, and G50 with their coordinates.
    operator.run_mdi(&[
        "T0100",
        "M3 S300",
        "G0 X-160 Z-223",
        "G1 X-302 F200",
        "G0 X-160",
        "M5",
    ]);
    let (face, _) = operator.measure_part(10.0);
    operator.run_mdi(&[&format!("G50 Z{face}")]);
    operator.run_mdi(&["M3", "G0 Z180", "G0 X-168", "G1 Z150 F200", "G0 Z185", "M5"]);
    let (_, diameter) = operator.measure_part(10.0);
    operator.run_mdi(&[&format!("G50 X{diameter}"), "G0 X200 Z230"]);
    assert_eq!((face, diameter), (177.0, 132.0));

    // Second turning tool: the same cuts, typed as offsets.
    operator.run_mdi(&[
        "T0200",
        "M3",
        "G0 X160 Z178",
        "G1 X-6 F200",
        "G0 X160",
        "M5",
    ]);
    let (face, _) = operator.measure_part(10.0);
    operator.enter_offset(2, &format!("Z{face}"));
    operator.run_mdi(&["M3", "G0 Z182", "G0 X127", "G1 Z150 F200", "G0 Z190", "M5"]);
    let (_, diameter) = operator.measure_part(10.0);
    operator.enter_offset(2, &format!("X{diameter}"));
    operator
        .hand
        .run_script("expect row 4 \"_002 -4.000 1.500\"");

    // Grooving tool: its right corner is the programmed tip, its left side cuts the face.
    operator.run_mdi(&[
        "G0 X200 Z230",
        "T0300",
        "M3",
        "G0 X160 Z176",
        "G1 X117 F200",
        "G0 X160",
        "M5",
    ]);
    let (face, _) = operator.measure_part(124.0);
    operator.enter_offset(3, &format!("Z{}", face + 3.0));
    operator.run_mdi(&["M3", "G0 Z180", "G0 X132", "G1 Z150 F200", "G0 Z190", "M5"]);
    let (_, diameter) = operator.measure_part(124.0);
    operator.enter_offset(3, &format!("X{diameter}"));
    operator
        .hand
        .run_script("expect row 5 \"_003 2.000 -3.250\"");

    // Threading tool: its point is aligned with the face by eye.
    operator.run_mdi(&["G0 X200 Z230", "T0400", "M3", "G0 Z177"]);
    let (face, _) = operator.measure_part(124.0);
    operator.enter_offset(4, &format!("Z{face}"));
    operator.run_mdi(&["G0 Z182", "G0 X127", "G1 Z150 F50", "G0 Z190", "M5"]);
    let (_, diameter) = operator.measure_part(124.0);
    operator.enter_offset(4, &format!("X{diameter}"));

    operator.run_mdi(&["G0 X200 Z230", "T0100", "G0 X150 Z185"]);
    operator.hand.run_script(
        "press EDIT\npress PRG\npress RESET\npress AUTO\npress CS\nwait 300ms\nwait idle 3000s\nexpect alarm none",
    );
    operator.wait_for_text(" in all:");
    let harness = &operator.hand.bench.harness;
    assert!(harness.query_by_label_contains("ollision").is_none());
    let (_, diameter) = operator.measure_part(10.0);
    assert_eq!(diameter, 16.0);
}
