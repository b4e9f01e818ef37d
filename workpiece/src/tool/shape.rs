//! Computes the shape of a tool relative to its imaginary tip.

use gsk_units::{Point, tip_direction};

use super::{Holder, Insert, InsertLetter, Tool};
use crate::convex::convex_hull;
use crate::curve::{PlaneArc, unit_vector};
use crate::grid::{GridContour, GridPoint, to_grid};

/// Part of a turning insert's edge that may cut, as a fraction of the edge length.
const CUTTING_SHARE: f64 = 0.95;
/// Overhang of an insert in front of its holder, as a fraction of its edge length.
const OVERHANG_SHARE: f64 = 0.4;
/// Distance between a shank and the leading edge of its insert, mm.
const SHANK_SETBACK_MM: f64 = 1.0;
/// Clearance of a blade on each side of its insert, mm.
const BLADE_RELIEF_MM: f64 = 0.15;
/// Extent of the turret on each side of a holder, mm.
const TURRET_SIDE_MM: f64 = 40.0;
/// Depth of the turret beyond the end of a holder, mm.
const TURRET_DEPTH_MM: f64 = 150.0;

/// A part of a tool, other than the cutting part, that must never touch anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyPart {
    /// The side of the insert that does not cut.
    InsertBack,
    /// The shank, bar or blade that carries the insert.
    Holder,
    /// The turret that carries the holder.
    Turret,
}

/// The shape of a tool: convex polygons relative to its imaginary tip.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolShape {
    /// The polygon of the cutting part: its area removes material.
    pub cutting: GridContour,
    /// The polygons of the other parts, which must never touch anything.
    pub body: Vec<(BodyPart, GridContour)>,
}

/// The contours of a tool in its base pose: the body is at +X, and at +Z unless the tool is
/// symmetric.
#[derive(Default)]
struct Outline {
    cutting: Vec<Point>,
    back: Vec<Point>,
    /// X at which the holder begins, mm from the imaginary tip.
    holder_begin: f64,
    /// Least Z of the shank, mm from the imaginary tip.
    shank_z: f64,
    /// The blade between insert and shank; `None` without one.
    blade: Option<Blade>,
}

struct Blade {
    /// Z of both sides of the blade, mm from the imaginary tip.
    z: (f64, f64),
    /// X of the end of the blade, mm from the imaginary tip.
    end: f64,
}

impl ToolShape {
    /// Computes the shape of a tool from its dimensions.
    pub fn from_tool(tool: &Tool) -> Self {
        let outline = outline(tool);
        let pose = Pose::from_tool(tool);
        let contour = |points: &[Point]| convex_hull(points.iter().map(|point| pose.apply(*point)));
        let mut body = Vec::new();
        if !outline.back.is_empty() {
            body.push((BodyPart::InsertBack, contour(&outline.back)));
        }
        let mut add = |part, z: (f64, f64), x: (f64, f64)| {
            let corner = |z, x| Point::new(x, z);
            body.push((
                part,
                contour(&[
                    corner(z.0, x.0),
                    corner(z.1, x.0),
                    corner(z.1, x.1),
                    corner(z.0, x.1),
                ]),
            ));
        };
        if let Some(blade) = &outline.blade {
            let relief = BLADE_RELIEF_MM.min((blade.z.1 - blade.z.0) / 4.0);
            add(
                BodyPart::Holder,
                (blade.z.0 + relief, blade.z.1 - relief),
                (outline.holder_begin, blade.end.max(outline.holder_begin)),
            );
        }
        let blade_end = outline.blade.as_ref().map(|blade| blade.end);
        let begin = blade_end.unwrap_or(outline.holder_begin);
        match tool.holder {
            Holder::None => {}
            Holder::Shank { width, length } => {
                let end = length.max(begin + 1.0);
                let shank = (outline.shank_z, outline.shank_z + width);
                add(BodyPart::Holder, shank, (begin, end));
                let turret = (shank.0 - TURRET_SIDE_MM, shank.1 + TURRET_SIDE_MM);
                add(BodyPart::Turret, turret, (end, end + TURRET_DEPTH_MM));
            }
            Holder::Bar { diameter, length } => {
                let begin = SHANK_SETBACK_MM;
                // The overhang of an insert in front of a bar is small, that of a blade is
                // its length.
                let bar_x = match blade_end {
                    Some(blade_end) => blade_end.max(outline.holder_begin),
                    None => (OVERHANG_SHARE * outline.holder_begin).max(0.3),
                };
                let end = length.max(begin + 1.0);
                add(BodyPart::Holder, (begin, end), (bar_x, bar_x + diameter));
                let middle = bar_x + diameter / 2.0;
                let turret = (middle - TURRET_SIDE_MM, middle + TURRET_SIDE_MM);
                add(BodyPart::Turret, (end, end + TURRET_DEPTH_MM), turret);
            }
        }
        body.retain(|(_, contour)| !contour.is_empty());
        Self {
            cutting: contour(&outline.cutting),
            body,
        }
    }
}

