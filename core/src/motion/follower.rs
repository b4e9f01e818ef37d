//! What threads and taps share: they wait for an angle of the spindle and follow it
//! through the gear from there, finer than a tick.
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

/// A beginning so far before the tick was missed: the next one counts, turns.
const MISSED: f64 = 0.01;

/// What a thread leaves to the one that goes on from it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Handover {
    /// Angle at which the next thread begins.
    begin: f64,
    direction: f64,
    /// Turns of the spindle beyond that angle already, and rate of the gear.
    turned: f64,
    rate: f64,
}

impl Handover {
    /// The axes came to a stop in between: only the angle counts.
    pub(crate) const fn stand_still(&mut self) {
        self.rate = 0.0;
    }
}

/// What a thread or a tap waits for before it begins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Wait {
    /// For the one-turn signal after the one at `seen`, then `phase` turns more.
    Index { seen: Option<f64>, phase: f64 },
    /// For the next time that this angle comes by.
    Angle(f64),
    /// For this angle, in this direction.
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

    /// One tick of waiting. At the beginning: its angle, the direction, and the part
    /// of the tick since then.
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

/// The first angle equal to `angle` in whole turns that comes at or after `from`.
fn next(angle: f64, from: f64, direction: f64) -> f64 {
    let turns = direction * (from - angle);
    // The signal itself is the beginning, whatever the last bits say.
    angle + direction * (turns - 1e-6).ceil()
}

/// A thread begins within a tick.
#[derive(Clone, Copy, Debug)]
struct Beginning {
    pub angle: f64,
    pub direction: f64,
    /// Part of the tick since the beginning.
    pub part: f64,
}

/// What motion tied to the spindle depends on in a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpindleTick<'a> {
    pub limits: &'a MotionLimits,
    pub spindle: &'a SpindleTurn,
    /// Measured speed, r/min.
    pub rpm: f64,
    /// Nothing begins.
    pub hold: bool,
    /// A thread that goes on in phase follows.
    pub continues: bool,
}

/// Where a follower ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    /// Turns in all.
    pub turns: f64,
    /// Lead at the beginning, mm per turn.
    pub first_lead: f64,
    /// Lead at the end if the gear comes down for it; `None`: it goes on.
    pub last_lead: Option<f64>,
}

/// How the time of a step was spent, s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spent {
    /// Before the beginning.
    pub waiting: f64,
    /// Since the beginning, offered and used: less only at the end.
    pub offered: f64,
    pub used: f64,
}

/// Follows the spindle through the gear.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Follower {
    wait: Option<Wait>,
    begin: f64,
    direction: f64,
    /// Turns of the spindle since the beginning.
    turned: f64,
    gear: Gear,
    /// The spindle turns, however slowly.
    turns: bool,
}

impl Follower {
    /// Begins after this.
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

    /// Goes on where another one ended; if that came to a stop, at its angle when
    /// it next comes by.
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

    /// Whether it has begun and the spindle turns: a slow one has ticks without a
    /// count.
    pub const fn is_moving(&self) -> bool {
        self.running() && self.turns
    }

    /// Whether it has begun.
    pub const fn running(&self) -> bool {
        self.wait.is_none()
    }

    /// Turns made by the tool; below zero when the spindle has turned back before
    /// the beginning.
    pub const fn done(&self) -> f64 {
        self.gear.done
    }

    /// The way made counts back: the other direction of the spindle leads out.
    pub(crate) fn turn_back(&mut self) {
        self.begin += self.direction * self.turned;
        self.direction = -self.direction;
        self.turned = 0.0;
        self.gear = Gear {
            rate: 1.0,
            done: 0.0,
        };
    }

    /// What goes to a follower that continues this one after `turns`.
    pub(crate) fn handover(&self, turns: f64, continues: bool) -> Handover {
        Handover {
            begin: self.begin + self.direction * turns,
            direction: self.direction,
            turned: self.turned - turns,
            rate: if continues { self.gear.rate } else { 0.0 },
        }
    }

    /// Goes on for `time` seconds, the last of the tick.
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
