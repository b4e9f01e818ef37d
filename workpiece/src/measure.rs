//! Measuring a part: its outline as cylinders, cones, faces, arcs and threads.
//!
//! The outline is a polygon on the grid; what was cut by one line or arc is put together
//! again, to half a micrometre:
//!
//! ```text
//!        arc     cylinder
//!      .-‾‾‾-.___________          points of the polygon -> lines and circles
//!     /                  |face     through them
//!    / cone
//! ```

use gsk_units::{Diameter, Point};
use serde::Serialize;

use crate::grid::{GridPoint, from_grid};
use crate::region::Region;

/// How far a point may lie off the line or circle it belongs to, mm.
const TOLERANCE: f64 = 0.000_5;
/// Points that make an arc, at least; fewer are lines.
const ARC_POINTS: usize = 5;
/// Arcs beyond this radius are lines, mm.
const FLAT: f64 = 5_000.0;
/// Grooves that make a thread, at least.
const THREAD_GROOVES: usize = 3;
/// How much the grooves of a thread may differ, mm.
const THREAD_TOLERANCE: f64 = 0.002;

/// A feature of a part, from its front to its back. Z in mm, from the zero of the part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Feature {
    /// A cylinder.
    Cylinder {
        /// Its diameter, mm.
        diameter: Diameter,
        /// Where it begins and ends.
        z: (f64, f64),
    },
    /// A plane face.
    Face {
        /// Diameters between which it lies, mm.
        diameters: (Diameter, Diameter),
        /// Where it lies.
        z: f64,
    },
    /// A cone: a taper, a chamfer.
    Cone {
        /// Diameters of its ends, mm.
        diameters: (Diameter, Diameter),
        /// Where they lie.
        z: (f64, f64),
        /// Half its angle, degrees from the spindle axis.
        angle: f64,
    },
    /// A circular arc.
    Arc {
        /// Its radius, mm; a hollow one is less than 0.
        radius: f64,
        /// Diameters of its ends, mm.
        diameters: (Diameter, Diameter),
        /// Where they lie.
        z: (f64, f64),
    },
    /// A thread, by its grooves in the drawn plane.
    Thread {
        /// From groove to groove, mm.
        pitch: f64,
        /// Diameters at the crest and at the root, mm.
        diameters: (Diameter, Diameter),
        /// Its first and its last groove.
        z: (f64, f64),
    },
}

/// A feature with its outline.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// What it is.
    pub feature: Feature,
    /// Its points, mm, from the front to the back; X a radius.
    pub outline: Vec<Point>,
}

/// The features of the outside of a half section, or of its bore.
pub fn features(section: &Region, side: Side) -> Vec<Feature> {
    let measured = measured(section, side);
    measured.into_iter().map(|it| it.feature).collect()
}

/// The features of the outside of a half section, or of its bore, with their outlines.
pub fn measured(section: &Region, side: Side) -> Vec<Measured> {
    let outline = outline(section, side);
    let pieces = pieces(&outline);
    let mut found = Vec::new();
    let mut next = 0;
    while next < pieces.len() {
        let (feature, used) =
            thread(&pieces[next..]).unwrap_or_else(|| (pieces[next].feature(), 1));
        let (first, last) = (&pieces[next], &pieces[next + used - 1]);
        let outline = outline.get(first.points.0..=last.points.1);
        found.push(Measured {
            feature,
            outline: outline.unwrap_or_default().to_vec(),
        });
        next += used;
    }
    found
}

/// A side of a half section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// What is seen from outside.
    Outside,
    /// The bore.
    Inside,
}

/// A line or an arc of the outline.
#[derive(Clone, Copy, Debug)]
struct Piece {
    from: Point,
    to: Point,
    /// Indices of its ends in the outline.
    points: (usize, usize),
    /// Centre and whether it bulges outwards.
    arc: Option<(Point, bool)>,
}

