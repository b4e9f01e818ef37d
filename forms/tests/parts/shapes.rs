//! The dimensions that each form promises, from its fields alone.

use gsk_workpiece::measure::{Feature, SectionSide};

use super::TOLERANCE_MM;
use super::cut::CutPart;

const fn side_of(is_inside: bool) -> SectionSide {
    match is_inside {
        true => SectionSide::Inside,
        false => SectionSide::Outside,
    }
}

pub fn face(part: &CutPart) {
    let stock = part.number("STOCK");
    let (core, nose) = (part.number("BORE"), part.number("NOSE"));
    for x in [core + 0.02, (core + stock) / 2.0, stock] {
        part.assert_passes(SectionSide::Outside, x, 0.0);
    }
    assert!(nose >= 0.0);
    let front = part
        .features(SectionSide::Outside)
        .into_iter()
        .filter_map(|it| match it {
            Feature::Face { z, .. } => Some(z),
            _ => None,
        });
    part.assert_near(front.fold(f64::NEG_INFINITY, f64::max), 0.0);
}

/// A corner between two lines with an arc or a chamfer: points on it. X is a radius here.
struct Corner {
    at: (f64, f64),
    before: (f64, f64),
    after: (f64, f64),
}

impl Corner {
    fn unit(from: (f64, f64), to: (f64, f64)) -> (f64, f64) {
        let (x, z) = (to.0 - from.0, to.1 - from.1);
        let length = x.hypot(z);
        (x / length, z / length)
    }

    /// The middle of an arc that touches both lines.
    fn arc_middle(&self, radius: f64) -> (f64, f64) {
        let (one, two) = (
            Self::unit(self.at, self.before),
            Self::unit(self.at, self.after),
        );
        let half = ((one.0 * two.0 + one.1 * two.1).clamp(-1.0, 1.0)).acos() / 2.0;
        let middle = Self::unit((0.0, 0.0), (one.0 + two.0, one.1 + two.1));
        let distance = radius / half.sin() - radius;
        (
            self.at.0 + middle.0 * distance,
            self.at.1 + middle.1 * distance,
        )
    }

    /// The middle of a chamfer that shortens both lines by `length`.
    fn chamfer_middle(&self, length: f64) -> (f64, f64) {
        let (one, two) = (
            Self::unit(self.at, self.before),
            Self::unit(self.at, self.after),
        );
        let half = length / 2.0;
        (
            self.at.0 + half * (one.0 + two.0),
            self.at.1 + half * (one.1 + two.1),
        )
    }
}

pub fn turned(part: &CutPart) {
    let inside = part.is_inside();
    let side = side_of(inside);
    let sign = if inside { -1.0 } else { 1.0 };
    let (end, front) = (part.number("D") / 2.0, part.number("DF") / 2.0);
    let length = part.number("L");
    let middle = (f64::midpoint(end, front), -length / 2.0);
    part.assert_passes(side, 2.0 * middle.0, middle.1);
    let edge = Corner {
        at: (front, 0.0),
        before: (front - sign, 0.0),
        after: (end, -length),
    };
    let edge = match part.text("EDGE").as_str() {
        "CHAMFER" => edge.chamfer_middle(part.number("C")),
        "RADIUS" => edge.arc_middle(part.number("C")),
        _ => edge.at,
    };
    part.assert_passes(side, 2.0 * edge.0, edge.1);
    let shoulder = Corner {
        at: (end, -length),
        before: (front, 0.0),
        after: (end + sign, -length),
    };
    // A sharp corner keeps the nose of the insert.
    let radius = part.number("R").max(part.number("NOSE"));
    let foot = shoulder.arc_middle(radius);
    part.assert_passes(side, 2.0 * foot.0, foot.1);
    let edge = match inside {
        true => part.number("HOLE"),
        false => part.number("STOCK"),
    };
    part.assert_passes(side, edge, -length);
}

/// A point of the text of an outline, as the test itself reads it; X is a radius.
#[derive(Clone, Copy, Default)]
struct Given {
    x: f64,
    z: f64,
    radius: f64,
    chamfer: f64,
}

fn read_points(text: &str) -> Vec<Given> {
    let mut points: Vec<Given> = Vec::new();
    for words in text.split('/') {
        let number = |letter: char| {
            let (_, rest) = words.split_once(letter)?;
            let end = rest
                .find(|it: char| it.is_ascii_alphabetic())
                .unwrap_or(rest.len());
            rest[..end].parse::<f64>().ok()
        };
        let last = points.last().copied().unwrap_or_default();
        let x = number('X').map_or(last.x, |x| x / 2.0);
        let angle = number('A').map(|it| (x - last.x).abs() / it.to_radians().tan());
        let z = number('Z').or_else(|| number('L').or(angle).map(|it| last.z - it));
        points.push(Given {
            x,
            z: z.unwrap_or(last.z),
            radius: number('R').unwrap_or(0.0),
            chamfer: number('C').unwrap_or(0.0),
        });
    }
    points
}

