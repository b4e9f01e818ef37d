//! DNC operation: a program comes in through the serial line while it runs (manual
//! PLC-II 3.6, 6.1).
//!
//! Characters are handed in from outside and pass the line at its baud rate. The
//! control asks for no more than it has room for: it sends DC1 (XON) at cycle start
//! and when there is room again, DC3 (XOFF) when there is none and at the end of the
//! run.

use std::collections::VecDeque;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use super::Cnc;
use crate::alarm::{Alarm, number};
use crate::command::{ProgramId, Source};
use crate::program::{Inflow, LineTooLong};

/// A PC talks at this rate or a higher one (manual III-9.3).
const SLOWEST: u32 = 4800;
/// A character on the line: start bit, eight bits, stop bit; a thousand ticks a second.
const CHARACTER: u32 = 10 * 1000;
/// Characters between the partner and the buffer.
const ON_THE_LINE: usize = 64;

/// The serial line in DNC operation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct DncLine {
    /// Somebody is at the other end.
    partner: bool,
    /// How often a program was called for.
    calls: u32,
    /// Characters on the line.
    coming: VecDeque<u8>,
    /// Bits that the line could have passed, times a thousand.
    credit: u32,
    /// The partner has no more.
    ended: bool,
}

impl DncLine {
    /// CTRD: characters come in.
    pub(super) fn receives(&self) -> bool {
        !self.coming.is_empty()
    }
}

impl Cnc {
    /// A partner that sends programs is at the line, or no more. One that goes while
    /// its program runs breaks it off: alarm 086.
    pub fn connect_dnc(&mut self, partner: bool) {
        let gone = self.dnc.partner && !partner;
        self.dnc.partner = partner;
        if gone {
            self.dnc_broken(say::serial_nobody_any_more());
        }
    }

    /// How often a program was called for: a partner that can begins anew each time.
    pub const fn dnc_calls(&self) -> u32 {
        self.dnc.calls
    }

    /// How many characters may be sent now; none means XOFF.
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

    /// The partner sends characters. Returns how many were taken: as many as there is
    /// room for.
    pub fn dnc_send(&mut self, characters: &[u8]) -> usize {
        let taken = characters.len().min(self.dnc_room());
        self.dnc.coming.extend(characters.iter().take(taken));
        taken
    }

    /// The partner has no more to send.
    pub const fn dnc_end(&mut self) {
        self.dnc.ended = true;
    }

    /// The line broke; a program that comes in through it ends with alarm 086.
    pub fn dnc_broken(&mut self, reason: impl Into<Message>) {
        if self.memory.programs.inflow().is_some() {
            self.raise(Alarm::new(number::SERIAL_NOT_READY).because(reason));
        }
    }

    /// Cycle start: DC1 goes out, and a program is taken in from its beginning.
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

    /// One millisecond of the line.
    pub(super) fn dnc_tick(&mut self) {
        if self.memory.programs.inflow().is_none() {
            return;
        }
        if !self.has_program_run() {
            // RESET, the end of the program, an alarm: DC3, and what was not read goes.
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

    /// Puts what has arrived behind what can be read.
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
    /// What the line passes in a tick goes into the buffer.
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
