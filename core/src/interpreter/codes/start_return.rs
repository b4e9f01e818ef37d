//! G75 and G76 of the Huaxing lathes: return to the start of the run.
//!
//! ```text
//!   cycle start      the tool is at A: machine (a, b), work (x, z)
//!   G92 X100 Z50     makes (100, 50) the work coordinates of the start
//!   G75              rapid to machine (a, b), whatever the coordinates are now
//!   G76              rapid to work (100, 50) in the coordinates in force
//! ```

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::Action;
use crate::interpreter::codes::positioning::{self, check_stroke};
use crate::interpreter::context::BlockContext;
use crate::interpreter::state::State;
use crate::interpreter::words::{AxisWords, StartReturn};

/// Plans the rapid back to the position that the tool had at cycle start.
///
/// # Errors
/// 012 with axis words; 090 if no position of cycle start is stored or, for G75, an axis has
/// no reference.
pub(crate) fn plan(
    state: &mut State,
    context: &BlockContext<'_>,
    axes: &AxisWords,
    coordinate_system: StartReturn,
) -> Result<Action, Alarm> {
    let code = match coordinate_system {
        StartReturn::Machine => 75,
        StartReturn::Work => 76,
    };
    if axes.has_any() {
        let rule = say::dialect_decided(say::start_return_with_axis_words(code));
        return Err(Alarm::new(number::TOO_MANY_WORDS).with_detail(rule));
    }
    let Some(run_start) = state.run_start else {
        let rule = say::start_return_without_start(code);
        return Err(Alarm::new(number::ZERO_RETURN).with_detail(rule));
    };
    let is_referenced = context.referenced.x && context.referenced.z;
    if coordinate_system == StartReturn::Machine && !is_referenced {
        let rule = say::dialect_decided(say::start_return_without_reference());
        return Err(Alarm::new(number::ZERO_RETURN).with_detail(rule));
    }
    let to = match coordinate_system {
        StartReturn::Machine => run_start.machine - state.zero - state.offset,
        StartReturn::Work => run_start.work,
    };
    let to = check_stroke(to, context.coordinate_range())?;
    state.position = to;
    state.end_at_position();
    Ok(positioning::plan_rapid(state, to))
}
