//! Decides whether the keys that hold a panel key down are still held. A lost release, or
//! one that a hung display delays, must not move an axis: a held key needs proof from the
//! display server, renewed several times a second.
//!
//! ```text
//!   window ──holders──► InputWatch ◄──replies── platform ──query──► display server
//!                           │                                       (separate connection)
//!   kernel thread ◄──proof──┘
//! ```
//!
//! Painted frames prove only that the window draws. All times are arguments, taken from
//! [`crate::platform::time_with_sleep`].

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use web_time::Duration;

/// Time between two queries to the display, and between two frames of the window while keys
/// are held.
pub const QUERY_INTERVAL: Duration = Duration::from_millis(50);
/// Held keys are released when the newest proof that they are held is older than this.
/// Together with the lookahead of a board and the ramp of a rapid the axis stops within 600
/// ms.
const LEASE: Duration = Duration::from_millis(130);
/// As [`LEASE`], while the lathe is simulated, which can hurt no one.
const LEASE_SIMULATED: Duration = Duration::from_millis(600);
/// Held keys are released when the last message of the window is older than this; it allows
/// for the time to draw a frame.
const WINDOW_LEASE: Duration = Duration::from_millis(250);
/// A display without a reply for this time has hung.
const HANG_TIMEOUT: Duration = Duration::from_millis(350);
/// A display that has hung delivers old key presses first. Its input counts again after the
/// display has replied steadily for this time.
const SETTLE_TIME: Duration = Duration::from_millis(300);

/// The input devices that hold keys of the panel down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Holders {
    /// Number of keys that are down on the PC keyboard.
    pub keys: usize,
    /// Whether a mouse button is down.
    pub pointer: bool,
    /// Number of fingers on the screen, which display servers do not report.
    pub fingers: usize,
}

impl Holders {
    /// Whether any input device holds a key.
    pub const fn any(self) -> bool {
        self.keys > 0 || self.pointer || self.fingers > 0
    }

    /// Whether the reply of a display confirms these holders: `keys` keys (modifiers not
    /// counted) and, with `pointer`, a mouse button are down.
    const fn are_confirmed_by(self, keys: usize, pointer: bool) -> bool {
        keys >= self.keys && (pointer || !self.pointer)
    }
}

/// The reply of the display server to a query of keys and buttons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DisplayReply {
    /// The display reports how many keys and whether a mouse button are down.
    Down {
        /// Number of keys that are down, without modifiers.
        keys: usize,
        /// Whether a mouse button is down.
        pointer: bool,
    },
    /// The display responds but cannot report which keys are down.
    Alive,
}

/// The input device that shows whether keys are still held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum ProofSource {
    /// The display; there is no proof before its first reply.
    #[default]
    Display,
    /// The frames of the window: this system has no display to query.
    Window,
}

#[derive(Debug, Default)]
struct State {
    source: ProofSource,
    holders: Holders,
    /// A board moves the slides, so the display is queried continuously.
    linked: bool,
    /// Whether the control is off, so that the display is no longer queried.
    ended: bool,
    /// Time of the newest query with a reply; `None` before the first one.
    last_reply: Option<Duration>,
    /// Time of the newest query whose reply confirmed that keys are held; `None` before the first
    /// one.
    last_proof: Option<Duration>,
    /// Time since which the display has replied without a pause; `None` while it does not.
    steady_since: Option<Duration>,
}

/// State about held keys, shared by the window, the kernel thread and the thread that queries
/// the display.
#[derive(Clone, Debug, Default)]
pub struct InputWatch(Arc<Mutex<State>>);

impl InputWatch {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Stores which input devices currently hold keys.
    pub fn set_holders(&self, holders: Holders) {
        self.state().holders = holders;
    }

    /// Stores whether a pulse board moves the slides.
    pub fn set_linked(&self, linked: bool) {
        self.state().linked = linked;
    }

    /// Accepts the frames of the window as proof that keys are held, on systems without a
    /// display to query.
    pub fn trust_window(&self) {
        self.state().source = ProofSource::Window;
    }

    /// Ends the queries, because the control is off.
    pub fn end(&self) {
        self.state().ended = true;
    }

    /// Whether the control is off.
    pub fn has_ended(&self) -> bool {
        self.state().ended
    }

    /// Whether the display must be queried for held keys.
    pub fn needs_query(&self) -> bool {
        let state = self.state();
        state.linked || state.holders.any()
    }

    /// Stores the reply to a query made at `queried` that arrived at `now`.
    pub fn record_reply(&self, queried: Duration, now: Duration, reply: DisplayReply) {
        let mut state = self.state();
        let pause = state.last_reply.map(|before| now.saturating_sub(before));
        if state.steady_since.is_none() || pause.is_none_or(|pause| pause > HANG_TIMEOUT) {
            state.steady_since = Some(now);
        }
        state.last_reply = Some(queried);
        let confirmed = match reply {
            DisplayReply::Down { keys, pointer } => state.holders.are_confirmed_by(keys, pointer),
            DisplayReply::Alive => true,
        };
        if confirmed {
            state.last_proof = Some(queried);
        }
    }

