//! Control, ladder and lathe together: from the key to the pulse.

use crate::bench::{press, run_ticks};
use gsk_core::cnc::Event;
use gsk_core::operation::{OperatingMode, RunState};
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::setup::Setup;
use gsk_core::simulation::{RunUntilResult, Simulation, StopCondition};

const MINUTE: u64 = 60_000;

fn key(byte: u16, bit: u8) -> BitAddress {
    BitAddress::new(Area::X, byte, bit)
}

fn with_program(text: &str) -> Simulation {
    crate::bench::program::with_program(Setup::default(), text)
}

fn run_program(text: &str) -> Simulation {
    let mut simulation = crate::bench::program::started(Setup::default(), text);
    assert_eq!(
        simulation.run_until(StopCondition::Stopped, 10 * MINUTE),
        RunUntilResult::Reached
    );
    simulation
}

#[track_caller]
fn assert_stopped_at(simulation: &Simulation, diameter: f64, z: f64) {
    let at = simulation.cnc.position_absolute();
    let near = (at.diameter().0 - diameter).abs() < 1e-9 && (at.z - z).abs() < 1e-9;
    assert!(
        near,
        "at X{} Z{}, not X{diameter} Z{z}",
        at.diameter().0,
        at.z
    );
    let slides = simulation.lathe.slide_position();
    let machine = simulation.cnc.position_machine();
    assert!((slides.x - machine.x).abs() < 1e-6 && (slides.z - machine.z).abs() < 1e-6);
}

#[test]
fn the_machine_is_ready_after_power_on() {
    let mut simulation = Simulation::new(Setup::delivered());
    run_ticks(&mut simulation, 500);
    assert!(
        simulation.cnc.alarms().is_empty(),
        "{:?}",
        simulation.cnc.alarms()
    );
    assert_eq!(simulation.cnc.plc_messages().count(), 0);
    assert_eq!(simulation.cnc.feed_override(), 100);
    assert_eq!(simulation.cnc.rapid_override(), 100);
    assert_eq!(simulation.cnc.tool(), (1, 0));
}

#[test]
fn a_program_runs_from_the_key_to_the_pulse() {
    let simulation =
        run_program("O0001\nG00 X100 Z50\nG98 G01 X80 Z20 F500\nG02 X100 Z10 R10\nM30\n");
    assert_stopped_at(&simulation, 100.0, 10.0);
    assert_eq!(simulation.cnc.run_state(), RunState::Reset);
    assert_eq!(simulation.cnc.counters().parts, 1);
}

#[test]
fn spindle_tool_and_coolant_go_through_the_ladder() {
    let simulation = run_program("O0001\nT0303\nM03 S600\nM08\nG04 X2\nG00 X50\nM00\nM30\n");
    assert!(
        simulation.cnc.alarms().is_empty(),
        "{:?}",
        simulation.cnc.alarms()
    );
    assert_eq!(simulation.lathe.station(), Some(3));
    assert_eq!(simulation.cnc.tool(), (3, 3));
    assert!((simulation.lathe.spindle_rpm() - 600.0).abs() < 5.0);
    assert!((simulation.cnc.spindle_actual() - 600.0).abs() < 5.0);
    assert_eq!(
        simulation.cnc.plc().memory().y(0) & 0b1000,
        0b1000,
        "coolant"
    );
    assert_eq!(simulation.cnc.run_state(), RunState::Stop, "M00");
}

#[test]
fn m30_stops_spindle_and_coolant() {
    let mut simulation = run_program("O0001\nM03 S600\nM08\nM30\n");
    run_ticks(&mut simulation, 5000);
    assert!(simulation.lathe.spindle_rpm().abs() < 1.0);
    assert_eq!(simulation.cnc.plc().memory().y(0) & 0b1000, 0);
}

#[test]
fn feed_hold_stops_and_cycle_start_continues() {
    let mut simulation = with_program("O0001\nG98 G01 X200 F300\nM30\n");
    simulation.start_automatic();
    run_ticks(&mut simulation, 1000);
    assert_eq!(simulation.cnc.run_state(), RunState::Run);
    press(&mut simulation, key(24, 7));
    run_ticks(&mut simulation, 1000);
    assert_eq!(simulation.cnc.run_state(), RunState::Hold);
    let held = simulation.cnc.position_absolute();
    run_ticks(&mut simulation, 500);
    assert_eq!(simulation.cnc.position_absolute(), held);
    press(&mut simulation, key(25, 0));
    assert_eq!(
        simulation.run_until(StopCondition::Stopped, 10 * MINUTE),
        RunUntilResult::Reached
    );
    assert_stopped_at(&simulation, 200.0, 300.0);
}

