//! Threads that follow the index of a real spindle: every pass cuts the same groove, and none
//! is cut while the spindle does not keep its speed.

use gsk_link::LinkState;
use gsk_twins::klipper::KlipperHardware;

use super::lathe::{referenced_lathe, referenced_lathe_with};
use super::machine::{StepCut, StepMachine};
use crate::bench::keys::{CYCLE_START, FEED_HOLD, RESET};
use gsk_core::command::MotionCode;

/// A pulse of Z, mm.
const PULSE_MM: f64 = 0.005;

/// Position of the groove of a pass, mm from the first pulse of the first pass: the least and
/// the greatest of its pulses.
#[derive(Clone, Copy, Debug)]
pub struct PassGroove {
    least: f64,
    most: f64,
}

/// The passes of a lathe between two positions; `way` is the direction of its spindle.
pub fn pass_grooves(
    lathe: &StepMachine,
    lead: f64,
    between: (f64, f64),
    direction: f64,
) -> Vec<PassGroove> {
    let (_, offset) = lathe.program_offset();
    let mut passes: Vec<Vec<f64>> = Vec::new();
    let mut cutting = false;
    let mut last = i64::MAX;
    for cut in &lathe.cuts {
        let down = cut.place < last;
        // A step down has just passed the half above its position.
        let z = (cut.place as f64 + 0.5) * PULSE_MM + offset;
        last = cut.place;
        let inside = down && z > between.0 && z < between.1;
        if inside && !cutting {
            passes.push(Vec::new());
        }
        cutting = inside;
        if inside && let Some(pass) = passes.last_mut() {
            pass.push(z + lead * cut.turns * direction);
        }
    }
    let first = passes.first().and_then(|pass| pass.first().copied());
    let first = first.unwrap_or_default();
    let beside = |groove: f64| {
        let turns = (groove - first) / lead;
        (turns - turns.round()) * lead
    };
    passes
        .iter()
        .map(|pass| {
            let places: Vec<f64> = pass.iter().map(|groove| beside(*groove)).collect();
            PassGroove {
                least: places.iter().copied().fold(f64::MAX, f64::min),
                most: places.iter().copied().fold(f64::MIN, f64::max),
            }
        })
        .collect()
}

/// The greatest distance of two pulses of all passes.
pub fn groove_spread(grooves: &[PassGroove]) -> f64 {
    let most = grooves.iter().map(|groove| groove.most);
    let least = grooves.iter().map(|groove| groove.least);
    most.fold(f64::MIN, f64::max) - least.fold(f64::MAX, f64::min)
}

/// The head of a program: part zero, spindle.
pub fn program_head(spindle: &str) -> String {
    format!("O1\nG50 X40 Z5\nG98 G97 {spindle}\nG00 X30 Z5\n")
}

pub const FIVE_PASSES: &str = "G92 X29 Z-25 F2\nX28.6\nX28.3\nX28.1\nX28\nG00 X40 Z5\nM30\n";
const LONG_THREAD: &str = "G92 X29 Z-80 F2\nX28.6\nG00 X40 Z5\nM30\n";

/// A pulse, and a tenth of a micrometre. Measured: 0.05 µm at 196 r/min, 2.7 µm at 596 and 4.1
/// µm at 996. The error above 0.1 µm comes from the board's sampling of the index every 0.1
/// ms.
pub const GROOVE_TOLERANCE_MM: f64 = PULSE_MM + 0.000_1;

#[test]
fn five_passes_of_g92_meet_in_one_groove() {
    for (spindle, way, sleep) in [
        ("M03 S200", 1.0, 1),
        ("M03 S600", 1.0, 7),
        ("M03 S1000", 1.0, 3),
        ("M04 S600", -1.0, 1),
    ] {
        let mut lathe = referenced_lathe(true, &[]);
        lathe.sleep = sleep;
        lathe.start_program(&(program_head(spindle) + FIVE_PASSES));
        lathe.finish(300_000);
        assert_eq!(lathe.alarms(), [""; 0], "{spindle}");
        lathe.assert_agrees();
        let grooves = pass_grooves(&lathe, 2.0, (-24.0, -5.0), way);
        println!("{spindle}: {:.2} um", groove_spread(&grooves) * 1000.0);
        assert_eq!(grooves.len(), 5, "{spindle}");
        assert!(
            groove_spread(&grooves) <= GROOVE_TOLERANCE_MM,
            "{spindle}: {grooves:#.5?}"
        );
    }
}

