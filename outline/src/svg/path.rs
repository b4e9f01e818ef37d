//! The data of an SVG path as lines and arcs, before its transform.

use core::f64::consts::TAU;

use gsk_messages::{Message, say};
use gsk_units::Point;
use svgtypes::{PathParser, PathSegment};

use super::transform::AffineMap;
use crate::piece::ProfilePiece;

/// Lines and arcs of an element, and how many of its curves were fitted.
#[derive(Default)]
pub(super) struct SvgPieces {
    pub(super) pieces: Vec<ProfilePiece>,
    pub(super) fitted_curves: usize,
}

/// Collects the pieces of an element through its transform.
pub(super) struct PieceCollector {
    pub(super) map: AffineMap,
    pub(super) tolerance: f64,
    pub(super) found: SvgPieces,
}

impl PieceCollector {
    pub(super) fn add_piece(&mut self, piece: ProfilePiece) {
        let mapped = self.map.apply_to_piece(&piece, self.tolerance);
        if mapped.len() > 1 {
            self.found.fitted_curves += 1;
        }
        self.found.pieces.extend(mapped);
    }

    pub(super) fn add_curve(&mut self, point_at: &dyn Fn(f64) -> Point, span: (f64, f64)) {
        let fitted = self.map.fit_curve(point_at, span, self.tolerance);
        self.found.pieces.extend(fitted);
        self.found.fitted_curves += 1;
    }

    /// Adds an arc about a centre; angles in radians from the horizontal axis.
    pub(super) fn add_ellipse(&mut self, ellipse: &EllipseArc) {
        let EllipseArc { begin, sweep, .. } = *ellipse;
        if (ellipse.major.length() - ellipse.minor.length()).abs() > 1e-9 * ellipse.major.length() {
            self.add_curve(&|t| ellipse.point_at(t), (begin, begin + sweep));
            return;
        }
        let turned = libm::atan2(ellipse.major.x, ellipse.major.z);
        let radius = ellipse.major.length();
        let arcs = ProfilePiece::from_center(ellipse.center, radius, begin + turned, sweep);
        for arc in arcs {
            self.add_piece(arc);
        }
    }
}

/// An arc of an ellipse, by its half axes.
pub(super) struct EllipseArc {
    pub(super) center: Point,
    pub(super) major: Point,
    pub(super) minor: Point,
    pub(super) begin: f64,
    pub(super) sweep: f64,
}

impl EllipseArc {
    fn point_at(&self, t: f64) -> Point {
        self.center + self.major * libm::cos(t) + self.minor * libm::sin(t)
    }

    /// The arc of a path command; `None` without length or radius, which is a line.
    fn from_ends(
        (from, to): (Point, Point),
        (rx, ry, rotation): (f64, f64, f64),
        (is_large, is_positive): (bool, bool),
    ) -> Option<Self> {
        let (rx, ry) = (rx.abs(), ry.abs());
        if rx == 0.0 || ry == 0.0 || from == to {
            return None;
        }
        let angle = rotation.to_radians();
        let along = Point::new(libm::sin(angle), libm::cos(angle));
        let across = along.left();
        // In the frame of the ellipse, scaled to the unit circle, from the middle of the chord.
        let half = (from - to) * 0.5;
        let (h, v) = (half.dot(along) / rx, half.dot(across) / ry);
        let square = h * h + v * v;
        let scale = if square > 1.0 { square.sqrt() } else { 1.0 };
        let (rx, ry, h, v) = (rx * scale, ry * scale, h / scale, v / scale);
        let height = ((1.0 / (h * h + v * v)) - 1.0).max(0.0).sqrt();
        let side = if is_large == is_positive {
            -height
        } else {
            height
        };
        let (center_h, center_v) = (side * v, -side * h);
        let begin = libm::atan2(v - center_v, h - center_h);
        let end = libm::atan2(-v - center_v, -h - center_h);
        let turn = libm::fmod(end - begin, TAU);
        let sweep = match is_positive {
            true if turn < 0.0 => turn + TAU,
            false if turn > 0.0 => turn - TAU,
            _ => turn,
        };
        let middle = (from + to) * 0.5;
        Some(Self {
            center: middle + along * (center_h * rx) + across * (center_v * ry),
            major: along * rx,
            minor: across * ry,
            begin,
            sweep,
        })
    }
}

