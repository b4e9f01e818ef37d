//! The partner at the serial port that sends the program in DNC operation.

use gsk_core::cnc::Cnc;

/// Whether the control waits for the partner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartnerWait {
    /// Machine time stops until the partner has sent. The same program then takes the same
    /// machine time, however slow the partner is.
    Allowed,
    /// Machine time continues without data.
    Forbidden,
}

/// Sends programs in DNC operation.
pub trait ProgramPartner {
    /// Sends as much text as the control's buffer takes. Called before every tick. With
    /// [`PartnerWait::Allowed`] it may block.
    fn send_text(&mut self, cnc: &mut Cnc, wait: PartnerWait);
}

/// A partner with the whole text, which it sends from its beginning at each call.
#[derive(Clone, Debug, Default)]
pub struct TextPartner {
    text: String,
    sent_bytes: usize,
    call_number: u32,
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

impl ProgramPartner for TextPartner {
    fn send_text(&mut self, cnc: &mut Cnc, _wait: PartnerWait) {
        cnc.set_dnc_partner(true);
        if self.call_number != cnc.dnc_request_count() {
            (self.call_number, self.sent_bytes) = (cnc.dnc_request_count(), 0);
        }
        let rest = self
            .text
            .as_bytes()
            .get(self.sent_bytes..)
            .unwrap_or_default();
        if rest.is_empty() {
            return cnc.end_dnc();
        }
        self.sent_bytes += cnc.receive_dnc(rest);
    }
}
