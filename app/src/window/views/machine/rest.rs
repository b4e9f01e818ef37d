//! Work on the part that is too long for each picture while it is being cut: it rests in
//! between, and the window draws again when the rest is over.

use std::time::Duration;

use egui::Context;

/// When the work was done last, by the clock of the window.
#[derive(Default)]
pub struct Rest(Option<f64>);

impl Rest {
    /// Whether so many seconds have passed since the work was done; if they have, it is
    /// done now. Else the window draws again when they have.
    pub fn is_over(&mut self, context: &Context, seconds: f64) -> bool {
        let now = context.input(|input| input.time);
        let left = self.0.map_or(0.0, |done| done + seconds - now);
        if left > 0.0 {
            context.request_repaint_after(Duration::from_secs_f64(left));
            return false;
        }
        self.0 = Some(now);
        true
    }
}