/// How a tool shape in its base orientation is mapped to its mounted orientation.
#[derive(Clone, Copy)]
struct Pose {
    /// Whether X and Z are exchanged first, because the tool is mounted along Z.
    swaps_axes: bool,
    /// Factor of X after the exchange: 1, or -1 to mirror.
    x_sign: f64,
    /// Factor of Z after the exchange: 1, or -1 to mirror.
    z_sign: f64,
}

impl Pose {
    fn from_tool(tool: &Tool) -> Self {
        // Seen from the nose centre, the body is opposite to the tip.
        let tip = tip_direction(tool.tip);
        let sign = |tip: f64| if tip > 0.0 { -1.0 } else { 1.0 };
        Self {
            swaps_axes: tip.x == 0.0 && tip.z != 0.0,
            x_sign: sign(tip.x),
            z_sign: sign(tip.z),
        }
    }

    fn apply(self, point: Point) -> GridPoint {
        let point = match self.swaps_axes {
            true => Point::new(point.z, point.x),
            false => point,
        };
        to_grid(Point::new(point.x * self.x_sign, point.z * self.z_sign))
    }
}

/// Whether a tool is symmetric about the direction of its tip.
fn is_symmetric(tool: &Tool) -> bool {
    let tip = tip_direction(tool.tip);
    (tip.x == 0.0) != (tip.z == 0.0)
}

fn outline(tool: &Tool) -> Outline {
    let tip = tip_direction(tool.tip);
    let centered = tip == Point::default();
    let symmetric = is_symmetric(tool);
    let nose = tool.nose();
    // The nose centre in the base pose.
    let center = match (centered, symmetric) {
        (true, _) => Point::default(),
        (_, true) => Point::new(nose, 0.0),
        _ => Point::new(nose, nose),
    };
    match tool.insert {
        Insert::Turning {
            letter: InsertLetter::R,
            size,
            ..
        } => round(center, size / 2.0),
        Insert::Turning {
            letter,
            entering,
            size,
            ..
        } => {
            let corner = letter.corner();
            let entering = if symmetric {
                90.0 - corner / 2.0
            } else {
                entering
            };
            rhombic(center, nose, letter, entering, size)
        }
        Insert::Grooving { width, nose, reach } => grooving(center, nose, width, reach, symmetric),
        Insert::Threading {
            angle,
            nose,
            height,
        } => threading(nose, angle, height),
        Insert::Drill {
            diameter,
            point,
            reach,
        } => drill(diameter, point, reach),
    }
}

/// The points of a nose arc between two angles, degrees counter-clockwise from +Z, as fine as
/// the grid. They include the points farthest along each axis.
fn nose_arc_points(center: Point, radius: f64, begin: f64, end: f64) -> Vec<Point> {
    use core::f64::consts::PI;
    let to_radians = PI / 180.0;
    let mut stops = vec![begin];
    let quarter = |degrees: f64| libm::ceil(degrees / 90.0 + 1e-9) * 90.0;
    let mut next = quarter(begin);
    while next < end - 1e-9 {
        stops.push(next);
        next += 90.0;
    }
    stops.push(end);
    let mut points = Vec::new();
    for pair in stops.windows(2) {
        let arc = PlaneArc {
            center,
            radius,
            begin: pair[0] * to_radians,
            sweep: (pair[1] - pair[0]) * to_radians,
        };
        points.extend(arc.points());
    }
    points
}

fn round(center: Point, radius: f64) -> Outline {
    Outline {
        cutting: nose_arc_points(center, radius, 0.0, 360.0),
        back: Vec::new(),
        holder_begin: center.x + radius * 0.8,
        shank_z: center.z - radius * 0.6,
        blade: None,
    }
}

