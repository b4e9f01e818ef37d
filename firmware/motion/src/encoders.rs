//! The spindle encoder with its index, the encoders of the axes, and the edge counter.

use crate::messages::Reason;
use crate::stepper::SpindleAngle;

/// Greatest number of counts between two calls, and least number of counts per turn. A greater
/// number means that counts are lost.
pub const MAX_COUNTS: i32 = 64;
/// Greatest difference between two index pulses from whole turns, counts.
const INDEX_TOLERANCE: u32 = 8;

/// The encoder of the spindle.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpindleEncoder {
    pub oid: u32,
    pub angle: SpindleAngle,
    /// The pin of the index; `None` without one.
    pub index_pin: Option<u32>,
    was_index: bool,
    /// Count at the first index pulse; `None` before it.
    first_index: Option<i32>,
    /// Count at the last index pulse.
    pub index_count: i32,
    /// The last count of the counter in hardware.
    seen: i32,
}

impl SpindleEncoder {
    /// Creates the encoder; `raw` is the count of the counter in hardware.
    pub fn new(oid: u32, counts_per_turn: u32, index_pin: Option<u32>, raw: i32) -> Self {
        Self {
            oid,
            angle: SpindleAngle {
                counts_per_turn,
                is_referenced: index_pin.is_none(),
                ..SpindleAngle::default()
            },
            index_pin,
            seen: raw,
            was_index: true,
            ..Self::default()
        }
    }

    /// Returns the counts since the last call, and takes them.
    ///
    /// # Errors
    /// Counts are lost.
    #[inline(always)]
    pub fn take_counts(&mut self, raw: i32) -> Result<i32, Reason> {
        let counts = raw.wrapping_sub(self.seen);
        if counts == 0 {
            return Ok(0);
        }
        if !(-MAX_COUNTS..=MAX_COUNTS).contains(&counts) {
            return Err(Reason::SpindleOverrun);
        }
        self.seen = raw;
        let angle = &mut self.angle;
        angle.count = angle.count.wrapping_add(counts);
        let turn = angle.counts_per_turn as i32;
        let mut turn_count = angle.turn_count as i32 + counts;
        if turn_count >= turn {
            turn_count -= turn;
        } else if turn_count < 0 {
            turn_count += turn;
        }
        angle.turn_count = turn_count as u32;
        Ok(counts)
    }

    /// Takes the level of the index pin. The first index pulse is the angle 0.
    ///
    /// # Errors
    /// The index has moved: counts are lost or the index is disturbed.
    pub fn take_index(&mut self, is_index: bool) -> Result<(), Reason> {
        let is_pulse = is_index && !self.was_index;
        self.was_index = is_index;
        if !is_pulse {
            return Ok(());
        }
        self.index_count = self.angle.count;
        let Some(_) = self.first_index else {
            self.first_index = Some(self.angle.count);
            self.angle.turn_count = 0;
            self.angle.is_referenced = true;
            return Ok(());
        };
        let off = self.angle.turn_count;
        if off > INDEX_TOLERANCE && self.angle.counts_per_turn - off > INDEX_TOLERANCE {
            return Err(Reason::IndexMoved);
        }
        Ok(())
    }
}

/// The encoder of an axis, which checks that the motor has followed.
#[derive(Clone, Copy, Debug)]
pub struct AxisEncoder {
    /// Index of the axis.
    pub axis: usize,
    /// The ratio: this number of counts ...
    pub counts: i32,
    /// ... in this number of steps.
    pub steps: i32,
    /// Greatest following error, steps.
    pub limit: i32,
    /// Count of the counter in hardware and position of the axis when they were compared first.
    pub reference: (i32, i32),
}

impl AxisEncoder {
    /// Whether the axis differs from its encoder by more than the limit.
    pub fn has_following_error(&self, position: i32, raw: i32) -> bool {
        let steps = i64::from(position.wrapping_sub(self.reference.1));
        let counts = i64::from(raw.wrapping_sub(self.reference.0));
        let error = steps * i64::from(self.counts) - counts * i64::from(self.steps);
        error.abs() > i64::from(self.limit) * i64::from(self.counts)
    }
}

/// The handwheel: an encoder that the board only reports.
#[derive(Clone, Copy, Debug, Default)]
pub struct Handwheel {
    pub oid: u32,
    /// Clock of the next report, ticks; `None` without a query.
    pub next: Option<u32>,
    pub rest_ticks: u32,
}

/// A counter of level changes at an input.
#[derive(Clone, Copy, Debug, Default)]
pub struct EdgeCounter {
    pub oid: u32,
    pub pin: u32,
    /// Clock of the next sample, ticks; `None` before the first query.
    pub next: Option<u32>,
    pub poll_ticks: u32,
    pub report: u32,
    pub report_ticks: u32,
    pub is_high: bool,
    pub count: u32,
    pub count_clock: u32,
}
