//! Tests of the simulated lathe without a control.

use gsk_plc::address::BitAddress;

use super::*;
use crate::memory::ControlParameters;
use crate::units::{PerAxis, Point, Pulses};

fn parameters(changes: &[(u16, i32)]) -> ControlParameters {
    let mut parameters = ControlParameters::default();
    for (number, value) in changes {
        parameters.set(*number, *value).unwrap();
    }
    parameters
}

fn lathe(changes: &[(u16, i32)]) -> SimulatedLathe {
    SimulatedLathe::new(LatheConfig::default(), &parameters(changes))
}

fn outputs(on: &[(usize, u8)]) -> MachineOutputs {
    let mut outputs = MachineOutputs::default();
    for (byte, bit) in on {
        outputs.y[*byte] |= 1 << bit;
    }
    outputs
}

/// Runs the lathe until `is_done`. Returns the number of ticks.
fn ticks_until(
    lathe: &mut SimulatedLathe,
    outputs: &MachineOutputs,
    is_done: impl Fn(&SimulatedLathe) -> bool,
) -> u32 {
    for ticks in 1..10_000 {
        tick(lathe, outputs);
        if is_done(lathe) {
            return ticks;
        }
    }
    panic!("it never happens");
}

fn address(text: &str) -> BitAddress {
    text.parse().unwrap()
}

/// Parameters for an analog spindle with 2000 r/min at 10 V.
const ANALOG: [(u16, i32); 2] = [(1, 0b0001_0000), (37, 2000)];
const TL_FORWARD: (usize, u8) = (1, 6);
const TL_REVERSE: (usize, u8) = (1, 7);
const M03: (usize, u8) = (1, 2);
const M04: (usize, u8) = (0, 4);
const SPZD: (usize, u8) = (0, 7);

#[test]
fn at_start_the_loop_is_closed_and_the_dogs_are_free() {
    let inputs = lathe(&[]).inputs();
    assert!(inputs.is_closed(0, 5), "*ESP");
    assert!(inputs.is_closed(0, 3) && inputs.is_closed(1, 3), "*DEC");
    // TSGN = 1: the station in place is open, the others closed.
    assert!(!inputs.is_closed(1, 6));
    assert!(inputs.is_closed(1, 7) && inputs.is_closed(0, 0) && inputs.is_closed(0, 1));
    // TCPS = 0: clamped is open.
    assert!(!inputs.is_closed(0, 7));
}

#[test]
fn the_turret_turns_a_station_in_600_ms() {
    let mut lathe = lathe(&[]);
    let forward = outputs(&[TL_FORWARD]);
    assert_eq!(
        ticks_until(&mut lathe, &forward, |l| l.station() == Some(2)),
        552
    );
    assert_eq!(
        ticks_until(&mut lathe, &forward, |l| l.station() == Some(3)),
        600
    );
    assert_eq!(
        ticks_until(&mut lathe, &forward, |l| l.station() == Some(4)),
        600
    );
    assert_eq!(
        ticks_until(&mut lathe, &forward, |l| l.station() == Some(1)),
        600
    );
    assert!(!lathe.inputs().is_closed(1, 6) && lathe.inputs().is_closed(0, 7));
}

#[test]
fn reverse_seats_and_clamps_in_100_ms() {
    let mut lathe = lathe(&[]);
    ticks_until(&mut lathe, &outputs(&[TL_FORWARD]), |l| {
        l.station() == Some(2)
    });
    assert!(!lathe.is_tool_post_clamped());
    let reverse = outputs(&[TL_REVERSE]);
    assert_eq!(
        ticks_until(&mut lathe, &reverse, SimulatedLathe::is_tool_post_clamped),
        100
    );
    assert_eq!(lathe.station(), Some(2));
    tick(&mut lathe, &MachineOutputs::default());
    assert!(lathe.is_tool_post_clamped() && !lathe.inputs().is_closed(0, 7));
}

#[test]
fn between_stations_reverse_returns_to_the_last_seat() {
    let mut lathe = lathe(&[]);
    for _ in 0..300 {
        tick(&mut lathe, &outputs(&[TL_FORWARD]));
    }
    assert_eq!(lathe.station(), None);
    let taken = ticks_until(
        &mut lathe,
        &outputs(&[TL_REVERSE]),
        SimulatedLathe::is_tool_post_clamped,
    );
    assert_eq!((taken, lathe.station()), (300, Some(1)));
}

