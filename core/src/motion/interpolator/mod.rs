//! The interpolator: one position per tick from the motion under way.

mod tick;

use serde::{Deserialize, Serialize};

use crate::motion::external_cut::ExternalCut;
use crate::motion::external_tap::ExternalTap;
use crate::motion::lag::Lag;
use crate::motion::limits::MotionLimits;
use crate::motion::manual_axis::{JogRate, ManualAxis};
use crate::motion::path::CutPath;
use crate::motion::ramp::Ramp;
use crate::motion::rapid::Rapid;
use crate::motion::spindle_follower::Handover;
use crate::motion::straight_rapid::StraightRapid;
use crate::motion::tap::TapMotion;
use crate::motion::thread::{ThreadMotion, ThreadMove};
use crate::units::{Axis, Feed, PerAxis, Point, TICK_S, min_not_nan};

/// The programmed motion that is being executed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum ProgrammedMotion {
    None,
    Rapid(Rapid),
    StraightRapid(StraightRapid),
    Cut {
        path: CutPath,
        ramp: Ramp,
        feed: Feed,
    },
    /// A cut in which the commanded position runs ahead of the tool; `remaining` is the distance to
    /// go from the commanded position, mm.
    #[serde(rename = "Led")]
    LaggedCut {
        path: CutPath,
        #[serde(rename = "rest")]
        remaining: f64,
        feed: Feed,
    },
    Thread(ThreadMotion),
    Tap(TapMotion),
    /// A cut that a board makes; the control only follows its progress.
    #[serde(rename = "Driven")]
    ExternalCut(ExternalCut),
    /// A tap that a board makes; the control only follows its depth.
    ExternalTap(ExternalTap),
}

/// The interpolator: produces a position per tick. Machine coordinates in mm, X as a
/// radius. Its whole state can be saved.
///
/// A block that ends within a tick leaves the rest of that tick. Start the next block at
/// once and call `continue_tick` to use the rest in the same tick. If the next block starts
/// only before the next [`Interpolator::tick`], that tick makes up for it. No time is lost
/// either way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interpolator {
    position: Point,
    /// Position of the tool at the start of this tick, mm.
    tick_start: Point,
    motion: ProgrammedMotion,
    /// Lag of the tool after the commanded position while cuts continue into each other.
    lag: Lag,
    manual: PerAxis<ManualAxis>,
    /// Time that remains of the tick in which the last block ended, s.
    #[serde(rename = "carry")]
    leftover_s: f64,
    /// State that the last thread passes to a thread that continues it; `None` without one.
    handover: Option<Handover>,
    stopping: bool,
    #[serde(rename = "dry")]
    is_dry_run: bool,
    /// Whether the last tick was guided along a given path.
    #[serde(default, skip_serializing_if = "core::ops::Not::not")]
    is_guided: bool,
}

impl Interpolator {
    /// Creates an interpolator at rest at a machine position, mm.
    pub fn new(position: Point) -> Self {
        Self {
            position,
            tick_start: position,
            motion: ProgrammedMotion::None,
            lag: Lag::default(),
            manual: PerAxis::default(),
            leftover_s: 0.0,
            handover: None,
            stopping: false,
            is_dry_run: false,
            is_guided: false,
        }
    }

    /// Position of the tool after the last tick, mm.
    pub const fn position(&self) -> Point {
        self.position
    }

    /// Commanded position, mm. It is ahead of [`position`](Self::position) while cuts
    /// continue into each other.
    pub fn commanded(&self) -> Point {
        self.position + self.lag.vector
    }

    /// Mean velocity of the tool in the last tick, mm/s per axis.
    pub(crate) fn velocity(&self) -> Point {
        (self.position - self.tick_start) * (1.0 / TICK_S)
    }

    /// Time that the last block left unused in the tick in which it ended, s.
    pub(crate) const fn leftover_time(&self) -> f64 {
        self.leftover_s
    }

