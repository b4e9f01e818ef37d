//! The block at the position of a run, and the steps that read it without changing anything.

use crate::alarm::Alarm;
use crate::command::{MotionCode, ProgramId, SequenceNumber, SourcePosition};
use crate::interpreter::ModalState;
use crate::interpreter::codes::corner;
use crate::interpreter::codes::inch;
use crate::interpreter::flow::Finishing;
use crate::interpreter::flow::code_calls::{self, CodeCalls};
use crate::interpreter::flow::program_position::ProgramPosition;
use crate::interpreter::host::Host;
use crate::interpreter::macros::lookahead::LookaheadReader;
use crate::interpreter::macros::statement::{self, StatementContext, StatementEffect};
use crate::interpreter::macros::system::VariableSources;
use crate::interpreter::macros::variable::ReadError;
use crate::interpreter::macros::variable_access::{VariableReader, with_formula_context};
use crate::interpreter::reader::run::InterpreterRun;
use crate::interpreter::reader::word_audit::{BlockRemark, WordAudit};
use crate::interpreter::state::State;
use crate::interpreter::words::SortedWords;
use crate::program::{CodeCall, MacroStatement, Program, ProgramBlock, ProgramMemory, Syntax};

use super::block_read::BlockRead;
use super::statements::resolve_block;

/// The next block of a run, before it is parsed and evaluated.
pub(super) struct PendingBlock<'a> {
    pub(super) program: &'a Program,
    pub(super) run: &'a InterpreterRun,
    pub(super) position: ProgramPosition,
    pub(super) syntax: Syntax,
    /// The source position for commands and alarms. Until [`Self::locate`] the line is 0 and
    /// the sequence number that of earlier blocks.
    pub(super) source: SourcePosition,
    pub(super) is_mdi: bool,
    /// Whether block skip is on, so that blocks marked `/` are skipped.
    pub(super) is_skipping: bool,
}

/// A position at which a run reads no block.
#[derive(Clone, Copy)]
pub(super) enum TextBoundary {
    /// The end of the profile that this G70 runs.
    ProfileEnd(Finishing),
    /// The end of the text or of the blocks of a call. The payload is the last line, for
    /// messages.
    TextEnd(u32),
    /// The end of the blocks that have arrived through the serial line.
    Starved,
}

/// The reason why a block cannot be evaluated now.
pub(super) enum ReadObstacle {
    /// The block must wait until every earlier command is finished.
    Wait,
    /// The next block, which decides the end of this one, has not arrived through the serial
    /// line yet.
    Starved,
    /// Evaluation fails: the block raises this alarm.
    Fault(Alarm),
}

impl From<ReadError> for ReadObstacle {
    fn from(reason: ReadError) -> Self {
        match reason {
            ReadError::Wait => Self::Wait,
            ReadError::Fault(alarm) => Self::Fault(alarm),
        }
    }
}

impl ReadObstacle {
    /// Converts to the result of reading a block. An alarm gets the position `source`.
    pub(super) fn into_read(self, source: SourcePosition) -> Result<BlockRead, Alarm> {
        match self {
            Self::Wait => Ok(BlockRead::Wait),
            Self::Starved => Ok(BlockRead::Starved),
            Self::Fault(alarm) => Err(alarm.with_source(source)),
        }
    }
}

impl TextBoundary {
    /// Finds the boundary at the position of a run; `None` if a block follows there.
    #[inline]
    pub(super) fn find<H: Host>(
        program: &Program,
        run: &InterpreterRun,
        is_mdi: bool,
        host: &H,
    ) -> Option<Self> {
        let position = run.position;
        if let Some(finishing) = run
            .finishing
            .filter(|profile| profile.is_finished_at(position))
        {
            return Some(Self::ProfileEnd(finishing));
        }
        if run
            .calls
            .last()
            .is_some_and(|call| call.is_finished_at(position))
        {
            let last_line = program.block_line(position.block.saturating_sub(1));
            return Some(Self::TextEnd(last_line));
        }
        if position.block < program.block_count() {
            return None;
        }
        Some(
            match !is_mdi && host.programs().has_more(position.program) {
                true => Self::Starved,
                false => Self::TextEnd(program.line_count()),
            },
        )
    }
}

