//! Measures a part: recognizes cylinders, cones, faces, arcs and threads in its outline.
//!
//! The outline is a polygon on the grid. Lines and circles are fitted through its points
//! with a tolerance of half a micrometre:
//!
//! ```text
//!        arc     cylinder
//!      .-‾‾‾-.___________          points of the polygon -> lines and circles
//!     /                  |face
//!    / cone
//! ```

use gsk_units::{Diameter, Point};
use serde::Serialize;

use crate::grid::{GridPoint, from_grid};
use crate::region::Region;

/// Greatest distance of a point from the line or circle fitted to it, mm.
const TOLERANCE_MM: f64 = 0.000_5;
/// Least number of points of an arc; fewer points become lines.
const MIN_ARC_POINTS: usize = 5;
/// Greatest radius of an arc, mm; flatter arcs become lines.
const MAX_ARC_RADIUS_MM: f64 = 5_000.0;
/// Least number of equal grooves that are recognized as a thread.
const MIN_THREAD_GROOVES: usize = 3;
/// Greatest difference between grooves of one thread in pitch and depth, mm.
const THREAD_TOLERANCE_MM: f64 = 0.002;

/// A feature of the outline. Pairs run from the front of the part to its back; Z is a part
/// coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Feature {
    /// A cylinder: a line of the outline parallel to the spindle axis.
    Cylinder {
        /// The diameter of the cylinder, mm.
        diameter: Diameter,
        /// Z of the front and back end of the cylinder, mm.
        z: (f64, f64),
    },
    /// A face: a line of the outline perpendicular to the spindle axis.
    Face {
        /// Diameters of both ends of the face, mm.
        diameters: (Diameter, Diameter),
        /// Z of the face, mm.
        z: f64,
    },
    /// A taper or a chamfer: an inclined line of the outline.
    Cone {
        /// Diameters of the front and back end, mm.
        diameters: (Diameter, Diameter),
        /// Z of the front and back end, mm.
        z: (f64, f64),
        /// Angle between the line and the spindle axis, degrees: half the cone angle.
        angle: f64,
    },
    /// A fillet, rounding or ball: a circular arc of the outline.
    Arc {
        /// The radius of the arc, mm; negative if the arc is concave.
        radius: f64,
        /// Diameters of the front and back end of the arc, mm.
        diameters: (Diameter, Diameter),
        /// Z of the front and back end of the arc, mm.
        z: (f64, f64),
    },
    /// A thread: equal grooves at equal distances.
    Thread {
        /// Distance between two grooves along Z, mm.
        pitch: f64,
        /// Crest diameter and root diameter, mm.
        diameters: (Diameter, Diameter),
        /// Z of the first and of the last groove, mm.
        z: (f64, f64),
    },
}

/// A feature of the outline with its points.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredFeature {
    /// The feature that was recognized in the outline.
    pub feature: Feature,
    /// Points of the outline from the front of the part to its back, mm; X is a radius.
    pub outline: Vec<Point>,
}

/// Measures one side of a half section and returns its features from front to back.
pub fn measure_features(section: &Region, side: SectionSide) -> Vec<Feature> {
    let measured = measure_with_outlines(section, side);
    measured.into_iter().map(|it| it.feature).collect()
}

/// Measures one side of a half section and returns its features with their outlines, from
/// front to back.
pub fn measure_with_outlines(section: &Region, side: SectionSide) -> Vec<MeasuredFeature> {
    let outline = outline(section, side);
    let segments = fit_segments(&outline);
    let mut found = Vec::new();
    let mut next = 0;
    while next < segments.len() {
        let (feature, used) =
            find_thread(&segments[next..]).unwrap_or_else(|| (segments[next].feature(), 1));
        let (first, last) = (&segments[next], &segments[next + used - 1]);
        let outline = outline.get(first.points.0..=last.points.1);
        found.push(MeasuredFeature {
            feature,
            outline: outline.unwrap_or_default().to_vec(),
        });
        next += used;
    }
    found
}

/// The side of a half section that is measured: outside or bore.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SectionSide {
    /// The outer surface of the part.
    Outside,
    /// The surface of the bore.
    Inside,
}

/// A piece of the outline: a line or an arc.
#[derive(Clone, Copy, Debug)]
struct OutlineSegment {
    from: Point,
    to: Point,
    /// Indices of the piece's first and last point in the outline.
    points: (usize, usize),
    /// Centre of the arc, mm, and whether the arc is convex; `None` for a line.
    arc: Option<(Point, bool)>,
}

