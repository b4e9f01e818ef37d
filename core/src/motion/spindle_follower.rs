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

/// Number of turns by which the spindle may be past the start angle when a tick begins; beyond this
/// the thread starts one turn later.
const MISSED_TURNS: f64 = 0.01;

/// State that a finished thread passes to the thread that continues it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Handover {
    /// Spindle angle at which the next thread begins, turns.
    begin: f64,
    direction: f64,
    /// Number of spindle turns beyond that angle. `rate` is the rate of the electronic gear.
    #[serde(rename = "turned")]
    turns_beyond: f64,
    rate: f64,
}

impl Handover {
    /// Whether the axes have not stopped: the next thread continues at their speed.
    pub(crate) const fn is_moving(&self) -> bool {
        self.rate > 0.0
    }

    /// Records that the axes have stopped between the threads: only the angle is still
    /// valid.
    pub(crate) const fn stop(&mut self) {
        self.rate = 0.0;
    }
}

/// The event for which a thread or a tap waits before it begins to follow the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum FollowerWait {
    /// Waits for a one-turn signal after that at the angle `seen`, turns, and then for `phase`
    /// turns more. `seen` is `None` before the first tick.
    Index { seen: Option<f64>, phase: f64 },
    /// The next time that the spindle passes this angle, turns (or a whole number of turns
    /// more).
    Angle(f64),
    /// This angle, turns, with the spindle in this direction (1 or -1).
    Begin { angle: f64, direction: f64 },
}

impl FollowerWait {
    pub fn from_degrees(degrees: f64) -> Self {
        let phase = degrees / 360.0;
        Self::Index {
            seen: None,
            phase: phase - phase.floor(),
        }
    }

    /// Advances the wait by one tick. Returns the start if it is within the tick; otherwise `None`.
    /// `rpm` is the spindle speed, r/min. `hold` prevents a start.
    fn tick(&mut self, spindle: &SpindleTurn, rpm: f64, hold: bool) -> Option<FollowerStart> {
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
                let angle = next_angle(spindle.zero + direction * phase, spindle.index, direction);
                *self = Self::Begin { angle, direction };
            }
            Self::Angle(angle) => {
                let angle = next_angle(angle, spindle.now, direction);
                *self = Self::Begin { angle, direction };
            }
            // The spindle was reversed in the meantime.
            Self::Begin {
                angle,
                direction: wanted,
            } if wanted != direction => {
                let angle = next_angle(angle, spindle.now, direction);
                *self = Self::Begin { angle, direction };
            }
            Self::Index { .. } | Self::Begin { .. } => {}
        }
        let Self::Begin { angle, direction } = *self else {
            return None;
        };
        let since = direction * (spindle.now - angle);
        let step = direction * (spindle.now - spindle.before);
        if since > step + MISSED_TURNS {
            *self = Self::Angle(angle);
            return None;
        }
        (since > 0.0 && step > 0.0).then(|| FollowerStart {
            angle,
            direction,
            fraction: (since / step).min(1.0),
        })
    }
}

/// The first angle, turns, at or after `from` in `direction` (1 or -1) that equals `angle` plus
/// whole turns.
fn next_angle(angle: f64, from: f64, direction: f64) -> f64 {
    let turns = direction * (from - angle);
    // The signal itself is the start, regardless of rounding.
    angle + direction * (turns - 1e-6).ceil()
}

/// The start of a thread or tap within a tick.
#[derive(Clone, Copy, Debug)]
struct FollowerStart {
    pub angle: f64,
    pub direction: f64,
    /// Fraction of the tick that is left after the start.
    pub fraction: f64,
}

/// Inputs of a motion that follows the spindle, for one tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpindleTick<'a> {
    pub limits: &'a MotionLimits,
    pub spindle: &'a SpindleTurn,
    /// Measured spindle speed in the tick, r/min.
    pub rpm: f64,
    /// Whether no thread may begin to follow the spindle.
    pub is_held: bool,
    /// Whether another thread continues in phase after this motion.
    pub continues: bool,
}

/// Turns and leads of a thread or tap.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FollowerTravel {
    /// Number of spindle turns in the whole thread.
    pub turns: f64,
    /// Lead at the start of the thread, mm per turn.
    pub first_lead: f64,
    /// Lead at the end, mm per turn, if the gear slows down there; `None`: another thread
    /// continues.
    pub last_lead: Option<f64>,
}

