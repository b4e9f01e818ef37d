//! Drafts an exercise from the part in the lathe: the dimensions that a teacher has picked with
//! the caliper become criteria.

use gsk_core::command::ProgramId;
use gsk_core::model::ModelId;
use gsk_core::setup::Setup;
use gsk_lesson::LessonText;
use gsk_messages::{Message, say};
use gsk_workpiece::job::{DiameterPoint, Job};
use gsk_workpiece::measure::{Feature, SectionSide, measure_features};
use gsk_workpiece::region::Region;

use super::head::{TaskHead, figure, in_both_languages, write_text};
use crate::criterion::{PartDimension, PartSurface};
use crate::drawing::check_outline;
use crate::outline_writer::write_outline;
use crate::part_size::{front_z, measure_dimension};
use crate::task::ExerciseTask;

/// A dimension of the part that the teacher has selected, with its tolerance and points.
#[derive(Clone, Debug, PartialEq)]
pub struct PickedDimension {
    /// Kind and position of the dimension on the part.
    pub dimension: PartDimension,
    /// Nominal size on the drawing, mm or degrees.
    pub size: f64,
    /// Upper deviation from the nominal size, mm or degrees.
    pub upper: f64,
    /// Lower deviation from the nominal size, mm or degrees; negative if the size may be less.
    pub lower: f64,
    /// Points that the dimension gives.
    pub points: u32,
}

/// Greatest difference between two measurements that count as the same face, mm.
const SAME_FACE: f64 = 0.001;
/// Default number of points of a selected dimension.
const USUAL_POINTS: u32 = 2;

impl PickedDimension {
    /// Returns the dimension of a feature of the part, with its measured size and a default
    /// tolerance; `None` for the front face, from which lengths are measured, and for a face that
    /// another one hides.
    pub fn from_feature(section: &Region, feature: &Feature) -> Option<Self> {
        let outside = measure_features(section, SectionSide::Outside);
        let front = front_z(&outside)?;
        let surface = match outside.contains(feature) {
            true => PartSurface::Outside,
            false => PartSurface::Bore,
        };
        let middle = |(from, to): (f64, f64)| round((from + to) / 2.0 - front);
        let (dimension, tolerance) = match *feature {
            Feature::Cylinder { z, .. } => {
                let z = middle(z);
                (PartDimension::Diameter { z, surface }, 0.05)
            }
            Feature::Face { diameters, .. } => {
                let diameter = round((diameters.0.0 + diameters.1.0) / 2.0);
                (PartDimension::Length { diameter, surface }, 0.1)
            }
            Feature::Cone { z, .. } => {
                let z = middle(z);
                (PartDimension::Angle { z, surface }, 0.2)
            }
            Feature::Arc { z, .. } => {
                let z = middle(z);
                (PartDimension::Radius { z, surface }, 0.1)
            }
            Feature::Thread { z, .. } => {
                let z = middle(z);
                (PartDimension::Pitch { z, surface }, 0.01)
            }
        };
        let size = measure_dimension(section, &dimension)?;
        // A length is measured to the first face that crosses its diameter: another one may.
        if let Feature::Face { z, .. } = *feature
            && (front - z - size).abs() > SAME_FACE
        {
            return None;
        }
        Some(Self {
            dimension,
            size: round(size),
            upper: tolerance,
            lower: -tolerance,
            points: USUAL_POINTS,
        })
    }

    /// Returns the name of the kind of dimension, such as diameter or length.
    pub fn kind(&self) -> Message {
        match self.dimension {
            PartDimension::Diameter { .. } => say::exercise_draft_diameter(),
            PartDimension::Length { .. } | PartDimension::Width { .. } => {
                say::exercise_draft_length()
            }
            PartDimension::Angle { .. } => say::exercise_draft_angle(),
            PartDimension::Radius { .. } => say::exercise_draft_radius(),
            PartDimension::Pitch { .. } | PartDimension::ThreadDepth { .. } => {
                say::exercise_draft_pitch()
            }
        }
    }

    /// Returns the name of the rule in the task file, the name of its position field, the value of
    /// that field, mm, and the surface.
    const fn rule(&self) -> (&'static str, &'static str, f64, PartSurface) {
        match self.dimension {
            PartDimension::Diameter { z, surface } => ("Diameter", "z", z, surface),
            PartDimension::Length { diameter, surface } => {
                ("Length", "diameter", diameter, surface)
            }
            PartDimension::Width { z, surface } => ("Width", "z", z, surface),
            PartDimension::Angle { z, surface } => ("Angle", "z", z, surface),
            PartDimension::Radius { z, surface } => ("Radius", "z", z, surface),
            PartDimension::Pitch { z, surface } => ("Pitch", "z", z, surface),
            PartDimension::ThreadDepth { z, surface } => ("ThreadDepth", "z", z, surface),
        }
    }

