//! Machines the part with a program: its moves cut the stock, and each collision is stored with its
//! block.
//!
//! Two sources use the same sweeps: the moves of a preview ([`Machining::execute_move`]), and the
//! ticks of a running control ([`live_part`]).

mod cut_fault;
pub mod guess;
pub mod live_part;
mod load_meter;
mod load_summary;
mod motion_track;
mod mounting;
mod move_load;
pub mod part_comparison;
mod pending_cut;
pub mod slide_shift;
mod thread_log;

use std::collections::BTreeMap;

use gsk_core::command::{ExecutedMove, SourcePosition};
use gsk_core::machine::LoadLimits;
use gsk_workpiece::collision::Collision;
use gsk_workpiece::cutting::{ChipSample, CuttingMaterial};
use gsk_workpiece::job::Job;
use gsk_workpiece::motion::{MotionKind, ToolMotion};
use gsk_workpiece::part::TurnedPart;
use gsk_workpiece::region::Region;
use gsk_workpiece::scene::{LatheScene, MotionEffect, SceneTool};
use gsk_workpiece::tool::{Insert, ToolShape};

pub use cut_fault::{CutFault, CutFaultKind};
pub use load_summary::{BlockLoad, LoadFinding, LoadSummary};
use motion_track::MotionTrack;
pub use mounting::Mounting;
use move_load::CutConditions;
pub use move_load::{CutLoad, MoveLoad};

use crate::curves::RapidRates;

/// Greatest number of collisions that are stored; further ones are dropped.
const MAX_FINDINGS: usize = 100;
/// Greatest radius of a grooving cut that parts the bar off, mm.
const PART_OFF_RADIUS_MM: f64 = 0.05;

/// A collision, and the block and tool that caused it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionFinding {
    /// The block that caused the collision; `None` in manual operation.
    pub source: Option<SourcePosition>,
    /// Number of the tool that collided.
    pub tool: u8,
    /// The collision: touching parts, position and depth.
    pub collision: Collision,
}

/// The time in the material of a tool: feeds that remove material, and threads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolCutting {
    /// Machine time, s.
    pub seconds: f64,
    /// The block of its first cut; `None` in manual operation.
    pub first_block: Option<SourcePosition>,
}

/// The part of a job that is being machined, move by move.
#[derive(Clone, Debug)]
pub struct Machining {
    job: Job,
    scene: LatheScene,
    cutters: BTreeMap<u8, SceneTool>,
    track: MotionTrack,
    /// Volume of the parted-off pieces, mm³.
    parted_volume_mm3: f64,
    findings: Vec<CollisionFinding>,
    /// What each tool has cut.
    cutting: BTreeMap<u8, ToolCutting>,
}

impl Machining {
    /// Creates the machining of a job with uncut stock.
    pub fn new(job: Job) -> Self {
        Self {
            scene: LatheScene::new(&job.stock),
            track: MotionTrack::from_job(&job),
            cutters: cutters(&job),
            parted_volume_mm3: 0.0,
            findings: Vec::new(),
            cutting: BTreeMap::new(),
            job,
        }
    }

    /// Returns the job with stock and tools, as passed to [`Machining::new`].
    pub const fn job(&self) -> &Job {
        &self.job
    }

    /// Returns the part, its clamping and the stock in their current state.
    pub const fn scene(&self) -> &LatheScene {
        &self.scene
    }

    /// Returns the volume that cuts have removed, mm³, without the parted-off pieces.
    pub fn removed_volume(&self) -> f64 {
        self.job.stock.section().volume() - self.scene.part().volume() - self.parted_volume_mm3
    }

    /// Returns the time in the material by tool, over all pieces of stock.
    pub const fn cutting(&self) -> &BTreeMap<u8, ToolCutting> {
        &self.cutting
    }

    /// The collisions in the order of their detection, each kind once per block and tool.
    pub fn findings(&self) -> &[CollisionFinding] {
        &self.findings
    }

