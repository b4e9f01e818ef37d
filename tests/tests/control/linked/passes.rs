//! Threads that the board synchronizes to its own spindle, one pass after the other.

use gsk_core::linked::LinkNote;
use gsk_core::operation::RunState;
use gsk_link::{LinkConfig, LinkState};
use gsk_twins::grbl::{GrblSettings, GrblState};
use gsk_twins::wire::Damage;

use super::assert_counts_agree;
use crate::bench::board::LinkedMachine;
use crate::bench::dice::{TestRandom, round_count};
use crate::bench::keys::{AUTO, CYCLE_START, FEED_HOLD, RESET, SINGLE_BLOCK};

/// 300 r/min, lead 2 mm, three passes.
const CYCLE: &str = "O1\nN10 G50 X60 Z20\nN20 G98 G97 S300 M03\nN30 G00 X30 Z5\n\
    N40 G92 X19.4 Z-20 F2 J0\nN50 X19\nN60 X18.6\nN70 G00 X60 Z20\nN80 M05\nN90 M30\n";

fn proven_config() -> LinkConfig {
    let mut config = LinkConfig {
        flush_keep_speed: 10_000,
        ..LinkConfig::default()
    };
    config.line.thread_proved = true;
    config
}

/// An encoder of 1024 pulses, gains 0.
fn tuned_settings() -> GrblSettings {
    let mut settings = GrblSettings::with_encoder(1024);
    for number in [90, 91, 92] {
        settings.set(number, 0.0).unwrap();
    }
    settings
}

fn ready_machine() -> LinkedMachine {
    LinkedMachine::for_threading(proven_config(), tuned_settings(), &[])
}

fn run_text(machine: &mut LinkedMachine, text: &str) {
    machine.load(text, None);
    machine.start_program();
    machine.run_to_end(600_000);
}

/// Spindle turns at which Z (mm from machine zero) was passed in each pass.
fn turns_at(machine: &LinkedMachine, z: f64) -> Vec<f64> {
    // The count at the pins starts at the initial position of the slides.
    let shift = machine.twin.pulses()[1] - machine.made_pulses()[1] + machine.home_pulses()[1];
    let place = (z * 200.0).round() as i64 + shift;
    let mut turns = Vec::new();
    for pass in machine.twin.passes() {
        let found = pass.0.iter().find(|(at, _)| at[1] <= place);
        turns.push(found.unwrap().1);
    }
    turns
}

/// The machine coordinate of a Z of the program.
fn machine_z(machine: &LinkedMachine, z: f64) -> f64 {
    let cnc = &machine.simulation.cnc;
    cnc.position_machine().z + z - cnc.position_absolute().z
}

#[track_caller]
fn assert_same_phase(turns: &[f64]) {
    for turn in turns {
        let off = (turn - turns[0]) - (turn - turns[0]).round();
        assert!(off.abs() < 0.002, "{turns:?}");
    }
}

fn refused_start(machine: &LinkedMachine, text: &str) -> (String, Option<u32>) {
    let mut machine = machine.clone();
    let stood = machine.made_pulses();
    machine.load(text, None);
    machine.start_program();
    machine.run_ms(30_000);
    assert_eq!(machine.alarms(), [604], "{text}");
    assert_eq!(machine.twin.passes().len(), 0, "{text}");
    let alarm = machine.simulation.cnc.alarms()[0].clone();
    let moved = machine.made_pulses() != stood;
    let line = alarm.source.map(|source| source.line);
    (alarm.detail_en(), line.filter(|_| !moved))
}

#[test]
fn the_passes_of_a_cycle_meet_one_groove_and_end_on_the_pulse() {
    let mut machine = ready_machine();
    run_text(&mut machine, CYCLE);
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_counts_agree(&machine);
    assert_eq!(machine.twin.passes().len(), 3);
    let [from, to] = [-2.0, -18.0].map(|z| turns_at(&machine, machine_z(&machine, z)));
    assert_same_phase(&from);
    assert_same_phase(&to);
    for (from, to) in from.iter().zip(&to) {
        assert!((to - from - 8.0).abs() < 0.004, "{from} {to}");
    }
    machine.run_ms(500);
    // The count was compared after each pass, and at the end.
    let agreed = |note: &&LinkNote| matches!(note, LinkNote::CountChecked { agrees: true, .. });
    assert!(machine.notes.iter().any(|note| agreed(&note)));
}