/// Two starts half a turn apart, and passes that begin at arbitrary times.
#[test]
fn starts_and_passes_have_their_positions() {
    let mut lathe = referenced_lathe(true, &[]);
    let text = "G92 X29 Z-25 F2 L2\nG04 X0.777\nG92 X28.6 Z-25 F2 L2\nG04 X3.333\n\
                G92 X28.3 Z-25 F2 L2\nG00 X40 Z5\nM30\n";
    lathe.start_program(&(program_head("M03 S500") + text));
    lathe.finish(300_000);
    assert_eq!(lathe.alarms(), [""; 0]);
    lathe.assert_agrees();
    // Measured by half the lead all of them are one groove, by the lead every second.
    let all = pass_grooves(&lathe, 1.0, (-24.0, -5.0), 2.0);
    assert_eq!(all.len(), 6);
    let by_lead = pass_grooves(&lathe, 2.0, (-24.0, -5.0), 1.0);
    for (pass, groove) in by_lead.iter().enumerate() {
        let beside = (pass % 2) as f64;
        let groove_error = |place: f64| (place.abs() - beside).abs();
        let off = groove_error(groove.least).max(groove_error(groove.most));
        assert!(off <= GROOVE_TOLERANCE_MM, "{pass}: {by_lead:#?}");
    }
}

#[test]
fn g76_g32_and_g34_follow_the_index() {
    let mut lathe = referenced_lathe(true, &[]);
    lathe.start_program(
        &(program_head("M03 S600")
            + "G76 P021060 Q100 R0.1\nG76 X28 Z-25 P1000 Q400 F2\nG00 X29\n\
               G32 Z-25 F2\nG00 X32\nZ5\nG00 X40 Z5\nM30\n"),
    );
    lathe.finish(300_000);
    assert_eq!(lathe.alarms(), [""; 0]);
    lathe.assert_agrees();
    let depths = |lathe: &StepMachine| lathe.cuts.iter().map(|cut| cut.x).min();
    let (x, _) = lathe.program_offset();
    let deepest = depths(&lathe).unwrap_or_default() as f64 / 400.0 + x;
    assert!((deepest - 14.0).abs() < 0.01, "{deepest}");

    // The lead of G34 grows by 0.1 mm a turn: after n turns 2 n + 0.05 n².
    let mut lathe = referenced_lathe(true, &[(28, 3000)]);
    lathe.start_program(&(program_head("M03 S300") + "G34 Z-25 F2 R0.1\nG00 X40\nZ5\nM30\n"));
    lathe.finish(300_000);
    assert_eq!(lathe.alarms(), [""; 0]);
    lathe.assert_agrees();
    let (_, offset) = lathe.program_offset();
    let position = |cut: &StepCut| (cut.place as f64 + 0.5) * PULSE_MM + offset;
    let cut: Vec<_> = lathe
        .cuts
        .iter()
        .filter(|cut| cut.x < 6100 && (-24.0..4.9).contains(&position(cut)))
        .collect();
    let down = cut
        .windows(2)
        .take_while(|pair| pair[1].place < pair[0].place);
    let cut: Vec<_> = down.map(|pair| pair[0]).collect();
    let distance = |turns: f64| 2.0 * turns + 0.05 * turns * turns;
    let first = cut[0];
    // Turns up to the first of these pulses.
    let begun = (5.0 - position(first)) / 2.0;
    for cut in &cut {
        let turns = cut.turns - first.turns + begun;
        let off = 5.0 - distance(turns) - position(cut);
        assert!(off.abs() < 0.02, "{off} at {turns}");
    }
    assert!(cut.len() > 4000, "{}", cut.len());
}