    /// Returns the mapping from slide positions to tip positions in the part.
    pub const fn mounting(&self) -> &Mounting {
        self.track.mounting()
    }

    /// Replaces the part by uncut stock and discards the collisions. The positions of the tools are
    /// kept.
    pub fn clamp_new_stock(&mut self) {
        self.scene = LatheScene::new(&self.job.stock);
        self.parted_volume_mm3 = 0.0;
        self.findings.clear();
    }

    /// Takes the tools of another job for the same stock. The part, its place and the collisions
    /// are kept.
    fn change_tools(&mut self, job: Job) {
        self.cutters = cutters(&job);
        self.track.mounting_mut().change_tools(&job);
        self.job = job;
    }

    /// A figure that changes with each cut and each collision of a tool: seconds in the material
    /// and number of collisions.
    fn contact_count(&self, tool: u8) -> (f64, usize) {
        let seconds = self.cutting.get(&tool).map_or(0.0, |it| it.seconds);
        (seconds, self.findings.len())
    }

    /// Cuts the part with a move of the program. `rates` are the rapid rates, which determine the
    /// path of rapids.
    pub fn execute_move(&mut self, executed: &ExecutedMove, rates: RapidRates) {
        let tool = executed.conditions.tool;
        for motion in self.track.tip_motions(executed, rates) {
            self.move_tool(Some(executed.source), tool, &motion, executed.duration_s);
        }
    }

    /// Cuts the part with a move of the program as [`Machining::execute_move`] does, and returns the
    /// load of its cut in a material; `None` if the move cuts nothing.
    pub fn execute_move_with_load(
        &mut self,
        executed: &ExecutedMove,
        rates: RapidRates,
        material: &CuttingMaterial,
    ) -> Option<MoveLoad> {
        let number = executed.conditions.tool;
        let mut load = None;
        for motion in self.track.tip_motions(executed, rates) {
            if let (Some(tool), Some(cutter)) =
                (self.job.tools.get(&number), self.cutters.get(&number))
            {
                let chips = |feed_mm| self.scene.chip_samples(cutter, &motion, feed_mm);
                let conditions = CutConditions {
                    tool,
                    material: self.job.material_at_rake(material, number),
                    scene: &self.scene,
                };
                load = MoveLoad::new(executed, &conditions, &motion, chips);
            }
            self.move_tool(Some(executed.source), number, &motion, executed.duration_s);
        }
        load
    }

    /// Moves a tool relative to the part: cuts the part, and stores a collision with the block
    /// `source`; `None` in manual operation. The motion takes `seconds`.
    fn move_tool(
        &mut self,
        source: Option<SourcePosition>,
        tool: u8,
        motion: &ToolMotion,
        seconds: f64,
    ) {
        let Some(cutter) = self.cutters.get(&tool) else {
            return;
        };
        let MotionEffect { removed, collision } = self.scene.move_tool(cutter, motion);
        let is_cutting = match motion.kind {
            MotionKind::Rapid => false,
            MotionKind::Thread(_) => true,
            MotionKind::Line | MotionKind::Arc { .. } => removed.area > 0.0,
        };
        if is_cutting && motion.turning {
            let cutting = self.cutting.entry(tool).or_default();
            cutting.seconds += seconds;
            cutting.first_block = cutting.first_block.or(source);
        }
        if let Some(collision) = collision {
            self.add_finding(CollisionFinding {
                source,
                tool,
                collision,
            });
        }
        let parts_off =
            removed.area > 0.0 && motion.to.x <= PART_OFF_RADIUS_MM && self.is_grooving(tool);
        if parts_off {
            let loose = self.scene.drop_loose_pieces();
            self.parted_volume_mm3 += loose.iter().map(Region::volume).sum::<f64>();
        }
    }

