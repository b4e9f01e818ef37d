//! Limits how often work on a part is repeated while the part is being cut. The window is
//! redrawn when the next turn is due.

use std::time::Duration;

use egui::Context;

/// Limits how often an action is repeated; holds the time of the last one, seconds of the window's
/// clock.
#[derive(Default)]
pub struct RepeatLimit(Option<f64>);

impl RepeatLimit {
    /// Whether `interval_s` have passed since the last call that returned true. If not, the
    /// window is redrawn when they have.
    pub fn is_due(&mut self, context: &Context, interval_s: f64) -> bool {
        let now = context.input(|input| input.time);
        let remaining_s = self.0.map_or(0.0, |done| done + interval_s - now);
        if remaining_s > 0.0 {
            context.request_repaint_after(Duration::from_secs_f64(remaining_s));
            return false;
        }
        self.0 = Some(now);
        true
    }
}