/// Where a path is: its last point, the start of its subpath, and the control point that a
/// smooth curve mirrors.
struct PathPosition {
    at: Point,
    begin: Point,
    cubic_control: Point,
    quadratic_control: Point,
}

/// Adds the pieces of path data.
pub(super) fn read_path(
    data: &str,
    line: usize,
    collector: &mut PieceCollector,
) -> Result<(), Message> {
    let mut position = PathPosition {
        at: Point::default(),
        begin: Point::default(),
        cubic_control: Point::default(),
        quadratic_control: Point::default(),
    };
    for segment in PathParser::from(data) {
        let segment = segment.map_err(|_| say::outline_bad_path(line))?;
        position.add_segment(segment, collector);
    }
    Ok(())
}

impl PathPosition {
    fn add_segment(&mut self, segment: PathSegment, collector: &mut PieceCollector) {
        let at = self.at;
        let point = |abs: bool, x: f64, y: f64| match abs {
            true => Point::new(y, x),
            false => at + Point::new(y, x),
        };
        match segment {
            PathSegment::MoveTo { abs, x, y } => {
                self.end_at(point(abs, x, y));
                self.begin = self.at;
            }
            PathSegment::LineTo { abs, x, y } => self.line_to(point(abs, x, y), collector),
            PathSegment::HorizontalLineTo { abs, x } => {
                let to = point(abs, x, if abs { at.x } else { 0.0 });
                self.line_to(to, collector);
            }
            PathSegment::VerticalLineTo { abs, y } => {
                let to = point(abs, if abs { at.z } else { 0.0 }, y);
                self.line_to(to, collector);
            }
            PathSegment::ClosePath { .. } => self.line_to(self.begin, collector),
            PathSegment::CurveTo {
                abs,
                x1,
                y1,
                x2,
                y2,
                x,
                y,
            } => self.cubic_to(
                point(abs, x1, y1),
                point(abs, x2, y2),
                point(abs, x, y),
                collector,
            ),
            PathSegment::SmoothCurveTo { abs, x2, y2, x, y } => {
                let mirrored = at * 2.0 - self.cubic_control;
                self.cubic_to(mirrored, point(abs, x2, y2), point(abs, x, y), collector);
            }
            PathSegment::Quadratic { abs, x1, y1, x, y } => {
                self.quadratic_to(point(abs, x1, y1), point(abs, x, y), collector);
            }
            PathSegment::SmoothQuadratic { abs, x, y } => {
                let mirrored = at * 2.0 - self.quadratic_control;
                self.quadratic_to(mirrored, point(abs, x, y), collector);
            }
            PathSegment::EllipticalArc {
                abs,
                rx,
                ry,
                x_axis_rotation,
                large_arc,
                sweep,
                x,
                y,
            } => {
                let to = point(abs, x, y);
                let radii = (rx, ry, x_axis_rotation);
                match EllipseArc::from_ends((at, to), radii, (large_arc, sweep)) {
                    Some(arc) => collector.add_ellipse(&arc),
                    None => collector.add_piece(ProfilePiece::line(at, to)),
                }
                self.end_at(to);
            }
        }
    }

    fn end_at(&mut self, to: Point) {
        self.at = to;
        self.cubic_control = to;
        self.quadratic_control = to;
    }

    fn line_to(&mut self, to: Point, collector: &mut PieceCollector) {
        collector.add_piece(ProfilePiece::line(self.at, to));
        self.end_at(to);
    }

    fn cubic_to(&mut self, first: Point, second: Point, to: Point, collector: &mut PieceCollector) {
        let points = [self.at, first, second, to];
        collector.add_curve(&|t| bezier(&points, t), (0.0, 1.0));
        self.end_at(to);
        self.cubic_control = second;
    }

    fn quadratic_to(&mut self, control: Point, to: Point, collector: &mut PieceCollector) {
        let points = [self.at, control, to];
        collector.add_curve(&|t| bezier(&points, t), (0.0, 1.0));
        self.end_at(to);
        self.quadratic_control = control;
    }
}

/// The point of a Bézier curve by its control points.
fn bezier(points: &[Point], t: f64) -> Point {
    let mut row: Vec<Point> = points.to_vec();
    while row.len() > 1 {
        row = (row.windows(2))
            .map(|pair| pair[0] * (1.0 - t) + pair[1] * t)
            .collect();
    }
    row.first().copied().unwrap_or_default()
}
