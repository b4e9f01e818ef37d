//! Carries out what acts while the reader reads it: statements of macro B, G65 H, and the
//! formulas and variables of a block.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::{Action, ProgramId, SourcePosition};
use crate::interpreter::codes::nose_radius;
use crate::interpreter::context::CompensationMode;
use crate::interpreter::flow::program_position::ProgramPosition;
use crate::interpreter::flow::{Flow, MacroEntry};
use crate::interpreter::host::Host;
use crate::interpreter::macros::macro_block;
use crate::interpreter::macros::statement::{MAX_MACRO_DEPTH, StatementEffect};
use crate::interpreter::macros::system::{self, VariableSources};
use crate::interpreter::macros::variable;
use crate::interpreter::macros::variable::ReadError;
use crate::interpreter::plan::Plan;
use crate::program::{MacroStatement, ProgramBlock, Syntax};

use super::Interpreter;
use super::block_read::{BlockRead, missing_program_alarm};

impl Interpreter {
    /// Carries out a statement of macro B at once, while the reader reads the block, and plans
    /// the flow after it.
    pub(super) fn execute_statement<H: Host>(
        &mut self,
        effect: Result<StatementEffect, ReadError>,
        source: SourcePosition,
        position: ProgramPosition,
        host: &mut H,
    ) -> Result<BlockRead, Alarm> {
        let flow = effect.and_then(|outcome| self.apply_effect(outcome, position, host));
        let flow = match flow {
            Ok(flow) => flow,
            Err(ReadError::Wait) => return Ok(BlockRead::Wait),
            Err(ReadError::Fault(alarm)) => return Err(alarm.with_source(source)),
        };
        let mut plan = Plan::new(source, self.state.modal);
        plan.after = Some(Action::Macro);
        plan.is_stop = host.parameters().macro_blocks_stop();
        plan.flow = flow;
        self.record_source(source);
        Ok(self.store_plan(plan))
    }

    /// Carries out the effect of a statement: assigns, or changes loops and modal calls.
    /// Returns the flow after the statement.
    fn apply_effect<H: Host>(
        &mut self,
        effect: StatementEffect,
        position: ProgramPosition,
        host: &mut H,
    ) -> Result<Flow, ReadError> {
        let jump_to = |block| Flow::Jump(ProgramPosition { block, ..position });
        let has_huaxing_variables = self.has_huaxing_variables;
        let levels = &mut self.current_run_mut().levels;
        match effect {
            StatementEffect::Nothing => {}
            StatementEffect::Assign(number, value) if has_huaxing_variables => {
                system::write_huaxing(number, value, host)?;
            }
            StatementEffect::Assign(number, value) => {
                system::write_variable(number, value, levels, host)?;
                if number == system::SETTINGS_VARIABLE {
                    self.set_inch_input(host.settings().inch);
                }
            }
            StatementEffect::Enter(entered) => levels.enter_loop(entered),
            StatementEffect::Repeat(first) => return Ok(jump_to(first)),
            StatementEffect::Leave(last) => return Ok(jump_to(last.saturating_add(1))),
            StatementEffect::Jump(number) => {
                return Ok(jump_to(self.find_jump_target(position, number, host)?));
            }
            StatementEffect::Call(call, arguments) => {
                self.check_macro_call()?;
                return Ok(Flow::MacroCall(Box::new(MacroEntry { call, arguments })));
            }
            StatementEffect::Modal(modal) => {
                if !levels.add_modal_call(modal, MAX_MACRO_DEPTH) {
                    let detail = say::modal_calls_too_many(MAX_MACRO_DEPTH);
                    return Err(Alarm::new(number::MODAL_CALLS).with_detail(detail).into());
                }
            }
            StatementEffect::CancelModal => levels.cancel_modal_call(),
        }
        Ok(Flow::Next)
    }

