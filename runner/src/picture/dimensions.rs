//! Dimensions of the part as a drawing gives them: diameters, radii, angles and pitches on
//! the material beside their surface, and where its shoulders lie below the spindle axis.
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

use super::legend::width;
use super::numbers::{HEIGHT, Taken};

/// Units between a surface or a line and the words beside it.
const GAP: f64 = 5.0;
/// Rows below the spindle axis in which shoulders have their figures.
const ROWS: u32 = 3;
/// Units that the figures of the shoulders take below the spindle axis.
pub(super) const BELOW_AXIS: f64 = 2.0 * GAP + ROWS as f64 * HEIGHT;
/// Units between two shoulders that both have their figures.
const APART: f64 = 6.0;
/// A corner smaller than this is that of a nose, not one of the drawing, units.
const CORNER: f64 = 14.0;
/// An angle is one of 45° within this, degrees.
const SAME: f64 = 0.001;

/// The dimensions of a part.
#[derive(Clone, Debug, Default)]
pub(super) struct Dimensions {
    surfaces: Vec<Surface>,
    /// Faces, then the ends of other surfaces.
    shoulders: Vec<Point>,
}

/// What is written beside a surface.
#[derive(Clone, Debug)]
struct Surface {
    ends: [Point; 2],
    middle: Point,
    /// Outside, the material lies towards the axis.
    side: SectionSide,
    words: String,
}

/// A dimension as it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// The upper left corner of the words, units.
    pub at: (f64, f64),
    /// The words.
    pub words: String,
    /// From a shoulder to its words.
    pub line: Option<[(f64, f64); 2]>,
}

impl Dimensions {
    /// Of a half section.
    pub fn of(section: &Region) -> Self {
        let mut found = Self::default();
        let sides = [SectionSide::Outside, SectionSide::Inside];
        let measured = sides.map(|side| (side, measure_with_outlines(section, side)));
        let all = || {
            let each = measured.iter();
            each.flat_map(|(side, surfaces)| surfaces.iter().map(|it| (*side, it)))
        };
        // Where a nose has rounded a corner, the face is the shoulder that is meant.
        let is_face = |surface: &MeasuredFeature| matches!(surface.feature, Feature::Face { .. });
        for (side, surface) in all().filter(|(_, it)| is_face(it)) {
            found.add(surface, side);
        }
        for (side, surface) in all().filter(|(_, it)| !is_face(it)) {
            found.add(surface, side);
        }
        found
    }

    fn add(&mut self, surface: &MeasuredFeature, side: SectionSide) {
        let outline = &surface.outline;
        let (Some(first), Some(last)) = (outline.first(), outline.last()) else {
            return;
        };
        if let Some(words) = words(&surface.feature) {
            self.surfaces.push(Surface {
                ends: [*first, *last],
                middle: middle(outline),
                side,
                words,
            });
        }
        self.shoulders.extend([*first, *last]);
    }

    /// Whether there are none.
    pub const fn is_empty(&self) -> bool {
        self.surfaces.is_empty() && self.shoulders.is_empty()
    }

    /// Where they are drawn, as far as there is room; `place` gives the units of a point.
    pub fn placed(&self, place: impl Fn(Point) -> (f64, f64), taken: &mut Taken) -> Vec<Dimension> {
        let mut drawn = Vec::new();
        for surface in &self.surfaces {
            let [from, to] = surface.ends.map(&place);
            if libm::hypot(to.0 - from.0, to.1 - from.1) < CORNER {
                continue;
            }
            let ((x, y), wide) = (place(surface.middle), width(&surface.words));
            // Y grows downwards.
            let y = match surface.side {
                SectionSide::Outside => y + GAP,
                SectionSide::Inside => y - GAP - HEIGHT,
            };
            let left = x - wide / 2.0;
            if taken.take((left, y, left + wide, y + HEIGHT)) {
                drawn.push(Dimension {
                    at: (left, y),
                    words: surface.words.clone(),
                    line: None,
                });
            }
        }
        let mut known: Vec<f64> = Vec::new();
        for point in &self.shoulders {
            let (x, from) = place(*point);
            if known.iter().any(|other| (other - x).abs() < APART) {
                continue;
            }
            known.push(x);
            let axis = place(Point::new(0.0, point.z)).1;
            let words = figure(point.z);
            let half = width(&words) / 2.0;
            let rows = (0..ROWS).map(|row| axis + GAP + HEIGHT * f64::from(row));
            let row = rows.into_iter().find(|top| {
                let around = (x - half - GAP, *top, x + half + GAP, top + HEIGHT);
                taken.take(around)
            });
            if let Some(top) = row {
                drawn.push(Dimension {
                    at: (x - half, top),
                    words,
                    line: Some([(x, from), (x, top)]),
                });
            }
        }
        drawn
    }
}

