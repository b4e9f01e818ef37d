//! The state of a run over programs: the next block, the running calls, and the remaining
//! commands of the block read last.

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::command::{ControlCommand, ProgramId, SequenceNumber, SourcePosition};
use crate::interpreter::flow::program_position::{CallKind, ProgramCall, ProgramPosition};
use crate::interpreter::flow::{Finishing, Flow, MacroEntry};
use crate::interpreter::macros::levels::Levels;
use crate::interpreter::macros::statement::{MAX_MACRO_DEPTH, StatementEffect};
use crate::interpreter::macros::variable::ReadError;
use crate::interpreter::macros::variable_access::{VariableWriter, write_variable};
use crate::interpreter::moves::explanation::PassNote;
use crate::interpreter::plan::Plan;

/// The state of a run over a program and those that it calls.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct InterpreterRun {
    /// The position of the next block to read.
    #[serde(rename = "place")]
    pub(crate) position: ProgramPosition,
    /// The calls in execution, the innermost last.
    pub(crate) calls: Vec<ProgramCall>,
    /// Local variables, loops and modal calls (G66) of the running macros.
    #[serde(default, skip_serializing_if = "Levels::is_empty")]
    pub(crate) levels: Levels,
    /// The last sequence number (N) read; `None` before the first.
    pub(crate) sequence: Option<SequenceNumber>,
    /// The source position of the block read last; `None` before the first block.
    pub(crate) source: Option<SourcePosition>,
    /// The remaining commands of the block read last; `None` if all are taken.
    pub(crate) plan: Option<Plan>,
    /// The explanation data of the last cycle move of the block read last, after its commands
    /// are taken; `None` without a cycle.
    #[serde(rename = "note")]
    pub(crate) last_note: Option<PassNote>,
    /// Whether the command taken last is a move along a contour, where G41 and G42 act.
    #[serde(rename = "contour")]
    pub(crate) is_contour: bool,
    /// The profile that a G70 runs through at present; `None` outside G70.
    pub(crate) finishing: Option<Finishing>,
    /// Whether the reader waits until every command is finished, as after M00.
    #[serde(rename = "paused")]
    pub(crate) is_paused: bool,
    #[serde(rename = "ended")]
    pub(crate) has_ended: bool,
}

impl InterpreterRun {
    /// A new run that starts at the block at `position`.
    pub(crate) const fn starting_at(position: ProgramPosition) -> Self {
        Self {
            position,
            calls: Vec::new(),
            levels: Levels::new(),
            sequence: None,
            source: None,
            plan: None,
            last_note: None,
            is_contour: false,
            finishing: None,
            is_paused: false,
            has_ended: false,
        }
    }

    /// A run that has already ended and gives no command.
    pub(crate) const fn new_ended() -> Self {
        let mut run = Self::starting_at(ProgramPosition {
            program: ProgramId::External,
            block: 0,
        });
        run.has_ended = true;
        run
    }

    /// Takes the next command of the block read last; `None` if all are taken. After the last
    /// command of the block sets the position of the next one.
    #[inline]
    pub(crate) fn take_command(&mut self) -> Option<ControlCommand> {
        let plan = self.plan.as_mut()?;
        self.is_contour = plan.motion.is_contour() && !plan.is_uncompensated;
        let command = plan.take_command();
        if plan.is_done() {
            let flow = core::mem::take(&mut plan.flow);
            self.last_note = plan.pass_note();
            self.plan = None;
            self.apply_flow(flow);
        }
        command
    }

    /// Records that the block read last was only a move along the contour and that its command
    /// is taken.
    pub(crate) const fn record_plain_move(&mut self) {
        self.is_contour = true;
        self.last_note = None;
        self.position = self.position.next_block();
    }

    /// The flow after a block that moves at `position`: the call of the last G66, or the next
    /// block.
    pub(crate) fn flow_after_move(&self, position: ProgramPosition) -> Flow {
        let Some((index, modal)) = self.levels.find_modal_call(&self.calls) else {
            return Flow::Next;
        };
        let call = ProgramCall {
            program: modal.program,
            runs_left: modal.runs,
            return_position: position.next_block(),
            kind: CallKind::Modal(index),
            first_block: 0,
            block_count: None,
            codes_ordinary: false,
        };
        let arguments = modal.arguments.clone();
        Flow::MacroCall(Box::new(MacroEntry { call, arguments }))
    }

    /// Carries out the effect of a statement in the block at the position of the run: assigns,
    /// or changes loops and modal calls. Returns the flow after the statement. `find_target`
    /// finds the index of the block with a sequence number, for GOTO.
    ///
    /// # Errors
    /// The alarm of the variable or of the jump, or a variable that cannot be written yet.
    pub(crate) fn apply_effect<V: VariableWriter>(
        &mut self,
        effect: StatementEffect,
        variables: &mut V,
        find_target: impl FnOnce(&V, i64) -> Result<u32, Alarm>,
    ) -> Result<Flow, ReadError> {
        let position = self.position;
        let jump_to = |block| Flow::Jump(ProgramPosition { block, ..position });
        match effect {
            StatementEffect::Nothing => {}
            StatementEffect::Assign(number, value) => {
                write_variable(number, value, &mut self.levels, variables)?;
            }
            StatementEffect::Enter(entered) => self.levels.enter_loop(entered),
            StatementEffect::Repeat(first) => return Ok(jump_to(first)),
            StatementEffect::Leave(last) => return Ok(jump_to(last.saturating_add(1))),
            StatementEffect::Jump(number) => return Ok(jump_to(find_target(variables, number)?)),
            StatementEffect::Call(call, arguments) => {
                return Ok(Flow::MacroCall(Box::new(MacroEntry { call, arguments })));
            }
            StatementEffect::Modal(modal) => {
                if !self.levels.add_modal_call(modal, MAX_MACRO_DEPTH) {
                    let detail = say::modal_calls_too_many(MAX_MACRO_DEPTH);
                    return Err(Alarm::new(number::MODAL_CALLS).with_detail(detail).into());
                }
            }
            StatementEffect::CancelModal => self.levels.cancel_modal_call(),
        }
        Ok(Flow::Next)
    }

    /// Continues the run after a block in the way that `flow` gives.
    pub(crate) fn apply_flow(&mut self, flow: Flow) {
        match flow {
            Flow::Next => self.position = self.position.next_block(),
            Flow::Jump(place) => {
                self.levels.end_left_loops(self.calls.len(), place.block);
                self.position = place;
            }
            Flow::RunProfile(finishing) => {
                self.position = finishing.first;
                self.finishing = Some(*finishing);
            }
            Flow::Call(call) => {
                self.position = call.begin_position();
                self.calls.push(call);
            }
            Flow::MacroCall(entry) => {
                let MacroEntry { call, arguments } = *entry;
                self.position = call.begin_position();
                self.calls.push(call);
                self.levels.push_level(arguments);
            }
            Flow::RunAgain => {
                let depth = self.calls.len();
                if let Some(call) = self.calls.last_mut() {
                    self.levels.prepare_next_run(call, depth);
                    call.runs_left = call.runs_left.saturating_sub(1);
                    self.position = call.begin_position();
                }
            }
            Flow::Return(place) => {
                if let Some(call) = self.calls.pop() {
                    self.levels.pop_level(&call, self.calls.len());
                }
                // M99 P may lead out of a loop.
                self.levels.end_left_loops(self.calls.len(), place.block);
                self.position = place;
            }
            Flow::End => {
                self.calls.clear();
                self.levels = Levels::new();
                self.has_ended = true;
            }
        }
    }
}
