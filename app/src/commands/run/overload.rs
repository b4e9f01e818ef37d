//! Cuts above the limits while a program runs on the simulated lathe.

use gsk_core::machine::LatheFault;
use gsk_runner::machining::CutFault;
use gsk_runner::machining::live_part::LivePart;

use crate::cli::RunArgs;

/// The cuts that have broken something in a run.
pub(super) struct OverloadLog {
    /// Whether the slides are simulated: a cut breaks nothing on a real lathe.
    is_simulated: bool,
    /// The cut of the last tick; `None` without one.
    last: Option<CutFault>,
    /// All cuts, the first one first.
    cuts: Vec<CutFault>,
}

impl OverloadLog {
    pub(super) const fn new(args: &RunArgs) -> Self {
        Self {
            is_simulated: args.link.is_none(),
            last: None,
            cuts: Vec::new(),
        }
    }

    /// Takes over what the part has found in a tick. Returns the cut above the limits, if any.
    pub(super) fn follow_tick(&mut self, part: Option<&LivePart>) -> Option<CutFault> {
        let found = part.and_then(LivePart::cut_fault);
        self.last = found.filter(|_| self.is_simulated);
        self.cuts.extend(self.last);
        self.last
    }

    /// The fault of the last tick; `None` without one.
    pub(super) fn fault(&self) -> Option<LatheFault> {
        self.last.map(|it| it.fault())
    }

    /// Whether the last tick ends the run: a spindle that stalls and stock that is loose leave
    /// nothing to cut. With a broken insert the program runs on.
    pub(super) fn ends_run(&self) -> bool {
        self.fault()
            .is_some_and(|it| it != LatheFault::InsertBroken)
    }

    pub(super) fn cuts(&self) -> &[CutFault] {
        &self.cuts
    }
}
