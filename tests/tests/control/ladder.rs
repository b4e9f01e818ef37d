//! Ladder and motion: the slots of the ladder never delay the interpolation, and a loaded
//! ladder runs from the next power-on.

use std::sync::Arc;

use gsk_core::cnc::{ControlRequest, LadderStep};
use gsk_core::operation::{RunState, SoftSwitch};
use gsk_core::plc::Ladder;
use gsk_core::plc::address::BitAddress;
use gsk_core::program::Program;
use gsk_core::setup::{STANDARD_LADDER, Setup};
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;

const PROGRAM: &str =
    "G98\nG00 X40 Z2\nG01 X40 Z-30 F3000\nG02 X60 Z-40 R10 F2000\nG00 X100 Z50\nM30\n";

fn compile_ladder(source: &str) -> Arc<Ladder> {
    Arc::new(Ladder::compile(source).unwrap())
}

fn parse_bit(text: &str) -> BitAddress {
    text.parse().unwrap()
}

/// The path of the program, tick by tick from the start signal on.
fn run_path(ladder: Arc<Ladder>) -> Vec<Point> {
    let mut simulation = Simulation::new(Setup {
        ladder: ladder.into(),
        ..Setup::default()
    });
    let open = ControlRequest::OpenExternal(Program::new(PROGRAM));
    simulation.cnc.request(open).unwrap();
    simulation.start_automatic();
    let mut path = Vec::new();
    for _ in 0..20_000 {
        simulation.tick();
        if simulation.cnc.run_state() == RunState::Run {
            path.push(simulation.cnc.position_machine());
        }
    }
    assert_eq!(simulation.cnc.run_state(), RunState::Reset);
    // The path before the key is released is the same for all.
    path
}

#[test]
fn the_division_of_level_2_never_shifts_the_path() {
    let divided = run_path(compile_ladder(STANDARD_LADDER));
    let undivided = run_path(compile_ladder(&format!(".OPT n1\n{STANDARD_LADDER}")));
    // The start may differ by some slots. From then on every tick is the same.
    let start_index = |path: &[Point]| path.iter().position(|at| *at != path[0]).unwrap();
    let (a, b) = (
        &divided[start_index(&divided)..],
        &undivided[start_index(&undivided)..],
    );
    let same = a.len().min(b.len()).min(1000);
    assert!(same > 500, "{same}");
    assert_eq!(a[..same], b[..same]);
}

/// DM01 and DM02 of M codes that the machine's ladder defines: 1 once the motion of their
/// block has ended, 0 with FIN, and never when FIN comes first. They are also sent under the
/// auxiliary lock (manual PLC-II 8.1, 8.2).
#[test]
fn m01_and_m02_of_the_ladder_have_their_decode_signals() {
    let named = format!(".MCODE 1 \"one\"\n.MCODE 2 \"two\"\n{STANDARD_LADDER}");
    // 080 is 500 ms: M01 waits for its motion, M02 is answered in the middle of it.
    let text = "G98\nG01 W-1 F600 M01\nG04 X0.2\nG01 W-20 F600 M02\nM30\n";
    for lock in [false, true] {
        let mut simulation = Simulation::new(Setup {
            ladder: compile_ladder(&named).into(),
            ..Setup::default()
        });
        simulation
            .cnc
            .request(ControlRequest::OpenExternal(Program::new(text)))
            .unwrap();
        for _ in 0..100 {
            simulation.tick();
        }
        if lock {
            let force = ControlRequest::ForceBit(parse_bit("G5.6"), Some(true));
            simulation.cnc.request(force).unwrap();
        }
        simulation.start_automatic();
        let (mut decoded, mut codes, mut begun) = ([false; 2], Vec::new(), false);
        for _ in 0..6000 {
            simulation.tick();
            let memory = simulation.cnc.plc().memory();
            for (seen, address) in decoded.iter_mut().zip(["F9.6", "F9.5"]) {
                if memory.bit(parse_bit(address)) {
                    *seen = true;
                    assert!(!memory.bit(parse_bit("F102.1")), "{address} in motion");
                    assert!(memory.bit(parse_bit("F1.3")), "{address} without F1.3");
                }
            }
            let code = memory.f(10);
            if memory.bit(parse_bit("F7.0")) && codes.last() != Some(&code) {
                codes.push(code);
            }
            begun |= simulation.cnc.run_state() == RunState::Run;
        }
        assert!(begun && simulation.cnc.run_state() == RunState::Reset);
        assert_eq!(codes, [1, 2, 30], "lock: {lock}");
        assert_eq!(decoded, [true, false], "lock: {lock}");
    }
}

