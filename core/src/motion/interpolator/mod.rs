//! The interpolator: one position per tick from the motion under way.

mod tick;

use serde::{Deserialize, Serialize};

use crate::motion::driven::Driven;
use crate::motion::follower::Handover;
use crate::motion::jog::{JogRate, ManualAxis};
use crate::motion::lag::Lag;
use crate::motion::limits::MotionLimits;
use crate::motion::path::Path;
use crate::motion::ramp::Ramp;
use crate::motion::rapid::Rapid;
use crate::motion::straight_rapid::StraightRapid;
use crate::motion::tap::Tap;
use crate::motion::thread::{Thread, ThreadMove};
use crate::units::{Axis, Feed, PerAxis, Point, TICK_S, min_not_nan};

/// Programmed motion under way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Motion {
    None,
    Rapid(Rapid),
    StraightRapid(StraightRapid),
    Cut {
        path: Path,
        ramp: Ramp,
        feed: Feed,
    },
    /// A cut whose command runs ahead of the tool, with its distance to go.
    #[serde(rename = "Led")]
    Led {
        path: Path,
        #[serde(rename = "rest")]
        rest: f64,
        feed: Feed,
    },
    Thread(Thread),
    Tap(Tap),
    /// A cut that the drives make on their own.
    #[serde(rename = "Driven")]
    Driven(Driven),
}

/// The interpolator: produces a position per tick. Machine coordinates, X in radius; plain
/// data.
///
/// A block that ends within a tick leaves the rest of that tick. Start the next block at
/// once and call `continue_tick` to use the rest in the same tick. If the next block starts
/// only before the next [`Interpolator::tick`], that tick makes up for it. No time is lost
/// either way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interpolator {
    position: Point,
    /// Position at the start of this tick.
    tick_start: Point,
    motion: Motion,
    /// Distance from the tool to the command while cuts continue into each other.
    lag: Lag,
    manual: PerAxis<ManualAxis>,
    /// Time left of the tick in which the last block ended, s.
    #[serde(rename = "carry")]
    carry: f64,
    /// State that the last motion passes to a thread that continues it.
    handover: Option<Handover>,
    stopping: bool,
    #[serde(rename = "dry")]
    dry: bool,
}

impl Interpolator {
    /// An interpolator at rest.
    pub fn new(position: Point) -> Self {
        Self {
            position,
            tick_start: position,
            motion: Motion::None,
            lag: Lag::default(),
            manual: PerAxis::default(),
            carry: 0.0,
            handover: None,
            stopping: false,
            dry: false,
        }
    }

    /// Position after the last tick.
    pub const fn position(&self) -> Point {
        self.position
    }

    /// Commanded position: ahead of [`position`](Self::position) while cuts continue into
    /// each other.
    pub fn commanded(&self) -> Point {
        self.position + self.lag.behind
    }

    /// Mean velocity of the last tick, mm/s.
    pub(crate) fn velocity(&self) -> Point {
        (self.position - self.tick_start) * (1.0 / TICK_S)
    }

    /// Time that the last block left of the tick in which it ended, s.
    pub(crate) const fn time_left(&self) -> f64 {
        self.carry
    }

    /// Whether any axis has speed.
    pub fn is_moving(&self) -> bool {
        let programmed = match &self.motion {
            Motion::None => !self.lag.is_none(),
            Motion::Rapid(rapid) => rapid.is_moving(),
            Motion::StraightRapid(rapid) => rapid.is_moving(),
            Motion::Led { .. } => !self.lag.is_none() || self.position != self.tick_start,
            Motion::Cut { ramp, .. } => ramp.speed > 0.0,
            Motion::Thread(thread) => thread.is_moving(),
            Motion::Tap(tap) => tap.is_moving(),
            Motion::Driven(cut) => cut.is_moving(),
        };
        programmed || self.manual.x.is_moving() || self.manual.z.is_moving()
    }

    /// Whether no programmed motion is under way (manual motion does not count).
    pub const fn finished(&self) -> bool {
        matches!(self.motion, Motion::None)
    }

    /// Distance to go of the programmed motion, per axis.
    pub fn distance_to_go(&self) -> Point {
        match &self.motion {
            Motion::None => Point::default(),
            Motion::Rapid(rapid) => rapid.to() - self.position,
            Motion::StraightRapid(rapid) => rapid.to() - self.position,
            Motion::Cut { path, .. } | Motion::Led { path, .. } => path.to() - self.position,
            Motion::Thread(thread) => thread.to() - self.position,
            Motion::Tap(tap) => tap.to() - self.position,
            Motion::Driven(cut) => cut.to() - self.position,
        }
    }

