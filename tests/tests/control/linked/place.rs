//! The position of the slides after a fault, on the pages and in the alarms.

use gsk_core::linked::Stamp;
use gsk_link::LinkState;
use gsk_twins::grbl::{GrblTwin, Variant};
use gsk_twins::wire::Damage;

use super::assert_together;
use crate::bench::board::{Board, Machine, Timed};
use crate::bench::keys::{AUTO, CYCLE_START, JOG, RESET, X_PLUS, Z_MINUS, ZERO};

/// 10 mm/s of Z, 2000 pulses/s.
const CUT: &str = "O1\nG98 G01 W-60 F600\nM30\n";

fn cutting<T: Board>(ready: &Machine<T>, text: &str) -> Machine<T> {
    let mut machine = ready.clone();
    machine.load(text, None);
    machine.start();
    assert!(machine.wait(4000, |machine| machine.simulation.cnc.feed_actual() > 240.0));
    machine.pass(600);
    machine
}

/// Pulses of Z on the pages. X and the coordinates must be consistent with them.
#[track_caller]
fn shown<T: Board>(machine: &Machine<T>) -> i64 {
    let cnc = &machine.simulation.cnc;
    let (pulses, at) = (cnc.pulses(), cnc.position_machine());
    let [x, z] = machine.home_pulses();
    assert!((at.x - (pulses.x.0 - x) as f64 / 400.0).abs() < 0.003);
    assert!((at.z - (pulses.z.0 - z) as f64 / 200.0).abs() < 0.006);
    pulses.z.0
}

/// The end of the alarm's detail gives the displayed position.
#[track_caller]
fn says<T: Board>(machine: &Machine<T>, number: u16, sure: &str) {
    let alarms = machine.simulation.cnc.alarms();
    let alarm = alarms.iter().find(|alarm| alarm.number == number);
    let detail = alarm.unwrap().detail_en();
    let at = machine.simulation.cnc.position_machine();
    let source = match sure {
        DOWN => "by what the board had been told",
        _ => "by the board's count",
    };
    let place = format!(
        "machine coordinates X {:.3} Z {:.3} {source}, {sure}",
        2.0 * at.x,
        at.z
    );
    assert!(detail.ends_with(&place), "{detail}\n{place}");
}

/// A fault in the cut. Returns the board's position then, and the stamp of an earlier picture.
fn broken<T: Board>(
    ready: &Machine<T>,
    breaks: impl Fn(&mut Machine<T>),
) -> (Machine<T>, i64, Stamp) {
    let mut machine = cutting(ready, CUT);
    let [_, z] = machine.made();
    let stamp = machine.linked.stamp();
    breaks(&mut machine);
    machine.pass(2500);
    (machine, z, stamp)
}

/// After a dead stop the pages show the made pulses, with the difference `off`.
fn shows_the_made<T: Board>(
    ready: &Machine<T>,
    breaks: impl Fn(&mut Machine<T>),
    (number, off, sure): (u16, i64, &str),
) {
    let (machine, _, stamp) = broken(ready, breaks);
    assert!(machine.alarms().contains(&number), "{:?}", machine.alarms());
    let (shown, made) = (shown(&machine), machine.made()[1]);
    assert!(
        (shown - made).abs() <= off,
        "{number}: {shown}, made {made}"
    );
    assert!(machine.linked.is_void(stamp), "{number}: not to be shown");
    let now = machine.linked.stamp();
    assert!(!machine.linked.is_void(now) && machine.linked.has_made(now));
    if !sure.is_empty() {
        says(&machine, number, sure);
    }
}

const OFF_PATH: &str = "uncertain: that is not on the commanded path";
const DEAD: &str = "uncertain: the motors were stopped dead and may have lost steps";
const RESTARTED: &str = "uncertain: its last count before it was reset";
const DOWN: &str = "uncertain: as it was when the board shut down, which nobody has read";
const UNHEARD: &str = "uncertain: the board may have made more since it was heard last";
const TOO_FAST: &str =
    "uncertain: stopped faster than flush_keep_speed the motors may have lost steps";

