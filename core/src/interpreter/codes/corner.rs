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
use crate::command::Action;
use crate::interpreter::Modal;
use crate::interpreter::codes::positioning::{feed, line};
use crate::interpreter::codes::scale;
use crate::interpreter::context::Context;
use crate::interpreter::context::exact::along;
use crate::interpreter::context::exact::{Exact, mm};
use crate::interpreter::context::moves::{Shift, Two};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{AxisWords, Target, Words};
use crate::units::Axis;

/// The shape of a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Join {
    Chamfer,
    Arc,
}

/// Whether a block may have a corner, so that the reader must read the next block.
pub(crate) fn is_possible(words: &Words, modal: &Modal) -> bool {
    is_asked(words) && words.one_shot.is_none() && words.motion.unwrap_or(modal.motion) == 1
}

/// Whether a G01 block has a word of a corner (I, K or R) other than 0.
pub(crate) fn is_asked(words: &Words) -> bool {
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
    context: &Context<'_>,
    words: &Words,
    axes: &AxisWords,
    corner: Exact,
) -> Result<Two, Alarm> {
    let axis = match (axes.x != Target::None, axes.z != Target::None) {
        (true, false) => Axis::X,
        (false, true) => Axis::Z,
        _ => return Err(fault(say::corner_block_moves_both_axes())),
    };
    let (join, size) = size(words, axis)?;
    let next_axis = axis.other();
    let length = corner.get(axis) - state.position.get(axis);
    let next_end = next_end(context, state, join, next_axis, corner)?;
    let next_length = next_end - corner.get(next_axis);
    let (before, after) = (along(axis, size.abs()), along(next_axis, size.abs()));
    if next_length.signum() != size.signum() {
        return Err(fault(say::corner_sign_wrong()));
    }
    if length.abs() < before || next_length.abs() < after {
        return Err(fault(say::corner_longer_than_move(mm(size.abs()))));
    }
    let mut begin = corner;
    begin.set(axis, corner.get(axis) - length.signum() * before);
    let mut end = corner;
    end.set(next_axis, corner.get(next_axis) + size.signum() * after);
    let joined = match join {
        Join::Chamfer => line(state, end)?,
        Join::Arc => {
            let center = begin + end - corner;
            Action::Arc {
                to: Shift::of(state).machine(end),
                center: Shift::of(state).machine(center),
                clockwise: clockwise(axis, length, size),
                feed: feed(&state.modal)?,
            }
        }
    };
    let first = if begin == state.position {
        None
    } else {
        Some(line(state, begin)?)
    };
    let motion = Two {
        first,
        second: Some(joined),
    };
    state.arrive(axes, end);
    state.ahead = state.ahead + corner - end;
    Ok(motion)
}

/// The shape and the signed size of the corner. Exactly one word fits.
fn size(words: &Words, axis: Axis) -> Result<(Join, i64), Alarm> {
    let given = |size: Option<i64>| size.filter(|&size| size != 0);
    let chamfer = match axis {
        Axis::Z => (given(words.i), given(words.k)),
        Axis::X => (given(words.k), given(words.i)),
    };
    match (chamfer, given(words.r)) {
        ((Some(size), None), None) => Ok((Join::Chamfer, size)),
        ((None, None), Some(size)) => Ok((Join::Arc, size)),
        _ => Err(fault(say::corner_size_word())),
    }
}

/// The coordinate that the next block commands on `axis`.
fn next_end(
    context: &Context<'_>,
    state: &State,
    join: Join,
    axis: Axis,
    corner: Exact,
) -> Result<i64, Alarm> {
    let Some(next) = context.next else {
        return Err(fault(say::corner_without_next_block()));
    };
    let next = scale::applied(next, state.scale, context.model.record());
    let motion = next.motion.unwrap_or(state.modal.motion);
    let thread = matches!(motion, 32 | 34);
    let axes = next
        .axes(context.x_factor, corner)
        .under(next.incremental.unwrap_or(state.incremental));
    let target = axes.get(axis).target(corner.get(axis));
    let alone = axes.get(axis.other()) == Target::None;
    match target {
        Some(end) if alone && next.one_shot.is_none() && (motion == 1 || thread) => {
            if thread && join == Join::Arc {
                return Err(fault(say::corner_arc_before_thread()));
            }
            Ok(end)
        }
        _ => Err(fault(say::corner_next_block_wrong())),
    }
}

/// Whether the corner arc from a move of signed `length` along `axis` turns clockwise.
const fn clockwise(axis: Axis, length: i64, size: i64) -> bool {
    // Seen with +Z to the right and +X up: from +Z to +X is counter-clockwise.
    match axis {
        Axis::Z => (length > 0) != (size > 0),
        Axis::X => (length > 0) == (size > 0),
    }
}

fn fault(detail: Message) -> Alarm {
    Alarm::new(number::ARC_DATA).because(say::corner_reason(detail))
}