#[test]
fn a_spindle_that_does_not_keep_its_speed_cuts_nothing() {
    let mut lathe = referenced_lathe(true, &[]);
    lathe.twin.set_speed_ripple(1.0, 0.5);
    lathe.start_program(&(program_head("M03 S600") + FIVE_PASSES));
    lathe.finish(60_000);
    let alarms = lathe.alarms();
    assert!(alarms[0].contains("091"), "{alarms:?}");
    assert!(alarms[0].contains("0.2 % are allowed"), "{alarms:?}");
    lathe.assert_agrees();
    let at = lathe.simulation.cnc.position_absolute();
    assert_eq!((at.x, at.z), (15.0, 5.0), "nothing was fed in");
}

#[test]
fn an_unsteady_spindle_spoils_one_pass_only() {
    let mut lathe = referenced_lathe(true, &[]);
    lathe.start_program(&(program_head("M03 S600") + LONG_THREAD));
    assert!(lathe.run_until(60_000, |lathe| {
        lathe.simulation.cnc.position_absolute().z < -10.0
    }));
    lathe.twin.set_speed_ripple(1.0, 0.5);
    lathe.finish(60_000);
    let alarms = lathe.alarms();
    assert!(alarms[0].contains("091"), "{alarms:?}");
    assert!(alarms[0].contains("of a turn"), "{alarms:?}");
    lathe.assert_agrees();
    // The run-out is made, the next pass is not.
    let at = lathe.simulation.cnc.position_absolute();
    assert!((at.z + 80.0).abs() < 1e-9, "{at:?}");
    assert!(at.x > 14.9, "{at:?}");
    let (x, _) = lathe.program_offset();
    let deepest = lathe.cuts.iter().map(|cut| cut.x).min().unwrap_or_default();
    assert!((deepest as f64 / 400.0 + x - 14.5).abs() < 0.01);
    // RESET, and the spindle keeps its speed again: the part is made after all.
    lathe.twin.set_speed_ripple(0.0, 0.5);
    lathe.press(RESET);
    lathe.start_program(&(program_head("M03 S600") + FIVE_PASSES));
    lathe.finish(300_000);
    assert_eq!(lathe.alarms(), [""; 0]);
    lathe.assert_agrees();
}

/// How fast the speed may change during a thread: an index then comes off the angle that was
/// predicted from the turns before it.
#[test]
fn a_speed_that_drifts_is_followed_or_spoils_the_thread() {
    /// Slow enough for a change at a steady rate within a pass, 1/s.
    const SLOW: f64 = 0.01;
    for (spindle, percent_a_second, spoilt) in [
        ("M03 S200", 0.3, false),
        ("M03 S200", 2.5, true),
        ("M03 S600", 0.5, false),
        ("M03 S600", 1.5, true),
        ("M03 S1000", 0.3, false),
        ("M03 S1000", 1.0, true),
    ] {
        let mut lathe = referenced_lathe(true, &[]);
        lathe.start_program(&(program_head(spindle) + LONG_THREAD));
        assert!(lathe.run_until(90_000, |lathe| {
            lathe.simulation.cnc.position_absolute().z < 0.0
        }));
        let pi = core::f64::consts::PI;
        lathe
            .twin
            .set_speed_ripple(percent_a_second / (2.0 * pi * SLOW), SLOW);
        lathe.run_until(60_000, |lathe| {
            lathe.simulation.cnc.position_absolute().z < -79.0
        });
        lathe.run_ms(500);
        let alarms = lathe.alarms();
        let has_alarm = alarms.iter().any(|alarm| alarm.contains("091"));
        assert_eq!(
            has_alarm, spoilt,
            "{spindle} {percent_a_second} %/s: {alarms:?}"
        );
    }
}

#[test]
fn without_an_index_the_thread_stops() {
    let mut lathe = referenced_lathe(true, &[]);
    lathe.start_program(&(program_head("M03 S600") + LONG_THREAD));
    assert!(lathe.run_until(60_000, |lathe| {
        lathe.simulation.cnc.position_absolute().z < -10.0
    }));
    lathe.twin.set_index_lost(true);
    lathe.finish(60_000);
    let alarms = lathe.alarms();
    assert!(
        alarms[0].contains("091") && alarms[0].contains("io.index"),
        "{alarms:?}"
    );
    lathe.assert_agrees();
    // Two turns and the time of a report, ahead by the lookahead.
    let at = lathe.simulation.cnc.position_absolute();
    assert!((-22.0..-14.0).contains(&at.z), "{at:?}");
    // The next one does not begin.
    lathe.press(RESET);
    lathe.start_program("O1\nG98 G97 M03 S600\nG92 X29 Z-25 F2\nM30\n");
    lathe.finish(60_000);
    assert!(lathe.alarms()[0].contains("094"), "{:?}", lathe.alarms());
}

