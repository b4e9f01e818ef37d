//! Splits the hole cycles G73 to G89 into steps.
//!
//! ```text
//!   1 rapid over the hole      initial level ---1---+
//!   2 rapid to R                                    2
//!   3 in, by the code          R level              +--- and back to R (G99) or to the
//!   4 at the bottom                                 3    initial level (G98)
//!   5 back                     Z                    4
//! ```

use gsk_core::alarm::{Alarm, number};
use gsk_messages::say;

use crate::memory::{MillMemory, parameter};
use crate::modal::{Hole, SpindleState};
use crate::space::{Length, MillAxis, MillPosition, Plane};

/// The words of a hole cycle, which remain in force for the next holes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct HoleData {
    /// Level of the tool before the first hole, a machine coordinate.
    pub(crate) initial: Length,
    /// R level as programmed; `None` until it is. With G91 it counts from the initial level.
    pub(crate) r: Option<HoleLevel>,
    /// Bottom of the hole: Z, or the axis across the plane; `None` until programmed. With G91
    /// it counts from R.
    pub(crate) bottom: Option<HoleLevel>,
    /// Word Q: the depth of a peck, or the shift of G76 and G87; `None` until programmed.
    pub(crate) q: Option<Length>,
    /// Dwell at the bottom (word P), s.
    pub(crate) dwell_s: f64,
}

/// A level of a hole as programmed, absolute or incremental.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HoleLevel {
    pub(crate) value: Length,
    pub(crate) incremental: bool,
}

/// A step of a hole cycle: a move, a dwell or a spindle change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum HoleStep {
    /// The tool moves to this point at rapid, machine coordinates.
    Rapid(MillPosition),
    /// The tool moves to this point at the feed, machine coordinates.
    Feed(MillPosition),
    /// The tap moves to a point, synchronised with the spindle.
    Tap {
        /// End of the tap's move, machine coordinates.
        to: MillPosition,
        /// Whether the tap moves out of the hole.
        out: bool,
    },
    /// The cycle dwells for this number of seconds.
    Dwell(f64),
    /// The spindle changes to this state.
    Spindle(SpindleState),
}

/// A hole to be made: its position, levels and cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drilling<'a> {
    pub(crate) hole: Hole,
    pub(crate) plane: Plane,
    /// Position over the hole, at the level at which the tool is before the cycle.
    pub(crate) over: MillPosition,
    pub(crate) initial: Length,
    pub(crate) r: Length,
    pub(crate) bottom: Length,
    pub(crate) q: Option<Length>,
    pub(crate) dwell_s: f64,
    pub(crate) to_r: bool,
    pub(crate) spindle: SpindleState,
    /// Whether taps are rigid (M29); then Q is the depth of a peck.
    pub(crate) rigid: bool,
    pub(crate) memory: &'a MillMemory,
}

/// Greatest number of pecks in a hole.
const MAX_PECKS: i64 = 10_000;

fn too_many_pecks() -> Alarm {
    Alarm::new(number::CYCLE_DATA).with_detail(say::mill_too_many_pecks(MAX_PECKS))
}

