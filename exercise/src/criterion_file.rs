//! The criteria of a task as written in its file, and their rules.

use gsk_core::machine::LatheFault;
use gsk_lesson::LessonText;
use gsk_messages::{Message, say};
use gsk_panel::script::{Expectation, ExpectedState};
use serde::Deserialize;

use crate::criterion::{
    CriterionRule, ExerciseCriterion, MachineCondition, PartDimension, PartSurface, TolerancedSize,
};

/// Greatest dimension of a part, mm, and greatest angle, degrees, that a task file may contain.
const MAX_SIZE: f64 = 5000.0;
/// Greatest number of points that one criterion may give.
const MAX_POINTS: u32 = 1000;
/// Longest time that a task file may contain, s: ten hours.
pub(crate) const MAX_TIME_S: f64 = 36_000.0;

/// A criterion as written in the task file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CriterionFile {
    pub(crate) id: String,
    points: u32,
    yes: LessonText,
    no: LessonText,
    rule: RuleFile,
}

/// The surface of a dimension, outside or bore, as written in the task file.
#[derive(Clone, Copy, Default, Deserialize)]
enum SurfaceFile {
    #[default]
    Outside,
    Bore,
}

/// A dimension at a position along the part, as written in the task file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SizeAtZ {
    /// Distance from the front of the part, mm.
    z: f64,
    size: f64,
    /// Upper and lower deviation from the nominal size, mm or degrees.
    tolerance: (f64, f64),
    #[serde(default)]
    surface: SurfaceFile,
}

/// A length from the front of the part, as written in the task file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LengthFile {
    /// Diameter at which the position of the face is measured, mm.
    diameter: f64,
    size: f64,
    tolerance: (f64, f64),
    #[serde(default)]
    surface: SurfaceFile,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct VariableFile {
    number: u16,
    from: f64,
    to: f64,
}

/// The rule of a criterion as written in the task file.
#[derive(Deserialize)]
enum RuleFile {
    Diameter(SizeAtZ),
    Length(LengthFile),
    Width(SizeAtZ),
    Angle(SizeAtZ),
    Radius(SizeAtZ),
    Pitch(SizeAtZ),
    ThreadDepth(SizeAtZ),
    AtEnd(Vec<String>),
    Reached(Vec<String>),
    InOrder(Vec<Vec<String>>),
    WorksAfterRepair(Vec<Vec<String>>),
    Never(Vec<String>),
    Variable(VariableFile),
    ReferencedBeforeStart,
    ToolMeasured(u8),
    TriedBeforeCut,
    NoCrash,
    NoAlarm,
    NoIgnoredAlarm,
    Within(f64),
    FirstRepair(String),
    Repaired(String),
    RepairedWhile(Vec<String>),
}

/// Checks a criterion of the task file and returns it.
///
/// # Errors
///
/// The message names the rule that the criterion breaks.
pub(crate) fn read_criterion(raw: CriterionFile) -> Result<ExerciseCriterion, Message> {
    let is_word = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    if raw.id.is_empty() || !raw.id.chars().all(is_word) {
        return Err(say::exercise_bad_id(&raw.id));
    }
    if raw.points == 0 || raw.points > MAX_POINTS {
        return Err(say::exercise_bad_points(raw.points, MAX_POINTS));
    }
    check_text(&raw.yes)?;
    check_text(&raw.no)?;
    Ok(ExerciseCriterion {
        id: raw.id,
        points: raw.points,
        yes: raw.yes,
        no: raw.no,
        rule: read_rule(raw.rule)?,
    })
}

/// Checks that a text is not empty in either language.
///
/// # Errors
///
/// A language is missing.
pub(crate) fn check_text(text: &LessonText) -> Result<(), Message> {
    match text.zh.trim().is_empty() || text.en.trim().is_empty() {
        true => Err(say::lesson_text_missing()),
        false => Ok(()),
    }
}

/// Parses the name of a lathe fault.
///
/// # Errors
///
/// The name is unknown.
pub(crate) fn read_fault(name: &str) -> Result<LatheFault, Message> {
    LatheFault::from_name(name).ok_or_else(|| {
        let names = LatheFault::ALL.map(|(name, _)| name);
        say::exercise_unknown_fault(name, names.join(" "))
    })
}

