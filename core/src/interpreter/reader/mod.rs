//! Reads blocks. The interpreter of the lathe reads as far as it may and gives the commands of
//! blocks one at a time; the walker gives the blocks of other models one at a time.
//!
//! ```text
//!   Interpreter --+--> PendingBlock --> StatementEffect, Flow --> InterpreterRun
//!   Walker -------+                                               position, calls, loops
//! ```

use serde::{Deserialize, Serialize};

use crate::alarm::Alarm;
use crate::command::{Frame, ProgramId, SourcePosition};
use crate::compensation::NoseCompensation;
use crate::interpreter::ModalState;
use crate::interpreter::calls::jump::JumpTargets;
use crate::interpreter::exact::ExactPoint;
use crate::interpreter::flow::code_calls::CodeCalls;
use crate::interpreter::flow::program_position::ProgramPosition;
use crate::interpreter::host::machine_codes::MachineCodes;
use crate::interpreter::host::{Host, InterpreterStep};
use crate::interpreter::moves::explanation::Explanation;
use crate::interpreter::reader::pass_explanation::explain_pass;
use crate::interpreter::reader::run::InterpreterRun;
use crate::interpreter::reader::word_audit::{LocatedRemark, WordAudit};
use crate::interpreter::state::{RunStart, State};
use crate::memory::ControlParameters;
use crate::model::{ControlModel, ModelRecord};
use crate::program::{BlockCache, Program, Syntax};
use crate::units::{Axis, Point};

mod block_evaluation;
mod block_read;
mod block_reader;
mod foreign_words;
mod pass_explanation;
mod pending_block;
mod plain_blocks;
pub(crate) mod run;
mod statements;
pub(crate) mod walker;
pub(crate) mod word_audit;

/// Turns blocks into commands. The interpreter is plain data that can be saved and restored at
/// any time.
///
/// [`start`](Self::start) begins a *run*. Then each call of [`next`](Self::next) gives one
/// command, until [`InterpreterStep::Ended`]. A block from the MDI page is a separate run
/// (`start_mdi`), which leaves a stopped automatic run unchanged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interpreter {
    pub(super) state: State,
    pub(super) main: InterpreterRun,
    pub(super) mdi: Option<MdiRun>,
    /// The nose radius compensation of the automatic run.
    pub(super) compensation: NoseCompensation,
    /// Programmed end of a suspended compensated run, machine coordinates, while MDI or manual
    /// motion moves the tool; `None` if no run is suspended.
    #[serde(rename = "aside")]
    pub(super) suspended_position: Option<ExactPoint>,
    jumps: JumpTargets,
    machine_codes: MachineCodes,
    /// Whether the control has the option of macro B.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    macro_b: bool,
    /// The control model that the programs are for.
    #[serde(default, skip_serializing_if = "ControlModel::is_delivered_main")]
    model: ControlModel,
    /// Whether the model of the programs has the variables #1 to #99 of the Huaxing lathes.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    #[serde(rename = "own_variables")]
    pub(super) has_huaxing_variables: bool,
    /// Codes that call a program by parameters of macro B; `None` if no code does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    code_calls: Option<Box<CodeCalls>>,
    /// Search for words that change nothing; `None` except in a preview.
    #[serde(skip)]
    audit: Option<Box<WordAudit>>,
    #[serde(skip)]
    recent: BlockCache,
}

/// The run over the block that the operator entered on the MDI page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct MdiRun {
    program: Program,
    run: InterpreterRun,
}

/// The state of the automatic run after the block read last, stored while MDI blocks run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ReadState(State);

/// The answer of [`Interpreter::advance`]; like [`InterpreterStep`] without the command.
pub(crate) enum AdvanceResult {
    /// The next command is stored in the place that the caller has passed.
    Command,
    Wait,
    /// The next block has not arrived through the serial line yet.
    Starved,
    Ended,
}

