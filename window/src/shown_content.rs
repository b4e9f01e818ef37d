//! What the window shows, as far as the thread must know that repaints it for the kernel.

use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

use web_time::Duration;

/// Interval between two frames of a picture that moves, and of the LCD right after a key.
const MOTION_INTERVAL: Duration = Duration::from_millis(40);
/// Interval between two frames while only numbers and lamps change: each frame draws the whole
/// window, and a computer without a graphics card takes 20 ms of a processor for it.
const NUMBERS_INTERVAL: Duration = Duration::from_millis(125);
/// Number of frames at the interval of a moving picture after the last key or pointer event.
const FRAMES_AFTER_INPUT: u8 = 12;

/// Written by the window in each frame, read by the thread that repaints it.
#[derive(Debug)]
pub struct ShownContent {
    /// Whether a view shows more of the PLC memory than the inputs; its timers run all the
    /// time.
    has_plc_memory: AtomicBool,
    /// Whether a view draws the machine or the part.
    has_motion: AtomicBool,
    /// Frames that still follow the last input at the short interval.
    frames_after_input: AtomicU8,
}

impl Default for ShownContent {
    /// The content before the first frame: everything may be shown.
    fn default() -> Self {
        Self {
            has_plc_memory: AtomicBool::new(true),
            has_motion: AtomicBool::new(true),
            frames_after_input: AtomicU8::new(0),
        }
    }
}

impl ShownContent {
    /// Stores whether a view shows more of the PLC memory than the inputs, and whether one draws
    /// the machine or the part.
    pub fn set_views(&self, has_plc_memory: bool, has_motion: bool) {
        self.has_plc_memory.store(has_plc_memory, Ordering::Relaxed);
        self.has_motion.store(has_motion, Ordering::Relaxed);
    }

    /// Records a key or pointer event, or a button that is held.
    pub fn record_input(&self) {
        self.frames_after_input
            .store(FRAMES_AFTER_INPUT, Ordering::Relaxed);
    }

    /// Whether a view shows more of the PLC memory than the inputs.
    pub fn has_plc_memory(&self) -> bool {
        self.has_plc_memory.load(Ordering::Relaxed)
    }

    /// Counts a frame that the kernel has requested.
    pub fn count_frame(&self) {
        let left = self.frames_after_input.load(Ordering::Relaxed);
        self.frames_after_input
            .store(left.saturating_sub(1), Ordering::Relaxed);
    }

    /// Shortest interval between two frames that the kernel requests.
    pub fn frame_interval(&self) -> Duration {
        let is_after_input = self.frames_after_input.load(Ordering::Relaxed) > 0;
        match is_after_input || self.has_motion.load(Ordering::Relaxed) {
            true => MOTION_INTERVAL,
            false => NUMBERS_INTERVAL,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_alone_change_rarely_until_a_key_is_pressed() {
        let shown = ShownContent::default();
        assert_eq!(shown.frame_interval(), MOTION_INTERVAL);
        shown.set_views(false, false);
        assert_eq!(shown.frame_interval(), NUMBERS_INTERVAL);
        shown.record_input();
        for _ in 0..FRAMES_AFTER_INPUT {
            assert_eq!(shown.frame_interval(), MOTION_INTERVAL);
            shown.count_frame();
        }
        assert_eq!(shown.frame_interval(), NUMBERS_INTERVAL);
    }
}
