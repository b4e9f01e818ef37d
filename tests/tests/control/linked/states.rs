//! Faults in every state of the link: the cable is unplugged and plugged in again, the board
//! is reset, the computer is away for two seconds.

use gsk_link::LinkState;
use gsk_twins::grbl::Variant;

use super::{SHORT, assert_together};
use crate::bench::board::{Board, Machine};
use crate::bench::keys::{JOG, RESET, X_PLUS, Z_MINUS, ZERO};

/// A state, and for some states their cause.
#[derive(Clone, Copy, Debug, PartialEq)]
enum When {
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

const ALL: [When; 12] = [
    When::Opening,
    When::Identify,
    When::Configure,
    When::Locked,
    When::Jogging,
    When::Homing,
    When::Ready,
    When::Moving,
    When::Verify,
    When::Tripped,
    When::Fault,
    When::Lost,
];

/// A machine just opened, one that is set up, and one that is ready.
struct Machines<T> {
    opened: Machine<T>,
    connected: Machine<T>,
    ready: Machine<T>,
}

fn line() -> Machines<gsk_twins::grbl::GrblTwin> {
    Machines {
        opened: Machine::new(Variant::Grbl, 10_000, 5),
        connected: Machine::connected(Variant::Grbl),
        ready: Machine::referenced(Variant::Grbl),
    }
}

fn timed() -> Machines<crate::bench::board::Timed> {
    Machines {
        opened: Machine::timed(10_000),
        connected: Machine::timed_connected(),
        ready: Machine::timed_referenced(),
    }
}

impl<T: Board> Machines<T> {
    fn brought(&self, when: When) -> Machine<T> {
        let (base, state) = match when {
            When::Opening => (&self.opened, LinkState::Opening),
            When::Identify => (&self.opened, LinkState::Identify),
            When::Configure => (&self.opened, LinkState::Configure),
            When::Locked => (&self.connected, LinkState::Locked),
            When::Jogging => (&self.connected, LinkState::Moving),
            When::Homing => (&self.connected, LinkState::Homing),
            When::Ready => (&self.ready, LinkState::Ready),
            When::Moving => (&self.ready, LinkState::Moving),
            When::Verify => (&self.ready, LinkState::Verify),
            When::Tripped => (&self.ready, LinkState::Tripped),
            When::Fault => (&self.ready, LinkState::Fault),
            When::Lost => (&self.ready, LinkState::Lost),
        };
        let mut machine = base.clone();
        // On a board of timed steps the control makes the return.
        let returns =
            |state| when == When::Homing && matches!(state, LinkState::Homing | LinkState::Moving);
        let into = |machine: &Machine<T>| {
            let now = machine.linked.state();
            now == state || returns(now)
        };
        match when {
            When::Jogging => {
                machine.press(JOG);
                machine.simulation.cnc.set_panel_key(Z_MINUS, true);
            }
            When::Homing => {
                machine.press(ZERO);
                machine.simulation.cnc.set_panel_key(X_PLUS, true);
            }
            When::Moving | When::Verify | When::Tripped | When::Fault | When::Lost => {
                machine.load(SHORT, None);
                machine.start();
                machine.wait(5000, |machine| {
                    machine.simulation.cnc.cursor().line >= 5 && machine.simulation.cnc.is_moving()
                });
            }
            _ => {}
        }
        match when {
            When::Verify => machine.simulation.cnc.set_panel_key(RESET, true),
            When::Tripped => machine.twin.press_limit(true),
            When::Fault => machine.twin.fail(),
            When::Lost => machine.cut_cable(),
            _ => {}
        }
        assert!(
            machine.wait(6000, into),
            "{when:?}: {:?}",
            machine.linked.state()
        );
        if matches!(when, When::Jogging | When::Homing) {
            machine.pass(300);
        }
        machine.simulation.cnc.set_panel_key(RESET, false);
        machine.twin.press_limit(false);
        machine
    }
}

/// It is stopped, and stays stopped, with an alarm.
fn stands<T: Board>(machine: &mut Machine<T>, place: &str) {
    machine.wait(130_000, |machine| {
        machine.linked.state() != LinkState::Homing
    });
    machine.pass(2500);
    let stood = machine.twin.pulses();
    machine.pass(1000);
    assert_eq!(machine.twin.pulses(), stood, "{place}: it moves on");
}

/// After a power cycle the board counts as another one, and the port must be opened again.
fn plug_in_anew<T: Board>(machine: &mut Machine<T>) {
    machine.mend_cable();
    machine.twin.press_reset();
    machine.reconnect();
    machine.wait(8000, |machine| machine.linked.state() == LinkState::Locked);
    if machine.linked.state() == LinkState::Configure {
        machine.linked.write_settings();
        machine.wait(3000, |machine| machine.linked.state() == LinkState::Locked);
    }
}

fn is_lost_and_found<T: Board>(machines: &Machines<T>, kind: &str) {
    for when in ALL {
        let place = format!("{kind} {when:?}");
        let mut machine = machines.brought(when);
        machine.cut_cable();
        machine.pass(1500);
        machine.simulation.cnc.set_panel_key(Z_MINUS, false);
        machine.simulation.cnc.set_panel_key(X_PLUS, false);
        let early = matches!(when, When::Opening | When::Identify | When::Configure);
        stands(&mut machine, &place);
        let state = machine.linked.state();
        assert_ne!(state, LinkState::Ready, "{place}");
        assert!(early || !machine.alarms().is_empty(), "{place}");
        // The cable alone brings nothing back without a request.
        machine.mend_cable();
        stands(&mut machine, &place);
        assert_ne!(machine.linked.state(), LinkState::Ready, "{place}");
        // Opening the port does not reset a board with its own USB port.
        let mut same = machine.clone();
        let stood = same.twin.pulses();
        same.reconnect();
        same.pass(7000);
        assert_eq!(same.twin.pulses(), stood, "{place}: moved by the opening");
        assert_ne!(same.linked.state(), LinkState::Ready, "{place}");
        machine.cut_cable();
        plug_in_anew(&mut machine);
        machine.press(RESET);
        machine.pass(500);
        assert_eq!(machine.linked.state(), LinkState::Locked, "{place}");
        assert_eq!(machine.alarms(), [0_u16; 0], "{place}");
        assert!(!machine.linked.knows_position(), "{place}");
        machine.starts_nothing();
        assert_eq!(machine.alarms(), [610], "{place}");
        machine.press(RESET);
        machine.reference();
        machine.works();
    }
}

#[test]
fn a_cable_out_and_in_again_in_every_state_of_a_line_board() {
    is_lost_and_found(&line(), "line");
}

#[test]
fn a_cable_out_and_in_again_in_every_state_of_a_board_of_timed_steps() {
    is_lost_and_found(&timed(), "timed");
}

fn is_reset<T: Board>(machines: &Machines<T>, kind: &str) {
    for when in ALL {
        let place = format!("{kind} {when:?}");
        let mut machine = machines.brought(when);
        machine.twin.press_reset();
        machine.pass(2000);
        machine.simulation.cnc.set_panel_key(Z_MINUS, false);
        machine.simulation.cnc.set_panel_key(X_PLUS, false);
        stands(&mut machine, &place);
        assert_ne!(machine.linked.state(), LinkState::Ready, "{place}");
        assert!(!machine.linked.knows_position(), "{place}");
        let early = matches!(when, When::Opening | When::Identify | When::Configure);
        assert!(early || !machine.alarms().is_empty(), "{place}");
        // If it has already shut down, or a restart was requested, no event is expected.
        let told = matches!(when, When::Fault | When::Tripped | When::Verify);
        if !early && !told && when != When::Lost {
            assert!(
                machine.alarms().contains(&606),
                "{place}: {:?}",
                machine.alarms()
            );
        }
        machine.starts_nothing();
    }
}

#[test]
fn a_reset_of_the_board_in_every_state() {
    is_reset(&line(), "line");
    is_reset(&timed(), "timed");
}

fn is_left_alone<T: Board>(machines: &Machines<T>, kind: &str) {
    for when in ALL {
        let place = format!("{kind} {when:?}");
        let mut machine = machines.brought(when);
        machine.pause(2000);
        let moved = matches!(when, When::Jogging | When::Moving | When::Verify);
        if when != When::Homing {
            // The motion sent before was made; a key that is still held starts nothing.
            let stood = machine.twin.pulses();
            machine.pass(1000);
            assert_eq!(machine.twin.pulses(), stood, "{place}: it moves on");
        }
        machine.simulation.cnc.set_panel_key(Z_MINUS, false);
        machine.simulation.cnc.set_panel_key(X_PLUS, false);
        stands(&mut machine, &place);
        let known = [605, 612];
        if matches!(when, When::Jogging | When::Moving) {
            assert!(
                machine.alarms().iter().any(|alarm| known.contains(alarm)),
                "{place}: {:?}",
                machine.alarms()
            );
        }
        if machine.linked.state() == LinkState::Ready {
            let counted = machine.linked.counted().unwrap();
            assert_eq!(counted, machine.simulation.cnc.pulses(), "{place}");
            if when != When::Homing {
                assert_together(&machine);
            }
        } else {
            assert!(!machine.linked.knows_position() || moved, "{place}");
        }
    }
}

#[test]
fn a_computer_away_for_two_seconds_in_every_state() {
    is_left_alone(&line(), "line");
    is_left_alone(&timed(), "timed");
}

/// A request that the operator makes before the board is identified is not executed later. A
/// jog key must be released and pressed again, a return requested again.
fn is_asked_too_early<T: Board>(opened: &Machine<T>) {
    for (mode, key) in [(JOG, Z_MINUS), (ZERO, X_PLUS)] {
        for held in [true, false] {
            let mut machine = opened.clone();
            machine.press(mode);
            machine.simulation.cnc.set_panel_key(key, true);
            machine.pass(100);
            machine.simulation.cnc.set_panel_key(key, held);
            assert_ne!(machine.linked.state(), LinkState::Locked);
            let stood = machine.twin.pulses();
            machine.wait(6000, |machine| {
                machine.linked.state() == LinkState::Locked || machine.alarms().contains(&603)
            });
            machine.linked.write_settings();
            assert!(
                machine.wait(6000, |machine| machine.linked.state() == LinkState::Locked),
                "{mode:?} {held} {:?} {:?}",
                machine.linked.state(),
                machine.alarms()
            );
            machine.pass(3000);
            assert_eq!(machine.twin.pulses(), stood, "held {held}");
            machine.simulation.cnc.set_panel_key(key, false);
            machine.press(RESET);
            machine.pass(1500);
            assert_eq!(machine.twin.pulses(), stood, "held {held}");
            machine.hold(key, 2000);
            assert_ne!(machine.twin.pulses(), stood, "{:?}", machine.alarms());
        }
    }
}

#[test]
fn what_is_asked_while_the_board_is_being_opened_is_not_done_later() {
    is_asked_too_early(&line().opened);
    is_asked_too_early(&timed().opened);
}
