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
use crate::command::{BlockNumber, ProgramId, Source};
use crate::interpreter::calls::jump::Jumps;
use crate::interpreter::calls::subprogram::LEVELS;
use crate::interpreter::context::code_calls::{CodeCalls, PlainCall, are_ordinary};
use crate::interpreter::context::place::{Call, CallKind, Place};
use crate::interpreter::macros::formula;
use crate::interpreter::macros::levels::{LOCALS, Levels, Locals, Loop};
use crate::interpreter::macros::statement::{self, Here, MACRO_LEVELS, Outcome};
use crate::interpreter::macros::variable::NotNow;
use crate::model::ControlModel;
use crate::program::{Block, CodeCall, Program, ProgramMemory, Recent, Syntax};

/// The variables above #33 of a model. The walker keeps #0 to #33.
pub trait System {
    /// The value of a variable; `None` is null.
    ///
    /// # Errors
    /// 115 for an unknown number.
    fn read(&self, number: u32) -> Result<Option<f64>, Alarm>;

    /// Sets a variable; `None` makes it null.
    ///
    /// # Errors
    /// 115 for an unknown number, 116 for a read-only variable, 043 for a value that it does
    /// not take.
    fn write(&mut self, number: u32, value: Option<f64>) -> Result<(), Alarm>;

    /// Whether `ASIN` and `ATAN` give −90 to 90 and −180 to 180 degrees instead of 0 to 360.
    fn signed_angles(&self) -> bool {
        false
    }
}

/// The result of reading a block.
#[derive(Clone, Debug, PartialEq)]
pub enum Read {
    /// Words for the caller to carry out, with numbers in place of formulas.
    Words(Box<Block>),
    /// A statement of macro B that the walker has carried out, or a skipped block.
    Nothing,
    /// The text of a called program has ended: the run continues after the call.
    Returned,
    /// The run has ended.
    Ended,
}

/// Where M99 has led to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Back {
    /// To another run of the same program, or to its caller.
    Returned,
    /// To an earlier block of the main program, or without P to its first one: the program
    /// restarts.
    Repeats,
    /// To a later block of the main program.
    Jumped,
}

/// A run over programs.
#[derive(Clone, Debug)]
pub struct Walker {
    /// The position of the block read last, and that of the next one.
    here: Place,
    place: Place,
    calls: Vec<Call>,
    levels: Levels,
    sequence: Option<BlockNumber>,
    jumps: Jumps,
    recent: Recent,
    codes: Option<Box<CodeCalls>>,
    ended: bool,
}

impl Walker {
    /// A run that begins at the first block of a program.
    pub fn new(program: ProgramId) -> Self {
        let place = Place { program, block: 0 };
        Self {
            here: place,
            place,
            calls: Vec::new(),
            levels: Levels::new(),
            sequence: None,
            jumps: Jumps::default(),
            recent: Recent::default(),
            codes: None,
            ended: false,
        }
    }

    /// Adds the codes that call a program by the parameters of a model.
    #[must_use]
    pub fn with_codes(mut self, model: &ControlModel) -> Self {
        self.codes = CodeCalls::of(model);
        self
    }

    /// The codes that call a program, unless the running calls make them ordinary.
    fn calling(&self) -> Option<&CodeCalls> {
        let codes = self.codes.as_deref();
        codes.filter(|_| !are_ordinary(&self.calls))
    }

    /// The source position of the block read last.
    pub fn source(&self, programs: &ProgramMemory) -> Source {
        let program = programs.get(self.here.program);
        Source {
            program: self.here.program,
            line: program.map_or(0, |text| text.block_line(self.here.block)),
            sequence: self.sequence,
        }
    }

    /// The program of the block read last.
    pub const fn program(&self) -> ProgramId {
        self.here.program
    }

    /// Reads the next block. `skipping` skips blocks marked `/`; `system` reads and writes
    /// variables above #33.
    ///
    /// # Errors
    /// The alarm of its syntax or of its statement.
    pub fn next(
        &mut self,
        programs: &ProgramMemory,
        syntax: Syntax,
        skipping: bool,
        system: &mut impl System,
    ) -> Result<Read, Alarm> {
        if self.ended {
            return Ok(Read::Ended);
        }
        let program = text(programs, self.place.program)?;
        self.here = self.place;
        if self.here.block >= program.block_count() {
            // An alarm names the last line of the text.
            self.here.block = self.here.block.saturating_sub(1);
            if self.calls.is_empty() {
                self.ended = true;
                return Ok(Read::Ended);
            }
            self.back(programs, None)?;
            return Ok(Read::Returned);
        }
        let index = self.here.block;
        self.sequence = program
            .sequence(index)
            .map(BlockNumber::from)
            .or(self.sequence);
        self.place = self.here.after();
        if skipping && program.has_skip_mark(index) {
            return Ok(Read::Nothing);
        }
        let calls = self.calling().map(|codes| {
            let called = |letter, code| codes.called(letter, code);
            program.code_call(index, &called)
        });
        let call = calls.transpose().map_err(Alarm::from)?.flatten();
        if let Some(call) = call {
            let outcome = self.call_by_words(&call, program, programs, syntax, system);
            return nothing_but(outcome);
        }
        // Taken out of `self`, which changes while the block is borrowed.
        let mut recent = core::mem::take(&mut self.recent);
        let read = recent.read(program, index, syntax);
        let outcome = read
            .map_err(|error| NotNow::Fault(error.into()))
            .and_then(|block| self.carry_out(block, program, programs, syntax, system));
        self.recent = recent;
        nothing_but(outcome)
    }

