//! The position of the slides after a fault, on the pages and in the alarms.

use gsk_core::linked::MotionStamp;
use gsk_link::LinkState;
use gsk_twins::grbl::{GrblTwin, Variant};
use gsk_twins::wire::Damage;

use super::assert_counts_agree;
use crate::bench::board::{BenchBoard, LinkedMachine, TimedBoard};
use crate::bench::keys::{AUTO, CYCLE_START, JOG, RESET, X_PLUS, Z_MINUS, ZERO};

/// 10 mm/s of Z, 2000 pulses/s.
const CUT: &str = "O1\nG98 G01 W-60 F600\nM30\n";

fn cutting_machine<T: BenchBoard>(ready: &LinkedMachine<T>, text: &str) -> LinkedMachine<T> {
    let mut machine = ready.clone();
    machine.load(text, None);
    machine.start_program();
    assert!(machine.run_until(4000, |machine| machine.simulation.cnc.feed_actual() > 240.0));
    machine.run_ms(600);
    machine
}

/// Pulses of Z on the pages. X and the coordinates must be consistent with them.
#[track_caller]
fn shown_pulses<T: BenchBoard>(machine: &LinkedMachine<T>) -> i64 {
    let cnc = &machine.simulation.cnc;
    let (pulses, at) = (cnc.pulses(), cnc.position_machine());
    let [x, z] = machine.home_pulses();
    assert!((at.x - (pulses.x.0 - x) as f64 / 400.0).abs() < 0.003);
    assert!((at.z - (pulses.z.0 - z) as f64 / 200.0).abs() < 0.006);
    pulses.z.0
}

/// The end of the alarm's detail gives the displayed position.
#[track_caller]
fn assert_alarm_position<T: BenchBoard>(machine: &LinkedMachine<T>, number: u16, certainty: &str) {
    let alarms = machine.simulation.cnc.alarms();
    let alarm = alarms.iter().find(|alarm| alarm.number == number);
    let detail = alarm.unwrap().detail_en();
    let at = machine.simulation.cnc.position_machine();
    let source = match certainty {
        SHUT_DOWN => "by the motion sent to the board",
        _ => "by the board's count",
    };
    let place = format!(
        "machine coordinates X {:.3} Z {:.3} {source}, {certainty}",
        2.0 * at.x,
        at.z
    );
    assert!(detail.ends_with(&place), "{detail}\n{place}");
}

/// A fault in the cut. Returns the board's position then, and the stamp of an earlier picture.
fn break_in_cut<T: BenchBoard>(
    ready: &LinkedMachine<T>,
    breaks: impl Fn(&mut LinkedMachine<T>),
) -> (LinkedMachine<T>, i64, MotionStamp) {
    let mut machine = cutting_machine(ready, CUT);
    let [_, z] = machine.made_pulses();
    let stamp = machine.linked.stamp();
    breaks(&mut machine);
    machine.run_ms(2500);
    (machine, z, stamp)
}

/// After a dead stop the pages show the made pulses, with the difference `off`.
fn assert_shows_made_pulses<T: BenchBoard>(
    ready: &LinkedMachine<T>,
    breaks: impl Fn(&mut LinkedMachine<T>),
    (number, off, sure): (u16, i64, &str),
) {
    let (machine, _, stamp) = break_in_cut(ready, breaks);
    assert!(machine.alarms().contains(&number), "{:?}", machine.alarms());
    let (shown, made) = (shown_pulses(&machine), machine.made_pulses()[1]);
    assert!(
        (shown - made).abs() <= off,
        "{number}: {shown}, made {made}"
    );
    assert!(
        machine.linked.is_discarded(stamp),
        "{number}: not to be shown"
    );
    let now = machine.linked.stamp();
    assert!(!machine.linked.is_discarded(now) && machine.linked.has_executed(now));
    if !sure.is_empty() {
        assert_alarm_position(&machine, number, sure);
    }
}

const OFF_PATH: &str = "uncertain: it is not on the commanded path";
const DEAD_STOP: &str = "uncertain: the motors were stopped dead and may have lost steps";
const RESTARTED: &str = "uncertain: its last count before it was reset";
const SHUT_DOWN: &str = "uncertain: estimated from the time the board shut down, not read from it";
const NOT_RECEIVED: &str = "uncertain: the board may have moved further since its last report";
const TOO_FAST: &str =
    "uncertain: stopped faster than flush_keep_speed the motors may have lost steps";

