//! Restart at a block: runs the program in a copy of the machine up to the block, lists what
//! differs there from the machine now, and finds a way to the start point.
//!
//! ```text
//!   machine now --clone--> BlockSearch --stops before the block--> BlockState
//!        |                                                            |
//!        +----------------- differences, route, trial <---------------+
//!                                   |
//!                              RestartPlan --> ControlRequest::Restart
//! ```

mod block_search;
mod copy_run;
mod difference;
mod machine_functions;
mod route;
mod words;

use gsk_core::command::{ProgramId, SourcePosition};
use gsk_core::interpreter::RunningCall;
use gsk_core::operation::PreparedRestart;
use gsk_core::simulation::Simulation;
use gsk_messages::{Language, Message, say};

use crate::machining::live_part::LivePart;

pub use block_search::{BlockState, BlockWatcher, LineWatcher, find_block};
pub use difference::StateDifference;
pub use words::{RestartWord, RestartWords};

/// A prepared restart at a block, with the information that the operator needs before it.
#[derive(Clone, Debug)]
pub struct RestartPlan {
    /// The block at which the program continues.
    pub block: SourcePosition,
    /// The text of the block at which the program continues.
    pub block_text: String,
    /// The calls that lead to the block, the innermost last.
    pub calls: Vec<RunningCall>,
    /// The values that the restart changes.
    pub differences: Vec<StateDifference>,
    /// The moves to the start point of the block, one message for each action.
    pub steps: Vec<Message>,
    /// Messages about effects that the restart does not repeat.
    pub remarks: Vec<Message>,
    /// Whether a pulse board moves real slides: the operator confirms each difference then.
    pub moves_real_slides: bool,
    /// The data with which the control executes the restart.
    pub restart: Box<PreparedRestart>,
}

/// Plans the restart of the machine `now` at the block before which the copy `found` has stopped.
/// `part` is the part in the machine now; without it the way is not checked for collisions.
/// `words` are put in place of those of the program, and the way is checked with them.
///
/// # Errors
/// Why the machine cannot restart now, why a word cannot be changed, or why no way leads to the
/// start point.
pub fn plan_restart(
    now: &Simulation,
    part: Option<&LivePart>,
    found: &BlockState,
    words: &RestartWords,
) -> Result<RestartPlan, Message> {
    if let Some(why) = now.cnc.restart_state_refusal() {
        return Err(why);
    }
    let target = &found.with_words(words)?;
    let block = target.simulation.cnc.next_block();
    let block = block.ok_or_else(say::restart_block_ended)?;
    let moves_real_slides = now.cnc.has_board();
    let now = &now.trial_copy();
    let route = route::find_route(now, part, target)?;
    let mut remarks = target.remarks.clone();
    if part.is_none() {
        remarks.push(say::restart_needs_part());
    }
    let others = target.functions.others();
    remarks.extend(others.map(say::restart_machine_function));
    let text = target.simulation.cnc.programs().get(block.program);
    Ok(RestartPlan {
        block,
        block_text: text.map_or_else(String::new, |it| it.line(block.line).trim().to_owned()),
        calls: target.simulation.cnc.running_calls().collect(),
        differences: difference::find_differences(now, target, found),
        steps: route::step_messages(&route, &target.simulation),
        remarks,
        moves_real_slides,
        restart: Box::new(route::prepare(now, target, &route)?),
    })
}

impl RestartPlan {
    /// Returns the plan as lines for the operator. `program_name` names a program.
    pub fn lines(&self, program_name: impl Fn(ProgramId) -> String) -> Vec<Message> {
        let mut lines = self.block_lines(program_name);
        lines.extend(self.differences.iter().map(StateDifference::to_message));
        lines.extend(self.way_lines());
        lines
    }

    /// Returns the lines that name the block and the calls that lead to it.
    pub fn block_lines(&self, program_name: impl Fn(ProgramId) -> String) -> Vec<Message> {
        let name = program_name(self.block.program);
        let mut lines = vec![say::restart_block(name, self.block.line, &self.block_text)];
        lines.extend(self.calls.iter().rev().map(|call| {
            say::restart_call(program_name(call.caller), call.caller_line, call.runs_left)
        }));
        lines
    }

    /// Returns the code with which an operator confirms exactly these differences: eight digits,
    /// FNV-1a of their English texts.
    pub fn confirmation_code(&self) -> String {
        let lines = self.differences.iter();
        let texts = lines.map(|it| it.to_message().text(Language::En));
        let mut hash: u32 = 0x811c_9dc5;
        for byte in texts.flat_map(String::into_bytes) {
            hash = (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        }
        format!("{hash:08x}")
    }

    /// Returns the lines after the differences: the way to the start point, and what follows.
    pub fn way_lines(&self) -> Vec<Message> {
        let mut lines = vec![say::restart_same_state()];
        lines.extend(self.steps.iter().cloned());
        lines.extend(self.remarks.iter().cloned());
        lines.push(say::restart_start_again());
        lines
    }
}
