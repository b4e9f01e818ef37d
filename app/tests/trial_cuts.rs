//! The operating example of the manual (chapter III-11), whose four tools are set by trial
//! cuts on the drawn part (manual II-4.4.2): cut, measure with the drawn caliper, type the
//! value, then turn the part. The test uses only the mouse and reads no tool length from the
//! simulation.

use std::path::PathBuf;
use std::time::Duration;

use crate::common::Bench;
use crate::common::hand::Hand;
use egui::{Event, Pos2, pos2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable};
use gsk_app::window::layout::{Layout, Layouts};
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
fn example() -> String {
    let sample = include_str!("../../assets/programs/04-manual-example.CNC");
    let kept = sample.lines().filter(|line| {
        let is = |word: &str| line.contains(word);
        !(is("G50") || is("M12") || is("M13"))
    });
    kept.collect::<Vec<_>>().join("\n")
}

/// Distance between two positions of the caliper, points; its reach is greater.
const STEP: f32 = 8.0;

struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

struct Trainee {
    hand: Hand,
    _folder: Folder,
}

impl Trainee {
    /// Opens the window with the blank in the chuck and the program in the control.
    fn new() -> Self {
        let folder = std::env::temp_dir().join(format!("gsk980td-trial-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let folder = Folder(folder);
        let program = folder.0.join("O0011.CNC");
        std::fs::write(&program, example()).unwrap();
        std::fs::write(folder.0.join("O0011.job.ron"), JOB).unwrap();
        let setup = Setup {
            start: Some(Point::new(0.0, 0.0)),
            referenced: true,
            ..Setup::default()
        };
        let size = vec2(1600.0, 900.0);
        let mut bench = Bench::sized(setup, Layouts::of(Layout::Machine), size);
        let context = bench.harness.ctx.clone();
        bench.harness.state_mut().open(&context, program);
        let mut trainee = Self {
            hand: Hand::at(bench),
            _folder: folder,
        };
        trainee.sees("come from the job file");
        trainee.hand.bench.click("Measure");
        let page = "press MDI\npress PRG\npress PGDN\nexpect row 1 \"(程序段值)\"\npress POS";
        trainee.hand.follow(page);
        trainee
    }

    /// Waits until a text is shown.
    #[track_caller]
    fn sees(&mut self, words: &str) {
        let bench = &mut self.hand.bench;
        let seen = (0..500).any(|_| {
            std::thread::sleep(Duration::from_millis(10));
            bench.run(10);
            bench.harness.query_by_label_contains(words).is_some()
        });
        assert!(seen, "«{words}» is not seen");
    }

    /// Types blocks on the MDI page and runs each.
    #[track_caller]
    fn mdi(&mut self, blocks: &[&str]) {
        for block in blocks {
            let mut script = "press MDI\npress PRG\n".to_owned();
            for word in block.split(' ') {
                script += &format!("type {word}\npress IN\n");
            }
            script += "press CS\nwait 300ms\nwait idle 600s\nwait 300ms\nexpect alarm none\n";
            self.hand.follow(&script);
        }
    }

    /// Types a value on the offset page.
    #[track_caller]
    fn offset(&mut self, number: u8, value: &str) {
        self.hand.follow(&format!(
            "press OFT\ntype P{number}\npress IN\ntype {value}\npress IN\n"
        ));
    }

    /// The text around `word` that the window shows with the pointer at a position.
    fn reads(&mut self, at: Pos2, word: &str) -> Option<(String, String)> {
        let harness = &mut self.hand.bench.harness;
        harness.event(Event::PointerMoved(at));
        harness.step();
        harness.step();
        let found = harness.query_all_by_label_contains(word).next()?;
        let words = found.value().or_else(|| found.accesskit_node().label())?;
        let (before, after) = words.split_once(word)?;
        Some((before.to_owned(), after.to_owned()))
    }

    /// Moves the caliper from one point towards another until it measures `what`. Returns
    /// position and value.
    #[track_caller]
    fn measures(&mut self, from: Pos2, to: Pos2, what: &str) -> (Pos2, f64) {
        let steps = ((to - from).length() / STEP) as i32;
        let met = (0..steps).find_map(|step| {
            let at = from + (to - from) * (step as f32 / steps as f32);
            Some((at, self.reads(at, what)?.1))
        });
        let (at, words) = met.unwrap_or_else(|| panic!("no «{what}» from {from} to {to}"));
        let value = words.split(',').next().unwrap_or_default();
        (at, value.trim().parse().unwrap())
    }

    /// Z of the front face at the diameter `at`, and the diameter of the part left of this
    /// face.
    #[track_caller]
    fn part(&mut self, at: f32) -> (f64, f64) {
        self.hand.bench.run(400);
        let picture = self.hand.bench.harness.get_by_label("Machine picture");
        let picture = picture.rect().shrink(4.0);
        // The row of the diameter is interpolated between the coordinates of two other rows.
        let rows = [picture.top(), picture.bottom()];
        let [above, below] = rows.map(|row| {
            let (x, _) = self.reads(pos2(picture.right(), row), "  Z ").unwrap();
            x.trim_start_matches("X ").parse::<f32>().unwrap()
        });
        let row = egui::remap(at, above..=below, rows[0]..=rows[1]);
        let (right, left) = (pos2(picture.right(), row), pos2(picture.left(), row));
        let (face, z) = self.measures(right, left, "face at Z ");
        let column = pos2(face.x - 26.0, picture.top());
        let (_, diameter) = self.measures(column, pos2(column.x, row), "cylinder ⌀");
        (z, diameter)
    }
}

#[test]
fn four_tools_are_set_by_trial_cuts_and_the_part_comes_out_right() {
    let mut trainee = Trainee::new();

    // Base tool: a face, a diameter, and G50 with their coordinates.
    trainee.mdi(&[
        "T0100",
        "M3 S300",
        "G0 X-160 Z-223",
        "G1 X-302 F200",
        "G0 X-160",
        "M5",
    ]);
    let (face, _) = trainee.part(10.0);
    trainee.mdi(&[&format!("G50 Z{face}")]);
    trainee.mdi(&["M3", "G0 Z180", "G0 X-168", "G1 Z150 F200", "G0 Z185", "M5"]);
    let (_, diameter) = trainee.part(10.0);
    trainee.mdi(&[&format!("G50 X{diameter}"), "G0 X200 Z230"]);
    assert_eq!((face, diameter), (177.0, 132.0));

    // Second turning tool: the same cuts, typed as offsets.
    trainee.mdi(&[
        "T0200",
        "M3",
        "G0 X160 Z178",
        "G1 X-6 F200",
        "G0 X160",
        "M5",
    ]);
    let (face, _) = trainee.part(10.0);
    trainee.offset(2, &format!("Z{face}"));
    trainee.mdi(&["M3", "G0 Z182", "G0 X127", "G1 Z150 F200", "G0 Z190", "M5"]);
    let (_, diameter) = trainee.part(10.0);
    trainee.offset(2, &format!("X{diameter}"));
    trainee.hand.follow("expect row 4 \"_002 -4.000 1.500\"");

    // Grooving tool: its right corner is the programmed tip, its left side cuts the face.
    trainee.mdi(&[
        "G0 X200 Z230",
        "T0300",
        "M3",
        "G0 X160 Z176",
        "G1 X117 F200",
        "G0 X160",
        "M5",
    ]);
    let (face, _) = trainee.part(124.0);
    trainee.offset(3, &format!("Z{}", face + 3.0));
    trainee.mdi(&["M3", "G0 Z180", "G0 X132", "G1 Z150 F200", "G0 Z190", "M5"]);
    let (_, diameter) = trainee.part(124.0);
    trainee.offset(3, &format!("X{diameter}"));
    trainee.hand.follow("expect row 5 \"_003 2.000 -3.250\"");

    // Threading tool: its point is aligned with the face by eye.
    trainee.mdi(&["G0 X200 Z230", "T0400", "M3", "G0 Z177"]);
    let (face, _) = trainee.part(124.0);
    trainee.offset(4, &format!("Z{face}"));
    trainee.mdi(&["G0 Z182", "G0 X127", "G1 Z150 F50", "G0 Z190", "M5"]);
    let (_, diameter) = trainee.part(124.0);
    trainee.offset(4, &format!("X{diameter}"));

    trainee.mdi(&["G0 X200 Z230", "T0100", "G0 X150 Z185"]);
    trainee.hand.follow(
        "press EDIT\npress PRG\npress RESET\npress AUTO\npress CS\nwait 300ms\nwait idle 3000s\nexpect alarm none",
    );
    trainee.sees(" in all:");
    let harness = &trainee.hand.bench.harness;
    assert!(harness.query_by_label_contains("ollision").is_none());
    let (_, diameter) = trainee.part(10.0);
    assert_eq!(diameter, 16.0);
}