#[test]
fn feed_hold_in_a_thread_stops_after_its_retract() {
    let mut lathe = referenced_lathe(true, &[]);
    // So deep that the run-out alone does not lead out of it.
    lathe.start_program(
        &(program_head("M03 S600") + &LONG_THREAD.replace("X28.6", "X25.8").replace("X29", "X26")),
    );
    assert!(lathe.run_until(60_000, |lathe| {
        lathe.simulation.cnc.position_absolute().z < -10.0
    }));
    lathe.press(FEED_HOLD);
    lathe.finish(60_000);
    lathe.assert_agrees();
    let at = lathe.simulation.cnc.position_absolute();
    assert!(
        (at.x - 15.0).abs() < 1e-9 && (at.z + 80.0).abs() < 1e-9,
        "{at:?}"
    );
    lathe.press(CYCLE_START);
    lathe.finish(300_000);
    assert_eq!(lathe.alarms(), [""; 0]);
    lathe.assert_agrees();
    let grooves = pass_grooves(&lathe, 2.0, (-78.0, -5.0), 1.0);
    assert_eq!(grooves.len(), 2);
    assert!(
        groove_spread(&grooves) <= GROOVE_TOLERANCE_MM,
        "{grooves:#?}"
    );
}

#[test]
fn reset_in_a_thread_stops_at_once_and_the_position_is_known() {
    let mut lathe = referenced_lathe(true, &[]);
    lathe.start_program(&(program_head("M03 S100") + LONG_THREAD));
    assert!(lathe.run_until(60_000, |lathe| {
        lathe.simulation.cnc.position_absolute().z < -10.0
    }));
    lathe.press(RESET);
    lathe.finish(60_000);
    lathe.assert_agrees();
    assert!(lathe.linked.knows_position());
    let at = lathe.simulation.cnc.position_absolute();
    assert!((-10.5..-9.0).contains(&at.z), "{at:?}");
}

#[test]
fn a_cut_per_revolution_goes_at_the_measured_speed() {
    let mut lathe = referenced_lathe(true, &[]);
    lathe.start_program("O1\nG50 X40 Z5\nG97 M03 S600\nG00 X30 Z5\nG99 G01 Z-35 F0.1\nG98\nM30\n");
    assert!(lathe.run_until(60_000, |lathe| {
        lathe.simulation.cnc.position_absolute().z < -5.0
    }));
    let rpm = lathe.twin.spindle_rpm();
    let shown = lathe.simulation.cnc.spindle().actual_rpm();
    assert!((shown - rpm).abs() < 0.5, "{shown} of {rpm}");
    let feed = lathe.simulation.cnc.feed_actual();
    assert!((feed - 0.1 * rpm).abs() < 0.1, "{feed} at {rpm}");
    lathe.finish(60_000);
    assert_eq!(lathe.alarms(), [""; 0]);
    lathe.assert_agrees();
}

#[test]
fn what_needs_an_index_names_its_setting() {
    for (block, what) in [
        ("G92 X29 Z-25 F2", "io.index"),
        ("G99 G01 Z-5 F0.1", "io.index"),
    ] {
        let mut lathe = referenced_lathe(false, &[]);
        lathe.start_program(&(program_head("M03 S600") + block + "\nM30\n"));
        lathe.finish(10_000);
        let alarms = lathe.alarms();
        assert!(
            alarms[0].contains("604") && alarms[0].contains(what),
            "{alarms:?}"
        );
    }
    let mut lathe = referenced_lathe(true, &[]);
    lathe.start_program(&(program_head("M03 S600") + "G33 Z-5 F1\nM30\n"));
    lathe.finish(10_000);
    let alarms = lathe.alarms();
    assert!(
        alarms[0].contains("604") && alarms[0].contains("reverses"),
        "{alarms:?}"
    );
}

