//! What a program does with each of its tools.

use std::collections::BTreeMap;

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::units::{Feed, Point};
use gsk_workpiece::job::Job;
use gsk_workpiece::motion::{MotionKind, ToolMotion};
use gsk_workpiece::stock::Stock;

use super::super::track::Track;
use crate::curves::RapidRates;

/// A length that is nothing, mm.
const NOTHING: f64 = 1e-6;
/// So near to the spindle axis a tool drills, mm of radius.
const ON_AXIS: f64 = 0.01;
/// Feeds along Z that are no longer are chamfers and runs into a cut, mm.
const SHORT: f64 = 3.0;
/// A cut across that lies no deeper faces the part, mm.
const FACE: f64 = 1.0;
/// Material above a ring into which a tool plunges from the front: more is not turned
/// off in one pass, mm of radius.
const RING: f64 = 4.0;

/// A motion of the first ones of a program, and its tool.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) tool: u8,
    pub(super) motion: ToolMotion,
    pub(super) threads: bool,
}

impl Step {
    pub(super) const fn is_cut(&self) -> bool {
        !matches!(self.motion.kind, MotionKind::Rapid)
    }

    fn way(&self) -> Point {
        self.motion.to - self.motion.from
    }
}

/// What a tool seems to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Work {
    /// Turning, facing, boring.
    Turn,
    /// Grooves from outside or from inside.
    Groove,
    /// Grooves into a face.
    FaceGroove,
    /// Threads.
    Thread,
    /// Drills and taps.
    Drill,
}

/// What a program does with a tool.
#[derive(Clone, Debug, Default)]
pub(super) struct Use {
    /// Number of the offset.
    pub(super) offset: u8,
    /// Beyond the spindle axis: its X is negative.
    pub(super) beyond: bool,
    threads: u32,
    /// The greatest lead of them, mm.
    pub(super) lead: f64,
    /// Feeds along the spindle axis.
    along: u32,
    /// The longest of them along Z, mm.
    longest: f64,
    /// Feeds across the spindle axis.
    across: u32,
    /// Feeds on the spindle axis.
    pub(super) drills: u32,
    /// Feeds into a groove: straight back comes next; of the rest, something else.
    grooves: [u32; 2],
    rings: [u32; 2],
    /// Feeds into a ring that were broken to let go of the chip, or that dwelt at its
    /// bottom.
    pecks: u32,
    /// How often it leaves a cut towards the axis and away from it.
    leaves: [u32; 2],
    /// How often it leaves a cut across towards the chuck and away from it.
    leaves_along: [u32; 2],
    /// The steepest way back into the part, degrees.
    pub(super) steepest: f64,
    /// Nearest to the axis within the part, mm of radius.
    pub(super) nearest: Option<f64>,
    /// The same where it cuts.
    pub(super) nearest_cut: f64,
    /// Farthest from the axis where it cuts, and where it cuts along, mm of radius.
    pub(super) farthest_cut: f64,
    pub(super) widest: f64,
    /// Least and greatest Z of its cuts.
    pub(super) deepest: f64,
    pub(super) first: f64,
    /// Where its cuts into grooves begin: Z, or X of grooves in a face.
    positions: Vec<f64>,
    /// Radii of its threads.
    pub(super) crests: Option<(f64, f64)>,
    pub(super) work: Option<Work>,
}

/// The motions of moves.
pub(super) fn steps(moves: &[ExecutedMove], rates: RapidRates) -> Vec<Step> {
    let mut track = Track::of(&Job::new(Stock::bar(50.0, 0.0, 60.0)));
    let step = |executed: &ExecutedMove| {
        let threads = executed.kind.is_thread();
        let tool = executed.conditions.tool;
        let motions = track.motions(executed, rates);
        motions.into_iter().map(move |motion| Step {
            tool,
            motion,
            threads,
        })
    };
    moves.iter().flat_map(step).collect()
}

/// The uses of tools that cut.
pub(super) fn uses(moves: &[ExecutedMove], steps: &[Step], front: f64) -> BTreeMap<u8, Use> {
    let mut uses = BTreeMap::<u8, Use>::new();
    let mut before: Option<&ExecutedMove> = None;
    for executed in moves {
        let used = uses.entry(executed.conditions.tool).or_default();
        if executed.kind == MoveKind::Dwell && before.is_some_and(is_along_inwards) {
            // A ring is cut round before the tool goes back.
            used.pecks += 1;
        }
        before = Some(executed);
        if executed.conditions.offset != 0 {
            used.offset = executed.conditions.offset;
        }
        if let (MoveKind::Thread, Some(Feed::PerRevolution(lead))) = (executed.kind, executed.feed)
        {
            used.lead = used.lead.max(lead);
        }
    }
    let numbers: Vec<u8> = uses.keys().copied().collect();
    for number in numbers {
        let own: Vec<&Step> = steps.iter().filter(|step| step.tool == number).collect();
        if let Some(used) = uses.get_mut(&number) {
            used.take(&own, front);
        }
    }
    uses.retain(|_, used| used.cuts());
    let outermost = uses
        .values()
        .map(|used| used.farthest_cut)
        .fold(0.0, f64::max);
    let drilled = uses.values().any(Use::is_drill);
    for used in uses.values_mut() {
        used.work = Some(used.judge(front, outermost, drilled));
    }
    uses
}

/// Whether a move cuts straight towards the chuck, beside the axis.
fn is_along_inwards(executed: &ExecutedMove) -> bool {
    let (from, to) = (executed.from, executed.to);
    executed.kind == MoveKind::Feed && from.x == to.x && to.z < from.z && to.x.abs() > ON_AXIS
}

impl Use {
    fn cuts(&self) -> bool {
        self.threads > 0 || self.along > 0 || self.across > 0 || self.drills > 0
    }

