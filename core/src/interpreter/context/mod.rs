//! What a block finds when it is read.

pub(super) mod code_calls;
pub(super) mod cycle_words;
pub(super) mod emission;
pub(super) mod exact;
pub(super) mod explanation;
pub(super) mod flow;
pub(super) mod host;
pub(super) mod machine_codes;
pub(super) mod moves;
pub(super) mod place;
pub(super) mod state;
pub(super) mod words;
pub(super) mod writes;

use crate::alarm::Alarm;
use crate::command::Source;
use crate::interpreter::context::code_calls::CodeCalls;
use crate::interpreter::context::exact::Reach;
use crate::interpreter::context::machine_codes::MachineCodes;
use crate::interpreter::context::place::{Call, Place};
use crate::interpreter::context::words::Words;
use crate::memory::{Offsets, Parameters};
use crate::model::ControlModel;
use crate::program::ProgramMemory;
use crate::units::PerAxis;

/// What a block may look at.
pub(crate) struct Context<'a> {
    pub(crate) parameters: &'a Parameters,
    /// Whose program it is.
    pub(crate) model: &'a ControlModel,
    pub(crate) offsets: &'a Offsets,
    pub(crate) programs: &'a ProgramMemory,
    pub(crate) referenced: PerAxis<bool>,
    /// Calls under way, the innermost last.
    pub(crate) calls: &'a [Call],
    pub(crate) source: Source,
    /// Where the block stands.
    pub(crate) place: Place,
    /// Whether the block was keyed in.
    pub(crate) mdi: bool,
    /// M codes of the machine's ladder.
    pub(crate) machine_codes: MachineCodes,
    /// Codes of macro B that call here; none where they are ordinary ones.
    pub(crate) code_calls: Option<&'a CodeCalls>,
    /// 2 under radius programming (001.2), else 1.
    pub(crate) x_factor: i64,
    /// The nose radius compensation before the block.
    pub(crate) compensated: Compensated,
    /// The words of any block of the program the block stands in, by its index
    /// and the code of group 01 before it; `None` for a skipped one.
    pub(crate) read: &'a dyn Fn(u32, u8) -> Result<Option<Words>, Alarm>,
    /// The words of the block that follows, for a block that needs them.
    pub(crate) next: Option<&'a Words>,
}

impl Context<'_> {
    /// How far the coordinates of the block may reach.
    pub(crate) fn reach(&self) -> Reach<'_> {
        Reach {
            x_factor: self.x_factor,
            record: self.model.record(),
        }
    }
}

/// The compensation as a block finds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Compensated {
    /// It takes no part: MDI, and the profile of a roughing cycle.
    Never,
    /// Cancel mode.
    Off,
    /// Offset mode.
    On,
}