#[test]
fn a_taper_has_its_lead_along_z_and_a_face_thread_along_x() {
    // R: the start of the cut is 2 mm (radius) lower than its end.
    let mut machine = ready_machine();
    let text = CYCLE.replace("J0", "J0 R-2");
    run_text(&mut machine, &text);
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_counts_agree(&machine);
    let [from, to] = [-2.0, -18.0].map(|z| turns_at(&machine, machine_z(&machine, z)));
    assert_same_phase(&from);
    assert!((to[0] - from[0] - 8.0).abs() < 0.004, "{from:?} {to:?}");
    let mut machine = ready_machine();
    let face = "O1\nG50 X60 Z20\nG98 G97 S300 M03\nG00 X50 Z5\nG32 X20 F1\nG00 X60 Z20\nM30\n";
    run_text(&mut machine, face);
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_counts_agree(&machine);
    let pass = &machine.twin.passes()[0].0;
    let (first, last) = (pass[0], *pass.last().unwrap());
    // 15 mm of radius; acceleration and stop take a little longer.
    assert_eq!((first.0[0] - last.0[0]).abs() / 100, 15 * 400 / 100);
    assert!((last.1 - first.1 - 15.0).abs() < 0.05);
}

#[test]
fn compound_cycle_and_single_threads_end_on_the_pulse() {
    let single = "O1\nG50 X60 Z20\nG98 G97 S300 M03\nG00 X18.6 Z5\nG32 X19.4 Z-20 F1.5\n\
        G00 X60\nG00 Z20\nM30\n";
    let compound = "O1\nG50 X60 Z20\nG98 G97 S300 M03\nG00 X30 Z5\nG76 P010060 Q100 R0.1\n\
        G76 X18 Z-20 P1000 Q400 F2\nG00 X60 Z20\nM30\n";
    for (text, least) in [(single, 1), (compound, 4)] {
        let mut machine = ready_machine();
        run_text(&mut machine, text);
        assert_eq!(machine.alarms(), [0_u16; 0], "{text}");
        assert_counts_agree(&machine);
        assert!(machine.twin.passes().len() >= least, "{text}");
    }
}

#[test]
fn play_of_the_screw_is_made_up_for_before_the_pass() {
    let mut machine =
        LinkedMachine::for_threading(proven_config(), tuned_settings(), &[(34, 20), (35, 100)]);
    run_text(&mut machine, CYCLE);
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_counts_agree(&machine);
    let from = turns_at(&machine, machine_z(&machine, -2.0));
    let to = turns_at(&machine, machine_z(&machine, -18.0));
    assert_same_phase(&from);
    assert!((to[0] - from[0] - 8.0).abs() < 0.004, "{from:?} {to:?}");
}

#[test]
fn missing_settings_are_named_before_anything_moves() {
    let delivered = GrblSettings::with_encoder(1024);
    for (config, settings, named) in [
        (proven_config(), GrblSettings::default(), &["no SS"][..]),
        (
            LinkConfig::default(),
            tuned_settings(),
            &["line.thread_proved"],
        ),
        (
            LinkConfig::default(),
            GrblSettings::default(),
            &["no SS", "line.thread_proved"],
        ),
        (proven_config(), delivered, &["$90, $91 and $92"]),
    ] {
        let machine = LinkedMachine::for_threading(config, settings, &[]);
        let (text, line) = refused_start(&machine, CYCLE);
        assert_eq!(line, Some(5), "{text}");
        for name in named {
            assert!(text.contains(name), "{text}");
        }
    }
}

/// The board counts the end of a pass from its work offset.
#[test]
fn a_work_offset_in_the_board_prevents_a_pass() {
    let mut machine = LinkedMachine::for_threading(proven_config(), tuned_settings(), &[]);
    machine.twin.set_work_offset([0.0, -40.0]);
    machine.reconnect();
    machine.run_until(6000, |machine| machine.linked.state() == LinkState::Locked);
    machine.press(RESET);
    machine.run_ms(500);
    machine.return_to_reference();
    let (text, line) = refused_start(&machine, CYCLE);
    assert_eq!(line, Some(5), "{text}");
    assert!(text.contains("G54"), "{text}");
}

