//! The load of whole programs: forces of blocks, limits of lathe and inserts, the report.

use gsk_core::command::{ExecutedMove, ProgramId};
use gsk_core::interpreter::{Explanation, ModalState};
use gsk_core::machine::{LatheFault, LoadLimits};
use gsk_core::operation::RunState;
use gsk_core::preview::Lint;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_messages::{Language, Message};
use gsk_runner::curves::RapidRates;
use gsk_runner::execution::{ExecutionLimits, ExecutionWatcher, WatcherStop, execute};
use gsk_runner::machining::live_part::LivePart;
use gsk_runner::machining::{CutLoad, LoadSummary, Machining};
use gsk_runner::report::{ProgramReport, RunEnd, check_program};
use gsk_workpiece::job::Job;
use gsk_workpiece::stock::{Stock, StockMaterial};
use gsk_workpiece::tool::{Holder, Tool};

const PASS: &str = "G50 X100 Z50\nG97 G99 M03 S600\nT0101\nG00 X46 Z2\nG01 Z-30 F0.25\nG00 Z5\n\
                    X100 Z50\nM30\n";

fn job() -> Job {
    let mut job = Job::new(Stock::bar(50.0, 0.0, 70.0));
    job.tools.insert(1, Tool::turning());
    job.tools.insert(2, Tool::boring());
    job.tools.insert(3, Tool::threading(60.0));
    job.tools.insert(4, Tool::drill(20.0));
    job
}

/// The load of a program, and its report with the warnings about the load.
fn check_load(text: &str, job: &Job, limits: &LoadLimits) -> (LoadSummary, ProgramReport) {
    let mut setup = Setup::default();
    setup.memory.programs.open_external(Program::new(text));
    setup.memory.programs.select(ProgramId::External);
    let rates = RapidRates::from_memory(&setup.memory);
    let mut machining = Machining::new(job.clone());
    let mut summary = LoadSummary::default();
    let material = job.cutting_material();
    let mut on_move = |executed: &ExecutedMove| {
        let Some(material) = &material else { return };
        if let Some(load) = machining.execute_move_with_load(executed, rates, material) {
            summary.add_move(&load);
        }
    };
    let language = Some(Language::En);
    let mut report = check_program("part.CNC", &setup, language, &mut on_move, &mut |_| true);
    assert_eq!(report.alarm, None);
    report.add_load(&summary, limits, job, false, language);
    (summary, report)
}

fn load_lints(report: &ProgramReport) -> Vec<Lint> {
    let lints = report.warnings.iter().map(|it| it.lint);
    lints.filter(|it| it.code() >= "W21").collect()
}

#[test]
fn a_pass_has_the_force_of_its_formula() {
    let (summary, report) = check_load(PASS, &job(), &LoadLimits::default());
    let [block] = summary.blocks() else {
        panic!("{:?}", summary.blocks());
    };
    assert_eq!((block.source.line, block.tool), (5, 1));
    // ap 2 mm, f 0.25 mm in C45.
    let chip = block.heaviest.chip;
    assert!((chip.area_mm2 - 0.5).abs() < 1e-3, "{chip:?}");
    let expected = 1500.0 * 0.5 * libm::pow(chip.thickness_mm(), -0.22);
    assert!((block.heaviest.force_n / expected - 1.0).abs() < 1e-3);
    // Torque at the diameter of 50 mm, power at 600 r/min.
    let torque = block.heaviest.force_n * 0.025;
    assert!((block.torque.0 / torque - 1.0).abs() < 1e-3);
    let power = torque * 600.0 / 9549.3;
    assert!(
        (block.power_kw / power - 1.0).abs() < 1e-3,
        "{}",
        block.power_kw
    );
    // 0.25² / (32 · 0.8)
    assert!((block.roughness_um.unwrap_or_default() - 2.4414).abs() < 1e-3);
    assert_eq!(load_lints(&report), []);
    let text = report.to_text(Some(Language::En));
    assert!(
        text.contains("load in C45") && text.contains("gives no grade"),
        "{text}"
    );
}

