//! Data common to all links: state, time, certainty of the position, and pending events.

use gsk_messages::Message;

use crate::{HostTime, LinkEvent, LinkState, Uncertainty};

/// Whether the position of the slides is certain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Position {
    /// The slides are at the position that the kernel has commanded.
    Known,
    /// The slides may be at another position than commanded, for this reason.
    Uncertain(Uncertainty),
}

/// State, time and pending events of the connection to a board.
#[derive(Clone, Debug)]
pub struct LinkSession {
    pub(crate) state: LinkState,
    pub(crate) now: HostTime,
    position: Position,
    /// Whether the link accepts manual motion although the position is uncertain.
    pub(crate) released: bool,
    pub(crate) events: Vec<LinkEvent>,
}

impl LinkSession {
    /// Creates the session of a link whose port was just opened.
    pub(crate) const fn new(now: HostTime) -> Self {
        Self {
            state: LinkState::Opening,
            now,
            position: Position::Uncertain(Uncertainty::Unreferenced),
            released: false,
            events: Vec::new(),
        }
    }

    /// Returns the time from `moment` to the current host time; 0 if `moment` is later.
    pub(crate) const fn since(&self, moment: HostTime) -> HostTime {
        self.now.saturating_sub(moment)
    }

    /// Whether the port is closed or the board is lost. Only the caller can reopen the port.
    pub(crate) const fn is_closed(&self) -> bool {
        matches!(self.state, LinkState::Off | LinkState::Lost)
    }

    /// Changes the state of the link and reports the change to the kernel.
    pub(crate) fn enter(&mut self, state: LinkState) {
        if self.state != state {
            self.state = state;
            self.events.push(LinkEvent::State(state));
        }
    }

    /// Reports an alarm to the kernel.
    pub(crate) fn alarm(&mut self, number: u16, detail: Message) {
        self.events.push(LinkEvent::Alarm { number, detail });
    }

    /// Whether the slides are at the kernel's position.
    pub(crate) const fn knows_position(&self) -> bool {
        matches!(self.position, Position::Known)
    }

    /// Returns why the position is uncertain; `None` if the position is known.
    pub(crate) const fn uncertainty(&self) -> Option<Uncertainty> {
        match self.position {
            Position::Known => None,
            Position::Uncertain(uncertainty) => Some(uncertainty),
        }
    }

    /// Marks the position as known: the counts of kernel and board agree.
    pub(crate) const fn confirm_position(&mut self) {
        self.position = Position::Known;
    }

    /// Permits manual motion although the position is unknown.
    pub(crate) const fn release(&mut self) {
        self.position = Position::Uncertain(Uncertainty::Unreferenced);
        self.released = true;
    }

    /// Marks the position as uncertain for this reason; an earlier reason is kept.
    pub(crate) const fn lose_position(&mut self, uncertainty: Uncertainty) {
        if self.knows_position() {
            self.position = Position::Uncertain(uncertainty);
        }
        self.released = false;
    }

    /// Replaces the reason why the position is uncertain, after the board has reported it.
    pub(crate) const fn replace_uncertainty(&mut self, uncertainty: Uncertainty) {
        if !self.knows_position() {
            self.position = Position::Uncertain(uncertainty);
        }
    }

    /// Returns the state of axes at standstill: [`LinkState::Ready`], or [`LinkState::Locked`] if
    /// the position is uncertain.
    pub(crate) const fn standing_state(&self) -> LinkState {
        if self.knows_position() {
            LinkState::Ready
        } else {
            LinkState::Locked
        }
    }
}
