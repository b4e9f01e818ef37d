//! Cycles of one pass: G90, G92 and G94 of this control.

use gsk_messages::say;

use crate::block::ForeignBlock;
use crate::motion::length_word;
use crate::porter::{Porter, Refusal};
use crate::state::ActiveCode;

impl Porter<'_> {
    /// Converts a block of a turning, thread or facing cycle, in which an axis word without a
    /// code repeats the cycle.
    pub fn convert_canned(&mut self, block: &mut ForeignBlock) -> Result<(), Refusal> {
        let active = self.state.active;
        let taper = match active {
            ActiveCode::Face => b'K',
            _ => b'I',
        };
        match block.number(taper) {
            Some(number) => {
                let text = length_word(b'R', self.state.length(number));
                block.replace(taper, &text);
            }
            None => self.convert_length(block, b'R'),
        }
        if active != ActiveCode::ThreadTurn {
            self.convert_feed(block);
        } else {
            if let Some(number) = block.number(b'Q') {
                if number.micro != 0 {
                    return Err(Refusal::new("Q", say::ported_note_start_angle()));
                }
                block.remove(b"Q");
            }
            self.convert_lead(block);
            self.write_run_out(block);
        }
        self.convert_axis(block, 0, false);
        self.convert_axis(block, 1, false);
        Ok(())
    }

    /// Switches the run-out of G92 off after M24. J and K are modal, so one block is enough.
    fn write_run_out(&mut self, block: &mut ForeignBlock) {
        let machine = &mut self.state.machine;
        if machine.run_out == Some(false) && !machine.wrote_run_out && block.has_any(b"XUZW") {
            machine.wrote_run_out = true;
            block.append("J0 K0");
        }
    }
}