    /// Checks that nose radius compensation is off for a macro call; alarm 036 if not.
    fn check_macro_call(&self) -> Result<(), Alarm> {
        match self.compensation_mode() {
            CompensationMode::On => Err(nose_radius::call_alarm()),
            CompensationMode::Off | CompensationMode::Never => Ok(()),
        }
    }

    /// Finds the index of the block that a jump to the sequence number `p` leads to. Returns an
    /// alarm as error if it is missing.
    fn find_jump_target<H: Host>(
        &mut self,
        position: ProgramPosition,
        p: i64,
        host: &H,
    ) -> Result<u32, Alarm> {
        let program = match &self.mdi {
            Some(mdi) => &mdi.program,
            None => host
                .programs()
                .get(position.program)
                .ok_or_else(|| missing_program_alarm(position.program))?,
        };
        match position.program {
            ProgramId::Dnc => Err(Alarm::new(number::BAD_JUMP).with_detail(say::jump_in_dnc())),
            _ => self.jumps.find_target(program, position, p),
        }
    }

    /// Carries out a G65 H block at once, while the reader reads it. G65, a code of group 00,
    /// clears the stored words of G90, G92 and G94 (manual I-3.2.5.3).
    pub(super) fn execute_macro_block<H: Host>(
        &mut self,
        block: &ProgramBlock,
        source: SourcePosition,
        position: ProgramPosition,
        host: &mut H,
    ) -> Result<BlockRead, Alarm> {
        let effect = match macro_block::evaluate_macro_block(block, host) {
            Ok(outcome) => outcome,
            Err(ReadError::Wait) => return Ok(BlockRead::Wait),
            Err(ReadError::Fault(alarm)) => return Err(alarm.with_source(source)),
        };
        let mut plan = Plan::new(source, self.state.modal);
        plan.after = Some(Action::Macro);
        plan.is_stop = host.parameters().macro_blocks_stop();
        match effect {
            macro_block::MacroBlockEffect::Nothing => {}
            macro_block::MacroBlockEffect::Value(slot, value) => {
                slot.write(value, host)
                    .map_err(|alarm| alarm.with_source(source))?;
            }
            macro_block::MacroBlockEffect::Jump(p) => {
                let target = self.find_jump_target(position, p, host);
                let block = target.map_err(|alarm| alarm.with_source(source))?;
                plan.flow = Flow::Jump(ProgramPosition { block, ..position });
            }
        }
        self.state.cycle.clear_end();
        self.record_source(source);
        Ok(self.store_plan(plan))
    }
}

/// The alarm of the Huaxing lathes for a statement; `None` for an assignment, which they have.
#[cold]
pub(super) fn huaxing_alarm(statement: &MacroStatement) -> Option<Alarm> {
    let code = match statement {
        MacroStatement::Assign(_) => return None,
        MacroStatement::Call(_) => 65,
        MacroStatement::ModalCall(_) => 66,
        MacroStatement::CancelModalCall => 67,
        _ => {
            let rule = say::statement_not_of_huaxing();
            return Some(Alarm::new(number::BAD_OPERATION).with_detail(rule));
        }
    };
    Some(Alarm::new(number::BAD_G).with_detail(say::g_unknown(code)))
}

/// Copies a block with numbers in place of its variables and formulas; `None` if the block has only
/// numbers. Returns an error if a variable or formula has no value or must wait.
pub(super) fn resolve_block<H: Host>(
    block: &ProgramBlock,
    sources: Option<&VariableSources<'_>>,
    syntax: Syntax,
    host: &H,
) -> Result<Option<ProgramBlock>, ReadError> {
    match (block.formulas(), sources) {
        (Some(formulas), Some(known)) => known
            .evaluate_words(block, formulas, syntax, host)
            .map(Some),
        _ if block.has_variables() => {
            if syntax.model.record().own_variables
                && let Some(number) = block.first_variable()
            {
                return Err(system::unknown_huaxing_alarm(number.into()));
            }
            variable::resolve_variables(block.clone(), syntax, host).map(Some)
        }
        _ => Ok(None),
    }
}