#[test]
fn passes_that_are_not_straight_are_refused() {
    let machine = ready_machine();
    let head = "O1\nG50 X60 Z20\nG98 G97 S300 M03\nG00 X30 Z5\n";
    for (block, named, unmoved) in [
        ("G34 Z-20 F2 R0.1", "G34", true),
        ("G33 Z-20 F2", "G33", true),
        ("G32 Z-20 F2 J2", "run-out", true),
        ("G92 X19.4 Z-20 F2", "run-out", true),
        ("G92 X19.4 Z-20 F2 J1 K1", "run-out", true),
        ("G92 X19.4 Z-20 F2 J0 L2", "L of G92", true),
        (
            "G76 P010560 Q100 R0.1\nG76 X18 Z-20 P1000 Q400 F2",
            "run-out",
            true,
        ),
        ("G32 Z-10 F2\nZ-20", "continues", false),
        (
            "G65 H80 P50\nG92 X19.4 Z-20 F2 J0\nN50 G92 X19.4 Z-20 F2",
            "run-out",
            false,
        ),
    ] {
        let (text, line) = refused_start(&machine, &format!("{head}{block}\nM30\n"));
        assert!(text.contains(named), "{block}: {text}");
        assert_eq!(line.is_some(), unmoved, "{block}: {text}");
    }
}

#[test]
fn a_start_without_ramp_is_not_faster_than_the_motors_can() {
    let mut slow = proven_config();
    slow.flush_keep_speed = 500;
    let machine = LinkedMachine::for_threading(slow, tuned_settings(), &[]);
    let (text, _) = refused_start(&machine, CYCLE);
    assert!(
        text.contains("600 mm/min") && text.contains("flush_keep_speed"),
        "{text}"
    );
    let short = CYCLE.replace("S300", "S3000").replace("Z-20 F2", "Z4.5 F2");
    let (text, _) = refused_start(&ready_machine(), &short);
    assert!(text.contains("too short"), "{text}");
}

#[test]
fn the_pages_follow_the_board_and_a_hold_comes_after_the_pass() {
    let mut machine = ready_machine();
    machine.load(CYCLE, None);
    machine.start_program();
    assert!(machine.run_until(20_000, |machine| {
        machine.twin.state() == GrblState::Run
            && machine
                .twin
                .passes()
                .last()
                .is_some_and(|pass| pass.0.len() > 100)
    }));
    let mut worst = 0.0_f64;
    machine.press(FEED_HOLD);
    while machine.linked.state() == LinkState::Moving && machine.twin.passes().len() == 1 {
        machine.run_one_ms();
        let shown = machine.simulation.cnc.pulses().z.0;
        worst = worst.max((shown - machine.made_pulses()[1]).abs() as f64 / 200.0);
        if machine.twin.state() != GrblState::Run {
            break;
        }
    }
    // 10 mm/s; the board is polled every 50 ms, and its position is shown one answer later.
    assert!(worst < 1.5, "{worst} mm behind");
    machine.run_ms(5000);
    assert_eq!(machine.simulation.cnc.run_state(), RunState::Hold);
    assert_eq!(machine.twin.passes().len(), 1);
    assert_counts_agree(&machine);
    // After the thread the first move is still made: X is out of it.
    let x = machine.simulation.cnc.position_absolute().x;
    assert!((x - 15.0).abs() < 0.01, "{x}");
    machine.press(CYCLE_START);
    machine.run_to_end(600_000);
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_eq!(machine.twin.passes().len(), 3);
    assert_counts_agree(&machine);
}

#[test]
fn single_block_stops_after_each_move_of_the_cycle() {
    let mut machine = ready_machine();
    machine.load(CYCLE, None);
    machine.press(SINGLE_BLOCK);
    machine.start_program();
    for _ in 0..40 {
        machine.run_until(30_000, |machine| {
            machine.simulation.cnc.run_state() != RunState::Run
                && !machine.linked.has_pending_motion()
        });
        assert_counts_agree(&machine);
        if machine.simulation.cnc.run_state() == RunState::Reset {
            break;
        }
        machine.press(CYCLE_START);
    }
    assert_eq!(machine.simulation.cnc.run_state(), RunState::Reset);
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_eq!(machine.twin.passes().len(), 3);
}

/// The machine some time after a pass was sent.
fn machine_in_pass(ready: &LinkedMachine, ms: u32) -> LinkedMachine {
    let mut machine = ready.clone();
    machine.load(CYCLE, None);
    machine.start_program();
    assert!(machine.run_until(20_000, |machine| !machine.twin.passes().is_empty()));
    machine.run_ms(ms);
    machine
}

