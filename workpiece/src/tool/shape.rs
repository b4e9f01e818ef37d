//! The shape of a tool, relative to its imaginary tip.

use gsk_units::{Point, tip_direction};

use super::{Holder, Insert, Letter, Tool};
use crate::convex::hull;
use crate::curve::{Arc, direction};
use crate::grid::{Contour, GridPoint, to_grid};

/// Part of its edge that a turning insert may cut with.
const CUTTING_PART: f64 = 0.95;
/// How far the insert stands out of its holder, as a part of its edge.
const OUT_OF_HOLDER: f64 = 0.4;
/// A shank stands back behind the edge that leads, mm.
const SHANK_BACK: f64 = 1.0;
/// A blade is so much narrower than its insert on each side, mm.
const BLADE_RELIEF: f64 = 0.15;
/// The turret beside a holder and beyond it, mm.
const TURRET: (f64, f64) = (40.0, 150.0);

/// What of a tool may touch nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyPart {
    /// The side of the insert that does not cut.
    InsertBack,
    /// The holder.
    Holder,
    /// The turret.
    Turret,
}

/// The shape of a tool: convex polygons relative to its imaginary tip.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// What cuts.
    pub cutting: Contour,
    /// What must not touch anything.
    pub body: Vec<(BodyPart, Contour)>,
}

/// A side of the tool in its base pose: body towards +X, and +Z unless it is even.
#[derive(Default)]
struct Outline {
    cutting: Vec<Point>,
    back: Vec<Point>,
    /// Where the holder begins above the tip, mm.
    out: f64,
    /// Least Z of a shank, mm.
    side: f64,
    /// A blade carries the insert as far as that.
    blade: Option<Blade>,
}

struct Blade {
    from: f64,
    to: f64,
    reach: f64,
}

impl Shape {
    /// Of a tool.
    pub fn of(tool: &Tool) -> Self {
        let outline = outline(tool);
        let pose = Pose::of(tool);
        let contour = |points: &[Point]| hull(points.iter().map(|point| pose.apply(*point)));
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
            let relief = BLADE_RELIEF.min((blade.to - blade.from) / 4.0);
            add(
                BodyPart::Holder,
                (blade.from + relief, blade.to - relief),
                (outline.out, blade.reach.max(outline.out)),
            );
        }
        let begin = outline.blade.as_ref().map_or(outline.out, |it| it.reach);
        match tool.holder {
            Holder::None => {}
            Holder::Shank { width, length } => {
                let end = length.max(begin + 1.0);
                let side = (outline.side, outline.side + width);
                add(BodyPart::Holder, side, (begin, end));
                let turret = (side.0 - TURRET.0, side.1 + TURRET.0);
                add(BodyPart::Turret, turret, (end, end + TURRET.1));
            }
            Holder::Bar { diameter, length } => {
                let begin = SHANK_BACK;
                // The insert stands out of the bar a little, so that it may bore; a blade
                // as far as it reaches.
                let out = match &outline.blade {
                    Some(blade) => blade.reach.max(outline.out),
                    None => (OUT_OF_HOLDER * outline.out).max(0.3),
                };
                let end = length.max(begin + 1.0);
                add(BodyPart::Holder, (begin, end), (out, out + diameter));
                let middle = out + diameter / 2.0;
                let turret = (middle - TURRET.0, middle + TURRET.0);
                add(BodyPart::Turret, (end, end + TURRET.1), turret);
            }
        }
        body.retain(|(_, contour)| !contour.is_empty());
        Self {
            cutting: contour(&outline.cutting),
            body,
        }
    }
}

/// From the base pose of a tool to its own.
#[derive(Clone, Copy)]
struct Pose {
    /// The axes exchanged first: a tool whose body lies along Z.
    across: bool,
    x: f64,
    z: f64,
}

impl Pose {
    fn of(tool: &Tool) -> Self {
        // The body lies on the other side of the centre than the tip.
        let tip = tip_direction(tool.tip);
        let sign = |tip: f64| if tip > 0.0 { -1.0 } else { 1.0 };
        Self {
            across: tip.x == 0.0 && tip.z != 0.0,
            x: sign(tip.x),
            z: sign(tip.z),
        }
    }