#[test]
fn a_blocked_turret_stays_and_a_faulty_clamp_switch_never_closes() {
    let mut lathe = lathe(&[]);
    lathe.set_fault(LatheFault::from_name("turret-blocked").unwrap(), true);
    for _ in 0..2000 {
        tick(&mut lathe, &outputs(&[TL_FORWARD]));
    }
    assert_eq!(lathe.station(), Some(1));
    lathe.set_fault(LatheFault::TurretUnclamped, true);
    for _ in 0..2000 {
        tick(&mut lathe, &outputs(&[TL_REVERSE]));
    }
    assert!(lathe.inputs().is_closed(0, 7));
}

#[test]
fn eight_stations_use_the_shared_pins() {
    // No gear switches (switched spindle), no enables.
    let mut lathe = lathe(&[(84, 8)]);
    ticks_until(&mut lathe, &outputs(&[TL_FORWARD]), |l| {
        l.station() == Some(7)
    });
    let inputs = lathe.inputs();
    assert!(!inputs.is_closed(1, 1));
    assert!(inputs.is_closed(1, 2) && inputs.is_closed(0, 4) && inputs.is_closed(1, 0));
}

#[test]
fn the_spindle_is_within_a_percent_after_500_ms() {
    let mut lathe = lathe(&ANALOG);
    let mut run = outputs(&[M03]);
    run.spindle_volts = 5.0;
    let taken = ticks_until(&mut lathe, &run, |l| l.spindle_rpm() >= 990.0);
    assert!((499..=500).contains(&taken), "{taken}");
    ticks_until(&mut lathe, &run, |l| l.spindle_rpm() == 1000.0);
    let mut reverse = outputs(&[M04]);
    reverse.spindle_volts = 5.0;
    ticks_until(&mut lathe, &reverse, |l| l.spindle_rpm() == -1000.0);
    let brake = outputs(&[SPZD]);
    assert!(ticks_until(&mut lathe, &brake, |l| l.spindle_rpm() > -10.0) <= 101);
}

#[test]
fn the_encoder_counts_four_times_its_lines_and_marks_each_turn() {
    let mut lathe = lathe(&ANALOG);
    let mut run = outputs(&[M03]);
    run.spindle_volts = 3.0;
    ticks_until(&mut lathe, &run, |l| l.spindle_rpm() == 600.0);
    let before = lathe.inputs().encoder;
    let mut marks = 0;
    for _ in 0..1000 {
        let inputs = tick(&mut lathe, &run);
        marks += u32::from(inputs.spindle_index);
        assert_eq!(inputs.encoder_index % 4096, 0);
        assert!((0..4096).contains(&(inputs.encoder - inputs.encoder_index)));
    }
    assert_eq!(marks, 10);
    assert!((lathe.inputs().encoder - before - 40_960).abs() <= 1);
}

#[test]
fn switched_speeds_and_a_coasting_spindle() {
    let mut lathe = lathe(&[]);
    lathe.turn_spindle(300.0);
    tick(&mut lathe, &MachineOutputs::default());
    assert_eq!(lathe.spindle_rpm(), 300.0);
    // M03 with S2.
    ticks_until(&mut lathe, &outputs(&[M03, (0, 0)]), |l| {
        l.spindle_rpm() == 500.0
    });
    ticks_until(&mut lathe, &MachineOutputs::default(), |l| {
        l.spindle_rpm() == 0.0
    });
}

fn tick(lathe: &mut SimulatedLathe, outputs: &MachineOutputs) -> MachineInputs {
    let mut inputs = MachineInputs::default();
    lathe.tick(outputs, &mut inputs);
    lathe.read_contacts(&mut inputs);
    inputs
}

fn drive_to(lathe: &mut SimulatedLathe, x: i64, z: i64) -> MachineInputs {
    let pulses = PerAxis::new(Pulses(x), Pulses(z));
    tick(
        lathe,
        &MachineOutputs {
            pulses,
            enable: PerAxis::new(true, true),
            ..MachineOutputs::default()
        },
    )
}

#[test]
fn the_slides_follow_the_pulses() {
    let mut lathe = lathe(&[]);
    assert_eq!(lathe.slide_position(), Point::new(-50.0, -150.0));
    drive_to(&mut lathe, 2000, -1000);
    assert_eq!(lathe.slide_position(), Point::new(-49.0, -151.0));
    // A reversed motor counts down towards plus.
    let mut reversed = self::lathe(&[(8, 0)]);
    drive_to(&mut reversed, 2000, -1000);
    assert_eq!(reversed.slide_position(), Point::new(-51.0, -149.0));
}

