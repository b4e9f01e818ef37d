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
use crate::command::{ProgramId, Source};
use crate::program::{Inflow, LineTooLong};

/// Lowest baud rate for DNC (manual III-9.3).
const SLOWEST: u32 = 4800;
/// Bits of a character (start bit, eight bits, stop bit) times ticks per second.
const CHARACTER: u32 = 10 * 1000;
/// Most characters between the partner and the buffer.
const ON_THE_LINE: usize = 64;

/// The serial line in DNC operation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct DncLine {
    /// Whether a partner is connected.
    #[serde(rename = "partner")]
    partner: bool,
    /// Number of programs requested since power-on.
    #[serde(rename = "calls")]
    calls: u32,
    /// Characters on the line, not yet in the buffer.
    #[serde(rename = "coming")]
    coming: VecDeque<u8>,
    /// Bits that the line could have passed, times 1000.
    credit: u32,
    /// Whether the partner has sent the whole program.
    #[serde(rename = "ended")]
    ended: bool,
}

impl DncLine {
    /// CTRD: whether characters are being received.
    pub(super) fn receives(&self) -> bool {
        !self.coming.is_empty()
    }
}

impl Cnc {
    /// Connects or disconnects a partner that sends programs. A disconnection while its
    /// program runs ends the program with alarm 086.
    pub fn connect_dnc(&mut self, partner: bool) {
        let gone = self.dnc.partner && !partner;
        self.dnc.partner = partner;
        if gone {
            self.dnc_broken(say::serial_nobody_any_more());
        }
    }

    /// Number of programs requested since power-on. A partner sends its program from the
    /// start each time the number changes.
    pub const fn dnc_calls(&self) -> u32 {
        self.dnc.calls
    }

    /// Number of characters that may be sent now; 0 means XOFF.
    pub fn dnc_room(&self) -> usize {
        let coming = self.dnc.coming.len();
        match self.memory.programs.inflow() {
            Some(inflow) if !self.dnc.ended => inflow
                .room()
                .saturating_sub(coming)
                .min(ON_THE_LINE - coming.min(ON_THE_LINE)),
            _ => 0,
        }
    }

    /// Takes characters from the partner, up to [`dnc_room`](Self::dnc_room). Returns how
    /// many were taken.
    pub fn dnc_send(&mut self, characters: &[u8]) -> usize {
        let taken = characters.len().min(self.dnc_room());
        self.dnc.coming.extend(characters.iter().take(taken));
        taken
    }

    /// Notes that the partner has sent the whole program.
    pub const fn dnc_end(&mut self) {
        self.dnc.ended = true;
    }

    /// Notes that the line failed; a program that it delivers ends with alarm 086.
    pub fn dnc_broken(&mut self, reason: impl Into<Message>) {
        if self.memory.programs.inflow().is_some() {
            self.raise(Alarm::new(number::SERIAL_NOT_READY).because(reason));
        }
    }

    /// Sends DC1 at cycle start and requests a program from its beginning.
    pub(crate) fn call_for_program(&mut self) -> Result<(), Alarm> {
        let refused = |reason: Message| Err(Alarm::new(number::SERIAL_NOT_READY).because(reason));
        if !self.memory.parameters.has_serial_port() {
            return refused(say::serial_off());
        }
        if self.baud() < SLOWEST {
            return refused(say::baud_rate_too_low(SLOWEST));
        }
        if !self.dnc.partner {
            return refused(say::serial_nobody());
        }
        self.dnc = DncLine {
            partner: true,
            calls: self.dnc.calls.wrapping_add(1),
            ..DncLine::default()
        };
        self.memory.programs.set_inflow(Some(Inflow::default()));
        Ok(())
    }

    fn baud(&self) -> u32 {
        self.memory.parameters.baud()
    }

    /// Advances the line by one tick (1 ms).
    pub(super) fn dnc_tick(&mut self) {
        if self.memory.programs.inflow().is_none() {
            return;
        }
        if !self.has_program_run() {
            // RESET, the end of the program or an alarm: DC3, and unread characters are
            // dropped.
            self.memory.programs.set_inflow(None);
            self.dnc.coming.clear();
            return;
        }
        let baud = self.baud();
        if let Err(long) = self.dnc.pass(baud, self.memory.programs.inflow_mut()) {
            let LineTooLong { line, most } = long;
            let alarm = Alarm::new(number::SERIAL_GARBLED)
                .because(say::serial_line_too_long(most))
                .at(Source {
                    program: ProgramId::Dnc,
                    line,
                    sequence: None,
                });
            self.raise(alarm);
        }
        self.take_in_what_arrived();
    }

    /// Appends the received blocks to the readable part of the program.
    pub(crate) fn take_in_what_arrived(&mut self) {
        let Some(inflow) = self.memory.programs.inflow_mut() else {
            return;
        };
        let Some(next) = self.run.interpreter.next_coming_in() else {
            return;
        };
        let before = inflow.window().clone();
        let gone = inflow.move_on(next);
        if *inflow.window() != before {
            self.run.interpreter.blocks_gone(gone);
            self.run.automatic.waiting = false;
        }
    }
}

impl DncLine {
    /// Moves the characters that the line passes in a tick to the buffer.
    fn pass(&mut self, baud: u32, inflow: Option<&mut Inflow>) -> Result<(), LineTooLong> {
        let Some(inflow) = inflow else {
            return Ok(());
        };
        if self.coming.is_empty() {
            self.credit = 0;
            if self.ended {
                inflow.finish();
            }
            return Ok(());
        }
        self.credit = self.credit.saturating_add(baud);
        while self.credit >= CHARACTER
            && let Some(byte) = self.coming.pop_front()
        {
            self.credit -= CHARACTER;
            inflow.take(byte)?;
        }
        Ok(())
    }
}
