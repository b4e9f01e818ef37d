//! What a thread asks of the spindle: alarms 091, 092, 094 and 098.

use gsk_core::cnc::Request;
use gsk_core::machine::Fault;
use gsk_core::operation::RunState;
use gsk_core::preview::preview;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;

use crate::run::{G32, Run};

#[test]
fn threads_need_a_turning_spindle_and_a_usable_encoder() {
    let text = "O0001\nG00 X40 Z5\nG32 Z-20 F2\nM30\n";
    let alarm = |text: &str, changes: &[(u16, i32)]| {
        let mut run = Run::started(text, changes);
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
fn the_preview_raises_the_same_alarms() {
    let alarm = |text: &str, lines: i32| {
        let mut setup = Setup::default();
        setup.parameters.set(70, lines).unwrap();
        let mut simulation = Simulation::new(setup.clone());
        let request = Request::OpenExternal(Program::new(text));
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
fn a_spindle_that_changes_its_speed_or_stops_is_noticed() {
    for (changes, number) in [
        ([(106, 10), (175, 0)], Some(91)),
        ([(106, 0), (175, 0b100)], Some(98)),
        ([(106, 0), (175, 0)], None),
    ] {
        let mut run = Run::started(G32, &changes);
        run.until_z(-5.0);
        run.simulation.lathe.set_fault(Fault::SpindleBlocked, true);
        run.wait(3000);
        assert_eq!(run.alarm(), number);
        assert!(run.z() > -12.0 && !run.simulation.cnc.is_moving());
        let state = if number.is_some() {
            RunState::Stop
        } else {
            RunState::Run
        };
        assert_eq!(run.state(), state);
    }
    // A cut per minute would go on; it too stops with 098.
    let text = "O0001\nM03 S500\nG04 X1\nG00 X40 Z5\nG98 G01 Z-90 F300\nM30\n";
    let mut run = Run::started(text, &[(175, 0b100)]);
    run.until_z(-5.0);
    run.simulation.lathe.set_fault(Fault::SpindleBlocked, true);
    run.wait(2000);
    assert_eq!((run.alarm(), run.state()), (Some(98), RunState::Stop));
}
