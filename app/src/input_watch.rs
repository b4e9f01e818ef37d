//! Proof that what holds a key of the panel still holds it. A release that is lost, or held
//! up by a display that hangs, moves nothing: a key is held only as long as the display
//! goes on to answer, and to show it held.
//!
//! ```text
//!   window ──holders──► InputWatch ◄──answers── platform ──question──► display server
//!                           │                                          (a connection of its own)
//!   kernel thread ◄──proof──┘
//! ```
//!
//! Painted pictures prove only that the window draws. All times are handed in: those of
//! [`crate::platform::time_with_sleep`].

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use web_time::Duration;

/// Between two questions to the display, and between two pictures of the window while
/// keys are held.
pub const ASK_EVERY: Duration = Duration::from_millis(50);
/// Held keys are let go when nothing has proved them held for so long. With the lookahead of
/// a board and the ramp of a rapid the axis stands within 600 ms.
const LEASE: Duration = Duration::from_millis(130);
/// The same of the simulated lathe, which hurts nobody.
const LEASE_SIMULATED: Duration = Duration::from_millis(600);
/// Held keys are let go when the window has said nothing for so long: it draws, which takes
/// time.
const WINDOW_LEASE: Duration = Duration::from_millis(250);
/// A display that has not answered for so long has hung.
const HANGS: Duration = Duration::from_millis(350);
/// A display that has hung hands over what was pressed meanwhile; it is believed again when
/// it has answered for so long.
const SETTLES: Duration = Duration::from_millis(300);

/// What holds keys of the panel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Holders {
    /// Keys of the PC keyboard.
    pub keys: usize,
    /// A button of the mouse.
    pub pointer: bool,
    /// Fingers; a display is not asked for them.
    pub fingers: usize,
}

impl Holders {
    /// Whether anything is held.
    pub const fn any(self) -> bool {
        self.keys > 0 || self.pointer || self.fingers > 0
    }

    /// Whether a display that shows so many keys (without Shift, Ctrl and the like), and a
    /// button of the mouse or none, shows these holders.
    pub const fn are_shown(self, keys: usize, pointer: bool) -> bool {
        keys >= self.keys && (pointer || !self.pointer)
    }
}

/// What a display answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// Keys that are down, without Shift, Ctrl and the like, and a button of the mouse.
    Down {
        /// Count of keys.
        keys: usize,
        /// A button of the mouse is down.
        pointer: bool,
    },
    /// It answers, and tells nobody what is down.
    Untold,
}

/// Who proves that keys are held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Witness {
    /// The display; as long as it has not answered there is no proof.
    #[default]
    Display,
    /// Nobody but the window: the system has nothing to be asked.
    Window,
}

#[derive(Debug, Default)]
struct State {
    witness: Witness,
    holders: Holders,
    /// A board moves slides: the display is asked all the time.
    linked: bool,
    /// The control is off: nothing more is asked.
    over: bool,
    /// When the newest question was asked that has been answered.
    answered: Option<Duration>,
    /// The same of a question whose answer showed what is held.
    proved: Option<Duration>,
    /// Since when the display has answered without a pause.
    steady: Option<Duration>,
}

/// Shared by the window, the kernel thread and the thread that asks the display.
#[derive(Clone, Debug, Default)]
pub struct InputWatch(Arc<Mutex<State>>);

impl InputWatch {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What holds keys now.
    pub fn hold(&self, holders: Holders) {
        self.state().holders = holders;
    }

    /// Whether a board moves slides.
    pub fn set_linked(&self, linked: bool) {
        self.state().linked = linked;
    }

    /// There is nothing to be asked on this system: the pictures of the window count.
    pub fn trust_window(&self) {
        self.state().witness = Witness::Window;
    }

    /// The control is off.
    pub fn end(&self) {
        self.state().over = true;
    }

    /// Whether the control is off.
    pub fn is_over(&self) -> bool {
        self.state().over
    }

    /// Whether the display is to be asked.
    pub fn is_wanted(&self) -> bool {
        let state = self.state();
        state.linked || state.holders.any()
    }

