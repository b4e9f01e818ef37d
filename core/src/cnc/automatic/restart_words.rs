//! Words that the operator changes in the state before a block, for a restart there.

use gsk_messages::{Message, say};

use crate::cnc::Cnc;
use crate::command::{Action, SpindleCommand};
use crate::units::Feed;

impl Cnc {
    /// Puts another tool number into force in a copy that has stopped before a block. The offset
    /// number stays: the block that was read ahead is computed with it.
    pub fn set_restart_tool(&mut self, tool: u8) {
        let run = &mut self.run;
        run.tool.0 = tool;
        run.modal.tool = tool;
        if let Some(next) = &mut run.automatic.next_command {
            next.modal.tool = tool;
        }
        run.interpreter.set_tool(tool);
    }

    /// Puts another S word into force in a copy that has stopped before a block: r/min, m/min
    /// under G96, or a step number.
    pub fn set_restart_speed(&mut self, s: f64) {
        let spindle = &mut self.spindle.control;
        spindle.command(match spindle.is_surface_mode() {
            true => SpindleCommand::Surface(s),
            false => SpindleCommand::Speed(s),
        });
        let run = &mut self.run;
        run.modal.spindle = s;
        if let Some(next) = &mut run.automatic.next_command {
            next.modal.spindle = s;
        }
        run.interpreter.set_speed_word(s);
    }

    /// Puts another F word into force in a copy that has stopped before a block, in the unit of
    /// the feed mode.
    ///
    /// # Errors
    /// The block has a separate F word, or its moves are already computed with the F before it.
    pub fn set_restart_feed(&mut self, feed: f64) -> Result<(), Message> {
        let run = &mut self.run;
        let before = run.modal.feed;
        if run.interpreter.has_moves_ahead() {
            return Err(say::restart_feed_is_read());
        }
        if let Some(next) = &mut run.automatic.next_command {
            if next.modal.feed != before {
                return Err(say::restart_feed_is_read());
            }
            next.modal.feed = feed;
            if let Action::Line { feed: of_move, .. } | Action::Arc { feed: of_move, .. } =
                &mut next.action
            {
                *of_move = match of_move {
                    Feed::PerMinute(_) => Feed::PerMinute(feed),
                    Feed::PerRevolution(_) => Feed::PerRevolution(feed),
                };
            }
        }
        run.modal.feed = feed;
        run.interpreter.set_feed_word(feed);
        Ok(())
    }
}
