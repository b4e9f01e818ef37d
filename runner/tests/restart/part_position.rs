//! The position of the part in a restart: the skipped blocks place a part whose position neither
//! a job nor a cut gives.

use gsk_core::command::ProgramId;
use gsk_core::memory::ToolOffset;
use gsk_core::simulation::Simulation;
use gsk_core::units::{Diameter, Point};
use gsk_messages::say;
use gsk_runner::machining::Machining;
use gsk_runner::machining::guess::guess_program_job;
use gsk_runner::machining::live_part::LivePart;
use gsk_runner::restart::{LineWatcher, RestartPlan, RestartWords, find_block, plan_restart};
use gsk_workpiece::job::{DiameterPoint, Job};

use super::programs::TestProgram;
use super::{AUTO_KEY, RESET_KEY, RecordedRun, START_KEY, setup};

const TURNED: &str = "O0007;\nG50 X100 Z100;\nG97 G98 S800 M03;\nT0101 M08;\nG00 X52 Z2;\n\
                      G01 X40 F120;\nZ-10;\nM30;\n";
/// The tool is changed where the work zero before G50 has the bar.
const CHANGED: &str = "O0009;\nG50 X100 Z100;\nG97 G98 S800 M03;\nG00 X120 Z70;\nT0202;\n\
                       G00 X52 Z2;\nG01 X40 F120;\nZ-10;\nG00 X60;\nX100 Z100;\nM30;\n";
/// Another tool with an offset, and a second zero after its first cut.
const TWO_ZEROS: &str = "O0008;\nG50 X100 Z100;\nG97 G98 S800 M03;\nT0101;\nG00 X52 Z2;\n\
                         G01 Z-8 F200;\nG00 X100 Z100;\nT0202;\nG00 X50 Z2;\nG01 Z-6 F200;\n\
                         G00 X60 Z2;\nG50 X70 Z12;\nG00 X58 Z12;\nG01 Z2 F200;\nG00 X70 Z12;\n\
                         X110 Z110;\nM30;\n";

const fn program(text: &'static str) -> TestProgram {
    TestProgram {
        name: "position",
        text,
        subprograms: &[],
        macro_b: false,
    }
}

/// The machine after power-on, with machine and work coordinates X0 Z0, and the job that the
/// program suggests.
fn machine(text: &'static str) -> (Simulation, Job) {
    let mut setup = setup(&program(text));
    for number in 1..=3 {
        // Without a tip number the moves alone show how a tool is mounted.
        let offset = setup.memory.offsets.get(number);
        let row = ToolOffset { t: 0, ..offset };
        setup.memory.offsets.set(number, row).unwrap();
    }
    let job = guess_program_job(&setup, &mut |_| true).expect("a job");
    assert_eq!(job.zero, None);
    let mut simulation = Simulation::new(setup);
    simulation.place_slides(Point::default());
    (simulation, job)
}

/// Plans as the window does: the search does not cut, and the way is checked with the part in
/// the machine.
fn plan(
    now: &Simulation,
    part: &LivePart,
    line: u32,
) -> Result<RestartPlan, gsk_messages::Message> {
    let text = now.cnc.programs().get(ProgramId::External).unwrap();
    let mut watcher = LineWatcher::new(ProgramId::External, text, line);
    let found = find_block(now, None, &mut watcher, None)?;
    plan_restart(now, Some(part), &found, &RestartWords::default())
}

fn uncut(job: &Job) -> LivePart {
    LivePart::new(Machining::new(job.clone()))
}

/// Restarts at a line, runs to the end and returns the run.
fn run_from(now: Simulation, part: LivePart, line: u32) -> RecordedRun {
    let plan = plan(&now, &part, line).unwrap_or_else(|why| panic!("line {line}: {why}"));
    let mut run = RecordedRun::new(now, part);
    let request = gsk_core::cnc::ControlRequest::Restart(plan.restart);
    run.simulation.cnc.request(request).unwrap();
    run.press(AUTO_KEY);
    run.press(START_KEY);
    while run.simulation.cnc.has_restart() || run.simulation.cnc.is_moving() {
        assert!(run.path.len() < 300_000, "no approach");
        run.tick();
    }
    run.press(START_KEY);
    run.run(600_000);
    assert!(run.is_over);
    run.settle();
    run
}

#[test]
fn a_fresh_machine_restarts_beside_the_part_of_its_program() {
    let (now, job) = machine(TURNED);
    assert_eq!(now.cnc.program_zero(), None, "no G50 has run");
    let run = run_from(now, uncut(&job), 7);
    assert_eq!(run.part.machining().findings(), []);
    let removed = run.part.machining().removed_volume();
    assert!(removed > 1000.0, "{removed}");
}

#[test]
fn the_way_to_the_tool_change_is_judged_where_the_program_has_the_part() {
    let (now, job) = machine(CHANGED);
    let run = run_from(now, uncut(&job), 8);
    assert_eq!(run.part.machining().findings(), []);
}

/// The tip of tool 2 in the part after a restart is that of the whole run.
#[test]
fn a_second_zero_and_an_offset_place_the_part_as_a_whole_run_does() {
    let (now, job) = machine(TWO_ZEROS);
    let mut whole = RecordedRun::new(now.clone(), uncut(&job));
    whole.press(AUTO_KEY);
    whole.press(START_KEY);
    whole.run(600_000);
    let zero = |run: &RecordedRun, tool| {
        let frame = run.simulation.cnc.frame();
        let mounting = run.part.machining().mounting().clone();
        mounting.slide_at_part_zero(tool, &frame)
    };
    for line in [6, 10, 14] {
        let run = run_from(now.clone(), uncut(&job), line);
        assert_eq!(run.part.machining().findings(), [], "line {line}");
        assert_eq!(zero(&run, 2), zero(&whole, 2), "line {line}");
    }
}

#[test]
fn a_job_with_a_zero_keeps_its_part_where_it_is() {
    let (now, mut job) = machine(TURNED);
    // G50 X100 Z100 where the slides are after power-on.
    job.zero = Some(DiameterPoint {
        x: Diameter(-100.0),
        z: -100.0,
    });
    let run = run_from(now.clone(), uncut(&job), 7);
    assert_eq!(run.part.machining().findings(), []);
    // The bar is where the way leads through.
    job.zero = Some(DiameterPoint {
        x: Diameter(-40.0),
        z: -40.0,
    });
    let why = plan(&now, &uncut(&job), 7).unwrap_err();
    assert_eq!(why, say::restart_approach_collision());
}

#[test]
fn after_g50_slides_within_the_part_are_refused() {
    let (now, job) = machine(TURNED);
    let mut run = RecordedRun::new(now, uncut(&job));
    run.press(AUTO_KEY);
    run.press(START_KEY);
    run.run(1000);
    run.press(RESET_KEY);
    run.settle();
    let zero = run.simulation.cnc.program_zero().expect("G50 has run");
    for (away, is_refused) in [
        (Point::new(0.0, 0.0), false),
        (Point::new(-10.0, -20.0), false),
        // X20 Z-20: within the bar.
        (Point::new(-40.0, -120.0), true),
    ] {
        let mut now = run.simulation.clone();
        now.place_slides(zero + away);
        let mut part = run.part.clone();
        part.change_machine();
        for part in [part, uncut(&job)] {
            let planned = plan(&now, &part, 7);
            let why = is_refused.then(say::restart_approach_collision);
            assert_eq!(planned.err(), why, "{away:?}");
        }
    }
}
