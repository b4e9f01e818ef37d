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

use crate::memory::ControlParameters;

/// Number of thread turns below which a distance counts as zero.
const MIN_TURNS: f64 = 1e-12;

/// The law by which the electronic gear increases and decreases its rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct GearLaw {
    /// Time constant T of the gear (parameter 029), s.
    #[serde(rename = "time")]
    pub time_constant_s: f64,
    /// Whether the rate changes exponentially instead of linearly (175.4).
    pub exponential: bool,
    /// Speed at which threads start and end (028), mm/s.
    #[serde(rename = "lowest")]
    pub lowest_mm_per_s: f64,
}

impl GearLaw {
    /// The rate of the gear, at most 1, at which the tool has the speed of parameter 028. `lead` is
    /// in mm per turn, the spindle speed `spin` in turns/s.
    pub(crate) fn lowest_rate(&self, lead: f64, spin: f64) -> f64 {
        let speed = lead * spin;
        if self.time_constant_s <= 0.0 || speed <= self.lowest_mm_per_s {
            1.0
        } else {
            self.lowest_mm_per_s / speed
        }
    }

    /// Number of thread turns made while the rate decreases from `rate` to `last`; `unit` is the
    /// number of spindle turns in the time constant T.
    fn braking_turns(&self, rate: f64, last: f64, unit: f64) -> f64 {
        if rate <= last {
            0.0
        } else if self.exponential {
            unit * (rate - last)
        } else {
            unit * (rate * rate - last * last) / 2.0
        }
    }

    /// Duration of `total` thread turns at `spin` spindle turns/s, s. The rate is `first`
    /// at the start (1: already in phase) and `last` at the end (1: another thread
    /// continues).
    pub fn duration(&self, total: f64, spin: f64, first: f64, last: f64) -> f64 {
        if total <= MIN_TURNS {
            return 0.0;
        }
        if spin <= 0.0 {
            return f64::INFINITY;
        }
        let even_s = total / spin;
        let time = self.time_constant_s;
        if time <= 0.0 || (first >= 1.0 && last >= 1.0) {
            return even_s;
        }
        if self.exponential {
            return self.exponential_duration(even_s, first, last);
        }
        // Turns, as a fraction of those in T, for the direct change between both rates.
        let straight = (last * last - first * first) / 2.0;
        if even_s < time * straight {
            return time * ((first * first + 2.0 * even_s / time).sqrt() - first);
        }
        if even_s < -time * straight {
            return 2.0 * even_s / (first + last);
        }
        let peak = f64::midpoint(first * first, last * last) + even_s / time;
        if peak < 1.0 {
            return time * (2.0 * peak.sqrt() - first - last).max(0.0);
        }
        let lost = |rate: f64| (1.0 - rate) * (1.0 - rate) / 2.0;
        even_s + time * (lost(first) + lost(last))
    }

    fn exponential_duration(&self, even: f64, first: f64, last: f64) -> f64 {
        let time = self.time_constant_s;
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

    /// Time in which the exponential law raises the rate from `from` to `to`, s; infinite
    /// if `to` is 1.
    fn rise_time(&self, from: f64, to: f64) -> f64 {
        if from >= to {
            0.0
        } else if to >= 1.0 {
            f64::INFINITY
        } else {
            self.time_constant_s * libm::log((1.0 - from) / (1.0 - to))
        }
    }
}

/// Reads the law of lead-in and lead-out from the parameters (028, 029, 175.4).
pub(super) fn gear_law(parameters: &ControlParameters) -> GearLaw {
    GearLaw {
        time_constant_s: parameters.feed_time() / 1000.0,
        exponential: parameters.is_thread_exponential(),
        lowest_mm_per_s: parameters.thread_start_speed() / 60.0,
    }
}

/// The position at which a motion through the gear ends, and its rate there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GearEnd {
    /// Number of thread turns of the whole motion.
    pub total: f64,
    /// Rate of the gear at the end, thread turns per spindle turn; `None` if the next thread
    /// continues without slowing down.
    pub last: Option<f64>,
}

/// State of the electronic gear between spindle and tool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Gear {
    /// Rate of the gear: thread turns per spindle turn, 0–1.
    pub rate: f64,
    /// Number of thread turns made since the start.
    #[serde(rename = "done")]
    pub done_turns: f64,
}

