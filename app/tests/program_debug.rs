//! The program view as a debugger: ladder slots and watched values.

use gsk_debugger::watch::WatchTarget;
use gsk_host::kernel::{BreakpointCommand, Command};

use crate::common::WindowBench;

#[test]
fn a_slot_of_the_ladder_is_eight_ticks() {
    let mut bench = WindowBench::new();
    bench
        .console
        .send(Command::Watch(vec![WatchTarget::parse("tick").unwrap()]));
    let mut ticks = Vec::new();
    for _ in 0..3 {
        let slot = BreakpointCommand::NextSlot;
        bench.console.send(Command::Breakpoints(slot));
        bench.run(100);
        let snapshot = bench.kernel.snapshot();
        assert!(snapshot.halt.is_some());
        let tick: u64 = snapshot.watches[0].value.clone().unwrap().parse().unwrap();
        ticks.push(tick);
    }
    assert_eq!([ticks[1] - ticks[0], ticks[2] - ticks[1]], [8, 8]);
}