#[test]
fn single_block_stops_after_each_block() {
    let mut simulation = with_program("O0001\nG00 X100\nG00 Z100\nM30\n");
    press(&mut simulation, key(20, 6));
    simulation.start_automatic();
    let mut stops = Vec::new();
    for _ in 0..3 {
        simulation.run_until(StopCondition::Stopped, MINUTE);
        stops.push((simulation.cnc.run_state(), simulation.cnc.cursor().line));
        press(&mut simulation, key(25, 0));
    }
    assert_eq!(
        stops,
        [
            (RunState::Stop, 2),
            (RunState::Stop, 3),
            (RunState::Reset, 1)
        ]
    );
}

#[test]
fn reset_ends_the_run_at_its_block() {
    let mut simulation = with_program("O0001\nG98 G01 X200 F300\nG01 Z0\nM30\n");
    simulation.start_automatic();
    run_ticks(&mut simulation, 1000);
    press(&mut simulation, key(26, 0));
    run_ticks(&mut simulation, 2000);
    assert_eq!(simulation.cnc.run_state(), RunState::Reset);
    assert!(!simulation.cnc.is_moving());
    assert_eq!(simulation.cnc.cursor().line, 2);
}

#[test]
fn the_emergency_stop_stops_at_once_and_clears_when_released() {
    let mut simulation = with_program("O0001\nM03 S500\nG98 G01 X200 F300\nM30\n");
    simulation.start_automatic();
    run_ticks(&mut simulation, 3000);
    assert!(simulation.cnc.is_moving());
    simulation.lathe.set_emergency_button(true);
    run_ticks(&mut simulation, 12);
    assert!(!simulation.cnc.is_moving());
    assert_eq!(simulation.cnc.alarms()[0].number, 207);
    assert!(simulation.cnc.is_shown_not_ready());
    run_ticks(&mut simulation, 100);
    assert_eq!(simulation.cnc.plc().memory().y(1) & 0b100, 0, "M03 is off");
    simulation.lathe.set_emergency_button(false);
    run_ticks(&mut simulation, 200);
    assert!(simulation.cnc.alarms().is_empty());
    assert_eq!(simulation.cnc.run_state(), RunState::Reset);
    assert!(!simulation.cnc.is_moving());
}

#[test]
fn jog_follows_its_key() {
    let mut simulation = Simulation::new(Setup::delivered());
    run_ticks(&mut simulation, 100);
    press(&mut simulation, key(20, 5));
    assert_eq!(simulation.cnc.mode(), OperatingMode::Jog);
    simulation.cnc.set_panel_key(key(22, 5), true);
    run_ticks(&mut simulation, 2000);
    let speed = simulation.cnc.feed_actual();
    assert!(
        (speed - 126.0).abs() < 1.0,
        "126 mm/min at 100 %, not {speed}"
    );
    assert!(simulation.cnc.position_machine().z < 0.0, "left is Z-");
    simulation.cnc.set_panel_key(key(22, 5), false);
    run_ticks(&mut simulation, 1000);
    assert!(!simulation.cnc.is_moving());

    press(&mut simulation, key(22, 6));
    simulation.cnc.set_panel_key(key(22, 5), true);
    run_ticks(&mut simulation, 1000);
    let speed = simulation.cnc.feed_actual();
    assert!((speed - 7600.0).abs() < 1.0, "rapid of Z, not {speed}");
}

#[test]
fn a_held_program_continues_after_jogging() {
    let mut simulation = with_program("O0001\nG98 G01 X200 F300\nG01 X100\nM30\n");
    simulation.start_automatic();
    run_ticks(&mut simulation, 1000);
    press(&mut simulation, key(20, 5));
    run_ticks(&mut simulation, 500);
    assert_eq!(simulation.cnc.run_state(), RunState::Hold);
    let before = simulation.cnc.position_absolute();
    simulation.cnc.set_panel_key(key(22, 7), true);
    run_ticks(&mut simulation, 1000);
    simulation.cnc.set_panel_key(key(22, 7), false);
    run_ticks(&mut simulation, 1000);
    assert!(simulation.cnc.position_absolute().z > before.z);
    simulation.start_automatic();
    assert_eq!(
        simulation.run_until(StopCondition::Stopped, 10 * MINUTE),
        RunUntilResult::Reached
    );
    assert!((simulation.cnc.position_absolute().diameter().0 - 100.0).abs() < 1e-9);
}

