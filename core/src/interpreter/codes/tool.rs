//! T: tool change and offset (manual I-3.5).
//!
//! ```text
//!   T 01 02      slide = programmed point + offset
//!     |  |
//!     |  +-- offset number 00-32, 00 cancels
//!     +----- tool; if missing, only the offset changes
//! ```

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::Action;
use crate::compensation::Nose;
use crate::interpreter::context::BlockContext;
use crate::interpreter::exact::ExactPoint;
use crate::interpreter::state::State;
use crate::units::PerAxis;

/// Greatest offset number in a T word.
const MAX_OFFSET_NUMBER: u8 = 32;
/// Greatest tool number of a gang tool post (084 = 0).
const MAX_TOOL_NUMBER: u8 = 32;

/// When the tool offset of a T word takes effect in its block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OffsetExecution {
    /// The coordinates shift at once; only programmed axes move, to points in the new
    /// coordinates.
    Shift,
    /// The slide travels the change of the offset with the motion of the block.
    Travel,
    /// The offset stays, only the tool changes (G04, G02, G03).
    ToolOnly,
}

/// The tool number and the offset number of a T word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ToolWord {
    /// Tool number; `None` keeps the tool in use.
    pub(crate) tool: Option<u8>,
    /// Tool offset number; 0 cancels the offset.
    pub(crate) offset: u8,
}

impl ToolWord {
    /// Decodes the number `value` of a T word by the model's rule: four digits as in
    /// [`Self::decode`], or on the Huaxing lathes two (tool, offset) or one for both.
    ///
    /// # Errors
    /// 032 or 029 for a wrong tool, 030 for a wrong offset.
    pub(crate) fn from_block(value: i64, context: &BlockContext<'_>) -> Result<Self, Alarm> {
        let stations = context.parameters.station_count().into();
        if context.model.record().tool_digits == 4 {
            return Self::decode(value, stations);
        }
        match (value / 10, value % 10) {
            (0, tool @ 1..=8) => Self::decode(tool * 100 + tool, stations),
            (tool @ 1..=8, offset @ 0..=8) => Self::decode(tool * 100 + offset, stations),
            _ => Err(Alarm::new(number::BAD_TOOL).with_detail(say::tool_of_two_digits(value))),
        }
    }

    /// Decodes and checks the number `value` of a T word: the last two digits are the offset,
    /// those before the tool. `stations` is the number of turret stations, 0 for a gang tool
    /// post.
    ///
    /// # Errors
    /// 032 or 029 for a wrong tool, 030 for a wrong offset.
    pub(crate) fn decode(value: i64, stations: i32) -> Result<Self, Alarm> {
        let (tool, offset) = (value / 100, value % 100);
        let is_gang_post = stations == 0;
        let last_tool = if is_gang_post {
            i64::from(MAX_TOOL_NUMBER)
        } else {
            i64::from(stations)
        };
        let tool =
            match u8::try_from(tool) {
                Ok(number) if tool <= last_tool => number,
                _ if is_gang_post => {
                    return Err(Alarm::new(number::TOOL_TOO_GREAT)
                        .with_detail(say::tool_too_great(value, tool, MAX_TOOL_NUMBER)));
                }
                _ => {
                    return Err(Alarm::new(number::BAD_TOOL)
                        .with_detail(say::tool_beyond_stations(value, tool, stations)));
                }
            };
        match u8::try_from(offset) {
            Ok(offset) if offset <= MAX_OFFSET_NUMBER => Ok(Self {
                tool: (tool != 0).then_some(tool),
                offset,
            }),
            _ => Err(
                Alarm::new(number::BAD_OFFSET).with_detail(say::tool_offset_too_great(
                    value,
                    offset,
                    MAX_OFFSET_NUMBER,
                )),
            ),
        }
    }
}

/// Puts a T word into force: changes the state and appends the tool change to `actions`,
/// followed by the new frame if the offset has changed.
pub(crate) fn apply_tool_word(
    state: &mut State,
    context: &BlockContext<'_>,
    word: ToolWord,
    execution: OffsetExecution,
    actions: &mut impl Extend<Action>,
) {
    let tool = word.tool.unwrap_or(state.modal.tool);
    (state.modal.tool, state.modal.offset) = (tool, word.offset);
    state.nose = Nose::from_offset(&context.offsets.get(word.offset));
    actions.extend([Action::Tool {
        tool,
        offset: word.offset,
        is_last: false,
    }]);
    let vector = ExactPoint::from_point(
        context
            .offsets
            .slide_displacement(word.offset, context.parameters),
    );
    let has_changed = vector != state.offset;
    match execution {
        OffsetExecution::ToolOnly => return,
        OffsetExecution::Travel => {
            state.offset = vector;
            state.untravelled = PerAxis::new(false, false);
        }
        OffsetExecution::Shift => {
            state.shift_offset(vector);
            state.untravelled = PerAxis::new(true, true);
        }
    }
    if has_changed {
        actions.extend([Action::Frame {
            frame: state.frame(),
            program_zero: None,
            relative: false,
        }]);
    }
}
