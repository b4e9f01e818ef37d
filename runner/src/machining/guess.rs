//! A job for a program that has none: its tools from what it does with each, its stock
//! from where it cuts. What comes of it is a guess, and is said to be one.
//!
//! ```text
//!            rapids: air, or a collision
//!         ..................................
//!   ██████┌───────────────────────────────┐ :  the largest bar that is cut and that
//!         │  cuts: stock, then air        │ :  neither a rapid nor the back of a tool
//!   ─ · ─ ┴ · ─ · ─ · ─ · ─ · ─ · ─ · ─ · ┴ ─> Z     goes through
//! ```

mod fit;
mod tools;
mod uses;

use std::collections::BTreeMap;

use gsk_core::command::ExecutedMove;
use gsk_core::memory::Offsets;
use gsk_core::preview::{Progress, preview_while};
use gsk_core::setup::Setup;
use gsk_core::units::Diameter;
use gsk_workpiece::grid::{GridPoint, grid};
use gsk_workpiece::job::{DiameterPoint, Job};
use gsk_workpiece::motion::MotionKind;
use gsk_workpiece::region::{GridBounds, Region};
use gsk_workpiece::scene::{LatheScene, SceneTool};
use gsk_workpiece::stock::{Form, Stock};
use gsk_workpiece::tool::{Tool, ToolShape};

use crate::curves::RapidRates;
use tools::{Known, Pose};
use uses::{Step, Use, Work, steps, uses};

/// Moves that a guess looks at: the first of a program.
pub const MOST_MOVES: usize = 20_000;
/// Motions with which tools and bars are tried.
const TRIED: usize = 2_000;
/// Bars that are tried.
const MOST_BARS: usize = 8;
/// Stock between the deepest cut and the jaws, mm.
const TO_JAWS: f64 = 10.0;
/// Diameter of a chuck over the radius of its stock, at least.
const CHUCK: f64 = 5.0;
/// What a facing cut takes at most, mm.
const FACE: f64 = 0.5;
/// Thinner bars are none, mm of radius.
const THINNEST: f64 = 1.0;
/// What a bar has more than the widest cut along it, mm of radius.
const SKIN: f64 = 1.0;
/// Wall around the widest bore, mm.
const WALL: f64 = 10.0;
/// Cuts begin no farther in front of a zero at the face, mm.
const APPROACH: f64 = 10.0;
/// Fronts that are tried.
const MOST_FRONTS: usize = 4;
/// Depth of a metric outside thread over its lead, radii.
const THREAD_DEPTH: f64 = 0.613_4;
/// A tool that goes through so little of the stock stands right, mm² of the half
/// section.
const RIGHT: f64 = 1.0;
/// Another pose must go through so much less.
const BETTER: f64 = 0.5;

/// A bar and tools to learn on where no program says what is cut: the tip of the first
/// tool stands before the bar at power-on, and no offset is right, so that the tools
/// must be set by trial cuts.
pub fn practice() -> Job {
    let length = |x: f64, z: f64| DiameterPoint { x: Diameter(x), z };
    let tools = [
        (1, Tool::turning(), length(0.0, 0.0)),
        (2, Tool::grooving(3.0), length(6.4, -2.7)),
        (3, Tool::threading(60.0), length(-3.2, 4.1)),
    ];
    let mut job = Job::new(Stock::bar(50.0, 1.0, 81.0));
    job.zero = Some(length(-64.0, -10.0));
    for (number, tool, length) in tools {
        job.tools.insert(number, tool);
        job.lengths.insert(number, length);
    }
    job
}

/// A job for the selected program of a set-up, as long as `go_on` says so.
pub fn of_program(setup: &Setup, go_on: &mut dyn FnMut(&Progress) -> bool) -> Option<Job> {
    let mut moves = Vec::new();
    let take = &mut |executed: &ExecutedMove| {
        if moves.len() < MOST_MOVES {
            moves.push(*executed);
        }
    };
    preview_while(setup, &setup.memory.programs, take, go_on);
    let rates = RapidRates::of(&setup.memory);
    guess(&moves, &setup.memory.offsets, rates)
}

