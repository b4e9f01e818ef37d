//! What became of the part.

use gsk_messages::{Language, Message, say};
use serde::Serialize;

use super::said;
use crate::machining::{Finding, Machining};
use crate::moves::{diameter_z, rounded};

/// The part at the end of a program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartReport {
    /// The job's file; none of one that was guessed.
    pub job: Option<String>,
    /// Volume of the fresh stock, mm³.
    pub stock_mm3: f64,
    /// Volume that was cut away, mm³.
    pub removed_mm3: f64,
    /// Volume of the part, mm³.
    pub left_mm3: f64,
    /// What hit what, in the order in which it happened.
    pub collisions: Vec<CollisionReport>,
}

/// A collision.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CollisionReport {
    /// Line of its block, from 1; none by hand.
    pub line: Option<u32>,
    /// Sequence number of its block.
    pub n: Option<u16>,
    /// The tool.
    pub tool: u8,
    /// What touched what.
    pub text: String,
    /// Where the tip was at the first touch, X as a diameter, part coordinates.
    pub tip: (f64, f64),
    /// Where they touched.
    pub contact: (f64, f64),
    /// How deep it went, mm.
    pub depth: f64,
}

impl PartReport {
    /// Of a part as it is now.
    pub fn new(machining: &Machining, job: Option<String>, language: Option<Language>) -> Self {
        Self {
            job,
            stock_mm3: rounded(machining.scene().stock().section().volume()),
            removed_mm3: rounded(machining.removed_volume()),
            left_mm3: rounded(machining.scene().part().volume()),
            collisions: machining
                .findings()
                .iter()
                .map(|finding| CollisionReport::new(finding, language))
                .collect(),
        }
    }

    /// Lines for people.
    pub(super) fn words(&self, words: Language) -> Vec<String> {
        let part = match &self.job {
            Some(job) => say::report_part(job, self.removed_mm3, self.left_mm3),
            None => say::report_part_guessed(self.removed_mm3, self.left_mm3),
        };
        let collisions = self.collisions.iter().map(CollisionReport::message);
        core::iter::once(part)
            .chain(collisions)
            .map(|said| said.text(words))
            .collect()
    }
}

impl CollisionReport {
    fn new(finding: &Finding, language: Option<Language>) -> Self {
        let collision = &finding.collision;
        Self {
            line: finding.source.map(|source| source.line),
            n: finding.source.and_then(|source| source.sequence),
            tool: finding.tool,
            text: said(&collision.message(), language),
            tip: diameter_z(collision.tip),
            contact: diameter_z(collision.contact),
            depth: rounded(collision.depth),
        }
    }

    fn message(&self) -> Message {
        let ((x, z), depth) = (self.tip, self.depth);
        match self.line {
            Some(line) => say::report_collision(line, self.tool, &self.text, x, z, depth),
            None => say::report_collision_by_hand(self.tool, &self.text, x, z, depth),
        }
    }
}
