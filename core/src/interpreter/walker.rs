//! Runs programs of a model with other codes than the lathe's: finds the next block and
//! carries out loops, jumps, calls and formulas. The caller carries out the words of a block.
//!
//! ```text
//!   Walker::next --> words of a block --> the caller carries them out --> call, back, end
//!      |                                                                       |
//!      +--- statements of macro B are carried out here <-----------------------+
//! ```

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::{ProgramId, SequenceNumber, SourcePosition};
use crate::interpreter::calls::jump::JumpTargets;
use crate::interpreter::calls::subprogram::MAX_CALL_DEPTH;
use crate::interpreter::flow::code_calls::{CodeCalls, PlainCall, are_ordinary};
use crate::interpreter::flow::program_position::{CallKind, ProgramCall, ProgramPosition};
use crate::interpreter::macros::formula;
use crate::interpreter::macros::levels::{LAST_LOCAL, Levels, LocalVariables, RunningLoop};
use crate::interpreter::macros::statement::{
    self, MAX_MACRO_DEPTH, StatementContext, StatementEffect,
};
use crate::interpreter::macros::variable::ReadError;
use crate::model::ControlModel;
use crate::program::{BlockCache, CodeCall, Program, ProgramBlock, ProgramMemory, Syntax};

/// The variables above #33, which the caller of the walker stores. The walker itself stores #0
/// to #33.
pub trait SystemVariables {
    /// Returns the value of the variable `number`; `None` is null.
    ///
    /// # Errors
    /// 115 for an unknown number.
    fn read(&self, number: u32) -> Result<Option<f64>, Alarm>;

    /// Sets the variable `number` to `value`; `None` makes it null.
    ///
    /// # Errors
    /// 115 for an unknown number, 116 for a read-only variable, 043 for a value that the
    /// variable does not take.
    fn write(&mut self, number: u32, value: Option<f64>) -> Result<(), Alarm>;

    /// Whether the results of `ASIN` and `ATAN` are −90 to 90 and −180 to 180 degrees; if not,
    /// 0 to 360.
    fn signed_angles(&self) -> bool {
        false
    }
}

/// What [`Walker::next`] has read.
#[derive(Clone, Debug, PartialEq)]
pub enum WalkedBlock {
    /// The words of a block for the caller to carry out, with numbers in place of formulas.
    Words(Box<ProgramBlock>),
    /// The caller has nothing to do: the walker has carried out a statement of macro B or
    /// skipped the block.
    Nothing,
    /// The text of a called program has ended, with the effect of an M99.
    Returned,
    /// The run has ended.
    Ended,
}

/// Where the run continues after an M99.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReturnEffect {
    /// With another run of the called program, or after the call in its caller.
    Returned,
    /// At the same or an earlier block of the main program, without P at the first one: the
    /// program restarts.
    Restarted,
    /// At a later block of the main program.
    Jumped,
}

/// A run over a program and those that it calls.
#[derive(Clone, Debug)]
pub struct Walker {
    /// The position of the block read last.
    last_position: ProgramPosition,
    /// The position of the next block.
    next_position: ProgramPosition,
    calls: Vec<ProgramCall>,
    levels: Levels,
    sequence: Option<SequenceNumber>,
    jumps: JumpTargets,
    recent: BlockCache,
    code_calls: Option<Box<CodeCalls>>,
    has_ended: bool,
}

impl Walker {
    /// A new run that begins at the first block of a program.
    pub fn new(program: ProgramId) -> Self {
        let next_position = ProgramPosition { program, block: 0 };
        Self {
            last_position: next_position,
            next_position,
            calls: Vec::new(),
            levels: Levels::new(),
            sequence: None,
            jumps: JumpTargets::default(),
            recent: BlockCache::default(),
            code_calls: None,
            has_ended: false,
        }
    }

    /// Makes those G, M and T codes call a program that the parameters of `model` name.
    #[must_use]
    pub fn with_code_calls(mut self, model: &ControlModel) -> Self {
        self.code_calls = CodeCalls::from_model(model);
        self
    }

    /// The codes that call a program; `None` if no code does or a running call makes them
    /// ordinary.
    fn active_code_calls(&self) -> Option<&CodeCalls> {
        let code_calls = self.code_calls.as_deref();
        code_calls.filter(|_| !are_ordinary(&self.calls))
    }

