//! The partner at the serial line in DNC operation, as a control meets it.

use gsk_core::cnc::Cnc;

/// Whether the partner may be waited for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patience {
    /// Machine time stands still until it has sent: the same program runs in the same
    /// time, however slow the partner is.
    Waits,
    /// Machine time goes on.
    None,
}

/// Sends programs in DNC operation.
pub trait Partner {
    /// Sends what the control has room for, before a tick.
    fn feed(&mut self, cnc: &mut Cnc, patience: Patience);
}

/// A partner that has a text at hand, and sends it from its beginning at each call.
#[derive(Clone, Debug, Default)]
pub struct TextPartner {
    text: String,
    sent: usize,
    call: u32,
}

impl TextPartner {
    /// A partner that sends this text.
    pub fn new(text: String) -> Self {
        Self {
            text,
            ..Self::default()
        }
    }
}

impl Partner for TextPartner {
    fn feed(&mut self, cnc: &mut Cnc, _patience: Patience) {
        cnc.connect_dnc(true);
        if self.call != cnc.dnc_calls() {
            (self.call, self.sent) = (cnc.dnc_calls(), 0);
        }
        let rest = self.text.as_bytes().get(self.sent..).unwrap_or_default();
        if rest.is_empty() {
            return cnc.dnc_end();
        }
        self.sent += cnc.dnc_send(rest);
    }
}
