//! What a thread requires of the spindle: alarms 091, 092, 094 and 098.

use gsk_core::cnc::ControlRequest;
use gsk_core::machine::LatheFault;
use gsk_core::operation::RunState;
use gsk_core::preview::preview;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;

use super::run::{G32, ThreadRun};

#[test]
fn threads_need_a_turning_spindle_and_a_usable_encoder() {
    let text = "O0001\nG00 X40 Z5\nG32 Z-20 F2\nM30\n";
    let alarm = |text: &str, changes: &[(u16, i32)]| {
        let mut run = ThreadRun::started(text, changes);
        run.finish();
        let alarms = run.simulation.cnc.alarms();
        (alarms[0].number, alarms[0].source.unwrap().line, run.z())
    };
    assert_eq!(alarm(text, &[]), (94, 3, 5.0));
    let turning = text.replace("G00", "M03 S500\nG04 X1\nG00");
    assert_eq!(alarm(&turning, &[(70, 50)]), (92, 5, 5.0));
    // 20 mm at 500 r/min are 10 m/min, more than 023.
    let fast = turning.replace("F2", "F20");
    assert_eq!(alarm(&fast, &[]), (94, 5, 5.0));
    let tap = turning.replace("G32", "G33");
    assert_eq!(alarm(&tap.replace("M03", "M05"), &[]), (94, 5, 5.0));
}

#[test]
fn a_run_out_that_is_too_fast_is_refused_before_the_thread() {
    // 20 mm of X on 1 mm of Z at 1 m/min: 20 m/min of 3800 (022).
    let text = "O0001\nM03 S500\nG04 X1\nG00 X80 Z5\nG92 X30 Z-20 F2 J20 K1\nM30\n";
    let mut run = ThreadRun::started(text, &[]);
    run.finish();
    assert_eq!((run.alarm(), run.z()), (Some(94), 5.0));
    let alarm = &run.simulation.cnc.alarms()[0];
    let detail = alarm.detail_en();
    assert_eq!(alarm.source.map(|source| source.line), Some(5));
    assert!(
        detail.contains("X would need 20000 mm/min at 500 r/min, the limit is 3800 (022)"),
        "{detail}"
    );
    // With a separate speed X retracts slowly enough.
    let mut run = ThreadRun::started(text, &[(107, 3000)]);
    run.finish();
    assert_eq!(run.alarm(), None);
}

#[test]
fn an_accelerating_spindle_counts_with_its_commanded_speed() {
    // 12 mm at 700 r/min are 8.4 m/min, more than 023; at its start it is slower.
    let text = "O0001\nM03 S200\nG04 X1\nG00 X40 Z5\nS700\nG32 Z-20 F12\nM30\n";
    let mut run = ThreadRun::started(text, &[]);
    run.finish();
    assert!(run.simulation.cnc.spindle_actual() < 650.0);
    assert_eq!((run.alarm(), run.z()), (Some(94), 5.0));
}

#[test]
fn a_spindle_that_becomes_too_fast_stops_the_thread() {
    // G96 in a face thread: the spindle speeds up towards the centre.
    let text = "O0001\nM03 S300\nG96 S100\nG00 X200 Z5\nG04 X1\nG32 X10 F4\nM30\n";
    let mut run = ThreadRun::started(text, &[]);
    run.run_until("stopped", |simulation| !simulation.cnc.alarms().is_empty());
    let fastest = run.simulation.lathe.spindle_rpm();
    assert_eq!(run.alarm(), Some(94));
    let detail = run.simulation.cnc.alarms()[0].detail_en();
    assert!(detail.contains("(022)"));
    // 3800 mm/min are 950 r/min.
    assert!((950.0..1150.0).contains(&fastest), "{fastest} r/min");
}

#[test]
fn the_preview_raises_the_same_alarms() {
    let alarm = |text: &str, lines: i32| {
        let mut setup = Setup::default();
        setup.memory.parameters.set(70, lines).unwrap();
        let mut simulation = Simulation::new(setup.clone());
        let request = ControlRequest::OpenExternal(Program::new(text));
        assert_eq!(simulation.cnc.request(request), Ok(()));
        let preview = preview(&setup, simulation.cnc.programs(), &mut |_| {});
        preview
            .alarm
            .map(|alarm| (alarm.number, alarm.source.unwrap().line))
    };
    let text = "O0001\nG00 X40 Z5\nG32 Z-20 F2\nM30\n";
    assert_eq!(alarm(text, 1024), Some((94, 3)));
    let turning = text.replace("G00", "M03 S500 G00");
    assert_eq!(alarm(&turning, 1024), None);
    assert_eq!(alarm(&turning, 99), Some((92, 3)));
    assert_eq!(alarm(&turning.replace("F2", "F20"), 1024), Some((94, 3)));
}

#[test]
fn a_spindle_that_changes_its_speed_or_stops_is_detected() {
    for (changes, number) in [
        ([(106, 10), (175, 0)], Some(91)),
        ([(106, 0), (175, 0b100)], Some(98)),
        ([(106, 0), (175, 0)], None),
    ] {
        let mut run = ThreadRun::started(G32, &changes);
        run.run_until_z(-5.0);
        run.simulation
            .lathe
            .set_fault(LatheFault::SpindleBlocked, true);
        run.run_ticks(3000);
        assert_eq!(run.alarm(), number);
        assert!(run.z() > -12.0 && !run.simulation.cnc.is_moving());
        let state = if number.is_some() {
            RunState::Stop
        } else {
            RunState::Run
        };
        assert_eq!(run.state(), state);
    }
    // A cut per minute would continue; it too stops with 098.
    let text = "O0001\nM03 S500\nG04 X1\nG00 X40 Z5\nG98 G01 Z-90 F300\nM30\n";
    let mut run = ThreadRun::started(text, &[(175, 0b100)]);
    run.run_until_z(-5.0);
    run.simulation
        .lathe
        .set_fault(LatheFault::SpindleBlocked, true);
    run.run_ticks(2000);
    assert_eq!((run.alarm(), run.state()), (Some(98), RunState::Stop));
}