/// A job for these moves of a program; `None` for one that cuts nothing.
pub fn guess(moves: &[ExecutedMove], offsets: &Offsets, rates: RapidRates) -> Option<Job> {
    let steps = steps(&moves[..moves.len().min(MOST_MOVES)], rates);
    let cuts: Vec<&Step> = steps.iter().filter(|step| step.is_cut()).collect();
    let deepest = |cut: &&Step| cut.motion.from.z.min(cut.motion.to.z);
    let deepest = cuts.iter().map(deepest).reduce(f64::min)?;
    let fronts = fronts(&cuts);
    let front = fronts.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let uses = uses(moves, &steps, front);
    if uses.is_empty() {
        return None;
    }
    let mut guess = Guess {
        tried: &steps[..steps.len().min(TRIED)],
        offsets,
        radii: Vec::new(),
        fronts,
        deepest,
        poses: BTreeMap::new(),
        slim: BTreeMap::new(),
        uses,
    };
    for (number, used) in &guess.uses {
        let poses = guess.known(0.0, front).poses(used);
        if let Some(pose) = poses.first() {
            guess.poses.insert(*number, *pose);
            guess.slim.insert(*number, pose.levels()[0]);
        }
    }
    guess.radii = guess.radii(&cuts);
    let intrusions = guess.settle_poses();
    let (radius, front) = guess.bar(&intrusions)?;
    Some(guess.fitted(radius, front))
}

/// Where the front of a bar may lie: at the facing cuts and before them, at the zero of
/// the program, or where its cuts begin if the zero lies at the chuck.
fn fronts(cuts: &[&Step]) -> Vec<f64> {
    let ends = |cut: &&Step| (cut.motion.from, cut.motion.to);
    let begins = || cuts.iter().map(ends).map(|(from, to)| from.z.max(to.z));
    let highest = begins().fold(f64::NEG_INFINITY, f64::max);
    let deepest = cuts.iter().map(ends).map(|(from, to)| from.z.min(to.z));
    let deepest = deepest.fold(f64::INFINITY, f64::min);
    let at_the_face = highest <= APPROACH || -deepest >= highest;
    let faced = cuts
        .iter()
        .map(ends)
        .filter(|(from, to)| from.z == to.z && from.x.abs().min(to.x.abs()) < THINNEST)
        .map(|(_, to)| to.z)
        .reduce(f64::max);
    match faced {
        // A cut behind the zero of the face parts the bar off, or faces deeper steps.
        Some(faced) if !at_the_face || faced >= -FACE => return vec![faced + FACE, faced],
        _ if at_the_face => return vec![0.0],
        _ => {}
    }
    let mut begins: Vec<f64> = begins().collect();
    begins.sort_by(|a, b| b.total_cmp(a));
    begins.dedup_by(|a, b| (*a - *b).abs() < 0.01);
    begins.truncate(MOST_FRONTS);
    begins
}

/// What a program does, and what is believed of its tools so far.
struct Guess<'a> {
    tried: &'a [Step],
    offsets: &'a Offsets,
    uses: BTreeMap<u8, Use>,
    /// Radii that a bar may have, the largest first, mm.
    radii: Vec<f64>,
    /// Where its front may lie, Z.
    fronts: Vec<f64>,
    deepest: f64,
    poses: BTreeMap<u8, Pose>,
    /// How slim each tool is with which its pose was judged.
    slim: BTreeMap<u8, u8>,
}

/// Stock that a step goes through and that must not be there.
struct Intruded {
    tool: u8,
    /// In a rapid; else by what does not cut.
    rapid: bool,
    region: Region,
    bounds: GridBounds,
}

