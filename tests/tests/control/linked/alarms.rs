//! The alarms of the link: what raises each, that nothing runs while its cause remains, and
//! how the operator continues.

use gsk_core::cnc::ControlRequest;
use gsk_link::LinkState;
use gsk_twins::grbl::{GrblTwin, Variant};

use super::SHORT;
use crate::bench::board::{BenchBoard, LinkedMachine, TimedBoard};
use crate::bench::keys::{JOG, MDI, RESET, Z_PLUS};

/// A program in its cut.
fn cutting_machine<T: BenchBoard>(ready: &LinkedMachine<T>) -> LinkedMachine<T> {
    let mut machine = ready.clone();
    machine.load(SHORT, None);
    machine.start_program();
    assert!(machine.run_until(5000, |machine| {
        machine.simulation.cnc.cursor().line >= 5 && machine.simulation.cnc.is_moving()
    }));
    machine.run_ms(200);
    machine
}

/// The alarm is active, nothing runs, RESET alone does not restart the program.
fn check_stopped_by<T: BenchBoard>(machine: &mut LinkedMachine<T>, number: u16) {
    assert!(
        machine.run_until(6000, |machine| machine.alarms().contains(&number)),
        "{number}: {:?} {:?}",
        machine.alarms(),
        machine.linked.state()
    );
    machine.run_ms(2000);
    machine.check_nothing_starts();
    assert!(machine.alarms().contains(&number), "{:?}", machine.alarms());
}

/// RESET and, if the position was lost, the reference return.
#[track_caller]
fn check_recovery<T: BenchBoard>(mut machine: LinkedMachine<T>) {
    machine.press(RESET);
    machine.run_ms(3000);
    assert!(
        machine.alarms().is_empty(),
        "{:?} {:?}",
        machine.simulation.cnc.alarms(),
        machine.linked.state()
    );
    let referenced = machine.simulation.cnc.referenced_axes();
    if !(referenced.x && referenced.z) {
        machine.check_nothing_starts();
        assert_eq!(machine.alarms(), [610]);
        machine.press(RESET);
        machine.return_to_reference();
    }
    machine.check_program_runs();
}

fn check_reconnection<T: BenchBoard>(machine: &mut LinkedMachine<T>) {
    machine.reconnect_cable();
    machine.press(RESET);
    assert!(machine.linked.needs_reopening());
    machine.reconnect();
    machine.run_until(8000, |machine| machine.linked.state() == LinkState::Locked);
    assert_eq!(machine.alarms(), [0_u16; 0], "the board is there again");
}

fn check_common_alarms<T: BenchBoard>(
    opened: &LinkedMachine<T>,
    connected: &LinkedMachine<T>,
    ready: &LinkedMachine<T>,
) {
    // 601: no answer.
    let mut machine = opened.clone();
    machine.cut_cable();
    check_stopped_by(&mut machine, 601);
    machine.press(RESET);
    assert_eq!(machine.alarms(), [601], "it stands until the board answers");
    machine.reconnect_cable();
    machine.reconnect();
    machine.run_until(8000, |machine| {
        matches!(
            machine.linked.state(),
            LinkState::Locked | LinkState::Configure
        )
    });
    machine.run_ms(1500);
    if machine.alarms().contains(&603) {
        // 603: the settings of a board as delivered differ.
        machine.press(RESET);
        assert!(machine.alarms().contains(&603), "until they are written");
        machine.check_nothing_starts();
        machine.linked.write_settings();
        machine.run_until(3000, |machine| machine.linked.state() == LinkState::Locked);
    }
    assert_eq!(machine.alarms(), [0_u16; 0], "there, and set as it must be");
    check_recovery(machine);

    // 604: the board cannot make the motion; another program works.
    let mut machine = ready.clone();
    machine.load("O1\nM03 S300\nG01 X50 F100\nG33 Z-5 F1\nM30\n", None);
    machine.check_nothing_starts();
    assert_eq!(machine.alarms(), [604]);
    check_recovery(machine);

    // 605: the link is lost.
    let mut machine = cutting_machine(ready);
    machine.cut_cable();
    check_stopped_by(&mut machine, 605);
    check_reconnection(&mut machine);
    check_recovery(machine);

    // 606: the board was reset.
    let mut machine = cutting_machine(ready);
    machine.twin.press_reset();
    check_stopped_by(&mut machine, 606);
    check_recovery(machine);

    // 608: it gave up.
    let mut machine = cutting_machine(ready);
    machine.twin.fail();
    check_stopped_by(&mut machine, 608);
    check_recovery(machine);

    // 610: no reference.
    let mut machine = connected.clone();
    machine.load(SHORT, None);
    machine.check_nothing_starts();
    check_stopped_by(&mut machine, 610);
    check_recovery(machine);

    // 611: the counts differ.
    let mut machine = ready.clone();
    machine.twin.add_position_error([3, 0]);
    check_stopped_by(&mut machine, 611);
    check_recovery(machine);

    // 612: the computer was busy for longer than the lookahead, but too briefly for the board
    // to stop automatically.
    let mut machine = cutting_machine(ready);
    machine.pause_host(180);
    check_stopped_by(&mut machine, 612);
    check_recovery(machine);

    // 622: the limit switch; it is left manually.
    let mut machine = cutting_machine(ready);
    machine.twin.press_limit(true);
    check_stopped_by(&mut machine, 622);
    machine.press(RESET);
    machine.run_ms(500);
    machine.press(JOG);
    machine.hold_key(Z_PLUS, 2000);
    machine.run_ms(1000);
    machine.twin.press_limit(false);
    machine.run_ms(1000);
    check_recovery(machine);

    // 207: the emergency stop.
    let mut machine = cutting_machine(ready);
    machine.twin.press_emergency(true);
    check_stopped_by(&mut machine, 207);
    machine.press(RESET);
    machine.run_ms(500);
    assert!(machine.alarms().contains(&207), "as long as it is pressed");
    machine.twin.press_emergency(false);
    machine.run_ms(500);
    check_recovery(machine);
}