#[test]
fn reset_and_emergency_stop_act_in_the_pass_and_the_position_is_unknown() {
    let ready = ready_machine();
    // Waiting for the one-turn signal, and cutting. A lost command is sent again.
    for (ms, emergency, lost) in [
        (20, false, false),
        (1000, false, false),
        (1000, false, true),
        (20, true, false),
        (1000, true, false),
        (1000, true, true),
    ] {
        let mut machine = machine_in_pass(&ready, ms);
        let next = machine.twin.to_board.sent_count();
        for byte in next..next + 2 * u64::from(lost) {
            // A status request, perhaps, and the command.
            machine.twin.to_board.damage(byte, Damage::Lost);
        }
        if emergency {
            machine.simulation.lathe.set_emergency_button(true);
            machine.run_ms(50);
        } else {
            machine.simulation.cnc.set_panel_key(RESET, true);
            machine.run_ms(50);
            machine.simulation.cnc.set_panel_key(RESET, false);
        }
        machine.run_ms(if lost { 300 } else { 0 });
        let stood = machine.made_pulses();
        machine.run_ms(3000);
        assert_eq!(machine.made_pulses(), stood, "{ms} {emergency} {lost}");
        assert_eq!(machine.linked.state(), LinkState::Locked);
        assert!(!machine.linked.knows_position());
        assert!(!machine.simulation.cnc.referenced_axes().z);
        machine.simulation.lathe.set_emergency_button(false);
        machine.press(RESET);
        machine.press(AUTO);
        machine.press(CYCLE_START);
        machine.run_ms(1000);
        assert_eq!(machine.alarms(), [610]);
        assert_eq!(machine.made_pulses(), stood, "nothing starts by itself");
    }
}

#[test]
fn a_cable_out_or_a_reset_of_the_board_in_the_pass_is_a_defined_stop() {
    let ready = ready_machine();
    let mut dice = TestRandom(5);
    for round in 0..round_count(8) {
        let mut machine = machine_in_pass(&ready, dice.below(3000));
        let wire = round % 2 == 0;
        if wire {
            machine.cut_cable();
        } else {
            machine.twin.press_reset();
        }
        machine.run_ms(12_000);
        let stood = machine.made_pulses();
        // A board that restarts is silent first.
        let alarms = machine.alarms();
        let named = if wire {
            alarms == [605]
        } else {
            alarms.contains(&606)
        };
        assert!(named, "round {round}: {alarms:?}");
        assert!(!machine.linked.knows_position());
        assert!(!machine.simulation.cnc.referenced_axes().x);
        machine.reconnect_cable();
        machine.press(AUTO);
        machine.press(CYCLE_START);
        machine.run_ms(3000);
        assert_eq!(machine.made_pulses(), stood, "round {round}");
    }
}

#[test]
fn a_spindle_that_does_not_turn_is_an_alarm_and_nothing_hangs() {
    let mut machine = ready_machine();
    machine.twin.spindle_mut().blocked = true;
    machine.load(CYCLE, None);
    machine.start_program();
    machine.run_ms(20_000);
    assert_eq!(machine.alarms(), [94]);
    assert!(machine.twin.passes().is_empty());
    assert_eq!(
        machine.linked.state(),
        LinkState::Ready,
        "the place is known"
    );
    assert_counts_agree(&machine);
    assert_eq!(machine.simulation.cnc.alarms()[0].source.unwrap().line, 5);

    // Too slow for the time limit of the board.
    let mut machine = ready_machine();
    machine.twin.spindle_mut().full_speed_rpm = 500.0;
    machine.load(CYCLE, None);
    machine.start_program();
    machine.run_ms(20_000);
    assert_eq!(machine.alarms(), [94]);
    let text = machine.simulation.cnc.alarms()[0].detail_en();
    assert!(text.contains("r/min is too slow"), "{text}");
    assert!(machine.twin.passes().is_empty());
}

#[test]
fn a_spindle_that_stops_after_the_command_is_alarm_14_of_the_board() {
    let mut machine = machine_in_pass(&ready_machine(), 10);
    machine.twin.spindle_mut().blocked = true;
    let stood = machine.made_pulses();
    machine.run_ms(8000);
    assert_eq!(machine.alarms(), [94]);
    assert_eq!(machine.made_pulses(), stood);
    assert_eq!(machine.linked.state(), LinkState::Fault);
    machine.press(RESET);
    machine.run_ms(500);
    assert_eq!(machine.linked.state(), LinkState::Locked);
    assert_eq!(machine.made_pulses(), stood);

    // The board does not detect a spindle that stops in the cut: the pass continues at its
    // initial speed, and the control sees it end.
    let mut machine = machine_in_pass(&ready_machine(), 1000);
    machine.twin.spindle_mut().blocked = true;
    machine.run_until(20_000, |machine| machine.twin.state() != GrblState::Run);
    machine.run_ms(20_000);
    assert_eq!(machine.alarms(), [94], "the next pass is not begun");
    assert_eq!(machine.twin.passes().len(), 1);
    assert_counts_agree(&machine);
}

