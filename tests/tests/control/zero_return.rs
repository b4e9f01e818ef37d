//! Returns to the machine zero and to the program zero point (manual III-7).

use crate::bench::{press, run_ticks};
use gsk_core::cnc::ControlRequest;
use gsk_core::machine::{LatheConfig, ServoConfig};
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::{Axis, Point};
use proptest::strategy::{Strategy, ValueTree};

const MINUTE: u64 = 60_000;

const fn key(byte: u16, bit: u8) -> BitAddress {
    BitAddress::new(Area::X, byte, bit)
}

const MACHINE_ZERO: BitAddress = key(20, 3);
const PROGRAM_ZERO: BitAddress = key(21, 3);
const JOG: BitAddress = key(20, 5);
const MDI: BitAddress = key(20, 2);
const START: BitAddress = key(25, 0);
/// Arrow down and arrow right: X+, Z+.
const X_PLUS: BitAddress = key(23, 1);
const Z_PLUS: BitAddress = key(22, 7);
const Z_MINUS: BitAddress = key(22, 5);

/// The lathe as delivered, with changed parameter bits and the tool at a position.
fn delivered_lathe(bits: &[(u16, u8, bool)], x: f64, z: f64) -> Simulation {
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
    setup.lathe.x.start = x;
    setup.lathe.z.start = z;
    let mut simulation = Simulation::new(setup);
    run_ticks(&mut simulation, 300);
    simulation
}

/// Holds a key until the axes have stopped, for at most `limit` ms.
fn hold_until_still(simulation: &mut Simulation, key: BitAddress, limit: u32) {
    simulation.cnc.set_panel_key(key, true);
    run_ticks(simulation, 200);
    for _ in 0..limit {
        if !simulation.cnc.is_moving() {
            break;
        }
        simulation.tick();
    }
    run_ticks(simulation, 200);
    simulation.cnc.set_panel_key(key, false);
    run_ticks(simulation, 50);
}

fn is_lamp_on(simulation: &Simulation, byte: u16, bit: u8) -> bool {
    simulation
        .cnc
        .plc()
        .memory()
        .bit(BitAddress::new(Area::Y, byte, bit))
}

fn alarms(simulation: &Simulation) -> Vec<u16> {
    simulation
        .cnc
        .alarms()
        .iter()
        .map(|alarm| alarm.number)
        .collect()
}

/// Runs a return until the axes have been at rest for a tenth of a second.
#[track_caller]
fn wait_until_still(simulation: &mut Simulation) {
    let mut still = 0;
    for time in 0.. {
        assert!(time < 2 * MINUTE, "it does not come to rest");
        simulation.tick();
        let moves = simulation.cnc.is_moving() || simulation.cnc.run_state() == RunState::Run;
        still = if moves { 0 } else { still + 1 };
        if still == 100 {
            return;
        }
    }
}

/// Checks a returned axis: machine coordinate, lamp, and true position of the slide.
#[track_caller]
fn assert_at_zero(simulation: &Simulation, axis: Axis, position: f64) {
    assert_eq!(alarms(simulation), [0u16; 0]);
    assert_eq!(simulation.cnc.position_machine().get(axis), 0.0);
    assert!(*simulation.cnc.referenced_axes().get(axis));
    let bit = if axis == Axis::X { 7 } else { 5 };
    assert!(is_lamp_on(simulation, 4, bit), "zero lamp");
    let slide = simulation.lathe.slide_position().get(axis);
    assert!(
        (slide - position).abs() < 1e-9,
        "{axis:?} stands at {slide}"
    );
}

#[test]
fn method_b_stops_on_the_first_zero_signal_after_the_switch() {
    // X: dog -60 to -10 on the diameter, signal at 0; Z: dog -30 to -5, signal at 0.
    let mut simulation = delivered_lathe(&[], -100.0, -150.0);
    press(&mut simulation, MACHINE_ZERO);
    hold_until_still(&mut simulation, Z_PLUS, 30_000);
    assert_at_zero(&simulation, Axis::Z, 0.0);
    assert!(!simulation.cnc.referenced_axes().x);
    hold_until_still(&mut simulation, X_PLUS, 30_000);
    assert_at_zero(&simulation, Axis::X, 0.0);
    // The lamp goes off when the axis leaves.
    press(&mut simulation, JOG);
    hold_until_still(&mut simulation, Z_MINUS, 500);
    assert!(!is_lamp_on(&simulation, 4, 5) && is_lamp_on(&simulation, 4, 7));
}