fn read_rule(raw: RuleFile) -> Result<CriterionRule, Message> {
    Ok(match raw {
        RuleFile::Diameter(size) => {
            size_rule(&size, |z, surface| PartDimension::Diameter { z, surface })?
        }
        RuleFile::Width(size) => {
            size_rule(&size, |z, surface| PartDimension::Width { z, surface })?
        }
        RuleFile::Angle(size) => {
            size_rule(&size, |z, surface| PartDimension::Angle { z, surface })?
        }
        RuleFile::Radius(size) => {
            size_rule(&size, |z, surface| PartDimension::Radius { z, surface })?
        }
        RuleFile::Pitch(size) => {
            size_rule(&size, |z, surface| PartDimension::Pitch { z, surface })?
        }
        RuleFile::ThreadDepth(size) => size_rule(&size, |z, surface| PartDimension::ThreadDepth {
            z,
            surface,
        })?,
        RuleFile::Length(length) => {
            let dimension = PartDimension::Length {
                diameter: length.diameter,
                surface: read_surface(length.surface),
            };
            CriterionRule::Size(dimension, read_size(length.size, length.tolerance)?)
        }
        RuleFile::AtEnd(conditions) => CriterionRule::AtEnd(read_conditions(&conditions)?),
        RuleFile::Reached(conditions) => CriterionRule::Reached(read_conditions(&conditions)?),
        RuleFile::Never(conditions) => CriterionRule::Never(read_conditions(&conditions)?),
        RuleFile::RepairedWhile(conditions) => {
            CriterionRule::RepairedWhile(read_conditions(&conditions)?)
        }
        RuleFile::InOrder(groups) => {
            if groups.len() < 2 {
                return Err(say::exercise_order_of_one());
            }
            CriterionRule::InOrder(read_groups(&groups)?)
        }
        RuleFile::WorksAfterRepair(groups) => {
            if groups.is_empty() {
                return Err(say::lesson_without_end());
            }
            CriterionRule::WorksAfterRepair(read_groups(&groups)?)
        }
        RuleFile::Variable(variable) => {
            if variable.from > variable.to {
                return Err(say::exercise_empty_range(variable.from, variable.to));
            }
            CriterionRule::Variable {
                number: variable.number,
                range: (variable.from, variable.to),
            }
        }
        RuleFile::ReferencedBeforeStart => CriterionRule::ReferencedBeforeStart,
        RuleFile::ToolMeasured(number) => CriterionRule::ToolMeasured(number),
        RuleFile::TriedBeforeCut => CriterionRule::TriedBeforeCut,
        RuleFile::NoCrash => CriterionRule::NoCrash,
        RuleFile::NoAlarm => CriterionRule::NoAlarm,
        RuleFile::NoIgnoredAlarm => CriterionRule::NoIgnoredAlarm,
        RuleFile::Within(seconds) => CriterionRule::Within(read_time_ms(seconds)?),
        RuleFile::FirstRepair(name) => CriterionRule::FirstRepair(read_fault(&name)?),
        RuleFile::Repaired(name) => CriterionRule::Repaired(read_fault(&name)?),
    })
}

fn read_groups(groups: &[Vec<String>]) -> Result<Vec<Vec<MachineCondition>>, Message> {
    let groups = groups.iter().map(|group| read_conditions(group));
    groups.collect()
}

/// Converts a time of the task file from s to ms.
///
/// # Errors
///
/// The time is below 1 s or above ten hours.
pub(crate) fn read_time_ms(seconds: f64) -> Result<u64, Message> {
    match (1.0..=MAX_TIME_S).contains(&seconds) {
        true => Ok((seconds * 1000.0) as u64),
        false => Err(say::exercise_bad_time(seconds, MAX_TIME_S)),
    }
}

fn size_rule(
    raw: &SizeAtZ,
    dimension: impl Fn(f64, PartSurface) -> PartDimension,
) -> Result<CriterionRule, Message> {
    // Positions are negative, as on the drawing: the front of the part is 0.
    if !(-MAX_SIZE..=0.0).contains(&raw.z) {
        return Err(say::exercise_bad_z(raw.z));
    }
    let size = read_size(raw.size, raw.tolerance)?;
    let dimension = dimension(raw.z, read_surface(raw.surface));
    Ok(CriterionRule::Size(dimension, size))
}

fn read_size(nominal: f64, (upper, lower): (f64, f64)) -> Result<TolerancedSize, Message> {
    let is_wrong = !nominal.is_finite()
        || nominal.abs() > MAX_SIZE
        || !upper.is_finite()
        || !lower.is_finite()
        || upper < lower;
    if is_wrong {
        return Err(say::exercise_bad_size(nominal, upper, lower));
    }
    Ok(TolerancedSize {
        nominal,
        max: nominal + upper,
        min: nominal + lower,
    })
}

const fn read_surface(raw: SurfaceFile) -> PartSurface {
    match raw {
        SurfaceFile::Outside => PartSurface::Outside,
        SurfaceFile::Bore => PartSurface::Bore,
    }
}

fn read_conditions(texts: &[String]) -> Result<Vec<MachineCondition>, Message> {
    if texts.is_empty() {
        return Err(say::lesson_without_end());
    }
    let conditions = texts.iter().map(|text| {
        let expectation =
            Expectation::parse(text).map_err(|error| say::subject_reason(text, error.message()))?;
        if reads_screen(&expectation) {
            return Err(say::exercise_reads_screen(text));
        }
        Ok(MachineCondition {
            text: text.clone(),
            expectation,
        })
    });
    conditions.collect()
}

/// Whether an expectation checks the LCD; criteria must not depend on the LCD.
fn reads_screen(expectation: &Expectation) -> bool {
    match expectation {
        Expectation::Row(..)
        | Expectation::State(ExpectedState::Screen(_) | ExpectedState::Page(_)) => true,
        Expectation::Not(inner) => reads_screen(inner),
        _ => false,
    }
}
