//! A restart in the middle of a thread with a spindle that varies: the passes that follow meet
//! the groove of those before.

use gsk_core::operation::RunState;

use super::machine::{COUNTS, PicoMachine};
use super::threads::{PULSE_MM, disturb, passes, spread};
use crate::bench::keys::{AUTO, CYCLE_START, FEED_HOLD, RESET};
use crate::step_link::restart::THREADS;

fn start(machine: &mut PicoMachine) {
    machine.press(CYCLE_START);
    machine.finish(300_000);
    assert_eq!(machine.alarms(), [""; 0]);
}

#[test]
fn the_passes_after_a_restart_meet_the_groove_of_a_spindle_that_varies() {
    for thread in &THREADS {
        let text = thread.text;
        let mut machine = PicoMachine::referenced(&[]);
        disturb(&mut machine, 0);
        machine.start_program(&thread.program());
        machine.finish(300_000);
        assert_eq!(machine.alarms(), [""; 0], "{text}");
        let (end, whole) = (machine.twin.pulses(), machine.steps.len());
        machine.press(AUTO);
        machine.press(CYCLE_START);
        let is_in_thread = machine.run_until(60_000, |machine| {
            machine.simulation.cnc.position_absolute().z < -10.0
        });
        assert!(is_in_thread, "{text}");
        // The thread is cut to its end first.
        machine.press(FEED_HOLD);
        machine.finish(60_000);
        machine.press(RESET);
        machine.run_ms(500);
        assert_eq!(machine.alarms(), [""; 0], "{text}");
        thread.request(&mut machine.simulation);
        start(&mut machine);
        assert!(!machine.simulation.cnc.has_restart(), "{text}");
        assert_eq!(machine.simulation.cnc.run_state(), RunState::Stop, "{text}");
        machine.steps.truncate(whole);
        start(&mut machine);
        machine.assert_agrees();
        assert_eq!(machine.twin.pulses(), end, "{text}");
        let grooves = passes(&machine, thread.pitch, (-18.0, -9.0), thread.direction());
        let (all, rest) = thread.passes;
        assert_eq!(grooves.len(), all + rest, "{text}");
        // A step, and a count of the encoder.
        let most = PULSE_MM + thread.pitch * thread.starts / f64::from(COUNTS);
        // G76 moves each pass along the flank: each is compared with the same pass of before.
        let (whole, restarted) = grooves.split_at(all);
        for (made, wanted) in restarted.iter().zip(&whole[all - rest..]) {
            let distance = spread(&[made.clone(), wanted.clone()]);
            assert!(distance <= most, "{text}: {distance}");
        }
    }
}
