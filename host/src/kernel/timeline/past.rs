//! A past moment that is shown: the machine at once, the part when it has been cut again.

use gsk_history::history::{History, HistorySeek};
use gsk_panel::emulator::Emulator;

use crate::kernel::part::KernelPart;

/// The machine and the part at a past moment of the session.
#[derive(Debug)]
pub(super) struct PastMachine {
    tick: u64,
    machine: Emulator,
    part: KernelPart,
    /// The seek that cuts the part; `None` for a stored state.
    seek: Option<HistorySeek>,
    is_part_pending: bool,
}

impl PastMachine {
    /// Computes the machine at a tick and starts to compute the part; `None` outside the session.
    /// `part` receives the part.
    pub(super) fn new(history: &History, tick: u64, part: KernelPart) -> Option<Self> {
        Some(Self {
            tick,
            machine: history.seek_machine(tick)?,
            part,
            seek: Some(history.begin_seek(tick)?),
            is_part_pending: true,
        })
    }

    /// Returns the last stored state before a tick; `None` outside the session.
    pub(super) fn stored(history: &History, tick: u64, mut part: KernelPart) -> Option<Self> {
        let moment = history.stored_state(tick)?;
        part.replace_state(moment.part);
        Some(Self {
            tick: moment.emulator.ticks(),
            machine: moment.emulator,
            part,
            seek: None,
            is_part_pending: false,
        })
    }

    /// Shows another tick instead; returns `None` if the tick is outside the session.
    pub(super) fn redirect(self, history: &History, tick: u64) -> Option<Self> {
        if tick == self.tick {
            return Some(self);
        }
        let seek = match self.seek {
            Some(seek) => history.redirect_seek(seek, tick)?,
            None => history.begin_seek(tick)?,
        };
        Some(Self {
            tick,
            machine: history.seek_machine(tick)?,
            seek: Some(seek),
            is_part_pending: true,
            ..self
        })
    }

    /// Continues the computation of the part by at most `max_ticks` ticks.
    pub(super) fn advance(&mut self, history: &History, max_ticks: u64) {
        let Some(seek) = self.seek.as_mut().filter(|_| self.is_part_pending) else {
            return;
        };
        if history.advance_seek(seek, max_ticks) {
            self.is_part_pending = false;
            self.part.replace_state(seek.moment().part.clone());
        }
    }

    /// Publishes the part once it is computed; returns `true` if there is something new.
    pub(super) fn publish_part(&mut self) -> bool {
        !self.is_part_pending && self.part.publish(&self.machine)
    }

    /// Sets whether a view shows the part.
    pub(super) fn set_part_visible(&mut self, visible: bool) {
        self.part.set_visible(visible);
    }

    pub(super) const fn tick(&self) -> u64 {
        self.tick
    }

    pub(super) const fn machine(&self) -> &Emulator {
        &self.machine
    }

    pub(super) const fn is_part_pending(&self) -> bool {
        self.is_part_pending
    }
}
