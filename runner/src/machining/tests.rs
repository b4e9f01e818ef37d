//! The sample programs on their guessed stock, and parts of known volume.

use core::f64::consts::PI;

use gsk_core::command::ProgramId;
use gsk_core::memory::Offsets;
use gsk_core::preview::preview;
use gsk_core::program::{Program, ProgramMemory};
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_workpiece::collision::{Obstacle, Toucher};
use gsk_workpiece::stock::{Form, Stock};
use gsk_workpiece::tool::{Insert, Tool};

use super::guess::{self, guess};
use super::live::Live;
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

fn moves(setup: &Setup) -> Vec<ExecutedMove> {
    let mut moves = Vec::new();
    let result = preview(setup, &setup.memory.programs, &mut |executed| {
        moves.push(*executed);
    });
    assert_eq!(result.alarm, None);
    moves
}

fn rates(setup: &Setup) -> RapidRates {
    RapidRates::of(&setup.memory)
}

fn carried_out(setup: &Setup, job: Job) -> Machining {
    let mut machining = Machining::new(job);
    for executed in moves(setup) {
        machining.moved(&executed, rates(setup));
    }
    machining
}

fn guessed(setup: &Setup) -> Job {
    guess(&moves(setup), &Offsets::default(), rates(setup)).unwrap()
}

#[test]
fn samples_cut_their_guessed_stock_without_a_collision() {
    for texts in [&[SHAFT][..], &[BUSHING], &[PIN, GROOVE], &[MANUAL]] {
        let setup = setup(texts);
        let job = guessed(&setup);
        job.check().unwrap();
        let machining = carried_out(&setup, job.clone());
        assert_eq!(machining.findings(), [], "{job:?}");
        assert!(machining.removed_volume() > 1000.0);
    }
}

#[test]
fn what_a_program_does_with_a_tool_shows_what_it_is() {
    let job = guessed(&setup(&[BUSHING]));
    assert!(job.tools[&3].is_internal());
    assert!(!job.tools[&1].is_internal());
    assert!(matches!(job.stock.form, Form::Tube { bore, .. } if bore.0 == 18.0));
    let job = guessed(&setup(&[PIN, GROOVE]));
    assert!(matches!(job.tools[&3].insert, Insert::Grooving { .. }));
    let thread = "G50 X60 Z20\nG97 M03 S500\nT0101\nG00 X32 Z3\nG92 X29 Z-20 F1.5\nX28.4\nM30\n";
    let job = guessed(&setup(&[thread]));
    assert!(matches!(job.tools[&1].insert, Insert::Threading { .. }));
}

/// A turning tool with a sharp corner, which leaves the programmed contour.
fn sharp() -> Tool {
    Tool {
        insert: Insert::Turning {
            letter: gsk_workpiece::tool::Letter::V,
            entering: 93.0,
            size: 12.7,
            nose: 0.0,
        },
        ..Tool::turning()
    }
}

/// Volume of a cone's frustum, mm³.
fn frustum(a: f64, b: f64, length: f64) -> f64 {
    PI * length * (a * a + a * b + b * b) / 3.0
}

#[test]
fn the_stepped_shaft_has_its_analytic_volume() {
    let setup = setup(&[SHAFT]);
    let mut job = Job::new(Stock::bar(54.0, 2.0, 82.0));
    job.tools.insert(1, sharp());
    job.tools.insert(2, sharp());
    let machining = carried_out(&setup, job);
    assert_eq!(machining.findings(), []);
    // The contour as it is programmed, from the face at Z0 back to Z-72.
    let fillet = |z: f64| {
        // G02 X40 Z-55 R5 from X30 Z-50: centre at X40 Z-50.
        20.0 - (25.0 - (z + 50.0) * (z + 50.0)).max(0.0).sqrt()
    };
    let corner = |z: f64| {
        // G03 X50 Z-59 K-4 from X42 Z-55: centre at X42 Z-59.
        21.0 + (16.0 - (z + 59.0) * (z + 59.0)).max(0.0).sqrt()
    };
    let disc = |radius: &dyn Fn(f64) -> f64, from: f64, to: f64| {
        // Simpson's rule in a variable that takes the root at the end out.
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
    let programmed = frustum(8.0, 10.0, 2.0)
        + frustum(10.0, 10.0, 18.0)
        + frustum(10.0, 15.0, 15.0)
        + frustum(15.0, 15.0, 15.0)
        + disc(&fillet, -55.0, -50.0)
        + disc(&corner, -59.0, -55.0)
        + frustum(25.0, 25.0, 13.0);
    let stock_behind = PI * 27.0 * 27.0 * (122.0 - 2.0 - 72.0);
    let volume = machining.scene().part().volume();
    let wanted = programmed + stock_behind;
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
    let machining = carried_out(&setup, job);
    let [finding] = machining.findings() else {
        panic!("{:?}", machining.findings());
    };
    assert_eq!(finding.source.map(|source| source.line), Some(6));
    assert_eq!(finding.collision.toucher, Toucher::RapidInsert);
    assert_eq!(finding.collision.obstacle, Obstacle::Stock);
}

#[test]
fn a_wrong_offset_cuts_wrong_as_on_the_machine() {
    let text = "G50 X60 Z20\nM03 S500\nT0101\nG00 X40 Z2\nG01 Z-20 F100\nG00 X50\nM30\n";
    let mut setup = setup(&[text]);
    let mut job = Job::new(Stock::bar(44.0, 0.0, 60.0));
    job.tools.insert(1, Tool::turning());
    job.lengths.insert(1, Default::default());
    // The control believes the tool to be 1 mm of diameter longer than it is.
    let mut row = setup.memory.offsets.get(1);
    row.x = 1.0;
    setup.memory.offsets.set(1, row).unwrap();
    let machining = carried_out(&setup, job);
    let radius = machining.scene().part().greatest_radius(-15.0, -5.0);
    assert!((radius - 20.5).abs() < 1e-9, "{radius}");
}

#[test]
fn the_running_control_leaves_the_part_of_the_preview() {
    let setup = setup(&[SHAFT]);
    let job = guessed(&setup);
    let looked = carried_out(&setup, job.clone());
    let mut simulation = Simulation::new(setup);
    let mut live = Live::new(Machining::new(job));
    simulation.start_automatic();
    let mut found = Vec::new();
    for _ in 0..20 * 60 * 1000 {
        simulation.tick();
        found.extend_from_slice(live.ticked(&simulation));
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
fn a_thread_of_g76_has_its_pitch_and_its_depth_in_the_part() {
    let text = "G50 X100 Z50\nG97 M03 S300\nT0101\nG00 X34 Z6\nG76 P010060 Q100 R0.1\n\
                G76 X28.05 Z-25 P975 Q400 F1.5\nG00 X100 Z50\nM30\n";
    let setup = setup(&[text]);
    let mut job = Job::new(Stock::bar(30.0, 0.0, 60.0));
    job.tools.insert(1, Tool::threading(60.0));
    let machining = carried_out(&setup, job);
    assert_eq!(machining.findings(), []);
    let section = machining.scene().part().section();
    let features =
        gsk_workpiece::measure::features(&section, gsk_workpiece::measure::Side::Outside);
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
    let job = guess::practice();
    job.check().unwrap();
    let mounting = Mounting::of(&job);
    let tip = mounting.tip(1, Point::default(), &Default::default());
    assert!(
        tip.x > job.stock.radius() && tip.z > job.stock.front(),
        "{tip:?}"
    );
}
