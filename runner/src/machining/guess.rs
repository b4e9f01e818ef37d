//! Guesses a job for a program that has none: its tools from their moves, its stock from the
//! positions of the cuts. Reports mark the result as guessed.
//!
//! ```text
//!            rapids: air, or a collision
//!         ..................................
//!   ██████┌───────────────────────────────┐ :  the largest bar that is cut and that
//!         │  cuts: stock, then air        │ :  neither a rapid nor the back of a tool
//!   ─ · ─ ┴ · ─ · ─ · ─ · ─ · ─ · ─ · ─ · ┴ ─> Z     goes through
//! ```

mod job_fit;
mod practice;
mod tool_uses;
mod tools;

use std::collections::BTreeMap;

use gsk_core::command::ExecutedMove;
use gsk_core::memory::Offsets;
use gsk_core::preview::{PreviewProgress, preview_with_progress};
use gsk_core::setup::Setup;
use gsk_core::units::Diameter;
use gsk_workpiece::grid::{GridPoint, grid};
use gsk_workpiece::job::Job;
use gsk_workpiece::motion::MotionKind;
use gsk_workpiece::region::{GridBounds, Region};
use gsk_workpiece::scene::{LatheScene, SceneTool};
use gsk_workpiece::stock::{Stock, StockForm};
use gsk_workpiece::tool::{Tool, ToolShape};

use crate::curves::RapidRates;
pub use practice::{empty_chuck_job, practice_job};
use tool_uses::{ToolStep, ToolUse, ToolWork, tool_steps, tool_uses};
use tools::{ToolKnowledge, ToolPose};

/// Greatest number of moves, from the beginning of a program, that a guess uses.
pub const MAX_GUESS_MOVES: usize = 20_000;
/// Greatest number of motions with which the guessed tools and bars are tested.
const MAX_TRIED_MOTIONS: usize = 2_000;
/// Greatest number of radii that are tried for the bar.
const MAX_TRIED_BARS: usize = 8;
/// Length of stock between the deepest cut and the jaws of a guessed bar, mm.
const JAW_CLEARANCE_MM: f64 = 10.0;
/// Least ratio of the chuck's diameter to the radius of the guessed stock.
const CHUCK_TO_STOCK_RATIO: f64 = 5.0;
/// Greatest length of stock that a facing cut is assumed to remove, mm.
const FACING_ALLOWANCE_MM: f64 = 0.5;
/// Least radius of a guessed bar, mm.
const MIN_BAR_RADIUS_MM: f64 = 1.0;
/// Excess of the radius of a guessed bar over its widest longitudinal cut, mm.
const OUTSIDE_ALLOWANCE_MM: f64 = 1.0;
/// Wall thickness of a guessed bar around its widest bore, mm.
const BORE_WALL_MM: f64 = 10.0;
/// Greatest Z at which cuts begin if the program zero is at the face of the part, mm.
const FACE_APPROACH_MM: f64 = 10.0;
/// Greatest number of Z positions that are tried for the face of the guessed bar.
const MAX_TRIED_FACES: usize = 4;
/// Depth of a metric external thread, as a radius, divided by its lead.
const THREAD_DEPTH_PER_LEAD: f64 = 0.613_4;
/// Greatest area, in the half section, in which a guessed tool may pass through the stock without
/// cutting, mm²; with a smaller area its pose counts as right.
const ACCEPTED_INTRUSION_MM2: f64 = 1.0;
/// Greatest ratio of the intrusion area of another pose to that of the current pose at which the
/// other one is chosen.
const POSE_CHANGE_FACTOR: f64 = 0.5;

/// Guesses stock and tools for the selected program of a set-up. `can_continue` receives the
/// progress and returns false to cancel the preview. `None` if the program cuts nothing.
pub fn guess_program_job(
    setup: &Setup,
    can_continue: &mut dyn FnMut(&PreviewProgress) -> bool,
) -> Option<Job> {
    let mut moves = Vec::new();
    let take = &mut |executed: &ExecutedMove| {
        if moves.len() < MAX_GUESS_MOVES {
            moves.push(*executed);
        }
    };
    preview_with_progress(setup, &setup.memory.programs, take, can_continue);
    let rates = RapidRates::from_memory(&setup.memory);
    guess_job(&moves, &setup.memory.offsets, rates)
}

