//! A program with a subprogram under the debugger: steps forwards and backwards.
#![allow(clippy::expect_used, clippy::unwrap_used)]

use gsk_core::command::ProgramId;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_debugger::debugged_run::DebuggedRun;
use gsk_debugger::history::SnapshotHistory;
use gsk_debugger::location::BreakLocation;
use gsk_debugger::session::{DebugSession, DebugStep, StopReason};
use gsk_debugger::source_files::{ProgramSource, ProgramSources};

const MAIN: &str = "G00 X50 Z5;\nG65 H01 P#200 Q3;\nG01 X40 F500;\nM98 P0012;\nG01 X45;\nG65 H01 P#200 Q7;\nM30;\n";
const SUB: &str = "O0012;\nG01 Z4;\nG01 Z3;\nM99;\n";

fn session() -> DebugSession {
    let mut setup = Setup::default();
    let programs = &mut setup.memory.programs;
    programs.store(SUB).expect("subprogram");
    programs.open_external(Program::new(MAIN));
    programs.select(ProgramId::External);
    let run = DebuggedRun::new(Simulation::new(setup), None);
    DebugSession::new(run, Box::<SnapshotHistory>::default())
}

fn add(session: &mut DebugSession, text: &str) {
    let main = ProgramSource {
        path: "main".to_owned(),
        programs: vec![ProgramId::External],
    };
    let sources = ProgramSources::new(vec![main]);
    let location = BreakLocation::parse(text, &sources).expect(text);
    session.breakpoints.add(location);
    session.resync_breakpoints();
}

fn step(session: &mut DebugSession, kind: DebugStep) -> StopReason {
    session.begin_step(kind);
    session.advance(1_000_000).expect("a stop")
}

/// The call stack as `program:line`; the main program is `main`.
fn frames(session: &DebugSession) -> Vec<String> {
    let frames = session.run().frames();
    let names = frames.iter().map(|frame| match frame.program {
        ProgramId::Stored(number) => format!("O{number}:{}", frame.line),
        _ => format!("main:{}", frame.line),
    });
    names.collect()
}

#[test]
fn steps_follow_the_call_stack() {
    let mut session = session();
    add(&mut session, "O12:3");
    assert!(matches!(
        step(&mut session, DebugStep::Continue),
        StopReason::Breakpoint(_)
    ));
    assert_eq!(frames(&session), ["O12:3", "main:4"]);
    // M99 only returns: it is no block of the machine.
    assert_eq!(step(&mut session, DebugStep::Into), StopReason::Step);
    assert_eq!(frames(&session), ["main:5"]);
}

#[test]
fn before_the_first_block_there_is_one_frame_at_it() {
    let mut session = session();
    assert_eq!(frames(&session), ["main:1"]);
    step(&mut session, DebugStep::Slot);
    assert_eq!(frames(&session), ["main:1"]);
    assert_eq!(session.run().calls().block(), None);
    assert_eq!(step(&mut session, DebugStep::Over), StopReason::Step);
    assert_eq!(frames(&session), ["main:2"]);
    assert_eq!(session.go_back(DebugStep::Over), StopReason::Entry);
    assert_eq!(frames(&session), ["main:1"]);
    assert_eq!(session.run().ticks(), 0);
    add(&mut session, "1");
    let reason = step(&mut session, DebugStep::Continue);
    assert!(matches!(reason, StopReason::Breakpoint(_)), "{reason:?}");
    assert_eq!(frames(&session), ["main:1"]);
}

/// Also over an M00: the operator pressed cycle start there once.
#[test]
fn slots_of_the_ladder_lead_back_to_the_states_of_before() {
    let mut setup = Setup::default();
    let text = "G00 X50 Z5;\nM00;\nG98 G01 X40 F500;\nM30;\n";
    setup.memory.programs.open_external(Program::new(text));
    setup.memory.programs.select(ProgramId::External);
    let run = DebuggedRun::new(Simulation::new(setup), None);
    let mut session = DebugSession::new(run, Box::<SnapshotHistory>::default());
    let reason = step(&mut session, DebugStep::Continue);
    assert_eq!(reason, StopReason::ProgramStop);
    let mut states = vec![session.run().simulation().clone()];
    for _ in 0..30 {
        assert_eq!(step(&mut session, DebugStep::Slot), StopReason::Step);
        states.push(session.run().simulation().clone());
    }
    let now = states.pop().expect("a state");
    let first = states.remove(0);
    for state in states.iter().rev() {
        assert_eq!(session.go_back(DebugStep::Slot), StopReason::Step);
        assert!(session.run().simulation() == state, "another state");
    }
    session.go_back(DebugStep::Slot);
    assert!(session.run().ticks() <= first.cnc.ticks());
    for state in &states {
        step(&mut session, DebugStep::Slot);
        while session.run().ticks() < state.cnc.ticks() {
            step(&mut session, DebugStep::Slot);
        }
        assert!(session.run().simulation() == state, "another state");
    }
    step(&mut session, DebugStep::Slot);
    assert!(*session.run().simulation() == now);
}