/// Executes a block by MDI and waits for its end.
#[track_caller]
fn run_mdi_block(simulation: &mut Simulation, words: &[&str]) {
    press(simulation, MDI);
    for word in words {
        let word = ControlRequest::AddMdiWord((*word).to_owned());
        simulation.cnc.request(word).unwrap();
    }
    press(simulation, START);
    wait_until_still(simulation);
    // The motors arrive after their command.
    run_ticks(simulation, 1000);
    assert_eq!(alarms(simulation), [0u16; 0]);
}

/// With any following error at the signal, and any backlash of the screw: the axis is at zero
/// from both sides where the control displays zero.
#[test]
fn a_servo_with_backlash_is_where_the_control_shows_it() {
    let mut worst: f64 = 0.0;
    for method_c in [false, true] {
        for gain in [20.0, 97.0] {
            for play in [0_i32, 3, 40] {
                for low in [200, 1000] {
                    let mut setup = Setup::delivered();
                    setup.lathe.z.start = -150.0;
                    setup.lathe.z.servo = Some(ServoConfig {
                        gain,
                        ..ServoConfig::default()
                    });
                    setup.lathe.z.backlash = f64::from(play) / 1000.0;
                    let parameters = &mut setup.memory.parameters;
                    parameters.set(35, play).unwrap();
                    parameters.set(33, low).unwrap();
                    parameters.set_bit(7, 1, method_c).unwrap();
                    parameters.set_bit(11, 2, true).unwrap();
                    let mut simulation = Simulation::new(setup);
                    run_ticks(&mut simulation, 300);
                    press(&mut simulation, MACHINE_ZERO);
                    press(&mut simulation, Z_PLUS);
                    wait_until_still(&mut simulation);
                    run_ticks(&mut simulation, 1000);
                    let at = |simulation: &Simulation| simulation.lathe.slide_position().z;
                    assert!(
                        simulation.cnc.referenced_axes().z,
                        "{:?}",
                        alarms(&simulation)
                    );
                    assert_eq!(simulation.cnc.position_machine().z, 0.0);
                    let zero = at(&simulation);
                    run_mdi_block(&mut simulation, &["G00", "W-5"]);
                    let below = at(&simulation);
                    run_mdi_block(&mut simulation, &["G00", "W5"]);
                    let again = at(&simulation);
                    let off = (below + 5.0 - zero).abs().max((again - zero).abs());
                    worst = worst.max(off);
                }
            }
        }
    }
    assert!(worst < 0.001, "{worst} mm");
}

/// 113 = 7600 in Z and half of it in X; 033 = 200 on the switch.
#[test]
fn the_approach_is_fast_and_the_search_slow() {
    let mut simulation = delivered_lathe(&[(11, 2, true)], -200.0, -300.0);
    press(&mut simulation, MACHINE_ZERO);
    press(&mut simulation, X_PLUS);
    press(&mut simulation, Z_PLUS);
    let (mut top, mut low) = (Point::default(), Point::new(9e9, 9e9));
    let mut before = simulation.lathe.slide_position();
    let mut slow_ticks = 0;
    for _ in 0..30_000 {
        simulation.tick();
        let now = simulation.lathe.slide_position();
        let speed = (now - before) * 60_000.0;
        before = now;
        top = Point::new(top.x.max(speed.x), top.z.max(speed.z));
        if now.z > -4.9 && now.z < -0.1 {
            slow_ticks += 1;
            low = Point::new(0.0, low.z.min(speed.z));
        }
    }
    assert!(
        (top.x - 3800.0).abs() <= 30.0 && (top.z - 7600.0).abs() <= 60.0,
        "{top:?}"
    );
    // 4.8 mm at 200 mm/min.
    assert!((1430..=1450).contains(&slow_ticks), "{slow_ticks}");
    assert_at_zero(&simulation, Axis::X, 0.0);
    assert_at_zero(&simulation, Axis::Z, 0.0);
}

#[test]
fn without_the_latch_releasing_the_keys_stops_the_return() {
    let mut simulation = delivered_lathe(&[], -100.0, -150.0);
    press(&mut simulation, MACHINE_ZERO);
    hold_until_still(&mut simulation, Z_PLUS, 200);
    run_ticks(&mut simulation, 1000);
    assert!(!simulation.cnc.is_moving());
    let z = simulation.lathe.slide_position().z;
    assert!((-150.0..-30.0).contains(&z) && z > -149.0, "{z}");
    assert!(!simulation.cnc.referenced_axes().z);
    // Pressed again it starts again.
    hold_until_still(&mut simulation, Z_PLUS, 30_000);
    assert_at_zero(&simulation, Axis::Z, 0.0);
}