#[test]
fn alarms_of_a_line_board_and_their_recovery() {
    check_common_alarms(
        &LinkedMachine::new(Variant::Grbl, 10_000, 5),
        &LinkedMachine::connected(Variant::Grbl),
        &LinkedMachine::referenced(Variant::Grbl),
    );
}

#[test]
fn alarms_of_a_board_of_timed_steps_and_their_recovery() {
    check_common_alarms(
        &LinkedMachine::timed_unlocked(10_000),
        &LinkedMachine::timed_connected(),
        &LinkedMachine::timed_referenced(),
    );
}

/// Faults that only the firmware of a line board reports: each number is the alarm of the
/// table.
#[test]
fn alarms_of_the_firmware_are_those_of_the_table() {
    let ready = LinkedMachine::referenced(Variant::GrblHal);
    for (code, raised) in [
        (2, vec![608]),
        (4, vec![608]),
        (12, vec![608]),
        (13, vec![608]),
        (14, vec![94]),
        (16, vec![607]),
        (17, vec![221, 222]),
        (22, vec![608]),
    ] {
        let mut machine: LinkedMachine<GrblTwin> = cutting_machine(&ready);
        machine.twin.raise_alarm(code);
        machine.run_ms(500);
        let mut alarms = machine.alarms();
        alarms.sort_unstable();
        assert_eq!(alarms, raised, "ALARM:{code}");
        assert!(!machine.linked.knows_position());
        machine.run_ms(1500);
        machine.check_nothing_starts();
        check_recovery(machine);
    }
}

fn check_alarm(ready: &LinkedMachine<TimedBoard>, breaks: impl Fn(&mut TimedBoard), number: u16) {
    let mut machine = cutting_machine(ready);
    breaks(&mut machine.twin);
    check_stopped_by(&mut machine, number);
    machine.twin.0.set_pin("PC7", false);
    machine.run_ms(500);
    check_recovery(machine);
}

/// And faults of a board of timed steps alone.
#[test]
fn a_board_of_timed_steps_reports_its_own_faults() {
    let ready = LinkedMachine::timed_referenced();
    let shut_down = |text: &'static str| move |board: &mut TimedBoard| board.0.force_shutdown(text);
    check_alarm(
        &ready,
        shut_down("Scheduled digital out event will exceed max_duration"),
        607,
    );
    check_alarm(&ready, shut_down("Timer too close"), 612);
    check_alarm(
        &ready,
        |board: &mut TimedBoard| board.0.set_pin("PC7", true),
        221,
    );
}

/// A spindle that was on when the board was lost does not start again with the board.
#[test]
fn the_spindle_does_not_come_back_with_the_board() {
    let mut machine = cutting_machine(&LinkedMachine::referenced(Variant::Grbl));
    assert_eq!(machine.twin.outputs().0, 3);
    machine.cut_cable();
    assert!(machine.run_until(3000, |machine| machine.linked.state() == LinkState::Lost));
    // Like the button of the link page, without RESET.
    machine.reconnect_cable();
    machine.reconnect();
    for _ in 0..6000 {
        machine.run_one_ms();
        let (way, _, coolant) = machine.twin.outputs();
        let opened = machine.linked.state() == LinkState::Locked;
        assert!(!opened || (way == 5 && !coolant), "{way} {coolant}");
    }
    assert_eq!(machine.linked.state(), LinkState::Locked);
    check_recovery(machine.clone());
    // Switched off and on again it turns.
    machine.press(RESET);
    machine.return_to_reference();
    let mut machine = cutting_machine(&machine);
    machine.run_ms(100);
    assert_eq!(
        (machine.twin.outputs().0, machine.twin.outputs().2),
        (3, true)
    );
}

