//! Runs programs of a model with other codes than the lathe's: finds the next block and
//! carries out loops, jumps, calls and formulas. The caller carries out the words of a block.
//!
//! ```text
//!   Walker::next --> words of a block --> the caller carries them out --> call, return, end
//!      |                                                                       |
//!      +--- statements of macro B are carried out here <-----------------------+
//! ```
//!
//! Run, calls, returns and statements are those of the [`Interpreter`](super::Interpreter).

use crate::alarm::Alarm;
use crate::command::{ProgramId, SourcePosition};
use crate::interpreter::calls::jump::JumpTargets;
use crate::interpreter::calls::subprogram;
use crate::interpreter::flow::call_context::CallContext;
use crate::interpreter::flow::code_calls::{CodeCalls, PlainCall, are_ordinary};
use crate::interpreter::flow::program_position::{CallKind, ProgramCall, ProgramPosition};
use crate::interpreter::flow::{Flow, MacroEntry};
use crate::interpreter::macros::formula;
use crate::interpreter::macros::lookahead::to_alarm;
use crate::interpreter::macros::statement::{self, StatementEffect};
use crate::interpreter::macros::variable::ReadError;
use crate::interpreter::macros::variable_access::{
    VariableReader, VariableWriter, with_formula_context,
};
use crate::model::ControlModel;
use crate::program::{BlockCache, ProgramBlock, ProgramMemory, Syntax};

use super::block_read::missing_program_alarm;
use super::pending_block::PendingBlock;
use super::run::InterpreterRun;

/// The result of one call of [`Walker::next`].
#[derive(Clone, Debug, PartialEq)]
pub enum WalkedBlock {
    /// The words of a block, which the caller carries out; formulas are replaced by numbers.
    Words(Box<ProgramBlock>),
    /// The caller has nothing to do: the walker has carried out a statement of macro B, skipped
    /// the block or returned from a call.
    Nothing,
    /// The run has ended; no further block follows.
    Ended,
}

/// A block that was read and not carried out yet.
enum ReadBlock {
    Words(Box<ProgramBlock>),
    Statement(StatementEffect),
    Nothing,
}

/// A run over a program and those that it calls.
#[derive(Clone, Debug)]
pub struct Walker {
    /// The run, positioned at the block that was read last.
    run: InterpreterRun,
    /// The flow after the block read last; `None` before the first block.
    flow: Option<Flow>,
    jumps: JumpTargets,
    recent: BlockCache,
    code_calls: Option<Box<CodeCalls>>,
}

/// Greatest sequence number that P of M99 can name.
const LAST_RETURN_TARGET: u32 = 99_999;

impl Walker {
    /// A new run that begins at the first block of a program. The parameters of `model` make
    /// G, M and T codes call a program.
    pub fn new(program: ProgramId, model: &ControlModel) -> Self {
        Self {
            run: InterpreterRun::starting_at(ProgramPosition { program, block: 0 }),
            flow: None,
            jumps: JumpTargets::default(),
            recent: BlockCache::default(),
            code_calls: CodeCalls::from_model(model),
        }
    }

    /// The source position of the block read last; after the end of a text that of its last
    /// block.
    pub fn source(&self, programs: &ProgramMemory) -> SourcePosition {
        let ProgramPosition { program, block } = self.run.position;
        let line = programs.get(program).map_or(0, |text| {
            text.block_line(block.min(text.block_count().saturating_sub(1)))
        });
        SourcePosition {
            program,
            line,
            sequence: self.run.sequence,
        }
    }

    /// Returns the program that contains the block that was read last.
    pub const fn current_program(&self) -> ProgramId {
        self.run.position.program
    }

    /// Reads the next block. `is_skipping` skips blocks marked `/`; `variables` stores the
    /// variables above #33.
    ///
    /// # Errors
    /// The alarm of the block's syntax or of its statement. The next call continues with the
    /// block after it.
    pub fn next(
        &mut self,
        programs: &ProgramMemory,
        syntax: Syntax,
        is_skipping: bool,
        variables: &mut (impl VariableReader + VariableWriter),
    ) -> Result<WalkedBlock, Alarm> {
        if let Some(flow) = self.flow.take() {
            self.run.apply_flow(flow);
        }
        let position = self.run.position;
        if self.run.has_ended {
            return Ok(WalkedBlock::Ended);
        }
        let program = programs.get(position.program);
        let program = program.ok_or_else(|| missing_program_alarm(position.program))?;
        if position.block >= program.block_count() {
            if self.run.calls.is_empty() {
                self.run.has_ended = true;
                return Ok(WalkedBlock::Ended);
            }
            self.plan_return(programs, None)?;
            return Ok(WalkedBlock::Nothing);
        }
        self.flow = Some(Flow::Next);
        // Taken out of `self`, which the block borrows.
        let mut recent = core::mem::take(&mut self.recent);
        let mut pending = PendingBlock::new((program, &self.run), syntax, false, is_skipping);
        pending.locate_unparsed();
        let sequence = pending.source.sequence;
        let read = self.read_block(pending, &mut recent, programs, &*variables);
        self.recent = recent;
        self.run.sequence = sequence;
        match read.map_err(to_alarm)? {
            ReadBlock::Words(words) => Ok(WalkedBlock::Words(words)),
            ReadBlock::Nothing => Ok(WalkedBlock::Nothing),
            ReadBlock::Statement(effect) => {
                let find_target = |_: &_, number| {
                    let jumps = &mut self.jumps;
                    jumps.find_target(program, position, number)
                };
                let flow = self.run.apply_effect(effect, variables, find_target);
                self.flow = Some(flow.map_err(to_alarm)?);
                Ok(WalkedBlock::Nothing)
            }
        }
    }

