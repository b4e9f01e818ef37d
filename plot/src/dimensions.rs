//! Dimensions the part as a drawing does: diameters, radii, angles and pitches on the material
//! next to their surface, and the Z of its shoulders below the spindle axis.
//!
//! ```text
//!        +------+
//!        | ⌀30  |______
//!        |      | ⌀20  |
//!   -.-.-|-.-.-.|-.-.-.|-.-
//!        |      |      |
//!      -50    -20      0
//! ```

use gsk_core::units::{Diameter, Point};
use gsk_workpiece::measure::{Feature, MeasuredFeature, SectionSide, measure_with_outlines};
use gsk_workpiece::region::Region;

use crate::number_placement::{HEIGHT, OccupancyMap};
use crate::text_width::text_width;

/// Gap between a surface or a line and its text, picture units.
const TEXT_GAP: f64 = 5.0;
/// Number of text rows below the spindle axis for the Z values of shoulders.
const SHOULDER_ROWS: u32 = 3;
/// Height of the area below the spindle axis for the Z values of shoulders, picture units.
pub(super) const BELOW_AXIS: f64 = 2.0 * TEXT_GAP + SHOULDER_ROWS as f64 * HEIGHT;
/// Least distance between two shoulders that both get a Z value, picture units.
const MIN_SHOULDER_DISTANCE: f64 = 6.0;
/// Length below which a surface gets no text, picture units: it comes from a tool nose and not
/// from the drawing.
const MIN_SURFACE_LENGTH: f64 = 14.0;
/// Difference up to which an angle counts as 45°, degrees.
const ANGLE_TOLERANCE_DEG: f64 = 0.001;

/// The surfaces and shoulders of a part that get dimensions in a picture.
#[derive(Clone, Debug, Default)]
pub(super) struct Dimensions {
    surfaces: Vec<DimensionedSurface>,
    /// Points whose Z is written below the axis: the ends of faces, then those of other
    /// surfaces.
    shoulders: Vec<Point>,
}

/// A surface and the text of its dimension.
#[derive(Clone, Debug)]
struct DimensionedSurface {
    ends: [Point; 2],
    middle: Point,
    /// Whether the surface is on the outside of the part or in its bore.
    side: SectionSide,
    text: String,
}

/// A dimension with its position in the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// Upper left corner of the text, picture units.
    pub corner: (f64, f64),
    /// The text of the dimension: `⌀20`, `R5`, `-50`.
    pub text: String,
    /// Ends of the line from a shoulder to its text, picture units; `None` for a text on a
    /// surface.
    pub line: Option<[(f64, f64); 2]>,
}

impl Dimensions {
    /// Finds the surfaces and shoulders of a half section that get dimensions.
    pub fn measure(section: &Region) -> Self {
        let mut found = Self::default();
        let sides = [SectionSide::Outside, SectionSide::Inside];
        let measured = sides.map(|side| (side, measure_with_outlines(section, side)));
        let all = || {
            let each = measured.iter();
            each.flat_map(|(side, surfaces)| surfaces.iter().map(|it| (*side, it)))
        };
        // Where a nose has rounded a corner, the face is the intended shoulder.
        let is_face = |surface: &MeasuredFeature| matches!(surface.feature, Feature::Face { .. });
        for (side, surface) in all().filter(|(_, it)| is_face(it)) {
            found.add_surface(surface, side);
        }
        for (side, surface) in all().filter(|(_, it)| !is_face(it)) {
            found.add_surface(surface, side);
        }
        found
    }

    fn add_surface(&mut self, surface: &MeasuredFeature, side: SectionSide) {
        let outline = &surface.outline;
        let (Some(first), Some(last)) = (outline.first(), outline.last()) else {
            return;
        };
        if let Some(words) = dimension_text(&surface.feature) {
            self.surfaces.push(DimensionedSurface {
                ends: [*first, *last],
                middle: outline_middle(outline),
                side,
                text: words,
            });
        }
        self.shoulders.extend([*first, *last]);
    }

    /// Whether the part has no dimensions to draw.
    pub const fn is_empty(&self) -> bool {
        self.surfaces.is_empty() && self.shoulders.is_empty()
    }

    /// Places the dimensions where the picture has free space; others are omitted. `to_units`
    /// converts a point in mm to picture units; `taken` marks the used space.
    pub fn place_all(
        &self,
        to_units: impl Fn(Point) -> (f64, f64),
        taken: &mut OccupancyMap,
    ) -> Vec<Dimension> {
        let mut drawn = Vec::new();
        for surface in &self.surfaces {
            let [from, to] = surface.ends.map(&to_units);
            if libm::hypot(to.0 - from.0, to.1 - from.1) < MIN_SURFACE_LENGTH {
                continue;
            }
            let ((x, y), wide) = (to_units(surface.middle), text_width(&surface.text));
            // Y grows downwards.
            let y = match surface.side {
                SectionSide::Outside => y + TEXT_GAP,
                SectionSide::Inside => y - TEXT_GAP - HEIGHT,
            };
            let left = x - wide / 2.0;
            if taken.occupy((left, y, left + wide, y + HEIGHT)) {
                drawn.push(Dimension {
                    corner: (left, y),
                    text: surface.text.clone(),
                    line: None,
                });
            }
        }
        let mut used_positions: Vec<f64> = Vec::new();
        for point in &self.shoulders {
            let (x, from) = to_units(*point);
            if used_positions
                .iter()
                .any(|other| (other - x).abs() < MIN_SHOULDER_DISTANCE)
            {
                continue;
            }
            used_positions.push(x);
            let axis = to_units(Point::new(0.0, point.z)).1;
            let words = format_figure(point.z);
            let half = text_width(&words) / 2.0;
            let rows = (0..SHOULDER_ROWS).map(|row| axis + TEXT_GAP + HEIGHT * f64::from(row));
            let row = rows.into_iter().find(|top| {
                let around = (x - half - TEXT_GAP, *top, x + half + TEXT_GAP, top + HEIGHT);
                taken.occupy(around)
            });
            if let Some(top) = row {
                drawn.push(Dimension {
                    corner: (x - half, top),
                    text: words,
                    line: Some([(x, from), (x, top)]),
                });
            }
        }
        drawn
    }
}

