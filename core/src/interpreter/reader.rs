//! The interpreter: reads blocks as far as it may and gives their commands one at a time.

use serde::{Deserialize, Serialize};

use crate::alarm::Alarm;
use crate::command::{Command, Frame, ProgramId, Source};
use crate::compensation::Compensation;
use crate::interpreter::Modal;
use crate::interpreter::calls::jump::Jumps;
use crate::interpreter::context::code_calls::CodeCalls;
use crate::interpreter::context::exact::Exact;
use crate::interpreter::context::explanation::{Explanation, Note};
use crate::interpreter::context::host::{Host, Step};
use crate::interpreter::context::machine_codes::MachineCodes;
use crate::interpreter::context::place::Place;
use crate::interpreter::context::state::{Begun, State};
use crate::interpreter::run::Run;
use crate::interpreter::word_audit::{Remarked, WordAudit};
use crate::memory::Parameters;
use crate::model::{ControlModel, Record};
use crate::program::{Program, Recent, Syntax};
use crate::units::{Axis, Point};

mod read;
mod reading;
mod statements;

/// Turns blocks into commands. It is plain data that can be saved and restored at any time.
///
/// [`start`](Self::start) begins a *run*. Then each call of [`next`](Self::next) gives one
/// command, until [`Step::Ended`]. A block from the MDI page is a separate run (`start_mdi`),
/// which leaves a stopped automatic run as it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interpreter {
    pub(super) state: State,
    pub(super) main: Run,
    pub(super) mdi: Option<Mdi>,
    /// The nose radius compensation of the automatic run.
    pub(super) compensation: Compensation,
    /// Programmed end of a suspended compensated run, machine coordinates, while something
    /// else moves the tool.
    #[serde(rename = "aside")]
    pub(super) aside: Option<Exact>,
    jumps: Jumps,
    machine_codes: MachineCodes,
    /// Whether the control has the option of macro B.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    macro_b: bool,
    /// The model that the programs are for.
    #[serde(default, skip_serializing_if = "ControlModel::is_delivered_main")]
    model: ControlModel,
    /// Whether that model has the variables #1 to #99 of the Huaxing lathes.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    #[serde(rename = "own_variables")]
    own_variables: bool,
    /// Codes that call a program by parameters of macro B.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    code_calls: Option<Box<CodeCalls>>,
    /// Finds words that change nothing. Only a preview sets it.
    #[serde(skip)]
    audit: Option<Box<WordAudit>>,
    #[serde(skip)]
    recent: Recent,
}

/// The run over the MDI block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Mdi {
    program: Program,
    run: Run,
}

/// The state at the last block read, while the tool is elsewhere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ReadTo(State);

/// An answer of [`Interpreter::advance`], with the command in place.
pub(crate) enum Advance {
    Command(Command),
    Wait,
    /// The next block has not arrived through the serial line yet.
    Starved,
    Ended,
}

impl Interpreter {
    /// The interpreter at power-on, without a run.
    pub fn new(parameters: &Parameters) -> Self {
        let modal = Modal {
            tool: parameters.tool_in_position(),
            ..Modal::default()
        };
        Self {
            state: State::new(modal),
            main: Run::over(),
            mdi: None,
            compensation: Compensation::default(),
            aside: None,
            jumps: Jumps::default(),
            machine_codes: MachineCodes::default(),
            macro_b: false,
            model: ControlModel::default(),
            own_variables: false,
            code_calls: None,
            audit: None,
            recent: Recent::default(),
        }
    }

    /// Sets inch input, from the next block on.
    pub(crate) const fn set_inch_input(&mut self, inch: bool) {
        self.state.modal.inch = inch;
    }

    /// Switches the option of macro B, from the next block on.
    pub fn set_macro_b(&mut self, on: bool) {
        self.macro_b = on;
        self.find_code_calls();
    }

    /// Reads the codes that call a program; they belong to macro B.
    fn find_code_calls(&mut self) {
        self.code_calls = match self.macro_b {
            true => CodeCalls::of(&self.model),
            false => None,
        };
    }

    /// Sets the model that the programs are for, from the next block on.
    pub fn set_model(&mut self, model: &ControlModel) {
        self.model.clone_from(model);
        self.own_variables = model.record().own_variables;
        self.find_code_calls();
    }

    /// Starts to search for words that change nothing, from the next block on.
    pub(crate) fn audit_words(&mut self) {
        self.audit = Some(Box::default());
    }

