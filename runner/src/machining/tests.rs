//! Tests the sample programs on their guessed stock, and parts of known volume.

use core::f64::consts::PI;

use gsk_core::command::ProgramId;
use gsk_core::machine::LatheConfig;
use gsk_core::memory::Offsets;
use gsk_core::preview::preview;
use gsk_core::program::{Program, ProgramMemory};
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_workpiece::collision::{Obstacle, TouchingPart};
use gsk_workpiece::stock::{Stock, StockForm};
use gsk_workpiece::tool::{Insert, Tool};

use super::guess::{self, guess_job};
use super::live_part::LivePart;
use super::*;

const SHAFT: &str = include_str!("../../../assets/programs/01-stepped-shaft.CNC");
const BUSHING: &str = include_str!("../../../assets/programs/02-bushing.CNC");
const PIN: &str = include_str!("../../../assets/programs/03-grooved-pin.CNC");
const MANUAL: &str = include_str!("../../../assets/programs/04-manual-example.CNC");
const GROOVE: &str = include_str!("../../../assets/programs/O1031.CNC");

fn setup(texts: &[&str]) -> Setup {
    let mut setup = Setup::default().with_chuck();
    let mut programs = ProgramMemory::default();
    for text in &texts[1..] {
        programs.store(*text).unwrap();
    }
    programs.open_external(Program::new(texts[0]));
    programs.select(ProgramId::External);
    setup.memory.programs = programs;
    setup
}

fn preview_moves(setup: &Setup) -> Vec<ExecutedMove> {
    let mut moves = Vec::new();
    let result = preview(setup, &setup.memory.programs, &mut |executed| {
        moves.push(*executed);
    });
    assert_eq!(result.alarm, None);
    moves
}

fn rapid_rates(setup: &Setup) -> RapidRates {
    RapidRates::from_memory(&setup.memory)
}

fn execute_program(setup: &Setup, job: Job) -> Machining {
    let mut machining = Machining::new(job);
    for executed in preview_moves(setup) {
        machining.execute_move(&executed, rapid_rates(setup));
    }
    machining
}

fn guess_setup_job(setup: &Setup) -> Job {
    guess_job(
        &preview_moves(setup),
        &Offsets::default(),
        rapid_rates(setup),
    )
    .unwrap()
}

#[test]
fn samples_cut_their_guessed_stock_without_a_collision() {
    for texts in [&[SHAFT][..], &[BUSHING], &[PIN, GROOVE], &[MANUAL]] {
        let setup = setup(texts);
        let job = guess_setup_job(&setup);
        job.check().unwrap();
        let machining = execute_program(&setup, job.clone());
        assert_eq!(machining.findings(), [], "{job:?}");
        assert!(machining.removed_volume() > 1000.0);
    }
}

#[test]
fn what_a_program_does_with_a_tool_shows_what_it_is() {
    let job = guess_setup_job(&setup(&[BUSHING]));
    assert!(job.tools[&3].is_internal());
    assert!(!job.tools[&1].is_internal());
    assert!(matches!(job.stock.form, StockForm::Tube { bore, .. } if bore.0 == 18.0));
    let job = guess_setup_job(&setup(&[PIN, GROOVE]));
    assert!(matches!(job.tools[&3].insert, Insert::Grooving { .. }));
    let thread = "G50 X60 Z20\nG97 M03 S500\nT0101\nG00 X32 Z3\nG92 X29 Z-20 F1.5\nX28.4\nM30\n";
    let job = guess_setup_job(&setup(&[thread]));
    assert!(matches!(job.tools[&1].insert, Insert::Threading { .. }));
}

/// A turning tool with a sharp corner, which leaves the programmed contour.
fn sharp_tool() -> Tool {
    Tool {
        insert: Insert::Turning {
            letter: gsk_workpiece::tool::InsertLetter::V,
            entering: 93.0,
            size: 12.7,
            nose: 0.0,
        },
        ..Tool::turning()
    }
}

/// Volume of a frustum with end radii `a` and `b`, mm³.
fn frustum_volume(a: f64, b: f64, length: f64) -> f64 {
    PI * length * (a * a + a * b + b * b) / 3.0
}

