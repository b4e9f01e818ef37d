//! The partner at the serial port that sends the program in DNC operation.

use gsk_core::cnc::Cnc;

/// Whether the control waits for the partner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartnerWait {
    /// The control may wait: machine time stops until the partner has sent. A program then
    /// takes the same machine time with a slow partner as with a fast one.
    Allowed,
    /// The control must not wait: machine time continues without data.
    Forbidden,
}

/// A partner at the serial port that sends programs in DNC operation.
pub trait ProgramPartner {
    /// Sends as much text as the control's buffer takes. Called before every tick. With
    /// [`PartnerWait::Allowed`] the call may block until text has arrived.
    fn send_text(&mut self, cnc: &mut Cnc, wait: PartnerWait);
}

/// A partner that has the whole program text in memory, and sends it from the beginning each
/// time the control requests a program.
#[derive(Clone, Debug, Default)]
pub struct TextPartner {
    text: String,
    sent_bytes: usize,
    call_number: u32,
}

impl TextPartner {
    /// Creates a partner that sends `text`.
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
