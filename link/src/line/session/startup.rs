//! Expected and unexpected restarts of a line board.

use core::time::Duration;

use crate::HostTime;

/// Time after aborted homing during which a restart of the board is expected.
const EXCUSED: Duration = Duration::from_secs(1);

/// Whether the board has restarted without a command of the link.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Start {
    /// The board has not restarted since the link was opened.
    #[default]
    None,
    /// The board has reported its start; its banner follows and is no further restart.
    Begun,
    /// The board has restarted. The board may now be another one or have other settings.
    Restarted,
}

/// Whether the board has restarted, until when a banner is expected, and whether to unlock it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Startup {
    start: Start,
    /// Host time until which a banner is expected and is no fault.
    excused_until: HostTime,
    /// Whether the link unlocks the board at the next report: after RESET, or after homing of
    /// one axis.
    pub(super) unlocks: bool,
}

impl Startup {
    /// Sets that a restart of the board is expected within a second from the host time `now`.
    pub(super) fn excuse(&mut self, now: HostTime) {
        self.excused_until = now + EXCUSED;
    }

    /// Records that the board has reported its start and will send its banner.
    pub(super) const fn has_begun(&mut self) {
        self.start = Start::Begun;
    }

    /// Records that the board has restarted without a command.
    pub(super) fn has_restarted(&mut self) {
        if self.start == Start::None {
            self.start = Start::Restarted;
        }
    }

    /// Whether the board has restarted without a command and the link has not repeated the opening
    /// since.
    pub(super) fn is_restarted(&self) -> bool {
        self.start != Start::None
    }

    /// Whether a banner received at the host time `now` is expected. After a reported start only
    /// the first banner is.
    pub(super) fn expects_banner(&mut self, now: HostTime) -> bool {
        let begun = self.start == Start::Begun;
        let expected = begun || now < self.excused_until;
        if begun {
            self.start = Start::Restarted;
        }
        expected
    }

    /// Forgets the restart and requests that the board is unlocked, because the link repeats the
    /// opening.
    pub(super) const fn begin_anew(&mut self) {
        self.start = Start::None;
        self.unlocks = true;
    }
}