#[test]
fn a_stopped_line_board_is_shown_at_its_position() {
    let ready = LinkedMachine::referenced(Variant::Grbl);
    let breaks = |machine: &mut LinkedMachine| machine.twin.press_limit(true);
    assert_shows_made_pulses(&ready, breaks, (622, 0, DEAD_STOP));
    let breaks = |machine: &mut LinkedMachine| machine.twin.raise_alarm(5);
    assert_shows_made_pulses(&ready, breaks, (608, 0, DEAD_STOP));
    let breaks = |machine: &mut LinkedMachine| machine.twin.raise_alarm(16);
    assert_shows_made_pulses(&ready, breaks, (607, 0, DEAD_STOP));
    let breaks = |machine: &mut LinkedMachine| machine.simulation.lathe.set_emergency_button(true);
    assert_shows_made_pulses(&ready, breaks, (207, 0, DEAD_STOP));
    // The host has not read it since its last report.
    let breaks = |machine: &mut LinkedMachine| machine.twin.press_reset();
    assert_shows_made_pulses(&ready, breaks, (606, 140, NOT_RECEIVED));
    // Through its reset line it is back at once.
    let breaks = |machine: &mut LinkedMachine| {
        // Too short for a report, or the control would see it too.
        machine.twin.press_emergency(true);
        machine.twin.advance(1000);
        machine.twin.press_emergency(false);
    };
    assert_shows_made_pulses(&ready, breaks, (606, 140, DEAD_STOP));
    // A line that the board does not understand: it is stopped, and its position is read.
    let breaks = |machine: &mut LinkedMachine| {
        machine.twin.write(b"G99Q\n");
        machine.run_ms(60);
    };
    let sure = "uncertain: the board may have misread its commands";
    assert_shows_made_pulses(&ready, breaks, (608, 0, sure));
}

/// FluidNC continues for a tenth of a second after its reset: the link polls it until it
/// stops.
#[test]
fn a_board_that_continues_after_its_reset_is_shown_at_its_position() {
    let ready = LinkedMachine::referenced(Variant::FluidNc);
    let sure = "uncertain: the board may have misread its commands";
    let breaks = |machine: &mut LinkedMachine<GrblTwin>| {
        machine.twin.write(b"G99Q\n");
        machine.run_ms(60);
    };
    assert_shows_made_pulses(&ready, breaks, (608, 0, sure));
    // A count that jumps off the path and stays so.
    let off = |machine: &mut LinkedMachine<GrblTwin>| machine.twin.add_position_error([400, 0]);
    let (machine, ..) = break_in_cut(&ready, off);
    assert_eq!(machine.alarms(), [611]);
    assert_eq!(shown_pulses(&machine), machine.made_pulses()[1]);
    assert_alarm_position(&machine, 611, OFF_PATH);
}

/// The board never makes motion that was on its way when it shut down.
#[test]
fn a_board_that_got_motion_too_late_is_shown_without_it() {
    let ready = LinkedMachine::timed_referenced();
    for ms in [130, 160, 190, 220] {
        let breaks = |machine: &mut LinkedMachine<TimedBoard>| {
            let [to_board, _] = machine.twin.wires();
            let next = to_board.sent_count();
            to_board.damage(next, Damage::Stalled(ms * 1_000_000));
        };
        let (machine, ..) = break_in_cut(&ready, breaks);
        let (shown, made) = (shown_pulses(&machine), machine.made_pulses()[1]);
        assert!(
            (shown - made).abs() <= 8,
            "{ms}: {shown}, made {made}, {:?}",
            machine.simulation.cnc.alarms()
        );
    }
}

#[test]
fn a_stopped_board_of_timed_steps_is_shown_at_its_position() {
    let ready = LinkedMachine::timed_referenced();
    let breaks = |machine: &mut LinkedMachine<TimedBoard>| machine.twin.press_limit(true);
    assert_shows_made_pulses(&ready, breaks, (622, 0, "certain"));
    // The board reports when it shut down; the computer's clock agrees to 1 ms.
    let breaks = |machine: &mut LinkedMachine<TimedBoard>| machine.twin.fail();
    assert_shows_made_pulses(&ready, breaks, (608, 4, SHUT_DOWN));
    let breaks = |machine: &mut LinkedMachine<TimedBoard>| {
        machine.simulation.lathe.set_emergency_button(true);
    };
    assert_shows_made_pulses(&ready, breaks, (207, 20, SHUT_DOWN));
    let breaks = |machine: &mut LinkedMachine<TimedBoard>| machine.twin.press_reset();
    assert_shows_made_pulses(&ready, breaks, (606, 140, RESTARTED));
}