#[test]
fn a_stopped_line_board_is_shown_where_it_stands() {
    let ready = Machine::referenced(Variant::Grbl);
    let breaks = |machine: &mut Machine| machine.twin.press_limit(true);
    shows_the_made(&ready, breaks, (622, 0, DEAD));
    let breaks = |machine: &mut Machine| machine.twin.raise_alarm(5);
    shows_the_made(&ready, breaks, (608, 0, DEAD));
    let breaks = |machine: &mut Machine| machine.twin.raise_alarm(16);
    shows_the_made(&ready, breaks, (607, 0, DEAD));
    let breaks = |machine: &mut Machine| machine.simulation.lathe.set_emergency_button(true);
    shows_the_made(&ready, breaks, (207, 0, DEAD));
    // The host has not read it since its last report.
    let breaks = |machine: &mut Machine| machine.twin.press_reset();
    shows_the_made(&ready, breaks, (606, 140, UNHEARD));
    // Through its reset line it is back at once.
    let breaks = |machine: &mut Machine| {
        // Too short for a report, or the control would see it too.
        machine.twin.press_emergency(true);
        machine.twin.advance(1000);
        machine.twin.press_emergency(false);
    };
    shows_the_made(&ready, breaks, (606, 140, DEAD));
    // A line that the board does not understand: it is stopped, and its position is read.
    let breaks = |machine: &mut Machine| {
        machine.twin.write(b"G99Q\n");
        machine.pass(60);
    };
    let sure = "uncertain: the board may have misunderstood its orders";
    shows_the_made(&ready, breaks, (608, 0, sure));
}

/// FluidNC continues for a tenth of a second after its reset: the link polls it until it
/// stops.
#[test]
fn a_board_that_goes_on_behind_its_reset_is_shown_where_it_stands() {
    let ready = Machine::referenced(Variant::FluidNc);
    let sure = "uncertain: the board may have misunderstood its orders";
    let breaks = |machine: &mut Machine<GrblTwin>| {
        machine.twin.write(b"G99Q\n");
        machine.pass(60);
    };
    shows_the_made(&ready, breaks, (608, 0, sure));
    // A count that jumps off the path and stays so.
    let off = |machine: &mut Machine<GrblTwin>| machine.twin.add_position_error([400, 0]);
    let (machine, ..) = broken(&ready, off);
    assert_eq!(machine.alarms(), [611]);
    assert_eq!(shown(&machine), machine.made()[1]);
    says(&machine, 611, OFF_PATH);
}

/// The board never makes motion that was on its way when it shut down.
#[test]
fn a_board_that_was_told_too_late_is_shown_no_farther_than_it_was_told() {
    let ready = Machine::timed_referenced();
    for ms in [130, 160, 190, 220] {
        let breaks = |machine: &mut Machine<Timed>| {
            let [to_board, _] = machine.twin.wires();
            let next = to_board.sent_count();
            to_board.damage(next, Damage::Stalled(ms * 1_000_000));
        };
        let (machine, ..) = broken(&ready, breaks);
        let (shown, made) = (shown(&machine), machine.made()[1]);
        assert!(
            (shown - made).abs() <= 8,
            "{ms}: {shown}, made {made}, {:?}",
            machine.simulation.cnc.alarms()
        );
    }
}

#[test]
fn a_stopped_board_of_timed_steps_is_shown_where_it_stands() {
    let ready = Machine::timed_referenced();
    let breaks = |machine: &mut Machine<Timed>| machine.twin.press_limit(true);
    shows_the_made(&ready, breaks, (622, 0, "certain"));
    // The board reports when it shut down; the computer's clock agrees to 1 ms.
    let breaks = |machine: &mut Machine<Timed>| machine.twin.fail();
    shows_the_made(&ready, breaks, (608, 4, DOWN));
    let breaks = |machine: &mut Machine<Timed>| machine.simulation.lathe.set_emergency_button(true);
    shows_the_made(&ready, breaks, (207, 20, DOWN));
    let breaks = |machine: &mut Machine<Timed>| machine.twin.press_reset();
    shows_the_made(&ready, breaks, (606, 140, RESTARTED));
}