impl OutlineSegment {
    fn feature(&self) -> Feature {
        let (from, to) = (self.from, self.to);
        let diameters = (from.diameter(), to.diameter());
        let z = (from.z, to.z);
        if let Some((center, is_convex)) = self.arc {
            let radius = (from - center).length();
            return Feature::Arc {
                radius: if is_convex { radius } else { -radius },
                diameters,
                z,
            };
        }
        if (from.x - to.x).abs() <= TOLERANCE_MM {
            return Feature::Cylinder {
                diameter: Diameter(from.x + to.x),
                z,
            };
        }
        if (from.z - to.z).abs() <= TOLERANCE_MM {
            return Feature::Face {
                diameters,
                z: (from.z + to.z) / 2.0,
            };
        }
        let angle = libm::atan2((to.x - from.x).abs(), (to.z - from.z).abs());
        Feature::Cone {
            diameters,
            z,
            angle: angle * 180.0 / core::f64::consts::PI,
        }
    }
}

/// The points of one side of the largest connected area, from its front to its back, mm; X is
/// a radius.
fn outline(section: &Region, side: SectionSide) -> Vec<Point> {
    let areas = section.connected_areas();
    let largest = areas.iter().max_by(|a, b| a.area().total_cmp(&b.area()));
    let Some(contour) = largest.and_then(|area| area.contours().first()) else {
        return Vec::new();
    };
    let (Some(front), Some(back)) = (
        contour.iter().map(|point| point.x).max(),
        contour.iter().map(|point| point.x).min(),
    ) else {
        return Vec::new();
    };
    // Counter-clockwise the outer surface runs from the front over the top to the back.
    let lowest = |z: i32| {
        let at = contour.iter().enumerate().filter(|(_, it)| it.x == z);
        at.min_by_key(|(_, point)| point.y).map(|(index, _)| index)
    };
    let (Some(begin), Some(end)) = (lowest(front), lowest(back)) else {
        return Vec::new();
    };
    let points_between = |from: usize, to: usize| -> Vec<GridPoint> {
        let count = (to + contour.len() - from) % contour.len();
        let points = contour.iter().cycle().skip(from).take(count + 1);
        points.copied().collect()
    };
    let mut points = match side {
        SectionSide::Outside => points_between(begin, end),
        SectionSide::Inside => points_between(end, begin),
    };
    if side == SectionSide::Inside {
        points.reverse();
        // Without a bore the inner side is the spindle axis.
        if points.iter().all(|point| point.y <= 0) {
            return Vec::new();
        }
    }
    points.into_iter().map(from_grid).collect()
}

/// Fits the fewest lines and arcs to the points that stay within the tolerance.
fn fit_segments(points: &[Point]) -> Vec<OutlineSegment> {
    let mut segments = Vec::new();
    let mut begin = 0;
    while begin + 1 < points.len() {
        let line = last_fitting(points, begin, is_line);
        let arc = last_fitting(points, begin, |points| fit_arc(points).is_some());
        let is_arc = arc + 1 - begin >= MIN_ARC_POINTS && arc > line;
        let end = if is_arc { arc } else { line };
        segments.push(OutlineSegment {
            from: points[begin],
            to: points[end],
            points: (begin, end),
            arc: if is_arc {
                fit_arc(&points[begin..=end])
            } else {
                None
            },
        });
        begin = end;
    }
    segments
}

/// The index of the last point up to which the points from index `begin` on still fit, as
/// `fits` decides.
fn last_fitting(points: &[Point], begin: usize, fits: impl Fn(&[Point]) -> bool) -> usize {
    let mut end = begin + 1;
    // The step doubles, then halves: fewer attempts than one for each point.
    let mut step = 1;
    while step > 0 {
        let next = end + step;
        if next < points.len() && fits(&points[begin..=next]) {
            end = next;
            step *= 2;
        } else {
            step /= 2;
        }
    }
    end
}

fn is_line(points: &[Point]) -> bool {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return true;
    };
    let Some(direction) = (*last - *first).unit() else {
        return false;
    };
    points
        .iter()
        .all(|point| direction.cross(*point - *first).abs() <= TOLERANCE_MM)
}

/// Fits a circle through the first, the middle and the last point. Returns its centre, mm, and
/// whether the arc is convex; `None` if a point is not on the circle.
fn fit_arc(points: &[Point]) -> Option<(Point, bool)> {
    let (first, last) = (*points.first()?, *points.last()?);
    let middle = points[points.len() / 2];
    let (b, c) = (middle - first, last - first);
    let twice = 2.0 * b.cross(c);
    if twice == 0.0 {
        return None;
    }
    let (bb, cc) = (b.dot(b), c.dot(c));
    // From the first point to the centre.
    let to_center = (b * cc - c * bb).left() * (1.0 / twice);
    let radius = to_center.length();
    let center = first + to_center;
    let on_it = |point: &Point| ((*point - center).length() - radius).abs() <= TOLERANCE_MM;
    // Long straight sides between points of a circle are lines, not chords of an arc.
    let chords = points.windows(2).all(|pair| {
        let chord = (pair[1] - pair[0]).length();
        let sagitta = chord * chord / (8.0 * radius);
        sagitta <= TOLERANCE_MM * 2.0
    });
    let is_arc = radius < MAX_ARC_RADIUS_MM && chords && points.iter().all(on_it);
    is_arc.then_some((center, twice > 0.0))
}

