//! A program carried out on the part: its moves cut the stock, and what they hit is
//! found with its block.
//!
//! The same part is cut two ways, and by the same sweeps: from the moves of a preview
//! ([`Machining::moved`]), and tick by tick from a control that runs ([`live`]).

pub mod guess;
pub mod ideal;
pub mod live;
mod mounting;
mod track;

use std::collections::BTreeMap;

use gsk_core::command::{ExecutedMove, Source};
use gsk_workpiece::collision::Collision;
use gsk_workpiece::job::Job;
use gsk_workpiece::motion::ToolMotion;
use gsk_workpiece::region::Region;
use gsk_workpiece::scene::{LatheScene, MotionEffect, SceneTool};
use gsk_workpiece::tool::{Insert, ToolShape};

pub use mounting::Mounting;
use track::Track;

use crate::curves::RapidRates;

/// Findings that are kept.
const MOST_FINDINGS: usize = 100;
/// An insert that came so near to the axis has parted the bar off, mm of radius.
const PARTED: f64 = 0.05;

/// A collision and the block that made it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// The block; none by hand.
    pub source: Option<Source>,
    /// The tool.
    pub tool: u8,
    /// What hit what, where, how deep.
    pub collision: Collision,
}

/// The part of a job while a program works on it.
#[derive(Clone, Debug)]
pub struct Machining {
    job: Job,
    scene: LatheScene,
    cutters: BTreeMap<u8, SceneTool>,
    track: Track,
    /// Volume of what was parted off, mm³.
    parted: f64,
    findings: Vec<Finding>,
}

impl Machining {
    /// With fresh stock.
    pub fn new(job: Job) -> Self {
        let cutters = job
            .tools
            .iter()
            .map(|(number, tool)| (*number, SceneTool::new(ToolShape::from_tool(tool))))
            .collect();
        Self {
            scene: LatheScene::new(&job.stock),
            track: Track::of(&job),
            cutters,
            parted: 0.0,
            findings: Vec::new(),
            job,
        }
    }

    /// The job.
    pub const fn job(&self) -> &Job {
        &self.job
    }

    /// Part and clamping.
    pub const fn scene(&self) -> &LatheScene {
        &self.scene
    }

    /// Volume that was cut away so far, mm³; what was parted off is no part of it.
    pub fn removed_volume(&self) -> f64 {
        self.job.stock.section().volume() - self.scene.part().volume() - self.parted
    }

    /// The collisions, each kind once a block, in the order in which they were met.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// How tools and part stand to the slide.
    pub const fn mounting(&self) -> &Mounting {
        self.track.mounting()
    }

    /// A new piece of stock is clamped; the tools stay where they are.
    pub fn fresh_stock(&mut self) {
        self.scene = LatheScene::new(&self.job.stock);
        self.parted = 0.0;
        self.findings.clear();
    }

    /// A move of the program.
    pub fn moved(&mut self, executed: &ExecutedMove, rates: RapidRates) {
        let tool = executed.conditions.tool;
        for motion in self.track.motions(executed, rates) {
            self.carry_out(Some(executed.source), tool, &motion);
        }
    }

    /// Moves a tool about the part.
    fn carry_out(&mut self, source: Option<Source>, tool: u8, motion: &ToolMotion) {
        let Some(cutter) = self.cutters.get(&tool) else {
            return;
        };
        let MotionEffect { removed, collision } = self.scene.move_tool(cutter, motion);
        if let Some(collision) = collision {
            self.note(Finding {
                source,
                tool,
                collision,
            });
        }
        let parts = removed.area > 0.0 && motion.to.x <= PARTED && self.is_grooving(tool);
        if parts {
            let loose = self.scene.drop_loose_pieces();
            self.parted += loose.iter().map(Region::volume).sum::<f64>();
        }
    }

    fn is_grooving(&self, tool: u8) -> bool {
        let tool = self.job.tools.get(&tool);
        tool.is_some_and(|tool| matches!(tool.insert, Insert::Grooving { .. }))
    }

    fn note(&mut self, finding: Finding) {
        let same = |known: &Finding| {
            known.source == finding.source
                && known.tool == finding.tool
                && known.collision.touching_part == finding.collision.touching_part
                && known.collision.obstacle == finding.collision.obstacle
        };
        if let Some(known) = self.findings.iter_mut().find(|known| same(known)) {
            known.collision.depth = known.collision.depth.max(finding.collision.depth);
        } else if self.findings.len() < MOST_FINDINGS {
            self.findings.push(finding);
        }
    }
}

#[cfg(test)]
mod tests;
