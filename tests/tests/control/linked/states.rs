//! Faults in every state of the link: the cable is unplugged and plugged in again, the board
//! is reset, the computer is away for two seconds.

use gsk_link::LinkState;
use gsk_twins::grbl::Variant;

use super::{SHORT, assert_counts_agree};
use crate::bench::board::{BenchBoard, LinkedMachine};
use crate::bench::keys::{JOG, RESET, X_PLUS, Z_MINUS, ZERO};

/// A state, and for some states their cause.
#[derive(Clone, Copy, Debug, PartialEq)]
enum LinkSituation {
    Opening,
    Identify,
    Configure,
    Locked,
    /// Manual motion with an unknown position.
    Jogging,
    Homing,
    Ready,
    Moving,
    Verify,
    Tripped,
    Fault,
    Lost,
}

const ALL: [LinkSituation; 12] = [
    LinkSituation::Opening,
    LinkSituation::Identify,
    LinkSituation::Configure,
    LinkSituation::Locked,
    LinkSituation::Jogging,
    LinkSituation::Homing,
    LinkSituation::Ready,
    LinkSituation::Moving,
    LinkSituation::Verify,
    LinkSituation::Tripped,
    LinkSituation::Fault,
    LinkSituation::Lost,
];

/// A machine just opened, one that is set up, and one that is ready.
struct ReadyMachines<T> {
    opened: LinkedMachine<T>,
    connected: LinkedMachine<T>,
    ready: LinkedMachine<T>,
}

fn line_machines() -> ReadyMachines<gsk_twins::grbl::GrblTwin> {
    ReadyMachines {
        opened: LinkedMachine::new(Variant::Grbl, 10_000, 5),
        connected: LinkedMachine::connected(Variant::Grbl),
        ready: LinkedMachine::referenced(Variant::Grbl),
    }
}

fn timed_machines() -> ReadyMachines<crate::bench::board::TimedBoard> {
    ReadyMachines {
        opened: LinkedMachine::timed_unlocked(10_000),
        connected: LinkedMachine::timed_connected(),
        ready: LinkedMachine::timed_referenced(),
    }
}

impl<T: BenchBoard> ReadyMachines<T> {
    fn machine_in(&self, when: LinkSituation) -> LinkedMachine<T> {
        let (base, state) = match when {
            LinkSituation::Opening => (&self.opened, LinkState::Opening),
            LinkSituation::Identify => (&self.opened, LinkState::Identify),
            LinkSituation::Configure => (&self.opened, LinkState::Configure),
            LinkSituation::Locked => (&self.connected, LinkState::Locked),
            LinkSituation::Jogging => (&self.connected, LinkState::Moving),
            LinkSituation::Homing => (&self.connected, LinkState::Homing),
            LinkSituation::Ready => (&self.ready, LinkState::Ready),
            LinkSituation::Moving => (&self.ready, LinkState::Moving),
            LinkSituation::Verify => (&self.ready, LinkState::Verify),
            LinkSituation::Tripped => (&self.ready, LinkState::Tripped),
            LinkSituation::Fault => (&self.ready, LinkState::Fault),
            LinkSituation::Lost => (&self.ready, LinkState::Lost),
        };
        let mut machine = base.clone();
        // On a board of timed steps the control makes the return.
        let returns = |state| {
            when == LinkSituation::Homing && matches!(state, LinkState::Homing | LinkState::Moving)
        };
        let into = |machine: &LinkedMachine<T>| {
            let now = machine.linked.state();
            now == state || returns(now)
        };
        match when {
            LinkSituation::Jogging => {
                machine.press(JOG);
                machine.simulation.cnc.set_panel_key(Z_MINUS, true);
            }
            LinkSituation::Homing => {
                machine.press(ZERO);
                machine.simulation.cnc.set_panel_key(X_PLUS, true);
            }
            LinkSituation::Moving
            | LinkSituation::Verify
            | LinkSituation::Tripped
            | LinkSituation::Fault
            | LinkSituation::Lost => {
                machine.load(SHORT, None);
                machine.start_program();
                machine.run_until(5000, |machine| {
                    machine.simulation.cnc.cursor().line >= 5 && machine.simulation.cnc.is_moving()
                });
            }
            _ => {}
        }
        match when {
            LinkSituation::Verify => machine.simulation.cnc.set_panel_key(RESET, true),
            LinkSituation::Tripped => machine.twin.press_limit(true),
            LinkSituation::Fault => machine.twin.fail(),
            LinkSituation::Lost => machine.cut_cable(),
            _ => {}
        }
        assert!(
            machine.run_until(6000, into),
            "{when:?}: {:?}",
            machine.linked.state()
        );
        if matches!(when, LinkSituation::Jogging | LinkSituation::Homing) {
            machine.run_ms(300);
        }
        machine.simulation.cnc.set_panel_key(RESET, false);
        machine.twin.press_limit(false);
        machine
    }
}

