//! Writes the outline of a part that was made, for the author of a task.

use gsk_core::units::Diameter;
use gsk_workpiece::measure::{Feature, SectionSide, measure_features};
use gsk_workpiece::region::Region;

use crate::part_size::nominal_front;

/// Writes the outline of a finished part as the field `outline` of a task file. The uncut end of
/// the part is left out.
pub fn write_outline(section: &Region) -> String {
    let outside = measure_features(section, SectionSide::Outside);
    let bore = measure_features(section, SectionSide::Inside);
    let (pip, front) = nominal_front(&outside);
    let outside = outside.get(pip..).unwrap_or_default();
    let mut text = format!("    outline: (\n        outside: [{}],\n", {
        write_features(outside, front)
    });
    if !bore.is_empty() {
        text += &format!("        bore: [{}],\n", write_features(&bore, front));
    }
    text + "    ),\n"
}

fn last_z(feature: &Feature) -> f64 {
    match *feature {
        Feature::Face { z, .. } => z,
        Feature::Cylinder { z, .. }
        | Feature::Cone { z, .. }
        | Feature::Arc { z, .. }
        | Feature::Thread { z, .. } => z.1,
    }
}

fn write_features(features: &[Feature], front: f64) -> String {
    // The last cylinder is the uncut rest, and the face after it the end of the stock.
    let last = features
        .iter()
        .rposition(|it| matches!(it, Feature::Cylinder { .. }));
    let end = |form: &str, x: Diameter, z: f64, value: Option<f64>| {
        let figure = |value: f64| {
            let rounded = (value * 1000.0).round() / 1000.0;
            // No negative zero.
            format!("{}", rounded + 0.0)
        };
        let value = value.map_or_else(String::new, |value| format!(", {}", figure(value)));
        format!("{form}({}, {}{value})", figure(x.0), figure(z - front))
    };
    let mut ends = Vec::new();
    let mut reached = f64::INFINITY;
    for feature in &features[..last.unwrap_or(features.len())] {
        let (start, stop) = match *feature {
            Feature::Cylinder { diameter, z } => (
                end("Line", diameter, z.0, None),
                end("Line", diameter, z.1, None),
            ),
            Feature::Face { diameters, z } => (
                end("Line", diameters.0, z, None),
                end("Line", diameters.1, z, None),
            ),
            Feature::Cone { diameters, z, .. } => (
                end("Line", diameters.0, z.0, None),
                end("Line", diameters.1, z.1, None),
            ),
            Feature::Arc {
                radius,
                diameters,
                z,
            } => (
                end("Line", diameters.0, z.0, None),
                end("Arc", diameters.1, z.1, Some(radius)),
            ),
            Feature::Thread {
                pitch,
                diameters,
                z,
            } => (
                end("Line", diameters.0, z.0, None),
                end("Thread", diameters.0, z.1, Some(pitch)),
            ),
        };
        // After the part an undercut runs back to the front.
        let z = last_z(feature);
        if z > reached {
            break;
        }
        reached = z;
        if ends.is_empty() {
            ends.push(start);
        }
        ends.push(stop);
    }
    ends.join(", ")
}
