//! Drafts an exercise from a program and its job: the learner writes the program for the part
//! that it makes. The dimensions of the part become criteria.

mod from_part;
mod head;

use std::fmt::Write as _;

pub use from_part::{PartDraft, PickedDimension};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::units::{Diameter, Point, parse_finite};
use gsk_messages::{Message, say};
use gsk_workpiece::job::{DiameterPoint, Job};
use gsk_workpiece::measure::{Feature, SectionSide, measure_features};
use gsk_workpiece::region::Region;
use head::{TaskHead, figure, in_both_languages, write_text};
pub use head::{propose_text, propose_title};

use crate::outline_writer::write_outline;
use crate::part_size::nominal_front;
use crate::solve::{SolutionScript, make_part};
use crate::task::ExerciseTask;

/// Length below which a surface gets no criterion, mm: such surfaces come from the tool nose.
const MIN_LENGTH: f64 = 1.0;
/// Work zero in the start state, machine coordinates, mm: within the travel of the lathe.
const WORK_ZERO: Point = Point::from_diameter(Diameter(-160.0), -220.0);
/// Start point of a program without G50, relative to the work zero, mm.
const USUAL_START: Point = Point::from_diameter(Diameter(100.0), 100.0);
/// Criterion in a drafted task file that is replaced once the part is known.
const PLACEHOLDER: &str = "(id: \"placeholder\", points: 1, yes: (zh: \"-\", en: \"-\"), \
     no: (zh: \"-\", en: \"-\"), rule: NoCrash),";

/// A drafted exercise: the text of its task file, and two solutions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExerciseDraft {
    /// Text of the task file.
    pub task: String,
    /// Script of the solution that reaches all points.
    pub reference: String,
    /// Script of a solution that fails every criterion: a rapid into the stock.
    pub wrong: String,
}

/// Drafts an exercise from a program that cuts a part. `setup` is the control, in which the program
/// is selected.
///
/// # Errors
///
/// No program is selected, it does not run to its end, or it makes no part that can be measured.
pub fn draft_exercise(setup: &Setup, job: &Job) -> Result<ExerciseDraft, Message> {
    let programs = &setup.memory.programs;
    let selected = programs.selected().and_then(|id| programs.get(id));
    let program = selected.ok_or_else(say::file_not_there)?;
    let number = program
        .number()
        .ok_or_else(say::lesson_program_without_number)?;
    let start = find_start(program.text());
    let job = place_job(job);
    // The learner writes the program itself; its subprograms are there.
    let subprograms = setup.memory.programs.iter().filter(|(it, _)| *it != number);
    let head = TaskHead {
        title: propose_title(number),
        text: propose_text(number, &job, start),
        setup,
        job: &job,
        slides: WORK_ZERO + start,
        absolute: start,
        programs: subprograms.map(|(_, it)| it.text()).collect(),
    };
    let head = head.write()?;
    let reference = type_program(program);
    let task = |outline: &str, criteria: &str| {
        format!("{head}{outline}    time_limit: 3600,\n    criteria: [\n{criteria}    ],\n)\n")
    };
    let named =
        |text: &str| ExerciseTask::read("draft", "task.ron", text).map_err(|error| error.message());
    let part = make_part(
        &named(&task("", PLACEHOLDER))?,
        &SolutionScript::read(&reference)?,
    )?;
    let part = part.ok_or_else(say::exercise_outline_no_part)?;
    let criteria = DraftedCriteria::measure(&part);
    if criteria.ids.is_empty() {
        return Err(say::exercise_draft_no_size());
    }
    let text = task(&write_outline(&part), &criteria.text);
    let wrong = format!(
        "# A rapid into the stock.\n# fails: {} no-crash\npress MDI\npress PRG\npress PGDN\n\
         type G0\npress IN\ntype U-400\npress IN\ntype W-400\npress IN\npress CS\nwait 20s\n",
        criteria.ids.join(" ")
    );
    named(&text)?;
    Ok(ExerciseDraft {
        task: text,
        reference,
        wrong,
    })
}

/// Returns the job with the work zero of the start state, and with the tool positions that belong
/// to it.
fn place_job(job: &Job) -> Job {
    let mut job = job.clone();
    job.zero = Some(DiameterPoint {
        x: WORK_ZERO.diameter(),
        z: WORK_ZERO.z,
    });
    for number in job.tools.keys() {
        job.lengths.entry(*number).or_default();
    }
    job
}

/// Returns the position at which the program starts: that of its first G50, else the default.
fn find_start(program: &str) -> Point {
    let set = program.lines().map(without_comments).find_map(|line| {
        let block: String = line.chars().filter(|c| !c.is_whitespace()).collect();
        let words = block.split_once("G50").map(|(_, words)| words.to_owned())?;
        let value = |address: char| {
            let (_, rest) = words.split_once(address)?;
            let end = rest.find(|c: char| c.is_ascii_alphabetic() || c == ';');
            parse_finite(&rest[..end.unwrap_or(rest.len())])
        };
        Some(Point::from_diameter(Diameter(value('X')?), value('Z')?))
    });
    set.unwrap_or(USUAL_START)
}