#[test]
fn a_weak_spindle_and_a_small_insert_are_warned_about() {
    let limits = LoadLimits {
        power_kw: Some(0.5),
        ..LoadLimits::default()
    };
    assert_eq!(
        load_lints(&check_load(PASS, &job(), &limits).1),
        [Lint::SpindlePower]
    );
    let limits = LoadLimits {
        power_kw: Some(3.0),
        base_rpm: Some(1500.0),
        ..LoadLimits::default()
    };
    // 19.1 N·m below the base speed.
    assert_eq!(
        load_lints(&check_load(PASS, &job(), &limits).1),
        [Lint::SpindleTorque]
    );
    // Two thirds of the edge of 12.9 mm, and of the nose of 0.8 mm.
    let deep = PASS.replace("X46", "X30");
    let (_, report) = check_load(&deep, &job(), &LoadLimits::default());
    assert_eq!(load_lints(&report), [Lint::InsertEdge]);
    let fast = PASS.replace("F0.25", "F0.6");
    let (_, report) = check_load(&fast, &job(), &LoadLimits::default());
    assert_eq!(load_lints(&report), [Lint::InsertFeed]);
}

#[test]
fn bars_and_stock_that_protrude_are_warned_about_once() {
    let limits = LoadLimits {
        stock_overhang: Some(1.2),
        ..LoadLimits::default()
    };
    assert_eq!(
        load_lints(&check_load(PASS, &job(), &limits).1),
        [Lint::LongOverhang]
    );
    let drill_and_bore = "G50 X100 Z50\nG97 G99 M03 S600\nT0404\nG00 X0 Z2\nG01 Z-30 F0.1\nG00 Z50\n\
                          X100\nT0202\nG00 X24 Z2\nG01 Z-25 F0.15\nX20\nG00 Z50\nM30\n";
    let mut job = job();
    let (_, report) = check_load(drill_and_bore, &job, &LoadLimits::default());
    assert_eq!(load_lints(&report), [Lint::LongOverhang], "80 mm of 12 mm");
    job.tools.insert(
        2,
        Tool {
            holder: Holder::Bar {
                diameter: 12.0,
                length: 45.0,
            },
            ..Tool::boring()
        },
    );
    let (summary, report) = check_load(drill_and_bore, &job, &LoadLimits::default());
    assert_eq!(load_lints(&report), []);
    // The drill: two lips of 10 mm with half the feed each, at the mean radius of 5 mm, and the
    // chisel edge.
    let drill = &summary.blocks()[0];
    assert!((drill.heaviest.chip.area_mm2 - 10.0 * 0.05).abs() < 1e-3);
    let lips = drill.heaviest.force_n * 0.005;
    assert!((drill.torque.0 / (1.2 * lips) - 1.0).abs() < 1e-3);
    let thrust = 2.5 * 0.5 * drill.heaviest.force_n * libm::sin(59f64.to_radians());
    assert!((drill.feed_force_n / thrust - 1.0).abs() < 1e-3);
    assert_eq!(drill.size_error.0, 0.0, "the lips hold each other");
    // The bar pushes inwards: the bore is too small, by twice what bar and stock give way.
    let bore = &summary.blocks()[1];
    let (error, force) = bore.size_error;
    assert!(force < 0.0 && error < 0.0, "{bore:?}");
    let bar = (45.0 * 45.0 * 45.0) * 64.0
        / (3.0 * 210_000.0 * core::f64::consts::PI * (12.0 * 12.0 * 12.0 * 12.0));
    let ratio = error / (2.0 * force * bar);
    assert!((1.0..1.1).contains(&ratio), "{ratio}");
}

