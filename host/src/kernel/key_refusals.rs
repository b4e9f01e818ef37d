//! Reports once why a key does nothing, and takes the report back when a key acts again.

use gsk_core::cnc::Cnc;
use gsk_messages::Message;
use gsk_panel::keys::Key;
use gsk_panel::refusal::{CHECK_DELAY_TICKS, KeyPress};

/// A report to the window about keys that do nothing.
pub(super) enum RefusalReport {
    /// A key has no effect, for the reason in the message.
    Refused(Option<Key>, Message),
    /// An earlier refusal is obsolete: a key has an effect, or another machine is operated.
    Obsolete,
}

/// Presses of machine keys that are checked some ticks later for an effect.
#[derive(Debug, Default)]
pub(super) struct KeyRefusals {
    /// Machine keys, each with the tick at which it is checked.
    pending: Vec<(u64, KeyPress)>,
    /// Whether the window currently shows a refusal.
    is_refusal_shown: bool,
}

impl KeyRefusals {
    /// Records a press of `key` at a tick; `None` for a typed character. `press` is the check that
    /// follows; `None` for a key without
    /// one. `refused` is the reason if page, mode or a switch forbids the key. Returns the report
    /// to the window; `None` if there is nothing to report.
    pub(super) fn record_press(
        &mut self,
        key: Option<Key>,
        press: Option<KeyPress>,
        refused: Option<Message>,
        tick: u64,
    ) -> Option<RefusalReport> {
        self.pending
            .extend(press.map(|press| (tick + CHECK_DELAY_TICKS, press)));
        match refused {
            Some(why) => {
                self.is_refusal_shown = true;
                Some(RefusalReport::Refused(key, why))
            }
            None => core::mem::take(&mut self.is_refusal_shown).then_some(RefusalReport::Obsolete),
        }
    }

    /// Records advice about a key that was released too early; the next key that acts makes it
    /// obsolete as it does a refusal.
    pub(super) const fn record_advice(&mut self) {
        self.is_refusal_shown = true;
    }

    /// Drops all presses, because another machine is operated from now on. Returns the report to the
    /// window; `None` if there is nothing to report.
    pub(super) fn clear(&mut self) -> Option<RefusalReport> {
        core::mem::take(self)
            .is_refusal_shown
            .then_some(RefusalReport::Obsolete)
    }

    /// Checks the machine keys that are due at `tick`; returns the refusal of the last one that
    /// does nothing, or `None` if all act.
    pub(super) fn check_due(&mut self, tick: u64, cnc: &Cnc) -> Option<RefusalReport> {
        if self.pending.is_empty() {
            return None;
        }
        let due = self.pending.iter().filter(|(at, _)| *at <= tick);
        let why = due
            .filter_map(|(_, press)| Some((press.key(), press.refusal_reason(cnc)?)))
            .next_back();
        self.pending.retain(|(at, _)| *at > tick);
        self.is_refusal_shown |= why.is_some();
        why.map(|(key, why)| RefusalReport::Refused(Some(key), why))
    }
}
