//! Follows the spindle angle for threads and taps, finer than a tick: waits for the start
//! angle, then turns with the spindle through the electronic gear.
//!
//! ```text
//!  spindle  ──┴── phase ──┴───────────────────────►   angle
//!           index       begin
//!  tick     ──┼───────┼───────┼───────┼───────►       part of the tick since then
//! ```

use serde::{Deserialize, Serialize};

use super::gear::{Gear, GearEnd};
use super::limits::MotionLimits;
use crate::spindle::SpindleTurn;
use crate::units::TICK_S;

/// A start angle that passed this long before the tick was missed, turns: the next one
/// counts.
const MISSED: f64 = 0.01;

/// State that a thread passes to the thread that continues it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Handover {
    /// Angle at which the next thread begins, turns.
    begin: f64,
    direction: f64,
    /// Spindle turns beyond that angle, and rate of the gear.
    #[serde(rename = "turned")]
    turned: f64,
    rate: f64,
}

impl Handover {
    /// Notes that the axes have stopped in between: only the angle still counts.
    pub(crate) const fn stand_still(&mut self) {
        self.rate = 0.0;
    }
}

/// What a thread or a tap waits for before it begins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Wait {
    /// The one-turn signal after the one at `seen`, and then `phase` turns more.
    Index { seen: Option<f64>, phase: f64 },
    /// The next time that this angle passes, turns.
    Angle(f64),
    /// This angle, turns, in this direction.
    Begin { angle: f64, direction: f64 },
}

impl Wait {
    pub fn degrees(degrees: f64) -> Self {
        let phase = degrees / 360.0;
        Self::Index {
            seen: None,
            phase: phase - phase.floor(),
        }
    }

    /// Advances the wait by one tick. When the start comes: its angle, the direction, and
    /// the fraction of the tick since then.
    fn tick(&mut self, spindle: &SpindleTurn, rpm: f64, hold: bool) -> Option<Beginning> {
        let direction = if rpm < 0.0 { -1.0 } else { 1.0 };
        if hold {
            if let Self::Index { seen, .. } = self {
                *seen = Some(spindle.index);
            }
            return None;
        }
        match *self {
            Self::Index { seen: None, phase } => {
                *self = Self::Index {
                    seen: Some(spindle.index),
                    phase,
                };
            }
            Self::Index {
                seen: Some(seen),
                phase,
            } if seen != spindle.index => {
                let angle = next(spindle.zero + direction * phase, spindle.index, direction);
                *self = Self::Begin { angle, direction };
            }
            Self::Angle(angle) => {
                let angle = next(angle, spindle.now, direction);
                *self = Self::Begin { angle, direction };
            }
            // The spindle was reversed in the meantime.
            Self::Begin {
                angle,
                direction: wanted,
            } if wanted != direction => {
                let angle = next(angle, spindle.now, direction);
                *self = Self::Begin { angle, direction };
            }
            Self::Index { .. } | Self::Begin { .. } => {}
        }
        let Self::Begin { angle, direction } = *self else {
            return None;
        };
        let since = direction * (spindle.now - angle);
        let step = direction * (spindle.now - spindle.before);
        if since > step + MISSED {
            *self = Self::Angle(angle);
            return None;
        }
        (since > 0.0 && step > 0.0).then(|| Beginning {
            angle,
            direction,
            part: (since / step).min(1.0),
        })
    }
}

/// The first angle at or after `from` that equals `angle` plus whole turns.
fn next(angle: f64, from: f64, direction: f64) -> f64 {
    let turns = direction * (from - angle);
    // The signal itself is the start, regardless of rounding.
    angle + direction * (turns - 1e-6).ceil()
}

/// The start of a thread within a tick.
#[derive(Clone, Copy, Debug)]
struct Beginning {
    pub angle: f64,
    pub direction: f64,
    /// Fraction of the tick since the start.
    pub part: f64,
}

/// Inputs of a motion that follows the spindle, for one tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpindleTick<'a> {
    pub limits: &'a MotionLimits,
    pub spindle: &'a SpindleTurn,
    /// Measured spindle speed, r/min.
    pub rpm: f64,
    /// Whether no thread may begin.
    pub hold: bool,
    /// Whether a thread continues in phase after this one.
    pub continues: bool,
}

