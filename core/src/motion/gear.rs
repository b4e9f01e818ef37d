//! The electronic gear of threads: converts spindle turns to thread turns.
//!
//! ```text
//!  rate │      ______________            rate = thread turns per spindle turn
//!     1 │    .'              '.          linear (175.4 = 0): slope 1 / T (029)
//!       │  .'                  '.        exponential: 1 - (1 - r0) e^(-t/T)
//!    r0 ├─'                      '─┐ r1  r0, r1: the speed of 028
//!       └─┴──┴──────────────┴────┴─┴─► t
//!        lead-in   in phase    tail
//! ```
//!
//! While the rate is below 1 the tool lags and the lead is short. After the lead-in the lag
//! is constant, so that all passes at one speed cut the same groove.

use serde::{Deserialize, Serialize};

use crate::memory::Parameters;

/// Turns below this count as zero.
const NOTHING: f64 = 1e-12;

/// How the gear increases and decreases its rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct GearLaw {
    /// Time constant T (029), s.
    #[serde(rename = "time")]
    pub time: f64,
    /// Exponential instead of linear (175.4).
    pub exponential: bool,
    /// Speed at which threads start and end (028), mm/s.
    #[serde(rename = "lowest")]
    pub lowest: f64,
}

impl GearLaw {
    /// The rate at which the speed is `lowest`, for a lead and a spindle speed (turns/s).
    pub(crate) fn lowest_rate(&self, lead: f64, spin: f64) -> f64 {
        let speed = lead * spin;
        if self.time <= 0.0 || speed <= self.lowest {
            1.0
        } else {
            self.lowest / speed
        }
    }

    /// Turns made while the rate decreases to `last`; `unit` is the turns in T.
    fn braking(&self, rate: f64, last: f64, unit: f64) -> f64 {
        if rate <= last {
            0.0
        } else if self.exponential {
            unit * (rate - last)
        } else {
            unit * (rate * rate - last * last) / 2.0
        }
    }

    /// Duration of `total` turns at `spin` turns/s, s: from the rate `first` (1: already in
    /// phase) to `last` (1: continuing).
    pub fn duration(&self, total: f64, spin: f64, first: f64, last: f64) -> f64 {
        if total <= NOTHING {
            return 0.0;
        }
        if spin <= 0.0 {
            return f64::INFINITY;
        }
        let even = total / spin;
        let time = self.time;
        if time <= 0.0 || (first >= 1.0 && last >= 1.0) {
            return even;
        }
        if self.exponential {
            return self.exponential_duration(even, first, last);
        }
        // Turns, as a fraction of those in T, for the direct change between both rates.
        let straight = (last * last - first * first) / 2.0;
        if even < time * straight {
            return time * ((first * first + 2.0 * even / time).sqrt() - first);
        }
        if even < -time * straight {
            return 2.0 * even / (first + last);
        }
        let peak = f64::midpoint(first * first, last * last) + even / time;
        if peak < 1.0 {
            return time * (2.0 * peak.sqrt() - first - last).max(0.0);
        }
        let lost = |rate: f64| (1.0 - rate) * (1.0 - rate) / 2.0;
        even + time * (lost(first) + lost(last))
    }

    fn exponential_duration(&self, even: f64, first: f64, last: f64) -> f64 {
        let time = self.time;
        let missing = |after: f64| (1.0 - first) * libm::exp(-after / time);
        let down = time * (first - last);
        if even < down {
            return even / (first - last) * libm::log(first / last);
        }
        let rising = self.rise_time(first, last);
        if last >= 1.0 || even < rising + down {
            // Newton's steps approach the result from above.
            let mut whole = even + time * (1.0 - first);
            for _ in 0..8 {
                let lag = time * (1.0 - first - missing(whole));
                whole -= (whole - lag - even) / (1.0 - missing(whole));
            }
            return whole;
        }
        let braking_at = (even - down).max(0.0);
        let peak = (1.0 - missing(braking_at)).max(last);
        braking_at + time * libm::log(peak / last)
    }

    /// Time in which the exponential law reaches a rate, s; infinite for the rate 1.
    fn rise_time(&self, from: f64, to: f64) -> f64 {
        if from >= to {
            0.0
        } else if to >= 1.0 {
            f64::INFINITY
        } else {
            self.time * libm::log((1.0 - from) / (1.0 - to))
        }
    }
}

/// The law of lead-in and lead-out, from the parameters.
pub(super) fn gear_law(parameters: &Parameters) -> GearLaw {
    GearLaw {
        time: parameters.feed_time() / 1000.0,
        exponential: parameters.thread_exponential(),
        lowest: parameters.thread_floor() / 60.0,
    }
}