#[test]
fn the_forces_across_and_against_the_feed_are_limited() {
    let (summary, report) = check_load(PASS, &job(), &LoadLimits::default());
    let block = &summary.blocks()[0];
    // An edge at 95° presses along the feed, its nose outwards.
    let share = block.feed_force_n / block.heaviest.force_n;
    assert!((0.42..0.5).contains(&share), "{share}");
    let radial = block.heaviest.radial_force_n / block.heaviest.force_n;
    assert!((0.05..0.25).contains(&radial), "{radial}");
    assert_eq!(load_lints(&report), []);
    let limits = |axis_force_n, grip_nm| LoadLimits {
        axis_force_n,
        grip_nm,
        ..LoadLimits::default()
    };
    let lints = |limits: &LoadLimits| load_lints(&check_load(PASS, &job(), limits).1);
    assert_eq!(lints(&limits(Some(100.0), None)), [Lint::AxisForce]);
    assert_eq!(lints(&limits(None, Some(5.0))), [Lint::ChuckGrip]);
    assert_eq!(lints(&limits(Some(5000.0), Some(500.0))), []);
}

#[test]
fn slender_stock_is_warned_about_by_size_and_a_tailstock_holds_it() {
    let mut job = job();
    job.stock = Stock::bar(12.0, 0.0, 120.0);
    let turn = PASS.replace("X46", "X8").replace("F0.25", "F0.15");
    let (summary, report) = check_load(&turn, &job, &LoadLimits::default());
    assert_eq!(load_lints(&report), [Lint::SizeError]);
    let free = summary.blocks()[0].size_error.0;
    assert!(
        free > 0.1,
        "the stock gives way, the part is thicker: {free}"
    );
    job.stock.tailstock = Some(gsk_workpiece::stock::Tailstock {
        quill: gsk_core::units::Diameter(30.0),
        center: gsk_core::units::Diameter(3.0),
    });
    let (summary, report) = check_load(&turn, &job, &LoadLimits::default());
    assert_eq!(load_lints(&report), []);
    assert!(summary.blocks()[0].size_error.0 < 0.2 * free);
}

#[test]
fn grooving_needs_more_force_than_turning_with_the_same_chip() {
    let text = "G50 X100 Z50\nG97 G99 M03 S600\nT0101\nG00 X52 Z-20\nG01 X40 F0.1\nG00 X60\n\
                X100 Z50\nM30\n";
    let mut job = job();
    job.tools.insert(1, Tool::grooving(3.0));
    let (summary, _) = check_load(text, &job, &LoadLimits::default());
    let [block] = summary.blocks() else {
        panic!("{:?}", summary.blocks());
    };
    let chip = block.heaviest.chip;
    assert!((chip.area_mm2 - 0.3).abs() < 1e-3, "{chip:?}");
    let turning = 1500.0 * chip.area_mm2 * libm::pow(chip.thickness_mm(), -0.22);
    let factor = block.heaviest.force_n / turning;
    assert!((factor - 1.3).abs() < 1e-3, "{factor}");
}

#[test]
fn a_rake_angle_changes_the_force() {
    let mut job = job();
    let force = |job: &Job| {
        let (summary, _) = check_load(PASS, job, &LoadLimits::default());
        summary.blocks()[0].heaviest.force_n
    };
    let plain = force(&job);
    job.rakes.insert(1, 16.0);
    assert!((force(&job) / plain - 0.85).abs() < 1e-6);
    assert_eq!(job.check(), Ok(()));
    job.rakes.insert(1, 60.0);
    assert!(job.check().is_err());
}

#[test]
fn under_g96_the_power_stays_while_the_torque_falls_with_the_diameter() {
    let face = "G50 X100 Z50\nG50 S3000\nG96 G99 M03 S150\nT0101\nG00 X52 Z-1\nG01 X30 F0.2\nG00 Z50\n\
                X100\nM30\n";
    let (summary, _) = check_load(face, &job(), &LoadLimits::default());
    let block = &summary.blocks()[0];
    // 150 m/min at the tip, and a little more at the end of the nose.
    let power = block.heaviest.force_n * 150.0 / 60_000.0;
    assert!(
        (block.power_kw / power - 1.0).abs() < 0.07,
        "{} {power}",
        block.power_kw
    );
    assert!(
        (block.heaviest.speed_m_per_min - 153.0).abs() < 5.0,
        "{block:?}"
    );
}

