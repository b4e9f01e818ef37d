//! The return to the machine zero, driven by the control and stopped by the board.

use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::setup::Setup;
use gsk_link::{LinkConfig, LinkState};
use gsk_twins::klipper::{KlipperHardware, TravelSwitch};

use super::bench::config;
use super::machine::StepMachine;
use crate::bench::dice::{TestRandom, round_count};
use crate::bench::keys::{FEED_HOLD, JOG, RESET, X_MINUS, X_PLUS, Z_MINUS, Z_PLUS, ZERO};

/// Switches of the lathe: X closes at -6000 and opens at -4000 (5 mm at 400
/// pulses/mm), Z at -3000 and -2000. The motors turn once in 1600 and 1000 pulses. When
/// the switch of Z opens its zero signal is on.
const DOG_X: TravelSwitch = travel_switch(0, -6000, -4000, None);
const DOG_Z: TravelSwitch = travel_switch(1, -3000, -2000, None);
const ZERO_X: TravelSwitch = travel_switch(0, 0, 31, Some(1600));
const ZERO_Z: TravelSwitch = travel_switch(1, 0, 19, Some(1000));
/// First edges after the dogs; the far edges of the dogs.
const ZERO_B: [i64; 2] = [-3200, -1980];
const ZERO_C: [i64; 2] = [-4000, -2000];

const fn travel_switch(axis: usize, from: i64, to: i64, turn: Option<i64>) -> TravelSwitch {
    TravelSwitch {
        stepper: axis,
        first_pulse: from,
        last_pulse: to,
        pulses_per_turn: turn,
    }
}

fn wires() -> LinkConfig {
    let mut config = config();
    config.z.zero = "PC7".to_owned();
    config
}

/// `one`: one switch for each axis (method C); the keys need not be held.
fn machine(one: bool, slides: [i64; 2]) -> StepMachine {
    let mut machine = power_on(wires(), one, slides);
    machine.press(RESET);
    machine.press(ZERO);
    machine.run_ms(300);
    machine
}

fn power_on(config: LinkConfig, one: bool, slides: [i64; 2]) -> StepMachine {
    machine_with_keys(config, one, true, slides)
}

/// `press`: a press of the key is enough (011.2 ZNIK).
fn machine_with_keys(config: LinkConfig, one: bool, press: bool, slides: [i64; 2]) -> StepMachine {
    let mut setup = Setup::delivered();
    for (number, bit, value) in [(7, 0, one), (7, 1, one), (11, 2, press)] {
        setup.memory.parameters.set_bit(number, bit, value).unwrap();
    }
    let mut machine = StepMachine::with_wiring(KlipperHardware::default(), config, setup);
    machine.twin.place_slides(slides);
    for (pin, travel) in [
        ("PC4", DOG_X),
        ("PC6", DOG_Z),
        ("PC5", ZERO_X),
        ("PC7", ZERO_Z),
        ("PC0", travel_switch(0, 8000, 1 << 40, None)),
        ("PC1", travel_switch(1, 8000, 1 << 40, None)),
    ] {
        machine.twin.place_switch(pin, travel);
    }
    assert!(machine.run_until(3000, |machine| machine.linked.state() == LinkState::Locked));
    machine.press(RESET);
    machine.press(ZERO);
    machine.run_ms(300);
    machine
}

#[track_caller]
fn return_axes(machine: &mut StepMachine) -> [i64; 2] {
    let ready = machine.run_until(120_000, |machine| {
        let referenced = machine.simulation.cnc.referenced_axes();
        let returned = referenced.x && referenced.z;
        returned && machine.linked.state() == LinkState::Ready || !machine.alarms().is_empty()
    });
    assert!(
        ready && machine.alarms().is_empty(),
        "{:?} {:?} {:?}",
        machine.linked.state(),
        machine.alarms(),
        machine.twin.pulses()
    );
    machine.run_ms(300);
    let referenced = machine.simulation.cnc.referenced_axes();
    assert!(referenced.x && referenced.z);
    let at = machine.simulation.cnc.position_machine();
    assert_eq!((at.x, at.z), (0.0, 0.0));
    machine.twin.pulses()
}

