//! Follows the tool post: T display, parameter 075, and the tool-change key.

use super::Cnc;
use crate::operation::Strobe;

impl Cnc {
    /// Updates the T display when the tool in position has changed from `before` without a
    /// T function.
    pub(super) fn follow_tool(&mut self, before: u8) {
        let current = self.plc.signals.current_tool;
        if current != before
            && (self.run.indexing_by_key || !self.run.handshake.is_strobe_up(Strobe::T))
        {
            self.run.indexing_by_key = false;
            self.run.tool = (current, 0);
            self.run.interpreter.set_tool(current);
        }
        if current != before {
            self.remember_tool(current);
        }
    }

    /// Stores the number of the tool in position in parameter 075; numbers beyond its range are not
    /// stored.
    pub(crate) fn remember_tool(&mut self, tool: u8) {
        self.memory.parameters.remember_tool(tool);
    }

    /// Turns the tool post to the next station, from the last one to the first; does nothing
    /// without a tool post or while a function waits for FIN.
    pub(super) fn index_tool(&mut self) {
        let stations = i32::from(self.memory.parameters.station_count());
        if self.run.handshake.is_busy() || stations == 0 {
            return;
        }
        let current = i32::from(self.plc.signals.current_tool);
        let next = if current >= stations { 1 } else { current + 1 };
        self.run.handshake.start(Strobe::T, next as u8);
        self.run.indexing_by_key = true;
    }
}