/// Guesses stock and tools from the executed moves of a program. `rates` are the rapid rates, which
/// determine the path of rapids. `None` if the program cuts nothing.
pub fn guess_job(moves: &[ExecutedMove], offsets: &Offsets, rates: RapidRates) -> Option<Job> {
    let steps = tool_steps(&moves[..moves.len().min(MAX_GUESS_MOVES)], rates);
    let cuts: Vec<&ToolStep> = steps.iter().filter(|step| step.is_cut()).collect();
    let deepest = |cut: &&ToolStep| cut.motion.from.z.min(cut.motion.to.z);
    let deepest = cuts.iter().map(deepest).reduce(f64::min)?;
    let fronts = find_fronts(&cuts);
    let front = fronts.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let uses = tool_uses(moves, &steps, front);
    if uses.is_empty() {
        return None;
    }
    let mut guess = JobGuess {
        tried: &steps[..steps.len().min(MAX_TRIED_MOTIONS)],
        offsets,
        radii: Vec::new(),
        fronts,
        deepest,
        poses: BTreeMap::new(),
        slimness: BTreeMap::new(),
        uses,
    };
    for (number, used) in &guess.uses {
        let poses = guess.tool_knowledge(0.0, front).possible_poses(used);
        if let Some(pose) = poses.first() {
            guess.poses.insert(*number, *pose);
            guess.slimness.insert(*number, pose.slimness_levels()[0]);
        }
    }
    guess.radii = guess.find_bar_radii(&cuts);
    let intrusions = guess.choose_poses();
    let (radius, front) = guess.choose_bar(&intrusions)?;
    Some(guess.fit_job(radius, front))
}

/// Returns possible Z positions of the bar's face, mm, the most probable first: at the facing cuts
/// and in front of them, at the program zero, or where the cuts begin if the zero is at the chuck.
fn find_fronts(cuts: &[&ToolStep]) -> Vec<f64> {
    let ends = |cut: &&ToolStep| (cut.motion.from, cut.motion.to);
    let begins = || cuts.iter().map(ends).map(|(from, to)| from.z.max(to.z));
    let highest = begins().fold(f64::NEG_INFINITY, f64::max);
    let deepest = cuts.iter().map(ends).map(|(from, to)| from.z.min(to.z));
    let deepest = deepest.fold(f64::INFINITY, f64::min);
    let at_the_face = highest <= FACE_APPROACH_MM || -deepest >= highest;
    let faced = cuts
        .iter()
        .map(ends)
        .filter(|(from, to)| from.z == to.z && from.x.abs().min(to.x.abs()) < MIN_BAR_RADIUS_MM)
        .map(|(_, to)| to.z)
        .reduce(f64::max);
    match faced {
        // A cut on the chuck side of the zero parts the bar off or faces deeper steps.
        Some(faced) if !at_the_face || faced >= -FACING_ALLOWANCE_MM => {
            return vec![faced + FACING_ALLOWANCE_MM, faced];
        }
        _ if at_the_face => return vec![0.0],
        _ => {}
    }
    let mut begins: Vec<f64> = begins().collect();
    begins.sort_by(|a, b| b.total_cmp(a));
    begins.dedup_by(|a, b| (*a - *b).abs() < 0.01);
    begins.truncate(MAX_TRIED_FACES);
    begins
}

/// The motions of a program, and the current assumptions about its bar and its tools.
struct JobGuess<'a> {
    tried: &'a [ToolStep],
    offsets: &'a Offsets,
    uses: BTreeMap<u8, ToolUse>,
    /// Possible radii of the bar, the largest first, mm.
    radii: Vec<f64>,
    /// Possible Z positions of the bar's face, the most probable first, mm.
    fronts: Vec<f64>,
    deepest: f64,
    poses: BTreeMap<u8, ToolPose>,
    /// For each tool number, the level of slimness (0 is the usual tool) with which its mounting
    /// was judged.
    slimness: BTreeMap<u8, u8>,
}

/// A region of the largest bar that a tool passes through without cutting: the real stock cannot be
/// there.
struct StockIntrusion {
    tool: u8,
    /// Whether the tool passed through the stock in a rapid; otherwise with a part that does
    /// not cut.
    rapid: bool,
    region: Region,
    bounds: GridBounds,
}