#[test]
fn feed_override_steps_act() {
    let mut simulation = with_program("O0001\nG98 G01 X0 F200\nM30\n");
    simulation.start_automatic();
    run_ticks(&mut simulation, 2000);
    for _ in 0..5 {
        press(&mut simulation, key(24, 6));
    }
    run_ticks(&mut simulation, 1000);
    assert_eq!(simulation.cnc.feed_override(), 50);
    assert!((simulation.cnc.feed_actual() - 100.0).abs() < 0.5);
}

#[test]
fn an_alarm_stops_at_its_block() {
    let simulation = run_program("O0001\nG00 X100\nG01 Z10\nM30\n");
    let alarm = &simulation.cnc.alarms()[0];
    assert_eq!((alarm.number, alarm.source.unwrap().line), (11, 3));
    assert_stopped_at(&simulation, 100.0, 300.0);
    assert_ne!(simulation.cnc.run_state(), RunState::Run);
}

#[test]
fn an_endless_loop_stays_responsive() {
    let mut simulation = with_program("O0001\nM99\n");
    simulation.start_automatic();
    run_ticks(&mut simulation, 1000);
    assert_eq!(simulation.cnc.run_state(), RunState::Run);
    press(&mut simulation, key(26, 0));
    run_ticks(&mut simulation, 100);
    assert_eq!(simulation.cnc.run_state(), RunState::Reset);
}

#[test]
fn machine_lock_moves_the_display_only() {
    let mut simulation = with_program("O0001\nG00 X100 Z50\nM30\n");
    press(&mut simulation, key(21, 0));
    simulation.start_automatic();
    simulation.run_until(StopCondition::Stopped, MINUTE);
    let at = simulation.cnc.position_absolute();
    assert_eq!((at.diameter().0, at.z), (100.0, 50.0));
    assert!((simulation.cnc.position_machine().z - 300.0).abs() < 1e-9);
    assert_eq!(simulation.lathe.slide_position().z, 300.0);
}

#[test]
fn executed_moves_are_reported_in_order() {
    let mut simulation = with_program("O0001\nG00 X100\nG98 G01 Z200 F1000\nM30\n");
    simulation.start_automatic();
    let mut lines = Vec::new();
    while simulation.cnc.run_state() == RunState::Run {
        simulation.tick();
        for event in simulation.cnc.events() {
            if let Event::MoveEnded(piece) = event {
                lines.push(piece.source.line);
            }
        }
    }
    assert_eq!(lines, [2, 3]);
}

#[test]
fn a_saved_simulation_continues_bit_for_bit() {
    let mut one = with_program("O0001\nM03 S500\nG98 G01 X200 Z100 F700\nM30\n");
    one.start_automatic();
    run_ticks(&mut one, 2000);
    let mut other = one.clone();
    run_ticks(&mut one, 5000);
    run_ticks(&mut other, 5000);
    assert_eq!(one, other);
}

#[test]
fn soft_limits_stop_a_jog_and_allow_the_return() {
    let mut setup = Setup::default();
    setup.memory.parameters.set(46, 310_000).unwrap();
    setup.memory.parameters.set_bit(172, 4, false).unwrap();
    let mut simulation = Simulation::new(setup);
    run_ticks(&mut simulation, 100);
    press(&mut simulation, key(20, 5));
    press(&mut simulation, key(22, 6));
    simulation.cnc.set_panel_key(key(22, 7), true);
    run_ticks(&mut simulation, 3000);
    assert_eq!(simulation.cnc.alarms()[0].number, 203);
    let over = simulation.cnc.position_machine().z - 310.0;
    assert!(
        (0.0..=1.52).contains(&over),
        "stopped {over} mm beyond the limit"
    );
    simulation.cnc.set_panel_key(key(22, 7), false);
    run_ticks(&mut simulation, 500);
    simulation.cnc.set_panel_key(key(22, 5), true);
    run_ticks(&mut simulation, 500);
    simulation.cnc.set_panel_key(key(22, 5), false);
    run_ticks(&mut simulation, 500);
    assert!(simulation.cnc.position_machine().z < 310.0);
    press(&mut simulation, key(26, 0));
    assert!(simulation.cnc.alarms().is_empty());
}