    /// Reads a block without changing anything. Returns an alarm as error if the block is
    /// invalid.
    fn read_block(
        &self,
        mut pending: PendingBlock<'_>,
        recent: &mut BlockCache,
        programs: &ProgramMemory,
        variables: &impl VariableReader,
    ) -> Result<ReadBlock, ReadError> {
        if pending.is_unparsed_skipped() {
            return Ok(ReadBlock::Nothing);
        }
        let calls = pending.active_code_calls(self.code_calls.as_deref());
        if let Some(calls) = calls
            && let Some(call) = pending.find_code_call(calls)?
        {
            let effect = pending.evaluate_code_call(&call, programs, variables)?;
            return Ok(ReadBlock::Statement(effect));
        }
        let block = recent.read(pending.program, pending.position.block, pending.syntax)?;
        if pending.is_without_effect(block) {
            return Ok(ReadBlock::Nothing);
        }
        if let Some(statement) = block.macro_statement() {
            let effect = pending.evaluate_statement(statement, programs, variables)?;
            return Ok(ReadBlock::Statement(effect));
        }
        let words = match block.formulas() {
            Some(formulas) => with_formula_context(&self.run.levels, variables, |context| {
                formula::evaluate_words(block, formulas, pending.syntax, context)
            })?,
            None => block.clone(),
        };
        Ok(ReadBlock::Words(Box::new(words)))
    }

    /// Returns the data on which calls and returns of the block that was read last depend.
    fn call_context<'a>(&'a self, programs: &'a ProgramMemory) -> CallContext<'a> {
        CallContext {
            programs,
            calls: &self.run.calls,
            position: self.run.position,
            last_target: LAST_RETURN_TARGET,
        }
    }

    /// Calls the subprogram with the number `program` after the block read last, `runs` times.
    /// `name` is the calling code, for messages.
    ///
    /// # Errors
    /// 077 for calls that are too deep, 078 for a missing program.
    pub fn call(
        &mut self,
        programs: &ProgramMemory,
        program: i64,
        runs: u16,
        name: &str,
    ) -> Result<(), Alarm> {
        let context = self.call_context(programs);
        let call = subprogram::new_call(&context, CallKind::Subprogram, program, runs, &name)?;
        self.flow = Some(Flow::Call(call));
        Ok(())
    }

    /// The subprogram that the M code `m` or the T code `t` calls by parameters, as M98 does;
    /// `None` if neither calls.
    pub fn find_called_subprogram(&self, m: Option<i64>, t: Option<i64>) -> Option<PlainCall> {
        let m = m.and_then(|code| u16::try_from(code).ok());
        let calls = self.code_calls.as_deref();
        calls
            .filter(|_| !are_ordinary(&self.run.calls))?
            .find_subprogram_by_number(m, t)
    }

    /// Makes a call found by [`Self::find_called_subprogram`], `runs` times. In the called
    /// program such codes are ordinary and call nothing.
    ///
    /// # Errors
    /// As for [`Self::call`].
    pub fn call_by_code(
        &mut self,
        programs: &ProgramMemory,
        call: &PlainCall,
        runs: u16,
    ) -> Result<(), Alarm> {
        let name = format_args!("{}{:02}", call.address, call.code);
        let context = self.call_context(programs);
        let kind = CallKind::Subprogram;
        let called = subprogram::new_call(&context, kind, call.program.into(), runs, &name)?;
        self.flow = Some(Flow::Call(ProgramCall {
            codes_ordinary: true,
            ..called
        }));
        Ok(())
    }

    /// Calls the program with the number `program` with `words` (letter and value) as
    /// arguments, as G65 does.
    ///
    /// # Errors
    /// As for [`Self::call`]; 129 for a word that is no argument.
    pub fn call_macro(
        &mut self,
        programs: &ProgramMemory,
        program: i64,
        runs: u16,
        name: &str,
        words: impl Iterator<Item = (u8, f64)>,
    ) -> Result<(), Alarm> {
        let arguments = words.map(|(address, value)| Ok((address, Some(value))));
        let arguments = statement::locals_from_arguments(arguments).map_err(to_alarm)?;
        let context = self.call_context(programs);
        let call = subprogram::new_call(&context, CallKind::Macro, program, runs, &name)?;
        self.flow = Some(Flow::MacroCall(Box::new(MacroEntry { call, arguments })));
        Ok(())
    }

    /// Makes the call of the last G66, if one is in force. Call this function after each block
    /// that moves.
    pub fn call_modal_macro(&mut self) {
        self.flow = Some(self.run.flow_after_move(self.run.position));
    }

    /// Carries out an M99: repeats the call if runs are left, or returns to the caller, at the
    /// block N`p` if given. In the main program jumps to that block or to the first one. Returns
    /// whether the main program restarts.
    ///
    /// # Errors
    /// 078 if the block `p` does not exist.
    pub fn plan_return(&mut self, programs: &ProgramMemory, p: Option<i64>) -> Result<bool, Alarm> {
        let context = self.call_context(programs);
        let flow = subprogram::plan_return(&context, p)?;
        let restarts = subprogram::is_restart(&context, &flow);
        self.flow = Some(flow);
        Ok(restarts)
    }

    /// Ends the run, as M30 does: [`Self::next`] then returns [`WalkedBlock::Ended`].
    pub fn end(&mut self) {
        self.flow = Some(Flow::End);
    }
}