/// Turns and leads of a motion that follows the spindle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    /// Total turns.
    pub turns: f64,
    /// Lead at the start, mm per turn.
    pub first_lead: f64,
    /// Lead at the end if the gear slows down for it; `None`: the motion continues.
    pub last_lead: Option<f64>,
}

/// Use of the time of a step, s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spent {
    /// Time before the start.
    pub waiting: f64,
    /// Time since the start: available, and used. `used` is less only at the end.
    pub offered: f64,
    pub used: f64,
}

/// Follows the spindle through the electronic gear.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Follower {
    wait: Option<Wait>,
    begin: f64,
    direction: f64,
    /// Spindle turns since the start.
    turned: f64,
    gear: Gear,
    /// Whether the spindle turns, at any speed.
    #[serde(rename = "turns")]
    turns: bool,
}

impl Follower {
    /// Begins when the wait has ended.
    pub const fn waiting(wait: Wait) -> Self {
        Self {
            wait: Some(wait),
            begin: 0.0,
            direction: 1.0,
            turned: 0.0,
            gear: Gear {
                rate: 0.0,
                done: 0.0,
            },
            turns: false,
        }
    }

    /// Continues another motion from its end. If that motion stopped, it waits for the next
    /// time that its end angle passes.
    pub(crate) const fn going_on(before: &Handover) -> Self {
        if before.rate <= 0.0 {
            return Self::waiting(Wait::Angle(before.begin));
        }
        Self {
            wait: None,
            begin: before.begin,
            direction: before.direction,
            turned: before.turned,
            gear: Gear {
                rate: before.rate,
                done: 0.0,
            },
            turns: true,
        }
    }

    /// Whether it has begun and the spindle turns. A slow spindle has ticks without a
    /// count.
    pub const fn is_moving(&self) -> bool {
        self.running() && self.turns
    }

    /// Whether it has begun.
    pub const fn running(&self) -> bool {
        self.wait.is_none()
    }

    /// Turns made by the tool. Negative when the spindle has turned back before the start.
    pub const fn done(&self) -> f64 {
        self.gear.done
    }

    /// Reverses: the other direction of the spindle leads out over the same turns.
    pub(crate) fn turn_back(&mut self) {
        self.begin += self.direction * self.turned;
        self.direction = -self.direction;
        self.turned = 0.0;
        self.gear = Gear {
            rate: 1.0,
            done: 0.0,
        };
    }

    /// State for a motion that continues this one after `turns`.
    pub(crate) fn handover(&self, turns: f64, continues: bool) -> Handover {
        Handover {
            begin: self.begin + self.direction * turns,
            direction: self.direction,
            turned: self.turned - turns,
            rate: if continues { self.gear.rate } else { 0.0 },
        }
    }

    /// Advances by `time` seconds, the last of the tick.
    pub fn advance(&mut self, tick: &SpindleTick<'_>, way: Way, time: f64) -> Spent {
        let law = tick.limits.gear_law();
        let spin = tick.rpm.abs() / 60.0;
        self.turns = spin > 0.0;
        let mut spent = Spent {
            waiting: 0.0,
            offered: time,
            used: 0.0,
        };
        if let Some(wait) = &mut self.wait {
            let Some(beginning) = wait.tick(tick.spindle, tick.rpm, tick.hold) else {
                return Spent {
                    waiting: time,
                    offered: 0.0,
                    used: 0.0,
                };
            };
            self.wait = None;
            self.begin = beginning.angle;
            self.direction = beginning.direction;
            self.gear.rate = law.lowest_rate(way.first_lead, spin);
            spent.offered = (beginning.part * TICK_S).min(time);
            spent.waiting = time - spent.offered;
        }
        let turned = self.direction * (tick.spindle.now - self.begin);
        let turns = turned - self.turned;
        let last = way.last_lead.map(|lead| law.lowest_rate(lead, spin));
        let end = GearEnd {
            total: way.turns,
            last: last.filter(|rate| *rate < 1.0),
        };
        spent.used = self.gear.advance(law, end, turns, spent.offered);
        self.turned += if spent.offered > 0.0 {
            turns * spent.used / spent.offered
        } else {
            turns
        };
        spent
    }
}
