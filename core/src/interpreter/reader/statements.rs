//! Carries out what acts while the reader reads it: statements of macro B, G65 H, and the
//! formulas and variables of a block.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::{Action, MotionCode, ProgramId, SourcePosition};
use crate::interpreter::calls::jump::JumpTargets;
use crate::interpreter::codes::nose_radius;
use crate::interpreter::context::CompensationMode;
use crate::interpreter::flow::Flow;
use crate::interpreter::flow::program_position::ProgramPosition;
use crate::interpreter::host::Host;
use crate::interpreter::macros::macro_block;
use crate::interpreter::macros::statement::StatementEffect;
use crate::interpreter::macros::system::{self, HostVariables, VariableSources};
use crate::interpreter::macros::variable;
use crate::interpreter::macros::variable::ReadError;
use crate::interpreter::plan::Plan;
use crate::program::{MacroStatement, Program, ProgramBlock, Syntax};

use super::block_read::{BlockRead, missing_program_alarm};
use super::{Interpreter, MdiRun};

impl Interpreter {
    /// Carries out a statement of macro B at once, while the reader reads the block, and plans
    /// the flow after it.
    pub(super) fn execute_statement<H: Host>(
        &mut self,
        effect: Result<StatementEffect, ReadError>,
        source: SourcePosition,
        host: &mut H,
    ) -> Result<BlockRead, Alarm> {
        let flow = effect.and_then(|outcome| self.apply_effect(outcome, host));
        let flow = match flow {
            Ok(flow) => flow,
            Err(ReadError::Wait) => return Ok(BlockRead::Wait),
            Err(ReadError::Fault(alarm)) => return Err(alarm.with_source(source)),
        };
        let mut plan = Plan::new(source, self.state.modal);
        plan.after = Some(Action::Macro);
        plan.is_stop = host.parameters().macro_blocks_stop();
        plan.flow = flow;
        Ok(self.record_plan(plan))
    }

    /// Carries out the effect of a statement and returns the flow after it.
    fn apply_effect<H: Host>(
        &mut self,
        effect: StatementEffect,
        host: &mut H,
    ) -> Result<Flow, ReadError> {
        if matches!(effect, StatementEffect::Call(..)) {
            self.check_macro_call()?;
        }
        let sets_inch = matches!(
            effect,
            StatementEffect::Assign(system::SETTINGS_VARIABLE, _)
        );
        let (run, mdi) = match &mut self.mdi {
            Some(MdiRun { program, run }) => (run, Some(&*program)),
            None => (&mut self.main, None),
        };
        let (jumps, position) = (&mut self.jumps, run.position);
        let mut variables = HostVariables {
            has_huaxing_variables: self.has_huaxing_variables,
            host: &mut *host,
        };
        let flow = run.apply_effect(effect, &mut variables, |variables, number| {
            find_jump_target(jumps, mdi, position, number, variables.host)
        })?;
        if sets_inch {
            self.set_inch_input(host.settings().inch);
        }
        Ok(flow)
    }

    /// Checks that nose radius compensation is off for a macro call; alarm 036 if not.
    fn check_macro_call(&self) -> Result<(), Alarm> {
        match self.compensation_mode() {
            CompensationMode::On => Err(nose_radius::call_alarm()),
            CompensationMode::Off | CompensationMode::Never => Ok(()),
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
                let mdi = self.mdi.as_ref().map(|mdi| &mdi.program);
                let target = find_jump_target(&mut self.jumps, mdi, position, p, host);
                let block = target.map_err(|alarm| alarm.with_source(source))?;
                plan.flow = Flow::Jump(ProgramPosition { block, ..position });
            }
        }
        self.state.cycle.clear_end();
        Ok(self.record_plan(plan))
    }
}

/// Finds the index of the block that a jump from `position` to the sequence number `p` leads to.
/// `mdi` is the text of the MDI block, if the jump is in it. Returns an alarm as error if the
/// block is missing.
fn find_jump_target<H: Host>(
    jumps: &mut JumpTargets,
    mdi: Option<&Program>,
    position: ProgramPosition,
    p: i64,
    host: &H,
) -> Result<u32, Alarm> {
    let program = match mdi {
        Some(program) => program,
        None => host
            .programs()
            .get(position.program)
            .ok_or_else(|| missing_program_alarm(position.program))?,
    };
    match position.program {
        ProgramId::Dnc => Err(Alarm::new(number::BAD_JUMP).with_detail(say::jump_in_dnc())),
        _ => jumps.find_target(program, position, p),
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

/// Copies a block with its variables and formulas replaced by numbers; `None` if the block has only
/// numbers. `motion` is the code of group 01 in force before the block. Returns an error if a
/// variable or formula has no value or must wait.
pub(super) fn resolve_block<H: Host>(
    block: &ProgramBlock,
    sources: Option<&VariableSources<'_, H>>,
    syntax: Syntax,
    motion: MotionCode,
    host: &H,
) -> Result<Option<ProgramBlock>, ReadError> {
    match (block.formulas(), sources) {
        (Some(formulas), Some(known)) => known.evaluate_words(block, formulas, syntax).map(Some),
        _ if block.has_variables() => {
            if syntax.model.record().own_variables
                && let Some(number) = block.first_variable()
            {
                return Err(system::unknown_huaxing_alarm(number.into()));
            }
            variable::resolve_variables(block.clone(), syntax, motion, host).map(Some)
        }
        _ => Ok(None),
    }
}