impl<'a> PendingBlock<'a> {
    /// Creates the block at the position of a run; [`Self::locate`] later sets its line and
    /// sequence number.
    #[inline]
    pub(super) fn new(
        (program, run): (&'a Program, &'a InterpreterRun),
        syntax: Syntax,
        is_mdi: bool,
        is_skipping: bool,
    ) -> Self {
        Self {
            program,
            run,
            position: run.position,
            syntax,
            source: SourcePosition {
                program: run.position.program,
                line: 0,
                sequence: run.sequence,
            },
            is_mdi,
            is_skipping,
        }
    }

    /// Sets the line and the sequence number of the block. `None` for `n` keeps the last
    /// sequence number.
    #[inline]
    pub(super) fn locate(&mut self, line: u32, n: Option<u32>) {
        self.source.line = line;
        self.source.sequence = n.map(SequenceNumber::from).or(self.source.sequence);
    }

    /// Sets the line and the sequence number of a block that cannot be parsed, from its text.
    #[cold]
    pub(super) fn locate_unparsed(&mut self) {
        let n = self.program.sequence(self.position.block);
        self.locate(self.program.block_line(self.position.block), n);
    }

    /// Whether block skip skips the block. For a block that cannot be parsed.
    pub(super) fn is_unparsed_skipped(&self) -> bool {
        self.is_skipping && self.program.has_skip_mark(self.position.block)
    }

    /// Whether the block is skipped or has no words.
    #[inline]
    pub(super) fn is_without_effect(&self, block: &ProgramBlock) -> bool {
        let is_skipped = self.is_skipping && block.skip;
        is_skipped || block.is_name_only()
    }

    /// Adds a remark if the block follows a semicolon in its line.
    pub(super) fn audit_semicolon(&self, audit: &mut WordAudit) {
        if self.program.follows_semicolon(self.position.block) {
            audit.add_remark(BlockRemark::AfterSemicolon, self.source);
        }
    }