#[test]
fn the_stepped_shaft_has_its_analytic_volume() {
    let setup = setup(&[SHAFT]);
    let mut job = Job::new(Stock::bar(54.0, 2.0, 82.0));
    job.tools.insert(1, sharp_tool());
    job.tools.insert(2, sharp_tool());
    let machining = execute_program(&setup, job);
    assert_eq!(machining.findings(), []);
    // The contour as programmed, from the face at Z0 back to Z-72.
    let fillet = |z: f64| {
        // G02 X40 Z-55 R5 from X30 Z-50: centre at X40 Z-50.
        20.0 - (25.0 - (z + 50.0) * (z + 50.0)).max(0.0).sqrt()
    };
    let corner = |z: f64| {
        // G03 X50 Z-59 K-4 from X42 Z-55: centre at X42 Z-59.
        21.0 + (16.0 - (z + 59.0) * (z + 59.0)).max(0.0).sqrt()
    };
    let disc = |radius: &dyn Fn(f64) -> f64, from: f64, to: f64| {
        // Simpson's rule in a variable that removes the root at the end.
        let steps = 20_000;
        let at = |part: f64| from + (to - from) * (1.0 - libm::cos(part * PI)) / 2.0;
        let slope = |part: f64| (to - from) * PI * libm::sin(part * PI) / 2.0;
        let value = |index: u32| {
            let part = f64::from(index) / f64::from(steps);
            let r = radius(at(part));
            let weight = match index {
                0 => 1.0,
                last if last == steps => 1.0,
                odd if odd % 2 == 1 => 4.0,
                _ => 2.0,
            };
            weight * PI * r * r * slope(part)
        };
        (0..=steps).map(value).sum::<f64>() / (3.0 * f64::from(steps))
    };
    let programmed = frustum_volume(8.0, 10.0, 2.0)
        + frustum_volume(10.0, 10.0, 18.0)
        + frustum_volume(10.0, 15.0, 15.0)
        + frustum_volume(15.0, 15.0, 15.0)
        + disc(&fillet, -55.0, -50.0)
        + disc(&corner, -59.0, -55.0)
        + frustum_volume(25.0, 25.0, 13.0);
    let stock_beyond_part = PI * 27.0 * 27.0 * (122.0 - 2.0 - 72.0);
    let volume = machining.scene().part().volume();
    let wanted = programmed + stock_beyond_part;
    assert!(
        (volume / wanted - 1.0).abs() < 1e-6,
        "{volume} instead of {wanted}"
    );
}

#[test]
fn a_rapid_into_the_stock_is_found_at_its_block() {
    let text = "G50 X60 Z20\nM03 S500\nT0101\nG00 X40 Z2\nG01 Z-20 F100\nG00 Z-30\nM30\n";
    let setup = setup(&[text]);
    let mut job = Job::new(Stock::bar(44.0, 0.0, 60.0));
    job.tools.insert(1, Tool::turning());
    let machining = execute_program(&setup, job);
    let [finding] = machining.findings() else {
        panic!("{:?}", machining.findings());
    };
    assert_eq!(finding.source.map(|source| source.line), Some(6));
    assert_eq!(finding.collision.touching_part, TouchingPart::RapidInsert);
    assert_eq!(finding.collision.obstacle, Obstacle::Stock);
}

#[test]
fn a_wrong_offset_cuts_wrong_as_on_the_machine() {
    let text = "G50 X60 Z20\nM03 S500\nT0101\nG00 X40 Z2\nG01 Z-20 F100\nG00 X50\nM30\n";
    let mut setup = setup(&[text]);
    let mut job = Job::new(Stock::bar(44.0, 0.0, 60.0));
    job.tools.insert(1, Tool::turning());
    job.lengths.insert(1, Default::default());
    // In the control the tool is 1 mm of diameter longer than it is.
    let mut row = setup.memory.offsets.get(1);
    row.x = 1.0;
    setup.memory.offsets.set(1, row).unwrap();
    let machining = execute_program(&setup, job);
    let radius = machining.scene().part().max_radius(-15.0, -5.0);
    assert!((radius - 20.5).abs() < 1e-9, "{radius}");
}

#[test]
fn the_running_control_leaves_the_part_of_the_preview() {
    let setup = setup(&[SHAFT]);
    let job = guess_setup_job(&setup);
    let looked = execute_program(&setup, job.clone());
    let mut simulation = Simulation::new(setup);
    let mut live = LivePart::new(Machining::new(job));
    simulation.start_automatic();
    let mut found = Vec::new();
    for _ in 0..20 * 60 * 1000 {
        simulation.tick();
        found.extend_from_slice(live.follow_tick(&simulation));
        if simulation.cnc.run_state() == gsk_core::operation::RunState::Reset {
            break;
        }
    }
    assert_eq!(found, []);
    let (run, looked) = (
        live.machining().scene().part().volume(),
        looked.scene().part().volume(),
    );
    assert!((run / looked - 1.0).abs() < 1e-4, "{run} {looked}");
}

