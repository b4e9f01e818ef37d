//! The partner at the serial port that sends the program in DNC operation.

use gsk_core::cnc::{Cnc, DncInput};
use gsk_panel::emulator::{Emulator, EmulatorInput, InputAnswer};

/// Whether the control may wait for data from the partner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartnerWait {
    /// The control may wait: machine time stops until the partner has sent. A program then
    /// takes the same machine time with a slow partner as with a fast one.
    Allowed,
    /// The control must not wait: machine time continues while no data arrives.
    Forbidden,
}

/// The control's end of the serial line in DNC operation.
pub trait DncReceiver {
    /// Returns the control that receives.
    fn control(&self) -> &Cnc;

    /// Passes an event of the partner, such as characters, to the control. Returns the number of
    /// accepted characters.
    fn pass(&mut self, input: DncInput) -> usize;
}

impl DncReceiver for Cnc {
    fn control(&self) -> &Cnc {
        self
    }

    fn pass(&mut self, input: DncInput) -> usize {
        self.apply_dnc(input)
    }
}

impl DncReceiver for Emulator {
    fn control(&self) -> &Cnc {
        self.cnc()
    }

    fn pass(&mut self, input: DncInput) -> usize {
        match self.apply(EmulatorInput::Dnc(input)) {
            InputAnswer::Accepted(characters) => characters,
            _ => 0,
        }
    }
}

/// Reports to the control that its partner is connected, unless the control has that state already.
pub fn connect_partner(line: &mut dyn DncReceiver) {
    if !line.control().has_dnc_partner() {
        line.pass(DncInput::Connected(true));
    }
}

/// Passes as many characters to the control as its buffer takes. Returns their number.
pub fn pass_characters(line: &mut dyn DncReceiver, characters: &[u8]) -> usize {
    let count = characters.len().min(line.control().dnc_free_characters());
    match characters.get(..count) {
        Some(taken) if count > 0 => line.pass(DncInput::Characters(taken.to_vec())),
        _ => 0,
    }
}

/// A partner at the serial port that sends programs in DNC operation.
pub trait ProgramPartner {
    /// Sends as much text as the control's buffer takes. Called before every tick. With
    /// [`PartnerWait::Allowed`] the call may block until text has arrived.
    fn send_text(&mut self, line: &mut dyn DncReceiver, wait: PartnerWait);
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
    fn send_text(&mut self, line: &mut dyn DncReceiver, _wait: PartnerWait) {
        connect_partner(line);
        let request_count = line.control().dnc_request_count();
        if self.call_number != request_count {
            (self.call_number, self.sent_bytes) = (request_count, 0);
        }
        let rest = self
            .text
            .as_bytes()
            .get(self.sent_bytes..)
            .unwrap_or_default();
        if rest.is_empty() {
            line.pass(DncInput::Complete);
            return;
        }
        self.sent_bytes += pass_characters(line, rest);
    }
}