/// The text of the dimension of a surface, `⌀20` for example. `None` for a face: its ends give
/// its Z.
fn dimension_text(feature: &Feature) -> Option<String> {
    let across = |Diameter(value): Diameter| format_figure(value);
    match *feature {
        Feature::Cylinder { diameter, .. } => Some(format!("⌀{}", across(diameter))),
        Feature::Face { .. } => None,
        Feature::Cone { z, angle, .. } => Some(match (angle - 45.0).abs() < ANGLE_TOLERANCE_DEG {
            true => format!("{}×45°", format_figure((z.0 - z.1).abs())),
            false => format!("{}°", format_figure(angle)),
        }),
        Feature::Arc { radius, .. } => Some(format!("R{}", format_figure(radius.abs()))),
        Feature::Thread {
            pitch, diameters, ..
        } => Some(format!(
            "⌀{} P{}",
            across(diameters.0),
            format_figure(pitch)
        )),
    }
}

/// Formats a length, mm, or an angle, degrees, with as many decimals as needed, three at most.
fn format_figure(value: f64) -> String {
    let rounded = (value * 1000.0).round() / 1000.0;
    if rounded == 0.0 {
        return "0".to_owned();
    }
    rounded.to_string()
}

/// Returns the point half-way along an outline.
fn outline_middle(outline: &[Point]) -> Point {
    let lengths = || outline.windows(2).map(|ends| (ends[1] - ends[0]).length());
    let mut left = lengths().sum::<f64>() / 2.0;
    for (ends, length) in outline.windows(2).zip(lengths()) {
        if length >= left && length > 0.0 {
            return ends[0] + (ends[1] - ends[0]) * (left / length);
        }
        left -= length;
    }
    outline.first().copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_workpiece::grid::to_grid;

    /// ⌀20 from 0 to -20 with a chamfer of 2 mm, ⌀30 to -50, a bore ⌀10.
    fn shaft() -> Dimensions {
        let outline = [
            (5.0, 0.0),
            (8.0, 0.0),
            (10.0, -2.0),
            (10.0, -20.0),
            (15.0, -20.0),
            (15.0, -50.0),
            (5.0, -50.0),
        ];
        let contour = outline.map(|(x, z)| to_grid(Point::new(x, z))).to_vec();
        Dimensions::measure(&Region::from_contours(&[contour]))
    }

    #[test]
    fn a_shaft_is_dimensioned_as_on_a_drawing() {
        let shaft = shaft();
        let words = shaft.surfaces.iter().map(|it| it.text.as_str());
        let mut words: Vec<&str> = words.collect();
        words.sort_unstable();
        assert_eq!(words, ["2×45°", "⌀10", "⌀20", "⌀30"]);
    }

    #[test]
    fn corners_of_a_nose_are_not_dimensions() {
        let mut taken = OccupancyMap::new((0.0, 0.0, 800.0, 400.0));
        // The chamfer is five units wide: no space for text, and -2 is next to 0.
        let place = |at: Point| (700.0 + at.z * 2.5, 200.0 - at.x * 2.5);
        let drawn = shaft().place_all(place, &mut taken);
        let words: Vec<&str> = drawn.iter().map(|it| it.text.as_str()).collect();
        assert!(
            !words.contains(&"2×45°") && !words.contains(&"-2"),
            "{words:?}"
        );
        assert!(words.contains(&"0") && words.contains(&"⌀30"), "{words:?}");
    }

    #[test]
    fn words_lie_on_the_material_and_figures_below_the_axis() {
        let mut taken = OccupancyMap::new((0.0, 0.0, 800.0, 400.0));
        let place = |point: Point| (700.0 + point.z * 10.0, 200.0 - point.x * 10.0);
        let drawn = shaft().place_all(place, &mut taken);
        let at = |words: &str| drawn.iter().find(|it| it.text == words).unwrap();
        assert_eq!(at("⌀20").corner.1, 100.0 + TEXT_GAP);
        assert_eq!(at("⌀10").corner.1, 150.0 - TEXT_GAP - HEIGHT);
        let figures = drawn.iter().filter(|it| it.line.is_some());
        let mut figures: Vec<&str> = figures.map(|it| it.text.as_str()).collect();
        figures.sort_unstable();
        assert_eq!(figures, ["-2", "-20", "-50", "0"]);
        let shoulder = at("-20");
        assert!(shoulder.corner.1 > 200.0);
        assert_eq!(shoulder.line.unwrap()[0].0, 500.0);
    }
}
