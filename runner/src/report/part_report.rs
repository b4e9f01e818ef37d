//! The report on the machined part.

use gsk_core::command::ProgramId;
use gsk_core::units::Diameter;
use gsk_messages::{Language, Message, say};
use gsk_workpiece::measure::{self, Feature, SectionSide};
use serde::Serialize;

use super::message_text;
use crate::machining::{CollisionFinding, CutFault, Machining};
use crate::move_output::{diameter_z, round_to_millionth};

/// The state of the part at the end of a program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartReport {
    /// Name of the job file; `None` for a guessed job.
    pub job: Option<String>,
    /// Volume of the new stock, mm³.
    pub stock_mm3: f64,
    /// Volume that cutting removed, mm³.
    pub removed_mm3: f64,
    /// Volume of the part that remains, mm³.
    pub left_mm3: f64,
    /// The measured features of the outside and then of the bore, each from front to back;
    /// empty if they were not measured.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub features: Vec<Feature>,
    /// The collisions in the order in which they happened.
    pub collisions: Vec<CollisionReport>,
    /// The cuts above the limits that have broken something in the simulated lathe.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub overloads: Vec<OverloadReport>,
}

/// A cut above the limits in a report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OverloadReport {
    /// Line of the block that cuts, from 1; `None` in manual operation.
    pub line: Option<u32>,
    /// The T number of the tool.
    pub tool: u8,
    /// Name of the fault that it causes.
    pub fault: &'static str,
    /// Message text with the limit that is exceeded.
    pub text: String,
}

/// A collision in a report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CollisionReport {
    /// Line of the block that caused the collision, from 1; `None` in manual operation.
    pub line: Option<u32>,
    /// Sequence number of the block; `None` without an N word.
    pub n: Option<u32>,
    /// The program that contains the block; `None` without a block. Not part of the JSON.
    #[serde(skip)]
    pub program: Option<ProgramId>,
    /// The T number of the tool.
    pub tool: u8,
    /// Message text that names the parts that touched.
    pub text: String,
    /// Position of the tool tip at the first contact: X as a diameter and Z, part coordinates,
    /// mm.
    pub tip: (f64, f64),
    /// Position of the contact: X as a diameter and Z, part coordinates, mm.
    pub contact: (f64, f64),
    /// Greatest depth of the overlap, mm.
    pub depth: f64,
}

impl PartReport {
    /// Creates the report on the current part. `job` is the name of the job file; with
    /// `measure` the features of the part are measured.
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
                    .map(round_to_micrometre)
                    .collect()
            }
            false => Vec::new(),
        };
        Self {
            job,
            stock_mm3: round_to_millionth(machining.scene().stock().section().volume()),
            removed_mm3: round_to_millionth(machining.removed_volume()),
            left_mm3: round_to_millionth(machining.scene().part().volume()),
            features,
            collisions: machining
                .findings()
                .iter()
                .map(|finding| CollisionReport::new(finding, language))
                .collect(),
            overloads: Vec::new(),
        }
    }

    /// Adds the cuts above the limits.
    #[must_use]
    pub fn with_overloads(mut self, cuts: &[CutFault], language: Option<Language>) -> Self {
        let reports = cuts.iter().map(|cut| OverloadReport {
            line: cut.source.map(|source| source.line),
            tool: cut.tool,
            fault: cut.fault().row().name,
            text: message_text(&cut.message(), language),
        });
        self.overloads = reports.collect();
        self
    }

    /// Returns the report as lines of text for the user, in the language `words`.
    pub(super) fn text_lines(&self, words: Language) -> Vec<String> {
        let part = match &self.job {
            Some(job) => say::report_part(job, self.removed_mm3, self.left_mm3),
            None => say::report_part_guessed(self.removed_mm3, self.left_mm3),
        };
        let collisions = self.collisions.iter().map(CollisionReport::message);
        let overloads = self.overloads.iter().map(OverloadReport::message);
        let features = self.features.iter().map(feature_message);
        core::iter::once(part)
            .chain(features)
            .chain(collisions)
            .chain(overloads)
            .map(|message| message.text(words))
            .collect()
    }
}

/// Rounds the values of a feature as on a drawing: lengths to micrometres, angles to
/// thousandths of a degree.
fn round_to_micrometre(feature: Feature) -> Feature {
    let round = |value: f64| (value * 1000.0).round() / 1000.0;
    let both = |(from, to): (f64, f64)| (round(from), round(to));
    let across =
        |(from, to): (Diameter, Diameter)| (Diameter(round(from.0)), Diameter(round(to.0)));
    match feature {
        Feature::Cylinder { diameter, z } => Feature::Cylinder {
            diameter: Diameter(round(diameter.0)),
            z: both(z),
        },
        Feature::Face { diameters, z } => Feature::Face {
            diameters: across(diameters),
            z: round(z),
        },
        Feature::Cone {
            diameters,
            z,
            angle,
        } => Feature::Cone {
            diameters: across(diameters),
            z: both(z),
            angle: round(angle),
        },
        Feature::Arc {
            radius,
            diameters,
            z,
        } => Feature::Arc {
            radius: round(radius),
            diameters: across(diameters),
            z: both(z),
        },
        Feature::Thread {
            pitch,
            diameters,
            z,
        } => Feature::Thread {
            pitch: round(pitch),
            diameters: across(diameters),
            z: both(z),
        },
    }
}

/// Returns the message with the measured values of a feature, for the user.
pub fn feature_message(feature: &Feature) -> Message {
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

impl OverloadReport {
    fn message(&self) -> Message {
        let text = say::as_written(&self.text);
        match self.line {
            Some(line) => say::in_line(line, text),
            None => text,
        }
    }
}

impl CollisionReport {
    fn new(finding: &CollisionFinding, language: Option<Language>) -> Self {
        let collision = &finding.collision;
        Self {
            line: finding.source.map(|source| source.line),
            n: finding
                .source
                .and_then(|source| source.sequence.map(u32::from)),
            program: finding.source.map(|source| source.program),
            tool: finding.tool,
            text: message_text(&collision.message(), language),
            tip: diameter_z(collision.tip),
            contact: diameter_z(collision.contact),
            depth: round_to_millionth(collision.depth),
        }
    }

    pub(crate) fn message(&self) -> Message {
        let ((x, z), depth) = (self.tip, self.depth);
        match self.line {
            Some(line) => say::report_collision(line, self.tool, &self.text, x, z, depth),
            None => say::report_collision_by_hand(self.tool, &self.text, x, z, depth),
        }
    }
}
