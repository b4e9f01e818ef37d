//! Slows motion down that needs more messages than the wire can carry.

use core::time::Duration;

/// Duration of motion over which the number of messages per ms is averaged, ms.
const AVERAGED: f64 = 30.0;
/// Transmission time of the waiting messages up to which motion is not slowed down, s.
const USUAL: f64 = 0.03;
/// Transmission time beyond [`USUAL`] at which motion takes twice its time, s.
const TWICE: f64 = 0.03;
/// Greatest factor by which motion is slowed down.
const SLOWEST: f64 = 8.0;
/// Greatest increase of the slowdown factor per ms of motion, so small that the axes decelerate
/// about as usual.
const BRAKES: f64 = 0.01;
/// Greatest decrease of the slowdown factor per ms of motion.
const RELEASES: f64 = 0.002;

/// The slowdown of motion in the board, when the line cannot transmit messages fast enough.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slowdown {
    /// Ratio of the duration of motion in the board to that in the kernel.
    factor: f64,
    /// Recent number of messages per ms of motion.
    density: f64,
    /// Duration of the motion whose steps are not compressed yet, ms.
    uncompressed: f64,
}

impl Default for Slowdown {
    fn default() -> Self {
        Self {
            factor: 1.0,
            density: 0.0,
            uncompressed: 0.0,
        }
    }
}

impl Slowdown {
    /// Returns the expected number of messages for the motion whose steps are not compressed yet.
    pub(super) fn expected(&self) -> f64 {
        self.density * self.uncompressed
    }

    /// Returns the factor by which the next motion, of this duration, takes longer in the
    /// board. `need` is the transmission time of the waiting messages.
    pub(super) fn factor(&mut self, duration: Duration, need: Duration) -> f64 {
        let ms = duration.as_secs_f64() * 1000.0;
        self.uncompressed += ms;
        let wanted = 1.0 + (need.as_secs_f64() - USUAL) / TWICE;
        let change = wanted.clamp(1.0, SLOWEST) - self.factor;
        self.factor += change.clamp(-RELEASES * ms, BRAKES * ms);
        self.factor
    }

    /// Takes the number of messages into which all motion so far was compressed, and updates the
    /// average per ms.
    pub(super) fn compressed(&mut self, messages: u32) {
        if self.uncompressed > 0.0 {
            let weight = self.uncompressed / (self.uncompressed + AVERAGED);
            self.density += (f64::from(messages) / self.uncompressed - self.density) * weight;
            self.uncompressed = 0.0;
        }
    }
}