#[test]
fn a_thread_has_the_force_of_its_groove() {
    let thread = "G50 X100 Z50\nG97 G99 M03 S500\nT0303\nG00 X52 Z6\nG92 X49.4 Z-30 F2\nX48.9\nG00 X100 Z50\n\
                  M30\n";
    let (summary, report) = check_load(thread, &job(), &LoadLimits::default());
    let [first, second] = summary.blocks() else {
        panic!("{:?}", summary.blocks());
    };
    // A V of 60° whose nose of 0.05 mm is 0.05 mm above its corner, with 0.3 and 0.55 mm of depth.
    let corner = 0.05 * 0.05 * (3.0f64.sqrt() - core::f64::consts::PI / 3.0);
    let area = |depth: f64| (depth + 0.05) * (depth + 0.05) / 3.0f64.sqrt() - corner;
    let expected = (area(0.3), area(0.55) - area(0.3));
    let found = (first.heaviest.chip.area_mm2, second.heaviest.chip.area_mm2);
    assert!(
        (found.0 / expected.0 - 1.0).abs() < 0.01,
        "{found:?} {expected:?}"
    );
    assert!(
        (found.1 / expected.1 - 1.0).abs() < 0.01,
        "{found:?} {expected:?}"
    );
    assert!(first.is_thread && first.roughness_um.is_none());
    assert_eq!(load_lints(&report), [], "a lead is no feed");
}

#[test]
fn plastic_has_no_load_and_a_grade_replaces_the_material() {
    let mut job = job();
    job.stock.material = StockMaterial::Plastic;
    let (summary, report) = check_load(PASS, &job, &LoadLimits::default());
    assert!(summary.blocks().is_empty());
    assert!(
        report.to_text(None).contains("no load"),
        "{}",
        report.to_text(None)
    );
    job.stock.grade = Some("TiAl6V4".to_owned());
    let (_, report) = check_load(PASS, &job, &LoadLimits::default());
    let load = report.load.expect("was requested");
    assert_eq!((load.material, load.assumed), (Some("TiAl6V4"), false));
    assert!(load.force_n > 500.0);
}

#[test]
fn the_text_lists_the_heaviest_blocks_and_counts_the_others() {
    let mut text = "G50 X100 Z50\nG97 G99 M03 S600\nT0101\nG00 X46 Z2\n".to_owned();
    for step in 0..80 {
        text += &format!("G01 Z{:.1} F0.{}\n", -0.5 * f64::from(step), 100 + step);
    }
    text += "G00 Z5\nM30\n";
    let (summary, report) = check_load(&text, &job(), &LoadLimits::default());
    assert!(summary.blocks().len() >= 79, "{}", summary.blocks().len());
    let text = report.to_text(None);
    assert_eq!(text.matches(", T01: ").count(), 50, "{text}");
    let omitted = summary.blocks().len() - 50;
    assert!(
        text.contains(&format!("and {omitted} blocks with less force")),
        "{text}"
    );
}

/// The loads of the running control after each tick of a program.
fn live_loads(text: &str, job: Job, measures: bool) -> Vec<Option<CutLoad>> {
    let mut setup = Setup::default();
    setup.memory.programs.open_external(Program::new(text));
    setup.memory.programs.select(ProgramId::External);
    let mut simulation = Simulation::new(setup);
    let mut live = LivePart::new(Machining::new(job));
    live.set_measures_load(measures);
    simulation.start_automatic();
    let mut loads = Vec::new();
    let mut state = RunState::Run;
    while state != RunState::Reset && loads.len() < 120_000 {
        simulation.tick();
        live.follow_tick(&simulation);
        loads.push(live.load());
        state = simulation.cnc.run_state();
    }
    assert_eq!(state, RunState::Reset, "the program does not end");
    loads
}

