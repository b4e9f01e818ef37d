//! A fast path for blocks that only move along the contour: X or U, Z or W, the words of an
//! arc and F, under G00 to G03. Most blocks are of this form. The rules are those of
//! [`block`]; the test `a_plain_move_is_what_its_block_is` compares the two.

use crate::alarm::Alarm;
use crate::command::{Action, MotionCode};
use crate::interpreter::block;
use crate::interpreter::codes::positioning;
use crate::interpreter::context::CompensationMode;
use crate::interpreter::exact::CoordinateRange;
use crate::interpreter::state::State;
use crate::interpreter::words::motion_code::find_motion_code;
use crate::interpreter::words::{ArcWords, AxisTarget, AxisWords};
use crate::model::{GCode, ModelRecord};
use crate::program::ProgramBlock;

/// The words of a block that only moves along the contour (G00 to G03).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlainMove {
    /// The code of group 01 in force for the move, G00 to G03.
    motion: MotionCode,
    /// Whether the block contains the code of `motion`.
    has_code: bool,
    feed: Option<f64>,
    /// X and Z as written, millionths of a millimetre.
    absolute: (Option<i64>, Option<i64>),
    /// U and W as written, millionths of a millimetre.
    increment: (Option<i64>, Option<i64>),
    arc: ArcWords,
}

/// The data that determine a plain move, besides its words and the state of the interpreter.
#[derive(Clone, Copy)]
pub(crate) struct MoveContext<'a> {
    pub(crate) record: &'a ModelRecord,
    pub(crate) compensation: CompensationMode,
    /// Factor from a programmed X to a diameter: 2 under radius programming (001.2), else 1.
    pub(crate) x_factor: i64,
}

impl MoveContext<'_> {
    const fn coordinate_range(&self) -> CoordinateRange<'_> {
        CoordinateRange {
            x_factor: self.x_factor,
            record: self.record,
        }
    }
}

impl PlainMove {
    /// Reads the move of a block in millimetres. `motion` is the code of group 01 before the
    /// block. `None` if the block contains anything but a plain move or refers to variables.
    #[inline]
    pub(crate) fn from_block(
        block: &ProgramBlock,
        motion: MotionCode,
        record: &ModelRecord,
    ) -> Option<Self> {
        if !block.has_only(b"GFXUZWRIK") || block.has_variables() {
            return None;
        }
        let mut plain = Self {
            motion,
            has_code: false,
            feed: None,
            absolute: (None, None),
            increment: (None, None),
            arc: ArcWords::default(),
        };
        for word in block.words() {
            let value = word.value;
            match word.address {
                b'X' => plain.absolute.0 = Some(value.millionths()),
                b'Z' => plain.absolute.1 = Some(value.millionths()),
                b'U' => plain.increment.0 = Some(value.millionths()),
                b'W' => plain.increment.1 = Some(value.millionths()),
                b'R' => plain.arc.r = Some(value.millionths()),
                b'I' => plain.arc.i = Some(value.millionths()),
                b'K' => plain.arc.k = Some(value.millionths()),
                b'F' => plain.feed = Some(value.mm()),
                _ => {
                    plain.motion = contour_code(record.g_code(value.integer())?)?;
                    plain.has_code = true;
                }
            }
        }
        let has_motion = match plain.motion {
            // Blocks with corners read ahead.
            MotionCode::Rapid | MotionCode::Line => {
                block.has_any(b"XUZW") && !block.has_any(b"RIK")
            }
            MotionCode::ArcClockwise | MotionCode::ArcCounterclockwise => block.has_any(b"XUZWIK"),
            _ => false,
        };
        has_motion.then_some(plain)
    }

    /// Applies the move to the state and returns its action; `None` for an arc of no length.
    ///
    /// # Errors
    /// The alarm of the move. The state stays as before.
    #[inline]
    pub(crate) fn apply(
        &self,
        state: &mut State,
        context: MoveContext<'_>,
    ) -> Result<Option<Action>, Alarm> {
        let axes = self.axis_words(state, context.x_factor);
        let before = state.modal;
        state.modal.motion = self.motion;
        if let Some(feed) = self.feed {
            state.modal.feed = feed;
        }
        let end = axes.resolve_end(state.position);
        let action = positioning::check_stroke(end, context.coordinate_range()).and_then(|end| {
            match self.motion {
                MotionCode::Rapid => Ok(Some(positioning::plan_rapid(state, end))),
                MotionCode::Line => positioning::plan_line(state, end).map(Some),
                _ => block::plan_arc(state, context.compensation, context.record, self.arc, end),
            }
        });
        if !matches!(action, Ok(Some(_))) {
            state.modal = before;
            return action;
        }
        if self.has_code {
            state.cycle.clear_end();
        }
        state.move_to(&axes, end);
        state.is_threading = false;
        action
    }

    fn axis_words(&self, state: &State, x_factor: i64) -> AxisWords {
        AxisWords {
            x: AxisTarget::from_words(self.absolute.0, self.increment.0, x_factor),
            z: AxisTarget::from_words(self.absolute.1, self.increment.1, 1),
            // Increments count from the corner that a chamfer has cut off.
            base: state.position + state.increment_offset,
        }
        .with_incremental(state.incremental)
    }
}

/// The code of group 01 that moves along the contour; `None` for other codes.
fn contour_code(meaning: GCode) -> Option<MotionCode> {
    find_motion_code(meaning).filter(|code| code.is_contour())
}