impl Gear {
    /// Advances by the number `turns` of spindle turns, made in `time` seconds. Returns the time
    /// used, s; it is less than `time` only if the end is reached.
    pub fn advance(&mut self, law: &GearLaw, end: GearEnd, turns: f64, time: f64) -> f64 {
        if turns <= 0.0 || time <= 0.0 {
            // The spindle stands still or turns back: the tool follows, but never past the
            // start.
            self.done_turns += self.rate * turns.min(0.0);
            return time;
        }
        let spin = turns / time;
        let mut used = 0.0;
        // Each iteration is one phase: increase, keep, decrease the rate.
        for _ in 0..8 {
            let (left, rest) = (time - used, end.total - self.done_turns);
            if rest <= MIN_TURNS {
                self.done_turns = end.total;
                return used;
            }
            if left <= 1e-15 {
                break;
            }
            used += self.advance_phase(law, end, spin, left);
        }
        if end.total - self.done_turns <= MIN_TURNS {
            self.done_turns = end.total;
            return used;
        }
        time
    }

    fn advance_phase(&mut self, law: &GearLaw, end: GearEnd, spin: f64, left: f64) -> f64 {
        let rest = end.total - self.done_turns;
        let unit = spin * law.time_constant_s;
        if law.time_constant_s <= 0.0 {
            self.rate = 1.0;
        }
        let last = end.last.unwrap_or(1.0);
        let braking = law.braking_turns(self.rate, last, unit);
        if braking > 0.0 && rest <= braking * (1.0 + 1e-9) {
            return self.decrease_rate(law, last, spin, rest, left);
        }
        if self.rate < 1.0 {
            return self.increase_rate(law, last, spin, rest, left);
        }
        let free_turns = rest - braking;
        let until = free_turns / spin;
        if until > left {
            self.done_turns += spin * left;
            return left;
        }
        self.done_turns += free_turns;
        until
    }

    /// Increases the rate towards 1, up to the point where it must decrease, for `left` seconds at
    /// most. Returns the time used, s. `last` is the rate at the end, `spin` the spindle speed in
    /// turns/s, `rest` the number of thread turns to go.
    fn increase_rate(&mut self, law: &GearLaw, last: f64, spin: f64, rest: f64, left: f64) -> f64 {
        let (rate, time) = (self.rate, law.time_constant_s);
        let unit = spin * time;
        if law.exponential {
            // Below the final rate no turns are reserved for the decrease.
            let rising = law.rise_time(rate, last);
            let until = if rate < last {
                rising
            } else {
                (rest - law.braking_turns(rate, last, unit)) / spin
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
                    self.done_turns += rest;
                    return span * rest / made;
                }
                if span >= rising {
                    self.rate = last;
                }
            }
            self.done_turns += made;
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
        self.done_turns += spin * f64::midpoint(rate, reached) * span;
        self.rate = reached;
        span
    }

    /// Moves at the current rate, at most to the end and for `left` seconds. Returns the time used,
    /// s. `spin` is the spindle speed in turns/s, `rest` the number of thread turns to go.
    fn coast(&mut self, spin: f64, rest: f64, left: f64) -> f64 {
        let until = rest / (spin * self.rate.max(1e-6));
        if until > left {
            self.done_turns += spin * self.rate * left;
            return left;
        }
        self.done_turns += rest;
        until
    }

    /// Decreases the rate, for `left` seconds at most, so that it is `last` exactly at the end,
    /// even if the spindle speed changes. Returns the time used, s. `spin` is the spindle speed in
    /// turns/s, `rest` the number of thread turns to go.
    fn decrease_rate(&mut self, law: &GearLaw, last: f64, spin: f64, rest: f64, left: f64) -> f64 {
        let rate = self.rate;
        if law.exponential {
            let time_constant = rest / (spin * (rate - last));
            let reached = rate * libm::exp(-left / time_constant);
            if reached > last {
                self.done_turns += rest - spin * time_constant * (reached - last);
                self.rate = reached;
                return left;
            }
            self.done_turns += rest;
            self.rate = last;
            return (time_constant * libm::log(rate / last)).min(left);
        }
        let until = 2.0 * rest / (spin * (rate + last));
        if until <= left {
            self.done_turns += rest;
            self.rate = last;
            return until;
        }
        self.rate = rate - (rate - last) * left / until;
        self.done_turns += spin * f64::midpoint(rate, self.rate) * left;
        left
    }
}