    /// Returns the codes that call a program in this block; `None` if such codes have their
    /// ordinary function: in MDI, through the serial line and in some calls.
    #[inline]
    pub(super) fn active_code_calls<'c>(
        &self,
        calls: Option<&'c CodeCalls>,
    ) -> Option<&'c CodeCalls> {
        let stored = !matches!(self.position.program, ProgramId::Mdi | ProgramId::Dnc);
        calls.filter(|_| stored && !code_calls::are_ordinary(&self.run.calls))
    }

    /// Finds the macro call that the first code of the block makes, and locates the block.
    /// `None` if the code calls nothing or the block is skipped.
    ///
    /// # Errors
    /// The alarm of an argument.
    pub(super) fn find_code_call(&mut self, calls: &CodeCalls) -> Result<Option<CodeCall>, Alarm> {
        let index = self.position.block;
        let found = self
            .program
            .code_call(index, &|letter, code| calls.find_macro(letter, code));
        let call = match found {
            Ok(call) => call.filter(|call| !(self.is_skipping && call.skip)),
            Err(_) if self.is_unparsed_skipped() => None,
            Err(error) => {
                self.source.line = self.program.block_line(index);
                return Err(Alarm::from(error).with_source(self.source));
            }
        };
        if let Some(call) = &call {
            self.locate(self.program.block_line(index), call.n);
        }
        Ok(call)
    }

    /// Evaluates the macro call that the first code of the block makes.
    ///
    /// # Errors
    /// The alarm of an argument, or a variable that cannot be read yet.
    pub(super) fn evaluate_code_call(
        &self,
        call: &CodeCall,
        programs: &ProgramMemory,
        variables: &impl VariableReader,
    ) -> Result<StatementEffect, ReadError> {
        let context = StatementContext {
            current_loop: None,
            ..self.statement_context(programs)
        };
        with_formula_context(&self.run.levels, variables, |formula_context| {
            statement::evaluate_code_call(call, &context, formula_context)
        })
    }

    /// Evaluates a statement of macro B without changing anything.
    ///
    /// # Errors
    /// The alarm of the statement, or a variable that cannot be read yet.
    pub(super) fn evaluate_statement(
        &self,
        statement: &MacroStatement,
        programs: &ProgramMemory,
        variables: &impl VariableReader,
    ) -> Result<StatementEffect, ReadError> {
        let context = self.statement_context(programs);
        with_formula_context(&self.run.levels, variables, |formula_context| {
            statement::evaluate_statement(statement, &context, formula_context)
        })
    }

    fn statement_context<'s>(&'s self, programs: &'s ProgramMemory) -> StatementContext<'s> {
        StatementContext {
            program: self.program,
            programs,
            position: self.position,
            calls: &self.run.calls,
            syntax: self.syntax,
            current_loop: self.run.levels.innermost_loop(self.run.calls.len()),
        }
    }

    /// The sources of the variables that formulas of the block read. `state` is the state
    /// after the previous block.
    #[inline]
    pub(super) fn variable_sources<'s, H: Host>(
        &self,
        state: State,
        has_huaxing_variables: bool,
        host: &'s H,
    ) -> VariableSources<'s, H>
    where
        'a: 's,
    {
        VariableSources {
            levels: &self.run.levels,
            state,
            source: self.source,
            has_huaxing_variables,
            host,
        }
    }

    /// A reader for the blocks after this one.
    #[inline]
    pub(super) fn lookahead_reader<'s, H>(
        &self,
        sources: Option<&'s VariableSources<'s, H>>,
        host: &'s H,
    ) -> LookaheadReader<'s, H>
    where
        'a: 's,
    {
        LookaheadReader {
            program: self.program,
            syntax: self.syntax,
            is_skipping: self.is_skipping,
            host,
            sources,
        }
    }

    /// Copies the block with its variables and formulas replaced by numbers, in mm. `None` if the
    /// block contains only numbers in mm already.
    ///
    /// # Errors
    ///
    /// The alarm of a formula, or a variable that cannot be read yet.
    #[inline]
    pub(super) fn convert<H: Host>(
        &self,
        block: &ProgramBlock,
        sources: Option<&VariableSources<'_, H>>,
        motion: MotionCode,
        host: &H,
    ) -> Result<Option<ProgramBlock>, ReadError> {
        let resolved = resolve_block(block, sources, self.syntax, motion, host)?;
        if !self.syntax.inch {
            return Ok(resolved);
        }
        let mut metric = resolved.unwrap_or_else(|| block.clone());
        inch::convert_to_metric(&mut metric, motion);
        Ok(Some(metric))
    }

    /// Reads the words of the next block if this block has a corner; `None` for other blocks.
    ///
    /// # Errors
    /// The next block has not arrived or cannot be read yet.
    #[inline]
    pub(super) fn read_next_words<H: Host>(
        &self,
        words: &SortedWords,
        modal: &ModalState,
        ahead: &LookaheadReader<'_, H>,
    ) -> Result<Option<SortedWords>, ReadObstacle> {
        let is_corner = corner::can_be_corner(words, modal);
        // A corner or the end of a thread depends on the next block, and not on the time of
        // its arrival through the serial line.
        let may_arrive =
            !self.is_mdi && ahead.host.programs().can_bring_block(self.position.program);
        if may_arrive
            && (is_corner || cuts_thread_pass(words, modal))
            && !ahead.has_next(self.position.block)
        {
            return Err(ReadObstacle::Starved);
        }
        match is_corner {
            true => Ok(ahead.read_words_after(self.position.block, MotionCode::Line)?),
            false => Ok(None),
        }
    }
}

/// Whether a block cuts a thread that may continue in the next block.
fn cuts_thread_pass(words: &SortedWords, modal: &ModalState) -> bool {
    let motion = words.motion.unwrap_or(modal.motion);
    motion.is_thread_pass() && words.one_shot.is_none() && words.has_axis_words()
}