    /// Carries out a macro call that a code makes with the words of its block.
    fn call_by_words(
        &mut self,
        call: &CodeCall,
        program: &Program,
        programs: &ProgramMemory,
        syntax: Syntax,
        system: &mut impl System,
    ) -> Result<Read, NotNow> {
        let read = |number: u32| self.variable(number, system);
        let read = formula::Read {
            variable: &read,
            signed_angles: system.signed_angles(),
        };
        let here = self.stand(program, programs, syntax, None);
        let outcome = statement::carry_out_code_call(call, &here, read)?;
        self.take_up(outcome, program, system)?;
        Ok(Read::Nothing)
    }

    fn carry_out(
        &mut self,
        block: &Block,
        program: &Program,
        programs: &ProgramMemory,
        syntax: Syntax,
        system: &mut impl System,
    ) -> Result<Read, NotNow> {
        if block.is_name() {
            return Ok(Read::Nothing);
        }
        let read = |number: u32| self.variable(number, system);
        let read = formula::Read {
            variable: &read,
            signed_angles: system.signed_angles(),
        };
        let Some(statement) = block.macro_statement() else {
            let words = match block.formulas() {
                Some(formulas) => formula::in_words(block, formulas, syntax, read)?,
                None => block.clone(),
            };
            return Ok(Read::Words(Box::new(words)));
        };
        let within = self.levels.innermost(self.calls.len());
        let here = self.stand(program, programs, syntax, within);
        let outcome = statement::carry_out(statement, &here, read)?;
        self.take_up(outcome, program, system)?;
        Ok(Read::Nothing)
    }

    /// The value of a variable.
    fn variable(&self, number: u32, system: &impl System) -> Result<Option<f64>, NotNow> {
        match number {
            0 => Ok(None),
            1..=LOCALS => Ok(self.levels.get(number as u8)),
            _ => system.read(number).map_err(NotNow::Fault),
        }
    }