#[test]
fn a_call_is_reached_with_the_first_block_of_its_program() {
    let mut session = session();
    add(&mut session, "4");
    let reason = step(&mut session, DebugStep::Continue);
    let StopReason::Breakpoint(hits) = reason else {
        panic!("{reason:?}");
    };
    assert_eq!(hits[0].block.map(|block| block.line), Some(4));
    assert_eq!(frames(&session), ["O12:2", "main:4"]);
}

#[test]
fn a_block_that_only_calls_is_reached_backwards_too() {
    let mut session = session();
    add(&mut session, "4");
    step(&mut session, DebugStep::Continue);
    step(&mut session, DebugStep::Out);
    assert_eq!(frames(&session), ["main:5"]);
    let reason = session.go_back(DebugStep::Continue);
    assert!(matches!(reason, StopReason::Breakpoint(_)), "{reason:?}");
    assert_eq!(frames(&session), ["O12:2", "main:4"]);
}

#[test]
fn an_alarm_stops_at_the_faulty_block() {
    let mut setup = Setup::default();
    let text = "G98 G01 X50 F500;\nG01 Z5;\nG19 X1;\nM30;\n";
    setup.memory.programs.open_external(Program::new(text));
    setup.memory.programs.select(ProgramId::External);
    let run = DebuggedRun::new(Simulation::new(setup), None);
    let mut session = DebugSession::new(run, Box::<SnapshotHistory>::default());
    session.filter.alarms = true;
    let reason = step(&mut session, DebugStep::Continue);
    assert!(matches!(reason, StopReason::Alarm(_)), "{reason:?}");
    assert_eq!(session.stop_block().map(|block| block.line), Some(3));
}

#[test]
fn over_stays_in_the_main_program_and_out_leaves_the_subprogram() {
    let mut session = session();
    add(&mut session, "3");
    step(&mut session, DebugStep::Continue);
    assert_eq!(frames(&session), ["main:3"]);
    assert_eq!(step(&mut session, DebugStep::Over), StopReason::Step);
    assert_eq!(frames(&session), ["main:5"]);
    assert_eq!(session.go_back(DebugStep::Into), StopReason::Step);
    assert_eq!(frames(&session), ["O12:3", "main:4"]);
    assert_eq!(step(&mut session, DebugStep::Out), StopReason::Step);
    assert_eq!(frames(&session), ["main:5"]);
    assert!(matches!(
        session.go_back(DebugStep::Over),
        StopReason::Breakpoint(_)
    ));
    assert_eq!(frames(&session), ["main:3"]);
    step(&mut session, DebugStep::Into);
    assert_eq!(frames(&session), ["O12:2", "main:4"]);
}

#[test]
fn going_back_and_on_gives_the_same_machine() {
    let mut session = session();
    add(&mut session, "5");
    step(&mut session, DebugStep::Continue);
    let there = session.run().simulation().clone();
    assert_eq!(session.go_back(DebugStep::Into), StopReason::Step);
    assert!(session.run().ticks() < there.cnc.ticks());
    assert_eq!(session.go_back(DebugStep::Continue), StopReason::Entry);
    assert_eq!(session.run().ticks(), 0);
    // The breakpoint is still armed.
    assert!(matches!(
        step(&mut session, DebugStep::Continue),
        StopReason::Breakpoint(_)
    ));
    assert!(*session.run().simulation() == there);
}

#[test]
fn the_last_writer_of_a_variable_is_found_backwards() {
    let mut session = session();
    assert_eq!(step(&mut session, DebugStep::Continue), StopReason::Ended);
    add(&mut session, "#200");
    let value = |session: &DebugSession| session.run().simulation().cnc.real_variable(200);
    for (after, before) in [(7.0, 3.0), (3.0, 0.0)] {
        assert!(matches!(
            session.go_back(DebugStep::Continue),
            StopReason::Breakpoint(_)
        ));
        assert_eq!(value(&session), Some(after));
        session.go_back(DebugStep::Tick);
        assert_eq!(value(&session).unwrap_or(0.0), before);
        // Back to the change itself, so that the next search begins before it.
        step(&mut session, DebugStep::Tick);
    }
}

#[test]
fn a_condition_decides_at_the_block() {
    for (condition, stops) in [("#200 EQ 3", true), ("#200 GT 5", false), ("1/0", true)] {
        let mut session = session();
        add(&mut session, &format!("3 if {condition}"));
        let reason = step(&mut session, DebugStep::Continue);
        assert_eq!(reason != StopReason::Ended, stops, "{condition}");
        if let StopReason::Breakpoint(hits) = reason {
            assert_eq!(hits[0].fault.is_some(), condition == "1/0");
        }
    }
}

#[test]
fn a_position_and_an_end_stop_the_run() {
    let mut session = session();
    add(&mut session, "X<42");
    assert!(matches!(
        step(&mut session, DebugStep::Continue),
        StopReason::Breakpoint(_)
    ));
    let x = session
        .run()
        .simulation()
        .cnc
        .position_absolute()
        .diameter();
    assert!(x.0 < 42.0 && x.0 > 41.9, "{x:?}");
    session.begin_run_to(ProgramId::External, 6);
    assert_eq!(session.advance(1_000_000), Some(StopReason::Reached));
    assert_eq!(frames(&session), ["main:6"]);
    assert_eq!(step(&mut session, DebugStep::Continue), StopReason::Ended);
}
