//! Evaluates the sorted words of a block into its plan, and audits them in a preview.

use crate::alarm::Alarm;
use crate::command::{Action, MotionCode, SourcePosition};
use crate::interpreter::block;
use crate::interpreter::codes::nose_radius::check_call;
use crate::interpreter::context::{BlockContext, CompensationMode};
use crate::interpreter::flow::Flow;
use crate::interpreter::flow::code_calls::CodeCalls;
use crate::interpreter::flow::program_position::{ProgramCall, ProgramPosition};
use crate::interpreter::host::Host;
use crate::interpreter::host::machine_codes::MachineCodes;
use crate::interpreter::macros::lookahead::{self, LookaheadReader};
use crate::interpreter::plan::Plan;
use crate::interpreter::reader::run::InterpreterRun;
use crate::interpreter::reader::word_audit::{EvaluatedBlock, WordAudit};
use crate::interpreter::state::State;
use crate::interpreter::words::SortedWords;
use crate::memory::ControlParameters;
use crate::model::ControlModel;
use crate::program::ProgramBlock;

use super::pending_block::PendingBlock;

/// A block without variables and formulas, and the data that its evaluation reads.
pub(super) struct BlockEvaluation<'a, H> {
    pub(super) pending: &'a PendingBlock<'a>,
    pub(super) block: &'a ProgramBlock,
    pub(super) words: &'a SortedWords,
    /// The words of the next block; `None` unless the block has a corner and a block follows
    /// it.
    pub(super) next: Option<&'a SortedWords>,
    /// Codes that call a program; `None` if such codes are ordinary in this block.
    pub(super) code_calls: Option<&'a CodeCalls>,
    pub(super) compensation: CompensationMode,
    pub(super) machine_codes: MachineCodes,
    pub(super) model: &'a ControlModel,
    pub(super) ahead: &'a LookaheadReader<'a, H>,
}

impl<H: Host> BlockEvaluation<'_, H> {
    /// Evaluates the block: changes `state` and fills `plan`. `audit` then searches the block
    /// for ignored words. `before` is a copy of `state` before the block.
    ///
    /// # Errors
    /// The alarm of a word. `state` and `plan` are then unusable.
    #[inline]
    pub(super) fn evaluate(
        &self,
        state: &mut State,
        before: &State,
        audit: Option<&mut WordAudit>,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        let pending = self.pending;
        let read_words = |index, motion| {
            self.ahead
                .read_words_at(index, motion)
                .map_err(lookahead::to_alarm)
        };
        let context = BlockContext {
            compensation: self.compensation,
            machine_codes: self.machine_codes,
            code_calls: self.code_calls,
            next: self.next,
            ..build_context(
                self.ahead.host,
                self.model,
                pending.source,
                pending.position,
                &pending.run.calls,
                pending.is_mdi,
                &read_words,
            )
        };
        block::evaluate(state, &context, self.words, plan)?;
        if let Some(audit) = audit {
            let evaluated = EvaluatedBlock {
                block: self.block,
                words: self.words,
                record: self.model.record(),
                before,
                after: state,
                plan,
            };
            let mut evaluate = |words: &SortedWords, state: &mut State, plan: &mut Plan| {
                block::evaluate(state, &context, words, plan)
            };
            let index = pending.position.block;
            audit.audit_block(pending.program, index, &evaluated, &mut evaluate);
        }
        plan_modal_call(pending.run, state, &context, plan)
    }
}

/// Plans the macro call that G66 makes after a block that moves, outside the profile of a G70.
/// Returns the alarm of a call that is not possible as error.
#[inline]
fn plan_modal_call(
    run: &InterpreterRun,
    state: &State,
    context: &BlockContext<'_>,
    plan: &mut Plan,
) -> Result<(), Alarm> {
    let can_call =
        run.levels.has_modal_call() && plan.motion.has_motion() && run.finishing.is_none();
    if !can_call || !matches!(plan.flow, Flow::Next) {
        return Ok(());
    }
    plan.flow = run.flow_after_move(context.position);
    match plan.flow {
        Flow::MacroCall(_) => check_call(state, context, plan.motion.is_contour()),
        _ => Ok(()),
    }
}

/// Builds the context of a block for which nose radius compensation is off and no code calls a
/// program. The caller changes these fields.
pub(super) fn build_context<'a, H: Host>(
    host: &'a H,
    model: &'a ControlModel,
    source: SourcePosition,
    position: ProgramPosition,
    calls: &'a [ProgramCall],
    mdi: bool,
    read_words: &'a dyn Fn(u32, MotionCode) -> Result<Option<SortedWords>, Alarm>,
) -> BlockContext<'a> {
    let parameters = host.parameters();
    BlockContext {
        parameters,
        model,
        offsets: host.offsets(),
        programs: host.programs(),
        referenced: host.referenced(),
        calls,
        source,
        position,
        is_mdi: mdi,
        machine_codes: MachineCodes::default(),
        code_calls: None,
        x_factor: x_factor(parameters),
        compensation: CompensationMode::Never,
        read_words,
        plan_profile_block: plan_moves,
        next: None,
    }
}

/// Evaluates the words of a block and returns the actions of its motion alone.
///
/// # Errors
/// The alarm of a word. `state` is then unusable.
fn plan_moves(
    state: &mut State,
    context: &BlockContext<'_>,
    words: &SortedWords,
) -> Result<Vec<Action>, Alarm> {
    let mut plan = Plan::new(context.source, state.modal);
    block::evaluate(state, context, words, &mut plan)?;
    let actions = core::iter::from_fn(|| plan.motion.next_action());
    Ok(actions.map(|planned| planned.action).collect())
}

/// Factor from a programmed X to a diameter: 2 under radius programming (001.2), else 1.
pub(super) fn x_factor(parameters: &ControlParameters) -> i64 {
    match parameters.is_radius_programming() {
        true => 2,
        false => 1,
    }
}