impl Drilling<'_> {
    /// Returns the point over the hole with Z at `level`.
    fn at(&self, level: Length) -> MillPosition {
        let mut point = self.over;
        point.set(self.plane.across(), level);
        point
    }

    /// Returns the point of the hole at a level, moved sideways by the shift of G76 and G87.
    fn shifted(&self, level: Length, shift: Length) -> MillPosition {
        let mut point = self.at(level);
        let bit = |bit| self.memory.bit(parameter::SHIFT, bit);
        let [first, second, _] = self.plane.axes();
        let axis: MillAxis = if bit(1) { second } else { first };
        let by = if bit(0) { -shift } else { shift };
        point.set(axis, point.get(axis) + by);
        point
    }

    /// Returns the steps that make the hole, in order. Errors: alarm 062 if Q is missing.
    pub(crate) fn steps(&self) -> Result<Vec<HoleStep>, Alarm> {
        let mut steps = vec![HoleStep::Rapid(self.over)];
        let (in_r, end) = (self.at(self.r), self.at(self.bottom));
        if self.hole != Hole::BackBore {
            steps.push(HoleStep::Rapid(in_r));
        }
        let feeds_out = matches!(self.hole, Hole::Bore | Hole::BoreDwell);
        match self.hole {
            Hole::Drill | Hole::Bore => steps.push(HoleStep::Feed(end)),
            Hole::DrillDwell | Hole::BoreDwell => {
                steps.extend([HoleStep::Feed(end), HoleStep::Dwell(self.dwell_s)]);
            }
            Hole::HighSpeedPeck | Hole::Peck => self.peck(&mut steps)?,
            Hole::LeftTap | Hole::RightTap => {
                self.tap(&mut steps)?;
                return Ok(self.with_dwell(steps));
            }
            // With G88 the operator withdraws the tool by hand.
            Hole::BoreStop | Hole::BoreByHand => steps.extend([
                HoleStep::Feed(end),
                HoleStep::Dwell(self.dwell_s),
                HoleStep::Spindle(SpindleState::Stopped),
            ]),
            Hole::FineBore => {
                let shift = self.required_q()?;
                steps.extend([
                    HoleStep::Feed(end),
                    HoleStep::Dwell(self.dwell_s),
                    HoleStep::Spindle(SpindleState::Stopped),
                    HoleStep::Rapid(self.shifted(self.bottom, shift)),
                    HoleStep::Rapid(self.shifted(self.return_level(), shift)),
                    HoleStep::Rapid(self.at(self.return_level())),
                    HoleStep::Spindle(self.spindle),
                ]);
                return Ok(self.with_dwell(steps));
            }
            Hole::BackBore => {
                let shift = self.required_q()?;
                let top = self.initial;
                steps.extend([
                    HoleStep::Spindle(SpindleState::Stopped),
                    HoleStep::Rapid(self.shifted(top, shift)),
                    HoleStep::Rapid(self.shifted(self.r, shift)),
                    HoleStep::Rapid(in_r),
                    HoleStep::Spindle(self.spindle),
                    HoleStep::Feed(end),
                    HoleStep::Dwell(self.dwell_s),
                    HoleStep::Spindle(SpindleState::Stopped),
                    HoleStep::Rapid(self.shifted(self.bottom, shift)),
                    HoleStep::Rapid(self.shifted(top, shift)),
                    HoleStep::Rapid(self.at(top)),
                    HoleStep::Spindle(self.spindle),
                ]);
                return Ok(self.with_dwell(steps));
            }
        }
        if feeds_out {
            steps.push(HoleStep::Feed(in_r));
        }
        steps.push(HoleStep::Rapid(self.at(self.return_level())));
        if matches!(self.hole, Hole::BoreStop | Hole::BoreByHand) {
            steps.push(HoleStep::Spindle(self.spindle));
        }
        Ok(self.with_dwell(steps))
    }

    /// Returns the level to which the tool returns after the hole: R or the initial level.
    const fn return_level(&self) -> Length {
        if self.to_r { self.r } else { self.initial }
    }

    /// Appends the dwell that parameter 5108 adds after every hole, and removes dwells of 0.
    fn with_dwell(&self, mut steps: Vec<HoleStep>) -> Vec<HoleStep> {
        let dwell = self.memory.value(parameter::HOLE_DWELL);
        if dwell > 0 {
            steps.push(HoleStep::Dwell(f64::from(dwell) / 1000.0));
        }
        steps.retain(|step| !matches!(step, HoleStep::Dwell(seconds) if *seconds <= 0.0));
        steps
    }

    /// Returns the absolute value of Q. Errors: alarm 062 if it is missing or 0.
    fn required_q(&self) -> Result<Length, Alarm> {
        let shift = self.q.map(Length::abs).filter(|it| *it > Length::ZERO);
        shift.ok_or_else(|| {
            let detail = say::mill_hole_without_q(self.hole.code());
            Alarm::new(number::CYCLE_DATA).with_detail(detail)
        })
    }

    /// Appends the pecks of G73 and G83. G73 retracts a little after each peck. G83 retracts
    /// to R and returns to just before the last depth.
    fn peck(&self, steps: &mut Vec<HoleStep>) -> Result<(), Alarm> {
        let q = self.required_q()?;
        let depth = self.bottom - self.r;
        let down = depth < Length::ZERO;
        let step = if down { -q } else { q };
        let away = |length: Length| if down { length } else { -length };
        let back = away(self.memory.length(parameter::PECK_BACK));
        let clearance = away(self.memory.length(parameter::PECK_CLEARANCE));
        let reached = |level: Length| {
            if down {
                level <= self.bottom
            } else {
                level >= self.bottom
            }
        };
        // Not above R.
        let not_out = |level: Length| {
            if (level > self.r) == down {
                self.r
            } else {
                level
            }
        };
        let mut level = self.r;
        for peck in 0.. {
            if peck == MAX_PECKS {
                return Err(too_many_pecks());
            }
            let before = level;
            if peck > 0 && self.hole == Hole::Peck {
                steps.push(HoleStep::Rapid(self.at(self.r)));
                steps.push(HoleStep::Rapid(self.at(not_out(before + clearance))));
            } else if peck > 0 {
                steps.push(HoleStep::Rapid(self.at(not_out(before + back))));
            }
            level = before + step;
            if reached(level) {
                break;
            }
            steps.push(HoleStep::Feed(self.at(level)));
        }
        steps.push(HoleStep::Feed(self.at(self.bottom)));
        steps.push(HoleStep::Dwell(self.dwell_s));
        Ok(())
    }

    /// Appends the steps of G74 and G84: in, spindle reversal, out. With M29 and Q they tap in
    /// pecks. Without an encoder they drill.
    fn tap(&self, steps: &mut Vec<HoleStep>) -> Result<(), Alarm> {
        let (in_r, end) = (self.at(self.r), self.at(self.bottom));
        if self.memory.value(parameter::ENCODER) == 0 {
            steps.push(HoleStep::Feed(end));
        } else {
            let (in_turn, out_turn) = match self.hole {
                Hole::LeftTap => (SpindleState::Reverse, SpindleState::Forward),
                _ => (SpindleState::Forward, SpindleState::Reverse),
            };
            steps.push(HoleStep::Spindle(in_turn));
            let tap = |to: MillPosition, out: bool| HoleStep::Tap { to, out };
            for (level, back) in self.tap_pecks()? {
                steps.extend([
                    tap(self.at(level), false),
                    HoleStep::Spindle(out_turn),
                    tap(self.at(back), true),
                    HoleStep::Spindle(in_turn),
                ]);
            }
            steps.extend([
                tap(end, false),
                HoleStep::Dwell(self.dwell_s),
                HoleStep::Spindle(out_turn),
                tap(in_r, true),
                HoleStep::Spindle(in_turn),
            ]);
        }
        steps.push(HoleStep::Rapid(self.at(self.return_level())));
        Ok(())
    }

    /// Returns the pecks of a rigid tap before the last one: the depth, and the level of the
    /// retraction. That is 5213 above the depth (588.5 = 1), or R.
    fn tap_pecks(&self) -> Result<Vec<(Length, Length)>, Alarm> {
        let q = self.q.map_or(Length::ZERO, Length::abs);
        let mut pecks = Vec::new();
        if !self.rigid || q == Length::ZERO {
            return Ok(pecks);
        }
        let down = self.bottom < self.r;
        let signed = |length: Length| if down { -length } else { length };
        let before_bottom = |level: Length| (level > self.bottom) == down && level != self.bottom;
        let a_little = self.memory.length(parameter::TAP_BACK);
        let short = self.memory.bit(parameter::TAPS, 5);
        let mut level = self.r + signed(q);
        while before_bottom(level) {
            if pecks.len() as i64 == MAX_PECKS {
                return Err(too_many_pecks());
            }
            let back = if short && a_little < q {
                level - signed(a_little)
            } else {
                self.r
            };
            pecks.push((level, back));
            level = level + signed(q);
        }
        Ok(pecks)
    }
}
