//! Measures the window for `--figures`: time to the first frame and to the first piece of a
//! tool path, frames per second, time per frame.

use gsk_messages::say;
use web_time::{Duration, Instant};

use crate::output;

/// Interval between two printed lines.
const PERIOD: Duration = Duration::from_secs(5);

/// Counts frames and prints the averages on standard error.
pub struct Figures {
    begun: Instant,
    since: Option<Instant>,
    frames: u32,
    busy: Duration,
    /// Whether a tool path has been drawn.
    path: bool,
}

impl Figures {
    /// Counts from `begun`, the start time of the program.
    pub const fn new(begun: Instant) -> Self {
        Self {
            begun,
            since: None,
            frames: 0,
            busy: Duration::ZERO,
            path: false,
        }
    }

    /// Records the count of pieces of the tool path in this frame. The first piece prints its
    /// time since the start.
    pub fn pieces(&mut self, pieces: usize) {
        if pieces > 0 && !self.path {
            self.path = true;
            let after = self.begun.elapsed().as_millis();
            output::complain_of(&say::window_first_path(after, pieces));
        }
    }

    /// Records a frame. `busy`: time spent on the previous frame, s.
    pub fn frame(&mut self, busy: Option<f32>) {
        let now = Instant::now();
        let Some(since) = self.since else {
            let after = self.begun.elapsed().as_millis();
            output::complain_of(&say::window_first_frame(after));
            self.since = Some(now);
            return;
        };
        self.frames += 1;
        self.busy += Duration::from_secs_f32(busy.unwrap_or(0.0).max(0.0));
        let passed = now - since;
        if passed < PERIOD {
            return;
        }
        let a_frame = self.busy / self.frames;
        let frames = f64::from(self.frames) / passed.as_secs_f64();
        let rate = say::window_frame_rate(frames, a_frame.as_secs_f64() * 1000.0);
        output::complain_of(&rate);
        self.since = Some(now);
        self.frames = 0;
        self.busy = Duration::ZERO;
    }
}