/// The motion of a board after the link was lost is unknown. The pages show what it had made
/// by then, without motion that was never sent.
fn is_shown_as_last_heard<T: Board>(ready: &Machine<T>) {
    let (mut machine, heard, stamp) = broken(ready, Machine::cut_cable);
    assert_eq!(machine.alarms(), [605], "and nothing about late motion");
    let shown = shown(&machine);
    assert!((shown - heard).abs() <= 140, "{shown}, at the cut {heard}");
    let made = machine.made()[1];
    assert!(shown >= made, "{shown}, made {made}: Z goes down");
    assert!(machine.linked.is_void(stamp));
    says(&machine, 605, UNHEARD);
    // RESET, which cannot clear it, does not remove the position.
    machine.press(RESET);
    machine.pass(300);
    says(&machine, 605, UNHEARD);
}

#[test]
fn a_lost_board_is_shown_where_it_was_heard_last() {
    is_shown_as_last_heard(&Machine::referenced(Variant::Grbl));
    is_shown_as_last_heard(&Machine::timed_referenced());
}

/// Motion that was not made is not shown after a stop by the control either.
fn reset_shows_the_made<T: Board>(ready: &Machine<T>) {
    let (machine, _, stamp) = broken(ready, |machine| machine.press(RESET));
    assert_eq!(machine.linked.state(), LinkState::Ready);
    assert_eq!(shown(&machine), machine.made()[1]);
    assert!(machine.linked.is_void(stamp));
}

#[test]
fn behind_reset_no_picture_shows_more_than_was_made() {
    reset_shows_the_made(&Machine::referenced(Variant::Grbl));
    reset_shows_the_made(&Machine::timed_referenced());
}

/// If the counts differ, the board's count gives the position.
fn differs<T: Board>(ready: &Machine<T>) {
    let mut machine = ready.clone();
    machine.twin.add_position_error([0, 7]);
    machine.pass(1500);
    assert_eq!(machine.alarms(), [611]);
    let made = machine.made()[1];
    assert_eq!(shown(&machine), made + 7);
    let sure = "uncertain: the board counts another place than was commanded";
    says(&machine, 611, sure);
}

#[test]
fn counts_that_differ_are_shown_as_the_board_counts() {
    differs(&Machine::referenced(Variant::Grbl));
    differs(&Machine::timed_referenced());
}

/// The computer was away: the motion sent before was made, and compared.
#[test]
fn late_motion_of_a_line_board_leaves_a_certain_place() {
    let (machine, ..) = broken(&Machine::referenced(Variant::Grbl), |machine| {
        machine.pause(400);
    });
    assert_eq!(machine.alarms(), [612]);
    assert_eq!(shown(&machine), machine.made()[1]);
    says(&machine, 612, "certain");
}

/// Without a reference return the numbers are shown all the same.
fn jogged<T: Board>(connected: &Machine<T>) {
    let mut machine = connected.clone();
    machine.press(JOG);
    machine.simulation.cnc.set_panel_key(Z_MINUS, true);
    machine.pass(1500);
    machine.twin.press_limit(true);
    machine.pass(500);
    machine.simulation.cnc.set_panel_key(Z_MINUS, false);
    machine.pass(500);
    assert_eq!(machine.alarms(), [622]);
    let sure = "uncertain: not both axes have made their reference return";
    says(&machine, 622, sure);
}

#[test]
fn a_fault_without_a_reference_says_so() {
    jogged(&Machine::connected(Variant::Grbl));
    jogged(&Machine::timed_connected());
}

/// Before a board is identified the alarm names no position.
fn nothing_said<T: Board>(opened: &Machine<T>) {
    let mut machine = opened.clone();
    machine.cut_cable();
    machine.pass(7000);
    assert_eq!(machine.alarms(), [601]);
    let detail = machine.simulation.cnc.alarms()[0].detail_en();
    assert!(!detail.contains("coordinates"), "{detail}");
}

#[test]
fn a_board_that_never_answered_says_nothing_of_a_place() {
    nothing_said(&Machine::new(Variant::Grbl, 10_000, 5));
    nothing_said(&Machine::timed(10_000));
}