    /// The source position of the block read last.
    pub fn source(&self, programs: &ProgramMemory) -> SourcePosition {
        let program = programs.get(self.last_position.program);
        SourcePosition {
            program: self.last_position.program,
            line: program.map_or(0, |text| text.block_line(self.last_position.block)),
            sequence: self.sequence,
        }
    }

    /// The program of the block read last.
    pub const fn current_program(&self) -> ProgramId {
        self.last_position.program
    }

    /// Reads the next block. `is_skipping` skips blocks marked `/`; `system` reads and writes
    /// variables above #33.
    ///
    /// # Errors
    /// The alarm of the block's syntax or of its statement.
    pub fn next(
        &mut self,
        programs: &ProgramMemory,
        syntax: Syntax,
        is_skipping: bool,
        system: &mut impl SystemVariables,
    ) -> Result<WalkedBlock, Alarm> {
        if self.has_ended {
            return Ok(WalkedBlock::Ended);
        }
        let program = find_program(programs, self.next_position.program)?;
        self.last_position = self.next_position;
        if self.last_position.block >= program.block_count() {
            // An alarm names the last line of the text.
            self.last_position.block = self.last_position.block.saturating_sub(1);
            if self.calls.is_empty() {
                self.has_ended = true;
                return Ok(WalkedBlock::Ended);
            }
            self.execute_return(programs, None)?;
            return Ok(WalkedBlock::Returned);
        }
        let index = self.last_position.block;
        self.sequence = program
            .sequence(index)
            .map(SequenceNumber::from)
            .or(self.sequence);
        self.next_position = self.last_position.next_block();
        if is_skipping && program.has_skip_mark(index) {
            return Ok(WalkedBlock::Nothing);
        }
        let code_call = self.active_code_calls().map(|codes| {
            let find_macro = |letter, code| codes.find_macro(letter, code);
            program.code_call(index, &find_macro)
        });
        let call = code_call.transpose().map_err(Alarm::from)?.flatten();
        if let Some(call) = call {
            let walked = self.call_with_words(&call, program, programs, syntax, system);
            return without_wait(walked);
        }
        // Taken out of `self`, which changes while the block is borrowed.
        let mut recent = core::mem::take(&mut self.recent);
        let read = recent.read(program, index, syntax);
        let walked = read
            .map_err(|error| ReadError::Fault(error.into()))
            .and_then(|block| self.execute_block(block, program, programs, syntax, system));
        self.recent = recent;
        without_wait(walked)
    }

    /// Carries out the macro call of a G or M code, with the words of its block as arguments.
    fn call_with_words(
        &mut self,
        call: &CodeCall,
        program: &Program,
        programs: &ProgramMemory,
        syntax: Syntax,
        system: &mut impl SystemVariables,
    ) -> Result<WalkedBlock, ReadError> {
        let read_variable = |number: u32| self.read_variable(number, system);
        let formula_context = formula::FormulaContext {
            read_variable: &read_variable,
            signed_angles: system.signed_angles(),
        };
        let context = self.statement_context(program, programs, syntax, None);
        let effect = statement::evaluate_code_call(call, &context, formula_context)?;
        self.apply_effect(effect, program, system)?;
        Ok(WalkedBlock::Nothing)
    }

    fn execute_block(
        &mut self,
        block: &ProgramBlock,
        program: &Program,
        programs: &ProgramMemory,
        syntax: Syntax,
        system: &mut impl SystemVariables,
    ) -> Result<WalkedBlock, ReadError> {
        if block.is_name_only() {
            return Ok(WalkedBlock::Nothing);
        }
        let read_variable = |number: u32| self.read_variable(number, system);
        let formula_context = formula::FormulaContext {
            read_variable: &read_variable,
            signed_angles: system.signed_angles(),
        };
        let Some(statement) = block.macro_statement() else {
            let words = match block.formulas() {
                Some(formulas) => {
                    formula::evaluate_words(block, formulas, syntax, formula_context)?
                }
                None => block.clone(),
            };
            return Ok(WalkedBlock::Words(Box::new(words)));
        };
        let current_loop = self.levels.innermost_loop(self.calls.len());
        let context = self.statement_context(program, programs, syntax, current_loop);
        let effect = statement::evaluate_statement(statement, &context, formula_context)?;
        self.apply_effect(effect, program, system)?;
        Ok(WalkedBlock::Nothing)
    }