/// An axis passes its soft limit by at most a fifth of its rapid rate in m/min (045 to 048),
/// wherever it comes from and even while it accelerates there.
#[test]
fn a_rapid_passes_a_soft_limit_by_a_fifth_of_its_rate_at_most() {
    /// Of X as a radius, mm.
    const LEAST_INCREMENT: f64 = 0.000_5;
    // Jog key, parameter of the limit, sign, rapid rate m/min; X counts its diameter.
    let sides = [
        (key(22, 7), 46, 1, 7.6),
        (key(22, 5), 48, -1, 7.6),
        (key(23, 1), 45, 1, 3.8),
        (key(22, 3), 47, -1, 3.8),
    ];
    for (jog, number, sign, rate) in sides {
        let along_x = number % 2 == 1;
        for step in 0..24 {
            // From 0.4 mm before the limit, where the axis has hardly begun, to 12 mm.
            let ahead = 400 + 497 * step;
            let at = if along_x { 150.0 } else { 300.0 };
            let thousandths = (at * 1000.0) as i32 + sign * ahead;
            let mut setup = Setup::default();
            let value = if along_x {
                2 * thousandths
            } else {
                thousandths
            };
            setup.memory.parameters.set(number, value).unwrap();
            setup.memory.parameters.set_bit(172, 4, false).unwrap();
            let mut simulation = Simulation::new(setup);
            run_ticks(&mut simulation, 100);
            press(&mut simulation, key(20, 5));
            press(&mut simulation, key(22, 6));
            simulation.cnc.set_panel_key(jog, true);
            run_ticks(&mut simulation, 1500);
            let position = simulation.cnc.position_machine();
            let reached = if along_x { position.x } else { position.z };
            let over = f64::from(sign) * reached - f64::from(sign * thousandths) / 1000.0;
            assert!(!simulation.cnc.is_moving(), "{number}, {ahead} µm ahead");
            assert!(
                over > 0.0 && over <= rate / 5.0 + LEAST_INCREMENT,
                "{number}, {ahead} µm ahead: {over} mm beyond the limit"
            );
        }
    }
}

#[test]
fn power_off_and_on_keeps_tool_overrides_and_parts() {
    let mut simulation = run_program("O0001\nT0202\nM30\n");
    press(&mut simulation, key(24, 3));
    simulation.power_cycle();
    run_ticks(&mut simulation, 500);
    assert!(
        simulation.cnc.alarms().is_empty(),
        "{:?}",
        simulation.cnc.alarms()
    );
    assert_eq!(simulation.cnc.tool(), (2, 0));
    assert_eq!(simulation.cnc.feed_override(), 110);
    assert_eq!(simulation.cnc.counters().parts, 1);
    assert_eq!(simulation.cnc.mode(), OperatingMode::Auto);
    let (slides, machine) = (
        simulation.lathe.slide_position(),
        simulation.cnc.position_machine(),
    );
    assert_eq!(slides, machine);
}

#[test]
fn the_tool_change_key_indexes_the_tool_post() {
    let mut simulation = Simulation::new(Setup::delivered());
    run_ticks(&mut simulation, 100);
    press(&mut simulation, key(20, 5));
    press(&mut simulation, key(24, 0));
    run_ticks(&mut simulation, 5000);
    assert_eq!(simulation.lathe.station(), Some(2));
    assert_eq!(simulation.cnc.tool(), (2, 0));
}

#[test]
fn a_cut_per_revolution_follows_the_measured_spindle() {
    let mut simulation = with_program("O0001\nM03 S500\nG99 G01 X0 F0.2\nM30\n");
    simulation.start_automatic();
    run_ticks(&mut simulation, 8000);
    let speed = simulation.cnc.feed_actual();
    assert!(
        (speed - 100.0).abs() < 0.5,
        "0.2 mm/rev at 500 r/min is 100 mm/min, not {speed}"
    );
}

#[test]
fn dry_run_locks_the_machine_and_takes_the_jog_rate() {
    let mut simulation = with_program("O0001\nG98 G01 X0 F20\nM03 S300\nM30\n");
    press(&mut simulation, key(21, 2));
    simulation.start_automatic();
    run_ticks(&mut simulation, 2000);
    assert!((simulation.cnc.feed_actual() - 126.0).abs() < 0.5);
    assert!((simulation.cnc.position_machine().x - 150.0).abs() < 1e-9);
}