    /// Whether any axis has speed, in programmed or manual motion.
    pub fn is_moving(&self) -> bool {
        let programmed = match &self.motion {
            ProgrammedMotion::None => !self.lag.is_zero(),
            ProgrammedMotion::Rapid(rapid) => rapid.is_moving(),
            ProgrammedMotion::StraightRapid(rapid) => rapid.is_moving(),
            ProgrammedMotion::LaggedCut { .. } => {
                !self.lag.is_zero() || self.position != self.tick_start
            }
            ProgrammedMotion::Cut { ramp, .. } => ramp.speed > 0.0,
            ProgrammedMotion::Thread(thread) => thread.is_moving(),
            ProgrammedMotion::Tap(tap) => tap.is_moving(),
            ProgrammedMotion::ExternalCut(cut) => cut.is_moving(),
            ProgrammedMotion::ExternalTap(tap) => tap.is_moving(),
        };
        programmed || self.is_guided || self.manual.x.is_moving() || self.manual.z.is_moving()
    }

    /// Whether no programmed motion is being executed (manual motion does not count).
    pub const fn is_finished(&self) -> bool {
        matches!(self.motion, ProgrammedMotion::None)
    }

    /// Distance to go of the programmed motion, per axis, mm; negative towards minus.
    pub fn distance_to_go(&self) -> Point {
        match &self.motion {
            ProgrammedMotion::None => Point::default(),
            ProgrammedMotion::Rapid(rapid) => rapid.to() - self.position,
            ProgrammedMotion::StraightRapid(rapid) => rapid.to() - self.position,
            ProgrammedMotion::Cut { path, .. } | ProgrammedMotion::LaggedCut { path, .. } => {
                path.to() - self.position
            }
            ProgrammedMotion::Thread(thread) => thread.to() - self.position,
            ProgrammedMotion::Tap(tap) => tap.to() - self.position,
            ProgrammedMotion::ExternalCut(cut) => cut.to() - self.position,
            ProgrammedMotion::ExternalTap(tap) => tap.to() - self.position,
        }
    }

    /// Upper bound of the stopping distance of a cut from [`commanded`](Self::commanded), mm;
    /// `None` if no cut is in progress. It is cheaper to compute than the stopping point.
    pub(crate) fn max_stopping_distance(&self, limits: &MotionLimits) -> Option<f64> {
        // An arc with unequal radii is a little longer than its computed length.
        const UNEQUAL_ENDS: f64 = 0.1;
        match &self.motion {
            ProgrammedMotion::LaggedCut { .. } => Some(0.0),
            ProgrammedMotion::Cut { ramp, .. } => {
                let braking = limits.cutting_law().braking_distance(ramp.speed);
                Some(min_not_nan(braking, ramp.remaining) + UNEQUAL_ENDS)
            }
            _ => None,
        }
    }

    /// Position at which the axes stop if they brake now, mm.
    pub(crate) fn stopping_point(&self, limits: &MotionLimits) -> Point {
        match &self.motion {
            ProgrammedMotion::None => {
                let braking_distance = |axis| self.manual.get(axis).braking_distance(axis, limits);
                self.commanded() + Point::new(braking_distance(Axis::X), braking_distance(Axis::Z))
            }
            ProgrammedMotion::LaggedCut { .. } => self.commanded(),
            ProgrammedMotion::ExternalCut(cut) => cut.to(),
            ProgrammedMotion::Rapid(rapid) => rapid.stopping_point(limits),
            ProgrammedMotion::StraightRapid(rapid) => rapid.stopping_point(limits),
            ProgrammedMotion::Cut { path, ramp, .. } => {
                path.point_at(ramp.remaining - limits.cutting_law().braking_distance(ramp.speed))
            }
            ProgrammedMotion::Thread(_)
            | ProgrammedMotion::Tap(_)
            | ProgrammedMotion::ExternalTap(_) => {
                let velocity = self.velocity();
                let speed = velocity.length();
                if speed <= 0.0 {
                    return self.position;
                }
                let distance = limits.cutting_law().braking_distance(speed);
                self.position + velocity * (distance / speed)
            }
        }
    }

