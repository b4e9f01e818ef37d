//! Fits tools and bar to the moves of a program: makes the tools as slim as needed, and the bar
//! protrude far enough from the jaws.

use std::collections::{BTreeMap, BTreeSet};

use gsk_core::command::{ProgramId, SourcePosition};
use gsk_workpiece::collision::{Obstacle, TouchingPart};
use gsk_workpiece::grid::mm;
use gsk_workpiece::job::Job;
use gsk_workpiece::tool::{Tool, ToolShape};

use super::super::Machining;
use super::tools::MAX_SLIMNESS;
use super::{JAW_CLEARANCE_MM, JobGuess, MAX_BAR_LENGTH_MM};

impl JobGuess<'_> {
    /// Creates the job with a bar of `radius` and face at Z `front`, mm, and with tools that
    /// are only as slim as the program needs.
    pub(super) fn fit_job(&self, radius: f64, front: f64) -> Job {
        let mut slim = BTreeMap::new();
        let mut job = Job::new(self.build_stock(radius, front));
        job.tools = self.build_tools(radius, front, &slim);
        let mut hits = self.find_hits(&job);
        if hits.hits_jaws {
            self.extend_bar_from_jaws(&mut job);
            hits = self.find_hits(&job);
        }
        // The fewest hits of each tool, and its slimness then.
        let mut fewest: BTreeMap<u8, (usize, u8)> = BTreeMap::new();
        for level in 1..=MAX_SLIMNESS {
            if hits.counts_by_tool.is_empty() {
                break;
            }
            for (tool, count) in &hits.counts_by_tool {
                fewest.entry(*tool).or_insert((*count, 0));
                slim.insert(*tool, level);
            }
            let tried: BTreeSet<u8> = hits.counts_by_tool.keys().copied().collect();
            job.tools = self.build_tools(radius, front, &slim);
            hits = self.find_hits(&job);
            for tool in tried {
                let count = hits.counts_by_tool.get(&tool).copied().unwrap_or(0);
                let known = fewest.entry(tool).or_insert((count, level));
                if count < known.0 {
                    *known = (count, level);
                }
            }
        }
        slim.extend(fewest.iter().map(|(tool, (_, level))| (*tool, *level)));
        job.tools = self.build_tools(radius, front, &slim);
        job
    }

    /// Lengthens the bar so that the tools that cut it do not reach the jaws.
    fn extend_bar_from_jaws(&self, job: &mut Job) {
        let reach = |tool: &Tool| {
            let shape = ToolShape::from_tool(tool);
            let body = shape.body.iter().flat_map(|(_, contour)| contour);
            let least = shape.cutting.iter().chain(body).map(|point| point.x).min();
            least.map_or(0.0, mm)
        };
        let reach: BTreeMap<u8, f64> = job
            .tools
            .iter()
            .map(|(number, tool)| (*number, reach(tool)))
            .collect();
        let cuts = self.tried.iter().filter(|step| step.is_cut());
        let least = cuts.filter_map(|step| {
            let reach = reach.get(&step.tool)?;
            Some(step.motion.from.z.min(step.motion.to.z) + reach)
        });
        let Some(least) = least.reduce(f64::min) else {
            return;
        };
        let stock = &mut job.stock;
        let overhang = (stock.face - least + JAW_CLEARANCE_MM).min(MAX_BAR_LENGTH_MM);
        if overhang > stock.overhang {
            stock.length += overhang - stock.overhang;
            stock.overhang = overhang;
        }
    }

    fn find_hits(&self, job: &Job) -> ToolHits {
        let mut machining = Machining::new(job.clone());
        for (line, step) in (1..).zip(self.tried) {
            // A separate source per motion counts each motion separately.
            let source = SourcePosition {
                program: ProgramId::External,
                line,
                sequence: None,
            };
            machining.move_tool(Some(source), step.tool, &step.motion);
        }
        let mut hits = ToolHits::default();
        for finding in machining.findings() {
            let collision = finding.collision;
            match (collision.touching_part, collision.obstacle) {
                (TouchingPart::RapidInsert, Obstacle::Stock) => hits.add_hit(finding.tool),
                (TouchingPart::RapidInsert | TouchingPart::StandingInsert, _) => {}
                (_, Obstacle::Jaws | Obstacle::Chuck) => hits.hits_jaws = true,
                (TouchingPart::Body(_), _) => hits.add_hit(finding.tool),
                (TouchingPart::Insert, _) => {}
            }
        }
        hits
    }
}

/// Collisions of the guessed tools.
#[derive(Default)]
struct ToolHits {
    hits_jaws: bool,
    /// Number of collisions by tool number: of its body with anything, of its insert with the
    /// stock in a rapid.
    counts_by_tool: BTreeMap<u8, usize>,
}

impl ToolHits {
    fn add_hit(&mut self, tool: u8) {
        *self.counts_by_tool.entry(tool).or_default() += 1;
    }
}
