//! Determines from the moves of a program what it does with each tool.

use std::collections::BTreeMap;

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::units::{Feed, Point};
use gsk_workpiece::job::Job;
use gsk_workpiece::motion::{MotionKind, ToolMotion};
use gsk_workpiece::stock::Stock;

use super::super::motion_track::MotionTrack;
use crate::curves::RapidRates;

/// Greatest length of a displacement that counts as zero, mm.
const ZERO_LENGTH_MM: f64 = 1e-6;
/// Greatest distance from the spindle axis at which a tool counts as on the axis and drills, mm.
const AXIS_TOLERANCE_MM: f64 = 0.01;
/// Greatest length of a feed along Z that counts as a chamfer or a run-in, mm.
const MAX_RUN_IN_MM: f64 = 3.0;
/// Greatest depth from the face of the bar at which a cut parallel to X counts as facing, mm.
const MAX_FACING_DEPTH_MM: f64 = 1.0;
/// Greatest depth of cut of one turning pass, mm of radius. A tool that plunges from the front with
/// more material outside it cuts a groove into the face.
const MAX_PASS_DEPTH_MM: f64 = 4.0;

/// A motion of the tool tip in a program, with the number of the tool.
#[derive(Clone, Debug)]
pub(super) struct ToolStep {
    pub(super) tool: u8,
    pub(super) motion: ToolMotion,
    pub(super) threads: bool,
}

impl ToolStep {
    pub(super) const fn is_cut(&self) -> bool {
        !matches!(self.motion.kind, MotionKind::Rapid)
    }

    fn displacement(&self) -> Point {
        self.motion.to - self.motion.from
    }
}

/// The kind of work that a tool seems to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ToolWork {
    /// The tool seems to turn, face or bore.
    Turn,
    /// The tool seems to cut grooves into the outside or the inside.
    Groove,
    /// The tool seems to cut grooves into a face.
    FaceGroove,
    /// The tool seems to cut threads.
    Thread,
    /// The tool seems to drill or tap on the spindle axis.
    Drill,
}

/// What a program does with one tool: its feeds, threads and holes.
#[derive(Clone, Debug, Default)]
pub(super) struct ToolUse {
    /// Number of the last tool offset that the program used with the tool; 0 for none.
    pub(super) offset: u8,
    /// Whether the tool cuts beyond the spindle axis, with negative X.
    pub(super) is_beyond_axis: bool,
    thread_count: u32,
    /// Greatest lead of the threads that the tool cuts, mm; 0 without threads.
    pub(super) lead_mm: f64,
    /// Number of the tool's feeds with a motion along Z, off the spindle axis.
    along_count: u32,
    /// Length of the tool's longest feed along Z, off the spindle axis, mm.
    longest_mm: f64,
    /// Number of the tool's feeds parallel to X.
    across_count: u32,
    /// Number of the tool's feeds on the spindle axis.
    pub(super) drill_count: u32,
    /// Number of feeds parallel to X after which the tool retracts in the opposite direction, as
    /// from a groove (index 0), and of the other ones (index 1).
    groove_counts: [u32; 2],
    ring_counts: [u32; 2],
    /// Number of plunges into a face that are interrupted to break the chip or end with a dwell.
    peck_count: u32,
    /// Number of retractions after a cut: towards the spindle axis (index 0), and away from it
    /// (index 1).
    retractions: [u32; 2],
    /// Number of retractions after a cut parallel to X: towards the chuck (index 0), and away from
    /// it (index 1).
    cross_retractions: [u32; 2],
    /// Angle from Z of the steepest cut towards both spindle axis and chuck, degrees; 0 without
    /// such a cut.
    pub(super) steepest_deg: f64,
    /// Least distance of the tool from the spindle axis in motions that end on the chuck side of
    /// the bar's face, mm of radius; `None` without such motions.
    pub(super) nearest_mm: Option<f64>,
    /// Least distance of the tool's cuts from the spindle axis, mm of radius.
    pub(super) nearest_cut_mm: f64,
    /// Greatest distance of the tool's cuts from the spindle axis, mm of radius. `widest_mm` is
    /// that of its longitudinal cuts.
    pub(super) farthest_cut_mm: f64,
    pub(super) widest_mm: f64,
    /// Least Z of the tool's cuts, mm. `first_z` is the greatest one.
    pub(super) deepest_z: f64,
    pub(super) first_z: f64,
    /// Positions at which cuts into grooves begin, mm: Z, or X for grooves in a face.
    positions: Vec<f64>,
    /// Least and greatest radius at which threads are cut, mm; `None` without threads.
    pub(super) crests: Option<(f64, f64)>,
    pub(super) work: Option<ToolWork>,
}