    /// Whether remarks exist that [`Self::take_remarks`] has not returned yet.
    #[inline]
    pub(crate) fn has_remarks(&self) -> bool {
        self.audit.as_ref().is_some_and(|audit| audit.has_remarks())
    }

    /// The remarks since the last call, with their source positions.
    pub(crate) fn take_remarks(&mut self) -> Vec<Remarked> {
        let audit = self.audit.as_mut();
        audit.map_or_else(Vec::new, |audit| audit.take())
    }

    /// The record of the model that the programs are for.
    pub(crate) fn record(&self) -> &'static Record {
        self.model.record()
    }

    /// The syntax of the next block of a program.
    pub(crate) fn syntax(
        &self,
        program: ProgramId,
        text: &Program,
        parameters: &Parameters,
    ) -> Syntax {
        Syntax {
            inch: self.state.modal.inch,
            // The serial line brings a program once, so macro B has no target to jump to.
            macro_b: (self.macro_b || self.own_variables)
                && program != ProgramId::Dnc
                && text.uses_macro_b(),
            model: self.model.id(),
            ..Syntax::from(parameters)
        }
    }

    /// The modal state after the block read last.
    pub const fn modal(&self) -> &Modal {
        &self.state.modal
    }

    /// Records that spindle or coolant stopped without a program: the last M code becomes M05
    /// or M09.
    pub(crate) const fn machine_stopped(&mut self) {
        self.state.modal.m = match self.state.modal.m {
            Some(3 | 4) => Some(5),
            Some(8) => Some(9),
            other => other,
        };
    }

    /// The thread lead in force, mm; 0 if unset.
    pub const fn thread_lead(&self) -> f64 {
        self.state.lead
    }

    /// The coordinate frame after the block read last.
    pub fn frame(&self) -> Frame {
        self.state.frame()
    }

    /// Programmed position at the end of the motion read so far, mm, X as a radius.
    pub fn position(&self) -> Point {
        self.state.position.point()
    }

    /// The source position of the block read last, in the current run; `None` before the
    /// first.
    pub fn cursor(&self) -> Option<Source> {
        self.run().source
    }

    /// The explanation of the cycle move taken last: pass, level, depth and formula. `None`
    /// outside cycles. Computed on each call.
    pub fn explanation(&self) -> Option<Explanation> {
        let run = self.run();
        if let (Some(finishing), Some(source)) = (&run.finishing, run.source) {
            return finishing.explanation(source);
        }
        let note = match &run.plan {
            Some(plan) => plan.note(),
            None => run.note,
        };
        note.and_then(Note::explanation)
    }

    /// Number of running subprogram and macro calls.
    pub fn depth(&self) -> usize {
        self.run().calls.len()
    }

    /// Index of the next block of the program that arrives through the serial line; `None` if
    /// the run keeps a position in it.
    pub(crate) fn next_coming_in(&self) -> Option<u32> {
        let run = &self.main;
        let free = run.plan.is_none() && run.calls.is_empty() && run.finishing.is_none();
        (free && run.place.program == ProgramId::Dnc).then_some(run.place.block)
    }

    /// Notes that the first `count` blocks of the arriving program are dropped, so that its
    /// indices shift.
    pub(crate) const fn blocks_gone(&mut self, count: u32) {
        self.main.place.block = self.main.place.block.saturating_sub(count);
    }

    /// A local variable of macro B in the innermost call of the automatic run; `None` is null.
    pub fn local(&self, number: u8) -> Option<f64> {
        self.main.levels.get(number)
    }

    /// Sets a local variable of macro B; `None` makes it null.
    pub(crate) fn set_local(&mut self, number: u8, value: Option<f64>) {
        self.main.levels.set(number, value);
    }

    /// A measure of work: blocks read so far, plus one for each 64 bytes of their text.
    pub(crate) const fn work(&self) -> u64 {
        self.recent.work()
    }

    /// Whether commands of the block read last remain.
    pub(crate) fn in_block(&self) -> bool {
        self.run().plan.is_some()
    }

    /// Starts a run over a program, at the first block at or after a line (from 1). Takes the
    /// position from the host and keeps the modal state.
    pub fn start(&mut self, program: ProgramId, line: u32, host: &impl Host) {
        let block = host
            .programs()
            .get(program)
            .map_or(0, |text| text.block_from_line(line));
        self.main = Run::from(Place { program, block });
        self.mdi = None;
        self.drop_compensation();
        self.jumps = Jumps::default();
        self.state.scale = None;
        self.resync(host);
        if self.record().returns_to_start() {
            let work = self.state.position;
            let machine = self.state.machine(work);
            self.state.begun = Some(Begun { machine, work });
        }
    }

    /// Starts a run over the block from the MDI page. After its end [`next`](Self::next)
    /// continues the automatic run, if there is one.
    pub(crate) fn start_mdi(&mut self, program: Program, host: &impl Host) {
        let run = Run::from(Place {
            program: ProgramId::Mdi,
            block: 0,
        });
        self.mdi = Some(Mdi { program, run });
        self.resync(host);
    }

    /// Ends the run over the MDI block.
    pub(crate) fn leave_mdi(&mut self) {
        self.mdi = None;
    }

    /// The state of the automatic run at its last block read.
    pub(crate) const fn read_to(&self) -> ReadTo {
        ReadTo(self.state)
    }

    /// Restores the position of the automatic run after MDI blocks. Their modal codes stay in
    /// force, and so does their frame unless `same_frame` is set.
    pub(crate) fn stand_where_read(&mut self, read_to: &ReadTo, same_frame: bool) {
        let ReadTo(before) = read_to;
        if same_frame {
            self.state.zero = before.zero;
            self.state.offset = before.offset;
            self.state.untravelled = before.untravelled;
        }
        self.state.stand_at(before.machine(before.position));
        self.state.ahead = before.ahead;
        self.state.threading = before.threading;
    }

    /// Takes the position from the host again, after manual motion.
    pub fn resync(&mut self, host: &impl Host) {
        self.lay_aside();
        self.state
            .stand_at(Exact::from_point(host.machine_position()));
    }

    /// Puts another coordinate frame into force, at power-on or after a manual reference
    /// return sets coordinates.
    pub(crate) fn set_frame(&mut self, frame: Frame, host: &impl Host) {
        self.state.zero = Exact::from_point(frame.zero);
        self.state.zero_offset = Exact::from_point(frame.zero_offset.point());
        self.state.offset = Exact::from_point(frame.offset);
        self.resync(host);
    }

    /// Cancels the tool offset of an axis, as manual returns to the reference point and to the
    /// program zero do.
    pub(crate) fn cancel_offset(&mut self, axis: Axis, host: &impl Host) {
        self.state.offset.set(axis, 0);
        *self.state.untravelled.get_mut(axis) = false;
        if self.state.offset == Exact::default() {
            self.state.cancel_offset_number();
        }
        self.resync(host);
    }

    /// Sets the M codes of the machine's ladder.
    pub(crate) const fn set_machine_codes(&mut self, codes: MachineCodes) {
        self.machine_codes = codes;
    }

    /// Sets the tool number after a manual tool change.
    pub(crate) const fn set_tool(&mut self, tool: u8) {
        self.state.modal.tool = tool;
    }

    /// RESET, or the end of a program. Ends the runs, clears the stored words of cycles,
    /// cancels G41 and G42 and drops their vector. Modal codes stay. 004.3 TOC decides whether
    /// the offset stays.
    pub fn reset(&mut self, host: &impl Host) {
        self.main = Run::over();
        self.mdi = None;
        self.drop_compensation();
        self.state.modal.nose_compensation = 40;
        self.state.cycle.clear();
        self.state.scale = None;
        if !host.parameters().reset_keeps_offset() {
            self.state.offset = Exact::default();
            self.state.cancel_offset_number();
            self.state.untravelled = Default::default();
        }
        self.resync(host);
    }

    /// The next command. Reads at most a few blocks and makes at most one command, so that it
    /// never delays a tick.
    ///
    /// # Errors
    /// The alarm of the block being read. The block has no effect then, and the next call
    /// reads it again.
    pub fn next(&mut self, host: &mut impl Host) -> Result<Step, Alarm> {
        Ok(match self.advance(host)? {
            Advance::Command(command) => Step::Command(Box::new(command)),
            Advance::Wait | Advance::Starved => Step::Wait,
            Advance::Ended => Step::Ended,
        })
    }

    fn run(&self) -> &Run {
        self.mdi.as_ref().map_or(&self.main, |mdi| &mdi.run)
    }

    fn run_mut(&mut self) -> &mut Run {
        match &mut self.mdi {
            Some(mdi) => &mut mdi.run,
            None => &mut self.main,
        }
    }
}