    /// Reads a variable: #0 to #33 from the walker, others from `system`; `None` is null.
    fn read_variable(
        &self,
        number: u32,
        system: &impl SystemVariables,
    ) -> Result<Option<f64>, ReadError> {
        match number {
            0 => Ok(None),
            1..=LAST_LOCAL => Ok(self.levels.get(number as u8)),
            _ => system.read(number).map_err(ReadError::Fault),
        }
    }

    /// The data that a statement in the block read last is evaluated with.
    fn statement_context<'a>(
        &'a self,
        program: &'a Program,
        programs: &'a ProgramMemory,
        syntax: Syntax,
        current_loop: Option<RunningLoop>,
    ) -> StatementContext<'a> {
        StatementContext {
            program,
            programs,
            position: self.last_position,
            calls: &self.calls,
            syntax,
            current_loop,
        }
    }

    /// Carries out the effect of a statement: assigns, jumps, calls, or enters or leaves a
    /// loop.
    fn apply_effect(
        &mut self,
        effect: StatementEffect,
        program: &Program,
        system: &mut impl SystemVariables,
    ) -> Result<(), ReadError> {
        match effect {
            StatementEffect::Nothing => {}
            StatementEffect::Assign(number, value) => {
                self.assign_variable(number, value, system)?;
            }
            StatementEffect::Enter(entered) => self.levels.enter_loop(entered),
            StatementEffect::Repeat(first) => self.jump_to(first),
            StatementEffect::Leave(last) => self.jump_to(last.saturating_add(1)),
            StatementEffect::Jump(number) => {
                let block = self
                    .jumps
                    .find_target(program, self.last_position, number)?;
                self.jump_to(block);
            }
            StatementEffect::Call(call, arguments) => self.enter_call(call, Some(arguments)),
            StatementEffect::Modal(modal) => {
                if !self.levels.add_modal_call(modal, MAX_MACRO_DEPTH) {
                    let detail = say::modal_calls_too_many(MAX_MACRO_DEPTH);
                    return Err(Alarm::new(number::MODAL_CALLS).with_detail(detail).into());
                }
            }
            StatementEffect::CancelModal => self.levels.cancel_modal_call(),
        }
        Ok(())
    }

    fn assign_variable(
        &mut self,
        number: u32,
        value: Option<f64>,
        system: &mut impl SystemVariables,
    ) -> Result<(), ReadError> {
        let value = value.map(formula::round_to_stored);
        match number {
            0 => {
                let detail = say::variable_of_macro_read_only(number);
                return Err(Alarm::new(number::READ_ONLY).with_detail(detail).into());
            }
            1..=LAST_LOCAL => self.levels.set(number as u8, value),
            _ => system.write(number, value)?,
        }
        Ok(())
    }

    fn jump_to(&mut self, block: u32) {
        self.levels.end_left_loops(self.calls.len(), block);
        self.next_position.block = block;
    }

    fn enter_call(&mut self, call: ProgramCall, arguments: Option<LocalVariables>) {
        self.next_position = call.begin_position();
        self.calls.push(call);
        if let Some(arguments) = arguments {
            self.levels.push_level(arguments);
        }
    }

    /// Calls the subprogram with the number `program` from the block read last, `runs` times.
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
        let call = self.new_call(programs, program, runs, name, CallKind::Subprogram)?;
        self.enter_call(call, None);
        Ok(())
    }

    /// The subprogram that the M code `m` or the T code `t` calls by parameters, as M98 does;
    /// `None` if neither calls.
    pub fn find_called_subprogram(&self, m: Option<i64>, t: Option<i64>) -> Option<PlainCall> {
        let m = m.and_then(|code| u16::try_from(code).ok());
        self.active_code_calls()?.find_subprogram_by_number(m, t)
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
        let name = format!("{}{:02}", call.address, call.code);
        let kind = CallKind::Subprogram;
        let mut call = self.new_call(programs, call.program.into(), runs, &name, kind)?;
        call.codes_ordinary = true;
        self.enter_call(call, None);
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
        let arguments = match statement::locals_from_arguments(arguments) {
            Ok(arguments) => arguments,
            Err(ReadError::Fault(alarm)) => return Err(alarm),
            Err(ReadError::Wait) => LocalVariables::new(),
        };
        let call = self.new_call(programs, program, runs, name, CallKind::Macro)?;
        self.enter_call(call, Some(arguments));
        Ok(())
    }

    fn new_call(
        &self,
        programs: &ProgramMemory,
        program: i64,
        runs: u16,
        name: &str,
        kind: CallKind,
    ) -> Result<ProgramCall, Alarm> {
        let is_same_kind = |call: &&ProgramCall| call.kind.is_subprogram() == kind.is_subprogram();
        if self.calls.iter().filter(is_same_kind).count() >= MAX_CALL_DEPTH {
            let detail = say::call_too_deep(name, MAX_CALL_DEPTH + 1, MAX_CALL_DEPTH);
            return Err(Alarm::new(number::CALL_TOO_DEEP).with_detail(detail));
        }
        let found = u16::try_from(program)
            .ok()
            .and_then(|it| programs.find_called(it));
        let program = found.ok_or_else(|| {
            let detail = say::call_program_missing(name, program);
            Alarm::new(number::TARGET_MISSING).with_detail(detail)
        })?;
        Ok(ProgramCall {
            program,
            runs_left: runs,
            return_position: self.last_position.next_block(),
            kind,
            first_block: 0,
            block_count: None,
            codes_ordinary: false,
        })
    }

    /// Makes the call of the last G66, if one is in force. Call this function after each block
    /// that moves.
    pub fn call_modal_macro(&mut self) {
        let Some((index, modal)) = self.levels.find_modal_call(&self.calls) else {
            return;
        };
        let call = ProgramCall {
            program: modal.program,
            runs_left: modal.runs,
            return_position: self.last_position.next_block(),
            kind: CallKind::Modal(index),
            first_block: 0,
            block_count: None,
            codes_ordinary: false,
        };
        let arguments = modal.arguments.clone();
        self.enter_call(call, Some(arguments));
    }

    /// Carries out an M99: repeats the call if runs are left, or returns to the caller, at the
    /// block N`p` if given. In the main program jumps to that block or to the first one.
    ///
    /// # Errors
    /// 078 if the block `p` does not exist.
    pub fn execute_return(
        &mut self,
        programs: &ProgramMemory,
        p: Option<i64>,
    ) -> Result<ReturnEffect, Alarm> {
        let find_block = |program| {
            let number = p
                .and_then(|n| u32::try_from(n).ok())
                .filter(|n| *n <= 99_999);
            let block = number.and_then(|n| {
                let text = programs.get(program)?;
                text.find_sequence_block(n, 0..text.block_count())
            });
            block.ok_or_else(|| {
                let detail = say::return_target_missing(p.unwrap_or(0));
                Alarm::new(number::TARGET_MISSING).with_detail(detail)
            })
        };
        let depth = self.calls.len();
        let Some(call) = self.calls.last_mut() else {
            let block = match p {
                Some(_) => find_block(self.last_position.program)?,
                None => 0,
            };
            self.jump_to(block);
            return Ok(if block <= self.last_position.block {
                ReturnEffect::Restarted
            } else {
                ReturnEffect::Jumped
            });
        };
        if call.runs_left > 1 {
            self.levels.prepare_next_run(call, depth);
            call.runs_left -= 1;
            self.next_position = call.begin_position();
            return Ok(ReturnEffect::Returned);
        }
        let mut place = call.return_position;
        if p.is_some() {
            place.block = find_block(place.program)?;
        }
        let call = *call;
        self.calls.pop();
        self.levels.pop_level(&call, self.calls.len());
        self.levels.end_left_loops(self.calls.len(), place.block);
        self.next_position = place;
        Ok(ReturnEffect::Returned)
    }

    /// Ends the run, as M30 does: [`Self::next`] then returns [`WalkedBlock::Ended`].
    pub fn end(&mut self) {
        self.has_ended = true;
    }

    /// Number of running subprogram and macro calls.
    pub fn call_depth(&self) -> usize {
        self.calls.len()
    }
}

/// Removes the variant Wait of [`ReadError`], which cannot occur: every earlier block is
/// finished.
fn without_wait(outcome: Result<WalkedBlock, ReadError>) -> Result<WalkedBlock, Alarm> {
    match outcome {
        Ok(read) => Ok(read),
        Err(ReadError::Fault(alarm)) => Err(alarm),
        Err(ReadError::Wait) => Ok(WalkedBlock::Nothing),
    }
}

fn find_program(programs: &ProgramMemory, program: ProgramId) -> Result<&Program, Alarm> {
    programs.get(program).ok_or_else(|| {
        let detail = say::program_not_there(format_args!("{program:?}"));
        Alarm::new(number::PROGRAM_MISSING).with_detail(detail)
    })
}