    /// Whether keys that went down at `pressed` must be released because there is no recent
    /// proof that they are held.
    pub fn has_lapsed(&self, pressed: Duration, now: Duration) -> bool {
        let state = self.state();
        let proof = state.last_proof.map_or(pressed, |proof| proof.max(pressed));
        let lease = if state.linked { LEASE } else { LEASE_SIMULATED };
        state.source == ProofSource::Display && now.saturating_sub(proof) > lease
    }

    /// Whether the last message of the window, sent at `last_message`, is so old that its keys
    /// must be released.
    pub fn has_window_lapsed(&self, last_message: Duration, now: Duration) -> bool {
        let lease = match self.state().linked {
            true => WINDOW_LEASE,
            false => LEASE_SIMULATED,
        };
        now.saturating_sub(last_message) > lease
    }

    /// Whether the display replies and has not hung recently, so that key presses and
    /// handwheel turns that arrive now were made now.
    pub fn is_fresh(&self, now: Duration) -> bool {
        let state = self.state();
        let age = |at: Option<Duration>| at.map(|at| now.saturating_sub(at));
        state.source == ProofSource::Window
            || age(state.last_reply).is_some_and(|age| age <= HANG_TIMEOUT)
                && age(state.steady_since).is_some_and(|age| age >= SETTLE_TIME)
    }

    /// Whether the display has not replied to queries for too long.
    pub fn is_silent(&self, now: Duration) -> bool {
        let state = self.state();
        let is_old = |at| now.saturating_sub(at) > LEASE;
        state.source == ProofSource::Display && state.last_reply.is_none_or(is_old)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    const ONE_KEY: Holders = Holders {
        keys: 1,
        pointer: false,
        fingers: 0,
    };

    /// Records replies of a display that replies within 5 ms, from 0 to `end` ms.
    fn reply_until(watch: &InputWatch, end: u64, reply: DisplayReply) {
        for queried in (0..end).step_by(100) {
            watch.record_reply(ms(queried), ms(queried + 5), reply);
        }
    }

    #[test]
    fn a_hung_display_proves_nothing() {
        let watch = InputWatch::default();
        watch.set_linked(true);
        watch.set_holders(ONE_KEY);
        let down = DisplayReply::Down {
            keys: 1,
            pointer: false,
        };
        reply_until(&watch, 1000, down);
        assert!(!watch.has_lapsed(ms(100), ms(1030)));
        assert!(watch.has_lapsed(ms(100), ms(1031)));
        assert!(!watch.is_silent(ms(1030)) && watch.is_silent(ms(1031)));
        assert!(watch.has_window_lapsed(ms(700), ms(1000)));
        // A late reply proves the time of its query.
        watch.record_reply(ms(1000), ms(4000), down);
        assert!(watch.has_lapsed(ms(100), ms(4000)));
        assert!(!watch.is_fresh(ms(4010)), "presses of the meantime");
        for queried in (4000..4400).step_by(100) {
            watch.record_reply(ms(queried), ms(queried + 5), down);
        }
        assert!(watch.is_fresh(ms(4310)));
    }

    #[test]
    fn a_display_with_the_key_up_proves_nothing() {
        for (holders, keys, pointer, held) in [
            (ONE_KEY, 0, true, false),
            (ONE_KEY, 1, false, true),
            (
                Holders {
                    pointer: true,
                    ..ONE_KEY
                },
                1,
                false,
                false,
            ),
            (
                Holders {
                    fingers: 2,
                    ..Holders::default()
                },
                0,
                false,
                true,
            ),
        ] {
            let watch = InputWatch::default();
            watch.set_holders(holders);
            watch.record_reply(
                ms(10_000),
                ms(10_001),
                DisplayReply::Down {
                    keys: 0,
                    pointer: false,
                },
            );
            watch.record_reply(ms(20_000), ms(20_001), DisplayReply::Down { keys, pointer });
            assert!(watch.has_lapsed(ms(0), ms(20_601)));
            assert_eq!(!watch.has_lapsed(ms(0), ms(20_600)), held, "{holders:?}");
        }
    }

    #[test]
    fn without_a_display_the_window_alone_counts() {
        let watch = InputWatch::default();
        assert!(watch.has_lapsed(ms(0), ms(700)) && !watch.is_fresh(ms(700)));
        watch.trust_window();
        assert!(!watch.has_lapsed(ms(0), ms(700)) && watch.is_fresh(ms(700)));
    }
}