impl JobGuess<'_> {
    const fn tool_knowledge(&self, radius: f64, front: f64) -> ToolKnowledge<'_> {
        ToolKnowledge {
            uses: &self.uses,
            offsets: self.offsets,
            radius,
            front,
        }
    }

    fn is_internal(&self, tool: u8) -> bool {
        let is_drill = |used: &ToolUse| used.work == Some(ToolWork::Drill);
        self.poses.get(&tool).is_some_and(|pose| pose.internal)
            || self.uses.get(&tool).is_some_and(is_drill)
    }

    /// Whether a tool cuts the outside of the bar, so that its cuts show the radius of the bar.
    fn is_outside(&self, tool: u8) -> bool {
        let faces = |used: &ToolUse| used.work == Some(ToolWork::FaceGroove);
        !self.is_internal(tool) && !self.uses.get(&tool).is_some_and(faces)
    }

    /// Returns possible radii of the bar, the largest first, mm: those at which outside cuts begin
    /// and end, and that of the widest longitudinal cut with an allowance.
    fn find_bar_radii(&self, cuts: &[&ToolStep]) -> Vec<f64> {
        let outside = |cut: &&&ToolStep| self.is_outside(cut.tool) && !cut.threads;
        let mut radii: Vec<f64> = cuts
            .iter()
            .filter(outside)
            .flat_map(|cut| [cut.motion.from.x.abs(), cut.motion.to.x.abs()])
            .filter(|radius| *radius > MIN_BAR_RADIUS_MM)
            .collect();
        let widest = self.widest_cut();
        let crests = self
            .uses
            .iter()
            .filter(|(tool, _)| !self.is_internal(**tool));
        let crests = crests.filter_map(|(_, used)| {
            let (low, high) = used.crests?;
            Some((low + THREAD_DEPTH_PER_LEAD * used.lead_mm).max(high))
        });
        let inside = self.uses.values().map(|used| used.farthest_cut_mm);
        radii.push(if widest > 0.0 {
            widest + OUTSIDE_ALLOWANCE_MM
        } else if let Some(faced) = radii.iter().copied().reduce(f64::max) {
            // Without a longitudinal cut, facing starts outside the bar.
            faced
        } else if let Some(crest) = crests.reduce(f64::max) {
            crest
        } else {
            inside.fold(0.0, f64::max) + BORE_WALL_MM
        });
        radii.sort_by(|a, b| b.total_cmp(a));
        radii.dedup_by(|a, b| (*a - *b).abs() < 0.01);
        radii.truncate(MAX_TRIED_BARS);
        radii
    }

    /// Returns the greatest radius of a longitudinal outside cut, mm.
    fn widest_cut(&self) -> f64 {
        let outside = self.uses.iter().filter(|(tool, _)| self.is_outside(**tool));
        outside.map(|(_, used)| used.widest_mm).fold(0.0, f64::max)
    }

    /// Radius of the hole that boring tools enter, mm; `None` if they enter none or a drill
    /// makes it.
    fn bore_radius(&self) -> Option<f64> {
        if self
            .uses
            .values()
            .any(|used| used.work == Some(ToolWork::Drill))
        {
            return None;
        }
        self.uses
            .iter()
            .filter(|(tool, _)| self.is_internal(**tool))
            .filter_map(|(_, used)| used.nearest_mm)
            .reduce(f64::min)
            .filter(|radius| *radius > 0.5)
    }

    fn build_stock(&self, radius: f64, front: f64) -> Stock {
        let mut stock = Stock::bar(
            radius * 2.0,
            front,
            front - self.deepest.min(0.0) + JAW_CLEARANCE_MM,
        );
        stock.chuck.diameter.0 = stock.chuck.diameter.0.max(radius * CHUCK_TO_STOCK_RATIO);
        if let Some(bore) = self.bore_radius().filter(|bore| *bore < radius) {
            stock.form = StockForm::Tube {
                diameter: Diameter(radius * 2.0),
                bore: Diameter(bore * 2.0),
            };
        }
        stock
    }

    fn build_tools(&self, radius: f64, front: f64, slim: &BTreeMap<u8, u8>) -> BTreeMap<u8, Tool> {
        let known = self.tool_knowledge(radius, front);
        let tool = |(number, used): (&u8, &ToolUse)| {
            let pose = self.poses.get(number)?;
            let slim = slim.get(number).copied().unwrap_or(0);
            Some((*number, known.build_tool(used, *pose, slim)))
        };
        self.uses.iter().filter_map(tool).collect()
    }

    /// Moves the guessed tools through the largest bar and returns the regions that they pass
    /// through without cutting. Stops when all tools of `limits`, if it has any, have passed
    /// through at least the area given there, mm².
    fn find_intrusions(&self, mut limits: BTreeMap<u8, f64>) -> Vec<StockIntrusion> {
        let radius = self.radii.first().copied().unwrap_or(MIN_BAR_RADIUS_MM);
        let front = self.fronts.first().copied().unwrap_or(0.0);
        let tools = self.build_tools(radius, front, &self.slimness);
        let cutters: BTreeMap<u8, SceneTool> = tools
            .iter()
            .map(|(number, tool)| (*number, SceneTool::new(ToolShape::from_tool(tool))))
            .collect();
        let mut scene = LatheScene::new(&self.build_stock(radius, front));
        let mut intrusions = Vec::new();
        let mut areas: BTreeMap<u8, f64> = BTreeMap::new();
        let has_limits = !limits.is_empty();
        for step in self.tried {
            let Some(cutter) = cutters.get(&step.tool) else {
                continue;
            };
            let intrusion = scene.intrude(cutter, &step.motion);
            for (rapid, region) in [(true, intrusion.insert), (false, intrusion.body)] {
                if let Some(bounds) = region.bounds() {
                    *areas.entry(step.tool).or_default() += region.area();
                    intrusions.push(StockIntrusion {
                        tool: step.tool,
                        rapid: rapid || matches!(step.motion.kind, MotionKind::Rapid),
                        region,
                        bounds,
                    });
                }
            }
            limits.retain(|tool, limit| areas.get(tool).copied().unwrap_or(0.0) < *limit);
            if has_limits && limits.is_empty() {
                break;
            }
        }
        intrusions
    }

    /// Chooses for each tool the pose with which it passes through the least stock without cutting.
    /// Returns the intrusions that remain.
    fn choose_poses(&mut self) -> Vec<StockIntrusion> {
        let of_tool = |intrusions: &[StockIntrusion], tool: u8| -> f64 {
            let own = intrusions.iter().filter(|it| it.tool == tool);
            own.map(|it| it.region.area()).sum()
        };
        let first = self.find_intrusions(BTreeMap::new());
        let first_tools = (self.poses.clone(), self.slimness.clone());
        let mut least: BTreeMap<u8, (f64, ToolPose, u8)> = BTreeMap::new();
        for (tool, pose) in &self.poses {
            let area = of_tool(&first, *tool);
            if area > ACCEPTED_INTRUSION_MM2 {
                least.insert(*tool, (area, *pose, pose.slimness_levels()[0]));
            }
        }
        let others: BTreeMap<u8, Vec<(ToolPose, u8)>> = least
            .keys()
            .filter_map(|tool| Some((*tool, self.other_poses(self.uses.get(tool)?))))
            .collect();
        let most = others.values().map(Vec::len).max().unwrap_or(0);
        if most == 0 {
            return first;
        }
        for index in 0..most {
            for (tool, (_, pose, slim)) in &least {
                let next = others.get(tool).and_then(|poses| poses.get(index));
                let (pose, slim) = next.copied().unwrap_or((*pose, *slim));
                self.poses.insert(*tool, pose);
                self.slimness.insert(*tool, slim);
            }
            // A tool takes another pose only if it passes through less than this area.
            let limits: BTreeMap<u8, f64> = least
                .iter()
                .filter_map(|(tool, (area, pose, _))| {
                    let (tried, _) = others.get(tool)?.get(index)?;
                    let factor = if tried == pose {
                        1.0
                    } else {
                        POSE_CHANGE_FACTOR
                    };
                    let may_change = *area > ACCEPTED_INTRUSION_MM2;
                    Some((*tool, if may_change { *area * factor } else { 0.0 }))
                })
                .collect();
            let intrusions = self.find_intrusions(limits.clone());
            for (tool, limit) in limits {
                let other = of_tool(&intrusions, tool);
                let tried = others.get(&tool).and_then(|poses| poses.get(index));
                if let (Some((pose, level)), true) = (tried, other < limit) {
                    least.insert(tool, (other, *pose, *level));
                }
            }
        }
        for (tool, (_, pose, slim)) in least {
            self.poses.insert(tool, pose);
            self.slimness.insert(tool, slim);
        }
        if (&self.poses, &self.slimness) == (&first_tools.0, &first_tools.1) {
            return first;
        }
        self.find_intrusions(BTreeMap::new())
    }

    /// Poses, with their slimness levels, to try for a tool that intrudes into stock: its most
    /// probable pose with every level, then the other poses with every level.
    fn other_poses(&self, used: &ToolUse) -> Vec<(ToolPose, u8)> {
        let all = self.tool_knowledge(0.0, 0.0).possible_poses(used);
        let mut poses = all.clone();
        // An inside that is nowhere wider than its entry is not cut.
        let bores = used
            .nearest_mm
            .is_some_and(|nearest| nearest < used.farthest_cut_mm);
        poses.retain(|pose| bores || !pose.internal);
        let first = all.first().map(|pose| (*pose, pose.slimness_levels()[0]));
        let levels = |pose: ToolPose| pose.slimness_levels().map(|slim| (pose, slim));
        let tried = poses.into_iter().flat_map(levels);
        tried.filter(|pose| Some(*pose) != first).collect()
    }

    /// Returns radius and Z of the face, mm, of the largest bar that the program cuts and that none
    /// of `intrusions` lies in; otherwise of the bar with the least misfit. `None` if the program
    /// cuts no bar.
    fn choose_bar(&self, intrusions: &[StockIntrusion]) -> Option<(f64, f64)> {
        let widest = self.widest_cut();
        let bore = self.bore_radius().unwrap_or(0.0);
        let mut least: Option<(BarMisfit, (f64, f64))> = None;
        for radius in &self.radii {
            for front in &self.fronts {
                if !self.is_cut(*radius, *front) {
                    continue;
                }
                let bar = Region::rectangle(
                    GridPoint::new(grid(front - 2.0 * MAX_BAR_LENGTH_MM), grid(bore)),
                    GridPoint::new(grid(*front), grid(*radius)),
                );
                let Some(bounds) = bar.bounds() else {
                    continue;
                };
                let through = |it: &&StockIntrusion| {
                    it.bounds.intersects(&bounds)
                        && is_thick(&it.region.intersection(bar.contours()))
                };
                let rapids = intrusions.iter().filter(|it| it.rapid).filter(through);
                let bodies = || {
                    intrusions
                        .iter()
                        .filter(|it| !it.rapid)
                        .any(|it| through(&it))
                };
                let rapids = rapids.count();
                let found = (rapids, *radius < widest, bodies());
                if least.as_ref().is_none_or(|(known, _)| found < *known) {
                    least = Some((found, (*radius, *front)));
                }
                if found == (0, false, false) {
                    return Some((*radius, *front));
                }
            }
        }
        least.map(|(_, bar)| bar)
    }

    fn is_cut(&self, radius: f64, front: f64) -> bool {
        let bore = self.bore_radius().unwrap_or(0.0);
        self.uses.iter().any(|(tool, used)| {
            let cuts = match self.is_internal(*tool) {
                true => used.farthest_cut_mm > bore || used.work == Some(ToolWork::Drill),
                false => used.nearest_cut_mm < radius,
            };
            cuts && used.deepest_z < front
        })
    }
}

/// Measure of how badly a bar fits, the most serious value first: number of rapids through the bar,
/// whether a longitudinal cut is wider than it, whether a tool body passes through it.
type BarMisfit = (usize, bool, bool);

/// Greatest length of a guessed bar, mm.
const MAX_BAR_LENGTH_MM: f64 = 2_000.0;

/// Whether a region is thicker, in both directions, than the rounding error of surfaces that slide
/// along each other.
fn is_thick(region: &Region) -> bool {
    const THIN: i32 = 50;
    region.bounds().is_some_and(|bounds| {
        bounds.high.x - bounds.low.x > THIN && bounds.high.y - bounds.low.y > THIN
    })
}
