//! DNC operation: the serial line delivers a program while it runs (manual PLC-II 3.6,
//! 6.1).
//!
//! The caller supplies characters, which pass the line at its baud rate. The control
//! requests only what its buffer can hold: it sends DC1 (XON) at cycle start and when the
//! buffer has space, DC3 (XOFF) when the buffer is full and at the end of the run.

use std::collections::VecDeque;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use super::Cnc;
use crate::alarm::{Alarm, number};
use crate::command::{ProgramId, SourcePosition};
use crate::program::{DncBuffer, LineTooLong};

/// Lowest baud rate for DNC (manual III-9.3).
const MIN_BAUD: u32 = 4800;
/// Credit that the transmission of a character uses: its ten bits (start bit, eight data bits, stop
/// bit) times 1000 ticks per second.
const CHARACTER_CREDIT: u32 = 10 * 1000;
/// Greatest number of characters on the line between the sending device and the buffer.
const MAX_ON_LINE: usize = 64;

/// An event of the device that sends programs on the serial line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DncInput {
    /// The device was connected (`true`) or disconnected.
    Connected(bool),
    /// The device has sent these characters.
    Characters(Vec<u8>),
    /// The device has sent the whole program.
    Complete,
    /// The line has failed for this reason.
    Failed(Message),
}

/// State of the serial line in DNC operation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct DncLine {
    /// Whether a device that sends programs is connected.
    #[serde(rename = "partner")]
    is_connected: bool,
    /// Number of programs that the control has requested since power-on.
    #[serde(rename = "calls")]
    request_count: u32,
    /// Characters on the line, not yet in the buffer.
    #[serde(rename = "coming")]
    line_characters: VecDeque<u8>,
    /// Bits that the line could have passed and that no character has used, times 1000.
    credit: u32,
    /// Whether the device has sent the whole program.
    #[serde(rename = "ended")]
    is_complete: bool,
}

impl DncLine {
    /// CTRD signal: whether characters are being received on the line.
    pub(super) fn is_receiving(&self) -> bool {
        !self.line_characters.is_empty()
    }
}

impl Cnc {
    /// Applies an event of the sending device. Returns the number of accepted characters.
    pub fn apply_dnc(&mut self, input: DncInput) -> usize {
        match input {
            DncInput::Connected(on) => self.set_dnc_partner(on),
            DncInput::Characters(characters) => return self.receive_dnc(&characters),
            DncInput::Complete => self.end_dnc(),
            DncInput::Failed(reason) => self.fail_dnc(reason),
        }
        0
    }

    /// Returns whether a device that sends programs is connected.
    pub const fn has_dnc_partner(&self) -> bool {
        self.dnc.is_connected
    }

    /// Connects or disconnects the device that sends programs. A disconnection while its
    /// program runs ends the program with alarm 086.
    pub fn set_dnc_partner(&mut self, is_connected: bool) {
        let was_disconnected = self.dnc.is_connected && !is_connected;
        self.dnc.is_connected = is_connected;
        if was_disconnected {
            self.fail_dnc(say::serial_partner_gone());
        }
    }

    /// Number of programs requested since power-on. The device must send its program from
    /// the start each time the number changes.
    pub const fn dnc_request_count(&self) -> u32 {
        self.dnc.request_count
    }

    /// Number of characters that the device may send now; 0 means XOFF.
    pub fn dnc_free_characters(&self) -> usize {
        let on_line = self.dnc.line_characters.len();
        match self.memory.programs.dnc_buffer() {
            Some(inflow) if !self.dnc.is_complete => inflow
                .free_characters()
                .saturating_sub(on_line)
                .min(MAX_ON_LINE - on_line.min(MAX_ON_LINE)),
            _ => 0,
        }
    }

    /// Puts characters that the device has sent on the line, at most
    /// [`dnc_free_characters`](Self::dnc_free_characters). Returns the number of accepted
    /// characters.
    pub fn receive_dnc(&mut self, characters: &[u8]) -> usize {
        let taken = characters.len().min(self.dnc_free_characters());
        self.dnc
            .line_characters
            .extend(characters.iter().take(taken));
        taken
    }

