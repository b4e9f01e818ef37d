//! Chamfers and corner arcs between two straight cuts along different axes.
//!
//! ```text
//!   G01 Z-20 I5 (chamfer)        G01 Z-20 R5 (corner arc)
//!   G01 X50                      G01 X50
//!
//!         |                            |
//!         |  5, towards the            |  radius 5, tangent
//!        /   next direction           )   to both
//!   ____/ :                      ____/
//!         corner as programmed
//! ```
//!
//! I after a Z move, K after an X move and R after either are radius values, signed towards
//! the next direction. The next block moves only the other axis, in G01 or, after a chamfer,
//! in a thread code. It is at least as long as the chamfer or radius.

use gsk_messages::{Message, say};

use crate::alarm::{Alarm, number};
use crate::command::{Action, MotionCode};
use crate::interpreter::ModalState;
use crate::interpreter::codes::positioning::{current_feed, plan_line};
use crate::interpreter::codes::scale;
use crate::interpreter::context::BlockContext;
use crate::interpreter::exact::length_on_axis;
use crate::interpreter::exact::{ExactPoint, to_mm};
use crate::interpreter::moves::{FrameShift, MovePair};
use crate::interpreter::state::State;
use crate::interpreter::words::{AxisTarget, AxisWords, SortedWords};
use crate::units::Axis;

/// Whether a corner joins its two cuts by a chamfer or by a tangent arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CornerJoin {
    Chamfer,
    Arc,
}

/// Whether a block may have a corner, so that the reader must read the next block.
pub(crate) fn can_be_corner(words: &SortedWords, modal: &ModalState) -> bool {
    has_corner_words(words)
        && words.one_shot.is_none()
        && words.motion.unwrap_or(modal.motion) == MotionCode::Line
}

/// Whether a G01 block has a word of a corner (I, K or R) other than 0.
pub(crate) fn has_corner_words(words: &SortedWords) -> bool {
    [words.i, words.k, words.r]
        .into_iter()
        .flatten()
        .any(|size| size != 0)
}

/// Plans a G01 block with a corner at `corner`: the cut, and the chamfer or arc. Leaves
/// `state.position` at the end of the chamfer or arc; increments of the next block count from
/// the corner.
///
/// # Errors
/// 013 for a wrong sign or size, or a next block that does not fit.
pub(crate) fn plan(
    state: &mut State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    axes: &AxisWords,
    corner: ExactPoint,
) -> Result<MovePair, Alarm> {
    let axis = match (axes.x != AxisTarget::None, axes.z != AxisTarget::None) {
        (true, false) => Axis::X,
        (false, true) => Axis::Z,
        _ => return Err(corner_alarm(say::corner_block_moves_both_axes())),
    };
    let (join, size) = find_join_and_size(words, axis)?;
    let next_axis = axis.other();
    let length = corner.get(axis) - state.position.get(axis);
    let next_end = find_next_end(context, state, join, next_axis, corner)?;
    let next_length = next_end - corner.get(next_axis);
    let (cut_off_before, cut_off_after) = (
        length_on_axis(axis, size.abs()),
        length_on_axis(next_axis, size.abs()),
    );
    if next_length.signum() != size.signum() {
        return Err(corner_alarm(say::corner_sign_wrong()));
    }
    if length.abs() < cut_off_before || next_length.abs() < cut_off_after {
        return Err(corner_alarm(say::corner_longer_than_move(to_mm(
            size.abs(),
        ))));
    }
    let mut begin = corner;
    begin.set(axis, corner.get(axis) - length.signum() * cut_off_before);
    let mut end = corner;
    end.set(
        next_axis,
        corner.get(next_axis) + size.signum() * cut_off_after,
    );
    let join_action = match join {
        CornerJoin::Chamfer => plan_line(state, end)?,
        CornerJoin::Arc => {
            let center = begin + end - corner;
            Action::Arc {
                to: FrameShift::from_state(state).to_machine(end),
                center: FrameShift::from_state(state).to_machine(center),
                clockwise: is_arc_clockwise(axis, length, size),
                feed: current_feed(&state.modal)?,
            }
        }
    };
    let first = if begin == state.position {
        None
    } else {
        Some(plan_line(state, begin)?)
    };
    let motion = MovePair {
        first,
        second: Some(join_action),
    };
    state.move_to(axes, end);
    state.increment_offset = state.increment_offset + corner - end;
    Ok(motion)
}

/// Finds the shape and the signed size (units of [`ExactPoint`], a radius in X) of the corner after
/// a move of `axis`. Exactly one of R and the chamfer's word may be programmed. Returns an alarm as
/// error otherwise.
fn find_join_and_size(words: &SortedWords, axis: Axis) -> Result<(CornerJoin, i64), Alarm> {
    let nonzero = |size: Option<i64>| size.filter(|&size| size != 0);
    let chamfer = match axis {
        Axis::Z => (nonzero(words.i), nonzero(words.k)),
        Axis::X => (nonzero(words.k), nonzero(words.i)),
    };
    match (chamfer, nonzero(words.r)) {
        ((Some(size), None), None) => Ok((CornerJoin::Chamfer, size)),
        ((None, None), Some(size)) => Ok((CornerJoin::Arc, size)),
        _ => Err(corner_alarm(say::corner_size_word())),
    }
}

/// Finds the programmed coordinate of `axis` at the end of the next block, in units of
/// [`ExactPoint`]. Returns an alarm as error if the next block does not fit a corner.
fn find_next_end(
    context: &BlockContext<'_>,
    state: &State,
    join: CornerJoin,
    axis: Axis,
    corner: ExactPoint,
) -> Result<i64, Alarm> {
    let Some(next) = context.next else {
        return Err(corner_alarm(say::corner_without_next_block()));
    };
    let next = scale::apply_scale(next, state.scale, context.model.record());
    let motion = next.motion.unwrap_or(state.modal.motion);
    let is_thread = motion.is_thread_pass();
    let axes = next
        .axis_words(context.x_factor, corner)
        .with_incremental(next.incremental.unwrap_or(state.incremental));
    let target = axes.get(axis).resolve(corner.get(axis));
    let is_alone = axes.get(axis.other()) == AxisTarget::None;
    match target {
        Some(end)
            if is_alone && next.one_shot.is_none() && (motion == MotionCode::Line || is_thread) =>
        {
            if is_thread && join == CornerJoin::Arc {
                return Err(corner_alarm(say::corner_arc_before_thread()));
            }
            Ok(end)
        }
        _ => Err(corner_alarm(say::corner_next_block_wrong())),
    }
}

/// Whether the corner arc after a move of signed `length` along `axis` turns clockwise. The
/// sign of `size` is the direction of the next move.
const fn is_arc_clockwise(axis: Axis, length: i64, size: i64) -> bool {
    // Seen with +Z to the right and +X up: from +Z to +X is counter-clockwise.
    match axis {
        Axis::Z => (length > 0) != (size > 0),
        Axis::X => (length > 0) == (size > 0),
    }
}

fn corner_alarm(detail: Message) -> Alarm {
    Alarm::new(number::ARC_DATA).with_detail(say::corner_reason(detail))
}
