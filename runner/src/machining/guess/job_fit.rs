//! Fits tools and bar to the moves of a program: makes the tools as slim as needed, and the bar
//! protrude far enough from the jaws.

use std::collections::{BTreeMap, BTreeSet};

use gsk_core::command::{ProgramId, SourcePosition};
use gsk_workpiece::collision::{Obstacle, TouchingPart};
use gsk_workpiece::grid::mm;
use gsk_workpiece::job::Job;
use gsk_workpiece::tool::{Tool, ToolShape};

use super::super::{CollisionFinding, Machining};
use super::tools::MAX_SLIMNESS;
use super::{JAW_CLEARANCE_MM, JobGuess, MAX_BAR_LENGTH_MM};

impl JobGuess<'_> {
    /// Creates the job with a bar of `radius` and face at Z `front`, mm, and with tools that
    /// are only as slim as the program needs.
    pub(super) fn fit_job(&self, radius: f64, front: f64) -> Job {
        let mut slim = BTreeMap::new();
        let mut job = Job::new(self.build_stock(radius, front));
        job.tools = self.build_tools(radius, front, &slim);
        let mut hits = self.find_hits(&job, &BTreeMap::new());
        if hits.hits_jaws {
            self.extend_bar_from_jaws(&mut job);
            hits = self.find_hits(&job, &BTreeMap::new());
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
            // The hits of other tools decide which ones are tried next.
            let limits = match tried.len() == job.tools.len() {
                true => fewest.iter().map(|(tool, it)| (*tool, it.0)).collect(),
                false => BTreeMap::new(),
            };
            hits = self.find_hits(&job, &limits);
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

    /// Moves the tools of a job along the motions and counts their collisions. Stops when all tools
    /// of `limits`, if it has any, have at least the number given there.
    fn find_hits(&self, job: &Job, limits: &BTreeMap<u8, usize>) -> ToolHits {
        let mut machining = Machining::new(job.clone());
        let mut hits = ToolHits::default();
        let mut counted = 0;
        for (line, step) in (1..).zip(self.tried) {
            // A separate source per motion counts each motion separately.
            let source = SourcePosition {
                program: ProgramId::External,
                line,
                sequence: None,
            };
            machining.move_tool(Some(source), step.tool, &step.motion, 0.0);
            for finding in machining.findings().iter().skip(counted) {
                hits.add_finding(finding);
            }
            counted = machining.findings().len();
            if hits.reach(limits) {
                break;
            }
        }
        hits
    }
}

/// The collisions that the guessed tools would make.
#[derive(Debug, Default, PartialEq)]
struct ToolHits {
    hits_jaws: bool,
    /// Number of collisions by tool number: of its body with anything, of its insert with the
    /// stock in a rapid.
    counts_by_tool: BTreeMap<u8, usize>,
}

impl ToolHits {
    fn add_finding(&mut self, finding: &CollisionFinding) {
        let collision = finding.collision;
        match (collision.touching_part, collision.obstacle) {
            (TouchingPart::RapidInsert, Obstacle::Stock) => self.add_hit(finding.tool),
            (TouchingPart::RapidInsert | TouchingPart::StandingInsert, _) => {}
            (_, Obstacle::Jaws | Obstacle::Chuck) => self.hits_jaws = true,
            (TouchingPart::Body(_), _) => self.add_hit(finding.tool),
            (TouchingPart::Insert, _) => {}
        }
    }

    /// Whether each tool of `limits`, of which there must be one, has at least the number of
    /// collisions given there.
    fn reach(&self, limits: &BTreeMap<u8, usize>) -> bool {
        let reaches = |(tool, limit): (&u8, &usize)| {
            let count = self.counts_by_tool.get(tool);
            count.is_some_and(|count| count >= limit)
        };
        !limits.is_empty() && limits.iter().all(reaches)
    }

    fn add_hit(&mut self, tool: u8) {
        *self.counts_by_tool.entry(tool).or_default() += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trial_stops_when_every_tool_has_its_number_of_hits() {
        let mut hits = ToolHits::default();
        let limits = BTreeMap::from([(1, 2), (3, 1)]);
        assert!(!hits.reach(&BTreeMap::new()) && !hits.reach(&limits));
        hits.add_hit(1);
        hits.add_hit(3);
        assert!(!hits.reach(&limits));
        hits.add_hit(1);
        assert!(hits.reach(&limits));
        hits.add_hit(2);
        assert!(hits.reach(&limits) && !hits.reach(&BTreeMap::new()));
    }
}