impl Guess<'_> {
    const fn known(&self, radius: f64, front: f64) -> Known<'_> {
        Known {
            uses: &self.uses,
            offsets: self.offsets,
            radius,
            front,
        }
    }

    fn is_internal(&self, tool: u8) -> bool {
        let is_drill = |used: &Use| used.work == Some(Work::Drill);
        self.poses.get(&tool).is_some_and(|pose| pose.internal)
            || self.uses.get(&tool).is_some_and(is_drill)
    }

    /// Whether its cuts show how wide the bar is.
    fn is_outside(&self, tool: u8) -> bool {
        let faces = |used: &Use| used.work == Some(Work::FaceGroove);
        !self.is_internal(tool) && !self.uses.get(&tool).is_some_and(faces)
    }

    /// Where outside cuts begin and end, and a little more than the widest cut along.
    fn radii(&self, cuts: &[&Step]) -> Vec<f64> {
        let outside = |cut: &&&Step| self.is_outside(cut.tool) && !cut.threads;
        let mut radii: Vec<f64> = cuts
            .iter()
            .filter(outside)
            .flat_map(|cut| [cut.motion.from.x.abs(), cut.motion.to.x.abs()])
            .filter(|radius| *radius > THINNEST)
            .collect();
        let widest = self.widest();
        let crests = self
            .uses
            .iter()
            .filter(|(tool, _)| !self.is_internal(**tool));
        let crests = crests.filter_map(|(_, used)| {
            let (low, high) = used.crests?;
            Some((low + THREAD_DEPTH * used.lead).max(high))
        });
        let inside = self.uses.values().map(|used| used.farthest_cut);
        radii.push(if widest > 0.0 {
            widest + SKIN
        } else if let Some(faced) = radii.iter().copied().reduce(f64::max) {
            // Nothing is turned along: what is faced is faced from outside the bar.
            faced
        } else if let Some(crest) = crests.reduce(f64::max) {
            crest
        } else {
            inside.fold(0.0, f64::max) + WALL
        });
        radii.sort_by(|a, b| b.total_cmp(a));
        radii.dedup_by(|a, b| (*a - *b).abs() < 0.01);
        radii.truncate(MOST_BARS);
        radii
    }

    /// The greatest radius of a cut along the outside, mm.
    fn widest(&self) -> f64 {
        let outside = self.uses.iter().filter(|(tool, _)| self.is_outside(**tool));
        outside.map(|(_, used)| used.widest).fold(0.0, f64::max)
    }

    /// Radius of the hole that inside tools find, mm; none where a drill makes it.
    fn bore(&self) -> Option<f64> {
        if self
            .uses
            .values()
            .any(|used| used.work == Some(Work::Drill))
        {
            return None;
        }
        self.uses
            .iter()
            .filter(|(tool, _)| self.is_internal(**tool))
            .filter_map(|(_, used)| used.nearest)
            .reduce(f64::min)
            .filter(|radius| *radius > 0.5)
    }

    fn stock(&self, radius: f64, front: f64) -> Stock {
        let mut stock = Stock::bar(radius * 2.0, front, front - self.deepest.min(0.0) + TO_JAWS);
        stock.chuck.diameter.0 = stock.chuck.diameter.0.max(radius * CHUCK);
        if let Some(bore) = self.bore().filter(|bore| *bore < radius) {
            stock.form = Form::Tube {
                diameter: Diameter(radius * 2.0),
                bore: Diameter(bore * 2.0),
            };
        }
        stock
    }

    fn tools(&self, radius: f64, front: f64, slim: &BTreeMap<u8, u8>) -> BTreeMap<u8, Tool> {
        let known = self.known(radius, front);
        let tool = |(number, used): (&u8, &Use)| {
            let pose = self.poses.get(number)?;
            let slim = slim.get(number).copied().unwrap_or(0);
            Some((*number, known.tool(used, *pose, slim)))
        };
        self.uses.iter().filter_map(tool).collect()
    }

    /// What the program goes through in the largest bar.
    fn intrusions(&self) -> Vec<Intruded> {
        let radius = self.radii.first().copied().unwrap_or(THINNEST);
        let front = self.fronts.first().copied().unwrap_or(0.0);
        let tools = self.tools(radius, front, &self.slim);
        let cutters: BTreeMap<u8, SceneTool> = tools
            .iter()
            .map(|(number, tool)| (*number, SceneTool::new(ToolShape::from_tool(tool))))
            .collect();
        let mut scene = LatheScene::new(&self.stock(radius, front));
        let mut intrusions = Vec::new();
        for step in self.tried {
            let Some(cutter) = cutters.get(&step.tool) else {
                continue;
            };
            let intrusion = scene.intrude(cutter, &step.motion);
            for (rapid, region) in [(true, intrusion.insert), (false, intrusion.body)] {
                if let Some(bounds) = region.bounds() {
                    intrusions.push(Intruded {
                        tool: step.tool,
                        rapid: rapid || matches!(step.motion.kind, MotionKind::Rapid),
                        region,
                        bounds,
                    });
                }
            }
        }
        intrusions
    }

    /// Takes for each tool the pose in which it goes through least of the stock.
    fn settle_poses(&mut self) -> Vec<Intruded> {
        let of_tool = |intrusions: &[Intruded], tool: u8| -> f64 {
            let own = intrusions.iter().filter(|it| it.tool == tool);
            own.map(|it| it.region.area()).sum()
        };
        let first = self.intrusions();
        let mut least: BTreeMap<u8, (f64, Pose, u8)> = BTreeMap::new();
        for (tool, pose) in &self.poses {
            let area = of_tool(&first, *tool);
            if area > RIGHT {
                least.insert(*tool, (area, *pose, pose.levels()[0]));
            }
        }
        let others: BTreeMap<u8, Vec<(Pose, u8)>> = least
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
                self.slim.insert(*tool, slim);
            }
            let intrusions = self.intrusions();
            for (tool, (area, pose, slim)) in &mut least {
                let other = of_tool(&intrusions, *tool);
                let Some((tried, level)) = others.get(tool).and_then(|poses| poses.get(index))
                else {
                    continue;
                };
                let factor = if tried == pose { 1.0 } else { BETTER };
                if other < *area * factor && *area > RIGHT {
                    (*area, *pose, *slim) = (other, *tried, *level);
                }
            }
        }
        for (tool, (_, pose, slim)) in least {
            self.poses.insert(tool, pose);
            self.slim.insert(tool, slim);
        }
        self.intrusions()
    }

    /// What is tried when a tool goes through stock: its pose with edges that suit
    /// shoulders, steps and narrow places, then the other poses with them all.
    fn other_poses(&self, used: &Use) -> Vec<(Pose, u8)> {
        let all = self.known(0.0, 0.0).poses(used);
        let mut poses = all.clone();
        // An inside that is nowhere wider than where it is entered is not cut.
        let bores = used
            .nearest
            .is_some_and(|nearest| nearest < used.farthest_cut);
        poses.retain(|pose| bores || !pose.internal);
        let first = all.first().map(|pose| (*pose, pose.levels()[0]));
        let levels = |pose: Pose| pose.levels().map(|slim| (pose, slim));
        let tried = poses.into_iter().flat_map(levels);
        tried.filter(|pose| Some(*pose) != first).collect()
    }

    /// Radius and front of the largest bar that is cut and that nothing goes through; if
    /// there is none, of the one that the fewest rapids go through.
    fn bar(&self, intrusions: &[Intruded]) -> Option<(f64, f64)> {
        let widest = self.widest();
        let bore = self.bore().unwrap_or(0.0);
        let mut least: Option<(Misfit, (f64, f64))> = None;
        for radius in &self.radii {
            for front in &self.fronts {
                if !self.is_cut(*radius, *front) {
                    continue;
                }
                let bar = Region::rectangle(
                    GridPoint::new(grid(front - 2.0 * FARTHEST), grid(bore)),
                    GridPoint::new(grid(*front), grid(*radius)),
                );
                let Some(bounds) = bar.bounds() else {
                    continue;
                };
                let through = |it: &&Intruded| {
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
        let bore = self.bore().unwrap_or(0.0);
        self.uses.iter().any(|(tool, used)| {
            let cuts = match self.is_internal(*tool) {
                true => used.farthest_cut > bore || used.work == Some(Work::Drill),
                false => used.nearest_cut < radius,
            };
            cuts && used.deepest < front
        })
    }
}

/// What is wrong with a bar, the worst first: rapids through it, cuts along that are wider,
/// whether a body goes through it.
type Misfit = (usize, bool, bool);

/// No bar is longer, mm.
const FARTHEST: f64 = 2_000.0;

/// Whether a region is more than what rounding leaves: surfaces slide along each other.
fn is_thick(region: &Region) -> bool {
    const THIN: i32 = 50;
    region.bounds().is_some_and(|bounds| {
        bounds.high.x - bounds.low.x > THIN && bounds.high.y - bounds.low.y > THIN
    })
}