    /// Records that the device has sent the whole program.
    pub const fn end_dnc(&mut self) {
        self.dnc.is_complete = true;
    }

    /// Handles a failure of the serial line: a DNC program that is running ends with alarm 086 and
    /// this reason.
    pub fn fail_dnc(&mut self, reason: impl Into<Message>) {
        if self.memory.programs.dnc_buffer().is_some() {
            self.raise(Alarm::new(number::SERIAL_NOT_READY).with_detail(reason));
        }
    }

    /// Sends DC1 at cycle start and requests a program from its beginning; returns alarm 086 as
    /// error if the line or the device is not ready.
    pub(crate) fn request_dnc_program(&mut self) -> Result<(), Alarm> {
        let refused =
            |reason: Message| Err(Alarm::new(number::SERIAL_NOT_READY).with_detail(reason));
        if !self.memory.parameters.has_serial_port() {
            return refused(say::serial_off());
        }
        if self.baud() < MIN_BAUD {
            return refused(say::baud_rate_too_low(MIN_BAUD));
        }
        if !self.dnc.is_connected {
            return refused(say::serial_no_partner());
        }
        self.dnc = DncLine {
            is_connected: true,
            request_count: self.dnc.request_count.wrapping_add(1),
            ..DncLine::default()
        };
        self.memory
            .programs
            .set_dnc_buffer(Some(DncBuffer::default()));
        Ok(())
    }

    fn baud(&self) -> u32 {
        self.memory.parameters.baud()
    }

    /// Advances the serial line by one tick (1 ms).
    pub(super) fn advance_dnc(&mut self) {
        if self.memory.programs.dnc_buffer().is_none() {
            return;
        }
        if !self.has_resumable_run() {
            // RESET, the end of the program or an alarm: DC3, and unread characters are
            // dropped.
            self.memory.programs.set_dnc_buffer(None);
            self.dnc.line_characters.clear();
            return;
        }
        let baud = self.baud();
        if let Err(long) = self
            .dnc
            .advance(baud, self.memory.programs.dnc_buffer_mut())
        {
            let LineTooLong { line, limit: most } = long;
            let alarm = Alarm::new(number::SERIAL_GARBLED)
                .with_detail(say::serial_line_too_long(most))
                .with_source(SourcePosition {
                    program: ProgramId::Dnc,
                    line,
                    sequence: None,
                });
            self.raise(alarm);
        }
        self.read_received_blocks();
    }

    /// Makes the received blocks readable for the interpreter, and drops the blocks already
    /// read.
    pub(crate) fn read_received_blocks(&mut self) {
        let Some(inflow) = self.memory.programs.dnc_buffer_mut() else {
            return;
        };
        let Some(next) = self.run.interpreter.next_arriving_block() else {
            return;
        };
        let before = inflow.window().clone();
        let dropped = inflow.advance_window(next);
        if *inflow.window() != before {
            self.run.interpreter.drop_arrived_blocks(dropped);
            self.run.automatic.waits_for_standstill = false;
        }
    }
}

impl DncLine {
    /// Moves the characters that the line passes in a tick at this baud rate (bit/s) to the buffer
    /// `inflow`; an error if a line of the program is too long.
    fn advance(&mut self, baud: u32, inflow: Option<&mut DncBuffer>) -> Result<(), LineTooLong> {
        let Some(inflow) = inflow else {
            return Ok(());
        };
        if self.line_characters.is_empty() {
            self.credit = 0;
            if self.is_complete {
                inflow.finish();
            }
            return Ok(());
        }
        self.credit = self.credit.saturating_add(baud);
        while self.credit >= CHARACTER_CREDIT
            && let Some(byte) = self.line_characters.pop_front()
        {
            self.credit -= CHARACTER_CREDIT;
            inflow.receive_byte(byte)?;
        }
        Ok(())
    }
}
