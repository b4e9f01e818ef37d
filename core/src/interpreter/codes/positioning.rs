//! G00 and G01: rapid positioning and straight cuts (manual I-3.2.2.1, I-3.2.2.2).
//!
//! ```text
//!   X ^            G00: both axes at their own rapid    G01: one straight line
//!     |   B        rates, the shorter one stops first   at the resultant rate F
//!     |   |\
//!     |   | \____  the corner lies where the            Fx = dX/L * F
//!     |   |      \ faster axis arrives                  Fz = dZ/L * F
//!     +---+-------A---> Z
//! ```

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::Action;
use crate::interpreter::ModalState;
use crate::interpreter::exact::{CoordinateRange, ExactPoint, to_mm};
use crate::interpreter::state::State;
use crate::units::{Axis, Feed};

/// Plans the rapid to the programmed point `to`.
pub(crate) fn plan_rapid(state: &State, to: ExactPoint) -> Action {
    Action::Rapid {
        to: state.to_machine(to).to_point(),
    }
}

/// Plans the straight cut to the programmed point `to`, at the feed in force.
///
/// # Errors
/// 011 without a feed.
pub(crate) fn plan_line(state: &State, to: ExactPoint) -> Result<Action, Alarm> {
    Ok(Action::Line {
        to: state.to_machine(to).to_point(),
        feed: current_feed(&state.modal)?,
    })
}

/// The feed in force: per minute (mm/min) or per revolution (mm/rev).
///
/// # Errors
/// 011 without a feed.
pub(crate) fn current_feed(modal: &ModalState) -> Result<Feed, Alarm> {
    if modal.feed <= 0.0 {
        return Err(Alarm::new(number::NO_FEED).with_detail(say::feed_missing()));
    }
    if modal.feed_per_revolution {
        return Ok(Feed::PerRevolution(modal.feed));
    }
    Ok(Feed::PerMinute(modal.feed))
}

/// Returns `end` if it lies within the stroke of the control.
///
/// # Errors
/// 043 outside the stroke.
pub(crate) fn check_stroke(
    end: ExactPoint,
    reach: CoordinateRange<'_>,
) -> Result<ExactPoint, Alarm> {
    let Some(axis) = end.axis_beyond_stroke(reach) else {
        return Ok(end);
    };
    let (name, factor) = match axis {
        Axis::X => ("X", reach.x_factor),
        Axis::Z => ("Z", 1),
    };
    Err(
        Alarm::new(number::OUT_OF_RANGE).with_detail(say::motion_end_out_of_range(
            name,
            to_mm(end.get(axis) / factor),
            to_mm(reach.stroke()),
        )),
    )
}