fn with_servo(servo: ServoConfig) -> SimulatedLathe {
    let mut config = LatheConfig::without_limits();
    config.x.servo = Some(servo);
    config.z.servo = Some(servo);
    SimulatedLathe::new(config, &ControlParameters::default())
}

#[test]
fn a_servo_lags_by_speed_over_gain_and_arrives() {
    let mut lathe = with_servo(ServoConfig {
        gain: 25.0,
        ..ServoConfig::default()
    });
    // Z at 60 mm/s, X (0.0005 mm a pulse) at 30 mm/s back: following errors of 2.4 and 1.2
    // mm.
    for tick in 1..=500 {
        drive_to(&mut lathe, -60 * tick, 60 * tick);
    }
    let following_error = lathe.following_error();
    assert!((following_error.z - 2.4).abs() < 1e-3 && (following_error.x + 1.2).abs() < 1e-3);
    assert!((lathe.slide_position().z - (30.0 - 2.4)).abs() < 0.001);
    for _ in 0..1000 {
        drive_to(&mut lathe, -30_000, 30_000);
    }
    assert_eq!(lathe.following_error(), Point::default());
    assert_eq!(lathe.slide_position(), Point::new(-15.0, 30.0));
}

#[test]
fn a_jammed_slide_trips_its_servo_until_the_drive_is_enabled_again() {
    let mut lathe = with_servo(ServoConfig {
        largest_error: 2.0,
        ..ServoConfig::default()
    });
    lathe.set_fault(LatheFault::SlideZ, true);
    assert!(!drive_to(&mut lathe, 0, 2000).drive_alarm.z);
    let inputs = drive_to(&mut lathe, 0, 2001);
    assert!(inputs.drive_alarm.z && !inputs.drive_alarm.x);
    // 005.2 DRDY = 0: a drive that is ready gives 0.
    assert!(inputs.drive_ready.z && !inputs.drive_ready.x);
    lathe.set_fault(LatheFault::SlideZ, false);
    assert!(drive_to(&mut lathe, 0, 2500).drive_alarm.z);
    // Emergency stop: the drive is switched off and drops its following error.
    let off = MachineOutputs {
        pulses: PerAxis::new(Pulses(0), Pulses(2500)),
        ..MachineOutputs::default()
    };
    assert!(!tick(&mut lathe, &off).drive_alarm.z);
    for _ in 0..1000 {
        drive_to(&mut lathe, 0, 3500);
    }
    assert_eq!(lathe.slide_position(), Point::new(0.0, 1.0));
}

#[test]
fn a_jammed_stepper_loses_its_steps() {
    let mut lathe =
        SimulatedLathe::new(LatheConfig::without_limits(), &ControlParameters::default());
    lathe.set_fault(LatheFault::SlideZ, true);
    assert!(!drive_to(&mut lathe, 0, 5000).drive_alarm.z);
    lathe.set_fault(LatheFault::SlideZ, false);
    drive_to(&mut lathe, 0, 6000);
    assert_eq!(lathe.slide_position(), Point::new(0.0, 1.0));
}

#[test]
fn a_stepper_that_meets_the_end_of_its_slide_switches_off() {
    let mut lathe = lathe(&[]);
    // Z from -150: the limit switch at +5, the end at +15.
    let inputs = drive_to(&mut lathe, 0, 165_000);
    assert!(!inputs.drive_alarm.z && inputs.over_limit.z == Some(TrippedLimit::Plus));
    let inputs = drive_to(&mut lathe, 0, 165_001);
    assert!(inputs.drive_alarm.z && !inputs.drive_alarm.x);
    drive_to(&mut lathe, 0, 200_000);
    assert_eq!(lathe.slide_position(), Point::new(-50.0, 15.0));
    // After the drive was switched off and on the slide moves back.
    tick(
        &mut lathe,
        &MachineOutputs {
            pulses: PerAxis::new(Pulses(0), Pulses(200_000)),
            ..MachineOutputs::default()
        },
    );
    assert!(!drive_to(&mut lathe, 0, 199_000).drive_alarm.z);
    assert_eq!(lathe.slide_position(), Point::new(-50.0, 14.0));
}

