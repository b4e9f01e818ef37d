//! The spindle with its ladder and lathe: gears, speed arrival, brake.

use std::sync::Arc;

use crate::bench::program::{started, with_program};
use crate::bench::{press, run_ticks};
use gsk_core::machine::LatheFault;
use gsk_core::operation::RunState;
use gsk_core::plc::Ladder;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::setup::{STANDARD_LADDER, Setup};
use gsk_core::simulation::Simulation;

const RESET: BitAddress = BitAddress::new(Area::X, 26, 0);
const BRAKE: BitAddress = BitAddress::new(Area::Y, 0, 7);
const M42_OUTPUT: BitAddress = BitAddress::new(Area::Y, 0, 0);
const M43_OUTPUT: BitAddress = BitAddress::new(Area::Y, 0, 1);
/// Input of the speed sensor in the ladder of these tests.
const ARRIVED: BitAddress = BitAddress::new(Area::X, 2, 0);

/// 2000 and 4000 r/min at 10 V in gears 1 and 2; 500 r/min while gears change, 200
/// and 300 ms before and after.
const GEARS: [(u16, i32); 6] = [
    (37, 2000),
    (38, 4000),
    (39, 8000),
    (65, 1),
    (66, 300),
    (67, 500),
];

fn setup(changes: &[(u16, i32)]) -> Setup {
    let mut setup = Setup::default();
    for (number, value) in changes {
        assert!(setup.memory.parameters.set(*number, *value).is_ok());
    }
    setup
}

/// Runs until the condition holds. Returns the number of ticks.
#[track_caller]
fn run_until(simulation: &mut Simulation, reached: impl Fn(&Simulation) -> bool) -> u32 {
    let mut count = 0;
    while !reached(simulation) {
        assert!(count < 60_000, "never: {:?}", simulation.cnc.alarms());
        simulation.tick();
        count += 1;
    }
    count
}

fn is_on(simulation: &Simulation, output: BitAddress) -> bool {
    simulation.cnc.plc().memory().bit(output)
}

fn volts(simulation: &Simulation) -> f64 {
    simulation.cnc.spindle().volts()
}

#[test]
fn a_gear_change_goes_step_by_step() {
    let text = "O0001\nM03 S1000\nG04 X1\nM42 G98 G01 X200 F6000\nM42\nM00\nM30\n";
    let mut simulation = started(setup(&GEARS), text);
    run_until(&mut simulation, |s| s.cnc.cursor().line == 3);
    assert!((volts(&simulation) - 5.0).abs() < 1e-9, "S1000 of 2000");
    run_until(&mut simulation, |s| s.cnc.spindle_commanded() == 500.0);
    let at = simulation.cnc.position_absolute();
    assert!((volts(&simulation) - 2.5).abs() < 1e-9, "067 in gear 1");
    run_ticks(&mut simulation, 30);
    assert_eq!(simulation.cnc.plc().memory().f(34), 0b10, "GR20");
    assert!(!is_on(&simulation, M42_OUTPUT));
    // 065 in units of 256 ms, then the gear's switch 500 ms after its output, then 066.
    let output = 30 + run_until(&mut simulation, |s| is_on(s, M42_OUTPUT));
    assert!((256..340).contains(&output), "{output}");
    let end = run_until(&mut simulation, |s| s.cnc.spindle_commanded() == 1000.0);
    assert!((800..900).contains(&end), "{end}");
    assert!((volts(&simulation) - 2.5).abs() < 1e-9, "S1000 of 4000");
    let moved = (simulation.cnc.position_absolute() - at).length();
    assert!(moved < 1e-3, "motion waits, it made {moved}");
    // Engaged already: the second M42 has nothing to do.
    run_until(&mut simulation, |s| {
        s.cnc.position_absolute().diameter().0 == 200.0
    });
    let line = run_until(&mut simulation, |s| s.cnc.cursor().line == 6);
    assert!(line < 20, "{line}");
}

#[test]
fn gears_three_and_four_have_no_switch() {
    let text = "O0001\nM03 S1000\nM43\nM00\nM30\n";
    let mut simulation = started(setup(&GEARS), text);
    run_until(&mut simulation, |s| is_on(s, M43_OUTPUT));
    let end = run_until(&mut simulation, |s| !s.cnc.spindle().is_changing_gear());
    assert!((300..400).contains(&end), "{end}");
    assert!((volts(&simulation) - 1.25).abs() < 1e-9, "S1000 of 8000");
}

#[test]
fn a_gear_that_does_not_engage_is_waited_for() {
    let mut setup = setup(&GEARS);
    // M42I valid when open (164.5 AGIM = 1): held closed.
    setup.forced_inputs = vec![(BitAddress::new(Area::X, 1, 2), true)];
    let mut simulation = started(setup, "O0001\nM03 S1000\nM42\nM00\nM30\n");
    run_ticks(&mut simulation, 30_000);
    assert!(simulation.cnc.spindle().is_changing_gear());
    assert_eq!(simulation.cnc.run_state(), RunState::Run);
    // Reset interrupts it: the old gear counts, S remains.
    press(&mut simulation, RESET);
    assert_eq!(simulation.cnc.spindle().gear(), 1);
    assert!((simulation.cnc.spindle_commanded() - 1000.0).abs() < 1e-9);
}