    /// Starts a rapid to the point `to`, mm.
    pub(crate) fn start_rapid(&mut self, to: Point, limits: &MotionLimits) {
        self.begin_motion(match limits.rapids_are_straight() {
            true => ProgrammedMotion::StraightRapid(StraightRapid::new(self.position, to)),
            false => ProgrammedMotion::Rapid(Rapid::new(self.position, to)),
        });
    }

    /// Starts a straight cut to the point `to`, mm.
    pub(crate) fn start_line(&mut self, to: Point, feed: Feed) {
        self.start_cut(CutPath::line(self.commanded(), to), feed);
    }

    /// Starts a circular cut to `to` about `center`, mm; clockwise is as seen with +Z to the right
    /// and +X up. The cut is a full circle if its end is its start.
    pub(crate) fn start_arc(&mut self, to: Point, center: Point, clockwise: bool, feed: Feed) {
        self.start_cut(CutPath::arc(self.commanded(), to, center, clockwise), feed);
    }

    /// Starts a thread, which waits for its spindle angle or continues the thread before.
    pub(crate) fn start_thread(&mut self, thread: &ThreadMove, limits: &MotionLimits) {
        let before = self.handover.take();
        let thread = ThreadMotion::new(self.position, thread, before, limits);
        self.begin_motion(ProgrammedMotion::Thread(thread));
    }

    /// Whether a thread is being executed that follows the spindle.
    pub(crate) const fn is_in_thread(&self) -> bool {
        matches!(&self.motion, ProgrammedMotion::Thread(thread) if thread.is_running())
    }

    /// Whether a thread has ended and another is to continue it without a stop.
    pub(crate) fn is_between_threads(&self) -> bool {
        self.is_finished() && self.handover.is_some_and(|handover| handover.is_moving())
    }

    /// Whether a programmed motion brakes because it was stopped.
    pub(crate) const fn is_braking(&self) -> bool {
        self.stopping && !self.is_finished()
    }

    /// Whether a thread waits for its spindle angle.
    pub(crate) const fn is_waiting_for_spindle(&self) -> bool {
        matches!(&self.motion, ProgrammedMotion::Thread(thread) if !thread.is_running())
    }

    /// Starts a straight cut to `to`, mm, that the board makes. It waits for
    /// [`begin_external_cut`](Self::begin_external_cut).
    pub(crate) fn start_external_cut(&mut self, to: Point) {
        self.begin_motion(ProgrammedMotion::ExternalCut(ExternalCut::new(
            self.position,
            to,
        )));
    }

    /// End point, mm, of a cut that the board has not started yet; `None` without such a cut.
    pub(crate) const fn pending_external_cut(&self) -> Option<Point> {
        match &self.motion {
            ProgrammedMotion::ExternalCut(cut) if !cut.is_begun() => Some(cut.to()),
            _ => None,
        }
    }

    /// Records that the board has started the cut: from now on only the board can end it.
    pub(crate) const fn begin_external_cut(&mut self) {
        if let ProgrammedMotion::ExternalCut(cut) = &mut self.motion {
            cut.begin();
        }
    }

    /// Sets the fraction of the cut that the board has made, 0–1.
    pub(crate) fn report_external_progress(&mut self, fraction: f64) {
        if let ProgrammedMotion::ExternalCut(cut) = &mut self.motion {
            cut.report_progress(fraction);
        }
    }

    /// Ends the cut that the board makes, at its end point. Returns false if there is no such cut.
    pub(crate) fn end_external_cut(&mut self) -> bool {
        let ProgrammedMotion::ExternalCut(cut) = &self.motion else {
            return false;
        };
        let to = cut.to();
        self.motion = ProgrammedMotion::None;
        self.position = to;
        self.tick_start = to;
        true
    }

