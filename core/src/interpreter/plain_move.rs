//! A straight move along the axes: X or U, Z or W, perhaps F, under G00 or G01. Most
//! blocks are no more than that, and need little of what [`block`](super::block) looks
//! for. The rules are the same: `a_plain_move_is_what_its_block_is` holds one against the
//! other.

use crate::alarm::Alarm;
use crate::command::Action;
use crate::interpreter::codes::positioning;
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{AxisWords, Target};
use crate::model::{GCode, Record};
use crate::program::Block;

/// What such a block says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlainMove {
    /// G00 or G01, where it stands in the block.
    code: Option<u8>,
    feed: Option<f64>,
    /// X, U, Z and W as written, millionths of a millimetre.
    absolute: (Option<i64>, Option<i64>),
    increment: (Option<i64>, Option<i64>),
}

impl PlainMove {
    /// The move that a block in millimetres is, with the code of group 01 before it;
    /// `None` where it says anything else, or refers to variables.
    pub(crate) fn of(block: &Block, motion: u8, record: &Record) -> Option<Self> {
        if !block.has_only(b"GFXUZW") || block.has_variables() {
            return None;
        }
        let mut plain = Self {
            code: None,
            feed: None,
            absolute: (None, None),
            increment: (None, None),
        };
        for word in block.words() {
            let value = word.value;
            match word.address {
                b'X' => plain.absolute.0 = Some(value.millionths()),
                b'Z' => plain.absolute.1 = Some(value.millionths()),
                b'U' => plain.increment.0 = Some(value.millionths()),
                b'W' => plain.increment.1 = Some(value.millionths()),
                b'F' => plain.feed = Some(value.mm()),
                _ => {
                    plain.code = match record.g_code(value.integer()) {
                        Some(GCode::Rapid | GCode::StraightRapid) => Some(0),
                        Some(GCode::Line) => Some(1),
                        _ => return None,
                    }
                }
            }
        }
        let moves = block.has_any(b"XUZW") && plain.code.unwrap_or(motion) <= 1;
        moves.then_some(plain)
    }

    /// Carries it out on the state: where the tool goes.
    ///
    /// # Errors
    /// 043 for an end beyond the stroke, the alarm of a cut without feed; the state is as
    /// before then.
    pub(crate) fn action(&self, state: &mut State, x_factor: i64) -> Result<Action, Alarm> {
        let axes = self.axes(state, x_factor);
        let before = state.modal;
        if let Some(code) = self.code {
            state.modal.motion = code;
        }
        if let Some(feed) = self.feed {
            state.modal.feed = feed;
        }
        let end = axes.target(state.position);
        let action =
            positioning::within_stroke(end, x_factor).and_then(|end| match state.modal.motion {
                0 => Ok(positioning::rapid(state, end)),
                _ => positioning::line(state, end),
            });
        match action {
            Ok(_) => {
                if self.code.is_some() {
                    state.cycle.clear_end();
                }
                state.arrive(&axes, end);
                state.threading = false;
            }
            Err(_) => state.modal = before,
        }
        action
    }

    fn axes(&self, state: &State, x_factor: i64) -> AxisWords {
        // Increments count from the corner that a chamfer has cut off.
        let base = state.position + state.ahead;
        let target = |absolute, increment, factor| Target::of(absolute, increment, factor);
        AxisWords {
            x: target(self.absolute.0, self.increment.0, x_factor),
            z: target(self.absolute.1, self.increment.1, 1),
            base,
        }
        .under(state.incremental)
    }
}