/// From any start position and with any timing of the keys, the return ends on the same pulse.
#[test]
fn all_starts_end_on_the_same_pulse() {
    let mut dice = TestRandom(5);
    for round in 0..round_count(6) {
        let one = dice.below(2) == 0;
        let slides = [
            -6100 - i64::from(dice.below(20_000)),
            -3100 - i64::from(dice.below(12_000)),
        ];
        let mut machine = machine(one, slides);
        machine.run_ms(dice.below(50));
        machine.twin.advance(u64::from(dice.below(1_000_000)));
        let keys = match dice.below(2) {
            0 => [X_PLUS, Z_PLUS],
            _ => [Z_PLUS, X_PLUS],
        };
        machine.press(keys[0]);
        machine.run_ms(dice.below(4000));
        // It holds programs only.
        machine.press(FEED_HOLD);
        machine.press(keys[1]);
        let place = if one { ZERO_C } else { ZERO_B };
        assert_eq!(
            return_axes(&mut machine),
            place,
            "{round}: {one} {slides:?}"
        );
    }
}

#[test]
fn both_axes_at_once_return_to_the_first_edge_after_the_switch() {
    let mut machine = machine(false, [-40_000, -20_000]);
    machine.press(X_PLUS);
    machine.press(Z_PLUS);
    machine.run_ms(1000);
    let before = machine.twin.pulses();
    machine.run_ms(500);
    let now = machine.twin.pulses();
    assert!(now[0] > before[0] && now[1] > before[1], "both move");
    assert_eq!(return_axes(&mut machine), ZERO_B);
    // The lamps, and again: it is on its zero.
    for bit in [5, 7] {
        let lamp = BitAddress::new(Area::Y, 4, bit);
        assert!(machine.simulation.cnc.plc().memory().bit(lamp));
    }
    machine.press(X_PLUS);
    machine.run_ms(500);
    assert_eq!(machine.twin.pulses(), ZERO_B);
}

/// The phase of the return, as far as it is visible from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ReturnPhase {
    Approach,
    OnSwitch,
    PastSwitch,
}

fn return_phase(machine: &StepMachine) -> ReturnPhase {
    match machine.twin.pulses()[1] {
        ..-3000 => ReturnPhase::Approach,
        -3000..-1995 => ReturnPhase::OnSwitch,
        _ => ReturnPhase::PastSwitch,
    }
}

/// A return of both axes in some phase of Z's, and a little later.
fn machine_in_phase(one: bool, wanted: ReturnPhase, later: u32) -> StepMachine {
    let mut machine = machine(one, [-30_000, -9000]);
    machine.press(X_PLUS);
    machine.press(Z_PLUS);
    assert!(machine.run_until(60_000, |machine| return_phase(machine) == wanted));
    machine.run_ms(later);
    machine
}

const PHASES: [(ReturnPhase, u32); 7] = [
    (ReturnPhase::Approach, 10),
    (ReturnPhase::Approach, 1300),
    (ReturnPhase::OnSwitch, 0),
    (ReturnPhase::OnSwitch, 5),
    (ReturnPhase::OnSwitch, 700),
    (ReturnPhase::PastSwitch, 3),
    (ReturnPhase::PastSwitch, 120),
];

/// All of them with `ROUNDS` in the environment.
fn some_phases() -> impl Iterator<Item = (ReturnPhase, u32)> {
    PHASES
        .into_iter()
        .step_by(if round_count(6) > 6 { 1 } else { 3 })
}

/// Moves manually off the switch, and back to the mode of the return.
#[track_caller]
fn leave_switch(machine: &mut StepMachine, key: BitAddress, axis: usize, below: i64) {
    machine.press(JOG);
    machine.simulation.cnc.set_panel_key(key, true);
    let off = machine.run_until(60_000, |machine| machine.twin.pulses()[axis] < below);
    assert!(off, "{:?}", machine.twin.pulses());
    machine.simulation.cnc.set_panel_key(key, false);
    machine.run_ms(500);
    machine.press(ZERO);
}