/// Returns the script lines that type a program in with keys and run it.
fn type_program(program: &Program) -> String {
    let mut script = "press EDIT\npress PRG\n".to_owned();
    for line in program.text().lines() {
        let block: String = without_comments(line)
            .chars()
            .filter(|c| !c.is_whitespace() && *c != ';' && *c != '%')
            .collect();
        if !block.is_empty() {
            // Writing to a string cannot fail.
            let _ = writeln!(script, "type {block}\npress EOB");
        }
    }
    script + "press RESET\nwait 200ms\npress AUTO\npress CS\nwait 1s\nwait idle 3000s\nwait 1s\n"
}

fn without_comments(line: &str) -> String {
    let mut depth = 0_u32;
    let mut kept = String::new();
    for c in line.chars() {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ if depth == 0 => kept.push(c),
            _ => {}
        }
    }
    kept
}

/// The criteria of a drafted part, as text for the task file.
#[derive(Default)]
struct DraftedCriteria {
    text: String,
    ids: Vec<String>,
    /// Least and greatest diameter of each face written so far on one side, mm.
    faces: Vec<(f64, f64)>,
}

impl DraftedCriteria {
    fn measure(part: &Region) -> Self {
        let mut drafted = Self::default();
        let outside = measure_features(part, SectionSide::Outside);
        let (_, front) = nominal_front(&outside);
        for (side, field) in [
            (SectionSide::Outside, ""),
            (SectionSide::Inside, ", surface: Bore"),
        ] {
            let features = measure_features(part, side);
            // The last cylinder is the uncut rest, and the face after it the end of the stock.
            let last = features
                .iter()
                .rposition(|it| matches!(it, Feature::Cylinder { .. }));
            drafted.faces.clear();
            for feature in &features[..last.unwrap_or(0)] {
                drafted.add(feature, front, field);
            }
        }
        if !drafted.ids.is_empty() {
            let sentences = [say::exercise_draft_no_crash(), say::exercise_draft_crash()];
            drafted.push("no-crash", &sentences, "NoCrash");
            drafted.ids.pop();
        }
        drafted
    }

    fn add(&mut self, feature: &Feature, front: f64, field: &str) {
        let middle = |(from, to): (f64, f64)| figure((from + to) / 2.0 - front);
        let is_long = |(from, to): (f64, f64)| from - to >= MIN_LENGTH;
        match *feature {
            Feature::Cylinder { diameter, z } if is_long(z) => {
                let size = figure(diameter.0);
                let rule = format!(
                    "Diameter((z: {}, size: {size}, tolerance: (0.05, -0.05){field}))",
                    middle(z)
                );
                self.add_size("diameter", say::exercise_draft_diameter(), &size, &rule);
            }
            Feature::Face { diameters, z } if front - z > MIN_LENGTH => {
                let (one, other) = (diameters.0.0, diameters.1.0);
                let crossed = (one + other) / 2.0;
                // A length is measured to the first face that crosses its diameter.
                let is_first = !self.faces.iter().any(|it| (it.0..=it.1).contains(&crossed));
                self.faces.push((one.min(other), one.max(other)));
                if !is_first || (one - other).abs() < 2.0 * MIN_LENGTH {
                    return;
                }
                let size = figure(front - z);
                let rule = format!(
                    "Length((diameter: {}, size: {size}, tolerance: (0.1, -0.1){field}))",
                    figure(crossed)
                );
                self.add_size("length", say::exercise_draft_length(), &size, &rule);
            }
            Feature::Cone { z, angle, .. } if is_long(z) => {
                let size = figure(angle);
                let rule = format!(
                    "Angle((z: {}, size: {size}, tolerance: (0.2, -0.2){field}))",
                    middle(z)
                );
                self.add_size("angle", say::exercise_draft_angle(), &size, &rule);
            }
            Feature::Arc { radius, z, .. } if is_long(z) => {
                let size = figure(radius);
                let rule = format!(
                    "Radius((z: {}, size: {size}, tolerance: (0.1, -0.1){field}))",
                    middle(z)
                );
                let size = size.trim_start_matches('-');
                self.add_size("radius", say::exercise_draft_radius(), size, &rule);
            }
            Feature::Thread { pitch, z, .. } => {
                let size = figure(pitch);
                let rule = format!(
                    "Pitch((z: {}, size: {size}, tolerance: (0.01, -0.01){field}))",
                    middle(z)
                );
                self.add_size("pitch", say::exercise_draft_pitch(), &size, &rule);
            }
            _ => {}
        }
    }

    fn add_size(&mut self, kind: &str, name_of_kind: Message, size: &str, rule: &str) {
        let name = format!("{kind}-{}", size.replace('.', "-"));
        let count = self.ids.iter().filter(|id| id.starts_with(&name)).count();
        let id = match count {
            0 => name,
            _ => format!("{name}-no{}", count + 1),
        };
        let sentences = [
            say::exercise_draft_size_good(name_of_kind.clone(), size),
            say::exercise_draft_size_bad(name_of_kind, size),
        ];
        self.push(&id, &sentences, rule);
    }

    fn push(&mut self, id: &str, [yes, no]: &[Message; 2], rule: &str) {
        let [yes, no] = [yes, no].map(|it| write_text(&in_both_languages(it)));
        let _ = writeln!(
            self.text,
            "        (\n            id: \"{id}\", points: 2,\n            yes: {yes},\n            \
             no: {no},\n            rule: {rule},\n        ),"
        );
        self.ids.push(id.to_owned());
    }
}
