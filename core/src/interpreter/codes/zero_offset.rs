//! G54 to G57 of the Huaxing lathes: zero offsets.
//!
//! ```text
//!   G92 X100 Z50   the tip is at (100, 50): the G92 system
//!   G55 X20 Z10    its zero is moved by (20, 10): (80, 40)
//!   G56 X5 Z5      and by (5, 5) more: (75, 35)
//!   G57            the tip is at the zero: (0, 0); X, Z set other values
//!   G54            the G92 system again: (100, 50)
//! ```

use crate::command::Action;
use crate::interpreter::exact::ExactPoint;
use crate::interpreter::state::State;
use crate::interpreter::words::{AxisTarget, AxisWords, ZeroOffsetCode};
use crate::units::Axis;

/// Moves the program zero as G54 to G57 (`code`) command with the values of X and Z. Returns
/// the new frame; the axes do not move.
pub(crate) fn set_zero_offset(state: &mut State, code: ZeroOffsetCode, axes: &AxisWords) -> Action {
    for axis in [Axis::X, Axis::Z] {
        let (before, current) = (state.zero_offset.get(axis), state.position.get(axis));
        let word = match axes.get(axis) {
            AxisTarget::Absolute(value) | AxisTarget::Increment(value) => Some(value),
            AxisTarget::None => None,
        };
        let offset = match code {
            ZeroOffsetCode::Off => 0,
            ZeroOffsetCode::Absolute => word.unwrap_or(before),
            ZeroOffsetCode::Added => before.saturating_add(word.unwrap_or(0)),
            ZeroOffsetCode::Here => before
                .saturating_add(current)
                .saturating_sub(word.unwrap_or(0)),
        };
        let shift = offset.saturating_sub(before);
        state.zero_offset.set(axis, offset);
        state
            .zero
            .set(axis, state.zero.get(axis).saturating_add(shift));
        state.position.set(axis, current.saturating_sub(shift));
    }
    Action::Frame {
        frame: state.frame(),
        program_zero: None,
        relative: false,
    }
}

/// Sets the stored zero offset to 0, because G92 defines the coordinates anew.
pub(crate) fn clear_zero_offset(state: &mut State) {
    state.zero_offset = ExactPoint::default();
}