pub fn contour(part: &CutPart) {
    let side = side_of(part.is_inside());
    let sign = if part.is_inside() { -1.0 } else { 1.0 };
    let points = read_points(&part.text("POINTS"));
    for (index, point) in points.iter().enumerate().take(points.len() - 1) {
        let next = points[index + 1];
        let before = match index {
            0 => (point.x - sign, 0.0),
            _ => (points[index - 1].x, points[index - 1].z),
        };
        let corner = Corner {
            at: (point.x, point.z),
            before,
            after: (next.x, next.z),
        };
        let one = Corner::unit(corner.before, corner.at);
        let two = Corner::unit(corner.at, corner.after);
        let straight = one.0 * two.0 + one.1 * two.1 > 1.0 - 1e-12;
        if point.chamfer > 0.0 {
            let middle = corner.chamfer_middle(point.chamfer);
            part.assert_passes(side, 2.0 * middle.0, middle.1);
        } else if point.radius > 0.0 && !straight {
            let middle = corner.arc_middle(point.radius);
            part.assert_passes(side, 2.0 * middle.0, middle.1);
        }
        part.assert_passes(side, point.x + next.x, f64::midpoint(point.z, next.z));
    }
}

pub fn groove(part: &CutPart) {
    let side = side_of(part.is_inside());
    let (surface, bottom) = (part.number("D"), part.number("DB"));
    let count = part.number("COUNT") as usize;
    for index in 0..count {
        let shift = if index > 0 {
            index as f64 * part.number("STEP")
        } else {
            0.0
        };
        let near = -part.number("POS") - shift;
        let far = near - part.number("W");
        part.assert_passes(side, bottom, f64::midpoint(near, far));
        let height = f64::midpoint(surface, bottom);
        part.assert_passes(side, height, near);
        part.assert_passes(side, height, far);
    }
}

pub fn part_off(part: &CutPart) {
    let end = -part.number("L") - part.number("TW");
    let front = part
        .features(SectionSide::Outside)
        .into_iter()
        .map(|it| match it {
            Feature::Face { z, .. } => z,
            Feature::Cylinder { z, .. }
            | Feature::Cone { z, .. }
            | Feature::Arc { z, .. }
            | Feature::Thread { z, .. } => z.0.max(z.1),
        });
    part.assert_near(front.fold(f64::NEG_INFINITY, f64::max), end);
}

pub fn thread(part: &CutPart) {
    let inside = part.is_inside();
    let designation = part.text("THREAD");
    let row =
        gsk_forms::thread_rows().find(|row| row.designation.eq_ignore_ascii_case(&designation));
    let row = row.unwrap();
    let (profile, pitch, side) = (row.profile(inside), row.pitch.mm(), side_of(inside));
    if profile.taper != 0.0 {
        // Along a taper each groove has another diameter: the first one, at the face.
        let slope = profile.taper * pitch;
        let (least, most) = part.diameters_within(side, (-1.5 * pitch, -0.05));
        let root = if inside { most } else { least };
        assert!(
            (root - profile.root).abs() <= 1.5 * slope.abs() + TOLERANCE_MM,
            "{}",
            part.section
        );
        return;
    }
    let run_out = part.number("STARTS") * pitch;
    let zone = (-part.number("L") + run_out + 1.5 * pitch, -pitch);
    let (least, most) = part.diameters_within(side, zone);
    let (crest, root) = if inside { (least, most) } else { (most, least) };
    part.assert_near(crest, profile.blank);
    part.assert_near(root, profile.root);
    let grooves = part.rising_crossings(side, f64::midpoint(crest, root), zone);
    assert!(grooves.len() > 2, "{}", part.section);
    for pair in grooves.windows(2) {
        part.assert_near(pair[0] - pair[1], pitch);
    }
}

pub fn drill(part: &CutPart) {
    let (diameter, length) = (part.number("D"), part.number("L"));
    part.assert_passes(SectionSide::Inside, diameter, -length / 2.0);
    part.assert_passes(SectionSide::Inside, diameter, -length);
    let point = (part.number("POINT") / 2.0).to_radians();
    let depth = length + diameter / 2.0 / point.tan();
    part.assert_passes(SectionSide::Inside, 0.0, -depth);
}

pub fn center(part: &CutPart) {
    let diameter = part.number("D");
    part.assert_passes(SectionSide::Inside, diameter, 0.0);
    let point = (part.number("POINT") / 2.0).to_radians();
    part.assert_passes(
        SectionSide::Inside,
        diameter / 2.0,
        -diameter / 4.0 / point.tan(),
    );
}