#[test]
fn a_busy_computer_does_not_disturb_a_pass() {
    let mut machine = machine_in_pass(&ready_machine(), 700);
    for pause in [150, 400, 1200] {
        machine.pause_host(pause);
        machine.run_ms(30);
    }
    machine.run_to_end(600_000);
    assert_eq!(machine.alarms(), [0_u16; 0]);
    assert_eq!(machine.twin.passes().len(), 3);
    assert_counts_agree(&machine);
}

/// One pass, and out of it.
const ONE_PASS: &str = "O1\nG50 X60 Z20\nG98 G97 S300 M03\nG00 X30 Z5\nG92 X19.4 Z-20 F2 J0\n\
    G00 X60 Z20\nM30\n";

/// The machine with its program, and the number of bytes on both wires before the pass, at its
/// command, and after it.
fn pass_byte_counts(ready: &LinkedMachine) -> ([u64; 2], [u64; 2]) {
    let mut machine = ready.clone();
    machine.load(ONE_PASS, None);
    machine.start_program();
    let given = |machine: &LinkedMachine| {
        let twin = &machine.twin;
        [twin.to_board.sent_count(), twin.to_host.sent_count()]
    };
    machine.run_until(20_000, |machine| !machine.twin.passes().is_empty());
    let begun = given(&machine);
    machine.run_to_end(60_000);
    (begun, given(&machine))
}

/// With any damage to a byte, the thread is cut with its lead, or the machine stops with an
/// alarm and nothing moves any more.
#[test]
fn a_damaged_byte_around_a_pass_ends_known_or_stopped() {
    let ready = ready_machine();
    let (begun, over) = pass_byte_counts(&ready);
    let mut dice = TestRandom(23);
    let (mut made, mut stopped) = (0, 0);
    for round in 0..round_count(16) {
        let mut machine = ready.clone();
        let damage = [
            Damage::Lost,
            Damage::Changed(1 << dice.below(4)),
            Damage::Doubled,
            Damage::Cut,
        ][dice.below(4) as usize];
        let wire = dice.below(2) as usize;
        // The command itself, and the traffic until the end.
        let from = begun[wire] - if wire == 0 { 30 } else { 0 };
        let byte = from + u64::from(dice.below((over[wire] - from) as u32));
        let twin = &mut machine.twin;
        let wires = [&mut twin.to_board, &mut twin.to_host];
        wires[wire].damage(byte, damage);
        machine.load(ONE_PASS, None);
        machine.start_program();
        let ended = machine.run_until(60_000, |machine| {
            let idle = machine.simulation.cnc.run_state() == RunState::Reset;
            !machine.alarms().is_empty() || (idle && !machine.linked.has_pending_motion())
        });
        let place = format!("{round}: {damage:?} at {byte} of wire {wire}");
        assert!(ended, "{place}: it hangs");
        machine.run_ms(20_000);
        if machine.alarms().is_empty() {
            assert_counts_agree(&machine);
            let [from, to] = [-2.0, -18.0].map(|z| turns_at(&machine, machine_z(&machine, z)));
            assert!((to[0] - from[0] - 8.0).abs() < 0.8, "{place}");
            made += 1;
        } else {
            stopped += 1;
        }
        let stood = machine.twin.pulses();
        machine.press(RESET);
        machine.run_ms(1500);
        assert_eq!(machine.twin.pulses(), stood, "{place}: it moves on");
        if machine.linked.state() == LinkState::Ready {
            assert_counts_agree(&machine);
        }
    }
    assert!(made > 0 && stopped > 0, "{made} {stopped}");
}

/// A lead that differs from the command is detected by its speed, and stopped.
#[test]
fn a_damaged_lead_is_detected_in_the_cut() {
    let ready = ready_machine();
    let (begun, _) = pass_byte_counts(&ready);
    // "K2.000000" and a line end: the 2 becomes a 3; the answers to `?` follow.
    let mut stopped = 0;
    for back in 8..14 {
        let mut machine = ready.clone();
        machine
            .twin
            .to_board
            .damage(begun[0] - back, Damage::Changed(1));
        machine.load(ONE_PASS, None);
        machine.start_program();
        machine.run_ms(30_000);
        stopped += u32::from(machine.simulation.cnc.alarms().iter().any(|alarm| {
            let text = alarm.detail_en();
            text.contains("900 mm/min instead of 600")
        }));
    }
    assert_eq!(stopped, 1);
}