#[test]
fn the_part_at_a_moment_has_the_motion_that_is_still_collected() {
    let setup = setup(&["O0001\nM03 S800 T0101\nG98\nG00 X36 Z2\nG01 Z-40 F300\nM30\n"]);
    let job = guess_setup_job(&setup);
    let mut simulation = Simulation::new(setup);
    let mut live = LivePart::new(Machining::new(job));
    simulation.start_automatic();
    let (mut collected, mut volume) = (0, live.part_now().volume());
    for _ in 0..60_000 {
        simulation.tick();
        live.follow_tick(&simulation);
        if simulation.cnc.run_state() == gsk_core::operation::RunState::Reset {
            break;
        }
        let now = live.part_now().volume();
        assert!(
            now <= volume + 1e-6,
            "the part grows from {volume} to {now}"
        );
        collected += u32::from(now < live.machining().scene().part().volume() - 1e-6);
        volume = now;
    }
    assert!(collected > 1000, "{collected} ticks");
    assert_eq!(live.part_now(), *live.machining().scene().part());
}

#[test]
fn a_thread_of_g76_has_its_pitch_and_its_depth_in_the_part() {
    let text = "G50 X100 Z50\nG97 M03 S300\nT0101\nG00 X34 Z6\nG76 P010060 Q100 R0.1\n\
                G76 X28.05 Z-25 P975 Q400 F1.5\nG00 X100 Z50\nM30\n";
    let setup = setup(&[text]);
    let mut job = Job::new(Stock::bar(30.0, 0.0, 60.0));
    job.tools.insert(1, Tool::threading(60.0));
    let machining = execute_program(&setup, job);
    assert_eq!(machining.findings(), []);
    let section = machining.scene().part().section();
    let features = gsk_workpiece::measure::measure_features(
        &section,
        gsk_workpiece::measure::SectionSide::Outside,
    );
    let thread = features.iter().find_map(|feature| match feature {
        gsk_workpiece::measure::Feature::Thread {
            pitch, diameters, ..
        } => Some((*pitch, diameters.0.0, diameters.1.0)),
        _ => None,
    });
    let Some((pitch, crest, root)) = thread else {
        panic!("{features:?}");
    };
    assert!((pitch - 1.5).abs() < 0.001, "{pitch}");
    assert!((crest - 30.0).abs() < 0.001, "{crest}");
    assert!((root - 28.05).abs() < 0.001, "{root}");
}

#[test]
fn the_bar_to_practise_on_is_sound_and_the_first_tool_stands_before_it() {
    let mut near_the_ends = LatheConfig::default();
    (near_the_ends.x.start, near_the_ends.z.start) = (-40.0, -20.0);
    for lathe in [LatheConfig::default(), near_the_ends] {
        let job = guess::practice_job(&lathe);
        job.check().unwrap();
        let setup = Setup {
            lathe,
            ..Setup::default()
        };
        let slides = Simulation::new(setup).lathe.slide_position();
        let tip = Mounting::from_job(&job).tip_in_part(1, slides, &Default::default());
        assert!(
            tip.x > job.stock.radius() && tip.z > job.stock.front(),
            "{tip:?}"
        );
    }
}

/// Name and text of a correct part program, and points of the half section of its guessed
/// part, X as a diameter: those that are stock, then those that are not.
type GuessedPart = (
    &'static str,
    &'static str,
    &'static [(f64, f64)],
    &'static [(f64, f64)],
);

const HEAD: &str = "G50 X120 Z80\nM03 S500\n";

