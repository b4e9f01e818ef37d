//! G50: sets the work coordinate system (manual I-3.2.1).
//!
//! ```text
//!   X ^           no motion: the current point gets new coordinates
//!     |     o <-- X, Z: its new absolute coordinate
//!     |     :     U, W: new minus old absolute coordinate
//!     |     :     The new coordinates define the program zero.
//!     O'----+---> Z
//! ```
//!
//! A tool offset that has only shifted the coordinates so far (T without motion, or T in the
//! same block) is subtracted from the value.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::Action;
use crate::interpreter::state::State;
use crate::interpreter::words::{AxisTarget, AxisWords, SortedWords};
use crate::units::Axis;

/// Sets the work coordinates of a G50 block. Returns the new frame, or `None` for a block with
/// S only. `relative_follows` sets the relative coordinates, too.
///
/// # Errors
/// 014 for a G50 without an axis word and S.
pub(crate) fn set_coordinates(
    state: &mut State,
    words: &SortedWords,
    axes: &AxisWords,
    relative_follows: bool,
) -> Result<Option<Action>, Alarm> {
    if !axes.has_any() {
        if words.s.is_some() {
            return Ok(None);
        }
        return Err(Alarm::new(number::EMPTY_G50).with_detail(say::coordinates_without_word()));
    }
    let machine = state.to_machine(state.position);
    for axis in [Axis::X, Axis::Z] {
        let current = state.position.get(axis);
        let coordinate = match axes.get(axis) {
            AxisTarget::None => continue,
            AxisTarget::Increment(difference) => current + difference,
            AxisTarget::Absolute(value) if *state.untravelled.get(axis) => {
                value - state.offset.get(axis)
            }
            AxisTarget::Absolute(value) => value,
        };
        state.position.set(axis, coordinate);
        state.zero.set(
            axis,
            machine.get(axis) - state.offset.get(axis) - coordinate,
        );
    }
    Ok(Some(Action::Frame {
        frame: state.frame(),
        program_zero: Some(machine.to_point()),
        relative: relative_follows,
    }))
}
