//! Starts of the board: those that were asked for, and those that were not.

use core::time::Duration;

use crate::HostTime;

/// A board that gave up a reference return has restarted by then.
const EXCUSED: Duration = Duration::from_secs(1);

/// Whether the board has started by itself since it became known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Start {
    /// It has not.
    #[default]
    None,
    /// It has said that it starts; its banner is still to come, and no news.
    Begun,
    /// It may be another one, or set otherwise.
    Restarted,
}

/// What is known of the starts of a board, and what is to be done behind one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Startup {
    start: Start,
    /// A board that gave up restarts; its banner is no surprise until then.
    excused_until: HostTime,
    /// It is unlocked as soon as it listens: the operator pressed RESET, or it has made the
    /// reference return of one axis and waits for the other.
    pub(super) unlocks: bool,
}

impl Startup {
    /// A start within the next second is no surprise.
    pub(super) fn excuse(&mut self, now: HostTime) {
        self.excused_until = now + EXCUSED;
    }

    /// The board says that it starts.
    pub(super) const fn has_begun(&mut self) {
        self.start = Start::Begun;
    }

    /// The board has started by itself.
    pub(super) fn has_restarted(&mut self) {
        if self.start == Start::None {
            self.start = Start::Restarted;
        }
    }

    /// Whether it has, and was not opened anew since.
    pub(super) fn is_restarted(&self) -> bool {
        self.start != Start::None
    }

    /// Whether a banner that has come is no news.
    pub(super) fn expects_banner(&mut self, now: HostTime) -> bool {
        let begun = self.start == Start::Begun;
        let expected = begun || now < self.excused_until;
        if begun {
            self.start = Start::Restarted;
        }
        expected
    }

    /// The board is asked anew who it is, and unlocked then.
    pub(super) const fn begin_anew(&mut self) {
        self.start = Start::None;
        self.unlocks = true;
    }
}
