//! Finds the kind of motion that a block commands.

use crate::command::MotionCode;
use crate::interpreter::codes::arc;
use crate::interpreter::state::State;
use crate::interpreter::words::{AxisWords, OneShot, SortedWords};
use crate::model::ModelRecord;

/// The kind of motion that a block commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BlockMotion {
    Nothing,
    OneShot(OneShot),
    Rapid,
    Line,
    Arc,
    Thread,
    Tap,
    TurningCycle,
    ThreadCycle,
    FacingCycle,
}

/// The motion that the words of a block command under the code of group 01 in force.
pub(super) fn find_motion(
    state: &State,
    words: &SortedWords,
    axes: &AxisWords,
    record: &ModelRecord,
) -> BlockMotion {
    if let Some(code) = words.one_shot {
        return BlockMotion::OneShot(code);
    }
    match state.modal.motion {
        MotionCode::Rapid if axes.has_any() => BlockMotion::Rapid,
        MotionCode::Line if axes.has_any() => BlockMotion::Line,
        code if code.is_arc() && has_arc_words(words, axes, record) => BlockMotion::Arc,
        code if code.is_thread_pass() && axes.has_any() => BlockMotion::Thread,
        MotionCode::Tapping if axes.has_any() => BlockMotion::Tap,
        code if code.is_canned_cycle() => {
            let has_run_out =
                code == MotionCode::ThreadCycle && words.j.or(words.k).or(words.l).is_some();
            let is_programmed = axes.has_any() || words.r.is_some() || has_run_out;
            // An empty block repeats the cycle, and so does its bare G code.
            let is_repetition =
                (words.count == 0 || words.motion.is_some()) && state.cycle.is_set();
            match code {
                MotionCode::TurningCycle if is_programmed || is_repetition => {
                    BlockMotion::TurningCycle
                }
                MotionCode::ThreadCycle if is_programmed || is_repetition => {
                    BlockMotion::ThreadCycle
                }
                MotionCode::FacingCycle if is_programmed || is_repetition => {
                    BlockMotion::FacingCycle
                }
                _ => BlockMotion::Nothing,
            }
        }
        _ => BlockMotion::Nothing,
    }
}

/// Whether a block commands an arc: by an end point or a centre, and on some models by R alone.
fn has_arc_words(words: &SortedWords, axes: &AxisWords, record: &ModelRecord) -> bool {
    let has_center = words.i.is_some() || words.k.is_some();
    let has_circle = words.r.is_some() && arc::allows_long_arc(record);
    axes.has_any() || has_center || has_circle
}