    /// Upper bound of a cut's stopping distance from [`commanded`](Self::commanded), mm,
    /// which is cheaper to compute than its stopping point. `None` for other motion.
    pub(crate) fn stops_within(&self, limits: &MotionLimits) -> Option<f64> {
        // An arc with unequal radii is a little longer than its computed length.
        const UNEQUAL_ENDS: f64 = 0.1;
        match &self.motion {
            Motion::Led { .. } => Some(0.0),
            Motion::Cut { ramp, .. } => {
                let braking = limits.cutting_law().braking_distance(ramp.speed);
                Some(min_not_nan(braking, ramp.remaining) + UNEQUAL_ENDS)
            }
            _ => None,
        }
    }

    /// Position at which the axes stop if they brake now.
    pub(crate) fn stopping_point(&self, limits: &MotionLimits) -> Point {
        match &self.motion {
            Motion::None => {
                let way = |axis| self.manual.get(axis).braking_distance(axis, limits);
                self.commanded() + Point::new(way(Axis::X), way(Axis::Z))
            }
            Motion::Led { .. } => self.commanded(),
            Motion::Driven(cut) => cut.to(),
            Motion::Rapid(rapid) => rapid.stopping_point(limits),
            Motion::StraightRapid(rapid) => rapid.stopping_point(limits),
            Motion::Cut { path, ramp, .. } => {
                path.at(ramp.remaining - limits.cutting_law().braking_distance(ramp.speed))
            }
            Motion::Thread(_) | Motion::Tap(_) => {
                let velocity = self.velocity();
                let speed = velocity.length();
                if speed <= 0.0 {
                    return self.position;
                }
                let way = limits.cutting_law().braking_distance(speed);
                self.position + velocity * (way / speed)
            }
        }
    }

    /// Starts a rapid.
    pub(crate) fn start_rapid(&mut self, to: Point, limits: &MotionLimits) {
        self.begin(match limits.rapids_are_straight() {
            true => Motion::StraightRapid(StraightRapid::new(self.position, to)),
            false => Motion::Rapid(Rapid::new(self.position, to)),
        });
    }

    /// Starts a straight cut.
    pub(crate) fn start_line(&mut self, to: Point, feed: Feed) {
        self.start_cut(Path::line(self.commanded(), to), feed);
    }

    /// Starts a circular cut, clockwise as seen with +Z to the right and +X up. It is a
    /// full circle when it ends at its start.
    pub(crate) fn start_arc(&mut self, to: Point, center: Point, clockwise: bool, feed: Feed) {
        self.start_cut(Path::arc(self.commanded(), to, center, clockwise), feed);
    }

    /// Starts a thread. It waits for its spindle angle, or continues the thread before.
    pub(crate) fn start_thread(&mut self, thread: &ThreadMove, limits: &MotionLimits) {
        let before = self.handover.take();
        let thread = Thread::new(self.position, thread, before, limits);
        self.begin(Motion::Thread(thread));
    }

    /// Whether a thread is under way that follows the spindle.
    pub(crate) const fn in_thread(&self) -> bool {
        matches!(&self.motion, Motion::Thread(thread) if thread.running())
    }

    /// Whether a thread waits for its spindle angle.
    pub(crate) const fn waits_for_spindle(&self) -> bool {
        matches!(&self.motion, Motion::Thread(thread) if !thread.running())
    }

    /// Starts a straight cut that the drives make on their own after
    /// [`begin_driven`](Self::begin_driven).
    pub(crate) fn start_driven(&mut self, to: Point) {
        self.begin(Motion::Driven(Driven::new(self.position, to)));
    }

    /// End point of a cut that waits for the drives; `None` if none waits.
    pub(crate) const fn waits_for_drives(&self) -> Option<Point> {
        match &self.motion {
            Motion::Driven(cut) if !cut.is_begun() => Some(cut.to()),
            _ => None,
        }
    }

    /// Notes that the drives make the cut: from now on only they end it.
    pub(crate) const fn begin_driven(&mut self) {
        if let Motion::Driven(cut) = &mut self.motion {
            cut.begin();
        }
    }

    /// Takes the fraction of the cut that the drives have made.
    pub(crate) fn driven_progress(&mut self, share: f64) {
        if let Motion::Driven(cut) = &mut self.motion {
            cut.tell(share);
        }
    }

    /// Ends the cut at its end point; false if there is none.
    pub(crate) fn end_driven(&mut self) -> bool {
        let Motion::Driven(cut) = &self.motion else {
            return false;
        };
        let to = cut.to();
        self.motion = Motion::None;
        self.position = to;
        self.tick_start = to;
        true
    }

    /// Starts tapping: in phase inwards until [`Interpolator::turn_back`].
    pub(crate) fn start_tap(&mut self, to: Point, lead: f64, degrees: f64) {
        let tap = Tap::new(self.position, to, lead, degrees);
        self.begin(Motion::Tap(tap));
    }

