//! The partner at the serial port that sends the program in DNC operation.

use gsk_core::cnc::Cnc;

/// Whether the control waits for the partner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patience {
    /// Machine time stops until the partner has sent. The same program then takes the same
    /// machine time, however slow the partner is.
    Waits,
    /// Machine time continues without data.
    None,
}

/// Sends programs in DNC operation.
pub trait Partner {
    /// Sends as much text as the control's buffer takes. Called before every tick. With
    /// [`Patience::Waits`] it may block.
    fn feed(&mut self, cnc: &mut Cnc, patience: Patience);
}

/// A partner with the whole text, which it sends from its beginning at each call.
#[derive(Clone, Debug, Default)]
pub struct TextPartner {
    text: String,
    sent: usize,
    call: u32,
}

impl TextPartner {
    /// Takes the text of the program.
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
