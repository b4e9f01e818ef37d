//! The spindle with its encoder, and the pass that is cut behind it (G33).
//!
//! ```text
//!   G33 read      second one-turn signal from here       end of the way
//!   ───┴───────────────────┴──────────────────────────────────┴───► ok
//!      speed measured      motion begins, at that speed: nothing is corrected
//!      no reports          (gains 0), or wrongly
//! ```

use super::block::{CutFeed, ParsedBlock};
use super::{GrblState, GrblTwin, Variant};

/// Time constant of the spindle, s.
const TIME_CONSTANT_S: f64 = 0.1;
/// Nearer to its speed than this part it has it.
const SPEED_TOLERANCE: f64 = 1e-5;
/// The one-turn signals must have come by then, ns.
const INDEX_TIMEOUT_NS: u64 = 5_000_000_000;
/// One-turn signals that are waited for.
const INDEX_SIGNALS_BEFORE_START: f64 = 2.0;
/// How much longer than asked for the pass becomes for each 1 of the gain $90.
const SPEED_ERROR_PER_GAIN: f64 = 0.0165;
/// Part of the rate of Z that a pass may take.
const MAX_Z_RATE_FRACTION: f64 = 0.9;

/// What turns behind the board.
#[derive(Clone, Debug)]
pub struct GrblSpindle {
    /// Speed at the greatest S, r/min.
    pub full_speed_rpm: f64,
    /// It stands whatever the board says.
    pub blocked: bool,
    rpm: f64,
    turns: f64,
}

impl Default for GrblSpindle {
    fn default() -> Self {
        Self {
            full_speed_rpm: 9999.0,
            blocked: false,
            rpm: 0.0,
            turns: 0.0,
        }
    }
}

impl GrblSpindle {
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
        self.rpm = if off.abs() <= SPEED_TOLERANCE * self.full_speed_rpm {
            wanted
        } else {
            self.rpm + off * (seconds / TIME_CONSTANT_S).min(1.0)
        };
        self.turns += self.rpm / 60.0 * seconds;
    }
}

/// Where the slides were at which turn of the spindle: X, Z in pulses.
#[derive(Clone, Debug, Default)]
pub struct PassTrace(pub Vec<([i64; 2], f64)>);

/// A pass under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct ThreadPass {
    block: ParsedBlock,
    target: [f64; 3],
    /// Speed along the path, mm/s.
    speed: f64,
    /// Turn at which it begins, and when waiting for it began; none: it has begun.
    waits_for_index: Option<(f64, u64)>,
}

impl ThreadPass {
    pub(super) const fn is_waiting_for_index(&self) -> bool {
        self.waits_for_index.is_some()
    }
}

impl GrblTwin {
    /// Whether it was told of an encoder and can thread.
    pub(super) fn has_spindle_sync(&self) -> bool {
        self.variant == Variant::GrblHal && self.settings.value(38) > 0.0
    }

    /// The spindle.
    pub const fn spindle(&self) -> &GrblSpindle {
        &self.spindle
    }

    /// The same, to be changed.
    pub const fn spindle_mut(&mut self) -> &mut GrblSpindle {
        &mut self.spindle
    }

    /// The passes cut so far.
    pub fn passes(&self) -> &[PassTrace] {
        &self.passes
    }

    /// G33 is carried out; answered when it is over.
    pub(super) fn begin_pass(
        &mut self,
        block: ParsedBlock,
        target: [f64; 3],
        lead: f64,
    ) -> Result<(), u8> {
        let rpm = self.spindle.rpm.abs();
        if rpm == 0.0 {
            return Err(41);
        }
        if rpm * lead > self.settings.value(112) * MAX_Z_RATE_FRACTION {
            return Err(43);
        }
        let gain = 1.0 + SPEED_ERROR_PER_GAIN * self.settings.value(90);
        let index = self.spindle.turns.abs().floor() + INDEX_SIGNALS_BEFORE_START;
        self.pass = Some(ThreadPass {
            block,
            target,
            speed: rpm * lead / 60.0 * gain,
            waits_for_index: Some((index, self.now)),
        });
        self.passes.push(PassTrace::default());
        self.state = GrblState::Run;
        Ok(())
    }

    /// A step of the spindle, and of the pass that waits for it or follows it.
    pub(super) fn advance_spindle(&mut self, step: u64) {
        let seconds = step as f64 * 1e-9;
        let full = match self.variant {
            Variant::FluidNc => self.full_speed_rpm(),
            Variant::Grbl | Variant::GrblHal => self.settings.value(30),
        };
        let share = (self.modal.speed / full.max(1e-9)).clamp(0.0, 1.0);
        let wanted = match self.spindle_code {
            3 => share * self.spindle.full_speed_rpm,
            4 => -share * self.spindle.full_speed_rpm,
            _ => 0.0,
        };
        self.spindle.advance(seconds, wanted);
        let Some(mut pass) = self.pass else {
            return;
        };
        let Some((index, since)) = pass.waits_for_index else {
            return;
        };
        let beyond = self.spindle.turns.abs() - index;
        if beyond >= 0.0 {
            pass.waits_for_index = None;
            pass.block.feed = CutFeed::Speed(pass.speed);
            self.pass = Some(pass);
            self.plan_move(pass.target, pass.block);
            // The part of this step behind the signal; the rest is to come.
            let passed = beyond / (self.spindle.rpm.abs() / 60.0).max(1e-9);
            self.pass_time_offset_s = passed.min(seconds) - seconds;
        } else if self.now >= since + INDEX_TIMEOUT_NS {
            self.pass = None;
            self.state = GrblState::Alarm;
            self.send_text("ALARM:14\r\n");
            // It waits for ever for the motion it has not begun.
            self.main_loop_blocked = true;
        }
    }

    /// Notes where the slides are in a pass.
    pub(super) fn record_pass_position(&mut self) {
        let under_way = self.pass.is_some_and(|pass| !pass.is_waiting_for_index());
        let (at, turns) = (self.pulses(), self.spindle.turns);
        if let (true, Some(trace)) = (under_way, self.passes.last_mut())
            && trace.0.last().is_none_or(|(before, _)| *before != at)
        {
            trace.0.push((at, turns));
        }
    }

    /// The way of a pass is made.
    pub(super) fn finish_pass(&mut self) {
        if self.pass.take().is_some() {
            self.send_answer(Ok(()));
            if core::mem::take(&mut self.hold_pending) {
                self.state = GrblState::Hold { complete: true };
            }
        }
    }
}