/// RESET does, and so does another mode.
#[test]
fn reset_ends_the_return_in_every_phase_and_another_one_ends_at_the_zero() {
    for one in [false, true] {
        for (wanted, later) in some_phases() {
            let mut machine = machine_in_phase(one, wanted, later);
            machine.press(if later % 2 == 0 { RESET } else { JOG });
            machine.run_ms(500);
            let stood = machine.twin.pulses();
            machine.run_ms(1000);
            let place = format!("{one} {wanted:?} {later}");
            assert_eq!(machine.twin.pulses(), stood, "{place}");
            assert_eq!(machine.alarms(), Vec::<String>::new(), "{place}");
            for (key, axis, from) in [(X_MINUS, 0, -6500), (Z_MINUS, 1, -3500)] {
                leave_switch(&mut machine, key, axis, from);
            }
            machine.press(X_PLUS);
            machine.press(Z_PLUS);
            let home = if one { ZERO_C } else { ZERO_B };
            assert_eq!(return_axes(&mut machine), home, "{place}");
        }
    }
}

/// With 011.2 ZNIK = 0 the axis moves only while its key is held.
#[test]
fn a_released_key_stops_the_axis_and_pressed_again_it_continues() {
    for one in [false, true] {
        for (wanted, later) in some_phases() {
            let mut machine = machine_with_keys(wires(), one, false, [-7000, -9000]);
            machine.press(RESET);
            machine.press(ZERO);
            machine.simulation.cnc.set_panel_key(X_PLUS, true);
            assert!(
                machine.run_until(60_000, |machine| machine.simulation.cnc.referenced_axes().x)
            );
            machine.simulation.cnc.set_panel_key(X_PLUS, false);
            machine.run_ms(300);
            machine.simulation.cnc.set_panel_key(Z_PLUS, true);
            assert!(machine.run_until(60_000, |machine| return_phase(machine) == wanted));
            machine.run_ms(later);
            machine.simulation.cnc.set_panel_key(Z_PLUS, false);
            machine.run_ms(1000);
            let stood = machine.twin.pulses();
            machine.run_ms(1000);
            assert_eq!(machine.twin.pulses(), stood);
            assert!(
                machine.simulation.cnc.referenced_axes().x,
                "X keeps its own"
            );
            // It may have braked onto the switch.
            if wanted != ReturnPhase::Approach || stood[1] > -3500 {
                leave_switch(&mut machine, Z_MINUS, 1, -3500);
            }
            machine.simulation.cnc.set_panel_key(Z_PLUS, true);
            machine.run_ms(300);
            let home = if one { ZERO_C } else { ZERO_B };
            assert_eq!(return_axes(&mut machine), home, "{one} {wanted:?} {later}");
        }
    }
}

#[test]
fn a_board_that_fails_in_any_phase_ends_the_return() {
    for (wanted, later) in some_phases() {
        let start = machine_in_phase(false, wanted, later);
        for fault in 0..3 {
            let mut machine = start.clone();
            let number = match fault {
                0 => {
                    machine.twin.press_reset();
                    606
                }
                1 => {
                    machine.twin.to_host.set_cut(true);
                    machine.twin.to_board.set_cut(true);
                    605
                }
                _ => {
                    machine.twin.set_pin("PC2", false);
                    207
                }
            };
            machine.run_ms(1500);
            let stood = machine.twin.pulses();
            machine.run_ms(1000);
            let place = format!("{wanted:?} {later} {number}");
            assert_eq!(machine.twin.pulses(), stood, "{place}");
            let alarm = format!("{number}");
            let alarms = machine.alarms();
            assert!(
                alarms.iter().any(|text| text.contains(&alarm)),
                "{place}: {alarms:?}"
            );
            let referenced = machine.simulation.cnc.referenced_axes();
            assert!(!referenced.x && !referenced.z, "{place}");
        }
    }
}