/// The motion of a board after the link was lost is unknown. The pages show what it had made
/// by then, without motion that was never sent.
fn check_shown_as_last_received<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let (mut machine, last_received, stamp) = break_in_cut(ready, LinkedMachine::cut_cable);
    assert_eq!(machine.alarms(), [605], "and nothing about late motion");
    let shown = shown_pulses(&machine);
    assert!(
        (shown - last_received).abs() <= 140,
        "{shown}, at the cut {last_received}"
    );
    let made = machine.made_pulses()[1];
    assert!(shown >= made, "{shown}, made {made}: Z goes down");
    assert!(machine.linked.is_discarded(stamp));
    assert_alarm_position(&machine, 605, NOT_RECEIVED);
    // RESET, which cannot clear it, does not remove the position.
    machine.press(RESET);
    machine.run_ms(300);
    assert_alarm_position(&machine, 605, NOT_RECEIVED);
}

#[test]
fn a_lost_board_is_shown_at_its_last_received_position() {
    check_shown_as_last_received(&LinkedMachine::referenced(Variant::Grbl));
    check_shown_as_last_received(&LinkedMachine::timed_referenced());
}

/// Motion that was not made is not shown after a stop by the control either.
fn check_reset_shows_made_pulses<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let (machine, _, stamp) = break_in_cut(ready, |machine| machine.press(RESET));
    assert_eq!(machine.linked.state(), LinkState::Ready);
    assert_eq!(shown_pulses(&machine), machine.made_pulses()[1]);
    assert!(machine.linked.is_discarded(stamp));
}

#[test]
fn after_reset_no_picture_shows_more_than_was_made() {
    check_reset_shows_made_pulses(&LinkedMachine::referenced(Variant::Grbl));
    check_reset_shows_made_pulses(&LinkedMachine::timed_referenced());
}

/// If the counts differ, the board's count gives the position.
fn check_differing_counts<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let mut machine = ready.clone();
    machine.twin.add_position_error([0, 7]);
    machine.run_ms(1500);
    assert_eq!(machine.alarms(), [611]);
    let made = machine.made_pulses()[1];
    assert_eq!(shown_pulses(&machine), made + 7);
    let sure = "uncertain: the board's count differs from the commanded position";
    assert_alarm_position(&machine, 611, sure);
}

#[test]
fn counts_that_differ_are_shown_as_the_board_counts() {
    check_differing_counts(&LinkedMachine::referenced(Variant::Grbl));
    check_differing_counts(&LinkedMachine::timed_referenced());
}

/// The computer was away: the motion sent before was made, and compared.
#[test]
fn late_motion_of_a_line_board_leaves_a_certain_position() {
    let (machine, ..) = break_in_cut(&LinkedMachine::referenced(Variant::Grbl), |machine| {
        machine.pause_host(400);
    });
    assert_eq!(machine.alarms(), [612]);
    assert_eq!(shown_pulses(&machine), machine.made_pulses()[1]);
    assert_alarm_position(&machine, 612, "certain");
}

/// Without a reference return the numbers are shown all the same.
fn check_without_reference<T: BenchBoard>(connected: &LinkedMachine<T>) {
    let mut machine = connected.clone();
    machine.press(JOG);
    machine.simulation.cnc.set_panel_key(Z_MINUS, true);
    machine.run_ms(1500);
    machine.twin.press_limit(true);
    machine.run_ms(500);
    machine.simulation.cnc.set_panel_key(Z_MINUS, false);
    machine.run_ms(500);
    assert_eq!(machine.alarms(), [622]);
    let sure = "uncertain: one or both axes have no reference return";
    assert_alarm_position(&machine, 622, sure);
}

#[test]
fn a_fault_without_a_reference_reports_that() {
    check_without_reference(&LinkedMachine::connected(Variant::Grbl));
    check_without_reference(&LinkedMachine::timed_connected());
}

/// Before a board is identified the alarm names no position.
fn check_no_position<T: BenchBoard>(opened: &LinkedMachine<T>) {
    let mut machine = opened.clone();
    machine.cut_cable();
    machine.run_ms(7000);
    assert_eq!(machine.alarms(), [601]);
    let detail = machine.simulation.cnc.alarms()[0].detail_en();
    assert!(!detail.contains("coordinates"), "{detail}");
}

#[test]
fn a_board_that_never_answered_reports_no_position() {
    check_no_position(&LinkedMachine::new(Variant::Grbl, 10_000, 5));
    check_no_position(&LinkedMachine::timed_unlocked(10_000));
}