/// Recognizes a thread at the start of the segments. Returns the thread and the number of its
/// segments; `None` if there is no thread.
fn find_thread(segments: &[OutlineSegment]) -> Option<(Feature, usize)> {
    let mut roots: Vec<Point> = Vec::new();
    let mut crest = f64::NEG_INFINITY;
    let mut used = 0;
    for (index, pair) in segments.windows(2).enumerate() {
        let is_root = is_falling_flank(&pair[0]) && has_rising_flank(&segments[index + 1..]);
        if !is_root {
            continue;
        }
        let root = groove_root(&segments[index..]);
        if let [.., before_last, last] = &roots[..] {
            let pitch = before_last.z - last.z;
            let fits = (last.z - root.z - pitch).abs() <= THREAD_TOLERANCE_MM
                && (last.x - root.x).abs() <= THREAD_TOLERANCE_MM;
            if !fits {
                break;
            }
        }
        if roots.is_empty() && index > 1 {
            return None;
        }
        roots.push(root);
        crest = segments[..=index + 1].iter().fold(crest, |crest, segment| {
            crest.max(segment.from.x).max(segment.to.x)
        });
        used = index + 2;
    }
    let (first, last) = (roots.first()?, roots.last()?);
    if roots.len() < MIN_THREAD_GROOVES {
        return None;
    }
    let feature = Feature::Thread {
        pitch: (first.z - last.z) / (roots.len() - 1) as f64,
        diameters: (Diameter(2.0 * crest), first.diameter()),
        z: (first.z, last.z),
    };
    Some((feature, used))
}

/// Least ratio of the change of X to the change of Z on a thread flank. Flatter lines are
/// tapers.
const MIN_FLANK_SLOPE: f64 = 0.25;

/// Whether a segment is a flank that leads towards the axis, seen from the front.
fn is_falling_flank(segment: &OutlineSegment) -> bool {
    let (from, to) = (segment.from, segment.to);
    segment.arc.is_none() && from.x - to.x > MIN_FLANK_SLOPE * (from.z - to.z).abs()
}

/// Whether one of the next two segments is a flank that leads away from the axis: at most
/// one segment lies between the flanks.
fn has_rising_flank(segments: &[OutlineSegment]) -> bool {
    let rises = |segment: &OutlineSegment| {
        let (from, to) = (segment.from, segment.to);
        segment.arc.is_none() && to.x - from.x > MIN_FLANK_SLOPE * (from.z - to.z).abs()
    };
    segments.iter().take(2).any(rises)
}