/// The computer is busy for up to 80 ms now and then, and the clock of the board is off. A
/// pause may coincide with the start of a pass.
#[test]
fn a_busy_computer_and_a_fast_board_cut_the_same_groove() {
    // BEGINS=N tries N moments, 7 ms apart.
    let begins = std::env::var("BEGINS").map_or(2, |begins| begins.parse().unwrap());
    for begin in 0..begins {
        check_busy_and_fast(7 * begin);
    }
}

fn check_busy_and_fast(begin: u32) {
    let mut lathe = referenced_lathe_with(
        KlipperHardware {
            clock_error_ppm: 100,
            ..KlipperHardware::default()
        },
        true,
        &[],
    );
    lathe.run_ms(begin);
    lathe.start_program(&(program_head("M03 S600") + FIVE_PASSES));
    let mut away = 0;
    for _ in 0..40 {
        away = (away + 37) % 80;
        lathe.pause_host(away);
        lathe.run_ms(431);
    }
    lathe.finish(60_000);
    assert_eq!(lathe.alarms(), [""; 0], "{begin}");
    lathe.assert_agrees();
    let grooves = pass_grooves(&lathe, 2.0, (-24.0, -5.0), 1.0);
    assert_eq!(grooves.len(), 5);
    // The speed changes of the spindle between two samples of its index are learned again.
    let poll = 600.0 / 60.0 * 0.0001 * 2.0;
    assert!(
        groove_spread(&grooves) <= GROOVE_TOLERANCE_MM + poll,
        "{begin}: {grooves:#?}"
    );
}

/// A spark on the wire of the index during a pass: that pass is spoilt, no later one.
#[test]
fn a_spark_on_the_index_is_found() {
    let mut lathe = referenced_lathe(true, &[]);
    lathe.start_program(&(program_head("M03 S600") + LONG_THREAD));
    assert!(lathe.run_until(60_000, |lathe| {
        lathe.simulation.cnc.position_absolute().z < -10.0
    }));
    lathe.twin.set_index_stuck_high(true);
    lathe.run_ms(1);
    lathe.twin.set_index_stuck_high(false);
    lathe.finish(60_000);
    assert!(lathe.alarms()[0].contains("091"), "{:?}", lathe.alarms());
    lathe.assert_agrees();
    let at = lathe.simulation.cnc.position_absolute();
    assert!((at.z + 80.0).abs() < 1e-9 && at.x > 14.9, "{at:?}");
}

/// A thread that waits for its index can be cancelled, and the axes continue from their
/// position.
#[test]
fn reset_while_a_thread_waits_for_its_index() {
    let mut lathe = referenced_lathe(true, &[]);
    // 23 r/min: it waits for more than a second on average.
    lathe.start_program(&(program_head("M03 S30") + "G00 X29\nG32 Z-25 F2\nG00 X40\nM30\n"));
    assert!(lathe.run_until(120_000, |lathe| {
        let at = lathe.simulation.cnc.position_absolute();
        at.x == 14.5 && lathe.simulation.cnc.modal().motion == MotionCode::Thread
    }));
    lathe.run_ms(300);
    let at = lathe.simulation.cnc.position_absolute();
    assert_eq!((at.x, at.z), (14.5, 5.0));
    assert!(
        lathe.linked.has_pending_motion(),
        "time goes on in the board"
    );
    lathe.press(RESET);
    lathe.run_ms(3000);
    assert_eq!(lathe.alarms(), [""; 0]);
    let at = lathe.simulation.cnc.position_absolute();
    assert_eq!((at.x, at.z), (14.5, 5.0));
    assert_eq!(lathe.linked.state(), LinkState::Ready);
    lathe.assert_agrees();
    lathe.start_program("O1\nG98 G00 X40\nG01 X30 F500\nM30\n");
    lathe.finish(60_000);
    assert_eq!(lathe.alarms(), [""; 0]);
    lathe.assert_agrees();
}
