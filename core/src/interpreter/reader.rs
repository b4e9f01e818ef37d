//! The interpreter itself: reads blocks as far as it may and hands out their
//! commands one at a time.

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

/// Blocks to commands. Plain data: it can be saved and restored at any time.
///
/// A *run* begins with [`start`](Self::start); [`next`](Self::next) then gives
/// one command a call until [`Step::Ended`]. A block keyed in on the MDI page
/// is a run of its own (`start_mdi`) that leaves a stopped
/// automatic run where it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interpreter {
    pub(super) state: State,
    pub(super) main: Run,
    pub(super) mdi: Option<Mdi>,
    /// The nose radius compensation of the automatic run.
    pub(super) compensation: Compensation,
    /// Programmed end of what a compensated run has read, machine coordinates,
    /// while something else moves the tool.
    pub(super) aside: Option<Exact>,
    jumps: Jumps,
    machine_codes: MachineCodes,
    /// Whether the control has the option of macro B.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    macro_b: bool,
    /// Whose programs are read.
    #[serde(default, skip_serializing_if = "ControlModel::is_delivered_main")]
    model: ControlModel,
    /// Whether that model has variables of its own.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    own_variables: bool,
    /// Codes of macro B that call a program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    code_calls: Option<Box<CodeCalls>>,
    /// Looks for words that change nothing; a preview alone does.
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

/// Where a run has been read to, while the tool stands elsewhere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ReadTo(State);

/// One answer of [`Interpreter::advance`], the command in place.
pub(crate) enum Advance {
    Command(Command),
    Wait,
    /// What follows has not come through the line yet.
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

    /// Whether programs are in inches, from the next block on.
    pub(crate) const fn set_inch_input(&mut self, inch: bool) {
        self.state.modal.inch = inch;
    }

    /// The option of macro B, from the next block on.
    pub fn set_macro_b(&mut self, on: bool) {
        self.macro_b = on;
        self.find_code_calls();
    }

    /// The codes that call a program, which belong to macro B.
    fn find_code_calls(&mut self) {
        self.code_calls = match self.macro_b {
            true => CodeCalls::of(&self.model),
            false => None,
        };
    }

    /// Whose programs are read, from the next block on.
    pub fn set_model(&mut self, model: &ControlModel) {
        self.model.clone_from(model);
        self.own_variables = model.record().own_variables;
        self.find_code_calls();
    }

    /// Looks for words that change nothing, from the next block on.
    pub(crate) fn audit_words(&mut self) {
        self.audit = Some(Box::default());
    }

    /// Whether something was found since the last call of [`Self::take_remarks`].
    #[inline]
    pub(crate) fn has_remarks(&self) -> bool {
        self.audit.as_ref().is_some_and(|audit| audit.has_remarks())
    }

    /// What was found since the last call.
    pub(crate) fn take_remarks(&mut self) -> Vec<Remarked> {
        let audit = self.audit.as_mut();
        audit.map_or_else(Vec::new, |audit| audit.take())
    }

