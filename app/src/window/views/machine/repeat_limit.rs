//! Limits how often work on a part is repeated while the part is being cut. The window is
//! redrawn when the next turn is due.

use std::time::Duration;

use egui::Context;

/// Time of the last turn, seconds of the window's clock.
#[derive(Default)]
pub struct RepeatLimit(Option<f64>);

impl RepeatLimit {
    /// Whether `interval_s` have passed since the last turn. If so, the turn counts as done now.
    /// If not, the window is redrawn at that time.
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