impl Interpreter {
    /// Creates the interpreter in its state at power-on, without a run.
    pub fn new(parameters: &ControlParameters) -> Self {
        let modal = ModalState {
            tool: parameters.tool_in_position(),
            ..ModalState::default()
        };
        Self {
            state: State::new(modal),
            main: InterpreterRun::new_ended(),
            mdi: None,
            compensation: NoseCompensation::default(),
            suspended_position: None,
            jumps: JumpTargets::default(),
            machine_codes: MachineCodes::default(),
            macro_b: false,
            model: ControlModel::default(),
            has_huaxing_variables: false,
            code_calls: None,
            audit: None,
            recent: BlockCache::default(),
        }
    }

    /// Switches inch input on or off, from the next block on.
    pub(crate) const fn set_inch_input(&mut self, inch: bool) {
        self.state.modal.inch = inch;
    }

    /// Switches the option of macro B on or off, from the next block on.
    pub fn set_macro_b(&mut self, on: bool) {
        self.macro_b = on;
        self.update_code_calls();
    }

    /// Reads from the model the codes that call a program; without macro B no code does.
    fn update_code_calls(&mut self) {
        self.code_calls = match self.macro_b {
            true => CodeCalls::from_model(&self.model),
            false => None,
        };
    }

    /// Sets the model that the programs are for, from the next block on.
    pub fn set_model(&mut self, model: &ControlModel) {
        self.model.clone_from(model);
        self.has_huaxing_variables = model.record().own_variables;
        self.update_code_calls();
    }

    /// Starts to search for words that change nothing, from the next block on.
    pub(crate) fn start_word_audit(&mut self) {
        self.audit = Some(Box::default());
    }

    /// Whether remarks exist that [`Self::take_remarks`] has not returned yet.
    #[inline]
    pub(crate) fn has_remarks(&self) -> bool {
        self.audit.as_ref().is_some_and(|audit| audit.has_remarks())
    }

    /// Returns the remarks found since the last call of this function, with their source
    /// positions.
    pub(crate) fn take_remarks(&mut self) -> Vec<LocatedRemark> {
        let audit = self.audit.as_mut();
        audit.map_or_else(Vec::new, |audit| audit.take_remarks())
    }

