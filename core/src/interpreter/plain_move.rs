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
use crate::program::{PlainToken, PlainWords, address_bits};

/// The words of a block that only moves along the contour (G00 to G03).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlainMove {
    /// The code of group 01 in force for the move, G00 to G03.
    motion: MotionCode,
    /// Whether the block contains the code of `motion`.
    has_code: bool,
    feed: Option<f64>,
    x: AxisTarget,
    z: AxisTarget,
    arc: ArcWords,
    /// The sequence number of the block; `None` without one.
    pub(crate) sequence: Option<u32>,
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
    /// block. `None` if the block contains anything but a plain move, or two words for the same
    /// value.
    #[inline]
    pub(crate) fn read(
        words: &mut PlainWords<'_>,
        motion: MotionCode,
        context: MoveContext<'_>,
    ) -> Option<Self> {
        let mut plain = Self {
            motion,
            has_code: false,
            feed: None,
            x: AxisTarget::None,
            z: AxisTarget::None,
            arc: ArcWords::default(),
            sequence: None,
        };
        let mut seen = 0;
        loop {
            let word = match words.next_token() {
                PlainToken::Word(word) => word,
                PlainToken::BlockEnd => break,
                PlainToken::Other => return None,
            };
            let value = word.value.millionths();
            // X and U, Z and W, R and I or K exclude each other.
            let excluded = match word.address {
                b'X' => {
                    plain.x = AxisTarget::Absolute(value * context.x_factor);
                    address_bits(b"XU")
                }
                b'U' => {
                    plain.x = AxisTarget::Increment(value * context.x_factor);
                    address_bits(b"XU")
                }
                b'Z' => {
                    plain.z = AxisTarget::Absolute(value);
                    address_bits(b"ZW")
                }
                b'W' => {
                    plain.z = AxisTarget::Increment(value);
                    address_bits(b"ZW")
                }
                b'R' => {
                    plain.arc.r = Some(value);
                    address_bits(b"RIK")
                }
                b'I' => {
                    plain.arc.i = Some(value);
                    address_bits(b"RI")
                }
                b'K' => {
                    plain.arc.k = Some(value);
                    address_bits(b"RK")
                }
                b'F' => {
                    plain.feed = Some(word.value.mm());
                    address_bits(b"F")
                }
                b'G' => {
                    plain.motion = contour_code(context.record.g_code(word.value.integer())?)?;
                    plain.has_code = true;
                    address_bits(b"G")
                }
                // After a G code N is not a sequence number on Huaxing lathes.
                b'N' if seen == 0 => {
                    plain.sequence = Some(word.value.integer() as u32);
                    address_bits(b"N")
                }
                _ => return None,
            };
            if seen & excluded != 0 {
                return None;
            }
            seen |= address_bits(&[word.address]);
        }
        let has_motion = match plain.motion {
            // Blocks with corners read ahead.
            MotionCode::Rapid | MotionCode::Line => {
                seen & address_bits(b"XUZW") != 0 && seen & address_bits(b"RIK") == 0
            }
            _ => seen & address_bits(b"XUZWIK") != 0,
        };
        (has_motion && plain.motion.is_contour()).then_some(plain)
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
        let axes = self.axis_words(state);
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

    fn axis_words(&self, state: &State) -> AxisWords {
        AxisWords {
            x: self.x,
            z: self.z,
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
