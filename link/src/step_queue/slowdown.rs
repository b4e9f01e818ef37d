//! Motion that turns and bends more often than the board can be sent is made slower.

use core::time::Duration;

/// Motion over which the messages it takes are averaged, ms.
const AVERAGED: f64 = 30.0;
/// So long the messages that wait may take, s; and how much longer they take at twice
/// the time of the kernel.
const USUAL: f64 = 0.03;
const TWICE: f64 = 0.03;
/// The slowest, as a multiple of the kernel's time.
const SLOWEST: f64 = 8.0;
/// Change of that in a ms of motion: slower, and back. As soft as a ramp of the axes.
const BRAKES: f64 = 0.01;
const RELEASES: f64 = 0.002;

/// Slowdown of the board against the kernel's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slowdown {
    /// How many times as long as the kernel's a piece of motion takes.
    factor: f64,
    /// Messages that a ms of motion took of late.
    density: f64,
    /// Motion that is not compressed, ms.
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
    /// Messages that the motion which is not compressed will take.
    pub(super) fn expected(&self) -> f64 {
        self.density * self.uncompressed
    }

    /// How many times as long as the kernel's the next piece of motion takes, when the
    /// messages that wait need so long.
    pub(super) fn factor(&mut self, duration: Duration, need: Duration) -> f64 {
        let ms = duration.as_secs_f64() * 1000.0;
        self.uncompressed += ms;
        let wanted = 1.0 + (need.as_secs_f64() - USUAL) / TWICE;
        let change = wanted.clamp(1.0, SLOWEST) - self.factor;
        self.factor += change.clamp(-RELEASES * ms, BRAKES * ms);
        self.factor
    }

    /// What was not compressed has taken so many messages.
    pub(super) fn compressed(&mut self, messages: u32) {
        if self.uncompressed > 0.0 {
            let weight = self.uncompressed / (self.uncompressed + AVERAGED);
            self.density += (f64::from(messages) / self.uncompressed - self.density) * weight;
            self.uncompressed = 0.0;
        }
    }
}