/// A board counts from its switches. If they do not come, there is no count.
#[test]
fn after_a_failed_return_the_position_is_unknown() {
    for variant in super::LINES {
        let mut machine = LinkedMachine::referenced(variant);
        machine.twin.place_switches([900.0, 900.0]);
        machine.press(ZERO);
        machine.press(X_PLUS);
        assert!(machine.run_until(200_000, |machine| machine.alarms().contains(&609)));
        machine.run_ms(1500);
        let alarms = machine.simulation.cnc.alarms();
        let alarm = alarms.iter().find(|alarm| alarm.number == 609).unwrap();
        let detail = alarm.detail_en();
        assert!(
            detail.ends_with("; the slide position is unknown"),
            "{variant:?} {detail}"
        );
    }
}

/// The emergency stop of a machine at rest: the safety chain has cut its drives.
fn check_stop_at_rest<T: BenchBoard>(ready: &LinkedMachine<T>) {
    let mut machine = ready.clone();
    let stood = shown_pulses(&machine);
    machine.simulation.lathe.set_emergency_button(true);
    machine.run_ms(1500);
    assert_eq!(machine.alarms(), [207]);
    assert_eq!(shown_pulses(&machine), stood);
    assert_alarm_position(&machine, 207, "uncertain: the drives were without power");
    // And again when it is pressed again.
    for pressed in [false, true] {
        machine.simulation.lathe.set_emergency_button(pressed);
        machine.run_ms(1500);
    }
    let detail = machine.simulation.cnc.alarms()[0].detail_en();
    assert!(detail.contains(" by the board's count, uncertain: "));
}

#[test]
fn an_emergency_stop_at_rest_reports_the_position() {
    check_stop_at_rest(&LinkedMachine::referenced(Variant::Grbl));
    check_stop_at_rest(&LinkedMachine::timed_referenced());
}

/// The contact of the board, which is that of the control.
fn check_stop_by_contact<T: BenchBoard>(ready: &LinkedMachine<T>, off: i64, certainty: &str) {
    let breaks = |machine: &mut LinkedMachine<T>| machine.twin.press_emergency(true);
    let (machine, ..) = break_in_cut(ready, breaks);
    let (shown, made) = (shown_pulses(&machine), machine.made_pulses()[1]);
    assert!((shown - made).abs() <= off, "{shown}, made {made}");
    assert_alarm_position(&machine, 207, certainty);
    let detail = machine.simulation.cnc.alarms()[0].detail_en();
    assert_eq!(detail.matches("coordinates").count(), 1, "{detail}");
}

#[test]
fn an_emergency_stop_by_the_contact_of_the_board_is_reported_once() {
    let powerless = "uncertain: the drives were without power";
    check_stop_by_contact(&LinkedMachine::timed_referenced(), 0, powerless);
    // Its contact resets a line board: the host has not read it since its last report.
    for variant in super::LINES {
        check_stop_by_contact(&LinkedMachine::referenced(variant), 140, DEAD_STOP);
    }
}

/// A reference that RESET has dropped is an alarm at once, not only at the next start.
fn check_dropped_reference<T: BenchBoard>(mut machine: LinkedMachine<T>, certainty: &str) {
    machine.load(CUT, None);
    machine.start_program();
    assert!(machine.run_until(4000, |machine| machine.simulation.cnc.feed_actual() > 550.0));
    machine.run_ms(300);
    machine.press(RESET);
    machine.run_ms(1500);
    assert_eq!(machine.linked.state(), LinkState::Locked);
    assert_eq!(machine.alarms(), [610]);
    let alarm = machine.simulation.cnc.alarms()[0].clone();
    let detail = alarm.detail_en();
    assert!(detail.starts_with("the reference is lost"), "{detail}");
    assert_counts_agree(&machine);
    assert_alarm_position(&machine, 610, certainty);
    machine.press(RESET);
    assert_eq!(machine.alarms(), [0_u16; 0]);
    machine.press(AUTO);
    machine.press(CYCLE_START);
    assert_eq!(machine.alarms(), [610]);
    machine.press(RESET);
    machine.return_to_reference();
    machine.check_program_runs();
}

#[test]
fn a_reference_dropped_by_reset_is_reported() {
    check_dropped_reference(
        LinkedMachine::with_flush_speed(Variant::Grbl, 300),
        TOO_FAST,
    );
    check_dropped_reference(LinkedMachine::timed_with_flush_speed(300), TOO_FAST);
    // Whether the backlash is made up for at the stop position is unknown.
    let mut machine = LinkedMachine::referenced(Variant::Grbl);
    machine.set_parameter(35, 20);
    let play = "uncertain: the backlash (034, 035) may not be compensated there";
    check_dropped_reference(machine, play);
}