    /// The position of a statement at the block read last.
    fn stand<'a>(
        &'a self,
        program: &'a Program,
        programs: &'a ProgramMemory,
        syntax: Syntax,
        within: Option<Loop>,
    ) -> Here<'a> {
        Here {
            program,
            programs,
            place: self.here,
            calls: &self.calls,
            syntax,
            within,
        }
    }

    /// Applies the effect of a statement.
    fn take_up(
        &mut self,
        outcome: Outcome,
        program: &Program,
        system: &mut impl System,
    ) -> Result<(), NotNow> {
        match outcome {
            Outcome::Nothing => {}
            Outcome::Assign(number, value) => self.assign(number, value, system)?,
            Outcome::Enter(entered) => self.levels.enter_loop(entered),
            Outcome::Repeat(first) => self.jump(first),
            Outcome::Leave(last) => self.jump(last.saturating_add(1)),
            Outcome::Goto(number) => {
                let block = self.jumps.target(program, self.here, number)?;
                self.jump(block);
            }
            Outcome::Call(call, arguments) => self.enter(call, Some(arguments)),
            Outcome::Modal(modal) => {
                if !self.levels.add_modal(modal, MACRO_LEVELS) {
                    let detail = say::modal_calls_too_many(MACRO_LEVELS);
                    return Err(Alarm::new(number::MODAL_CALLS).because(detail).into());
                }
            }
            Outcome::CancelModal => self.levels.cancel_modal(),
        }
        Ok(())
    }

    fn assign(
        &mut self,
        number: u32,
        value: Option<f64>,
        system: &mut impl System,
    ) -> Result<(), NotNow> {
        let value = value.map(formula::kept);
        match number {
            0 => {
                let detail = say::variable_of_macro_read_only(number);
                return Err(Alarm::new(number::READ_ONLY).because(detail).into());
            }
            1..=LOCALS => self.levels.set(number as u8, value),
            _ => system.write(number, value)?,
        }
        Ok(())
    }

    fn jump(&mut self, block: u32) {
        self.levels.jump(self.calls.len(), block);
        self.place.block = block;
    }

    fn enter(&mut self, call: Call, arguments: Option<Locals>) {
        self.place = call.begin();
        self.calls.push(call);
        if let Some(arguments) = arguments {
            self.levels.enter(arguments);
        }
    }

    /// Calls a subprogram from the block read last, `runs` times. `name` is the calling code,
    /// for messages.
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
        self.enter(call, None);
        Ok(())
    }

    /// The subprogram that an M or T calls by parameters, as M98 does; `None` if it is
    /// ordinary.
    pub fn called_by(&self, m: Option<i64>, t: Option<i64>) -> Option<PlainCall> {
        let m = m.and_then(|code| u16::try_from(code).ok());
        self.calling()?.plain_by(m, t)
    }

    /// Calls such a subprogram `runs` times. In it the codes are ordinary.
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
        self.enter(call, None);
        Ok(())
    }

    /// Calls a program with the words of the block as arguments, as G65 does.
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
        let arguments = match statement::arguments_of(arguments) {
            Ok(arguments) => arguments,
            Err(NotNow::Fault(alarm)) => return Err(alarm),
            Err(NotNow::Wait) => Locals::new(),
        };
        let call = self.new_call(programs, program, runs, name, CallKind::Macro)?;
        self.enter(call, Some(arguments));
        Ok(())
    }

    fn new_call(
        &self,
        programs: &ProgramMemory,
        program: i64,
        runs: u16,
        name: &str,
        kind: CallKind,
    ) -> Result<Call, Alarm> {
        let alike = |call: &&Call| call.kind.is_subprogram() == kind.is_subprogram();
        if self.calls.iter().filter(alike).count() >= LEVELS {
            let detail = say::call_too_deep(name, LEVELS + 1, LEVELS);
            return Err(Alarm::new(number::CALL_TOO_DEEP).because(detail));
        }
        let found = u16::try_from(program).ok().and_then(|it| programs.find(it));
        let program = found.ok_or_else(|| {
            let detail = say::call_program_missing(name, program);
            Alarm::new(number::TARGET_MISSING).because(detail)
        })?;
        Ok(Call {
            program,
            runs,
            back: self.here.after(),
            kind,
            first: 0,
            blocks: None,
            codes_ordinary: false,
        })
    }

    /// Makes the call of the last G66. The caller calls it after each block that moves.
    pub fn moved(&mut self) {
        let Some((index, modal)) = self.levels.modal(&self.calls) else {
            return;
        };
        let call = Call {
            program: modal.program,
            runs: modal.runs,
            back: self.here.after(),
            kind: CallKind::Modal(index),
            first: 0,
            blocks: None,
            codes_ordinary: false,
        };
        let arguments = modal.arguments.clone();
        self.enter(call, Some(arguments));
    }

    /// Carries out an M99, with its P.
    ///
    /// # Errors
    /// 078 for a missing block.
    pub fn back(&mut self, programs: &ProgramMemory, p: Option<i64>) -> Result<Back, Alarm> {
        let find = |program| {
            let number = p
                .and_then(|n| u32::try_from(n).ok())
                .filter(|n| *n <= 99_999);
            let found = number.and_then(|n| {
                let text = programs.get(program)?;
                text.find_sequence_block(n, 0..text.block_count())
            });
            found.ok_or_else(|| {
                let detail = say::return_target_missing(p.unwrap_or(0));
                Alarm::new(number::TARGET_MISSING).because(detail)
            })
        };
        let depth = self.calls.len();
        let Some(call) = self.calls.last_mut() else {
            let block = match p {
                Some(_) => find(self.here.program)?,
                None => 0,
            };
            self.jump(block);
            return Ok(if block <= self.here.block {
                Back::Repeats
            } else {
                Back::Jumped
            });
        };
        if call.runs > 1 {
            self.levels.run_again(call, depth);
            call.runs -= 1;
            self.place = call.begin();
            return Ok(Back::Returned);
        }
        let mut place = call.back;
        if p.is_some() {
            place.block = find(place.program)?;
        }
        let call = *call;
        self.calls.pop();
        self.levels.leave(&call, self.calls.len());
        self.levels.jump(self.calls.len(), place.block);
        self.place = place;
        Ok(Back::Returned)
    }

    /// Ends the run (M30).
    pub fn end(&mut self) {
        self.ended = true;
    }

    /// Number of running calls.
    pub fn depth(&self) -> usize {
        self.calls.len()
    }
}

/// The result of reading. Waits cannot occur, because every earlier block is finished.
fn nothing_but(outcome: Result<Read, NotNow>) -> Result<Read, Alarm> {
    match outcome {
        Ok(read) => Ok(read),
        Err(NotNow::Fault(alarm)) => Err(alarm),
        Err(NotNow::Wait) => Ok(Read::Nothing),
    }
}

fn text(programs: &ProgramMemory, program: ProgramId) -> Result<&Program, Alarm> {
    programs.get(program).ok_or_else(|| {
        let detail = say::program_not_there(format_args!("{program:?}"));
        Alarm::new(number::PROGRAM_MISSING).because(detail)
    })
}
