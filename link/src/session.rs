//! What a link keeps whatever its board speaks: where it stands with the board, how far
//! the position can be relied on, and what the kernel has not heard yet.

use gsk_messages::Message;

use crate::{HostTime, LinkEvent, LinkState, Uncertainty};

/// How far the position of the slides can be relied on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Position {
    /// The slides stand where the kernel says.
    Known,
    /// They may not, for this reason.
    Uncertain(Uncertainty),
}

/// State, time and events of a link.
#[derive(Clone, Debug)]
pub struct LinkSession {
    pub(crate) state: LinkState,
    pub(crate) now: HostTime,
    position: Position,
    /// Motion is taken in a state that takes none: the operator moves the axes by hand.
    pub(crate) released: bool,
    pub(crate) events: Vec<LinkEvent>,
}

impl LinkSession {
    /// A link whose port has just been opened.
    pub(crate) const fn new(now: HostTime) -> Self {
        Self {
            state: LinkState::Opening,
            now,
            position: Position::Uncertain(Uncertainty::Unreferenced),
            released: false,
            events: Vec::new(),
        }
    }

    /// Time passed since a moment.
    pub(crate) const fn since(&self, moment: HostTime) -> HostTime {
        self.now.saturating_sub(moment)
    }

    /// Whether the port is closed or the board lost: nothing more happens by itself.
    pub(crate) const fn is_closed(&self) -> bool {
        matches!(self.state, LinkState::Off | LinkState::Lost)
    }

    /// Another state, which the kernel hears of.
    pub(crate) fn enter(&mut self, state: LinkState) {
        if self.state != state {
            self.state = state;
            self.events.push(LinkEvent::State(state));
        }
    }

    /// An alarm of the table, with its cause.
    pub(crate) fn alarm(&mut self, number: u16, detail: Message) {
        self.events.push(LinkEvent::Alarm { number, detail });
    }

    /// Whether the slides stand where the kernel says.
    pub(crate) const fn knows_position(&self) -> bool {
        matches!(self.position, Position::Known)
    }

    /// Why they may not.
    pub(crate) const fn uncertainty(&self) -> Option<Uncertainty> {
        match self.position {
            Position::Known => None,
            Position::Uncertain(uncertainty) => Some(uncertainty),
        }
    }

    /// The kernel and the board agree where the slides stand.
    pub(crate) const fn confirm_position(&mut self) {
        self.position = Position::Known;
    }

    /// Nobody knows where the slides stand, and they are moved all the same.
    pub(crate) const fn release(&mut self) {
        self.position = Position::Uncertain(Uncertainty::Unreferenced);
        self.released = true;
    }

    /// Nobody knows any more where the slides stand; the first reason stays.
    pub(crate) const fn lose_position(&mut self, uncertainty: Uncertainty) {
        if self.knows_position() {
            self.position = Position::Uncertain(uncertainty);
        }
        self.released = false;
    }

    /// The state of a link whose axes stand and whose count agrees.
    pub(crate) const fn standing_state(&self) -> LinkState {
        if self.knows_position() {
            LinkState::Ready
        } else {
            LinkState::Locked
        }
    }
}