    fn write(&self, id: &str) -> String {
        let (name, field, position, surface) = self.rule();
        let surface = match surface {
            PartSurface::Outside => "",
            PartSurface::Bore => ", surface: Bore",
        };
        let size = figure(self.size.abs());
        let sentences = [
            say::exercise_draft_size_good(self.kind(), &size),
            say::exercise_draft_size_bad(self.kind(), &size),
        ];
        let [yes, no] = sentences.map(|it| write_text(&in_both_languages(&it)));
        format!(
            "        (\n            id: {id:?}, points: {},\n            yes: {yes},\n            \
             no: {no},\n            rule: {name}(({field}: {}, size: {}, \
             tolerance: ({}, {}){surface})),\n        ),\n",
            self.points,
            figure(position),
            figure(self.size),
            figure(self.upper),
            figure(self.lower),
        )
    }
}

/// The data from which an exercise is written: the teacher's machine, the part, and the texts that
/// the teacher has typed.
#[derive(Clone, Debug)]
pub struct PartDraft<'a> {
    /// Title of the exercise.
    pub title: LessonText,
    /// The task of the learner, as text.
    pub text: LessonText,
    /// Machine time after which the solution ends, minutes.
    pub time_limit_min: u32,
    /// The control with its programs, offsets and parameters, and the position of the slides.
    pub setup: &'a Setup,
    /// Stock and tools that the learner gets.
    pub job: &'a Job,
    /// Half section of the finished part.
    pub section: &'a Region,
    /// The selected dimensions, each of which becomes a criterion.
    pub dimensions: &'a [PickedDimension],
    /// Whether the learner gets the selected program; otherwise the learner writes it.
    pub gives_program: bool,
}

impl PartDraft<'_> {
    /// Writes the file of the task.
    ///
    /// # Errors
    /// No dimension is picked, or a value breaks a rule of the file.
    pub fn write(&self) -> Result<String, Message> {
        if self.dimensions.is_empty() {
            return Err(say::exercise_draft_no_pick());
        }
        if self.setup.memory.model.id() != ModelId::Gsk980td {
            return Err(say::exercise_draft_model());
        }
        let slides = self.setup.start.unwrap_or_default();
        let absolute = self.setup.absolute.unwrap_or(slides);
        let mut job = self.job.clone();
        // The position of the part in the task is that which it has now.
        job.zero
            .get_or_insert_with(|| DiameterPoint::from(slides - absolute));
        let head = TaskHead {
            title: self.title.clone(),
            text: self.text.clone(),
            setup: self.setup,
            job: &job,
            slides,
            absolute,
            programs: self.stored_programs(),
        };
        let (head, outline) = (head.write()?, write_outline(self.section));
        let (limit_s, criteria) = (self.time_limit_min * 60, self.write_criteria());
        let write = |outline: &str| {
            format!(
                "{head}{outline}    time_limit: {limit_s},\n    criteria: [\n{criteria}    ],\n)\n"
            )
        };
        let drawn = write(&outline);
        let task = ExerciseTask::read("draft", "task.ron", &drawn);
        // Sizes that the teacher has changed are not those of his part: no drawing shows both.
        match check_outline(&task.map_err(|error| error.message())?).is_empty() {
            true => Ok(drawn),
            false => Ok(write("")),
        }
    }

    /// Returns the texts of the programs that the learner gets, the selected one first.
    fn stored_programs(&self) -> Vec<&str> {
        let programs = &self.setup.memory.programs;
        let selected = match programs.selected() {
            Some(ProgramId::Stored(number)) => Some(number),
            _ => None,
        };
        let (own, others): (Vec<_>, Vec<_>) = programs
            .iter()
            .partition(|(number, _)| Some(*number) == selected);
        let own = own.into_iter().filter(|_| self.gives_program);
        own.chain(others).map(|(_, it)| it.text()).collect()
    }

    fn write_criteria(&self) -> String {
        let mut text = String::new();
        let mut ids: Vec<String> = Vec::new();
        for picked in self.dimensions {
            let (kind, ..) = picked.rule();
            let size = figure(picked.size.abs()).replace('.', "-");
            let name = format!("{}-{size}", kind.to_ascii_lowercase());
            let mut id = name.clone();
            let mut number = 1;
            while ids.contains(&id) {
                number += 1;
                id = format!("{name}-no{number}");
            }
            text.push_str(&picked.write(&id));
            ids.push(id);
        }
        text
    }
}

fn round(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}