#[test]
fn the_running_control_has_the_load_of_the_check_and_none_outside_the_cut() {
    let thread = "G50 X100 Z50\nG97 M03 S300\nT0303\nG00 X54 Z6\nG92 X49.4 Z-20 F1.5\nX49\n\
                  G00 X100 Z50\nM30\n";
    let drill = "G50 X100 Z50\nG97 G99 M03 S600\nT0404\nG00 X0 Z2\nG01 Z-15 F0.2\nG00 Z5\n\
                 X100 Z50\nM30\n";
    for text in [PASS, thread, drill] {
        let (summary, _) = check_load(text, &job(), &LoadLimits::default());
        let heaviest = (summary.blocks().iter()).max_by(|a, b| a.power_kw.total_cmp(&b.power_kw));
        let heaviest = heaviest.expect("a cut").heaviest;
        let loads = live_loads(text, job(), true);
        let loads: Vec<CutLoad> = loads.into_iter().map(|load| load.expect("steel")).collect();
        assert_eq!(
            (loads[0].torque_nm, loads.last().unwrap().torque_nm),
            (0.0, 0.0)
        );
        let mut cuts: Vec<CutLoad> = loads
            .iter()
            .filter(|it| it.force_n > 0.0)
            .copied()
            .collect();
        assert!(
            cuts.len() > 200 && cuts.len() < loads.len() * 9 / 10,
            "{}",
            cuts.len()
        );
        cuts.sort_by(|a, b| a.torque_nm.total_cmp(&b.torque_nm));
        // The end of a program of one pass; the last pass of a thread is the heaviest or the first.
        let usual = cuts[cuts.len() * 3 / 4];
        for (name, found, wanted) in [
            ("torque", usual.torque_nm, heaviest.torque_nm),
            ("radial", usual.radial_force_n, heaviest.radial_force_n),
            ("axial", usual.axial_force_n, heaviest.axial_force_n),
        ] {
            let error = (found - wanted).abs() / wanted.abs().max(1.0);
            assert!(error < 0.05, "{text} {name}: {found} instead of {wanted}");
        }
    }
    let idle = live_loads(PASS, job(), false);
    assert!(idle.iter().all(|load| *load == Some(CutLoad::default())));
    let mut plastic = job();
    plastic.stock.material = StockMaterial::Plastic;
    let unknown = live_loads(PASS, plastic, true);
    assert!(
        unknown.iter().all(Option::is_none),
        "no constants for plastic"
    );
}

/// Cuts the part of a run, and ends it where the stock comes loose.
struct LooseStock(LivePart);

impl ExecutionWatcher for LooseStock {
    fn on_move(&mut self, _: &ExecutedMove) {}

    fn on_tick(&mut self, _: u64, _: Point, simulation: &Simulation) -> Option<WatcherStop> {
        self.0.follow_tick(simulation);
        self.cut_fault().map(|_| WatcherStop::Overload)
    }

    fn cut_fault(&self) -> Option<LatheFault> {
        self.0.cut_fault().map(|it| it.fault())
    }

    fn on_block(&mut self, _: u32, _: &str, _: &ModalState) {}

    fn on_pass(&mut self, _: &Explanation) {}

    fn wants_explanations(&self) -> bool {
        false
    }

    fn show(&mut self, _: &Message) {}
}

#[test]
fn an_overload_sets_its_fault_and_the_slides_stop() {
    let mut setup = Setup::default();
    setup.lathe.load.grip_nm = Some(2.0);
    setup.memory.programs.open_external(Program::new(PASS));
    setup.memory.programs.select(ProgramId::External);
    let mut live = LivePart::new(Machining::new(job()));
    live.set_overload(true);
    let mut watcher = LooseStock(live);
    let limits = ExecutionLimits {
        parts: 1,
        time_ms: 60_000,
    };
    let simulation = Simulation::new(setup);
    let run = execute("pass", simulation, limits, None, None, &mut watcher, None);
    let (report, simulation) = run.expect("a run");
    assert_eq!(report.end, RunEnd::Overload);
    assert!(simulation.lathe.has_fault(LatheFault::StockLoose));
    let z = simulation.cnc.position_absolute().z;
    assert!(!simulation.cnc.is_moving() && z > -2.0, "{z}");
}