/// A board counts from its switches. If they do not come, there is no count.
#[test]
fn behind_a_return_that_failed_nobody_knows_the_place() {
    for variant in super::LINES {
        let mut machine = Machine::referenced(variant);
        machine.twin.place_switches([900.0, 900.0]);
        machine.press(ZERO);
        machine.press(X_PLUS);
        assert!(machine.wait(200_000, |machine| machine.alarms().contains(&609)));
        machine.pass(1500);
        let alarms = machine.simulation.cnc.alarms();
        let alarm = alarms.iter().find(|alarm| alarm.number == 609).unwrap();
        let detail = alarm.detail_en();
        assert!(
            detail.ends_with("; nobody knows where the slides stand"),
            "{variant:?} {detail}"
        );
    }
}

/// The emergency stop of a machine at rest: the safety chain has cut its drives.
fn is_stopped_at_rest<T: Board>(ready: &Machine<T>) {
    let mut machine = ready.clone();
    let stood = shown(&machine);
    machine.simulation.lathe.set_emergency_button(true);
    machine.pass(1500);
    assert_eq!(machine.alarms(), [207]);
    assert_eq!(shown(&machine), stood);
    says(&machine, 207, "uncertain: the drives were without power");
    // And again when it is pressed again.
    for pressed in [false, true] {
        machine.simulation.lathe.set_emergency_button(pressed);
        machine.pass(1500);
    }
    let detail = machine.simulation.cnc.alarms()[0].detail_en();
    assert!(detail.contains(" by the board's count, uncertain: "));
}

#[test]
fn an_emergency_stop_at_rest_says_where_the_slides_stand() {
    is_stopped_at_rest(&Machine::referenced(Variant::Grbl));
    is_stopped_at_rest(&Machine::timed_referenced());
}

/// The contact of the board, which is that of the control.
fn is_stopped_by_its_contact<T: Board>(ready: &Machine<T>, off: i64, sure: &str) {
    let breaks = |machine: &mut Machine<T>| machine.twin.press_emergency(true);
    let (machine, ..) = broken(ready, breaks);
    let (shown, made) = (shown(&machine), machine.made()[1]);
    assert!((shown - made).abs() <= off, "{shown}, made {made}");
    says(&machine, 207, sure);
    let detail = machine.simulation.cnc.alarms()[0].detail_en();
    assert_eq!(detail.matches("coordinates").count(), 1, "{detail}");
}

#[test]
fn an_emergency_stop_by_the_contact_of_the_board_says_so_once() {
    let powerless = "uncertain: the drives were without power";
    is_stopped_by_its_contact(&Machine::timed_referenced(), 0, powerless);
    // Its contact resets a line board: the host has not read it since its last report.
    for variant in super::LINES {
        is_stopped_by_its_contact(&Machine::referenced(variant), 140, DEAD);
    }
}

/// A reference that RESET has dropped is an alarm at once, not only at the next start.
fn is_told<T: Board>(mut machine: Machine<T>, sure: &str) {
    machine.load(CUT, None);
    machine.start();
    assert!(machine.wait(4000, |machine| machine.simulation.cnc.feed_actual() > 550.0));
    machine.pass(300);
    machine.press(RESET);
    machine.pass(1500);
    assert_eq!(machine.linked.state(), LinkState::Locked);
    assert_eq!(machine.alarms(), [610]);
    let alarm = machine.simulation.cnc.alarms()[0].clone();
    let detail = alarm.detail_en();
    assert!(detail.starts_with("the reference was dropped"), "{detail}");
    assert_together(&machine);
    says(&machine, 610, sure);
    machine.press(RESET);
    assert_eq!(machine.alarms(), [0_u16; 0]);
    machine.press(AUTO);
    machine.press(CYCLE_START);
    assert_eq!(machine.alarms(), [610]);
    machine.press(RESET);
    machine.reference();
    machine.works();
}

#[test]
fn a_reference_dropped_by_reset_is_told() {
    is_told(Machine::with(Variant::Grbl, 300), TOO_FAST);
    is_told(Machine::timed_with(300), TOO_FAST);
    // Whether the backlash is made up for at the stop position is unknown.
    let mut machine = Machine::referenced(Variant::Grbl);
    machine.set(35, 20);
    let play = "uncertain: the play of the screws (034, 035) may not be made up for there";
    is_told(machine, play);
}