    /// Starts tapping: the tool moves inwards in phase with the spindle until
    /// [`reverse_tap`](Self::reverse_tap). `to` is its bottom, mm, `lead` in mm per turn, `degrees`
    /// the spindle angle after the one-turn signal at which it starts.
    pub(crate) fn start_tap(&mut self, to: Point, lead: f64, degrees: f64) {
        let tap = TapMotion::new(self.position, to, lead, degrees);
        self.begin_motion(ProgrammedMotion::Tap(tap));
    }

    /// Starts a tap that the board makes; see [`start_tap`](Self::start_tap). It waits for
    /// [`begin_external_tap`](Self::begin_external_tap).
    pub(crate) fn start_external_tap(&mut self, to: Point, lead: f64, degrees: f64) {
        let tap = ExternalTap::new(self.position, to, lead, degrees);
        self.begin_motion(ProgrammedMotion::ExternalTap(tap));
    }

    /// A tap that the board has not started yet; `None` without one.
    pub(crate) const fn pending_external_tap(&self) -> Option<&ExternalTap> {
        match &self.motion {
            ProgrammedMotion::ExternalTap(tap) if !tap.is_begun() => Some(tap),
            _ => None,
        }
    }

    /// Records that the board has started the tap: from now on only the board can end it.
    pub(crate) const fn begin_external_tap(&mut self) {
        if let ProgrammedMotion::ExternalTap(tap) = &mut self.motion {
            tap.begin();
        }
    }

    /// Whether a tap that the board has started is followed, and not to be stopped.
    pub(crate) const fn follows_external_tap(&self) -> bool {
        matches!(&self.motion, ProgrammedMotion::ExternalTap(tap) if tap.is_begun())
            && !self.stopping
    }

    /// Sets the depth of the tap that the board has reported, mm.
    pub(crate) fn report_tap_depth(&mut self, depth_mm: f64) {
        if let ProgrammedMotion::ExternalTap(tap) = &mut self.motion {
            tap.report_depth(depth_mm);
        }
    }

    /// Ends the tap that the board makes, at its start, and returns it; `None` without one.
    pub(crate) fn end_external_tap(&mut self) -> Option<ExternalTap> {
        let ProgrammedMotion::ExternalTap(tap) = self.motion else {
            return None;
        };
        self.motion = ProgrammedMotion::None;
        self.position = tap.from();
        self.tick_start = tap.from();
        Some(tap)
    }

    /// Whether a tap has reached its depth. Even then it follows the spindle.
    pub(crate) fn is_tap_at_bottom(&self) -> bool {
        match &self.motion {
            ProgrammedMotion::Tap(tap) => tap.is_at_bottom(),
            ProgrammedMotion::ExternalTap(tap) => tap.is_at_bottom(),
            _ => false,
        }
    }

    /// Reverses the tap: the tool follows the reversed spindle out to its start and stops
    /// there.
    pub(crate) fn reverse_tap(&mut self) {
        match &mut self.motion {
            ProgrammedMotion::Tap(tap) => tap.reverse(),
            ProgrammedMotion::ExternalTap(tap) => tap.reverse(),
            _ => {}
        }
    }

    /// Starts a cut along `path`, which begins at the commanded position. The first tick of the cut
    /// decides which speed law applies.
    fn start_cut(&mut self, path: CutPath, feed: Feed) {
        let lag = self.lag;
        self.begin_motion(ProgrammedMotion::Cut {
            path,
            ramp: Ramp::new(path.length()),
            feed,
        });
        self.lag = lag;
    }

    fn begin_motion(&mut self, motion: ProgrammedMotion) {
        self.motion = motion;
        self.lag = Lag::default();
        self.manual = PerAxis::default();
        self.stopping = false;
        self.handover = None;
    }

    /// Starts the jog of an axis in a direction (true = positive) at a rate; `None` stops it. The
    /// jog acts while no programmed motion is in progress. Call it on changes only.
    pub(crate) const fn set_jog(&mut self, axis: Axis, command: Option<(bool, JogRate)>) {
        self.manual.get_mut(axis).request_jog(command);
    }