    /// What the model is whose programs are read.
    pub(crate) fn record(&self) -> &'static Record {
        self.model.record()
    }

    /// How blocks of a program are read now.
    pub(crate) fn syntax(
        &self,
        program: ProgramId,
        text: &Program,
        parameters: &Parameters,
    ) -> Syntax {
        Syntax {
            inch: self.state.modal.inch,
            // What comes in through the line has no place to jump to.
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

    /// Spindle and coolant stopped without a program: the last M code is the one for that.
    pub(crate) const fn machine_stopped(&mut self) {
        self.state.modal.m = match self.state.modal.m {
            Some(3 | 4) => Some(5),
            Some(8) => Some(9),
            other => other,
        };
    }

    /// The thread lead in force, mm; zero = none yet.
    pub const fn thread_lead(&self) -> f64 {
        self.state.lead
    }

    /// The coordinate frame after the block read last.
    pub fn frame(&self) -> Frame {
        self.state.frame()
    }

    /// Programmed position where the motion read so far ends, radius mm.
    pub fn position(&self) -> Point {
        self.state.position.point()
    }

    /// The block read last, in the run that goes on.
    pub fn cursor(&self) -> Option<Source> {
        self.run().source
    }

    /// Why the move of a cycle taken last is where it is: its pass, level, depth
    /// and formula. `None` outside cycles. Worked out when asked.
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

    /// How many subprogram calls are under way.
    pub fn depth(&self) -> usize {
        self.run().calls.len()
    }

    /// The block of the program coming in through the line that is read next; none
    /// while a place in it is kept.
    pub(crate) fn next_coming_in(&self) -> Option<u32> {
        let run = &self.main;
        let free = run.plan.is_none() && run.calls.is_empty() && run.finishing.is_none();
        (free && run.place.program == ProgramId::Dnc).then_some(run.place.block)
    }

    /// So many blocks in front of that one are gone.
    pub(crate) const fn blocks_gone(&mut self, count: u32) {
        self.main.place.block = self.main.place.block.saturating_sub(count);
    }

    /// A local variable of macro B in the innermost call of the automatic run; `None`: null.
    pub fn local(&self, number: u8) -> Option<f64> {
        self.main.levels.get(number)
    }

    /// Gives it a value, or makes it null.
    pub(crate) fn set_local(&mut self, number: u8, value: Option<f64>) {
        self.main.levels.set(number, value);
    }

    /// Blocks read so far, and one more for each 64 bytes of their texts.
    pub(crate) const fn work(&self) -> u64 {
        self.recent.work()
    }

    /// Whether commands of the block read last are still to come.
    pub(crate) fn in_block(&self) -> bool {
        self.run().plan.is_some()
    }

    /// Starts a run over a program at the first block of a line or after it.
    /// The position comes from the host, the modal state stays.
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

    /// Starts a run over the block keyed in on the MDI page. After its end
    /// [`next`](Self::next) goes on with the automatic run, if one stands.
    pub(crate) fn start_mdi(&mut self, program: Program, host: &impl Host) {
        let run = Run::from(Place {
            program: ProgramId::Mdi,
            block: 0,
        });
        self.mdi = Some(Mdi { program, run });
        self.resync(host);
    }

    /// The run over the MDI block is over.
    pub(crate) fn leave_mdi(&mut self) {
        self.mdi = None;
    }

    /// Where the automatic run has been read to.
    pub(crate) const fn read_to(&self) -> ReadTo {
        ReadTo(self.state)
    }

    /// After MDI blocks the automatic run counts on from where it was read to. The
    /// modal codes that they left are in force, and so is a frame that they changed.
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

    /// Takes the position from the host again (after manual motion).
    pub fn resync(&mut self, host: &impl Host) {
        self.lay_aside();
        self.state
            .stand_at(Exact::from_point(host.machine_position()));
    }

    /// Puts another coordinate frame into force: at power-on, or after a
    /// manual reference return sets coordinates.
    pub(crate) fn set_frame(&mut self, frame: Frame, host: &impl Host) {
        self.state.zero = Exact::from_point(frame.zero);
        self.state.zero_offset = Exact::from_point(frame.zero_offset.point());
        self.state.offset = Exact::from_point(frame.offset);
        self.resync(host);
    }

    /// Cancels the tool offset of an axis, as manual returns to the reference
    /// point and to the program zero do.
    pub(crate) fn cancel_offset(&mut self, axis: Axis, host: &impl Host) {
        self.state.offset.set(axis, 0);
        *self.state.untravelled.get_mut(axis) = false;
        if self.state.offset == Exact::default() {
            self.state.cancel_offset_number();
        }
        self.resync(host);
    }

    /// M codes that the machine's ladder carries out.
    pub(crate) const fn set_machine_codes(&mut self, codes: MachineCodes) {
        self.machine_codes = codes;
    }

    /// The tool number shown after a manual tool change.
    pub(crate) const fn set_tool(&mut self, tool: u8) {
        self.state.modal.tool = tool;
    }

    /// RESET, and the end of a program: runs are over, the stored words of
    /// cycles are cleared, modal codes stay, but G41 and G42 are cancelled and
    /// their vector is dropped. The offset stays by 004.3 TOC.
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

    /// The next command. Reads at most a few blocks and makes at most one
    /// command, so that a tick is never held up.
    ///
    /// # Errors
    /// The alarm of the block being read. The block has had no effect then,
    /// and the next call reads it again.
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
