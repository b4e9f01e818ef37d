//! The alarms of the link: what raises each, that nothing runs while its cause remains, and
//! how the operator continues.

use gsk_core::cnc::Request;
use gsk_link::LinkState;
use gsk_twins::grbl::{GrblTwin, Variant};

use super::SHORT;
use crate::bench::board::{Board, Machine, Timed};
use crate::bench::keys::{JOG, MDI, RESET, Z_PLUS};

/// A program in its cut.
fn working<T: Board>(ready: &Machine<T>) -> Machine<T> {
    let mut machine = ready.clone();
    machine.load(SHORT, None);
    machine.start();
    assert!(machine.wait(5000, |machine| {
        machine.simulation.cnc.cursor().line >= 5 && machine.simulation.cnc.is_moving()
    }));
    machine.pass(200);
    machine
}

/// The alarm is active, nothing runs, RESET alone does not restart the program.
fn stops<T: Board>(machine: &mut Machine<T>, number: u16) {
    assert!(
        machine.wait(6000, |machine| machine.alarms().contains(&number)),
        "{number}: {:?} {:?}",
        machine.alarms(),
        machine.linked.state()
    );
    machine.pass(2000);
    machine.starts_nothing();
    assert!(machine.alarms().contains(&number), "{:?}", machine.alarms());
}

/// RESET and, if the position was lost, the reference return.
#[track_caller]
fn goes_on<T: Board>(mut machine: Machine<T>) {
    machine.press(RESET);
    machine.pass(3000);
    assert!(
        machine.alarms().is_empty(),
        "{:?} {:?}",
        machine.simulation.cnc.alarms(),
        machine.linked.state()
    );
    let referenced = machine.simulation.cnc.referenced();
    if !(referenced.x && referenced.z) {
        machine.starts_nothing();
        assert_eq!(machine.alarms(), [610]);
        machine.press(RESET);
        machine.reference();
    }
    machine.works();
}

fn reconnects<T: Board>(machine: &mut Machine<T>) {
    machine.mend_cable();
    machine.press(RESET);
    assert!(machine.linked.is_to_be_reopened());
    machine.reconnect();
    machine.wait(8000, |machine| machine.linked.state() == LinkState::Locked);
    assert_eq!(machine.alarms(), [0_u16; 0], "the board is there again");
}

fn common<T: Board>(opened: &Machine<T>, connected: &Machine<T>, ready: &Machine<T>) {
    // 601: no answer.
    let mut machine = opened.clone();
    machine.cut_cable();
    stops(&mut machine, 601);
    machine.press(RESET);
    assert_eq!(machine.alarms(), [601], "it stands until the board answers");
    machine.mend_cable();
    machine.reconnect();
    machine.wait(8000, |machine| {
        matches!(
            machine.linked.state(),
            LinkState::Locked | LinkState::Configure
        )
    });
    machine.pass(1500);
    if machine.alarms().contains(&603) {
        // 603: the settings of a board as delivered differ.
        machine.press(RESET);
        assert!(machine.alarms().contains(&603), "until they are written");
        machine.starts_nothing();
        machine.linked.write_settings();
        machine.wait(3000, |machine| machine.linked.state() == LinkState::Locked);
    }
    assert_eq!(machine.alarms(), [0_u16; 0], "there, and set as it must be");
    goes_on(machine);

    // 604: the board cannot make the motion; another program works.
    let mut machine = ready.clone();
    machine.load("O1\nM03 S300\nG01 X50 F100\nG33 Z-5 F1\nM30\n", None);
    machine.starts_nothing();
    assert_eq!(machine.alarms(), [604]);
    goes_on(machine);

    // 605: the link is lost.
    let mut machine = working(ready);
    machine.cut_cable();
    stops(&mut machine, 605);
    reconnects(&mut machine);
    goes_on(machine);

    // 606: the board was reset.
    let mut machine = working(ready);
    machine.twin.press_reset();
    stops(&mut machine, 606);
    goes_on(machine);

    // 608: it gave up.
    let mut machine = working(ready);
    machine.twin.fail();
    stops(&mut machine, 608);
    goes_on(machine);

    // 610: no reference.
    let mut machine = connected.clone();
    machine.load(SHORT, None);
    machine.starts_nothing();
    stops(&mut machine, 610);
    goes_on(machine);

    // 611: the counts differ.
    let mut machine = ready.clone();
    machine.twin.add_position_error([3, 0]);
    stops(&mut machine, 611);
    goes_on(machine);

    // 612: the computer was busy for longer than the lookahead, but too briefly for the board
    // to stop automatically.
    let mut machine = working(ready);
    machine.pause(180);
    stops(&mut machine, 612);
    goes_on(machine);

    // 622: the limit switch; it is left manually.
    let mut machine = working(ready);
    machine.twin.press_limit(true);
    stops(&mut machine, 622);
    machine.press(RESET);
    machine.pass(500);
    machine.press(JOG);
    machine.hold(Z_PLUS, 2000);
    machine.pass(1000);
    machine.twin.press_limit(false);
    machine.pass(1000);
    goes_on(machine);

    // 207: the emergency stop.
    let mut machine = working(ready);
    machine.twin.press_emergency(true);
    stops(&mut machine, 207);
    machine.press(RESET);
    machine.pass(500);
    assert!(machine.alarms().contains(&207), "as long as it is pressed");
    machine.twin.press_emergency(false);
    machine.pass(500);
    goes_on(machine);
}

