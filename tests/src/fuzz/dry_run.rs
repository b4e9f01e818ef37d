//! Runs the interpreter alone, one timed step after another, and the preview.

use core::cell::LazyCell;
use core::mem::discriminant;

use gsk_core::alarm::Alarm;
use gsk_core::command::{Action, ControlCommand, ExecutedMove};
use gsk_core::interpreter::{ImmediateHost, Interpreter, InterpreterStep};
use gsk_core::memory::Registers;
use gsk_core::preview::{PreviewEnd, preview_beyond_alarms};
use gsk_core::setup::Setup;
use gsk_core::units::{PerAxis, Point};

use super::watch;

/// Interprets the selected program for at most `limit` steps. Returns whether the program
/// ended within them.
pub(super) fn step_through(setup: &Setup, limit: u32) -> bool {
    let Some(program) = setup.memory.programs.selected() else {
        return true;
    };
    let mut host = ImmediateHost {
        parameters: setup.memory.parameters.clone(),
        offsets: setup.memory.offsets.clone(),
        registers: Registers::new(setup.day_time),
        counters: setup.memory.counters,
        settings: setup.memory.settings,
        now_s: 0.0,
        variables: setup.memory.variables.clone(),
        inputs: LazyCell::new(Box::new(|| 0b1010)),
        outputs: 0,
        programs: &setup.memory.programs,
        machine_position: setup.start.unwrap_or_default(),
        referenced: PerAxis::new(true, true),
        block_skip: true,
    };
    let mut interpreter = Interpreter::new(&host.parameters);
    interpreter.set_macro_b(setup.memory.settings.macro_b);
    interpreter.set_model(&setup.memory.model);
    interpreter.start(program, 1, &host);
    for taken in 0..limit {
        match watch::run_unit(|| interpreter.next(&mut host)) {
            Ok(InterpreterStep::Command(command)) => {
                check_command(&command);
                if matches!(command.action, Action::End { .. } | Action::Repeat) {
                    watch::record_event("steps", watch::order_of_magnitude(taken.into()));
                    return true;
                }
            }
            Ok(InterpreterStep::Wait) => assert!(taken > 0, "it waits for a machine that stands"),
            Ok(InterpreterStep::Ended) => return true,
            Err(alarm) => {
                check_alarm(&alarm);
                interpreter.reset(&host);
                return true;
            }
        }
        if taken % 64 == 0 {
            watch::record_event("explained", interpreter.explain().is_some());
        }
    }
    false
}

fn check_command(command: &ControlCommand) {
    let end = match &command.action {
        Action::Rapid { to } | Action::Line { to, .. } | Action::Thread { to, .. } => Some(*to),
        Action::Arc { to, center, .. } => {
            assert_finite(*center);
            Some(*to)
        }
        _ => None,
    };
    if let Some(to) = end {
        assert_finite(to);
    }
    let modal = &command.modal;
    watch::record_event(
        "action",
        (
            discriminant(&command.action),
            modal.motion.number(),
            modal.nose_compensation,
            modal.feed_per_revolution,
            command.block_end,
        ),
    );
}

fn check_alarm(alarm: &Alarm) {
    let rule = watch::message_rule(&alarm.detail_en());
    watch::record_event("alarm", (alarm.number, rule));
}

fn assert_finite(point: Point) {
    assert!(
        point.x.is_finite() && point.z.is_finite(),
        "a point is {point:?}"
    );
}

/// Number of blocks without motion after which a preview is cancelled.
const MOTIONLESS_BLOCKS: u64 = 1_500_000;

/// Previews the selected program to its end, with the alarms after the first one, and checks
/// the moves.
pub(super) fn preview_all(setup: &Setup) {
    let mut moves = 0_u64;
    let mut on_move = |executed: &ExecutedMove| {
        moves += 1;
        assert_finite(executed.from);
        assert_finite(executed.to);
        if let Some(center) = executed.center {
            assert_finite(center);
        }
        assert!(
            executed.duration_s.is_finite() && executed.duration_s >= 0.0,
            "a move takes {} s",
            executed.duration_s
        );
    };
    let seen = preview_beyond_alarms(
        setup,
        &setup.memory.programs,
        &mut on_move,
        &mut |progress| progress.motionless < MOTIONLESS_BLOCKS,
    );
    assert_eq!(seen.moves, moves, "moves are counted as they are reported");
    assert_eq!(seen.end == PreviewEnd::Alarm, seen.alarm.is_some());
    assert!(seen.time_s.is_finite() && seen.time_s >= seen.cutting_s);
    for alarm in seen.alarm.iter().chain(&seen.further.alarms) {
        check_alarm(alarm);
    }
    watch::record_event("moves", watch::order_of_magnitude(moves));
}