#[test]
fn a_servo_at_the_end_of_its_slide_lags_until_it_trips() {
    let mut config = LatheConfig::default();
    config.x.servo = Some(ServoConfig::default());
    config.x.backlash = 0.1;
    let mut lathe = SimulatedLathe::new(config, &ControlParameters::default());
    // X from -100, a pulse of 0.0005 mm: the end at -330 is 230 000 pulses away.
    let inputs = (1..=2400).map(|tick| drive_to(&mut lathe, -100 * tick, 0));
    let tripped = inputs.take_while(|inputs| !inputs.drive_alarm.x).count();
    // The motor takes up the play; its following error is then 10 mm on the diameter.
    assert!((2300..=2402).contains(&tripped), "{tripped}");
    assert_eq!(lathe.slide_position().x, -165.0);
}

#[test]
fn a_slide_beyond_its_end_moves_back_only() {
    let mut lathe = lathe(&[]);
    lathe.move_slides(Point::new(-50.0, 40.0));
    assert!(!drive_to(&mut lathe, 0, -1000).drive_alarm.z);
    assert_eq!(lathe.slide_position().z, 39.0);
    assert!(drive_to(&mut lathe, 0, -500).drive_alarm.z);
    assert_eq!(lathe.slide_position().z, 39.0);
}

#[test]
fn the_screw_has_its_play() {
    let mut config = LatheConfig::without_limits();
    config.z.backlash = 0.05;
    let mut lathe = SimulatedLathe::new(config, &ControlParameters::default());
    let mut move_to = |pulses| {
        drive_to(&mut lathe, 0, pulses);
        (lathe.slide_position().z * 1000.0).round()
    };
    assert_eq!(move_to(100), 100.0);
    assert_eq!(move_to(60), 100.0);
    assert_eq!(move_to(40), 90.0);
    assert_eq!(move_to(80), 90.0);
    assert_eq!(move_to(95), 95.0);
}

#[test]
fn dogs_index_pulse_and_limit_switches() {
    let mut lathe = lathe(&[]);
    // Z from -150: dog from -30 to -5, motor turn 10 mm, limit at +5.
    let dog = |inputs: &MachineInputs| !inputs.is_closed(1, 3);
    assert!(!dog(&drive_to(&mut lathe, 0, 119_999)));
    assert!(dog(&drive_to(&mut lathe, 0, 120_000)));
    assert!(dog(&drive_to(&mut lathe, 0, 145_000)));
    assert!(!dog(&drive_to(&mut lathe, 0, 145_001)));
    assert!(!drive_to(&mut lathe, 0, 149_999).index_pulse.z);
    assert!(drive_to(&mut lathe, 0, 150_000).index_pulse.z);
    assert!(drive_to(&mut lathe, 0, 155_000).is_closed(0, 5));
    assert!(!drive_to(&mut lathe, 0, 155_001).is_closed(0, 5));
    lathe.set_overtravel_release(true);
    assert!(lathe.inputs().is_closed(0, 5));
    lathe.set_emergency_button(true);
    assert!(!lathe.inputs().is_closed(0, 5));
}

#[test]
fn the_zero_signal_latches_the_count_of_its_first_change() {
    let mut lathe = lathe(&[]);
    // Z from -150, one turn 10 mm, the signal is on for a fiftieth: 0.2 mm.
    let mut latch = |z| {
        drive_to(&mut lathe, 0, z)
            .index_latch
            .z
            .map(|count| count.0)
    };
    assert_eq!(latch(9_990), Some(200));
    assert_eq!(latch(9_995), None);
    assert_eq!(latch(10_004), Some(10_000));
    assert_eq!(latch(10_150), None);
    assert_eq!(latch(10_230), Some(10_200));
    // In the negative direction, the first position with the other level is below the edge.
    assert_eq!(latch(10_190), Some(10_199));
    assert_eq!(latch(9_990), Some(9_999));
    // More than one change in a tick: the first counts.
    assert_eq!(latch(20_300), Some(10_000));
}

#[test]
fn one_switch_latches_at_its_ends() {
    let mut lathe = lathe(&[(7, 1 << 1)]);
    // Z from -150, dog from -30 to -5.
    let mut latch = |z| {
        drive_to(&mut lathe, 0, z)
            .index_latch
            .z
            .map(|count| count.0)
    };
    assert_eq!(latch(119_990), None);
    assert_eq!(latch(120_010), Some(120_000));
    assert_eq!(latch(145_004), Some(145_001));
    assert_eq!(latch(144_990), Some(145_000));
    assert_eq!(latch(119_990), Some(119_999));
}