/// What a drawing writes beside a surface; a face is given by its ends.
fn words(feature: &Feature) -> Option<String> {
    let across = |Diameter(value): Diameter| figure(value);
    match *feature {
        Feature::Cylinder { diameter, .. } => Some(format!("⌀{}", across(diameter))),
        Feature::Face { .. } => None,
        Feature::Cone { z, angle, .. } => Some(match (angle - 45.0).abs() < SAME {
            true => format!("{}×45°", figure((z.0 - z.1).abs())),
            false => format!("{}°", figure(angle)),
        }),
        Feature::Arc { radius, .. } => Some(format!("R{}", figure(radius.abs()))),
        Feature::Thread {
            pitch, diameters, ..
        } => Some(format!("⌀{} P{}", across(diameters.0), figure(pitch))),
    }
}

/// A figure with as many decimals as it needs, three at most.
fn figure(value: f64) -> String {
    let rounded = (value * 1000.0).round() / 1000.0;
    if rounded == 0.0 {
        return "0".to_owned();
    }
    rounded.to_string()
}

/// The point half-way along an outline.
fn middle(outline: &[Point]) -> Point {
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
        Dimensions::of(&Region::from_contours(&[contour]))
    }

    #[test]
    fn a_shaft_is_dimensioned_as_on_a_drawing() {
        let shaft = shaft();
        let words = shaft.surfaces.iter().map(|it| it.words.as_str());
        let mut words: Vec<&str> = words.collect();
        words.sort_unstable();
        assert_eq!(words, ["2×45°", "⌀10", "⌀20", "⌀30"]);
    }

    #[test]
    fn corners_of_a_nose_are_not_dimensions() {
        let mut taken = Taken::new((0.0, 0.0, 800.0, 400.0));
        // The chamfer is five units wide: no room for words, and -2 lies beside 0.
        let place = |at: Point| (700.0 + at.z * 2.5, 200.0 - at.x * 2.5);
        let drawn = shaft().placed(place, &mut taken);
        let words: Vec<&str> = drawn.iter().map(|it| it.words.as_str()).collect();
        assert!(
            !words.contains(&"2×45°") && !words.contains(&"-2"),
            "{words:?}"
        );
        assert!(words.contains(&"0") && words.contains(&"⌀30"), "{words:?}");
    }

    #[test]
    fn words_lie_on_the_material_and_figures_below_the_axis() {
        let mut taken = Taken::new((0.0, 0.0, 800.0, 400.0));
        let place = |point: Point| (700.0 + point.z * 10.0, 200.0 - point.x * 10.0);
        let drawn = shaft().placed(place, &mut taken);
        let at = |words: &str| drawn.iter().find(|it| it.words == words).unwrap();
        assert_eq!(at("⌀20").at.1, 100.0 + GAP);
        assert_eq!(at("⌀10").at.1, 150.0 - GAP - HEIGHT);
        let figures = drawn.iter().filter(|it| it.line.is_some());
        let mut figures: Vec<&str> = figures.map(|it| it.words.as_str()).collect();
        figures.sort_unstable();
        assert_eq!(figures, ["-2", "-20", "-50", "0"]);
        let shoulder = at("-20");
        assert!(shoulder.at.1 > 200.0);
        assert_eq!(shoulder.line.unwrap()[0].0, 500.0);
    }
}
