//! Measures the window for `--figures`: time to the first frame and to the first piece of a
//! tool path, frames per second, time per frame.

use gsk_host::output;
use gsk_messages::say;
use web_time::{Duration, Instant};

/// Interval between two printed lines of averages.
const REPORT_INTERVAL: Duration = Duration::from_secs(5);

/// Counts frames and prints their average times on standard error.
pub struct FrameFigures {
    program_start: Instant,
    period_start: Option<Instant>,
    frames: u32,
    frame_time: Duration,
    /// Whether a toolpath has been drawn since the start.
    has_seen_path: bool,
}

impl FrameFigures {
    /// Creates figures that count from `program_start`, the start time of the program.
    pub const fn new(program_start: Instant) -> Self {
        Self {
            program_start,
            period_start: None,
            frames: 0,
            frame_time: Duration::ZERO,
            has_seen_path: false,
        }
    }

    /// Records the number of segments of the tool path in this frame. At the first segments,
    /// prints the time since the start.
    pub fn record_pieces(&mut self, pieces: usize) {
        if pieces > 0 && !self.has_seen_path {
            self.has_seen_path = true;
            let after_ms = self.program_start.elapsed().as_millis();
            output::report_error(&say::window_first_path(after_ms, pieces));
        }
    }

    /// Records a frame. `frame_time_s` is the time spent on the previous frame, s. Prints the
    /// averages every `REPORT_INTERVAL`.
    pub fn record_frame(&mut self, frame_time_s: Option<f32>) {
        let now = Instant::now();
        let Some(since) = self.period_start else {
            let after_ms = self.program_start.elapsed().as_millis();
            output::report_error(&say::window_first_frame(after_ms));
            self.period_start = Some(now);
            return;
        };
        self.frames += 1;
        self.frame_time += Duration::from_secs_f32(frame_time_s.unwrap_or(0.0).max(0.0));
        let elapsed = now - since;
        if elapsed < REPORT_INTERVAL {
            return;
        }
        let time_per_frame = self.frame_time / self.frames;
        let frames = f64::from(self.frames) / elapsed.as_secs_f64();
        let rate = say::window_frame_rate(frames, time_per_frame.as_secs_f64() * 1000.0);
        output::report_error(&rate);
        self.period_start = Some(now);
        self.frames = 0;
        self.frame_time = Duration::ZERO;
    }
}
