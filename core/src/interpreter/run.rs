//! Where a run stands in its programs: the next block, the calls under way,
//! and what is left of the block read last.

use serde::{Deserialize, Serialize};

use crate::command::{BlockNumber, Command, ProgramId, Source};
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::flow::{Finishing, Flow, MacroEntry};
use crate::interpreter::context::place::{Call, CallKind, Place};
use crate::interpreter::macros::levels::Levels;
use crate::interpreter::plan::Plan;

/// One run over programs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Run {
    /// The next block to read.
    pub(crate) place: Place,
    /// Calls under way, the innermost last.
    pub(crate) calls: Vec<Call>,
    /// Variables, loops and the modal call of macros.
    #[serde(default, skip_serializing_if = "Levels::is_empty")]
    pub(crate) levels: Levels,
    /// The last N met.
    pub(crate) sequence: Option<BlockNumber>,
    /// The block read last.
    pub(crate) source: Option<Source>,
    /// Its commands not taken yet.
    pub(crate) plan: Option<Plan>,
    /// What the last move of a finished plan belongs to.
    pub(crate) note: Option<Note>,
    /// The command taken last came from a block along a contour.
    pub(crate) contour: bool,
    /// The profile that a G70 runs through.
    pub(crate) finishing: Option<Finishing>,
    /// Nothing more is read before everything is finished (after M00).
    pub(crate) paused: bool,
    pub(crate) ended: bool,
}

impl Run {
    /// A run about to read a block.
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

    /// A run that is over.
    pub(crate) const fn over() -> Self {
        let mut run = Self::from(Place {
            program: ProgramId::External,
            block: 0,
        });
        run.ended = true;
        run
    }

    /// The next command of the block read last; at its end, turns to the
    /// block that follows.
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

    /// The block read last was a move along the contour and nothing else: it is taken,
    /// and the next block follows.
    pub(crate) const fn move_alone(&mut self) {
        self.contour = true;
        self.note = None;
        self.place = self.place.after();
    }

    /// What a move leads to: the call of the last G66, or the next block.
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