    /// The display has answered now what it was asked at a moment.
    pub fn answer(&self, asked: Duration, now: Duration, shown: Shown) {
        let mut state = self.state();
        let pause = state.answered.map(|before| now.saturating_sub(before));
        if state.steady.is_none() || pause.is_none_or(|pause| pause > HANGS) {
            state.steady = Some(now);
        }
        state.answered = Some(asked);
        let held = match shown {
            Shown::Down { keys, pointer } => state.holders.are_shown(keys, pointer),
            Shown::Untold => true,
        };
        if held {
            state.proved = Some(asked);
        }
    }

    /// Whether nothing has proved that the keys are held which went down at a moment.
    pub fn has_lapsed(&self, pressed: Duration, now: Duration) -> bool {
        let state = self.state();
        let proved = state.proved.map_or(pressed, |proved| proved.max(pressed));
        let lease = if state.linked { LEASE } else { LEASE_SIMULATED };
        state.witness == Witness::Display && now.saturating_sub(proved) > lease
    }

    /// Whether the window has said nothing since a moment for so long that what it holds is
    /// let go.
    pub fn has_window_lapsed(&self, heard: Duration, now: Duration) -> bool {
        let lease = match self.state().linked {
            true => WINDOW_LEASE,
            false => LEASE_SIMULATED,
        };
        now.saturating_sub(heard) > lease
    }

    /// Whether the display answers, and has not hung of late: what is pressed and turned
    /// was pressed and turned just now.
    pub fn is_fresh(&self, now: Duration) -> bool {
        let state = self.state();
        let answers = |at: Option<Duration>| at.map(|at| now.saturating_sub(at));
        state.witness == Witness::Window
            || answers(state.answered).is_some_and(|age| age <= HANGS)
                && answers(state.steady).is_some_and(|age| age >= SETTLES)
    }

    /// Whether the display has stopped answering.
    pub fn is_silent(&self, now: Duration) -> bool {
        let state = self.state();
        let old = |at| now.saturating_sub(at) > LEASE;
        state.witness == Witness::Display && state.answered.is_none_or(old)
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

    /// A display that answers within 5 ms, from 0 to this moment.
    fn answers_until(watch: &InputWatch, end: u64, shown: Shown) {
        for asked in (0..end).step_by(100) {
            watch.answer(ms(asked), ms(asked + 5), shown);
        }
    }

    #[test]
    fn a_display_that_hangs_proves_nothing() {
        let watch = InputWatch::default();
        watch.set_linked(true);
        watch.hold(ONE_KEY);
        let down = Shown::Down {
            keys: 1,
            pointer: false,
        };
        answers_until(&watch, 1000, down);
        assert!(!watch.has_lapsed(ms(100), ms(1030)));
        assert!(watch.has_lapsed(ms(100), ms(1031)));
        assert!(!watch.is_silent(ms(1030)) && watch.is_silent(ms(1031)));
        assert!(watch.has_window_lapsed(ms(700), ms(1000)));
        // An answer that comes late proves the moment of its question.
        watch.answer(ms(1000), ms(4000), down);
        assert!(watch.has_lapsed(ms(100), ms(4000)));
        assert!(!watch.is_fresh(ms(4010)), "what was pressed meanwhile");
        for asked in (4000..4400).step_by(100) {
            watch.answer(ms(asked), ms(asked + 5), down);
        }
        assert!(watch.is_fresh(ms(4310)));
    }

    #[test]
    fn a_display_that_shows_a_key_up_proves_nothing() {
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
            watch.hold(holders);
            watch.answer(
                ms(10_000),
                ms(10_001),
                Shown::Down {
                    keys: 0,
                    pointer: false,
                },
            );
            watch.answer(ms(20_000), ms(20_001), Shown::Down { keys, pointer });
            assert!(watch.has_lapsed(ms(0), ms(20_601)));
            assert_eq!(!watch.has_lapsed(ms(0), ms(20_600)), held, "{holders:?}");
        }
    }

    #[test]
    fn without_a_display_to_ask_the_window_alone_counts() {
        let watch = InputWatch::default();
        assert!(watch.has_lapsed(ms(0), ms(700)) && !watch.is_fresh(ms(700)));
        watch.trust_window();
        assert!(!watch.has_lapsed(ms(0), ms(700)) && watch.is_fresh(ms(700)));
    }
}