/// Converts executed moves to motions of the tool tips; `rates` are the rapid rates, which
/// determine the path of rapids.
pub(super) fn tool_steps(moves: &[ExecutedMove], rates: RapidRates) -> Vec<ToolStep> {
    let mut track = MotionTrack::from_job(&Job::new(Stock::bar(50.0, 0.0, 60.0)));
    let step = |executed: &ExecutedMove| {
        let threads = executed.kind.is_thread();
        let tool = executed.conditions.tool;
        let motions = track.tip_motions(executed, rates);
        motions.into_iter().map(move |motion| ToolStep {
            tool,
            motion,
            threads,
        })
    };
    moves.iter().flat_map(step).collect()
}

/// Returns the use of each tool that cuts, by tool number. `steps` are the tip motions of `moves`;
/// `front` is Z of the bar's face, mm.
pub(super) fn tool_uses(
    moves: &[ExecutedMove],
    steps: &[ToolStep],
    front: f64,
) -> BTreeMap<u8, ToolUse> {
    let mut uses = BTreeMap::<u8, ToolUse>::new();
    let mut before: Option<&ExecutedMove> = None;
    for executed in moves {
        let used = uses.entry(executed.conditions.tool).or_default();
        if executed.kind == MoveKind::Dwell && before.is_some_and(is_along_inwards) {
            // A ring is cut all round before the tool retracts.
            used.peck_count += 1;
        }
        before = Some(executed);
        if executed.conditions.offset != 0 {
            used.offset = executed.conditions.offset;
        }
        if let (MoveKind::Thread, Some(Feed::PerRevolution(lead))) = (executed.kind, executed.feed)
        {
            used.lead_mm = used.lead_mm.max(lead);
        }
    }
    let numbers: Vec<u8> = uses.keys().copied().collect();
    for number in numbers {
        let own: Vec<&ToolStep> = steps.iter().filter(|step| step.tool == number).collect();
        if let Some(used) = uses.get_mut(&number) {
            used.add_steps(&own, front);
        }
    }
    uses.retain(|_, used| used.has_cuts());
    let outermost = uses
        .values()
        .map(|used| used.farthest_cut_mm)
        .fold(0.0, f64::max);
    let drilled = uses.values().any(ToolUse::is_drill);
    for used in uses.values_mut() {
        used.work = Some(used.classify_work(front, outermost, drilled));
    }
    uses
}

/// Whether a move is a feed parallel to Z towards the chuck, farther from the spindle axis than
/// [`AXIS_TOLERANCE_MM`].
fn is_along_inwards(executed: &ExecutedMove) -> bool {
    let (from, to) = (executed.from, executed.to);
    executed.kind == MoveKind::Feed
        && from.x == to.x
        && to.z < from.z
        && to.x.abs() > AXIS_TOLERANCE_MM
}

impl ToolUse {
    fn has_cuts(&self) -> bool {
        self.thread_count > 0
            || self.along_count > 0
            || self.across_count > 0
            || self.drill_count > 0
    }

    fn add_steps(&mut self, steps: &[&ToolStep], front: f64) {
        let cuts = || steps.iter().filter(|step| step.is_cut());
        // A tool that faces past the axis does not work beyond it.
        let reach = |low: f64, high: f64| (low.min(high), high.max(low));
        let (low, high) = cuts().fold((0.0_f64, 0.0_f64), |(low, high), step| {
            let (a, b) = reach(step.motion.from.x, step.motion.to.x);
            (low.min(a), high.max(b))
        });
        self.is_beyond_axis = -low > high;
        let side = if self.is_beyond_axis { -1.0 } else { 1.0 };
        self.nearest_cut_mm = f64::INFINITY;
        self.deepest_z = f64::INFINITY;
        self.first_z = f64::NEG_INFINITY;
        for (index, step) in steps.iter().enumerate() {
            let on_side = |point: Point| Point::new(point.x * side, point.z);
            let (from, to) = (on_side(step.motion.from), on_side(step.motion.to));
            let displacement = to - from;
            if to.z < front {
                let nearest = from.x.min(to.x);
                self.nearest_mm = Some(self.nearest_mm.map_or(nearest, |known| known.min(nearest)));
            }
            if !step.is_cut() {
                continue;
            }
            self.nearest_cut_mm = self.nearest_cut_mm.min(from.x.min(to.x));
            self.farthest_cut_mm = self.farthest_cut_mm.max(from.x.max(to.x));
            self.deepest_z = self.deepest_z.min(from.z.min(to.z));
            self.first_z = self.first_z.max(from.z.max(to.z));
            let next = steps[index + 1..]
                .iter()
                .map(|next| on_side(next.displacement()))
                .find(|displacement| displacement.length() > ZERO_LENGTH_MM);
            if step.threads {
                self.add_thread(from, to);
            } else {
                self.add_cut(from, displacement, next, front);
            }
            if displacement.z.abs() > ZERO_LENGTH_MM
                && let Some(next) = next
                && next.x.abs() > ZERO_LENGTH_MM
                && next.z * displacement.z <= ZERO_LENGTH_MM
            {
                self.retractions[usize::from(next.x > 0.0)] += 1;
            }
        }
    }