#[test]
fn alarms_of_a_line_board_and_what_it_takes_to_go_on() {
    common(
        &Machine::new(Variant::Grbl, 10_000, 5),
        &Machine::connected(Variant::Grbl),
        &Machine::referenced(Variant::Grbl),
    );
}

#[test]
fn alarms_of_a_board_of_timed_steps_and_what_it_takes_to_go_on() {
    common(
        &Machine::timed(10_000),
        &Machine::timed_connected(),
        &Machine::timed_referenced(),
    );
}

/// Faults that only the firmware of a line board reports: each number is the alarm of the
/// table.
#[test]
fn alarms_of_the_firmware_are_those_of_the_table() {
    let ready = Machine::referenced(Variant::GrblHal);
    for (said, raised) in [
        (2, vec![608]),
        (4, vec![608]),
        (12, vec![608]),
        (13, vec![608]),
        (14, vec![94]),
        (16, vec![607]),
        (17, vec![221, 222]),
        (22, vec![608]),
    ] {
        let mut machine: Machine<GrblTwin> = working(&ready);
        machine.twin.raise_alarm(said);
        machine.pass(500);
        let mut alarms = machine.alarms();
        alarms.sort_unstable();
        assert_eq!(alarms, raised, "ALARM:{said}");
        assert!(!machine.linked.knows_position());
        machine.pass(1500);
        machine.starts_nothing();
        goes_on(machine);
    }
}

fn tells(ready: &Machine<Timed>, breaks: impl Fn(&mut Timed), number: u16) {
    let mut machine = working(ready);
    breaks(&mut machine.twin);
    stops(&mut machine, number);
    machine.twin.0.set_pin("PC7", false);
    machine.pass(500);
    goes_on(machine);
}

/// And faults of a board of timed steps alone.
#[test]
fn a_board_of_timed_steps_tells_its_own_faults() {
    let ready = Machine::timed_referenced();
    let shut_down = |text: &'static str| move |board: &mut Timed| board.0.force_shutdown(text);
    tells(
        &ready,
        shut_down("Scheduled digital out event will exceed max_duration"),
        607,
    );
    tells(&ready, shut_down("Timer too close"), 612);
    tells(
        &ready,
        |board: &mut Timed| board.0.set_pin("PC7", true),
        221,
    );
}

/// A spindle that was on when the board was lost does not start again with the board.
#[test]
fn the_spindle_does_not_come_back_with_the_board() {
    let mut machine = working(&Machine::referenced(Variant::Grbl));
    assert_eq!(machine.twin.outputs().0, 3);
    machine.cut_cable();
    assert!(machine.wait(3000, |machine| machine.linked.state() == LinkState::Lost));
    // Like the button of the link page, without RESET.
    machine.mend_cable();
    machine.reconnect();
    for _ in 0..6000 {
        machine.ms();
        let (way, _, coolant) = machine.twin.outputs();
        let opened = machine.linked.state() == LinkState::Locked;
        assert!(!opened || (way == 5 && !coolant), "{way} {coolant}");
    }
    assert_eq!(machine.linked.state(), LinkState::Locked);
    goes_on(machine.clone());
    // Switched off and on again it turns.
    machine.press(RESET);
    machine.reference();
    let mut machine = working(&machine);
    machine.pass(100);
    assert_eq!(
        (machine.twin.outputs().0, machine.twin.outputs().2),
        (3, true)
    );
}

