//! Motion that turns and bends more often than the board can be told is made slower.

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

/// Pace of the board against the kernel's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// How many times as long as the kernel's a piece of motion takes.
    slower: f64,
    /// Messages that a ms of motion took of late.
    density: f64,
    /// Motion that is not fitted, ms.
    unfitted: f64,
}

impl Default for Pace {
    fn default() -> Self {
        Self {
            slower: 1.0,
            density: 0.0,
            unfitted: 0.0,
        }
    }
}

impl Pace {
    /// Messages that the motion which is not fitted will take.
    pub(super) fn expected(&self) -> f64 {
        self.density * self.unfitted
    }

    /// How many times as long as the kernel's the next piece of motion takes, when the
    /// messages that wait need so long.
    pub(super) fn slower(&mut self, duration: Duration, need: Duration) -> f64 {
        let ms = duration.as_secs_f64() * 1000.0;
        self.unfitted += ms;
        let wanted = 1.0 + (need.as_secs_f64() - USUAL) / TWICE;
        let change = wanted.clamp(1.0, SLOWEST) - self.slower;
        self.slower += change.clamp(-RELEASES * ms, BRAKES * ms);
        self.slower
    }

    /// What was not fitted has taken so many messages.
    pub(super) fn fitted(&mut self, messages: u32) {
        if self.unfitted > 0.0 {
            let weight = self.unfitted / (self.unfitted + AVERAGED);
            self.density += (f64::from(messages) / self.unfitted - self.density) * weight;
            self.unfitted = 0.0;
        }
    }
}
