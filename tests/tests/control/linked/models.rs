//! The sibling controls NC-B08 and Huaxing 31/32 on a pulse board: a program, a hold, RESET and a
//! limit switch.

use gsk_core::model::{ControlModel, ModelId};
use gsk_core::operation::RunState;
use gsk_link::LinkState;
use gsk_twins::grbl::Variant;

use super::{LINES, assert_counts_agree};
use crate::bench::board::{BenchBoard, LinkedMachine};
use crate::bench::keys::{CYCLE_START, FEED_HOLD, JOG, RESET, Z_MINUS, Z_PLUS};

/// A part in the language of the NC-B08: straight rapids, a long arc by a negative R, a dwell
/// in seconds, an output, and the return over a point.
const OF_NCB08: &str = "O21\nG50 X60 Z20\nG98 S500 M03\nG00 X40 Z5 M08\nM10 P0\n\
    G01 Z-10 F300\nG02 X50 Z-15 R-5.2\nG01 X52\nG04 X0.2\nM11 P0\nG00 X60 Z20\nM05\nM2\n";

/// A part in the language of the Huaxing lathe: increments by G91, a diameter in I, blocks that
/// are repeated, and M02.
const OF_HX31: &str = "%P22\nN10 G92 X60 Z20\nN20 G98 S500 M03\nN30 G90 G00 X40 Z5\n\
    N40 G01 Z-10 F300\nN50 G91 G01 X2 Z-1\nN60 X-1\nN70 G26 N50.60.2\n\
    N80 G90 G02 X53 Z-18 I10 K0\nN90 G00 X60 Z20\nN95 M05\nN99 M02\n";

/// The models, each with its program.
const SIBLINGS: [(ModelId, &str); 2] = [(ModelId::Ncb08, OF_NCB08), (ModelId::Hx31, OF_HX31)];

/// A board with the control of a model, after its reference return.
fn referenced(variant: Variant, model: ModelId) -> LinkedMachine {
    let machine = LinkedMachine::with_model(variant, ControlModel::new(model));
    assert_eq!(machine.simulation.cnc.model().id(), model);
    machine
}

#[test]
fn programs_of_siblings_end_on_the_pulse_of_the_kernel() {
    for variant in LINES {
        for (model, text) in SIBLINGS {
            let mut machine = referenced(variant, model);
            machine.load(text, None);
            machine.start_program();
            machine.run_to_end(300_000);
            assert_eq!(machine.alarms(), [0_u16; 0], "{variant:?} {model:?}");
            assert_counts_agree(&machine);
            // The program ends where it began, on diameter 60 and at 20.
            let at = machine.simulation.cnc.position_absolute();
            assert!((at.x - 30.0).abs() < 0.003, "{model:?} {at:?}");
            assert!((at.z - 20.0).abs() < 0.006, "{model:?} {at:?}");
        }
    }
}

#[test]
fn a_hold_and_reset_of_siblings_lose_no_pulse() {
    for (model, text) in SIBLINGS {
        let plain = {
            let mut machine = referenced(Variant::Grbl, model);
            machine.load(text, None);
            machine.start_program();
            machine.run_to_end(300_000);
            machine.made_pulses()
        };
        let mut machine = referenced(Variant::Grbl, model);
        machine.load(text, None);
        machine.start_program();
        machine.run_ms(2500);
        machine.press(FEED_HOLD);
        assert!(machine.run_until(3000, |machine| !machine.linked.has_pending_motion()));
        assert_counts_agree(&machine);
        let held = machine.made_pulses();
        machine.run_ms(500);
        assert_eq!(machine.made_pulses(), held, "{model:?}: held");
        assert_ne!(held, plain, "{model:?}: the hold is inside the program");
        machine.press(CYCLE_START);
        machine.run_to_end(300_000);
        assert_eq!(machine.made_pulses(), plain, "{model:?}");

        machine.start_program();
        machine.run_ms(2500);
        machine.press(RESET);
        assert!(machine.run_until(3000, |machine| machine.linked.state() == LinkState::Ready));
        assert_counts_agree(&machine);
        let stopped = machine.made_pulses();
        machine.run_ms(1000);
        assert_eq!(
            machine.made_pulses(),
            stopped,
            "{model:?}: stays after RESET"
        );
        assert_eq!(machine.simulation.cnc.run_state(), RunState::Reset);
        assert_eq!(machine.alarms(), [0_u16; 0]);
    }
}

#[test]
fn a_limit_switch_stops_the_motion_of_siblings() {
    for (model, _) in SIBLINGS {
        let mut machine = referenced(Variant::Grbl, model);
        machine.press(JOG);
        machine.simulation.cnc.set_panel_key(Z_MINUS, true);
        machine.run_ms(800);
        machine.twin.press_limit(true);
        machine.run_ms(500);
        machine.simulation.cnc.set_panel_key(Z_MINUS, false);
        machine.run_ms(500);
        assert_eq!(machine.alarms(), [622], "{model:?}");
        assert_eq!(machine.linked.state(), LinkState::Tripped);
        for _ in 0..2 {
            machine.press(RESET);
            machine.run_ms(4000);
        }
        machine.press(JOG);
        assert_eq!(machine.alarms(), [0_u16; 0], "{model:?}");
        let before = machine.twin.pulses()[1];
        machine.hold_key(Z_PLUS, 1500);
        machine.run_ms(1500);
        assert!(machine.twin.pulses()[1] > before, "{model:?}: away from it");
    }
}