/// The parts of the time by which a follower was advanced.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepTime {
    /// Part of the time before the start angle is reached, s.
    pub waiting_s: f64,
    /// Part of the time after the start angle, s. `used_s` is the part of it that was used; it is
    /// less only if the end was reached.
    pub available_s: f64,
    pub used_s: f64,
}

/// Follows the spindle angle through the electronic gear.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SpindleFollower {
    wait: Option<FollowerWait>,
    begin: f64,
    direction: f64,
    /// Number of spindle turns since the start angle.
    turned: f64,
    gear: Gear,
    /// Whether the spindle turned in the last tick, at any speed.
    #[serde(rename = "turns")]
    spindle_turns: bool,
}

impl SpindleFollower {
    /// Creates a follower that begins to follow the spindle when the event of `wait` has occurred.
    pub const fn waiting(wait: FollowerWait) -> Self {
        Self {
            wait: Some(wait),
            begin: 0.0,
            direction: 1.0,
            turned: 0.0,
            gear: Gear {
                rate: 0.0,
                done_turns: 0.0,
            },
            spindle_turns: false,
        }
    }

    /// Creates a follower that continues another motion from its end. If that motion
    /// stopped, the follower waits until the spindle passes the end angle again.
    pub(crate) const fn continuing(before: &Handover) -> Self {
        if before.rate <= 0.0 {
            return Self::waiting(FollowerWait::Angle(before.begin));
        }
        Self {
            wait: None,
            begin: before.begin,
            direction: before.direction,
            turned: before.turns_beyond,
            gear: Gear {
                rate: before.rate,
                done_turns: 0.0,
            },
            spindle_turns: true,
        }
    }

    /// Whether the follower has begun and the spindle turns. True also in ticks of a slow
    /// spindle without an encoder count.
    pub const fn is_moving(&self) -> bool {
        self.is_running() && self.spindle_turns
    }

    /// Whether the follower has begun to follow the spindle.
    pub const fn is_running(&self) -> bool {
        self.wait.is_none()
    }

    /// Number of thread turns made by the tool; negative if the spindle has turned back past the
    /// start.
    pub const fn turns_done(&self) -> f64 {
        self.gear.done_turns
    }

    /// Reverses: the other direction of the spindle moves the tool out over the same turns.
    pub(crate) fn reverse(&mut self) {
        self.begin += self.direction * self.turned;
        self.direction = -self.direction;
        self.turned = 0.0;
        self.gear = Gear {
            rate: 1.0,
            done_turns: 0.0,
        };
    }

    /// Returns the state for a motion that continues this one after its number `turns` of turns;
    /// `continues`: it does so without a stop.
    pub(crate) fn handover(&self, turns: f64, continues: bool) -> Handover {
        Handover {
            begin: self.begin + self.direction * turns,
            direction: self.direction,
            turns_beyond: self.turned - turns,
            rate: if continues { self.gear.rate } else { 0.0 },
        }
    }

    /// Advances by `time` seconds, the last part of the tick. Returns the part of the time that was
    /// used, s.
    pub fn advance(
        &mut self,
        tick: &SpindleTick<'_>,
        travel: FollowerTravel,
        time: f64,
    ) -> StepTime {
        let law = tick.limits.gear_law();
        let spin = tick.rpm.abs() / 60.0;
        self.spindle_turns = spin > 0.0;
        let mut step_time = StepTime {
            waiting_s: 0.0,
            available_s: time,
            used_s: 0.0,
        };
        if let Some(wait) = &mut self.wait {
            let Some(beginning) = wait.tick(tick.spindle, tick.rpm, tick.is_held) else {
                return StepTime {
                    waiting_s: time,
                    available_s: 0.0,
                    used_s: 0.0,
                };
            };
            self.wait = None;
            self.begin = beginning.angle;
            self.direction = beginning.direction;
            self.gear.rate = law.lowest_rate(travel.first_lead, spin);
            step_time.available_s = (beginning.fraction * TICK_S).min(time);
            step_time.waiting_s = time - step_time.available_s;
        }
        let turned = self.direction * (tick.spindle.now - self.begin);
        let turns = turned - self.turned;
        let last = travel.last_lead.map(|lead| law.lowest_rate(lead, spin));
        let end = GearEnd {
            total: travel.turns,
            last: last.filter(|rate| *rate < 1.0),
        };
        step_time.used_s = self.gear.advance(law, end, turns, step_time.available_s);
        self.turned += if step_time.available_s > 0.0 {
            turns * step_time.used_s / step_time.available_s
        } else {
            turns
        };
        step_time
    }
}