#[test]
fn a_lathe_without_limits_has_neither_dogs_nor_limit_switches() {
    let mut lathe =
        SimulatedLathe::new(LatheConfig::without_limits(), &ControlParameters::default());
    for count in [-9_999_000, -20_000, 9_999_000] {
        let inputs = drive_to(&mut lathe, count, count);
        assert!(inputs.is_closed(0, 5) && inputs.is_closed(0, 3) && inputs.is_closed(1, 3));
    }
}

#[test]
fn inputs_can_be_forced_and_freed() {
    let mut lathe = lathe(&[]);
    lathe.force_input(address("X0.5"), Some(false));
    lathe.force_input(address("X2.3"), Some(true));
    let inputs = tick(&mut lathe, &MachineOutputs::default());
    assert!(!inputs.is_closed(0, 5) && inputs.is_closed(2, 3));
    lathe.force_input(address("X0.5"), None);
    lathe.force_input(address("Y0.0"), Some(true));
    assert!(lathe.inputs().is_closed(0, 5) && lathe.inputs().is_closed(2, 3));
}

#[test]
fn chuck_and_gears_answer_after_half_a_second() {
    // Chuck with in-position switches: SLQP, PB2.
    let mut lathe = lathe(&[(164, 0b1110_0101), (168, 0b0000_0100)]);
    let clamp = outputs(&[(0, 6)]);
    assert_eq!(
        ticks_until(&mut lathe, &clamp, SimulatedLathe::is_chuck_clamped),
        500
    );
    assert!(lathe.inputs().is_closed(1, 2) && !lathe.inputs().is_closed(1, 1));
    // Analog spindle with gears, AGIM = 1: in position is open.
    let mut lathe = self::lathe(&[(1, 0b0001_0000)]);
    assert!(!lathe.inputs().is_closed(1, 1) && lathe.inputs().is_closed(1, 2));
    let second = outputs(&[(0, 0)]);
    let in_position = |l: &SimulatedLathe| !l.inputs().is_closed(1, 2);
    assert!((500..=501).contains(&ticks_until(&mut lathe, &second, in_position)));
    assert_eq!(lathe.gear(), 2);
}

#[test]
fn door_and_pressure_by_their_parameters() {
    // PB4 and PB3, both closed when well.
    let mut lathe = lathe(&[(168, 0b1111_0000)]);
    assert!(lathe.inputs().is_closed(1, 5) && lathe.inputs().is_closed(0, 7));
    lathe.set_fault(LatheFault::DoorOpen, true);
    lathe.set_fault(LatheFault::PressureLow, true);
    assert!(!lathe.inputs().is_closed(1, 5) && !lathe.inputs().is_closed(0, 7));
}

#[test]
fn a_machine_file_needs_only_the_differing_fields() {
    let text = "(name: \"small\", turret: (stations: Some(6)), z: (start: -20.0, dog: None))";
    let config: LatheConfig = ron::from_str(text).unwrap();
    assert_eq!(
        (config.turret.stations, config.turret.station_ms),
        (Some(6), 600)
    );
    assert_eq!((config.z.start, config.z.dog), (-20.0, None));
    assert_eq!(config.x, LatheConfig::default().x);
    assert!(ron::from_str::<LatheConfig>("(stations: 4)").is_err());
}

#[test]
fn every_fault_can_be_set_and_cleared() {
    let mut lathe = lathe(&[]);
    for (name, fault) in LatheFault::ALL {
        assert!(!lathe.has_fault(fault), "{name}");
        lathe.set_fault(fault, true);
        let found: Vec<&str> = LatheFault::ALL
            .iter()
            .filter(|(_, fault)| lathe.has_fault(*fault))
            .map(|(name, _)| *name)
            .collect();
        assert_eq!(found, [name]);
        lathe.set_fault(fault, false);
    }
}

#[test]
fn a_forced_input_reports_its_level() {
    let mut lathe = lathe(&[]);
    let address = "X0.5".parse().unwrap();
    assert_eq!(lathe.forced_input(address), None);
    for state in [Some(false), Some(true), None] {
        lathe.force_input(address, state);
        assert_eq!(lathe.forced_input(address), state);
        assert_eq!(lathe.forced_input("X0.4".parse().unwrap()), None);
        assert_eq!(lathe.forced_input("Y0.5".parse().unwrap()), None);
    }
}
