//! Fuzzes the whole control with its lathe: any program runs for some seconds.

use core::mem::discriminant;
use std::cell::OnceCell;

use gsk_core::cnc::Event;
use gsk_core::operation::RunState;
use gsk_core::simulation::Simulation;

use super::{settings, watch};

/// Machine time for which the program runs, ticks (ms).
const RUN_TICKS: u32 = 4000;

pub(super) fn fuzz_simulation(input: &[u8]) {
    thread_local! {
        static WARM: OnceCell<()> = const { OnceCell::new() };
    }
    let text = String::from_utf8_lossy(input);
    let setup = settings::setup_from_input(&text);
    // The first control of a process compiles the ladder.
    WARM.with(|warm| {
        warm.get_or_init(|| drop(Simulation::new(setup.clone())));
    });
    let mut simulation = Simulation::new(setup);
    simulation.start_automatic();
    for _ in 0..RUN_TICKS {
        watch::run_unit(|| simulation.tick());
        let cnc = &simulation.cnc;
        for event in cnc.events() {
            watch::record_event("event", (discriminant(event), cnc.modal().motion.number()));
            if let Event::AlarmRaised(alarm) = event {
                watch::record_event("alarm", alarm.number);
            }
        }
        let position = cnc.position_machine();
        assert!(
            position.x.is_finite() && position.z.is_finite(),
            "the tool is at {position:?}"
        );
        assert!(cnc.feed_actual().is_finite());
        if cnc.run_state() == RunState::Reset && !cnc.is_moving() {
            break;
        }
    }
    watch::record_event("state", format!("{:?}", simulation.cnc.run_state()));
}
