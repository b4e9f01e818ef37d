//! The slides of every lathe have ends. These tests check what the control reports about a
//! stop there (manual III-3.5, III-7).

use crate::bench::{press, run_ticks};
use gsk_core::alarm::Alarm;
use gsk_core::cnc::Event;
use gsk_core::machine::{AxisConfig, LatheConfig, ServoConfig};
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::{Axis, Point};
use proptest::prop_assert;
use proptest::strategy::Strategy;
use proptest::test_runner::{Config, TestRunner};

/// The longest return, ms: from one end of the training lathe to the other, and at the low
/// rate of 033 over a dog.
const MAX_RETURN_MS: u32 = 40_000;

const fn key(byte: u16, bit: u8) -> BitAddress {
    BitAddress::new(Area::X, byte, bit)
}

const MACHINE_ZERO: BitAddress = key(20, 3);
const X_PLUS: BitAddress = key(23, 1);
const Z_PLUS: BitAddress = key(22, 7);

/// A lathe in machine zero mode, its slides at a position (X in radius).
fn lathe_at(config: LatheConfig, bits: &[(u16, u8, bool)], position: Point) -> Simulation {
    let mut setup = Setup::delivered();
    for (number, bit, value) in bits {
        assert!(
            setup
                .memory
                .parameters
                .set_bit(*number, *bit, *value)
                .is_ok()
        );
    }
    setup.lathe = config;
    let mut simulation = Simulation::new(setup);
    simulation.lathe.move_slides(position);
    run_ticks(&mut simulation, 300);
    press(&mut simulation, MACHINE_ZERO);
    simulation
}

/// Runs a return to its end: standstill for a fifth of a second.
fn is_finished(simulation: &mut Simulation) -> bool {
    let mut still = 0;
    for _ in 0..MAX_RETURN_MS {
        simulation.tick();
        still = if simulation.cnc.is_moving() {
            0
        } else {
            still + 1
        };
        if still == 200 {
            return true;
        }
    }
    false
}

fn alarm_detail(simulation: &Simulation, number: u16) -> String {
    let standing = simulation.cnc.alarms().iter();
    let found = standing.filter(|alarm| alarm.number == number);
    found.map(Alarm::detail_en).collect()
}

/// The training lathe, without parts that a machine file may remove.
fn lathe_without(limits: bool, dogs: bool, servo: Option<ServoConfig>) -> LatheConfig {
    let less = |axis: AxisConfig| AxisConfig {
        limits: axis.limits.filter(|_| limits),
        dog: axis.dog.filter(|_| dogs),
        servo,
        ..axis
    };
    let lathe = LatheConfig::default();
    LatheConfig {
        x: less(lathe.x),
        z: less(lathe.z),
        ..lathe
    }
}

#[test]
fn a_return_from_anywhere_comes_to_an_end_within_the_slide() {
    let mut runner = TestRunner::new(Config {
        cases: 60,
        failure_persistence: None,
        rng_algorithm: proptest::test_runner::RngAlgorithm::ChaCha,
        ..Config::default()
    });
    let lathes = (
        proptest::bool::ANY,
        proptest::bool::ANY,
        proptest::bool::ANY,
    );
    let methods = (
        proptest::bool::ANY,
        proptest::bool::ANY,
        proptest::bool::ANY,
    );
    let ways = (lathes, methods, 0.0..=1.0f64, 0.0..=1.0f64)
        .prop_map(|(lathe, method, x, z)| (lathe, method, x, z));
    let outcome = runner.run(&ways, |((limits, dogs, servo), method, x, z)| {
        let config = lathe_without(limits, dogs, servo.then(ServoConfig::default));
        let (of_x, of_z) = (config.x.slide_ends(Axis::X), config.z.slide_ends(Axis::Z));
        let at = |minus: f64, plus: f64, part: f64| minus + (plus - minus) * part;
        let place = Point::new(
            at(of_x.minus, of_x.plus, x) / 2.0,
            at(of_z.minus, of_z.plus, z),
        );
        let (with_switch, one_switch, negative) = method;
        let bits = [
            (11, 2, true),
            (14, 0, with_switch),
            (14, 1, with_switch),
            (7, 0, one_switch),
            (7, 1, one_switch),
            (6, 0, negative),
            (6, 1, negative),
        ];
        let mut simulation = lathe_at(config, &bits, place);
        press(&mut simulation, X_PLUS);
        press(&mut simulation, Z_PLUS);
        prop_assert!(is_finished(&mut simulation), "it does not end");
        let slides = simulation.lathe.slide_position();
        let (x, z) = (slides.x * 2.0, slides.z);
        prop_assert!((of_x.minus..=of_x.plus).contains(&x), "X stands at {x}");
        prop_assert!((of_z.minus..=of_z.plus).contains(&z), "Z stands at {z}");
        let arrived = simulation.cnc.referenced_axes();
        let has_alarm = !simulation.cnc.alarms().is_empty();
        prop_assert!(
            has_alarm || arrived.x && arrived.z,
            "it stands and says nothing"
        );
        Ok(())
    });
    assert_eq!(outcome, Ok(()));
}