impl Piece {
    fn feature(&self) -> Feature {
        let (from, to) = (self.from, self.to);
        let diameters = (from.diameter(), to.diameter());
        let z = (from.z, to.z);
        if let Some((center, bulges)) = self.arc {
            let radius = (from - center).length();
            return Feature::Arc {
                radius: if bulges { radius } else { -radius },
                diameters,
                z,
            };
        }
        if (from.x - to.x).abs() <= TOLERANCE {
            return Feature::Cylinder {
                diameter: Diameter(from.x + to.x),
                z,
            };
        }
        if (from.z - to.z).abs() <= TOLERANCE {
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

/// The points of one side of the largest piece, from its front to its back.
fn outline(section: &Region, side: Side) -> Vec<Point> {
    let pieces = section.pieces();
    let largest = pieces.iter().max_by(|a, b| a.area().total_cmp(&b.area()));
    let Some(contour) = largest.and_then(|piece| piece.contours().first()) else {
        return Vec::new();
    };
    let (Some(front), Some(back)) = (
        contour.iter().map(|point| point.x).max(),
        contour.iter().map(|point| point.x).min(),
    ) else {
        return Vec::new();
    };
    // Counter-clockwise the outside goes from the front, over the top, to the back.
    let lowest = |z: i32| {
        let at = contour.iter().enumerate().filter(|(_, it)| it.x == z);
        at.min_by_key(|(_, point)| point.y).map(|(index, _)| index)
    };
    let (Some(begin), Some(end)) = (lowest(front), lowest(back)) else {
        return Vec::new();
    };
    let around = |from: usize, to: usize| -> Vec<GridPoint> {
        let count = (to + contour.len() - from) % contour.len();
        let points = contour.iter().cycle().skip(from).take(count + 1);
        points.copied().collect()
    };
    let mut points = match side {
        Side::Outside => around(begin, end),
        Side::Inside => around(end, begin),
    };
    if side == Side::Inside {
        points.reverse();
        // Without a bore that side is the spindle axis.
        if points.iter().all(|point| point.y <= 0) {
            return Vec::new();
        }
    }
    points.into_iter().map(from_grid).collect()
}

/// Lines and arcs through the points, as few as stay within the tolerance.
fn pieces(points: &[Point]) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut begin = 0;
    while begin + 1 < points.len() {
        let line = longest(points, begin, fits_line);
        let arc = longest(points, begin, |points| fits_arc(points).is_some());
        let is_arc = arc + 1 - begin >= ARC_POINTS && arc > line;
        let end = if is_arc { arc } else { line };
        pieces.push(Piece {
            from: points[begin],
            to: points[end],
            points: (begin, end),
            arc: if is_arc {
                fits_arc(&points[begin..=end])
            } else {
                None
            },
        });
        begin = end;
    }
    pieces
}

/// The last point up to which all points from `begin` fit.
fn longest(points: &[Point], begin: usize, fits: impl Fn(&[Point]) -> bool) -> usize {
    let mut end = begin + 1;
    // Steps that double, then halve: a fit of many points is not tried at each of them.
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

fn fits_line(points: &[Point]) -> bool {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return true;
    };
    let Some(direction) = (*last - *first).unit() else {
        return false;
    };
    points
        .iter()
        .all(|point| direction.cross(*point - *first).abs() <= TOLERANCE)
}

/// The circle through the first, the middle and the last point, if all lie on it.
fn fits_arc(points: &[Point]) -> Option<(Point, bool)> {
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
    let on_it = |point: &Point| ((*point - center).length() - radius).abs() <= TOLERANCE;
    // The chords between the points must be those of an arc, not long straight sides.
    let chords = points.windows(2).all(|pair| {
        let chord = (pair[1] - pair[0]).length();
        let sagitta = chord * chord / (8.0 * radius);
        sagitta <= TOLERANCE * 2.0
    });
    (radius < FLAT && chords && points.iter().all(on_it)).then_some((center, twice > 0.0))
}

/// A thread at the begin of the pieces, and how many of them it is made of.
fn thread(pieces: &[Piece]) -> Option<(Feature, usize)> {
    // Lowest points of the grooves and highest ones between them.
    let mut roots: Vec<Point> = Vec::new();
    let mut crest = f64::NEG_INFINITY;
    let mut used = 0;
    for (index, pair) in pieces.windows(2).enumerate() {
        let is_root = falls(&pair[0]) && rises_after(&pieces[index + 1..]);
        if !is_root {
            continue;
        }
        let root = bottom(&pieces[index..]);
        if let [.., before_last, last] = &roots[..] {
            let pitch = before_last.z - last.z;
            let fits = (last.z - root.z - pitch).abs() <= THREAD_TOLERANCE
                && (last.x - root.x).abs() <= THREAD_TOLERANCE;
            if !fits {
                break;
            }
        }
        if roots.is_empty() && index > 1 {
            return None;
        }
        roots.push(root);
        crest = pieces[..=index + 1].iter().fold(crest, |crest, piece| {
            crest.max(piece.from.x).max(piece.to.x)
        });
        used = index + 2;
    }
    let (first, last) = (roots.first()?, roots.last()?);
    if roots.len() < THREAD_GROOVES {
        return None;
    }
    let feature = Feature::Thread {
        pitch: (first.z - last.z) / (roots.len() - 1) as f64,
        diameters: (Diameter(2.0 * crest), first.diameter()),
        z: (first.z, last.z),
    };
    Some((feature, used))
}

/// Whether a piece goes towards the axis on its way to the back, steeper than a taper.
fn falls(piece: &Piece) -> bool {
    piece.arc.is_none() && piece.from.x - piece.to.x > 0.25 * (piece.from.z - piece.to.z).abs()
}

/// Whether after at most one piece at the root the outline rises again as steeply.
fn rises_after(pieces: &[Piece]) -> bool {
    let rises = |piece: &Piece| {
        piece.arc.is_none() && piece.to.x - piece.from.x > 0.25 * (piece.from.z - piece.to.z).abs()
    };
    pieces.iter().take(2).any(rises)
}

/// The lowest point of a groove that begins with its falling side: in the middle of
/// what lies between both sides.
fn bottom(pieces: &[Piece]) -> Point {
    let Some(falling) = pieces.first() else {
        return Point::default();
    };
    let rising = pieces
        .iter()
        .skip(1)
        .take(2)
        .find(|piece| piece.to.x > piece.from.x);
    let end = rising.map_or(falling.to, |piece| piece.from);
    let middle = (falling.to + end) * 0.5;
    // The nose's lowest point lies below the points where it meets the sides.
    let between = pieces.get(1).filter(|piece| piece.arc.is_some());
    let lowest = between.and_then(|piece| {
        let (center, _) = piece.arc?;
        Some(center.x - (piece.from - center).length())
    });
    Point::new(lowest.unwrap_or(middle.x), middle.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Kind, Motion, ThreadPath};
    use crate::scene::{Cutter, Scene};
    use crate::stock::Stock;
    use crate::tool::{Insert, Letter, Shape, Tool};
    use gsk_units::Axis;

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() <= 0.001
    }

    fn turned(points: &[(f64, f64)]) -> Region {
        let mut scene = Scene::new(&Stock::bar(50.0, 0.0, 60.0));
        let tool = Tool {
            insert: Insert::Turning {
                letter: Letter::V,
                entering: 93.0,
                size: 12.7,
                nose: 0.0,
            },
            ..Tool::turning()
        };
        let cutter = Cutter::new(Shape::of(&tool));
        for pair in points.windows(2) {
            let motion = Motion {
                from: Point::new(pair[0].0, pair[0].1),
                to: Point::new(pair[1].0, pair[1].1),
                kind: Kind::Line,
                turning: true,
            };
            scene.carry_out(&cutter, &motion);
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
        let features = features(&section, Side::Outside);
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
    fn an_arc_has_its_radius_and_its_side() {
        for (clockwise, center) in [
            (false, Point::new(15.0, -15.0)),
            (true, Point::new(25.0, -5.0)),
        ] {
            let mut scene = Scene::new(&Stock::bar(50.0, 0.0, 60.0));
            let tool = Tool {
                insert: Insert::Turning {
                    letter: Letter::V,
                    entering: 93.0,
                    size: 15.875,
                    nose: 0.0,
                },
                ..Tool::turning()
            };
            let cutter = Cutter::new(Shape::of(&tool));
            let (from, to) = (Point::new(15.0, -5.0), Point::new(25.0, -15.0));
            for (kind, from, to) in [
                (Kind::Line, Point::new(15.0, 1.0), from),
                (Kind::Arc { center, clockwise }, from, to),
            ] {
                let motion = Motion {
                    from,
                    to,
                    kind,
                    turning: true,
                };
                scene.carry_out(&cutter, &motion);
            }
            let features = features(&scene.part().section(), Side::Outside);
            let radius = features.iter().find_map(|feature| match feature {
                Feature::Arc { radius, .. } => Some(*radius),
                _ => None,
            });
            let wanted = if clockwise { -10.0 } else { 10.0 };
            assert!(radius.is_some_and(|it| near(it, wanted)), "{features:?}");
        }
    }

    #[test]
    fn a_thread_has_its_pitch_and_its_diameters() {
        let mut scene = Scene::new(&Stock::bar(30.0, 0.0, 60.0));
        let cutter = Cutter::new(Shape::of(&Tool::threading(60.0)));
        for x in [14.6, 14.2, 14.08] {
            let path = ThreadPath {
                from: Point::new(x, 4.0),
                to: Point::new(x, -25.0),
                long: Axis::Z,
                lead: 1.5,
                increase: 0.0,
                phase: 0.0,
            };
            let motion = Motion {
                from: path.from,
                to: path.to,
                kind: Kind::Thread(path.imprints().0),
                turning: true,
            };
            scene.carry_out(&cutter, &motion);
        }
        let features = features(&scene.part().section(), Side::Outside);
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
            form: crate::stock::Form::Tube {
                diameter: Diameter(50.0),
                bore: Diameter(20.0),
            },
            ..Stock::bar(50.0, 0.0, 60.0)
        };
        let features = features(&stock.section(), Side::Inside);
        assert!(
            features.iter().any(|feature| matches!(feature,
                Feature::Cylinder { diameter, .. } if near(diameter.0, 20.0))),
            "{features:?}"
        );
        let bar = Stock::bar(50.0, 0.0, 60.0).section();
        assert!(super::features(&bar, Side::Inside).is_empty());
    }
}