/// ```text
///         main edge
///           \   φm       φ: directions of the edges from the theoretical corner V,
///            \           counter-clockwise from +Z:
///   feed <-   \  ε         φm = 180° − entering angle, φs = φm − ε
///              V----- φs   nose centre: on the bisector, r / sin(ε/2) from V
/// ```
fn rhombic(center: Point, nose: f64, letter: InsertLetter, entering: f64, size: f64) -> Outline {
    let corner = letter.corner();
    let (main, second) = (180.0 - entering, 180.0 - entering - corner);
    let half = libm::sin(corner / 2.0 * core::f64::consts::PI / 180.0);
    let bisector = unit_vector((main + second) / 2.0);
    let tip = center - bisector * (nose / half);
    let edge = letter.edge_length_mm(size);
    let (along_main, along_second) = (unit_vector(main) * edge, unit_vector(second) * edge);
    let mut cutting = nose_arc_points(center, nose, main + 90.0, second + 270.0);
    let front = [
        tip + along_main * CUTTING_SHARE,
        tip + along_second * CUTTING_SHARE,
    ];
    cutting.extend(front);
    let mut back = vec![front[0], front[1], tip + along_main, tip + along_second];
    match letter {
        InsertLetter::T => {}
        InsertLetter::W => back.push(tip + (along_main + along_second) * 0.9),
        _ => back.push(tip + along_main + along_second),
    }
    Outline {
        cutting,
        back,
        holder_begin: edge * OVERHANG_SHARE,
        shank_z: tip.z + along_main.z.max(0.0) + SHANK_SETBACK_MM,
        blade: None,
    }
}

fn grooving(center: Point, nose: f64, width: f64, reach: f64, symmetric: bool) -> Outline {
    // The programmed point is a corner or the middle of the edge.
    let low = match (symmetric, center == Point::default() && nose > 0.0) {
        (true, _) => -width / 2.0,
        (false, true) => -nose,
        (false, false) => 0.0,
    };
    let bottom = center.x - nose;
    let high = low + width;
    let mut cutting = nose_arc_points(Point::new(bottom + nose, low + nose), nose, 180.0, 270.0);
    cutting.extend(nose_arc_points(
        Point::new(bottom + nose, high - nose),
        nose,
        270.0,
        360.0,
    ));
    // The insert ends here; the blade extends to the full cutting depth.
    let insert = bottom + reach.min(width.max(2.0) * 1.5);
    cutting.extend([Point::new(insert, low), Point::new(insert, high)]);
    Outline {
        cutting,
        back: Vec::new(),
        holder_begin: insert,
        shank_z: low,
        blade: Some(Blade {
            z: (low, high),
            end: bottom + reach,
        }),
    }
}

fn threading(nose: f64, angle: f64, height: f64) -> Outline {
    let half = angle / 2.0;
    // The programmed point is the middle of the nose for every tip number.
    let mut cutting = nose_arc_points(Point::new(nose, 0.0), nose, 180.0 + half, 360.0 - half);
    let sine = libm::sin(half * core::f64::consts::PI / 180.0);
    let cosine = libm::cos(half * core::f64::consts::PI / 180.0);
    // X of the intersection of both flanks, below the nose.
    let apex = nose - nose / sine;
    let wide = (height - apex) * sine / cosine;
    cutting.extend([Point::new(height, -wide), Point::new(height, wide)]);
    Outline {
        cutting,
        back: Vec::new(),
        holder_begin: height,
        shank_z: -wide,
        blade: None,
    }
}