#[test]
fn with_the_latch_one_press_is_enough_and_reset_stops_it() {
    let mut simulation = delivered_lathe(&[(11, 2, true)], -100.0, -150.0);
    press(&mut simulation, MACHINE_ZERO);
    press(&mut simulation, Z_PLUS);
    assert!(simulation.cnc.is_moving());
    press(&mut simulation, key(26, 0));
    run_ticks(&mut simulation, 1000);
    assert!(!simulation.cnc.is_moving() && !simulation.cnc.referenced_axes().z);
    press(&mut simulation, Z_MINUS);
    wait_until_still(&mut simulation);
    assert_at_zero(&simulation, Axis::Z, 0.0);
}

#[test]
fn on_the_switch_the_return_is_refused_with_alarm_090() {
    let mut simulation = delivered_lathe(&[], -100.0, -20.0);
    press(&mut simulation, MACHINE_ZERO);
    hold_until_still(&mut simulation, Z_PLUS, 1000);
    assert_eq!(alarms(&simulation), [90]);
    assert_eq!(simulation.lathe.slide_position().z, -20.0);
}

/// Method C with a return in the positive direction: the zero is the positive end of the dog,
/// reached on the way back.
#[test]
fn method_c_comes_back_to_the_edge_of_the_switch() {
    let mut simulation = delivered_lathe(&[(7, 1, true), (11, 2, true)], -100.0, -150.0);
    press(&mut simulation, MACHINE_ZERO);
    press(&mut simulation, Z_PLUS);
    wait_until_still(&mut simulation);
    run_ticks(&mut simulation, 100);
    assert_at_zero(&simulation, Axis::Z, -5.0);
}

#[test]
fn method_a_goes_straight_to_the_zero_that_was_set() {
    let mut simulation = delivered_lathe(&[(14, 0, false), (14, 1, false)], -100.0, -150.0);
    press(&mut simulation, MACHINE_ZERO);
    hold_until_still(&mut simulation, Z_PLUS, 1000);
    assert_eq!(alarms(&simulation), [93]);
    press(&mut simulation, key(26, 0));
    simulation
        .cnc
        .request(ControlRequest::SetMachineZero(Axis::Z))
        .expect("at rest");
    press(&mut simulation, JOG);
    press(&mut simulation, key(22, 6));
    hold_until_still(&mut simulation, Z_MINUS, 700);
    press(&mut simulation, MACHINE_ZERO);
    hold_until_still(&mut simulation, Z_MINUS, 30_000);
    assert_at_zero(&simulation, Axis::Z, -150.0);
    // It remains after an emergency stop.
    simulation.lathe.set_emergency_button(true);
    run_ticks(&mut simulation, 100);
    simulation.lathe.set_emergency_button(false);
    run_ticks(&mut simulation, 300);
    assert!(simulation.cnc.referenced_axes().z);
}

#[test]
fn a_switch_means_that_the_zero_is_not_set_by_hand() {
    let mut simulation = delivered_lathe(&[], -100.0, -150.0);
    simulation
        .cnc
        .request(ControlRequest::SetMachineZero(Axis::Z))
        .expect("ignored");
    assert!(!simulation.cnc.referenced_axes().z);
}

/// The absolute coordinates continue through a return, or begin at 049 and 050 with 012.7 APRS
/// = 1; the relative ones follow with 005.1 PPD = 1.
#[test]
fn coordinates_after_the_return() {
    for (aprs, ppd) in [(false, true), (true, true), (true, false)] {
        let mut simulation =
            delivered_lathe(&[(12, 7, aprs), (5, 1, ppd), (11, 2, true)], -100.0, -150.0);
        press(&mut simulation, MACHINE_ZERO);
        press(&mut simulation, Z_PLUS);
        wait_until_still(&mut simulation);
        run_ticks(&mut simulation, 100);
        let absolute = simulation.cnc.position_absolute().z;
        let relative = simulation.cnc.position_relative().z;
        // It has moved 150 mm; 050 is 0.
        let (expected, follows) = match (aprs, ppd) {
            (false, _) => (150.0, 150.0),
            (true, true) => (0.0, 0.0),
            (true, false) => (0.0, 150.0),
        };
        assert!(
            (absolute - expected).abs() < 1e-6,
            "{aprs} {ppd}: {absolute}"
        );
        assert!(
            (relative - follows).abs() < 1e-6,
            "{aprs} {ppd}: {relative}"
        );
    }
}

fn start_mdi_block(simulation: &mut Simulation, words: &[&str]) {
    press(simulation, MDI);
    for word in words {
        let word = ControlRequest::AddMdiWord((*word).to_owned());
        assert_eq!(simulation.cnc.request(word), Ok(()));
    }
    press(simulation, START);
}

