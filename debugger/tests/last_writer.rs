//! The last writer of random bits and variables, found backwards, against a search through every
//! tick of the run.
#![allow(clippy::expect_used)]

use gsk_core::command::ProgramId;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_debugger::debugged_run::{DebuggedRun, RunProgress};
use gsk_debugger::history::SnapshotHistory;
use gsk_debugger::location::BreakLocation;
use gsk_debugger::session::{DebugSession, DebugStep, StopReason};
use gsk_debugger::source_files::ProgramSources;
use gsk_debugger::watch::{WatchTarget, WatchedValue};

/// Writes variables, offsets and outputs, in a loop with a counter.
const PROGRAM: &str = "G50 X100 Z100;\nG97 G98 S600 M03;\nG65 H01 P#200 Q0;\nN10 G00 X90 Z98;\n\
    M08;\nG65 H02 P#200 Q#200 R1;\nG01 U-1 F3000;\nM09;\nT0102;\nG65 H03 P#201 Q9 R#200;\n\
    G00 X100 Z100;\nG65 H04 P#202 Q#200 R3;\nT0101;\nG65 H86 P10 Q#200 R4;\nM05;\nG04 X0.3;\n\
    M04;\nG04 X0.2;\nM30;\n";
const TARGETS: [&str; 16] = [
    "#200", "#201", "#202", "#203", "Y5.0", "Y5.1", "Y1.2", "Y0.4", "Y0.3", "F9.7", "R100.0",
    "line", "S", "T", "M", "X20.1",
];
/// Number of random targets and moments.
const SEARCHES: usize = 200;

fn run() -> DebuggedRun {
    let mut setup = Setup::default();
    setup.memory.programs.open_external(Program::new(PROGRAM));
    setup.memory.programs.select(ProgramId::External);
    DebuggedRun::new(Simulation::new(setup), None)
}

/// The values of all targets after each tick, from tick 0.
fn all_values(targets: &[WatchTarget]) -> Vec<Vec<Option<WatchedValue>>> {
    let mut run = run();
    let read = |run: &DebuggedRun| {
        let values = targets.iter().map(|it| it.read(run.simulation()).ok());
        values.collect::<Vec<_>>()
    };
    let mut values = vec![read(&run)];
    while run.progress() != RunProgress::Ended {
        run.tick();
        values.push(read(&run));
    }
    values
}

/// A generator with a fixed sequence (xorshift).
fn below(state: &mut u64, end: usize) -> usize {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state % end as u64) as usize
}

#[test]
fn the_last_writer_is_the_last_change_of_a_search_through_every_tick() {
    let names = TARGETS.map(|name| WatchTarget::parse(name).expect(name));
    let values = all_values(&names);
    let mut random = 0x9e37_79b9_7f4a_7c15;
    let mut found = 0;
    for _ in 0..SEARCHES {
        let index = below(&mut random, TARGETS.len());
        let moment = 1 + below(&mut random, values.len() - 2);
        let is_change = |tick: &usize| values[*tick][index] != values[*tick - 1][index];
        let wanted = (1..moment).rev().find(is_change);

        let mut session = DebugSession::new(run(), Box::<SnapshotHistory>::default());
        session.begin_step(DebugStep::Continue);
        assert_eq!(session.advance(moment as u64), None);
        let name = TARGETS[index];
        let location = BreakLocation::parse(name, &ProgramSources::default());
        session.breakpoints.add(location.expect(name));
        session.resync_breakpoints();
        let reason = session.go_back(DebugStep::Continue);
        let context = format!("{name} before tick {moment}");
        match wanted {
            Some(tick) => {
                assert!(matches!(reason, StopReason::Breakpoint(_)), "{context}");
                assert_eq!(session.run().ticks(), tick as u64, "{context}");
                found += 1;
            }
            None => assert_eq!(reason, StopReason::Entry, "{context}"),
        }
    }
    assert!(found > SEARCHES / 2, "{found} writers");
    println!("{found} of {SEARCHES} values have a writer, found at its tick");
}
