//! Spindle and coolant of a line board, switched at standstill only.

use core::fmt::Write;

use super::LineLink;
use crate::line::response::BoardState;
use crate::{BoardOutputs, SpindleDirection};

/// The states of spindle and coolant: those that the kernel wants, and those sent to the board.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LineOutputs {
    pub(super) wanted: BoardOutputs,
    pub(super) switched: BoardOutputs,
}

impl LineOutputs {
    /// Whether the requested states of the outputs were sent to the board.
    pub(super) fn are_switched(&self) -> bool {
        self.wanted == self.switched
    }

    /// Records that all outputs are off, because a starting board switches them off.
    pub(super) fn reset_to_off(&mut self) {
        self.switched = BoardOutputs::default();
    }

    /// Returns the line that switches the outputs to their wanted states, and counts it as sent;
    /// `None` if the wanted states were sent before.
    fn next_line(&mut self) -> Option<String> {
        if self.are_switched() {
            return None;
        }
        self.switched = self.wanted;
        let BoardOutputs {
            spindle,
            millivolts,
            coolant,
        } = self.wanted;
        // Writing to a `String` cannot fail.
        let mut line = String::new();
        let _ = match spindle {
            SpindleDirection::Stop => write!(line, "M5"),
            SpindleDirection::Forward => write!(line, "M3S{:.1}", f64::from(millivolts) / 10.0),
            SpindleDirection::Reverse => write!(line, "M4S{:.1}", f64::from(millivolts) / 10.0),
        };
        line.push_str(if coolant { "M8" } else { "M9" });
        Some(line)
    }
}

impl LineLink {
    pub(super) fn switch(&mut self) {
        if self.stands_in(&[BoardState::Idle])
            && let Some(line) = self.outputs.next_line()
        {
            self.send(&line, false);
        }
    }
}
