//! The data that the evaluation of a block reads: state, words, machine and calls.

use crate::alarm::Alarm;
use crate::command::{Action, MotionCode, SourcePosition};
use crate::interpreter::exact::CoordinateRange;
use crate::interpreter::flow::call_context::CallContext;
use crate::interpreter::flow::code_calls::CodeCalls;
use crate::interpreter::flow::program_position::{ProgramCall, ProgramPosition};
use crate::interpreter::host::machine_codes::MachineCodes;
use crate::interpreter::state::State;
use crate::interpreter::words::SortedWords;
use crate::memory::{ControlParameters, Offsets};
use crate::model::ControlModel;
use crate::program::ProgramMemory;
use crate::units::PerAxis;

/// Evaluates the words of a block: updates the state and returns the moves.
pub(crate) type ProfileBlockPlanner =
    fn(&mut State, &BlockContext<'_>, &SortedWords) -> Result<Vec<Action>, Alarm>;

/// Greatest sequence number that P of M99 can name.
const LAST_RETURN_TARGET: u32 = 65_535;

/// The data that the evaluation of a block reads besides the words of the block and the state.
pub(crate) struct BlockContext<'a> {
    pub(crate) parameters: &'a ControlParameters,
    /// The control model that the program is for.
    pub(crate) model: &'a ControlModel,
    pub(crate) offsets: &'a Offsets,
    pub(crate) programs: &'a ProgramMemory,
    pub(crate) referenced: PerAxis<bool>,
    /// The calls in execution, the innermost last.
    pub(crate) calls: &'a [ProgramCall],
    pub(crate) source: SourcePosition,
    /// The program of the block, and its index.
    pub(crate) position: ProgramPosition,
    /// Whether the operator entered the block on the MDI page.
    pub(crate) is_mdi: bool,
    /// The M codes that the machine's ladder carries out.
    pub(crate) machine_codes: MachineCodes,
    /// Codes that call a program by parameters of macro B; `None` if they are ordinary codes
    /// in this program.
    pub(crate) code_calls: Option<&'a CodeCalls>,
    /// Factor from a programmed X to a diameter: 2 under radius programming (001.2), else 1.
    pub(crate) x_factor: i64,
    /// The mode of the nose radius compensation before the block.
    pub(crate) compensation: CompensationMode,
    /// Reads the words of a block of this program, by its index and the code of group 01
    /// before it; `None` for a skipped block.
    pub(crate) read_words: &'a dyn Fn(u32, MotionCode) -> Result<Option<SortedWords>, Alarm>,
    /// Plans the moves of a block in the profile of a cycle. A function, because a profile is
    /// part of a block itself.
    pub(crate) plan_profile_block: ProfileBlockPlanner,
    /// The words of the next block; `None` unless the block has a corner and a block follows
    /// it.
    pub(crate) next: Option<&'a SortedWords>,
}

impl BlockContext<'_> {
    /// Returns the data that determine the greatest coordinate that the block may command.
    pub(crate) fn coordinate_range(&self) -> CoordinateRange<'_> {
        CoordinateRange {
            x_factor: self.x_factor,
            record: self.model.record(),
        }
    }

    /// Returns the data on which calls and returns of the block depend.
    pub(crate) const fn call_context(&self) -> CallContext<'_> {
        CallContext {
            programs: self.programs,
            calls: self.calls,
            position: self.position,
            last_target: LAST_RETURN_TARGET,
        }
    }
}

/// The mode of the nose radius compensation before a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CompensationMode {
    /// The compensation does not act: MDI, and the profile of a roughing cycle.
    Never,
    /// Cancel mode: the tool nose centre is not offset from the programmed path.
    Off,
    /// Offset mode: the tool nose centre is offset from the programmed path.
    On,
}