    /// Returns the part that a motion of a tool would leave.
    fn part_after(&self, tool: u8, motion: &ToolMotion) -> TurnedPart {
        match self.cutters.get(&tool) {
            Some(cutter) => self.scene.part_after(cutter, motion),
            None => self.scene.part().clone(),
        }
    }

    /// Moves a tool whose insert is broken: nothing is cut, and a collision of its body is stored.
    fn move_broken_tool(&mut self, source: Option<SourcePosition>, tool: u8, motion: &ToolMotion) {
        let cutter = self.cutters.get(&tool);
        let found = cutter.and_then(|cutter| self.scene.find_body_collision(cutter, motion));
        if let Some(collision) = found {
            self.add_finding(CollisionFinding {
                source,
                tool,
                collision,
            });
        }
    }

    /// The first limit that a straight motion or a thread exceeds with a feed per revolution, mm,
    /// at a spindle speed, r/min; `None` within all limits.
    fn exceeded_limit(
        &self,
        number: u8,
        motion: &ToolMotion,
        (feed_mm, rpm): (f64, f64),
        limits: &LoadLimits,
        material: &CuttingMaterial,
    ) -> Option<CutFaultKind> {
        let (conditions, samples) = self.sample_motion(number, motion, feed_mm, material)?;
        let feed = (feed_mm, matches!(motion.kind, MotionKind::Thread(_)));
        samples
            .iter()
            .find_map(|sample| conditions.exceeded_limit(sample, feed, rpm, limits))
    }

    /// The load with the greatest force along a straight motion or a thread with a feed per
    /// revolution, mm, at a spindle speed, r/min; `None` if nothing is cut.
    fn heaviest_load(
        &self,
        number: u8,
        motion: &ToolMotion,
        (feed_mm, rpm): (f64, f64),
        material: &CuttingMaterial,
    ) -> Option<CutLoad> {
        let (conditions, samples) = self.sample_motion(number, motion, feed_mm, material)?;
        let loads = samples
            .iter()
            .map(|sample| conditions.load(sample, 1.0, rpm));
        loads.max_by(|one, other| one.force_n.total_cmp(&other.force_n))
    }

    /// The chips of a motion with a feed per revolution, mm, and what their load depends on; `None`
    /// for a tool that the job does not have.
    fn sample_motion(
        &self,
        number: u8,
        motion: &ToolMotion,
        feed_mm: f64,
        material: &CuttingMaterial,
    ) -> Option<(CutConditions<'_>, Vec<ChipSample>)> {
        let (tool, cutter) = (self.job.tools.get(&number)?, self.cutters.get(&number)?);
        let feed_of_edge_mm = feed_mm / f64::from(tool.edge_count());
        let samples = self.scene.chip_samples(cutter, motion, feed_of_edge_mm);
        let conditions = CutConditions {
            tool,
            material: self.job.material_at_rake(material, number),
            scene: &self.scene,
        };
        Some((conditions, samples))
    }

    fn is_grooving(&self, tool: u8) -> bool {
        let tool = self.job.tools.get(&tool);
        tool.is_some_and(|tool| matches!(tool.insert, Insert::Grooving { .. }))
    }

    fn add_finding(&mut self, finding: CollisionFinding) {
        let same = |known: &CollisionFinding| {
            known.source == finding.source
                && known.tool == finding.tool
                && known.collision.touching_part == finding.collision.touching_part
                && known.collision.obstacle == finding.collision.obstacle
        };
        if let Some(known) = self.findings.iter_mut().find(|known| same(known)) {
            known.collision.depth = known.collision.depth.max(finding.collision.depth);
        } else if self.findings.len() < MAX_FINDINGS {
            self.findings.push(finding);
        }
    }
}

/// The shapes of the tools of a job, by their numbers.
fn cutters(job: &Job) -> BTreeMap<u8, SceneTool> {
    let tools = job.tools.iter();
    tools
        .map(|(number, tool)| (*number, SceneTool::new(ToolShape::from_tool(tool))))
        .collect()
}

#[cfg(test)]
mod tests;
