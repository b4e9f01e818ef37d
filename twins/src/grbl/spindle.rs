//! The spindle with its encoder, and the pass that is cut behind it (G33).
//!
//! ```text
//!   G33 read      second one-turn signal from here       end of the way
//!   ───┴───────────────────┴──────────────────────────────────┴───► ok
//!      speed measured      motion begins, at that speed: nothing is corrected
//!      no reports          (gains 0), or wrongly
//! ```

use super::block::{Asked, Pace};
use super::{GrblTwin, State, Variant};

/// Time constant of the spindle, s.
const LAG: f64 = 0.1;
/// Nearer to its speed than this part it has it.
const ARRIVED: f64 = 1e-5;
/// The one-turn signals must have come by then, ns.
const INDEX_NS: u64 = 5_000_000_000;
/// One-turn signals that are waited for.
const SIGNALS: f64 = 2.0;
/// How much longer than asked for the pass becomes for each 1 of the gain $90.
const TRAP: f64 = 0.0165;
/// Part of the rate of Z that a pass may take.
const FASTEST: f64 = 0.9;

/// What turns behind the board.
#[derive(Clone, Debug)]
pub struct Spindle {
    /// Speed at the greatest S, r/min.
    pub full_speed: f64,
    /// It stands whatever the board says.
    pub blocked: bool,
    rpm: f64,
    turns: f64,
}

impl Default for Spindle {
    fn default() -> Self {
        Self {
            full_speed: 9999.0,
            blocked: false,
            rpm: 0.0,
            turns: 0.0,
        }
    }
}

impl Spindle {
    /// Its speed, r/min.
    pub const fn rpm(&self) -> f64 {
        self.rpm
    }

    /// Turns since power-on.
    pub const fn turns(&self) -> f64 {
        self.turns
    }

    fn advance(&mut self, seconds: f64, wanted: f64) {
        let wanted = if self.blocked { 0.0 } else { wanted };
        let off = wanted - self.rpm;
        self.rpm = if off.abs() <= ARRIVED * self.full_speed {
            wanted
        } else {
            self.rpm + off * (seconds / LAG).min(1.0)
        };
        self.turns += self.rpm / 60.0 * seconds;
    }
}

/// Where the slides were at which turn of the spindle: X, Z in pulses.
#[derive(Clone, Debug, Default)]
pub struct PassTrace(pub Vec<([i64; 2], f64)>);

/// A pass under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    asked: Asked,
    target: [f64; 3],
    /// Speed along the path, mm/s.
    speed: f64,
    /// Turn at which it begins, and when waiting for it began; none: it has begun.
    waits: Option<(f64, u64)>,
}

impl Pass {
    pub(super) const fn is_waiting(&self) -> bool {
        self.waits.is_some()
    }
}

impl GrblTwin {
    /// Whether it was told of an encoder and can thread.
    pub(super) fn has_spindle_sync(&self) -> bool {
        self.variant == Variant::GrblHal && self.settings.value(38) > 0.0
    }

    /// The spindle.
    pub const fn spindle(&self) -> &Spindle {
        &self.shaft
    }

    /// The same, to be changed.
    pub const fn spindle_mut(&mut self) -> &mut Spindle {
        &mut self.shaft
    }

    /// The passes cut so far.
    pub fn passes(&self) -> &[PassTrace] {
        &self.passes
    }

    /// G33 is carried out; answered when it is over.
    pub(super) fn begin_pass(
        &mut self,
        asked: Asked,
        target: [f64; 3],
        lead: f64,
    ) -> Result<(), u8> {
        let rpm = self.shaft.rpm.abs();
        if rpm == 0.0 {
            return Err(41);
        }
        if rpm * lead > self.settings.value(112) * FASTEST {
            return Err(43);
        }
        let gain = 1.0 + TRAP * self.settings.value(90);
        let index = self.shaft.turns.abs().floor() + SIGNALS;
        self.pass = Some(Pass {
            asked,
            target,
            speed: rpm * lead / 60.0 * gain,
            waits: Some((index, self.now)),
        });
        self.passes.push(PassTrace::default());
        self.state = State::Run;
        Ok(())
    }

    /// A step of the spindle, and of the pass that waits for it or follows it.
    pub(super) fn turn_spindle(&mut self, step: u64) {
        let seconds = step as f64 * 1e-9;
        let full = match self.variant {
            Variant::FluidNc => self.top_speed(),
            Variant::Grbl | Variant::GrblHal => self.settings.value(30),
        };
        let share = (self.modal.speed / full.max(1e-9)).clamp(0.0, 1.0);
        let wanted = match self.spindle {
            3 => share * self.shaft.full_speed,
            4 => -share * self.shaft.full_speed,
            _ => 0.0,
        };
        self.shaft.advance(seconds, wanted);
        let Some(mut pass) = self.pass else {
            return;
        };
        let Some((index, since)) = pass.waits else {
            return;
        };
        let beyond = self.shaft.turns.abs() - index;
        if beyond >= 0.0 {
            pass.waits = None;
            pass.asked.pace = Pace::Speed(pass.speed);
            self.pass = Some(pass);
            self.plan(pass.target, pass.asked);
            // The part of this step behind the signal; the rest is to come.
            let passed = beyond / (self.shaft.rpm.abs() / 60.0).max(1e-9);
            self.head_start = passed.min(seconds) - seconds;
        } else if self.now >= since + INDEX_NS {
            self.pass = None;
            self.state = State::Alarm;
            self.say("ALARM:14\r\n");
            // It waits for ever for the motion it has not begun.
            self.stuck = true;
        }
    }

    /// Notes where the slides are in a pass.
    pub(super) fn trace_pass(&mut self) {
        let under_way = self.pass.is_some_and(|pass| !pass.is_waiting());
        let (at, turns) = (self.pulses(), self.shaft.turns);
        if let (true, Some(trace)) = (under_way, self.passes.last_mut())
            && trace.0.last().is_none_or(|(before, _)| *before != at)
        {
            trace.0.push((at, turns));
        }
    }

    /// The way of a pass is made.
    pub(super) fn end_pass(&mut self) {
        if self.pass.take().is_some() {
            self.answer(Ok(()));
            if core::mem::take(&mut self.hold_pending) {
                self.state = State::Hold { complete: true };
            }
        }
    }
}
