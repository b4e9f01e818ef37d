//! Fits tools and bar to what a program does: as slim as needed, far enough out of the jaws.

use std::collections::{BTreeMap, BTreeSet};

use gsk_core::command::{ProgramId, Source};
use gsk_workpiece::collision::{Obstacle, TouchingPart};
use gsk_workpiece::grid::mm;
use gsk_workpiece::job::Job;
use gsk_workpiece::tool::{Tool, ToolShape};

use super::super::Machining;
use super::tools::SLIMMEST;
use super::{FARTHEST, Guess, TO_JAWS};

impl Guess<'_> {
    /// The job with a bar, its tools as slim as the program needs them.
    pub(super) fn fitted(&self, radius: f64, front: f64) -> Job {
        let mut slim = BTreeMap::new();
        let mut job = Job::new(self.stock(radius, front));
        job.tools = self.tools(radius, front, &slim);
        let mut hits = self.hits(&job);
        if hits.jaws {
            self.clear_jaws(&mut job);
            hits = self.hits(&job);
        }
        // The fewest hits of each tool, and how slim it is then.
        let mut fewest: BTreeMap<u8, (usize, u8)> = BTreeMap::new();
        for level in 1..=SLIMMEST {
            if hits.of_tools.is_empty() {
                break;
            }
            for (tool, count) in &hits.of_tools {
                fewest.entry(*tool).or_insert((*count, 0));
                slim.insert(*tool, level);
            }
            let tried: BTreeSet<u8> = hits.of_tools.keys().copied().collect();
            job.tools = self.tools(radius, front, &slim);
            hits = self.hits(&job);
            for tool in tried {
                let count = hits.of_tools.get(&tool).copied().unwrap_or(0);
                let known = fewest.entry(tool).or_insert((count, level));
                if count < known.0 {
                    *known = (count, level);
                }
            }
        }
        slim.extend(fewest.iter().map(|(tool, (_, level))| (*tool, *level)));
        job.tools = self.tools(radius, front, &slim);
        job
    }

    /// Makes the bar stand out as far as tools reach that cut it.
    fn clear_jaws(&self, job: &mut Job) {
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
        let overhang = (stock.face - least + TO_JAWS).min(FARTHEST);
        if overhang > stock.overhang {
            stock.length += overhang - stock.overhang;
            stock.overhang = overhang;
        }
    }

    fn hits(&self, job: &Job) -> Hits {
        let mut machining = Machining::new(job.clone());
        for (line, step) in (1..).zip(self.tried) {
            // Each motion is counted by itself.
            let source = Source {
                program: ProgramId::External,
                line,
                sequence: None,
            };
            machining.carry_out(Some(source), step.tool, &step.motion);
        }
        let mut hits = Hits::default();
        for finding in machining.findings() {
            let collision = finding.collision;
            match (collision.touching_part, collision.obstacle) {
                (TouchingPart::RapidInsert, Obstacle::Stock) => hits.count(finding.tool),
                (TouchingPart::RapidInsert | TouchingPart::StandingInsert, _) => {}
                (_, Obstacle::Jaws | Obstacle::Chuck) => hits.jaws = true,
                (TouchingPart::Body(_), _) => hits.count(finding.tool),
                (TouchingPart::Insert, _) => {}
            }
        }
        hits
    }
}

/// What guessed tools hit.
#[derive(Default)]
struct Hits {
    jaws: bool,
    /// Findings by tool: its body anywhere, its insert in a rapid in the stock.
    of_tools: BTreeMap<u8, usize>,
}

impl Hits {
    fn count(&mut self, tool: u8) {
        *self.of_tools.entry(tool).or_default() += 1;
    }
}