    fn apply(self, point: Point) -> GridPoint {
        let point = match self.across {
            true => Point::new(point.z, point.x),
            false => point,
        };
        to_grid(Point::new(point.x * self.x, point.z * self.z))
    }
}

/// Whether a tool stands even about the direction of its tip.
fn is_even(tool: &Tool) -> bool {
    let tip = tip_direction(tool.tip);
    (tip.x == 0.0) != (tip.z == 0.0)
}

fn outline(tool: &Tool) -> Outline {
    // Where the nose centre lies in the base pose.
    let tip = tip_direction(tool.tip);
    let centered = tip == Point::default();
    let even = is_even(tool);
    let nose = tool.nose();
    let center = match (centered, even) {
        (true, _) => Point::default(),
        (_, true) => Point::new(nose, 0.0),
        _ => Point::new(nose, nose),
    };
    match tool.insert {
        Insert::Turning {
            letter: Letter::R,
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
            let entering = if even { 90.0 - corner / 2.0 } else { entering };
            rhombic(center, nose, letter, entering, size)
        }
        Insert::Grooving { width, nose, reach } => grooving(center, nose, width, reach, even),
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

/// The points of a nose on the grid's accuracy, with those where it is widest.
fn nose_points(center: Point, radius: f64, begin: f64, end: f64) -> Vec<Point> {
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
        let arc = Arc {
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
        cutting: nose_points(center, radius, 0.0, 360.0),
        back: Vec::new(),
        out: center.x + radius * 0.8,
        side: center.z - radius * 0.6,
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
fn rhombic(center: Point, nose: f64, letter: Letter, entering: f64, size: f64) -> Outline {
    let corner = letter.corner();
    let (main, second) = (180.0 - entering, 180.0 - entering - corner);
    let half = libm::sin(corner / 2.0 * core::f64::consts::PI / 180.0);
    let bisector = direction((main + second) / 2.0);
    let tip = center - bisector * (nose / half);
    let edge = edge_length(letter, size);
    let (along_main, along_second) = (direction(main) * edge, direction(second) * edge);
    let mut cutting = nose_points(center, nose, main + 90.0, second + 270.0);
    let front = [
        tip + along_main * CUTTING_PART,
        tip + along_second * CUTTING_PART,
    ];
    cutting.extend(front);
    let mut back = vec![front[0], front[1], tip + along_main, tip + along_second];
    match letter {
        Letter::T => {}
        Letter::W => back.push(tip + (along_main + along_second) * 0.9),
        _ => back.push(tip + along_main + along_second),
    }
    Outline {
        cutting,
        back,
        out: edge * OUT_OF_HOLDER,
        side: tip.z + along_main.z.max(0.0) + SHANK_BACK,
        blade: None,
    }
}

/// Length of an edge from the inscribed circle (ISO 1832), mm.
fn edge_length(letter: Letter, size: f64) -> f64 {
    let sine = |degrees: f64| libm::sin(degrees * core::f64::consts::PI / 180.0);
    match letter {
        Letter::C | Letter::D | Letter::V => size / sine(letter.corner()),
        // Tangent of 60°.
        Letter::T => size * 1.732_050_807_568_877_2,
        Letter::W => size * 0.684,
        Letter::S | Letter::R => size,
    }
}

fn grooving(center: Point, nose: f64, width: f64, reach: f64, even: bool) -> Outline {
    // The programmed corner, or the middle of the edge.
    let low = match (even, center == Point::default() && nose > 0.0) {
        (true, _) => -width / 2.0,
        (false, true) => -nose,
        (false, false) => 0.0,
    };
    let bottom = center.x - nose;
    let high = low + width;
    let mut cutting = nose_points(Point::new(bottom + nose, low + nose), nose, 180.0, 270.0);
    cutting.extend(nose_points(
        Point::new(bottom + nose, high - nose),
        nose,
        270.0,
        360.0,
    ));
    // The insert itself; the blade goes on as deep as it reaches.
    let insert = bottom + reach.min(width.max(2.0) * 1.5);
    cutting.extend([Point::new(insert, low), Point::new(insert, high)]);
    Outline {
        cutting,
        back: Vec::new(),
        out: insert,
        side: low,
        blade: Some(Blade {
            from: low,
            to: high,
            reach: bottom + reach,
        }),
    }
}

fn threading(nose: f64, angle: f64, height: f64) -> Outline {
    let half = angle / 2.0;
    // The middle of the point is programmed, whatever the number of the tip.
    let mut cutting = nose_points(Point::new(nose, 0.0), nose, 180.0 + half, 360.0 - half);
    let sine = libm::sin(half * core::f64::consts::PI / 180.0);
    let cosine = libm::cos(half * core::f64::consts::PI / 180.0);
    // Where the flanks would meet below the nose.
    let apex = nose - nose / sine;
    let wide = (height - apex) * sine / cosine;
    cutting.extend([Point::new(height, -wide), Point::new(height, wide)]);
    Outline {
        cutting,
        back: Vec::new(),
        out: height,
        side: -wide,
        blade: None,
    }
}

/// Along its own axis in the base pose: the point down, the flutes up.
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
        out: end,
        side: -radius,
        blade: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{from_grid, mm};
    use crate::region::{Bounds, Region};

    fn bounds(contour: &[GridPoint]) -> (Point, Point) {
        let bounds = Bounds::of(contour).unwrap();
        (from_grid(bounds.low), from_grid(bounds.high))
    }

    #[test]
    fn the_imaginary_tip_of_every_direction_is_where_the_nose_ends() {
        for tip in 1..=8 {
            let tool = Tool {
                tip,
                ..Tool::turning()
            };
            let (low, high) = bounds(&Shape::of(&tool).cutting);
            let toward = tip_direction(tip);
            let near = |value: f64| value.abs() < 0.000_11;
            if toward.x < 0.0 {
                assert!(near(low.x), "{tip}: {low:?}");
            }
            if toward.x > 0.0 {
                assert!(near(high.x), "{tip}: {high:?}");
            }
            // The main edge of 95° leans back: the nose leads in Z, too.
            if toward.z < 0.0 {
                assert!(near(low.z), "{tip}: {low:?}");
            }
            if toward.z > 0.0 {
                assert!(near(high.z), "{tip}: {high:?}");
            }
        }
    }

    #[test]
    fn a_nose_is_a_circle_about_its_centre() {
        let tool = Tool::turning();
        let shape = Shape::of(&tool);
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
    fn a_grooving_insert_is_as_wide_as_it_is_said_to_be() {
        for (tip, low, high) in [(3, 0.0, 3.0), (4, -3.0, 0.0), (8, -1.5, 1.5)] {
            let tool = Tool {
                tip,
                ..Tool::grooving(3.0)
            };
            let (least, greatest) = bounds(&Shape::of(&tool).cutting);
            assert_eq!((least.z, greatest.z, least.x), (low, high, 0.0), "{tip}");
        }
    }

    #[test]
    fn a_threading_insert_has_its_flanks() {
        let shape = Shape::of(&Tool::threading(60.0));
        let (low, high) = bounds(&shape.cutting);
        assert_eq!(low.x, 0.0);
        // 30° flanks about the apex 0.05 mm below the point's end.
        let wide = (4.0 + 0.05) / 3.0_f64.sqrt();
        assert!((high.z - wide).abs() < 0.000_2 && (low.z + wide).abs() < 0.000_2);
    }

    #[test]
    fn a_drill_lies_along_the_axis_with_its_point_ahead() {
        let shape = Shape::of(&Tool::drill(20.0));
        let (low, high) = bounds(&shape.cutting);
        assert_eq!((low.z, low.x, high.x, high.z), (0.0, -10.0, 10.0, 80.0));
    }

    #[test]
    fn holders_keep_clear_of_the_turned_surface_and_of_the_face() {
        let shape = Shape::of(&Tool::turning());
        for (part, contour) in &shape.body {
            let (low, _) = bounds(contour);
            let beside = low.z > 0.0 || *part == BodyPart::Turret;
            assert!(low.x > 0.3 && beside, "{part:?} {low:?}");
        }
        let boring = Shape::of(&Tool::boring());
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
    fn every_letter_and_tip_makes_a_convex_shape() {
        for letter in Letter::ALL {
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
                let shape = Shape::of(&tool);
                let area = Region::of(core::slice::from_ref(&shape.cutting)).area();
                assert!(area > mm(10_000), "{letter:?} {tip}: {area}");
            }
        }
    }
}
