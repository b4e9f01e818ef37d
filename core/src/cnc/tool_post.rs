//! Follows the tool post: T display, 075, the tool-change key.

use super::Cnc;
use crate::operation::Strobe;

impl Cnc {
    /// Updates the T display when the tool post was turned manually.
    pub(super) fn follow_tool(&mut self, before: u8) {
        let now = self.plc.signals.current_tool;
        if now != before && (self.run.indexing_by_hand || !self.run.handshake.strobe(Strobe::T)) {
            self.run.indexing_by_hand = false;
            self.run.tool = (now, 0);
            self.run.interpreter.set_tool(now);
        }
        if now != before {
            self.remember_tool(now);
        }
    }

    /// Stores the tool in position in 075; numbers beyond its range are not stored.
    pub(crate) fn remember_tool(&mut self, tool: u8) {
        self.memory.parameters.remember_tool(tool);
    }

    /// Turns the tool post to the next station, from the last one to the first.
    pub(super) fn index_tool(&mut self) {
        let stations = i32::from(self.memory.parameters.stations());
        if self.run.handshake.busy() || stations == 0 {
            return;
        }
        let now = i32::from(self.plc.signals.current_tool);
        let next = if now >= stations { 1 } else { now + 1 };
        self.run.handshake.start(Strobe::T, next as u8);
        self.run.indexing_by_hand = true;
    }
}