#[test]
fn a_loaded_ladder_runs_from_the_next_power_on() {
    let mut simulation = Simulation::new(Setup::default());
    let other = compile_ladder("END1\nLDI R0.0\nOUT Y2.5\nEND2");
    let load = ControlRequest::LoadLadder(Arc::clone(&other));
    simulation.cnc.request(load.clone()).unwrap();
    assert_eq!(simulation.cnc.next_ladder(), None, "not in MDI mode");
    let edit_key = parse_bit("X20.0");
    for down in [true, false] {
        simulation.cnc.set_panel_key(edit_key, down);
        run_ticks(&mut simulation, 100);
    }
    simulation.cnc.request(load.clone()).unwrap();
    assert_eq!(simulation.cnc.next_ladder(), None, "the switch is off");
    let switch = ControlRequest::SetParameterSwitch(true);
    simulation.cnc.request(switch).unwrap();
    simulation.cnc.request(load).unwrap();
    for _ in 0..100 {
        simulation.tick();
    }
    assert!(!simulation.cnc.plc().memory().bit(parse_bit("Y2.5")));
    assert_eq!(simulation.cnc.next_ladder(), Some(&other));
    simulation.power_cycle();
    assert_eq!(simulation.cnc.next_ladder(), None);
    for _ in 0..100 {
        simulation.tick();
    }
    assert!(simulation.cnc.plc().memory().bit(parse_bit("Y2.5")));
}

#[test]
fn a_halted_ladder_continues_in_steps() {
    let mut simulation = Simulation::new(Setup::default());
    for _ in 0..100 {
        simulation.tick();
    }
    simulation
        .cnc
        .request(ControlRequest::HaltLadder(true))
        .unwrap();
    simulation.cnc.set_panel_key(parse_bit("X24.7"), true);
    for _ in 0..100 {
        simulation.tick();
    }
    let hold = |simulation: &Simulation| !simulation.cnc.plc().memory().bit(parse_bit("G8.5"));
    assert!(!hold(&simulation), "the ladder stands");
    assert!(simulation.cnc.is_ladder_halted());
    let step = |simulation: &mut Simulation, step| {
        simulation
            .cnc
            .request(ControlRequest::StepLadder(step))
            .unwrap();
    };
    assert_eq!(simulation.cnc.plc().next_rung(), Some(1));
    step(&mut simulation, LadderStep::Rung);
    assert_eq!(simulation.cnc.plc().next_rung(), Some(2));
    assert!(!hold(&simulation));
    step(&mut simulation, LadderStep::Rung);
    assert!(hold(&simulation), "F02 is the second rung");
    assert!(simulation.cnc.is_in_feed_hold());
    step(&mut simulation, LadderStep::Slot);
    assert_eq!(simulation.cnc.plc().next_rung(), Some(1));
    simulation
        .cnc
        .request(ControlRequest::HaltLadder(false))
        .unwrap();
    simulation.cnc.set_panel_key(parse_bit("X24.7"), false);
    for _ in 0..100 {
        simulation.tick();
    }
    assert!(!hold(&simulation));
}