/// The panel does not show outputs as on after the board has dropped them.
#[test]
fn what_a_board_dropped_is_shown_as_off() {
    fn check_dropped<T: BenchBoard>(
        ready: &LinkedMachine<T>,
        breaks: impl Fn(&mut LinkedMachine<T>),
        number: u16,
    ) {
        let mut machine = cutting_machine(ready);
        machine.run_ms(500);
        let lamps = |machine: &LinkedMachine<T>| {
            let memory = machine.simulation.cnc.plc().memory();
            // Spindle forward and coolant: outputs and the lamps of their keys.
            [(1, 2), (5, 1), (0, 3), (5, 0)].map(|(byte, bit)| memory.y(byte) >> bit & 1 == 1)
        };
        assert_eq!(lamps(&machine), [true; 4], "{number}");
        breaks(&mut machine);
        machine.run_ms(6000);
        assert!(machine.alarms().contains(&number), "{:?}", machine.alarms());
        assert_eq!(lamps(&machine), [false; 4], "{number}");
        let cnc = &machine.simulation.cnc;
        assert!(matches!(cnc.modal().m, Some(5 | 9)), "{:?}", cnc.modal().m);
        let speed = cnc.spindle_actual();
        assert!(speed < 1.0, "{number}: S {speed}");
        // And it does not restart automatically.
        machine.press(RESET);
        machine.run_ms(3000);
        assert_eq!(lamps(&machine), [false; 4], "{number}");
    }
    let line = LinkedMachine::referenced(Variant::Grbl);
    check_dropped(&line, |machine| machine.twin.press_reset(), 606);
    check_dropped(&line, |machine| machine.twin.raise_alarm(5), 608);
    let timed = LinkedMachine::timed_referenced();
    check_dropped(&timed, |machine| machine.twin.press_reset(), 606);
    check_dropped(&timed, |machine| machine.twin.fail(), 608);
}

/// Nothing moves through a board that returns with other settings.
#[test]
fn a_board_that_restarts_with_other_settings_is_603() {
    let mut machine = cutting_machine(&LinkedMachine::referenced(Variant::Grbl));
    // X turns in the other direction.
    machine.twin.settings_mut().set(3, 1.0).unwrap();
    machine.twin.press_reset();
    check_stopped_by(&mut machine, 606);
    machine.press(RESET);
    assert!(machine.run_until(3000, |machine| machine.alarms() == [603]));
    assert_eq!(machine.linked.state(), LinkState::Configure);
    machine.check_nothing_starts();
    machine.press(RESET);
    assert!(machine.alarms().contains(&603), "{:?}", machine.alarms());
    machine.linked.write_settings();
    machine.run_until(3000, |machine| machine.linked.state() == LinkState::Locked);
    check_recovery(machine);
}

/// The gears and rates of the control must be those that the board was set up for.
#[test]
fn parameters_of_the_drives_that_were_changed_are_603() {
    fn with_parameter<T: BenchBoard>(
        mut machine: LinkedMachine<T>,
        number: u16,
        value: i32,
    ) -> LinkedMachine<T> {
        machine.press(MDI);
        for request in [
            ControlRequest::SetParameterSwitch(true),
            ControlRequest::SetParameter { number, value },
            ControlRequest::SetParameterSwitch(false),
        ] {
            machine.simulation.cnc.request(request).unwrap();
        }
        machine.press(RESET);
        machine.load(SHORT, None);
        machine.check_nothing_starts();
        assert_eq!(machine.alarms(), [603], "{number}");
        machine.press(RESET);
        assert!(machine.alarms().is_empty());
        machine
    }
    let line = LinkedMachine::referenced(Variant::Grbl);
    // Rapid of X, which $110 must allow.
    let mut machine = with_parameter(line, 22, 4100);
    machine.reconnect();
    machine.run_until(8000, |machine| machine.alarms() == [603]);
    machine.linked.write_settings();
    machine.run_until(3000, |machine| machine.linked.state() == LinkState::Locked);
    check_recovery(machine);
    let mut machine = with_parameter(LinkedMachine::timed_referenced(), 17, 6);
    machine.reconnect();
    machine.run_until(8000, |machine| machine.linked.state() == LinkState::Locked);
    check_recovery(machine);
}