#[test]
fn a_return_without_switches_ends_in_a_drive_alarm_that_names_them() {
    let mut simulation = lathe_at(
        lathe_without(false, false, None),
        &[(11, 2, true)],
        Point::default(),
    );
    press(&mut simulation, Z_PLUS);
    assert!(is_finished(&mut simulation));
    assert_eq!(simulation.lathe.slide_position().z, 15.0);
    assert_eq!(
        alarm_detail(&simulation, 222),
        "Z was returning to its machine zero and had not met the deceleration switch"
    );
}

#[test]
fn the_alarm_of_a_limit_switch_names_axis_side_and_direction_off() {
    // Beyond the dog, which ends at -5: the return hits the limit switch at +5.
    let place = Point::new(-50.0, -2.0);
    let mut simulation = lathe_at(LatheConfig::default(), &[(11, 2, true)], place);
    press(&mut simulation, Z_PLUS);
    assert!(is_finished(&mut simulation));
    assert_eq!(
        alarm_detail(&simulation, 207),
        "limit switch Z+: hold [Overtravel release 超程解除] (with the mouse: right-click it first) and jog Z- [← Z] until it is free; Z was returning to its machine \
         zero and had not met the deceleration switch"
    );
    // The button alone has no side.
    let mut simulation = lathe_at(LatheConfig::default(), &[], Point::new(-50.0, -100.0));
    simulation.lathe.set_emergency_button(true);
    run_ticks(&mut simulation, 50);
    assert_eq!(simulation.cnc.alarms()[0], Alarm::new(207));
}

#[test]
fn a_return_that_begins_on_its_switch_reports_the_direction_off() {
    for (negative, way) in [(false, "X-"), (true, "X+")] {
        let place = Point::new(-20.0, -100.0);
        let bits = [(6, 0, negative)];
        let mut simulation = lathe_at(LatheConfig::default(), &bits, place);
        press(&mut simulation, X_PLUS);
        assert_eq!(
            alarm_detail(&simulation, 90),
            format!(
                "X is on its deceleration switch: jog {way} until it is off, press RESET, then return"
            )
        );
    }
}

/// The advice to the operator while a key is pressed and released.
fn advice_messages(latching: bool, z: f64) -> Vec<String> {
    let place = Point::new(-50.0, z);
    let mut simulation = lathe_at(LatheConfig::default(), &[(11, 2, latching)], place);
    let mut messages = Vec::new();
    for (at, down) in [(Z_PLUS, true), (Z_PLUS, false), (MACHINE_ZERO, true)] {
        simulation.cnc.set_panel_key(at, down);
        for _ in 0..600 {
            simulation.tick();
            messages.extend(
                simulation
                    .cnc
                    .events()
                    .iter()
                    .filter_map(|event| match event {
                        Event::Advised(text) => Some(text.to_string()),
                        _ => None,
                    }),
            );
        }
    }
    assert!(!simulation.cnc.is_moving() && !simulation.cnc.referenced_axes().z);
    messages
}

#[test]
fn a_return_key_released_too_early_advises_to_hold_it() {
    let text = "the return of Z was interrupted: hold its key until the lamp lights \
                (with parameter 011.2 = 1 one press is enough)";
    assert_eq!(advice_messages(false, -150.0), [text]);
    // One press is enough; the key of the mode stops it on purpose.
    assert_eq!(advice_messages(true, -150.0), [""; 0]);
}

#[test]
fn a_return_interrupted_on_its_switch_advises_to_start_before_it() {
    let text = "the return of Z was interrupted at its deceleration switch: jog Z- until it is \
                clear of the switch, then hold the key until the lamp lights";
    assert_eq!(advice_messages(false, -30.5), [text]);
}
