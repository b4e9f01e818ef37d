//! Spindle and coolant: what they are to do, and what the board has been told. Lines
//! switch at a standstill only.

use core::fmt::Write;

use super::LineLink;
use crate::line::response::BoardState;
use crate::{BoardOutputs, SpindleDirection};

/// Outputs asked for and told.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Outputs {
    pub(super) wanted: BoardOutputs,
    pub(super) switched: BoardOutputs,
}

impl Outputs {
    /// Whether the board has been told what is wanted.
    pub(super) fn are_switched(&self) -> bool {
        self.wanted == self.switched
    }

    /// A board that starts has everything switched off.
    pub(super) fn reset_to_off(&mut self) {
        self.switched = BoardOutputs::default();
    }

    /// The line that switches what is wanted; none: that is switched already.
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
        // A `String` takes everything that is written to it.
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
