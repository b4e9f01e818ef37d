//! The state of a run over programs: the next block, the running calls, and the remaining
//! commands of the block read last.

use serde::{Deserialize, Serialize};

use crate::command::{BlockNumber, Command, ProgramId, Source};
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::flow::{Finishing, Flow, MacroEntry};
use crate::interpreter::context::place::{Call, CallKind, Place};
use crate::interpreter::macros::levels::Levels;
use crate::interpreter::plan::Plan;

/// A run over programs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Run {
    /// The position of the next block to read.
    #[serde(rename = "place")]
    pub(crate) place: Place,
    /// The running calls, the innermost last.
    pub(crate) calls: Vec<Call>,
    /// Local variables, loops and modal calls of macros.
    #[serde(default, skip_serializing_if = "Levels::is_empty")]
    pub(crate) levels: Levels,
    /// The last sequence number (N) read.
    pub(crate) sequence: Option<BlockNumber>,
    /// The source position of the block read last.
    pub(crate) source: Option<Source>,
    /// Its remaining commands; `None` if all are taken.
    pub(crate) plan: Option<Plan>,
    /// The explanation data of the last move of a finished plan.
    #[serde(rename = "note")]
    pub(crate) note: Option<Note>,
    /// Whether the command taken last is a move along a contour, where G41 and G42 act.
    #[serde(rename = "contour")]
    pub(crate) contour: bool,
    /// The profile that a G70 runs through.
    pub(crate) finishing: Option<Finishing>,
    /// Whether the reader pauses until every command is finished (after M00).
    #[serde(rename = "paused")]
    pub(crate) paused: bool,
    #[serde(rename = "ended")]
    pub(crate) ended: bool,
}

impl Run {
    /// A run that starts at a block.
    pub(crate) const fn from(place: Place) -> Self {
        Self {
            place,
            calls: Vec::new(),
            levels: Levels::new(),
            sequence: None,
            source: None,
            plan: None,
            note: None,
            contour: false,
            finishing: None,
            paused: false,
            ended: false,
        }
    }

    /// A run that has ended.
    pub(crate) const fn over() -> Self {
        let mut run = Self::from(Place {
            program: ProgramId::External,
            block: 0,
        });
        run.ended = true;
        run
    }

    /// Takes the next command of the block read last; after its last command sets the next
    /// block.
    #[inline]
    pub(crate) fn take(&mut self) -> Option<Command> {
        let plan = self.plan.as_mut()?;
        self.contour = plan.motion.is_contour() && !plan.apart;
        let command = plan.take();
        if plan.is_done() {
            let flow = core::mem::take(&mut plan.flow);
            self.note = plan.note();
            self.plan = None;
            self.follow(flow);
        }
        command
    }

    /// Records that the block read last was only a move along the contour and that its command
    /// is taken.
    pub(crate) const fn move_alone(&mut self) {
        self.contour = true;
        self.note = None;
        self.place = self.place.after();
    }

    /// The flow after a move: the call of the last G66, or the next block.
    pub(crate) fn modal_call(&self, place: Place) -> Flow {
        let Some((index, modal)) = self.levels.modal(&self.calls) else {
            return Flow::Next;
        };
        let call = Call {
            program: modal.program,
            runs: modal.runs,
            back: place.after(),
            kind: CallKind::Modal(index),
            first: 0,
            blocks: None,
            codes_ordinary: false,
        };
        let arguments = modal.arguments.clone();
        Flow::MacroCall(Box::new(MacroEntry { call, arguments }))
    }

    fn follow(&mut self, flow: Flow) {
        match flow {
            Flow::Next => self.place = self.place.after(),
            Flow::Jump(place) => {
                self.levels.jump(self.calls.len(), place.block);
                self.place = place;
            }
            Flow::Finish(finishing) => {
                self.place = finishing.first;
                self.finishing = Some(*finishing);
            }
            Flow::Call(call) => {
                self.place = call.begin();
                self.calls.push(call);
            }
            Flow::MacroCall(entry) => {
                let MacroEntry { call, arguments } = *entry;
                self.place = call.begin();
                self.calls.push(call);
                self.levels.enter(arguments);
            }
            Flow::Again => {
                let depth = self.calls.len();
                if let Some(call) = self.calls.last_mut() {
                    self.levels.run_again(call, depth);
                    call.runs = call.runs.saturating_sub(1);
                    self.place = call.begin();
                }
            }
            Flow::Return(place) => {
                if let Some(call) = self.calls.pop() {
                    self.levels.leave(&call, self.calls.len());
                }
                // M99 P may lead out of a loop.
                self.levels.jump(self.calls.len(), place.block);
                self.place = place;
            }
            Flow::End => {
                self.calls.clear();
                self.levels = Levels::new();
                self.ended = true;
            }
        }
    }
}
