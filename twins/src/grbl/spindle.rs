//! The spindle with its encoder, and thread passes synchronized to it (G33).
//!
//! ```text
//!   G33 read      second one-turn signal from here       end of the move
//!   ───┴───────────────────┴──────────────────────────────────┴───► ok
//!      speed measured      motion begins, at that speed: nothing is corrected
//!      no reports          (gains 0), or wrongly
//! ```

use super::block::{CutFeed, ParsedBlock};
use super::{GrblState, GrblTwin, Variant};

/// Time constant with which the spindle approaches its speed, s.
const TIME_CONSTANT_S: f64 = 0.1;
/// Relative difference from the commanded speed below which the spindle counts as at speed.
const SPEED_TOLERANCE: f64 = 1e-5;
/// Time without an index signal after which a thread pass ends with an alarm, ns.
const INDEX_TIMEOUT_NS: u64 = 5_000_000_000;
/// Number of index signals until a thread pass starts.
const INDEX_SIGNALS_BEFORE_START: f64 = 2.0;
/// Relative increase of the speed of a thread pass per unit of the gain $90.
const SPEED_ERROR_PER_GAIN: f64 = 0.0165;
/// Maximum speed of a thread pass as a fraction of the maximum Z rate ($112).
const MAX_Z_RATE_FRACTION: f64 = 0.9;

/// The spindle of a lathe with a Grbl board, with its speed and angle.
#[derive(Clone, Debug)]
pub struct GrblSpindle {
    /// Spindle speed at the maximum S value, r/min.
    pub full_speed_rpm: f64,
    /// Whether the spindle is blocked, so that it cannot turn.
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
    /// Returns the spindle speed, r/min; negative in reverse.
    pub const fn rpm(&self) -> f64 {
        self.rpm
    }

    /// Returns the number of spindle turns since power-on; reverse turns are subtracted.
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

/// Record of a thread pass: positions of X and Z, pulses, each with the turns of the spindle
/// there.
#[derive(Clone, Debug, Default)]
pub struct PassTrace(pub Vec<([i64; 2], f64)>);

/// The thread pass (G33) that the board executes.
#[derive(Clone, Copy, Debug)]
pub(super) struct TwinThreadPass {
    block: ParsedBlock,
    target: [f64; 3],
    /// Speed of the thread pass along the path, mm/s.
    speed: f64,
    /// Spindle turn at which the pass starts, and the time at which the wait began, ns; `None`
    /// after the start.
    waits_for_index: Option<(f64, u64)>,
}

impl TwinThreadPass {
    pub(super) const fn is_waiting_for_index(&self) -> bool {
        self.waits_for_index.is_some()
    }
}

impl GrblTwin {
    /// Returns whether an encoder is configured, so that the board can cut threads.
    pub(super) fn has_spindle_sync(&self) -> bool {
        self.variant == Variant::GrblHal && self.settings.value(38) > 0.0
    }

    /// Returns the spindle of the board.
    pub const fn spindle(&self) -> &GrblSpindle {
        &self.spindle
    }

    /// Returns the spindle of the board, mutable.
    pub const fn spindle_mut(&mut self) -> &mut GrblSpindle {
        &mut self.spindle
    }

    /// Returns the recorded motion of all thread passes so far.
    pub fn passes(&self) -> &[PassTrace] {
        &self.passes
    }

    /// Starts a thread pass (G33) to `target` with a lead in mm. The line is answered at the
    /// end of the pass. Returns the error number if the spindle stands still or the pass is
    /// too fast.
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
        self.pass = Some(TwinThreadPass {
            block,
            target,
            speed: rpm * lead / 60.0 * gain,
            waits_for_index: Some((index, self.now)),
        });
        self.passes.push(PassTrace::default());
        self.state = GrblState::Run;
        Ok(())
    }

    /// Advances the spindle by `step` ns, and starts a thread pass that waits for its index
    /// signal.
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
            // The time in this step after the index signal.
            let passed = beyond / (self.spindle.rpm.abs() / 60.0).max(1e-9);
            self.pass_time_offset_s = passed.min(seconds) - seconds;
        } else if self.now >= since + INDEX_TIMEOUT_NS {
            self.pass = None;
            self.state = GrblState::Alarm;
            self.send_text("ALARM:14\r\n");
            // The firmware waits forever for a motion that never starts.
            self.main_loop_blocked = true;
        }
    }

    /// Records the position of the slides in the current thread pass if it has changed.
    pub(super) fn record_pass_position(&mut self) {
        let under_way = self.pass.is_some_and(|pass| !pass.is_waiting_for_index());
        let (at, turns) = (self.pulses(), self.spindle.turns);
        if let (true, Some(trace)) = (under_way, self.passes.last_mut())
            && trace.0.last().is_none_or(|(before, _)| *before != at)
        {
            trace.0.push((at, turns));
        }
    }

    /// Ends the thread pass, if one is in execution, and answers its line.
    pub(super) fn finish_pass(&mut self) {
        if self.pass.take().is_some() {
            self.send_answer(Ok(()));
            if core::mem::take(&mut self.hold_pending) {
                self.state = GrblState::Hold { complete: true };
            }
        }
    }
}
