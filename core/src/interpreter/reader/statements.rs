//! Carries out what acts while the reader reads it: statements of macro B, G65 H, and the
//! formulas and variables of a block.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::{Action, ProgramId, Source};
use crate::interpreter::codes::nose_radius;
use crate::interpreter::context::Compensated;
use crate::interpreter::context::flow::{Flow, MacroEntry};
use crate::interpreter::context::host::Host;
use crate::interpreter::context::place::Place;
use crate::interpreter::macros::macro_block;
use crate::interpreter::macros::statement::{MACRO_LEVELS, Outcome};
use crate::interpreter::macros::system::{self, Known};
use crate::interpreter::macros::variable;
use crate::interpreter::macros::variable::NotNow;
use crate::interpreter::plan::Plan;
use crate::program::{Block, Statement, Syntax};

use super::Interpreter;
use super::read::{Read, missing};

impl Interpreter {
    /// Carries out a statement of macro B while the reader reads it.
    pub(super) fn follow_statement<H: Host>(
        &mut self,
        outcome: Result<Outcome, NotNow>,
        source: Source,
        place: Place,
        host: &mut H,
    ) -> Result<Read, Alarm> {
        let outcome = outcome.and_then(|outcome| self.take_up(outcome, place, host));
        let flow = match outcome {
            Ok(flow) => flow,
            Err(NotNow::Wait) => return Ok(Read::Wait),
            Err(NotNow::Fault(alarm)) => return Err(alarm.at(source)),
        };
        let mut plan = Plan::new(source, self.state.modal);
        plan.after = Some(Action::Macro);
        plan.stops = host.parameters().macro_blocks_stop();
        plan.flow = flow;
        self.note(source);
        Ok(self.planned(plan))
    }

    /// Applies the effect of a statement and returns the flow after it.
    fn take_up<H: Host>(
        &mut self,
        outcome: Outcome,
        place: Place,
        host: &mut H,
    ) -> Result<Flow, NotNow> {
        let to = |block| Flow::Jump(Place { block, ..place });
        let counted = self.own_variables;
        let levels = &mut self.run_mut().levels;
        match outcome {
            Outcome::Nothing => {}
            Outcome::Assign(number, value) if counted => {
                system::write_counted(number, value, host)?;
            }
            Outcome::Assign(number, value) => {
                system::write(number, value, levels, host)?;
                if number == system::SETTINGS {
                    self.set_inch_input(host.settings().inch);
                }
            }
            Outcome::Enter(entered) => levels.enter_loop(entered),
            Outcome::Repeat(first) => return Ok(to(first)),
            Outcome::Leave(last) => return Ok(to(last.saturating_add(1))),
            Outcome::Goto(number) => return Ok(to(self.jump_target(place, number, host)?)),
            Outcome::Call(call, arguments) => {
                self.check_macro_call()?;
                return Ok(Flow::MacroCall(Box::new(MacroEntry { call, arguments })));
            }
            Outcome::Modal(modal) => {
                if !levels.add_modal(modal, MACRO_LEVELS) {
                    let detail = say::modal_calls_too_many(MACRO_LEVELS);
                    return Err(Alarm::new(number::MODAL_CALLS).because(detail).into());
                }
            }
            Outcome::CancelModal => levels.cancel_modal(),
        }
        Ok(Flow::Next)
    }

    /// Checks that no macro is called under nose radius compensation.
    fn check_macro_call(&self) -> Result<(), Alarm> {
        match self.compensated() {
            Compensated::On => Err(nose_radius::call_fault()),
            Compensated::Off | Compensated::Never => Ok(()),
        }
    }

    /// The block that a jump to a sequence number leads to.
    fn jump_target<H: Host>(&mut self, place: Place, p: i64, host: &H) -> Result<u32, Alarm> {
        let program = match &self.mdi {
            Some(mdi) => &mdi.program,
            None => host
                .programs()
                .get(place.program)
                .ok_or_else(|| missing(place.program))?,
        };
        match place.program {
            ProgramId::Dnc => Err(Alarm::new(number::BAD_JUMP).because(say::jump_in_dnc())),
            _ => self.jumps.target(program, place, p),
        }
    }

    /// Carries out a G65 H block while the reader reads it. As a code of group 00 it clears
    /// the stored words of G90, G92 and G94 (manual I-3.2.5.3).
    pub(super) fn operate<H: Host>(
        &mut self,
        block: &Block,
        source: Source,
        place: Place,
        host: &mut H,
    ) -> Result<Read, Alarm> {
        let outcome = match macro_block::evaluate(block, host) {
            Ok(outcome) => outcome,
            Err(NotNow::Wait) => return Ok(Read::Wait),
            Err(NotNow::Fault(alarm)) => return Err(alarm.at(source)),
        };
        let mut plan = Plan::new(source, self.state.modal);
        plan.after = Some(Action::Macro);
        plan.stops = host.parameters().macro_blocks_stop();
        match outcome {
            macro_block::Outcome::Nothing => {}
            macro_block::Outcome::Value(slot, value) => {
                slot.write(value, host).map_err(|alarm| alarm.at(source))?;
            }
            macro_block::Outcome::Jump(p) => {
                let target = self.jump_target(place, p, host);
                let block = target.map_err(|alarm| alarm.at(source))?;
                plan.flow = Flow::Jump(Place { block, ..place });
            }
        }
        self.state.cycle.clear_end();
        self.note(source);
        Ok(self.planned(plan))
    }
}

/// The alarm of the Huaxing lathes for a statement other than an assignment.
#[cold]
pub(super) fn refused_by_huaxing(statement: &Statement) -> Option<Alarm> {
    let code = match statement {
        Statement::Assign(_) => return None,
        Statement::Call(_) => 65,
        Statement::ModalCall(_) => 66,
        Statement::CancelModalCall => 67,
        _ => {
            let rule = say::statement_not_of_huaxing();
            return Some(Alarm::new(number::BAD_OPERATION).because(rule));
        }
    };
    Some(Alarm::new(number::BAD_G).because(say::g_unknown(code)))
}

/// A copy of a block with numbers in place of its variables and formulas; `None` if it has
/// numbers only.
pub(super) fn resolve<H: Host>(
    block: &Block,
    known: Option<&Known<'_>>,
    syntax: Syntax,
    host: &H,
) -> Result<Option<Block>, NotNow> {
    match (block.formulas(), known) {
        (Some(formulas), Some(known)) => known.words(block, formulas, syntax, host).map(Some),
        _ if block.has_variables() => {
            if syntax.model.record().own_variables
                && let Some(number) = block.first_variable()
            {
                return Err(system::unknown_there(number.into()));
            }
            variable::resolve(block.clone(), syntax, host).map(Some)
        }
        _ => Ok(None),
    }
}