/// The panel does not show outputs as on after the board has dropped them.
#[test]
fn what_a_board_dropped_is_shown_as_off() {
    fn drops<T: Board>(ready: &Machine<T>, breaks: impl Fn(&mut Machine<T>), number: u16) {
        let mut machine = working(ready);
        machine.pass(500);
        let lamps = |machine: &Machine<T>| {
            let memory = machine.simulation.cnc.plc().memory();
            // Spindle forward and coolant: outputs and the lamps of their keys.
            [(1, 2), (5, 1), (0, 3), (5, 0)].map(|(byte, bit)| memory.y(byte) >> bit & 1 == 1)
        };
        assert_eq!(lamps(&machine), [true; 4], "{number}");
        breaks(&mut machine);
        machine.pass(6000);
        assert!(machine.alarms().contains(&number), "{:?}", machine.alarms());
        assert_eq!(lamps(&machine), [false; 4], "{number}");
        let cnc = &machine.simulation.cnc;
        assert!(matches!(cnc.modal().m, Some(5 | 9)), "{:?}", cnc.modal().m);
        let speed = cnc.spindle_actual();
        assert!(speed < 1.0, "{number}: S {speed}");
        // And it does not restart automatically.
        machine.press(RESET);
        machine.pass(3000);
        assert_eq!(lamps(&machine), [false; 4], "{number}");
    }
    let line = Machine::referenced(Variant::Grbl);
    drops(&line, |machine| machine.twin.press_reset(), 606);
    drops(&line, |machine| machine.twin.raise_alarm(5), 608);
    let timed = Machine::timed_referenced();
    drops(&timed, |machine| machine.twin.press_reset(), 606);
    drops(&timed, |machine| machine.twin.fail(), 608);
}

/// Nothing moves through a board that returns with other settings.
#[test]
fn a_board_that_restarts_with_other_settings_is_603() {
    let mut machine = working(&Machine::referenced(Variant::Grbl));
    // X turns in the other direction.
    machine.twin.settings_mut().set(3, 1.0).unwrap();
    machine.twin.press_reset();
    stops(&mut machine, 606);
    machine.press(RESET);
    assert!(machine.wait(3000, |machine| machine.alarms() == [603]));
    assert_eq!(machine.linked.state(), LinkState::Configure);
    machine.starts_nothing();
    machine.press(RESET);
    assert!(machine.alarms().contains(&603), "{:?}", machine.alarms());
    machine.linked.write_settings();
    machine.wait(3000, |machine| machine.linked.state() == LinkState::Locked);
    goes_on(machine);
}

/// The gears and rates of the control must be those that the board was set up for.
#[test]
fn parameters_of_the_drives_that_were_changed_are_603() {
    fn changed<T: Board>(mut machine: Machine<T>, number: u16, value: i32) -> Machine<T> {
        machine.press(MDI);
        for request in [
            Request::SetParameterSwitch(true),
            Request::SetParameter { number, value },
            Request::SetParameterSwitch(false),
        ] {
            machine.simulation.cnc.request(request).unwrap();
        }
        machine.press(RESET);
        machine.load(SHORT, None);
        machine.starts_nothing();
        assert_eq!(machine.alarms(), [603], "{number}");
        machine.press(RESET);
        assert!(machine.alarms().is_empty());
        machine
    }
    let line = Machine::referenced(Variant::Grbl);
    // Rapid of X, which $110 must allow.
    let mut machine = changed(line, 22, 4100);
    machine.reconnect();
    machine.wait(8000, |machine| machine.alarms() == [603]);
    machine.linked.write_settings();
    machine.wait(3000, |machine| machine.linked.state() == LinkState::Locked);
    goes_on(machine);
    let mut machine = changed(Machine::timed_referenced(), 17, 6);
    machine.reconnect();
    machine.wait(8000, |machine| machine.linked.state() == LinkState::Locked);
    goes_on(machine);
}