    /// Whether a tap has reached its depth. It continues to follow the spindle.
    pub(crate) fn tap_at_bottom(&self) -> bool {
        matches!(&self.motion, Motion::Tap(tap) if tap.at_bottom())
    }

    /// Reverses the tap: it follows the reversed spindle out to its start and ends there.
    pub(crate) fn turn_back(&mut self) {
        if let Motion::Tap(tap) = &mut self.motion {
            tap.turn_back();
        }
    }

    /// Starts a cut from the command of the previous one. Its first tick decides which law
    /// applies.
    fn start_cut(&mut self, path: Path, feed: Feed) {
        let lag = self.lag;
        self.begin(Motion::Cut {
            path,
            ramp: Ramp::new(path.length()),
            feed,
        });
        self.lag = lag;
    }

    fn begin(&mut self, motion: Motion) {
        self.motion = motion;
        self.lag = Lag::default();
        self.manual = PerAxis::default();
        self.stopping = false;
        self.handover = None;
    }

    /// Sets the jog of an axis (true = positive), or stops it. It acts while no programmed
    /// motion is under way. Call it on changes only.
    pub(crate) const fn set_jog(&mut self, axis: Axis, command: Option<(bool, JogRate)>) {
        self.manual.get_mut(axis).set(command);
    }

    /// Moves an axis by `distance` mm (a step, or one detent of the handwheel). Further
    /// steps add to the distance to go.
    pub(crate) fn start_step(&mut self, axis: Axis, distance: f64, rate: JogRate) {
        let position = self.position.get(axis);
        self.manual.get_mut(axis).step(position, distance, rate);
    }

    /// Moves an axis to a coordinate at a given rate.
    pub const fn go_to(&mut self, axis: Axis, coordinate: f64, rate: JogRate) {
        self.manual.get_mut(axis).go_to(coordinate, rate);
    }

    /// Changes the rate of the step under way.
    pub(crate) const fn set_step_rate(&mut self, axis: Axis, rate: JogRate) {
        self.manual.get_mut(axis).set_rate(rate);
    }

    /// Distance to go of a step, mm; `None` if no step is under way.
    pub(crate) fn step_rest(&self, axis: Axis) -> Option<f64> {
        let goal = self.manual.get(axis).goal()?;
        Some(goal - self.position.get(axis))
    }

    /// Speed of an axis in manual motion, mm/min.
    pub(crate) const fn manual_speed(&self, axis: Axis) -> f64 {
        self.manual.get(axis).speed() * 60.0
    }

    /// Drops the manual command of an axis, which then decelerates.
    pub const fn release(&mut self, axis: Axis) {
        self.manual.get_mut(axis).release();
    }

    /// Stops an axis in manual motion at a coordinate that it has reached or just passed.
    pub(crate) fn stop_on(&mut self, axis: Axis, coordinate: f64) {
        *self.manual.get_mut(axis) = ManualAxis::default();
        *self.position.get_mut(axis) = coordinate;
    }

    /// Whether a step of an axis is under way.
    pub const fn stepping(&self, axis: Axis) -> bool {
        self.manual.get(axis).stepping()
    }

    /// Decelerates the axes by their laws and drops the rest of the motion.
    pub(crate) const fn decelerate(&mut self) {
        self.stopping = true;
        self.manual.x.release();
        self.manual.z.release();
    }

    /// Stops at once (emergency stop).
    pub(crate) fn stop_now(&mut self) {
        *self = Self::new(self.position);
    }

    /// Drops a motion that stands still.
    pub fn cancel(&mut self) {
        self.stop_now();
    }

    /// Shifts the whole motion: position, end points and centre.
    pub(crate) fn translate(&mut self, by: Point) {
        self.position = self.position + by;
        self.tick_start = self.tick_start + by;
        self.manual.x.translate(by.x);
        self.manual.z.translate(by.z);
        self.motion = match self.motion {
            Motion::None => Motion::None,
            Motion::Rapid(rapid) => Motion::Rapid(rapid.translated(by)),
            Motion::StraightRapid(rapid) => Motion::StraightRapid(rapid.translated(by)),
            Motion::Cut { path, ramp, feed } => Motion::Cut {
                path: path.translated(by),
                ramp,
                feed,
            },
            Motion::Led { path, rest, feed } => Motion::Led {
                path: path.translated(by),
                rest,
                feed,
            },
            Motion::Thread(thread) => Motion::Thread(thread.translated(by)),
            Motion::Tap(tap) => Motion::Tap(tap.translated(by)),
            Motion::Driven(cut) => Motion::Driven(cut.translated(by)),
        };
    }
}