#[test]
fn a_forced_bit_and_a_soft_switch_reach_the_control() {
    let mut simulation = Simulation::new(Setup::default());
    let ticks = |simulation: &mut Simulation| {
        for _ in 0..100 {
            simulation.tick();
        }
    };
    let force = ControlRequest::ForceBit(parse_bit("G46.7"), Some(true));
    simulation.cnc.request(force).unwrap();
    ticks(&mut simulation);
    assert!(
        simulation.cnc.plc().memory().bit(parse_bit("F2.7")),
        "dry run"
    );
    let free = ControlRequest::ForceBit(parse_bit("G46.7"), None);
    simulation.cnc.request(free).unwrap();
    ticks(&mut simulation);
    assert!(!simulation.cnc.plc().memory().bit(parse_bit("F2.7")));
    for switch in SoftSwitch::ALL {
        let on = ControlRequest::SetSoftSwitch(switch, true);
        simulation.cnc.request(on).unwrap();
        assert!(simulation.cnc.is_soft_switch_on(switch));
    }
    ticks(&mut simulation);
    let memory = simulation.cnc.plc().memory();
    assert_eq!(memory.f(75), 0b11_1110);
    for signal in ["F4.1", "F4.4", "F4.3", "F2.7", "F4.0"] {
        assert!(memory.bit(parse_bit(signal)), "{signal}");
    }
}

/// A program that moves Z slowly in the negative direction, one second after its start.
fn with_moving_z(changes: &[(u16, u8)]) -> Simulation {
    let mut setup = Setup::default();
    for (number, bit) in changes {
        setup
            .memory
            .parameters
            .set_bit(*number, *bit, true)
            .unwrap();
    }
    let mut simulation = Simulation::new(setup);
    let program = Program::new("G98\nG01 W-600 F600\nM30\n");
    simulation
        .cnc
        .request(ControlRequest::OpenExternal(program))
        .unwrap();
    simulation.start_automatic();
    run_ticks(&mut simulation, 1000);
    simulation
}

fn run_ticks(simulation: &mut Simulation, ticks: u32) {
    for _ in 0..ticks {
        simulation.tick();
    }
}

fn force_bit(simulation: &mut Simulation, address: &str, value: Option<bool>) {
    let request = ControlRequest::ForceBit(parse_bit(address), value);
    simulation.cnc.request(request).unwrap();
    run_ticks(simulation, 1000);
}

fn is_advancing(simulation: &mut Simulation) -> bool {
    let before = simulation.cnc.position_machine();
    run_ticks(simulation, 100);
    simulation.cnc.position_machine() != before
}

#[test]
fn interlocks_hold_a_run_that_then_continues() {
    let mut simulation = with_moving_z(&[]);
    assert!(is_advancing(&mut simulation));
    // Signal, its value, and whether a motion of Z in its negative direction waits.
    let table = [
        ("G7.1", true, true),
        ("G8.0", false, true),
        ("G130.1", true, true),
        ("G130.0", true, false),
        ("G134.1", true, true),
        ("G132.1", true, false),
        ("G134.0", true, false),
    ];
    for (signal, value, waits) in table {
        force_bit(&mut simulation, signal, Some(value));
        assert_eq!(is_advancing(&mut simulation), !waits, "{signal}");
        assert_eq!(simulation.cnc.run_state(), RunState::Run, "{signal}");
        force_bit(&mut simulation, signal, None);
        // The standard ladder does not write the interlocks of single axes.
        if !matches!(signal, "G8.0") {
            force_bit(&mut simulation, signal, Some(!value));
            force_bit(&mut simulation, signal, None);
        }
        assert!(is_advancing(&mut simulation), "after {signal}");
    }
    assert!(simulation.cnc.alarms().is_empty());
}

#[test]
fn a_limit_signal_stops_motion_towards_it_with_its_alarm() {
    let mut simulation = with_moving_z(&[]);
    // The other side and the other axis have no effect.
    for signal in ["G114.1", "G116.0"] {
        force_bit(&mut simulation, signal, Some(false));
        assert!(is_advancing(&mut simulation), "{signal}");
        force_bit(&mut simulation, signal, None);
    }
    force_bit(&mut simulation, "G116.1", Some(false));
    let numbers: Vec<u16> = simulation.cnc.alarms().iter().map(|a| a.number).collect();
    assert_eq!(numbers, [204]);
    assert!(!is_advancing(&mut simulation));
    assert_eq!(simulation.cnc.run_state(), RunState::Stop);
}

