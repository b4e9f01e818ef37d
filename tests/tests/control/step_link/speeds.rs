//! Spindle and coolant that switch while the slides move.

use gsk_core::command::MotionCode;
use gsk_core::operation::RunState;

use super::bench::config;
use super::lathe::referenced_lathe;
use super::machine::StepMachine;

const BUSHING: &str = include_str!("../../../../assets/programs/02-bushing.CNC");

/// With an analog spindle.
fn analog(pwm: bool) -> StepMachine {
    let mut config = config();
    if !pwm {
        config.io.spindle_pwm = String::new();
    }
    let mut machine = StepMachine::with_config(config, &[(1, 4, true)]);
    machine.return_axes();
    machine
}

/// Runs to the end and calls `look` every millisecond.
fn run_watched(machine: &mut StepMachine, mut look: impl FnMut(&StepMachine)) {
    for _ in 0..3_600_000 {
        machine.run_one_ms();
        look(machine);
        let cnc = &machine.simulation.cnc;
        if !machine.linked.has_pending_motion()
            && !cnc.is_moving()
            && cnc.run_state() != RunState::Run
        {
            return;
        }
    }
    panic!("it does not end");
}

#[test]
fn the_speed_follows_the_slide_and_not_the_kernel() {
    let mut machine = analog(true);
    let kernel = machine.simulation.cnc.pulses();
    let offset = machine.twin.pulses()[0] - kernel.x.0;
    machine.start_program(
        "O1\nG50 X120 Z20\nG50 S3000\nG96 S120 M03\nG98 G00 X64 Z2\nG04 X1\nG01 X20 F1200\nM30\n",
    );
    machine.run_until(30_000, |machine| machine.simulation.cnc.cursor().line == 7);
    let begun = machine.twin.statistics().output_command_count;
    let since = machine.twin.now();
    let (mut seen, mut worst) = (0, 0.0_f64);
    run_watched(&mut machine, |machine| {
        let cnc = &machine.simulation.cnc;
        let here = cnc.position_machine().x;
        let per_mm = 400.0;
        let made = (machine.twin.pulses()[0] - offset) as f64;
        let at = here + (made - cnc.pulses().x.0 as f64) / per_mm;
        let diameter = 2.0 * (at - cnc.frame().zero.x);
        if (22.0..60.0).contains(&diameter) && cnc.modal().motion == MotionCode::Line {
            let rpm = 1000.0 * 120.0 / (core::f64::consts::PI * diameter);
            let duty = f64::from(machine.twin.output("PH6").unwrap());
            worst = worst.max((rpm / 9999.0 * 255.0 - duty).abs());
            seen += 1;
        }
    });
    assert!(seen > 500, "{seen}");
    // A step of the output, and the change of the speed in 20 ms.
    assert!(worst < 2.5, "{worst}");
    // 50 a second, and the enable of the drives every 100 ms.
    let seconds = (machine.twin.now() - since) as f64 * 1e-9;
    let orders = (machine.twin.statistics().output_command_count - begun) as f64;
    assert!(orders < 61.0 * seconds + 10.0, "{orders} in {seconds} s");
}

/// M08 in the middle of the path: the kernel does not wait for the slides, and the coolant
/// does not switch before they are there.
#[test]
fn coolant_switches_at_its_position_without_waiting_for_the_slides() {
    let mut machine = analog(true);
    let start_at = machine.twin.pulses()[1];
    machine.start_program("O1\nG98 G01 W-10 F600\nM08\nG01 W-10\nM09\nG01 W-10\nM30\n");
    let (mut on, mut off, mut waits) = (None, None, [0, 0]);
    run_watched(&mut machine, |machine| {
        let z = machine.twin.pulses()[1];
        // Inverted.
        let flows = machine.twin.output("PB7") == Some(0);
        if flows && on.is_none() {
            on = Some(z - start_at);
        }
        if !flows && on.is_some() && off.is_none() {
            off = Some(z - start_at);
        }
        let cnc = &machine.simulation.cnc;
        if !cnc.is_moving() && matches!(cnc.cursor().line, 3 | 5) {
            waits[usize::from(cnc.cursor().line == 5)] += 1;
        }
    });
    assert_eq!(machine.alarms(), Vec::<String>::new());
    // At the ends of the cuts, 10 mm of 200 pulses.
    assert_eq!((on, off), (Some(-2000), Some(-4000)));
    // As long as the ladder takes for an M (081 = 500 ms); waiting for the slides would take
    // 200 ms more.
    assert!(waits.iter().all(|wait| *wait < 600), "{waits:?}");
}

#[test]
fn without_the_output_the_setting_is_named() {
    let mut machine = analog(false);
    let stood = machine.twin.pulses();
    machine.start_program("O1\nG96 S100 M03\nG98 G01 W-5 F100\nM30\n");
    machine.run_ms(500);
    let alarms = machine.alarms();
    assert!(
        alarms[0].contains("604") && alarms[0].contains("io.spindle_pwm"),
        "{alarms:?}"
    );
    assert_eq!(machine.twin.pulses(), stood);
}

/// The unchanged sample: feed per revolution follows the index of the real spindle.
#[test]
fn the_unchanged_bushing_ends_on_the_pulse_of_the_kernel() {
    let mut lathe = referenced_lathe(true, &[]);
    lathe.start_program(BUSHING);
    let mut duties = std::collections::BTreeSet::new();
    for _ in 0..3_600_000 {
        lathe.run_one_ms();
        duties.extend(lathe.twin.output("PH6"));
        let cnc = &lathe.simulation.cnc;
        if !lathe.linked.has_pending_motion()
            && !cnc.is_moving()
            && cnc.run_state() != RunState::Run
        {
            break;
        }
    }
    assert_eq!(lathe.alarms(), Vec::<String>::new());
    assert_eq!(lathe.simulation.cnc.run_state(), RunState::Reset);
    lathe.assert_agrees();
    // From 120 m/min at 64 mm to 2000 r/min, which is 10 V.
    assert!(duties.contains(&0) && duties.contains(&255) && duties.len() > 20);
    assert_eq!(lathe.twin.output("PB4"), Some(0), "M05");
}