#[test]
fn an_analog_speed_is_on_f22_without_a_strobe() {
    let mut simulation = started(Setup::default(), "O0001\nM03 S1234\nM00\nM30\n");
    let mut strobe = false;
    for _ in 0..2000 {
        simulation.tick();
        strobe |= simulation.cnc.plc().memory().f(7) & 0b100 != 0;
    }
    let memory = simulation.cnc.plc().memory();
    assert_eq!((memory.f(22), memory.f(23)), (0xd2, 0x04));
    assert!(!strobe, "SF belongs to switched speeds");
}

/// The standard ladder with a speed sensor on X2.0, the check of 175.6, and 072.
fn with_sensor(delay: i32) -> Setup {
    let text = STANDARD_LADDER.replacen("OUT G29.4\n", "LD X2.0\nOUT G29.4\n", 1);
    let mut setup = setup(&[(175, 0b100_0000), (72, delay)]);
    let ladder = Ladder::compile(&text);
    assert!(ladder.is_ok());
    if let Ok(ladder) = ladder {
        setup.ladder = Arc::new(ladder).into();
    }
    setup
}

const CUTS: &str = "O0001\nM03 S500\nG00 X290\nG98 G01 X280 F600\nG01 X270\nM00\nM30\n";

#[test]
fn a_cut_waits_for_the_speed() {
    let mut simulation = with_program(with_sensor(0), CUTS);
    simulation.lathe.force_input(ARRIVED, Some(false));
    simulation.start_automatic();
    run_ticks(&mut simulation, 20_000);
    let at = simulation.cnc.position_absolute();
    assert_eq!(at.diameter().0, 290.0, "the rapid went, the cut waits");
    assert_eq!(simulation.cnc.run_state(), RunState::Run);
    simulation.lathe.force_input(ARRIVED, Some(true));
    let begun = run_until(&mut simulation, |s| s.cnc.position_absolute() != at);
    assert!(begun < 40, "{begun}");
    // The second cut follows a cut: SAR does not count any more.
    simulation.lathe.force_input(ARRIVED, Some(false));
    run_until(&mut simulation, |s| s.cnc.run_state() == RunState::Stop);
    assert_eq!(simulation.cnc.position_absolute().diameter().0, 270.0);
}

#[test]
fn the_speed_is_checked_after_072() {
    let mut begun = [0; 2];
    for (delay, begun) in [0, 250].into_iter().zip(&mut begun) {
        let mut simulation = with_program(with_sensor(delay), CUTS);
        simulation.lathe.force_input(ARRIVED, Some(true));
        simulation.start_automatic();
        run_until(&mut simulation, |s| s.cnc.cursor().line == 4);
        *begun = run_until(&mut simulation, |s| {
            s.cnc.feed_actual() > 0.0 && !s.cnc.position_absolute().diameter().0.eq(&290.0)
        });
    }
    assert_eq!(begun[1] - begun[0], 250);
}

#[test]
fn axes_are_stopped_while_the_brake_is_on() {
    for (zdil, stands) in [(0, true), (0b1_0000, false)] {
        let changes = [(11, 0b1000_0010 | zdil), (87, 50), (89, 1500)];
        let text = "O0001\nM03 S500\nG04 X1\nM05\nG98 G01 X200 F600\nM00\nM30\n";
        let mut simulation = started(setup(&changes), text);
        run_until(&mut simulation, |s| is_on(s, BRAKE));
        // M05 takes 080 = 500 ms; the cut begins while the brake is still on.
        let mut moved = 0;
        let mut ticks = 0;
        while is_on(&simulation, BRAKE) {
            let before = simulation.cnc.position_absolute();
            simulation.tick();
            moved += u32::from(simulation.cnc.position_absolute() != before);
            ticks += 1;
        }
        assert!(
            (1490..1530).contains(&ticks),
            "089 = 1500 ms, it took {ticks}"
        );
        // The tick in which the brake opens is the first that moves.
        assert_eq!(moved <= 1, stands, "{moved} ticks moved, 011.4 {zdil}");
    }
}

#[test]
fn feed_per_revolution_follows_the_measured_spindle() {
    let text = "O0001\nM03 S600\nG04 X1\nG99 G01 Z200 F0.5\nM00\nM30\n";
    let mut simulation = started(Setup::default(), text);
    run_until(&mut simulation, |s| s.cnc.position_absolute().z < 295.0);
    assert!((simulation.cnc.feed_actual() - 300.0).abs() < 1.0);
    // A stopped spindle stops the feed. When it starts again, so does the feed.
    simulation.lathe.set_fault(LatheFault::SpindleBlocked, true);
    run_ticks(&mut simulation, 1500);
    let at = simulation.cnc.position_absolute().z;
    run_ticks(&mut simulation, 500);
    assert_eq!(simulation.cnc.position_absolute().z, at);
    simulation
        .lathe
        .set_fault(LatheFault::SpindleBlocked, false);
    run_until(&mut simulation, |s| s.cnc.position_absolute().z < 250.0);
    assert!((simulation.cnc.feed_actual() - 300.0).abs() < 1.0);
}