const GUESSED: [GuessedPart; 21] = [
    (
        "facing with G94",
        "T0101\nG00 X52 Z2\nG94 X20 Z-2 F100\nZ-4\nZ-6\nZ-8\nG00 X100 Z80",
        &[(19.0, -7.0), (50.0, -9.0)],
        &[(24.0, -7.5), (50.0, -7.5)],
    ),
    (
        "facing with G72, finished away from the chuck",
        "T0101\nG00 X52 Z2\nG72 W2 R1\nG72 P10 Q20 U0.2 W0.1 F100\nN10 G00 Z-12\nG01 X30 F60\n\
         Z-6\nX20\nZ0\nN20 Z2\nG70 P10 Q20\nG00 X100 Z80",
        &[(19.0, -5.0), (29.0, -11.0), (50.0, -12.5)],
        &[(22.5, -5.0), (32.5, -11.0)],
    ),
    (
        "facing with G01",
        "T0101\nG00 X52 Z0\nG01 X-1.6 F100\nG00 Z2\nX46\nG01 Z-20\nX52\nG00 X100 Z80",
        &[(45.0, -10.0), (45.0, -0.1), (50.0, -21.0)],
        &[(47.0, -10.0), (10.0, 0.1)],
    ),
    (
        "an internal thread in a drilled and bored hole",
        "T0101\nG00 X0 Z5\nG01 Z-40 F60\nG00 Z80\nT0202\nG00 X24 Z3\nG90 X25 Z-30 F100\nX26\nX27\n\
         X28.4\nG00 Z80\nT0303\nG00 X26 Z5\nG92 X28.9 Z-25 F1.5\nX29.4\nX29.8\nX30\nG00 Z80",
        &[(30.2, -10.0), (28.6, -28.0)],
        &[(28.2, -28.0), (22.0, -30.0)],
    ),
    (
        "an internal thread in a tube",
        "T0101\nG00 X18 Z5\nG76 P010060 Q100 R0.05\nG76 X21.5 Z-25 P800 Q300 F1.5\nG00 Z80",
        &[(21.8, -10.0), (30.0, -30.0)],
        &[(17.5, -10.0)],
    ),
    (
        "a groove in the face with G74",
        "T0101\nG00 X30 Z3\nG74 R0.5\nG74 Z-6 Q2000 F50\nG00 X100 Z80",
        &[(25.0, -3.0), (35.0, -3.0), (30.0, -6.5)],
        &[(30.0, -5.0)],
    ),
    (
        "a groove in the face with G01",
        "T0101\nG00 X30 Z3\nG01 Z-6 F30\nG04 X1\nG00 Z3\nX100 Z80",
        &[(25.0, -3.0), (35.0, -3.0), (30.0, -6.5)],
        &[(30.0, -5.0)],
    ),
    (
        "a groove and parting off",
        "T0101\nG00 X44 Z-20\nG01 X30 F40\nG00 X44\nZ-40\nG01 X-0.4 F30\nG00 X100 Z80",
        &[(20.0, -41.0)],
        &[(20.0, -38.0)],
    ),
    (
        "a deep groove with G75",
        "T0101\nG00 X62 Z-20\nG75 R1\nG75 X12 P3000 F40\nG00 X100 Z80",
        &[(10.0, -19.0), (60.0, -22.0)],
        &[(14.0, -18.0)],
    ),
    (
        "a groove in a bore",
        "T0101\nG00 X18 Z3\nG90 X20 Z-30 F80\nX22\nG00 Z80\nT0202\nG00 X20 Z3\nZ-15\n\
         G01 X28 F30\nX20\nG00 Z80",
        &[(23.0, -8.0), (23.0, -20.0), (28.5, -13.5)],
        &[(27.0, -13.5), (21.0, -25.0)],
    ),
    (
        "a left-hand tool from a groove on",
        "T0101\nG00 X54 Z-43\nG01 X44 F40\nG00 X54\nX100 Z80\nT0202\nG00 X54 Z-40\nG00 X48\n\
         G01 Z-10 F80\nX54\nG00 Z-40\nX44\nG01 Z-10\nX54\nG00 X100 Z80",
        &[(43.0, -20.0), (47.0, -8.0)],
        &[(45.0, -20.0)],
    ),
    (
        "an undercut between shoulders",
        "T0101\nG00 X46 Z2\nG01 Z-45 F100\nX54\nG00 Z2\nX46\nG01 Z-8 F80\nX36 Z-20\nZ-35\nX46 Z-38\n\
         X54\nG00 X100 Z80",
        &[(45.0, -5.0), (35.0, -25.0), (45.0, -42.0)],
        &[(37.0, -25.0), (47.0, -42.0)],
    ),
    (
        "without a T word",
        "G00 X52 Z2\nG90 X46 Z-30 F100\nX42\nX38\nG00 X100 Z80",
        &[(37.0, -20.0), (50.0, -31.0)],
        &[(39.0, -20.0)],
    ),
    (
        "beyond the axis",
        "T0101\nG00 X-52 Z2\nX-46\nG01 Z-25 F100\nX-52\nG00 Z2\nX-42\nG01 Z-25\nX-52\nG00 X-120 Z80",
        &[(41.0, -20.0), (47.0, -27.0)],
        &[(43.0, -20.0)],
    ),
    (
        "a tapered thread",
        "T0101\nG00 X34 Z6\nG92 X29.6 Z-20 R-1 F1.5\nX29 R-1\nX28.2 R-1\nG00 X100 Z80",
        &[(26.0, -3.0), (27.5, -15.0)],
        &[],
    ),
    (
        "a thread before a shoulder",
        "T0101\nG00 X42 Z2\nG90 X34 Z-23 F100\nX30 Z-8\nX26\nX22\nX18\nG00 X120 Z80\nT0404\n\
         G00 X22 Z6\nG92 X17.6 Z-4 F1.5\nX17.2\nX16.8\nX16.4\nX16.16\nG00 X120 Z80",
        &[(33.0, -15.0), (15.0, -3.0)],
        &[(35.0, -15.0), (19.0, -5.0)],
    ),
    (
        "a wide groove in a face with a short last step",
        "T0101\nG00 X52 Z2\nG90 X48 Z-30 F100\nG00 X100 Z80\nT0202\nG00 X28 Z3\nG74 R0.5\n\
         G74 X20 Z-5 P5000 Q2000 F50\nG00 X100 Z80",
        &[(15.0, -3.0), (33.0, -3.0), (24.0, -6.0)],
        &[(18.0, -3.0), (21.5, -3.0), (24.0, -4.5), (30.0, -3.0)],
    ),
    (
        "rapids away from shoulders",
        "T0101\nG00 X46 Z2\nG01 Z-30 F100\nG00 X52\nZ2\nX40\nG01 Z-20\nG00 X52\nX100 Z80",
        &[(39.0, -10.0), (45.0, -25.0), (47.0, -31.0)],
        &[(41.0, -10.0), (47.0, -20.0)],
    ),
    (
        "rapids away from the shoulders of a bore",
        "T0202\nG00 X20 Z2\nG01 Z-50 F60\nG00 X18\nZ2\nX26\nG01 Z-20\nG00 X19\nZ2\nX100 Z80",
        &[(26.5, -10.0), (21.0, -40.0), (21.0, -21.0)],
        &[(25.0, -10.0), (19.5, -40.0)],
    ),
    (
        "rapids away from faced steps",
        "T0101\nG00 X52 Z-2\nG01 X30 F60\nG00 Z2\nX52\nZ-4\nG01 X30\nG00 Z2\nX100 Z80",
        &[(29.0, -1.0), (45.0, -5.0)],
        &[(31.0, -3.0)],
    ),
    (
        "a tube, faced and turned",
        "T0101\nG00 X54 Z0\nG01 X18 F80\nG00 Z2\nX46\nG01 Z-20 F100\nX52\nG00 X100 Z80",
        &[(45.0, -10.0)],
        &[(47.0, -10.0), (30.0, 0.1)],
    ),
];