    /// The data of the control model that the programs are for.
    pub(crate) fn record(&self) -> &'static ModelRecord {
        self.model.record()
    }

    /// The syntax by which the next block of a program is read; `text` is that program.
    pub(crate) fn syntax(
        &self,
        program: ProgramId,
        text: &Program,
        parameters: &ControlParameters,
    ) -> Syntax {
        Syntax {
            inch: self.state.modal.inch,
            // The serial line brings a program once, so macro B has no target to jump to.
            macro_b: (self.macro_b || self.has_huaxing_variables)
                && program != ProgramId::Dnc
                && text.uses_macro_b(),
            model: self.model.id(),
            ..Syntax::from(parameters)
        }
    }

    /// The modal codes, feed, spindle speed and tool after the block read last.
    pub const fn modal(&self) -> &ModalState {
        &self.state.modal
    }

    /// Records that spindle or coolant stopped without a program: the last M code becomes M05
    /// or M09.
    pub(crate) const fn record_machine_stop(&mut self) {
        self.state.modal.m = match self.state.modal.m {
            Some(3 | 4) => Some(5),
            Some(8) => Some(9),
            other => other,
        };
    }

    /// The thread lead in force, mm per revolution; 0 if unset.
    pub const fn thread_lead(&self) -> f64 {
        self.state.lead
    }

    /// The coordinate frame (program zero and offsets) after the block read last.
    pub fn frame(&self) -> Frame {
        self.state.frame()
    }

    /// Programmed position at the end of the motion read so far, mm, X as a radius.
    pub fn position(&self) -> Point {
        self.state.position.to_point()
    }

    /// The source position of the block read last in the current run; `None` before the first
    /// block.
    pub fn cursor(&self) -> Option<SourcePosition> {
        self.current_run().source
    }

    /// Explains the cycle move taken last: pass, level, depth and formula. `None` outside
    /// cycles. Each call computes the explanation again.
    pub fn explain(&self) -> Option<Explanation> {
        let run = self.current_run();
        if let (Some(finishing), Some(source)) = (&run.finishing, run.source) {
            return finishing.explain(source);
        }
        let note = match &run.plan {
            Some(plan) => plan.pass_note(),
            None => run.last_note,
        };
        note.and_then(explain_pass)
    }

    /// Returns the number of subprogram and macro calls in execution.
    pub fn call_depth(&self) -> usize {
        self.current_run().calls.len()
    }

    /// Index of the next block to read of the program that arrives through the serial line;
    /// `None` if the run still needs earlier blocks of that program or runs another one.
    pub(crate) fn next_arriving_block(&self) -> Option<u32> {
        let run = &self.main;
        let is_free = run.plan.is_none() && run.calls.is_empty() && run.finishing.is_none();
        (is_free && run.position.program == ProgramId::Dnc).then_some(run.position.block)
    }

    /// Corrects the position of the run after the first `count` blocks of the arriving program
    /// were dropped.
    pub(crate) const fn drop_arrived_blocks(&mut self, count: u32) {
        self.main.position.block = self.main.position.block.saturating_sub(count);
    }

    /// The value of a local variable of macro B in the innermost call of the automatic run;
    /// `None` for null.
    pub fn local_variable(&self, number: u8) -> Option<f64> {
        self.main.levels.get(number)
    }

    /// Sets a local variable of macro B in the innermost call of the automatic run; `None`
    /// sets null.
    pub(crate) fn set_local_variable(&mut self, number: u8, value: Option<f64>) {
        self.main.levels.set(number, value);
    }

    /// Work done so far, to limit the computing time: number of blocks read plus one for each
    /// 64 bytes of their text.
    pub(crate) const fn work_units(&self) -> u64 {
        self.recent.work()
    }

    /// Whether commands of the block read last are left to take.
    pub(crate) fn is_in_block(&self) -> bool {
        self.current_run().plan.is_some()
    }

    /// Starts a run over a program, at the first block at or after the line `line` (from 1).
    /// Takes the tool position from the host and keeps the modal state.
    pub fn start(&mut self, program: ProgramId, line: u32, host: &impl Host) {
        let block = host
            .programs()
            .get(program)
            .map_or(0, |text| text.block_from_line(line));
        self.main = InterpreterRun::starting_at(ProgramPosition { program, block });
        self.mdi = None;
        self.drop_compensation();
        self.jumps = JumpTargets::default();
        self.state.scale = None;
        self.resync(host);
        if self.record().returns_to_start() {
            let work = self.state.position;
            let machine = self.state.to_machine(work);
            self.state.run_start = Some(RunStart { machine, work });
        }
    }

    /// Starts a run over the block `program` from the MDI page. After the end of this run
    /// [`next`](Self::next) continues the automatic run, if there is one.
    pub(crate) fn start_mdi(&mut self, program: Program, host: &impl Host) {
        let run = InterpreterRun::starting_at(ProgramPosition {
            program: ProgramId::Mdi,
            block: 0,
        });
        self.mdi = Some(MdiRun { program, run });
        self.resync(host);
    }

    /// Ends the run over the MDI block; the automatic run becomes the current one again.
    pub(crate) fn leave_mdi(&mut self) {
        self.mdi = None;
    }

    /// Returns a copy of the state after the block read last, for
    /// [`Self::restore_read_position`].
    pub(crate) const fn read_state(&self) -> ReadState {
        ReadState(self.state)
    }

    /// Restores the position of the automatic run after MDI blocks. Their modal codes stay in
    /// force. Their coordinate frame does, too, unless `same_frame` restores the earlier one.
    pub(crate) fn restore_read_position(&mut self, read_state: &ReadState, same_frame: bool) {
        let ReadState(before) = read_state;
        if same_frame {
            self.state.zero = before.zero;
            self.state.offset = before.offset;
            self.state.untravelled = before.untravelled;
        }
        self.state
            .set_machine_position(before.to_machine(before.position));
        self.state.increment_offset = before.increment_offset;
        self.state.is_threading = before.is_threading;
    }

    /// Takes the tool position from the host again, after manual motion.
    pub fn resync(&mut self, host: &impl Host) {
        self.suspend_compensation();
        self.state
            .set_machine_position(ExactPoint::from_point(host.machine_position()));
    }

    /// Puts another coordinate frame into force: at power-on, or when a manual reference
    /// return sets coordinates.
    pub(crate) fn set_frame(&mut self, frame: Frame, host: &impl Host) {
        self.state.zero = ExactPoint::from_point(frame.zero);
        self.state.zero_offset = ExactPoint::from_point(frame.zero_offset.to_point());
        self.state.offset = ExactPoint::from_point(frame.offset);
        self.resync(host);
    }

    /// Cancels the tool offset of an axis, as manual returns to the reference point and to the
    /// program zero do.
    pub(crate) fn cancel_offset(&mut self, axis: Axis, host: &impl Host) {
        self.state.offset.set(axis, 0);
        *self.state.untravelled.get_mut(axis) = false;
        if self.state.offset == ExactPoint::default() {
            self.state.cancel_offset_number();
        }
        self.resync(host);
    }

    /// Sets the M codes that the machine's ladder carries out.
    pub(crate) const fn set_machine_codes(&mut self, codes: MachineCodes) {
        self.machine_codes = codes;
    }

    /// Sets the tool number after a manual tool change.
    pub(crate) const fn set_tool(&mut self, tool: u8) {
        self.state.modal.tool = tool;
    }

    /// Puts another S word into force for the blocks after the one read last.
    pub(crate) const fn set_speed_word(&mut self, s: f64) {
        self.state.modal.spindle = s;
        if self.state.modal.surface_speed {
            self.state.surface = s;
        }
    }

    /// Puts another F word into force for the blocks after the one read last.
    pub(crate) const fn set_feed_word(&mut self, feed: f64) {
        self.state.modal.feed = feed;
    }

    /// Whether moves are computed that have not been taken: those of a cycle, or under G41 and
    /// G42.
    pub(crate) fn has_moves_ahead(&self) -> bool {
        self.is_in_block() || self.compensation.is_on() || self.compensation.has_pending()
    }

    /// Carries out RESET or the end of a program: ends the runs, deletes the stored words of
    /// cycles, ends scaling, cancels G41 and G42 and drops their vector. Other modal codes
    /// stay. 004.3 TOC decides whether the tool offset stays.
    pub fn reset(&mut self, host: &impl Host) {
        self.main = InterpreterRun::new_ended();
        self.mdi = None;
        self.drop_compensation();
        self.state.modal.nose_compensation = 40;
        self.state.cycle.clear();
        self.state.scale = None;
        if !host.parameters().reset_keeps_offset() {
            self.state.offset = ExactPoint::default();
            self.state.cancel_offset_number();
            self.state.untravelled = Default::default();
        }
        self.resync(host);
    }

    /// Returns the next command. One call reads at most a few blocks and makes at most one
    /// command, so that the call never delays a tick.
    ///
    /// # Errors
    /// The alarm of the block being read. The block has no effect then, and the next call
    /// reads it again.
    pub fn next(&mut self, host: &mut impl Host) -> Result<InterpreterStep, Alarm> {
        let mut command = None;
        Ok(match (self.advance(host, &mut command)?, command) {
            (AdvanceResult::Ended, _) => InterpreterStep::Ended,
            (AdvanceResult::Command, Some(command)) => InterpreterStep::Command(Box::new(command)),
            _ => InterpreterStep::Wait,
        })
    }

    fn current_run(&self) -> &InterpreterRun {
        self.mdi.as_ref().map_or(&self.main, |mdi| &mdi.run)
    }

    fn current_run_mut(&mut self) -> &mut InterpreterRun {
        match &mut self.mdi {
            Some(mdi) => &mut mdi.run,
            None => &mut self.main,
        }
    }
}