    fn add_thread(&mut self, from: Point, to: Point) {
        if from.x.abs() <= AXIS_TOLERANCE_MM && to.x.abs() <= AXIS_TOLERANCE_MM {
            self.drill_count += 1;
            return;
        }
        self.thread_count += 1;
        let (low, high) = self.crests.unwrap_or((from.x, from.x));
        let x = from.x.max(to.x);
        self.crests = Some((low.min(x), high.max(x)));
    }

    fn add_cut(&mut self, from: Point, displacement: Point, next: Option<Point>, front: f64) {
        let back = |along: f64, across: f64, axis: f64| {
            let straight = across.abs() <= ZERO_LENGTH_MM && along * axis < 0.0;
            usize::from(!straight)
        };
        let next_displacement = next.unwrap_or_default();
        if displacement.z.abs() <= ZERO_LENGTH_MM {
            self.across_count += u32::from(displacement.x.abs() > ZERO_LENGTH_MM);
            let is_back = next.is_some()
                && back(next_displacement.x, next_displacement.z, displacement.x) == 0;
            self.groove_counts[usize::from(!is_back)] +=
                u32::from(displacement.x.abs() > ZERO_LENGTH_MM);
            if is_back {
                self.positions.push(from.z);
                self.retractions[usize::from(next_displacement.x > 0.0)] += 1;
            }
            // In front of the bar the feed is an infeed: the pass along the bar follows it.
            if next_displacement.z.abs() > ZERO_LENGTH_MM && from.z <= front {
                self.cross_retractions[usize::from(next_displacement.z > 0.0)] += 1;
            }
            return;
        }
        if from.x.abs() <= AXIS_TOLERANCE_MM && displacement.x.abs() <= ZERO_LENGTH_MM {
            self.drill_count += 1;
            return;
        }
        self.along_count += 1;
        self.longest_mm = self.longest_mm.max(displacement.z.abs());
        self.widest_mm = self.widest_mm.max(from.x.min(from.x + displacement.x));
        if displacement.x.abs() <= ZERO_LENGTH_MM && displacement.z < 0.0 {
            let is_back = next.is_some()
                && back(next_displacement.z, next_displacement.x, displacement.z) == 0;
            self.ring_counts[usize::from(!is_back)] += 1;
            if is_back {
                self.peck_count +=
                    u32::from(next_displacement.z < -displacement.z - ZERO_LENGTH_MM);
                self.positions.push(from.x);
            }
        } else if displacement.x.abs() > ZERO_LENGTH_MM {
            self.ring_counts[1] += 1;
        }
        if displacement.z < 0.0 && displacement.x < 0.0 {
            let steep = libm::atan2(-displacement.x, -displacement.z).to_degrees();
            self.steepest_deg = self.steepest_deg.max(steep);
        }
    }

    /// Whether the tool only drills or taps.
    pub(super) const fn is_drill(&self) -> bool {
        self.drill_count > 0 && self.along_count == 0 && self.thread_count == 0
    }

    fn classify_work(&self, front: f64, outermost: f64, drilled: bool) -> ToolWork {
        let rings = self.ring_counts[0] > 0 && self.ring_counts[1] == 0 && self.across_count == 0;
        if self.is_drill() {
            ToolWork::Drill
        } else if self.thread_count > 0 && self.along_count == 0 {
            ToolWork::Thread
        } else if rings
            && (self.peck_count > 0
                || (!drilled && self.farthest_cut_mm + MAX_PASS_DEPTH_MM < outermost))
        {
            ToolWork::FaceGroove
        } else if self.groove_counts[0] > 0
            && self.longest_mm <= MAX_RUN_IN_MM
            && self.groove_counts[0] >= self.groove_counts[1]
            && self.deepest_z < front - MAX_FACING_DEPTH_MM
        {
            ToolWork::Groove
        } else {
            ToolWork::Turn
        }
    }

    /// Whether the tool seems to cut the inside: it retracts towards the spindle axis more often
    /// than away from it.
    pub(super) const fn is_internal(&self) -> bool {
        self.retractions[0] > self.retractions[1]
    }

    /// Whether the tool seems to cut away from the chuck: after cuts parallel to X it retracts
    /// towards the chuck more often than away from it.
    pub(super) const fn is_left_hand(&self) -> bool {
        self.cross_retractions[0] > self.cross_retractions[1]
    }

    /// Greatest distance below `limit` between neighbouring plunges of the tool, mm: between
    /// the plunges of one wide groove, where the last step is often a small rest. `None` if all
    /// plunges are farther apart.
    pub(super) fn plunge_step(&self, limit: f64) -> Option<f64> {
        let mut positions = self.positions.clone();
        positions.sort_by(f64::total_cmp);
        let steps = positions.windows(2).map(|pair| pair[1] - pair[0]);
        let steps = steps.filter(|step| *step > 0.1 && *step < limit);
        steps.max_by(f64::total_cmp)
    }
}