#[test]
fn parts_that_are_right_collide_with_no_guessed_tool() {
    for (name, text, stock, air) in GUESSED {
        let head = match text.contains("X-52") {
            true => HEAD.replace("X120", "X-120"),
            false => HEAD.to_owned(),
        };
        let setup = setup(&[&format!("{head}{text}\nM30\n")]);
        let job = guess_setup_job(&setup);
        job.check().unwrap();
        let machining = execute_program(&setup, job.clone());
        assert_eq!(machining.findings(), [], "{name}: {job:?}");
        let section = machining.scene().part().section();
        let has = |&(x, z): &(f64, f64)| {
            section.contains(gsk_workpiece::grid::to_grid(Point::new(x / 2.0, z)))
        };
        assert!(stock.iter().all(has), "{name}: too much is cut, {job:?}");
        assert!(!air.iter().any(has), "{name}: too little is cut, {job:?}");
    }
}

#[test]
fn a_machine_zero_that_is_not_known_is_not_in_the_part() {
    let head = "M03 S500\nT0101\nG00 X46 Z2\nG01 Z-20 F100\nX52\n";
    let job = || {
        let mut job = Job::new(Stock::bar(50.0, 0.0, 60.0));
        job.tools.insert(1, Tool::turning());
        job
    };
    // The machine zero has no position: neither the path there nor back collides.
    for text in [
        "G28 U0 W0\nG00 X44 Z2\nG01 Z-10\nM30\n",
        "G28 X60 Z5\nG00 W5\nU2\nX44 Z2\nG01 Z-10\nM30\n",
        "G28 U0\nG28 W0\nG00 Z2\nX44\nG01 Z-10\nM30\n",
    ] {
        let setup = setup(&[&format!("{head}{text}")]);
        let machining = execute_program(&setup, job());
        assert_eq!(machining.findings(), [], "{text}");
        let radius = machining.scene().part().max_radius(-5.0, -2.0);
        assert!((radius - 22.0).abs() < 1e-9, "{text}: {radius}");
    }
    // With a known position the path back goes through the bar.
    let mut setup = setup(&[&format!("{head}G28 U0 W0\nM30\n")]);
    setup.absolute = Some(Point::new(0.0, -40.0));
    let machining = execute_program(&setup, job());
    assert!(!machining.findings().is_empty());
}