/// It is stopped, and stays stopped, with an alarm.
fn assert_stays_stopped<T: BenchBoard>(machine: &mut LinkedMachine<T>, place: &str) {
    machine.run_until(130_000, |machine| {
        machine.linked.state() != LinkState::Homing
    });
    machine.run_ms(2500);
    let stood = machine.twin.pulses();
    machine.run_ms(1000);
    assert_eq!(machine.twin.pulses(), stood, "{place}: it moves on");
}

/// After a power cycle the board counts as another one, and the port must be opened again.
fn replug<T: BenchBoard>(machine: &mut LinkedMachine<T>) {
    machine.reconnect_cable();
    machine.twin.press_reset();
    machine.reconnect();
    machine.run_until(8000, |machine| machine.linked.state() == LinkState::Locked);
    if machine.linked.state() == LinkState::Configure {
        machine.linked.write_settings();
        machine.run_until(3000, |machine| machine.linked.state() == LinkState::Locked);
    }
}

fn check_cable<T: BenchBoard>(machines: &ReadyMachines<T>, kind: &str) {
    for when in ALL {
        let place = format!("{kind} {when:?}");
        let mut machine = machines.machine_in(when);
        machine.cut_cable();
        machine.run_ms(1500);
        machine.simulation.cnc.set_panel_key(Z_MINUS, false);
        machine.simulation.cnc.set_panel_key(X_PLUS, false);
        let early = matches!(
            when,
            LinkSituation::Opening | LinkSituation::Identify | LinkSituation::Configure
        );
        assert_stays_stopped(&mut machine, &place);
        let state = machine.linked.state();
        assert_ne!(state, LinkState::Ready, "{place}");
        assert!(early || !machine.alarms().is_empty(), "{place}");
        // The cable alone brings nothing back without a request.
        machine.reconnect_cable();
        assert_stays_stopped(&mut machine, &place);
        assert_ne!(machine.linked.state(), LinkState::Ready, "{place}");
        // Opening the port does not reset a board with its own USB port.
        let mut same = machine.clone();
        let stood = same.twin.pulses();
        same.reconnect();
        same.run_ms(7000);
        assert_eq!(same.twin.pulses(), stood, "{place}: moved by the opening");
        assert_ne!(same.linked.state(), LinkState::Ready, "{place}");
        machine.cut_cable();
        replug(&mut machine);
        machine.press(RESET);
        machine.run_ms(500);
        assert_eq!(machine.linked.state(), LinkState::Locked, "{place}");
        assert_eq!(machine.alarms(), [0_u16; 0], "{place}");
        assert!(!machine.linked.knows_position(), "{place}");
        machine.check_nothing_starts();
        assert_eq!(machine.alarms(), [610], "{place}");
        machine.press(RESET);
        machine.return_to_reference();
        machine.check_program_runs();
    }
}

#[test]
fn a_cable_out_and_in_again_in_every_state_of_a_line_board() {
    check_cable(&line_machines(), "line");
}

#[test]
fn a_cable_out_and_in_again_in_every_state_of_a_board_of_timed_steps() {
    check_cable(&timed_machines(), "timed");
}