#[test]
fn g28_seeks_the_reference_of_an_axis_that_has_none() {
    let mut simulation = delivered_lathe(&[], -100.0, -150.0);
    start_mdi_block(&mut simulation, &["G28", "U0", "W-10"]);
    wait_until_still(&mut simulation);
    run_ticks(&mut simulation, 100);
    assert_at_zero(&simulation, Axis::X, 0.0);
    assert_at_zero(&simulation, Axis::Z, 0.0);
    // From now on it is a rapid.
    start_mdi_block(&mut simulation, &["G28", "U-50", "W-100"]);
    let mut longest = 0u32;
    while simulation.cnc.run_state() == RunState::Run || simulation.cnc.is_moving() {
        simulation.tick();
        longest += 1;
        assert!(longest < 5000, "no search at the low rate");
    }
    run_ticks(&mut simulation, 100);
    assert_at_zero(&simulation, Axis::X, 0.0);
}

#[test]
fn a_program_continues_with_its_own_coordinates_after_g28() {
    let mut simulation = delivered_lathe(&[], -100.0, -150.0);
    let text = "O0001\nG50 X200 Z100\nG28 U0 W0\nG00 X210 Z90\nM30\n";
    let opened = simulation
        .cnc
        .request(ControlRequest::OpenExternal(Program::new(text)));
    assert_eq!(opened, Ok(()));
    simulation.start_automatic();
    wait_until_still(&mut simulation);
    assert_eq!(alarms(&simulation), [0u16; 0]);
    // The slides began at X-100 Z-150, which is X200 Z100 of the program.
    let slides = simulation.lathe.slide_position();
    assert!(
        (slides.x + 45.0).abs() < 1e-6 && (slides.z + 160.0).abs() < 1e-6,
        "{slides:?}"
    );
}

#[test]
fn feed_hold_stops_the_search_of_a_g28_and_start_continues() {
    let mut simulation = delivered_lathe(&[], -100.0, -150.0);
    start_mdi_block(&mut simulation, &["G28", "W0"]);
    run_ticks(&mut simulation, 500);
    press(&mut simulation, key(24, 7));
    run_ticks(&mut simulation, 1000);
    assert_eq!(simulation.cnc.run_state(), RunState::Hold);
    assert!(!simulation.cnc.is_moving());
    press(&mut simulation, START);
    wait_until_still(&mut simulation);
    run_ticks(&mut simulation, 100);
    assert_at_zero(&simulation, Axis::Z, 0.0);
}

#[test]
fn program_zero_is_where_the_g50_was() {
    let mut setup = Setup::default();
    setup
        .memory
        .parameters
        .set_bit(11, 2, true)
        .expect("exists");
    let mut simulation = Simulation::new(setup);
    run_ticks(&mut simulation, 300);
    press(&mut simulation, PROGRAM_ZERO);
    press(&mut simulation, X_PLUS);
    assert_eq!(alarms(&simulation), [93]);
    press(&mut simulation, key(26, 0));
    let from = simulation.lathe.slide_position();
    start_mdi_block(&mut simulation, &["G50", "X100", "Z50"]);
    run_ticks(&mut simulation, 200);
    start_mdi_block(&mut simulation, &["G00", "X60.5", "Z-20.123"]);
    wait_until_still(&mut simulation);
    press(&mut simulation, PROGRAM_ZERO);
    press(&mut simulation, X_PLUS);
    press(&mut simulation, Z_MINUS);
    wait_until_still(&mut simulation);
    run_ticks(&mut simulation, 100);
    assert_eq!(alarms(&simulation), [0u16; 0]);
    assert_eq!(simulation.lathe.slide_position(), from);
    assert!(is_lamp_on(&simulation, 4, 7) && is_lamp_on(&simulation, 4, 5));
    let shown = simulation.cnc.position_absolute();
    assert!((shown.diameter().0 - 100.0).abs() < 1e-9 && (shown.z - 50.0).abs() < 1e-9);
}

#[test]
fn a_return_moves_under_the_ladders_locks_only() {
    let mut simulation = delivered_lathe(&[(11, 2, true)], -100.0, -150.0);
    press(&mut simulation, MACHINE_ZERO);
    press(&mut simulation, key(21, 0));
    let moved = |simulation: &Simulation| simulation.lathe.slide_position();
    let before = moved(&simulation);
    press(&mut simulation, Z_PLUS);
    run_ticks(&mut simulation, 1000);
    assert_eq!(moved(&simulation), before, "machine lock");
    assert!(!simulation.cnc.referenced_axes().z);
}

