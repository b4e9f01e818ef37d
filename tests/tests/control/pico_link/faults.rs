//! Faults on the line in a thread: the thread is right, or an alarm is shown; the control never
//! shows a wrong position as certain.

use gsk_link::LinkState;
use gsk_twins::wire::Damage;

use super::machine::PicoMachine;
use super::stops::{assert_stands_and_is_true, in_thread};

/// Lets the program end and checks it: without an alarm each pulse is made; with one nothing moves,
/// and a position that the control calls known is that of the slides. Returns whether there was an
/// alarm.
#[track_caller]
fn check_outcome(machine: &mut PicoMachine, name: &str) -> bool {
    machine.run_until(60_000, PicoMachine::is_over);
    machine.run_ms(1000);
    let has_alarm = !machine.alarms().is_empty();
    let stood = machine.twin.pulses();
    machine.run_ms(300);
    assert_eq!(machine.twin.pulses(), stood, "{name}: it moves on");
    if !has_alarm || machine.linked.knows_position() {
        machine.assert_agrees();
    }
    has_alarm
}

#[test]
fn damaged_bytes_are_repeated_or_an_alarm() {
    let mut alarms = 0;
    let mut cases = 0;
    for (number, damage) in [
        Damage::Lost,
        Damage::Changed(0x10),
        Damage::Doubled,
        Damage::Stalled(20_000_000),
        Damage::Stalled(150_000_000),
    ]
    .into_iter()
    .enumerate()
    {
        for is_to_board in [true, false] {
            for position in 0..3_u64 {
                let mut machine = in_thread();
                let wire = if is_to_board {
                    &mut machine.twin.to_board
                } else {
                    &mut machine.twin.to_host
                };
                let from = wire.sent_count() + 40 + 61 * position + 7 * number as u64;
                for hit in 0..4 {
                    wire.damage(from + 97 * hit, damage);
                }
                let name = format!("{damage:?} to board: {is_to_board}, {position}");
                alarms += u32::from(check_outcome(&mut machine, &name));
                cases += 1;
            }
        }
    }
    println!("{cases} cases, {alarms} with an alarm");
    assert!(alarms < cases / 2, "{alarms}");
}

#[test]
fn an_unplugged_cable_is_an_alarm_and_a_planned_stop() {
    let mut machine = in_thread();
    let at = machine.twin.pulses()[1];
    machine.twin.to_board.set_cut(true);
    machine.twin.to_host.set_cut(true);
    machine.run_ms(1500);
    let run_on = machine.twin.pulses()[1].abs_diff(at);
    println!("unplugged: {run_on} pulses");
    assert!(run_on <= 650, "{run_on}");
    let alarms = machine.alarms();
    assert!(alarms[0].contains("605"), "{alarms:?}");
    assert_eq!(machine.linked.state(), LinkState::Lost);
    assert!(!machine.linked.knows_position());
    assert_eq!(machine.twin.output("gpio15"), Some(0.0), "spindle off");
}

#[test]
fn a_reset_board_is_reported_before_any_motion() {
    let mut machine = in_thread();
    machine.twin.press_reset();
    machine.run_ms(1000);
    let alarms = machine.alarms();
    assert!(alarms[0].contains("606"), "{alarms:?}");
    assert!(!machine.linked.knows_position());
    let stood = machine.twin.pulses();
    machine.run_ms(1000);
    assert_eq!(machine.twin.pulses(), stood);
}

#[test]
fn a_short_pause_of_the_host_has_no_effect() {
    let mut machine = in_thread();
    for _ in 0..5 {
        machine.is_host_dead = true;
        machine.run_ms(45);
        machine.is_host_dead = false;
        machine.run_ms(200);
    }
    machine.finish(60_000);
    assert_eq!(machine.alarms(), [""; 0]);
    assert_stands_and_is_true(&mut machine);
}
