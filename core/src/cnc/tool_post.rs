//! The tool post as the control follows it: T display, 075, the tool-change key.

use super::Cnc;
use crate::operation::Strobe;
use crate::setup::TOOL_PARAMETER;

impl Cnc {
    /// The T display follows the tool post when it was turned by hand.
    pub(super) fn follow_tool(&mut self, before: u8) {
        let now = self.from_plc.current_tool;
        if now != before && (self.indexing_by_hand || !self.handshake.strobe(Strobe::T)) {
            self.indexing_by_hand = false;
            self.tool = (now, 0);
            self.interpreter.set_tool(now);
        }
        if now != before {
            self.remember_tool(now);
        }
    }

    /// 075 holds the tool in position; numbers beyond its range are not kept.
    pub(crate) fn remember_tool(&mut self, tool: u8) {
        let _ = self.parameters.set(TOOL_PARAMETER, tool.into());
    }

    /// The tool-change key: the next station, after the last the first.
    pub(super) fn index_tool(&mut self) {
        let stations = self.parameters.value(84);
        if self.handshake.busy() || stations == 0 {
            return;
        }
        let now = i32::from(self.from_plc.current_tool);
        let next = if now >= stations { 1 } else { now + 1 };
        self.handshake.start(Strobe::T, next as u8);
        self.indexing_by_hand = true;
    }
}
