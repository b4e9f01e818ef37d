//! The whole control with a board of timed steps in place of its simulated slides.

use gsk_core::cnc::ControlRequest;
use gsk_core::operation::RunState;
use gsk_link::LinkState;

use super::machine::StepMachine;
use crate::bench::keys::CYCLE_START;

const SHAFT: &str = include_str!("../../../../assets/programs/01-stepped-shaft.CNC");
const PIN: &str = include_str!("../../../../assets/programs/03-grooved-pin.CNC");
const GROOVE: &str = include_str!("../../../../assets/programs/O1031.CNC");

#[test]
fn reference_return_and_the_samples_end_on_the_pulse_of_the_kernel() {
    // EVERY_SAMPLE=1 also runs the long one.
    let every = std::env::var_os("EVERY_SAMPLE").is_some();
    let samples = [(PIN, Some(GROOVE)), (SHAFT, None)];
    for (main, sub) in samples.into_iter().take(if every { 2 } else { 1 }) {
        let mut machine = StepMachine::new();
        machine.return_axes();
        // Past the switches and back to them.
        assert_eq!(machine.twin.pulses(), [4800, 2400]);
        if let Some(sub) = sub {
            let stored = ControlRequest::StoreProgram(sub.to_owned());
            machine.simulation.cnc.request(stored).unwrap();
        }
        machine.start_program(main);
        for _ in 0..3_600_000 {
            machine.run_one_ms();
            if machine.linked.has_pending_motion() || machine.simulation.cnc.is_moving() {
                continue;
            }
            match machine.simulation.cnc.run_state() {
                RunState::Run => {}
                RunState::Stop if machine.alarms().is_empty() => machine.press(CYCLE_START),
                _ => break,
            }
        }
        assert!(machine.alarms().is_empty(), "{:?}", machine.alarms());
        assert_eq!(machine.simulation.cnc.run_state(), RunState::Reset);
        machine.assert_agrees();
        assert!(machine.twin.statistics().step_count > 20_000);
        assert!(machine.worst_queue <= 625);
        assert_eq!(machine.linked.state(), LinkState::Ready);
    }
}
