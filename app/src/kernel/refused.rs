//! Keys that do nothing, and why: said once, and taken back when a key acts again.

use gsk_core::cnc::Cnc;
use gsk_messages::Message;
use gsk_panel::refusal::{CHECK_DELAY_TICKS, KeyPress};

/// What becomes of the word on refused keys.
pub(super) enum Verdict {
    /// The key does nothing, and why.
    Refused(Message),
    /// A key acts: what was said of the one before is over.
    Acts,
}

/// Keys that wait to be judged.
#[derive(Debug, Default)]
pub(super) struct Refusals {
    /// Machine keys, with the tick to judge them at.
    pending: Vec<(u64, KeyPress)>,
    /// Something was said and still stands.
    said: bool,
}

impl Refusals {
    /// A key goes down at a tick; `refused`: page, mode or a switch is against it.
    pub(super) fn pressed(
        &mut self,
        press: Option<KeyPress>,
        refused: Option<Message>,
        tick: u64,
    ) -> Option<Verdict> {
        self.pending
            .extend(press.map(|press| (tick + CHECK_DELAY_TICKS, press)));
        match refused {
            Some(why) => {
                self.said = true;
                Some(Verdict::Refused(why))
            }
            None => core::mem::take(&mut self.said).then_some(Verdict::Acts),
        }
    }

    /// Judges the machine keys whose time has come.
    pub(super) fn judge(&mut self, tick: u64, cnc: &Cnc) -> Option<Verdict> {
        if self.pending.is_empty() {
            return None;
        }
        let due = self.pending.iter().filter(|(at, _)| *at <= tick);
        let why = due
            .filter_map(|(_, press)| press.refusal_reason(cnc))
            .next_back();
        self.pending.retain(|(at, _)| *at > tick);
        self.said |= why.is_some();
        why.map(Verdict::Refused)
    }
}