/// The lowest point of a groove, mm. The first of `segments` is its falling flank; Z is the
/// middle between both flanks.
fn groove_root(segments: &[OutlineSegment]) -> Point {
    let Some(falling) = segments.first() else {
        return Point::default();
    };
    let rising = segments
        .iter()
        .skip(1)
        .take(2)
        .find(|segment| segment.to.x > segment.from.x);
    let end = rising.map_or(falling.to, |segment| segment.from);
    let middle = (falling.to + end) * 0.5;
    // The lowest point of a round root is below the points where it joins the flanks.
    let round_root = segments.get(1).filter(|segment| segment.arc.is_some());
    let lowest = round_root.and_then(|segment| {
        let (center, _) = segment.arc?;
        Some(center.x - (segment.from - center).length())
    });
    Point::new(lowest.unwrap_or(middle.x), middle.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{MotionKind, ThreadPath, ToolMotion};
    use crate::scene::{LatheScene, SceneTool};
    use crate::stock::Stock;
    use crate::tool::{Insert, InsertLetter, Tool, ToolShape};
    use gsk_units::Axis;

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() <= 0.001
    }

    fn turned(points: &[(f64, f64)]) -> Region {
        let mut scene = LatheScene::new(&Stock::bar(50.0, 0.0, 60.0));
        let tool = Tool {
            insert: Insert::Turning {
                letter: InsertLetter::V,
                entering: 93.0,
                size: 12.7,
                nose: 0.0,
            },
            ..Tool::turning()
        };
        let cutter = SceneTool::new(ToolShape::from_tool(&tool));
        for pair in points.windows(2) {
            let motion = ToolMotion {
                from: Point::new(pair[0].0, pair[0].1),
                to: Point::new(pair[1].0, pair[1].1),
                kind: MotionKind::Line,
                turning: true,
                by_hand: false,
            };
            scene.move_tool(&cutter, &motion);
        }
        scene.part().section()
    }

    #[test]
    fn cylinder_chamfer_cone_and_face_are_measured() {
        let section = turned(&[
            (22.0, 1.0),
            (22.0, -30.0),
            (26.0, -30.0),
            (26.0, 1.0),
            (17.0, 1.0),
            (20.0, -2.0),
            (20.0, -20.0),
            (22.0, -26.0),
        ]);
        let features = measure_features(&section, SectionSide::Outside);
        let cylinder = |diameter: f64, z: (f64, f64)| {
            features.iter().any(|feature| {
                matches!(feature, Feature::Cylinder { diameter: d, z: at }
                    if near(d.0, diameter) && near(at.0, z.0) && near(at.1, z.1))
            })
        };
        assert!(cylinder(40.0, (-2.0, -20.0)), "{features:?}");
        assert!(cylinder(44.0, (-26.0, -30.0)), "{features:?}");
        let cones: Vec<f64> = features
            .iter()
            .filter_map(|feature| match feature {
                Feature::Cone { angle, .. } => Some(*angle),
                _ => None,
            })
            .collect();
        assert!(near(cones[0], 45.0), "{cones:?}");
        assert!((cones[1] - 18.4349).abs() < 0.001, "{cones:?}");
    }

    #[test]
    fn the_radius_of_an_arc_is_negative_if_it_is_concave() {
        for (clockwise, center) in [
            (false, Point::new(15.0, -15.0)),
            (true, Point::new(25.0, -5.0)),
        ] {
            let mut scene = LatheScene::new(&Stock::bar(50.0, 0.0, 60.0));
            let tool = Tool {
                insert: Insert::Turning {
                    letter: InsertLetter::V,
                    entering: 93.0,
                    size: 15.875,
                    nose: 0.0,
                },
                ..Tool::turning()
            };
            let cutter = SceneTool::new(ToolShape::from_tool(&tool));
            let (from, to) = (Point::new(15.0, -5.0), Point::new(25.0, -15.0));
            for (kind, from, to) in [
                (MotionKind::Line, Point::new(15.0, 1.0), from),
                (MotionKind::Arc { center, clockwise }, from, to),
            ] {
                let motion = ToolMotion {
                    from,
                    to,
                    kind,
                    turning: true,
                    by_hand: false,
                };
                scene.move_tool(&cutter, &motion);
            }
            let features = measure_features(&scene.part().section(), SectionSide::Outside);
            let radius = features.iter().find_map(|feature| match feature {
                Feature::Arc { radius, .. } => Some(*radius),
                _ => None,
            });
            let wanted = if clockwise { -10.0 } else { 10.0 };
            assert!(radius.is_some_and(|it| near(it, wanted)), "{features:?}");
        }
    }

    #[test]
    fn pitch_and_diameters_of_a_thread_are_measured() {
        let mut scene = LatheScene::new(&Stock::bar(30.0, 0.0, 60.0));
        let cutter = SceneTool::new(ToolShape::from_tool(&Tool::threading(60.0)));
        for x in [14.6, 14.2, 14.08] {
            let path = ThreadPath {
                from: Point::new(x, 4.0),
                to: Point::new(x, -25.0),
                lead_axis: Axis::Z,
                lead: 1.5,
                lead_change: 0.0,
                phase: 0.0,
            };
            let motion = ToolMotion {
                from: path.from,
                to: path.to,
                kind: MotionKind::Thread(path.imprints().0),
                turning: true,
                by_hand: false,
            };
            scene.move_tool(&cutter, &motion);
        }
        let features = measure_features(&scene.part().section(), SectionSide::Outside);
        let Some(Feature::Thread {
            pitch, diameters, ..
        }) = features
            .iter()
            .find(|feature| matches!(feature, Feature::Thread { .. }))
        else {
            panic!("{features:?}");
        };
        assert!(near(*pitch, 1.5), "{pitch}");
        assert!(near(diameters.0.0, 30.0), "{diameters:?}");
        assert!(near(diameters.1.0, 28.16), "{diameters:?}");
    }

    #[test]
    fn a_bore_is_measured_from_the_inside() {
        let stock = Stock {
            form: crate::stock::StockForm::Tube {
                diameter: Diameter(50.0),
                bore: Diameter(20.0),
            },
            ..Stock::bar(50.0, 0.0, 60.0)
        };
        let features = measure_features(&stock.section(), SectionSide::Inside);
        assert!(
            features.iter().any(|feature| matches!(feature,
                Feature::Cylinder { diameter, .. } if near(diameter.0, 20.0))),
            "{features:?}"
        );
        let bar = Stock::bar(50.0, 0.0, 60.0).section();
        assert!(measure_features(&bar, SectionSide::Inside).is_empty());
    }
}