#[test]
fn a_cut_waits_for_the_speed_arrival_signal() {
    let mut simulation = with_moving_z(&[]);
    assert!(is_advancing(&mut simulation), "175.6 = 0: not looked at");
    let mut setup = Setup::default();
    setup.memory.parameters.set_bit(175, 6, true).unwrap();
    setup.memory.parameters.set(72, 500).unwrap();
    let mut simulation = Simulation::new(setup);
    let program = Program::new("G98\nG00 W-10\nG01 W-10 F600\nG01 W-10\nM30\n");
    simulation
        .cnc
        .request(ControlRequest::OpenExternal(program))
        .unwrap();
    let hold = ControlRequest::ForceBit(parse_bit("G29.4"), Some(false));
    simulation.cnc.request(hold).unwrap();
    simulation.start_automatic();
    run_ticks(&mut simulation, 5000);
    let z = simulation.cnc.position_machine().z;
    assert!(
        (z - 290.0).abs() < 1e-9,
        "the rapid is over, the cut waits: {z}"
    );
    force_bit(&mut simulation, "G29.4", None);
    run_ticks(&mut simulation, 5000);
    let z = simulation.cnc.position_machine().z;
    assert!(
        (z - 270.0).abs() < 1e-9,
        "both cuts, the second unchecked: {z}"
    );
}

#[test]
fn one_percent_rapid_and_the_override_table() {
    use gsk_core::operation::FromPlc;
    use gsk_core::plc::PlcMemory;
    let decoded = |writes: &[(u16, u8)]| {
        let mut memory = PlcMemory::new();
        for (byte, value) in writes {
            memory.set_g(*byte, *value);
        }
        FromPlc::read(&memory)
    };
    // G96: HROV and the inverted seven bits; values above 100 % count as 100.
    assert_eq!(decoded(&[(96, 0b1111_1110), (14, 3)]).rapid_override, 1);
    assert_eq!(decoded(&[(96, 0b1000_0000)]).rapid_override, 100);
    assert_eq!(decoded(&[(96, 0b1111_1111)]).rapid_override, 0);
    for (code, percent) in [(0, 100), (2, 50), (1, 25), (3, 0)] {
        assert_eq!(decoded(&[(14, code)]).rapid_override, percent);
    }
    for (code, percent) in [(15, 0), (10, 50), (5, 100), (4, 110), (0, 150)] {
        assert_eq!(decoded(&[(12, code)]).feed_override, percent);
    }
    let spindle = [
        (7, 50),
        (6, 60),
        (2, 70),
        (3, 80),
        (1, 90),
        (0, 100),
        (4, 110),
        (5, 120),
    ];
    for (code, percent) in spindle {
        assert_eq!(decoded(&[(30, code)]).spindle_override, percent);
    }
    assert_eq!(
        decoded(&[(10, 5), (11, 1)]).jog_code,
        15,
        "G11 is 0 in the table"
    );
    assert_eq!(decoded(&[(201, 3)]).current_tool, 3);
    assert_eq!(decoded(&[(202, 1)]).current_tool, 255, "no such tool");
}

#[test]
fn key1_protects_the_programs() {
    let mut simulation = Simulation::new(Setup::default());
    let store = |simulation: &mut Simulation| {
        let request = ControlRequest::StoreProgram("O0007\nM30\n".to_owned());
        simulation.cnc.request(request).unwrap();
        simulation.cnc.programs().iter().count()
    };
    force_bit(&mut simulation, "G46.3", Some(true));
    assert!(simulation.cnc.is_memory_protected());
    assert_eq!(store(&mut simulation), 0);
    force_bit(&mut simulation, "G46.3", None);
    force_bit(&mut simulation, "G46.3", Some(false));
    assert_eq!(store(&mut simulation), 1);
}