    /// Starts a motion of an axis by `distance`, mm (one step, or the graduations of the
    /// handwheel). Further steps add to the distance to go.
    pub(crate) fn start_step(&mut self, axis: Axis, distance: f64, rate: JogRate) {
        let position = self.position.get(axis);
        self.manual.get_mut(axis).step(position, distance, rate);
    }

    /// Starts a manual motion of an axis to a machine coordinate, mm, at a given rate.
    pub const fn go_to(&mut self, axis: Axis, coordinate: f64, rate: JogRate) {
        self.manual.get_mut(axis).go_to(coordinate, rate);
    }

    /// Changes the rate of the current step of an axis; without a step it does nothing.
    pub(crate) const fn set_step_rate(&mut self, axis: Axis, rate: JogRate) {
        self.manual.get_mut(axis).set_rate(rate);
    }

    /// Distance to go of the current step of an axis, mm, negative towards minus; `None` without a
    /// step.
    pub(crate) fn step_distance_to_go(&self, axis: Axis) -> Option<f64> {
        let goal = self.manual.get(axis).goal()?;
        Some(goal - self.position.get(axis))
    }

    /// Speed of an axis in manual motion, mm/min.
    pub(crate) const fn manual_speed(&self, axis: Axis) -> f64 {
        self.manual.get(axis).speed() * 60.0
    }

    /// Drops the manual command of an axis, which then decelerates.
    pub const fn release_axis(&mut self, axis: Axis) {
        self.manual.get_mut(axis).release();
    }

    /// Stops an axis in manual motion at a machine coordinate (mm) that it has reached or
    /// just passed.
    pub(crate) fn stop_at(&mut self, axis: Axis, coordinate: f64) {
        *self.manual.get_mut(axis) = ManualAxis::default();
        *self.position.get_mut(axis) = coordinate;
    }

    /// Whether an axis moves to the target of a step, of the handwheel or of `go_to`.
    pub const fn is_stepping(&self, axis: Axis) -> bool {
        self.manual.get(axis).is_stepping()
    }

    /// Decelerates the axes by their laws and drops the rest of the motion.
    pub(crate) const fn decelerate(&mut self) {
        self.stopping = true;
        self.manual.x.release();
        self.manual.z.release();
    }

    /// Stops all motion at once, without deceleration (emergency stop).
    pub(crate) fn stop_now(&mut self) {
        *self = Self::new(self.position);
    }

    /// Drops the current motion; its axes must be at standstill.
    pub fn cancel(&mut self) {
        self.stop_now();
    }

    /// Shifts position, end points and centre of the motion by a vector, mm.
    pub(crate) fn translate(&mut self, by: Point) {
        self.position = self.position + by;
        self.tick_start = self.tick_start + by;
        self.manual.x.translate(by.x);
        self.manual.z.translate(by.z);
        self.motion = match self.motion {
            ProgrammedMotion::None => ProgrammedMotion::None,
            ProgrammedMotion::Rapid(rapid) => ProgrammedMotion::Rapid(rapid.shifted(by)),
            ProgrammedMotion::StraightRapid(rapid) => {
                ProgrammedMotion::StraightRapid(rapid.shifted(by))
            }
            ProgrammedMotion::Cut { path, ramp, feed } => ProgrammedMotion::Cut {
                path: path.shifted(by),
                ramp,
                feed,
            },
            ProgrammedMotion::LaggedCut {
                path,
                remaining: rest,
                feed,
            } => ProgrammedMotion::LaggedCut {
                path: path.shifted(by),
                remaining: rest,
                feed,
            },
            ProgrammedMotion::Thread(thread) => ProgrammedMotion::Thread(thread.shifted(by)),
            ProgrammedMotion::Tap(tap) => ProgrammedMotion::Tap(tap.shifted(by)),
            ProgrammedMotion::ExternalCut(cut) => ProgrammedMotion::ExternalCut(cut.shifted(by)),
            ProgrammedMotion::ExternalTap(tap) => ProgrammedMotion::ExternalTap(tap.shifted(by)),
        };
    }
}