/// End of a motion through the gear.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GearEnd {
    /// Total thread turns.
    pub total: f64,
    /// Rate at the end; `None`: the next thread continues.
    pub last: Option<f64>,
}

/// State of the electronic gear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Gear {
    /// Thread turns per spindle turn, 0–1.
    pub rate: f64,
    /// Thread turns made.
    #[serde(rename = "done")]
    pub done: f64,
}

impl Gear {
    /// Advances by `turns` of the spindle in `time` seconds. Returns the time used, which
    /// is less than `time` only at the end.
    pub fn advance(&mut self, law: &GearLaw, end: GearEnd, turns: f64, time: f64) -> f64 {
        if turns <= 0.0 || time <= 0.0 {
            // The spindle stands still or turns back: the tool follows, but never past the
            // start.
            self.done += self.rate * turns.min(0.0);
            return time;
        }
        let spin = turns / time;
        let mut used = 0.0;
        // Each iteration is one phase: increase, keep, decrease the rate.
        for _ in 0..8 {
            let (left, rest) = (time - used, end.total - self.done);
            if rest <= NOTHING {
                self.done = end.total;
                return used;
            }
            if left <= 1e-15 {
                break;
            }
            used += self.phase(law, end, spin, left);
        }
        if end.total - self.done <= NOTHING {
            self.done = end.total;
            return used;
        }
        time
    }

    fn phase(&mut self, law: &GearLaw, end: GearEnd, spin: f64, left: f64) -> f64 {
        let rest = end.total - self.done;
        let unit = spin * law.time;
        if law.time <= 0.0 {
            self.rate = 1.0;
        }
        let last = end.last.unwrap_or(1.0);
        let braking = law.braking(self.rate, last, unit);
        if braking > 0.0 && rest <= braking * (1.0 + 1e-9) {
            return self.drop_rate(law, last, spin, rest, left);
        }
        if self.rate < 1.0 {
            return self.take_up(law, last, spin, rest, left);
        }
        let room = rest - braking;
        let until = room / spin;
        if until > left {
            self.done += spin * left;
            return left;
        }
        self.done += room;
        until
    }

    /// Increases the rate towards 1, or to the point where it must decrease.
    fn take_up(&mut self, law: &GearLaw, last: f64, spin: f64, rest: f64, left: f64) -> f64 {
        let (rate, time) = (self.rate, law.time);
        let unit = spin * time;
        if law.exponential {
            // Below the final rate no turns are reserved for the decrease.
            let rising = law.rise_time(rate, last);
            let until = if rate < last {
                rising
            } else {
                (rest - law.braking(rate, last, unit)) / spin
            };
            let span = until.clamp(0.0, left);
            if span <= 1e-15 {
                return self.coast(spin, rest, left);
            }
            let reached = 1.0 - (1.0 - rate) * libm::exp(-span / time);
            let made = spin * (span - time * (reached - rate));
            self.rate = reached;
            if rate < last {
                if made >= rest {
                    self.done += rest;
                    return span * rest / made;
                }
                if span >= rising {
                    self.rate = last;
                }
            }
            self.done += made;
            return span;
        }
        let free = (rate * rate + 2.0 * rest / unit).sqrt();
        let peak = if free <= last {
            free
        } else {
            (f64::midpoint(rate * rate, last * last) + rest / unit)
                .sqrt()
                .min(1.0)
        };
        if peak <= rate {
            return self.coast(spin, rest, left);
        }
        let whole = time * (peak - rate);
        let (span, reached) = if whole <= left {
            (whole, peak)
        } else {
            (left, rate + left / time)
        };
        self.done += spin * f64::midpoint(rate, reached) * span;
        self.rate = reached;
        span
    }

    /// Keeps the present rate to the end.
    fn coast(&mut self, spin: f64, rest: f64, left: f64) -> f64 {
        let until = rest / (spin * self.rate.max(1e-6));
        if until > left {
            self.done += spin * self.rate * left;
            return left;
        }
        self.done += rest;
        until
    }

    /// Decreases the rate to `last` exactly at the end, at any change of the spindle speed.
    fn drop_rate(&mut self, law: &GearLaw, last: f64, spin: f64, rest: f64, left: f64) -> f64 {
        let rate = self.rate;
        if law.exponential {
            let own = rest / (spin * (rate - last));
            let reached = rate * libm::exp(-left / own);
            if reached > last {
                self.done += rest - spin * own * (reached - last);
                self.rate = reached;
                return left;
            }
            self.done += rest;
            self.rate = last;
            return (own * libm::log(rate / last)).min(left);
        }
        let until = 2.0 * rest / (spin * (rate + last));
        if until <= left {
            self.done += rest;
            self.rate = last;
            return until;
        }
        self.rate = rate - (rate - last) * left / until;
        self.done += spin * f64::midpoint(rate, self.rate) * left;
        left
    }
}