/// Number of random starts: a tenth unless PROPTEST_CASES sets another one.
fn random_start_count() -> u32 {
    std::env::var("PROPTEST_CASES")
        .ok()
        .and_then(|count| count.parse().ok())
        .unwrap_or(100)
}

/// A lathe with short travel: the dogs are as far from the zero as braking needs.
fn short_lathe(bits: &[(u16, u8, bool)]) -> Simulation {
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
    // Fast low rate and short ramps: the test is about positions, not about time.
    for (number, value) in [(33, 1000), (24, 50), (25, 50)] {
        assert!(setup.memory.parameters.set(number, value).is_ok());
    }
    setup.lathe = LatheConfig::default();
    let mut simulation = Simulation::new(setup);
    run_ticks(&mut simulation, 300);
    press(&mut simulation, MACHINE_ZERO);
    simulation
}

/// Puts both slides at a position, returns both axes by the keys, and returns their end
/// positions in pulses of the lathe.
fn return_from(simulation: &mut Simulation, x: f64, z: f64) -> (f64, f64) {
    simulation.lathe.move_slides(Point::new(x, z));
    simulation.lathe.set_count(simulation.cnc.pulses());
    // Both keys of an axis start the return; the lamps of the last one are off.
    press(simulation, JOG);
    hold_until_still(simulation, Z_MINUS, 40);
    hold_until_still(simulation, key(22, 3), 40);
    press(simulation, MACHINE_ZERO);
    press(simulation, X_PLUS);
    press(simulation, Z_PLUS);
    wait_until_still(simulation);
    run_ticks(simulation, 50);
    assert_eq!(alarms(simulation), [0u16; 0]);
    assert!(
        is_lamp_on(simulation, 4, 7) && is_lamp_on(simulation, 4, 5),
        "from {x} {z}"
    );
    let slides = simulation.lathe.slide_position();
    (slides.x, slides.z)
}

fn assert_same_position(bits: &[(u16, u8, bool)], place: (f64, f64)) {
    let mut simulation = short_lathe(bits);
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    for _ in 0..random_start_count() {
        let start = (-140.0..-32.0, -480.0..-32.0).new_tree(&mut runner);
        let Ok((x, z)) = start.map(|tree| tree.current()) else {
            continue;
        };
        let came = return_from(&mut simulation, x, z);
        // Exactly the same pulse: the positions are whole numbers of pulses.
        let pulses = |(x, z): (f64, f64)| ((x * 2000.0).round(), (z * 1000.0).round());
        assert_eq!(pulses(came), pulses(place), "from {x} {z}");
    }
}

#[test]
fn method_b_lands_on_the_same_pulse_from_anywhere() {
    assert_same_position(&[(11, 2, true)], (0.0, 0.0));
}

#[test]
fn method_c_lands_on_the_same_pulse_from_anywhere() {
    assert_same_position(&[(11, 2, true), (7, 0, true), (7, 1, true)], (-5.0, -5.0));
}

#[test]
fn method_a_lands_on_the_same_pulse_from_anywhere() {
    let bits = [(11, 2, true), (14, 0, false), (14, 1, false)];
    let mut simulation = short_lathe(&bits);
    for axis in [Axis::X, Axis::Z] {
        let set = simulation.cnc.request(ControlRequest::SetMachineZero(axis));
        assert_eq!(set, Ok(()));
    }
    let zero = simulation.cnc.pulses();
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    for _ in 0..random_start_count() {
        let start = (10u32..900, 10u32..900);
        let (x, z) = start.new_tree(&mut runner).expect("times").current();
        press(&mut simulation, JOG);
        press(&mut simulation, key(22, 6));
        hold_for(&mut simulation, key(22, 3), x);
        hold_for(&mut simulation, Z_MINUS, z);
        assert_ne!(simulation.cnc.pulses(), zero);
        press(&mut simulation, MACHINE_ZERO);
        press(&mut simulation, X_PLUS);
        press(&mut simulation, Z_PLUS);
        wait_until_still(&mut simulation);
        run_ticks(&mut simulation, 50);
        assert_eq!(simulation.cnc.pulses(), zero);
        assert_eq!(alarms(&simulation), [0u16; 0]);
    }
}

fn hold_for(simulation: &mut Simulation, key: BitAddress, time: u32) {
    simulation.cnc.set_panel_key(key, true);
    run_ticks(simulation, time);
    simulation.cnc.set_panel_key(key, false);
    run_ticks(simulation, 1000);
}
