//! What became of the part.

use gsk_core::command::ProgramId;
use gsk_core::units::Diameter;
use gsk_messages::{Language, Message, say};
use gsk_workpiece::measure::{self, Feature, SectionSide};
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
    /// The outside and then the bore, each from front to back, if they were measured.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub features: Vec<Feature>,
    /// What hit what, in the order in which it happened.
    pub collisions: Vec<CollisionReport>,
}

/// A collision.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CollisionReport {
    /// Line of its block, from 1; none by hand.
    pub line: Option<u32>,
    /// Sequence number of its block.
    pub n: Option<u32>,
    /// The program of its block; not part of the JSON.
    #[serde(skip)]
    pub program: Option<ProgramId>,
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
    pub fn new(
        machining: &Machining,
        job: Option<String>,
        measure: bool,
        language: Option<Language>,
    ) -> Self {
        let features = match measure {
            true => {
                let section = machining.scene().part().section();
                let sides = [SectionSide::Outside, SectionSide::Inside];
                let of_side = |side| measure::measure_features(&section, side);
                sides
                    .into_iter()
                    .flat_map(of_side)
                    .map(to_micrometre)
                    .collect()
            }
            false => Vec::new(),
        };
        Self {
            job,
            stock_mm3: rounded(machining.scene().stock().section().volume()),
            removed_mm3: rounded(machining.removed_volume()),
            left_mm3: rounded(machining.scene().part().volume()),
            features,
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
        let features = self.features.iter().map(in_words);
        core::iter::once(part)
            .chain(features)
            .chain(collisions)
            .map(|said| said.text(words))
            .collect()
    }
}

/// A feature as a drawing gives it: whole micrometres, thousandths of a degree.
fn to_micrometre(feature: Feature) -> Feature {
    let whole = |value: f64| (value * 1000.0).round() / 1000.0;
    let both = |(from, to): (f64, f64)| (whole(from), whole(to));
    let across =
        |(from, to): (Diameter, Diameter)| (Diameter(whole(from.0)), Diameter(whole(to.0)));
    match feature {
        Feature::Cylinder { diameter, z } => Feature::Cylinder {
            diameter: Diameter(whole(diameter.0)),
            z: both(z),
        },
        Feature::Face { diameters, z } => Feature::Face {
            diameters: across(diameters),
            z: whole(z),
        },
        Feature::Cone {
            diameters,
            z,
            angle,
        } => Feature::Cone {
            diameters: across(diameters),
            z: both(z),
            angle: whole(angle),
        },
        Feature::Arc {
            radius,
            diameters,
            z,
        } => Feature::Arc {
            radius: whole(radius),
            diameters: across(diameters),
            z: both(z),
        },
        Feature::Thread {
            pitch,
            diameters,
            z,
        } => Feature::Thread {
            pitch: whole(pitch),
            diameters: across(diameters),
            z: both(z),
        },
    }
}

/// What is measured of a feature.
pub fn in_words(feature: &Feature) -> Message {
    match *feature {
        Feature::Cylinder { diameter, z } => say::measure_cylinder(diameter.0, z.0, z.1),
        Feature::Face {
            diameters: (from, to),
            z,
        } => say::measure_face(z, from.0, to.0),
        Feature::Cone {
            diameters: (from, to),
            z,
            angle,
        } => say::measure_cone(from.0, to.0, z.0, z.1, angle),
        Feature::Arc {
            radius,
            diameters: (from, to),
            z,
        } => say::measure_arc(radius, from.0, to.0, z.0, z.1),
        Feature::Thread {
            pitch,
            diameters: (crest, root),
            z,
        } => say::measure_thread(pitch, crest.0, root.0, z.0, z.1),
    }
}

impl CollisionReport {
    fn new(finding: &Finding, language: Option<Language>) -> Self {
        let collision = &finding.collision;
        Self {
            line: finding.source.map(|source| source.line),
            n: finding
                .source
                .and_then(|source| source.sequence.map(u32::from)),
            program: finding.source.map(|source| source.program),
            tool: finding.tool,
            text: said(&collision.message(), language),
            tip: diameter_z(collision.tip),
            contact: diameter_z(collision.contact),
            depth: rounded(collision.depth),
        }
    }

    pub(super) fn message(&self) -> Message {
        let ((x, z), depth) = (self.tip, self.depth);
        match self.line {
            Some(line) => say::report_collision(line, self.tool, &self.text, x, z, depth),
            None => say::report_collision_by_hand(self.tool, &self.text, x, z, depth),
        }
    }
}