/// The outline of a drill. In its base pose the axis is X: the point is at 0, the flutes at
/// +X.
fn drill(diameter: f64, point: f64, reach: f64) -> Outline {
    let radius = diameter / 2.0;
    let half = point / 2.0 * core::f64::consts::PI / 180.0;
    let cone = radius * libm::cos(half) / libm::sin(half);
    let end = reach.max(cone);
    Outline {
        cutting: vec![
            Point::new(0.0, 0.0),
            Point::new(cone, -radius),
            Point::new(cone, radius),
            Point::new(end, -radius),
            Point::new(end, radius),
        ],
        back: Vec::new(),
        holder_begin: end,
        shank_z: -radius,
        blade: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{from_grid, mm};
    use crate::region::{GridBounds, Region};

    fn bounds(contour: &[GridPoint]) -> (Point, Point) {
        let bounds = GridBounds::from_points(contour).unwrap();
        (from_grid(bounds.low), from_grid(bounds.high))
    }

    #[test]
    fn the_nose_touches_the_imaginary_tip_of_each_direction() {
        for tip in 1..=8 {
            let tool = Tool {
                tip,
                ..Tool::turning()
            };
            let (low, high) = bounds(&ToolShape::from_tool(&tool).cutting);
            let toward = tip_direction(tip);
            let near = |value: f64| value.abs() < 0.000_11;
            if toward.x < 0.0 {
                assert!(near(low.x), "{tip}: {low:?}");
            }
            if toward.x > 0.0 {
                assert!(near(high.x), "{tip}: {high:?}");
            }
            // With an entering angle of 95° the nose is also the first point along Z.
            if toward.z < 0.0 {
                assert!(near(low.z), "{tip}: {low:?}");
            }
            if toward.z > 0.0 {
                assert!(near(high.z), "{tip}: {high:?}");
            }
        }
    }

    #[test]
    fn points_of_the_nose_are_on_a_circle_about_its_centre() {
        let tool = Tool::turning();
        let shape = ToolShape::from_tool(&tool);
        let center = tool.center();
        assert_eq!(center, Point::new(0.8, 0.8));
        let on_nose = shape
            .cutting
            .iter()
            .map(|point| from_grid(*point) - center)
            .filter(|from| from.x < 0.0 && from.z < 0.5);
        for from in on_nose {
            assert!((from.length() - 0.8).abs() < 0.000_1, "{from:?}");
        }
    }

    #[test]
    fn a_grooving_insert_has_the_given_width() {
        for (tip, low, high) in [(3, 0.0, 3.0), (4, -3.0, 0.0), (8, -1.5, 1.5)] {
            let tool = Tool {
                tip,
                ..Tool::grooving(3.0)
            };
            let (least, greatest) = bounds(&ToolShape::from_tool(&tool).cutting);
            assert_eq!((least.z, greatest.z, least.x), (low, high, 0.0), "{tip}");
        }
    }

    #[test]
    fn a_threading_insert_has_the_given_flank_angle() {
        let shape = ToolShape::from_tool(&Tool::threading(60.0));
        let (low, high) = bounds(&shape.cutting);
        assert_eq!(low.x, 0.0);
        // Flanks of 30° from an apex 0.05 mm below the nose.
        let wide = (4.0 + 0.05) / 3.0_f64.sqrt();
        assert!((high.z - wide).abs() < 0.000_2 && (low.z + wide).abs() < 0.000_2);
    }

    #[test]
    fn a_drill_extends_along_z_from_its_point() {
        let shape = ToolShape::from_tool(&Tool::drill(20.0));
        let (low, high) = bounds(&shape.cutting);
        assert_eq!((low.z, low.x, high.x, high.z), (0.0, -10.0, 10.0, 80.0));
    }

    #[test]
    fn holders_are_clear_of_the_turned_surface_and_of_the_face() {
        let shape = ToolShape::from_tool(&Tool::turning());
        for (part, contour) in &shape.body {
            let (low, _) = bounds(contour);
            let beside = low.z > 0.0 || *part == BodyPart::Turret;
            assert!(low.x > 0.3 && beside, "{part:?} {low:?}");
        }
        let boring = ToolShape::from_tool(&Tool::boring());
        for (part, contour) in &boring.body {
            let (low, high) = bounds(contour);
            assert!(
                high.x < -0.2 || *part == BodyPart::Turret,
                "{part:?} {high:?}"
            );
            assert!(low.z > 0.0, "{part:?} {low:?}");
        }
    }

    #[test]
    fn each_letter_and_tip_gives_a_shape_with_an_area() {
        for letter in InsertLetter::ALL {
            for tip in 0..=9 {
                let tool = Tool {
                    insert: Insert::Turning {
                        letter,
                        entering: 93.0_f64.min(178.0 - letter.corner()),
                        size: 9.525,
                        nose: 0.4,
                    },
                    tip,
                    holder: Holder::None,
                };
                tool.check().unwrap();
                let shape = ToolShape::from_tool(&tool);
                let area = Region::from_contours(core::slice::from_ref(&shape.cutting)).area();
                assert!(area > mm(10_000), "{letter:?} {tip}: {area}");
            }
        }
    }
}