#[test]
fn what_is_not_wired_is_named_and_nothing_moves() {
    let mut without_zero = wires();
    without_zero.z.zero = String::new();
    let mut without_switch = wires();
    without_switch.z.dec = String::new();
    without_switch.z.limit = String::new();
    for (config, one, text) in [
        (&without_zero, false, Some("link.z.zero names no pin")),
        (&without_zero, true, None),
        (&without_switch, true, Some("link.z.dec names no pin")),
    ] {
        let mut machine = power_on(config.clone(), one, [-7000, -4000]);
        for (pin, travel) in [("PC4", DOG_X), ("PC6", DOG_Z), ("PC5", ZERO_X)] {
            machine.twin.place_switch(pin, travel);
        }
        machine.press(RESET);
        machine.press(ZERO);
        machine.press(Z_PLUS);
        let Some(text) = text else {
            machine.press(X_PLUS);
            assert_eq!(
                return_axes(&mut machine),
                ZERO_C,
                "method C needs no zero signal"
            );
            continue;
        };
        machine.run_ms(500);
        assert_eq!(machine.twin.pulses()[1], -4000);
        let alarms = machine.alarms();
        assert!(
            alarms[0].contains("609") && alarms[0].contains(text),
            "{alarms:?}"
        );
    }
}

#[test]
fn a_return_that_begins_on_the_switch_is_alarm_090_and_the_ladder_sees_switch_and_signal() {
    let mut machine = machine(false, [-5000, -3500]);
    let contact = |machine: &StepMachine, byte, bit| {
        let address = BitAddress::new(Area::X, byte, bit);
        machine.simulation.cnc.plc().memory().bit(address)
    };
    // Open when pressed (004.5 DECI = 0).
    assert!(!contact(&machine, 0, 3) && contact(&machine, 1, 3));
    machine.press(X_PLUS);
    machine.run_ms(200);
    assert!(
        machine.alarms()[0].contains("090"),
        "{:?}",
        machine.alarms()
    );
    assert_eq!(machine.twin.pulses(), [-5000, -3500]);
    machine.twin.set_pin("PC5", true);
    machine.run_ms(500);
    assert!(machine.simulation.cnc.sensors().zero_signal.x);
}

/// Without a deceleration switch the limit switch is the reference.
#[test]
fn without_another_switch_the_limit_switch_is_the_reference() {
    let mut config = wires();
    for axis in [&mut config.x, &mut config.z] {
        axis.dec = String::new();
        axis.zero = String::new();
        axis.home_at = 4.0;
    }
    let mut machine = power_on(config, false, [-3000, -4000]);
    machine.press(RESET);
    machine.press(ZERO);
    machine.press(X_PLUS);
    machine.press(Z_PLUS);
    assert!(machine.run_until(120_000, |machine| machine.linked.state()
        == LinkState::Ready));
    machine.run_ms(500);
    // A millimetre off the position where it opens.
    assert_eq!(machine.twin.pulses(), [7999 - 400, 7999 - 200]);
    assert_eq!(machine.alarms(), Vec::<String>::new());
    let at = machine.simulation.cnc.position_machine();
    assert_eq!((at.x, at.z), (2.0, 4.0));
}

/// A broken switch is an alarm before the slide reaches the end of its bed.
#[test]
fn a_switch_that_does_not_come_within_the_length_of_the_slide_is_alarm_609() {
    for (key, axis, name, most) in [
        // 320 mm of diameter, 400 pulses/mm of radius; 510 mm, 200 pulses/mm.
        (X_PLUS, 0, "link.x.dec", 64_000),
        (Z_PLUS, 1, "link.z.dec", 102_000),
    ] {
        let start = [-90_000, -130_000];
        let mut machine = machine(false, start);
        machine
            .twin
            .place_switch("PC4", travel_switch(0, 1 << 39, 1 << 40, None));
        machine
            .twin
            .place_switch("PC6", travel_switch(1, 1 << 39, 1 << 40, None));
        machine.press(key);
        assert!(machine.run_until(60_000, |machine| !machine.alarms().is_empty()));
        machine.run_ms(2000);
        let alarms = machine.alarms();
        assert!(
            alarms[0].contains("609") && alarms[0].contains(name),
            "{alarms:?}"
        );
        // It brakes with its ramp.
        let way = machine.twin.pulses()[axis] - start[axis];
        assert!((most..most + 4000).contains(&way), "{way}");
        // The count is good: the next return finds its switch.
        machine.press(RESET);
        assert_eq!(machine.linked.state(), LinkState::Locked);
        machine.twin.place_switch("PC4", DOG_X);
        machine.twin.place_switch("PC6", DOG_Z);
        machine.press(ZERO);
        machine.press(X_PLUS);
        machine.press(Z_PLUS);
        assert_eq!(return_axes(&mut machine), ZERO_B);
    }
}