fn check_reset<T: BenchBoard>(machines: &ReadyMachines<T>, kind: &str) {
    for when in ALL {
        let place = format!("{kind} {when:?}");
        let mut machine = machines.machine_in(when);
        machine.twin.press_reset();
        machine.run_ms(2000);
        machine.simulation.cnc.set_panel_key(Z_MINUS, false);
        machine.simulation.cnc.set_panel_key(X_PLUS, false);
        assert_stays_stopped(&mut machine, &place);
        assert_ne!(machine.linked.state(), LinkState::Ready, "{place}");
        assert!(!machine.linked.knows_position(), "{place}");
        let early = matches!(
            when,
            LinkSituation::Opening | LinkSituation::Identify | LinkSituation::Configure
        );
        assert!(early || !machine.alarms().is_empty(), "{place}");
        // If it has already shut down, or a restart was requested, no event is expected.
        let is_known = matches!(
            when,
            LinkSituation::Fault | LinkSituation::Tripped | LinkSituation::Verify
        );
        if !early && !is_known && when != LinkSituation::Lost {
            assert!(
                machine.alarms().contains(&606),
                "{place}: {:?}",
                machine.alarms()
            );
        }
        machine.check_nothing_starts();
    }
}

#[test]
fn a_reset_of_the_board_in_every_state() {
    check_reset(&line_machines(), "line");
    check_reset(&timed_machines(), "timed");
}

fn check_pause<T: BenchBoard>(machines: &ReadyMachines<T>, kind: &str) {
    for when in ALL {
        let place = format!("{kind} {when:?}");
        let mut machine = machines.machine_in(when);
        machine.pause_host(2000);
        let moved = matches!(
            when,
            LinkSituation::Jogging | LinkSituation::Moving | LinkSituation::Verify
        );
        if when != LinkSituation::Homing {
            // The motion sent before was made; a key that is still held starts nothing.
            let stood = machine.twin.pulses();
            machine.run_ms(1000);
            assert_eq!(machine.twin.pulses(), stood, "{place}: it moves on");
        }
        machine.simulation.cnc.set_panel_key(Z_MINUS, false);
        machine.simulation.cnc.set_panel_key(X_PLUS, false);
        assert_stays_stopped(&mut machine, &place);
        let known = [605, 612];
        if matches!(when, LinkSituation::Jogging | LinkSituation::Moving) {
            assert!(
                machine.alarms().iter().any(|alarm| known.contains(alarm)),
                "{place}: {:?}",
                machine.alarms()
            );
        }
        if machine.linked.state() == LinkState::Ready {
            let counted = machine.linked.counted().unwrap();
            assert_eq!(counted, machine.simulation.cnc.pulses(), "{place}");
            if when != LinkSituation::Homing {
                assert_counts_agree(&machine);
            }
        } else {
            assert!(!machine.linked.knows_position() || moved, "{place}");
        }
    }
}

#[test]
fn a_computer_away_for_two_seconds_in_every_state() {
    check_pause(&line_machines(), "line");
    check_pause(&timed_machines(), "timed");
}

/// A request that the operator makes before the board is identified is not executed later. A
/// jog key must be released and pressed again, a return requested again.
fn check_early_request<T: BenchBoard>(opened: &LinkedMachine<T>) {
    for (mode, key) in [(JOG, Z_MINUS), (ZERO, X_PLUS)] {
        for held in [true, false] {
            let mut machine = opened.clone();
            machine.press(mode);
            machine.simulation.cnc.set_panel_key(key, true);
            machine.run_ms(100);
            machine.simulation.cnc.set_panel_key(key, held);
            assert_ne!(machine.linked.state(), LinkState::Locked);
            let stood = machine.twin.pulses();
            machine.run_until(6000, |machine| {
                machine.linked.state() == LinkState::Locked || machine.alarms().contains(&603)
            });
            machine.linked.write_settings();
            assert!(
                machine.run_until(6000, |machine| machine.linked.state() == LinkState::Locked),
                "{mode:?} {held} {:?} {:?}",
                machine.linked.state(),
                machine.alarms()
            );
            machine.run_ms(3000);
            assert_eq!(machine.twin.pulses(), stood, "held {held}");
            machine.simulation.cnc.set_panel_key(key, false);
            machine.press(RESET);
            machine.run_ms(1500);
            assert_eq!(machine.twin.pulses(), stood, "held {held}");
            machine.hold_key(key, 2000);
            assert_ne!(machine.twin.pulses(), stood, "{:?}", machine.alarms());
        }
    }
}

#[test]
fn requests_during_the_opening_are_not_executed_later() {
    check_early_request(&line_machines().opened);
    check_early_request(&timed_machines().opened);
}
