//! Measures a dimension of the part in the same way as `check --measure`.

use gsk_workpiece::measure::{Feature, SectionSide, measure_features};
use gsk_workpiece::region::Region;

use crate::criterion::{CriterionRule, PartDimension, PartSurface, TolerancedSize};
use crate::outline::locate;
use crate::task::ExerciseTask;

/// A dimension of the drawing with its measured size on the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredSize {
    /// Index in the task of the criterion to which the dimension belongs.
    pub criterion: usize,
    /// Kind and position of the dimension.
    pub dimension: PartDimension,
    /// The size on the drawing with its limits, mm or degrees.
    pub size: TolerancedSize,
    /// The measured size on the part, mm or degrees; `None` if the part does not have the
    /// dimension.
    pub measured: Option<f64>,
}

impl MeasuredSize {
    /// Returns whether the part has the dimension within its limits.
    pub fn is_met(&self) -> bool {
        self.measured.is_some_and(|it| self.size.contains(it))
    }
}

/// Measures the dimensions that a task marks on the half section of a part.
pub fn measure_sizes(task: &ExerciseTask, section: &Region) -> Vec<MeasuredSize> {
    let criteria = task.criteria.iter().enumerate();
    let sizes = criteria.filter_map(|(index, criterion)| match &criterion.rule {
        CriterionRule::Size(dimension, size) => Some(MeasuredSize {
            criterion: index,
            dimension: *dimension,
            size: *size,
            measured: measure_dimension(section, dimension)
                .filter(|_| is_made(task, section, dimension)),
        }),
        _ => None,
    });
    sizes.collect()
}

/// Greatest difference in diameter between part and drawing at which a cylinder counts as made, mm.
const MADE_TOLERANCE: f64 = 0.5;

/// Whether the cylinder whose width is measured exists on the part: before a groove is cut, the
/// uncut cylinder is at its position. Without a drawing every cylinder counts.
fn is_made(task: &ExerciseTask, section: &Region, dimension: &PartDimension) -> bool {
    let (PartDimension::Width { z, surface }, Some(outline)) = (*dimension, &task.outline) else {
        return true;
    };
    let diameter = PartDimension::Diameter { z, surface };
    let drawn = locate(outline, &diameter).and_then(|(_, drawn)| drawn);
    let measured = measure_dimension(section, &diameter);
    drawn
        .zip(measured)
        .is_none_or(|(drawn, measured)| (drawn - measured).abs() <= MADE_TOLERANCE)
}

/// Measures a dimension on a half section, mm or degrees; returns `None` if the part does not have
/// it.
pub fn measure_dimension(section: &Region, dimension: &PartDimension) -> Option<f64> {
    let front = front_z(&measure_features(section, SectionSide::Outside))?;
    let features = |surface: PartSurface| {
        let side = match surface {
            PartSurface::Outside => SectionSide::Outside,
            PartSurface::Bore => SectionSide::Inside,
        };
        measure_features(section, side).into_iter()
    };
    match *dimension {
        PartDimension::Diameter { z, surface } => features(surface).find_map(|it| match it {
            Feature::Cylinder { diameter, z: ends } => contains(ends, front + z, diameter.0),
            _ => None,
        }),
        PartDimension::Width { z, surface } => features(surface).find_map(|it| match it {
            Feature::Cylinder { z: ends, .. } => contains(ends, front + z, ends.0 - ends.1),
            _ => None,
        }),
        PartDimension::Angle { z, surface } => features(surface).find_map(|it| match it {
            Feature::Cone { z: ends, angle, .. } => contains(ends, front + z, angle),
            _ => None,
        }),
        PartDimension::Radius { z, surface } => features(surface).find_map(|it| match it {
            Feature::Arc {
                z: ends, radius, ..
            } => contains(ends, front + z, radius),
            _ => None,
        }),
        PartDimension::Pitch { z, surface } => features(surface).find_map(|it| match it {
            Feature::Thread { z: ends, pitch, .. } => contains(ends, front + z, pitch),
            _ => None,
        }),
        PartDimension::ThreadDepth { z, surface } => features(surface).find_map(|it| match it {
            Feature::Thread {
                z: ends, diameters, ..
            } => contains(ends, front + z, (diameters.0.0 - diameters.1.0).abs() / 2.0),
            _ => None,
        }),
        PartDimension::Length { diameter, surface } => features(surface).find_map(|it| match it {
            Feature::Face { diameters, z } => {
                let ends = (diameters.0.0, diameters.1.0);
                // The front face is where the length begins.
                contains(ends, diameter, front - z).filter(|length| *length > 0.001)
            }
            _ => None,
        }),
    }
}

/// Returns `value` if `position` is between both ends, else `None`.
fn contains(ends: (f64, f64), position: f64, value: f64) -> Option<f64> {
    let (low, high) = (ends.0.min(ends.1), ends.0.max(ends.1));
    (low..=high).contains(&position).then_some(value)
}

/// Greatest height of the pip that a tool leaves at the axis of the front face, mm.
const MAX_PIP: f64 = 0.2;

/// Returns the front face as on a drawing, without the pip that the tool leaves at the axis: the
/// number of features of the pip, and z of the face, mm. `features` are those of the outside.
pub(crate) fn nominal_front(features: &[Feature]) -> (usize, f64) {
    let Some(front) = front_z(features) else {
        return (0, 0.0);
    };
    let face = features
        .iter()
        .enumerate()
        .rev()
        .find_map(|(index, it)| match *it {
            Feature::Face { z, .. } if z > front - MAX_PIP => Some((index, z)),
            _ => None,
        });
    face.unwrap_or((0, front))
}

/// Returns z of the front end of the part, mm, from the features of its outside; `None` if there
/// are none.
pub(crate) fn front_z(features: &[Feature]) -> Option<f64> {
    features.first().map(|first| match *first {
        Feature::Face { z, .. } => z,
        Feature::Cylinder { z, .. }
        | Feature::Cone { z, .. }
        | Feature::Arc { z, .. }
        | Feature::Thread { z, .. } => z.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::{SolutionScript, make_part};

    const GROOVE: &str = include_str!("../../assets/exercises/18-groove/task.ron");
    const REFERENCE: &str = include_str!("../../assets/exercises/18-groove/reference.txt");

    #[test]
    fn the_width_of_a_groove_is_shown_when_the_groove_is_cut() {
        let task = ExerciseTask::read("18-groove", "18-groove", GROOVE).expect("a task");
        let width = |script: &str| {
            let script = SolutionScript::read(script).expect("a solution");
            let part = make_part(&task, &script).expect("plays").expect("a part");
            let dimension = PartDimension::Width {
                z: -18.5,
                surface: PartSurface::Outside,
            };
            let sizes = measure_sizes(&task, &part);
            let size = sizes.iter().find(|size| size.dimension == dimension);
            let uncut = measure_dimension(&part, &dimension);
            (uncut, size.expect("the width").measured)
        };
        let (uncut, shown) = width("wait 1s\n");
        assert!(uncut.is_some_and(|it| it > 50.0), "the bar is there");
        assert_eq!(shown, None);
        let (cut, shown) = width(REFERENCE);
        assert!(cut.is_some() && cut == shown, "{cut:?} {shown:?}");
    }
}
