//! A restart at a block with a board: from a referenced position, on the pulse of an
//! uninterrupted run.

use gsk_core::cnc::ControlRequest;
use gsk_core::command::ProgramId;
use gsk_core::operation::RunState;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_messages::{Message, say};
use gsk_runner::machining::Machining;
use gsk_runner::machining::guess::guess_program_job;
use gsk_runner::machining::live_part::LivePart;
use gsk_runner::restart::{LineWatcher, RestartPlan, RestartWords, find_block, plan_restart};
use gsk_twins::grbl::Variant;
use gsk_workpiece::job::DiameterPoint;

use super::{GROOVE, LINES, PIN, SHAFT, SHORT, assert_counts_agree};
use crate::bench::board::{BenchBoard, LinkedMachine};
use crate::bench::keys::{CYCLE_START, RESET};

/// Plans the restart at a line of the opened program.
fn plan<T: BenchBoard>(machine: &LinkedMachine<T>, line: u32) -> Result<RestartPlan, Message> {
    plan_at(&machine.simulation, (line, None), None)
}

/// Plans the restart at a line, or at a pass of the cycle there.
pub fn plan_at(
    now: &Simulation,
    (line, pass): (u32, Option<u64>),
    part: Option<&LivePart>,
) -> Result<RestartPlan, Message> {
    let program = now.cnc.programs().get(ProgramId::External).unwrap();
    let mut watcher = LineWatcher::new(ProgramId::External, program, line);
    let target = find_block(now, None, &mut watcher, pass)?;
    plan_restart(now, part, &target, &RestartWords::default())
}

fn wait_for_standstill<T: BenchBoard>(machine: &mut LinkedMachine<T>) {
    let stood = machine.run_until(300_000, |machine| {
        let cnc = &machine.simulation.cnc;
        cnc.run_state() != RunState::Run && !cnc.is_moving() && !machine.linked.has_pending_motion()
    });
    assert!(stood, "{:?}", machine.alarms());
}

/// Interrupts a program with RESET after some time, restarts it at a line, and compares its end
/// with that of an uninterrupted run.
fn restart_at<T: BenchBoard>(
    machine: &LinkedMachine<T>,
    (text, sub): (&str, Option<&str>),
    interrupted_after_ms: u32,
    line: u32,
) {
    let mut whole = machine.clone();
    whole.load(text, sub);
    whole.start_program();
    whole.run_to_end(3_600_000);
    let mut machine = machine.clone();
    machine.load(text, sub);
    machine.start_program();
    machine.run_ms(interrupted_after_ms);
    assert_eq!(
        machine.simulation.cnc.run_state(),
        RunState::Run,
        "too late"
    );
    machine.press(RESET);
    machine.run_ms(500);
    wait_for_standstill(&mut machine);
    assert_eq!(machine.alarms(), [0_u16; 0]);
    let stood = machine.made_pulses();

    let plan = plan(&machine, line).unwrap_or_else(|why| panic!("line {line}: {why}"));
    assert!(plan.moves_real_slides);
    assert!(!plan.differences.is_empty());
    let request = ControlRequest::Restart(plan.restart);
    machine.simulation.cnc.request(request).unwrap();
    machine.run_ms(1000);
    assert_eq!(machine.made_pulses(), stood, "the request moves nothing");
    machine.press(CYCLE_START);
    machine.run_ms(100);
    wait_for_standstill(&mut machine);
    assert_eq!(machine.alarms(), [0_u16; 0], "line {line}");
    assert_eq!(machine.simulation.cnc.run_state(), RunState::Stop);
    assert!(!machine.simulation.cnc.has_restart(), "at the start point");
    assert_counts_agree(&machine);
    machine.press(CYCLE_START);
    machine.run_to_end(3_600_000);
    assert_eq!(machine.alarms(), [0_u16; 0], "line {line}");
    assert_counts_agree(&machine);
    assert_eq!(machine.made_pulses(), whole.made_pulses(), "line {line}");
}

#[test]
fn a_restart_on_a_board_ends_on_the_pulse_of_a_whole_run() {
    for variant in LINES {
        let machine = LinkedMachine::referenced(variant);
        restart_at(&machine, (SHORT, None), 9000, 5);
        restart_at(&machine, (SHORT, None), 6000, 6);
    }
    let machine = LinkedMachine::timed_referenced();
    restart_at(&machine, (SHORT, None), 9000, 5);
}

/// Cycles and a subprogram.
#[test]
fn a_restart_in_cycles_and_after_a_call_ends_on_the_pulse() {
    let line_of = |text: &str, word: &str| {
        let index = text.lines().position(|line| line.contains(word)).unwrap();
        index as u32 + 1
    };
    let machine = LinkedMachine::referenced(Variant::GrblHal);
    restart_at(&machine, (SHAFT, None), 60_000, line_of(SHAFT, "N160"));
    restart_at(&machine, (PIN, Some(GROOVE)), 40_000, line_of(PIN, "N120"));
}

#[test]
fn without_a_reference_no_restart_is_planned() {
    let mut machine = LinkedMachine::connected(Variant::Grbl);
    machine.load(SHORT, None);
    machine.run_ms(100);
    let why = plan(&machine, 5).unwrap_err();
    assert_eq!(why, say::reference_return_needed());
}

/// A plan of before does not fit slides that have moved since.
#[test]
fn a_plan_expires_when_the_slides_move() {
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.load(SHORT, None);
    machine.run_ms(100);
    let plan = plan(&machine, 5).unwrap();
    machine.start_program();
    machine.run_ms(6000);
    machine.press(RESET);
    machine.run_ms(500);
    wait_for_standstill(&mut machine);
    let request = ControlRequest::Restart(plan.restart);
    let refusal = machine.simulation.cnc.request_refusal(&request);
    assert_eq!(refusal, Some(say::restart_state_changed()));
}

/// The guessed part is where the program will place it by G50, which has not run yet.
#[test]
fn a_restart_before_the_first_g50_is_checked_where_the_program_has_the_part() {
    const TURNED: &str = "O0007\nG50 X100 Z100\nG97 G98 S800 M03\nT0101 M08\nG00 X52 Z2\n\
                          G01 X40 F120\nZ-10\nM30\n";
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.load(TURNED, None);
    machine.run_ms(100);
    let now = &machine.simulation;
    assert_eq!(now.cnc.program_zero(), None, "no G50 has run");
    let mut setup = Setup::delivered();
    let programs = &mut setup.memory.programs;
    programs.open_external(Program::new(TURNED));
    programs.select(ProgramId::External);
    let mut job = guess_program_job(&setup, &mut |_| true).expect("a job");
    let part = LivePart::new(Machining::new(job.clone()));
    let planned = plan_at(now, (7, None), Some(&part));
    assert!(planned.is_ok(), "{}", planned.unwrap_err());
    // The job has its part where the way leads through.
    let start = now.cnc.position_machine() + Point::new(-20.0, -40.0);
    job.zero = Some(DiameterPoint::from(start));
    let part = LivePart::new(Machining::new(job));
    let refusal = plan_at(now, (7, None), Some(&part)).unwrap_err();
    assert_eq!(refusal, say::restart_approach_collision());
}
