//! Macros in the whole control: their pace, the signals of the ladder, memory.

use crate::bench::program::started;
use crate::bench::{press, run_ticks};
use gsk_core::alarm::Alarm;
use gsk_core::cnc::ControlRequest;
use gsk_core::memory::Variables;
use gsk_core::operation::{OperatingMode, RunState};
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::preview::{PreviewEnd, preview};
use gsk_core::program::{Program, ProgramMemory};
use gsk_core::setup::Setup;
use gsk_core::simulation::{RunUntilResult, Simulation, StopCondition};

fn run_preview(text: &str) -> (PreviewEnd, f64) {
    let setup = Setup::default();
    let mut programs = ProgramMemory::default();
    programs.open_external(Program::new(text));
    programs.select(gsk_core::command::ProgramId::External);
    let preview = preview(&setup, &programs, &mut |_| {});
    (preview.end, preview.time_s)
}

#[test]
fn an_operation_takes_a_millisecond() {
    let text = "G65 H01 P#200 Q0;\nN1 G65 H02 P#200 Q#200 R1;\nG65 H84 P1 Q#200 R1000;\nM30;";
    let mut simulation = started(Setup::default(), text);
    let value = |simulation: &Simulation| simulation.cnc.variables().get(200).unwrap_or(0);
    let first = value(&simulation);
    run_ticks(&mut simulation, 500);
    assert_eq!(value(&simulation) - first, 250);
    assert_eq!(
        simulation.run_until(StopCondition::Stopped, 10_000),
        RunUntilResult::Reached
    );
    assert_eq!(value(&simulation), 1000);
    let (end, seconds) = run_preview(text);
    assert_eq!(end, PreviewEnd::M30);
    assert!((2.0..2.6).contains(&seconds), "{seconds}");
}

#[test]
fn an_endless_loop_keeps_running_and_the_preview_gives_up() {
    for text in [
        "N1 G65 H80 P1;",
        "N1 G65 H81 P1 Q#1004 R#1004;",
        "N1;\nN2;\nG65 H80 P-2;",
    ] {
        let mut simulation = started(Setup::default(), text);
        run_ticks(&mut simulation, 1000);
        assert_eq!(simulation.cnc.run_state(), RunState::Run);
    }
    assert_eq!(run_preview("N1 G65 H80 P1;").0, PreviewEnd::Limit);
}

#[test]
fn inputs_and_outputs_are_those_of_the_ladder() {
    let mut simulation = started(
        Setup::default(),
        "G01 U1 F60;\nG65 H01 P#1104 Q1;\nG65 H01 P#1133 Q66051;\nN5 G65 H81 P5 Q#1003 R1;\nG65 H01 P#1104 Q0;\nG65 H01 P#200 Q77;\nM30;",
    );
    let output = |simulation: &Simulation| simulation.cnc.plc().memory().f(54);
    // Nothing is switched before the motion has ended.
    assert!(simulation.cnc.is_moving());
    assert_eq!(output(&simulation), 0);
    simulation
        .lathe
        .force_input(BitAddress::new(Area::X, 0, 1), Some(true));
    run_ticks(&mut simulation, 1500);
    assert!(!simulation.cnc.is_moving());
    assert_eq!(output(&simulation), 1 << 4);
    let more: Vec<u8> = (56..60)
        .map(|byte| simulation.cnc.plc().memory().f(byte))
        .collect();
    assert_eq!(more, [3, 2, 1, 0]);
    // #1003 is T04, X0.1 of the standard ladder.
    let contact = BitAddress::new(Area::X, 0, 1);
    simulation.lathe.force_input(contact, Some(true));
    run_ticks(&mut simulation, 200);
    assert_eq!(output(&simulation), 1 << 4);
    simulation.lathe.force_input(contact, Some(false));
    run_ticks(&mut simulation, 200);
    assert_eq!(output(&simulation), 0);
    assert_eq!(simulation.cnc.variables().get(200), Some(77));
}

#[test]
fn variables_survive_power_off_and_are_keyed_in_by_hand() {
    let mut simulation = started(Setup::default(), "G65 H01 P#231 Q-5;\nM30;");
    assert_eq!(
        simulation.run_until(StopCondition::Stopped, 10_000),
        RunUntilResult::Reached
    );
    simulation.power_cycle();
    assert_eq!(simulation.cnc.variables().get(231), Some(-5));
    run_ticks(&mut simulation, 100);
    press(&mut simulation, BitAddress::new(Area::X, 20, 2));
    assert_eq!(simulation.cnc.mode(), OperatingMode::Mdi);
    let mut set = |number, value| {
        simulation
            .cnc
            .request(ControlRequest::SetVariable { number, value })
    };
    assert_eq!(set(500, Variables::GREATEST), Ok(()));
    let number = |result: Result<(), Alarm>| result.unwrap_err().number;
    assert_eq!(number(set(232, 1)), 115);
    assert_eq!(number(set(200, Variables::GREATEST + 1)), 111);
}

#[test]
fn a_locked_return_lights_no_lamp() {
    for (locked, lamps) in [(true, 0), (false, 0b11)] {
        let mut simulation = Simulation::new(Setup::default());
        run_ticks(&mut simulation, 100);
        if locked {
            press(&mut simulation, BitAddress::new(Area::X, 21, 0));
        }
        let program = Program::new("G28 U0 W0;\nG04 P300;\nM30;");
        simulation
            .cnc
            .request(ControlRequest::OpenExternal(program))
            .unwrap();
        simulation.start_automatic();
        simulation.run_until(StopCondition::Stopped, 60_000);
        assert_eq!(simulation.cnc.plc().memory().f(94), lamps);
        assert_eq!(simulation.cnc.position_absolute().z, 0.0);
    }
}

#[test]
fn user_alarms_come_in_their_turn() {
    let mut simulation = started(Setup::default(), "G01 U10 F60;\nG65 H99 P15;");
    assert!(simulation.cnc.alarms().is_empty() && simulation.cnc.is_moving());
    simulation.run_until(StopCondition::Stopped, 60_000);
    let alarm = &simulation.cnc.alarms()[0];
    assert_eq!(
        (alarm.number, alarm.line_text()),
        (515, "P/S 515".to_owned())
    );
    let at = simulation.cnc.position_absolute().diameter().0;
    assert!((at - 310.0).abs() < 1e-9, "{at}");
}