    fn take(&mut self, steps: &[&Step], front: f64) {
        let cuts = || steps.iter().filter(|step| step.is_cut());
        // Beyond the axis are those that cut there, not those that face past it.
        let reach = |low: f64, high: f64| (low.min(high), high.max(low));
        let (low, high) = cuts().fold((0.0_f64, 0.0_f64), |(low, high), step| {
            let (a, b) = reach(step.motion.from.x, step.motion.to.x);
            (low.min(a), high.max(b))
        });
        self.beyond = -low > high;
        let side = if self.beyond { -1.0 } else { 1.0 };
        self.nearest_cut = f64::INFINITY;
        self.deepest = f64::INFINITY;
        self.first = f64::NEG_INFINITY;
        for (index, step) in steps.iter().enumerate() {
            let on_side = |point: Point| Point::new(point.x * side, point.z);
            let (from, to) = (on_side(step.motion.from), on_side(step.motion.to));
            let way = to - from;
            if to.z < front {
                let nearest = from.x.min(to.x);
                self.nearest = Some(self.nearest.map_or(nearest, |known| known.min(nearest)));
            }
            if !step.is_cut() {
                continue;
            }
            self.nearest_cut = self.nearest_cut.min(from.x.min(to.x));
            self.farthest_cut = self.farthest_cut.max(from.x.max(to.x));
            self.deepest = self.deepest.min(from.z.min(to.z));
            self.first = self.first.max(from.z.max(to.z));
            let next = steps[index + 1..]
                .iter()
                .map(|next| on_side(next.way()))
                .find(|way| way.length() > NOTHING);
            if step.threads {
                self.take_thread(from, to);
            } else {
                self.take_cut(from, way, next);
            }
            if way.z.abs() > NOTHING
                && let Some(next) = next
                && next.x.abs() > NOTHING
                && next.z * way.z <= NOTHING
            {
                self.leaves[usize::from(next.x > 0.0)] += 1;
            }
        }
    }

    fn take_thread(&mut self, from: Point, to: Point) {
        if from.x.abs() <= ON_AXIS && to.x.abs() <= ON_AXIS {
            self.drills += 1;
            return;
        }
        self.threads += 1;
        let (low, high) = self.crests.unwrap_or((from.x, from.x));
        let x = from.x.max(to.x);
        self.crests = Some((low.min(x), high.max(x)));
    }

    fn take_cut(&mut self, from: Point, way: Point, next: Option<Point>) {
        let back = |along: f64, across: f64, axis: f64| {
            let straight = across.abs() <= NOTHING && along * axis < 0.0;
            usize::from(!straight)
        };
        let next_way = next.unwrap_or_default();
        if way.z.abs() <= NOTHING {
            self.across += u32::from(way.x.abs() > NOTHING);
            let is_back = next.is_some() && back(next_way.x, next_way.z, way.x) == 0;
            self.grooves[usize::from(!is_back)] += u32::from(way.x.abs() > NOTHING);
            if is_back {
                self.positions.push(from.z);
                self.leaves[usize::from(next_way.x > 0.0)] += 1;
            }
            if next_way.z.abs() > NOTHING {
                self.leaves_along[usize::from(next_way.z > 0.0)] += 1;
            }
            return;
        }
        if from.x.abs() <= ON_AXIS && way.x.abs() <= NOTHING {
            self.drills += 1;
            return;
        }
        self.along += 1;
        self.longest = self.longest.max(way.z.abs());
        self.widest = self.widest.max(from.x.min(from.x + way.x));
        if way.x.abs() <= NOTHING && way.z < 0.0 {
            let is_back = next.is_some() && back(next_way.z, next_way.x, way.z) == 0;
            self.rings[usize::from(!is_back)] += 1;
            if is_back {
                self.pecks += u32::from(next_way.z < -way.z - NOTHING);
                self.positions.push(from.x);
            }
        } else if way.x.abs() > NOTHING {
            self.rings[1] += 1;
        }
        if way.z < 0.0 && way.x < 0.0 {
            let steep = libm::atan2(-way.x, -way.z).to_degrees();
            self.steepest = self.steepest.max(steep);
        }
    }

    /// Whether it does nothing but drill or tap.
    pub(super) const fn is_drill(&self) -> bool {
        self.drills > 0 && self.along == 0 && self.threads == 0
    }

    fn judge(&self, front: f64, outermost: f64, drilled: bool) -> Work {
        let rings = self.rings[0] > 0 && self.rings[1] == 0 && self.across == 0;
        if self.is_drill() {
            Work::Drill
        } else if self.threads > 0 && self.along == 0 {
            Work::Thread
        } else if rings && (self.pecks > 0 || (!drilled && self.farthest_cut + RING < outermost)) {
            Work::FaceGroove
        } else if self.grooves[0] > 0
            && self.longest <= SHORT
            && self.grooves[0] >= self.grooves[1]
            && self.deepest < front - FACE
        {
            Work::Groove
        } else {
            Work::Turn
        }
    }

    /// Whether its cuts seem to lie on the inside.
    pub(super) const fn is_internal(&self) -> bool {
        self.leaves[0] > self.leaves[1]
    }

    /// Whether it seems to cut away from the chuck: it leaves cuts across towards it.
    pub(super) const fn is_left_hand(&self) -> bool {
        self.leaves_along[0] > self.leaves_along[1]
    }

    /// The least distance between its plunges, mm.
    pub(super) fn step(&self) -> Option<f64> {
        let mut positions = self.positions.clone();
        positions.sort_by(f64::total_cmp);
        let steps = positions.windows(2).map(|pair| pair[1] - pair[0]);
        steps.filter(|step| *step > 0.1).min_by(f64::total_cmp)
    }
}
