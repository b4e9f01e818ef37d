//! Transforms of SVG elements.

use gsk_messages::{Message, say};
use gsk_units::Point;
use svgtypes::{TransformListParser, TransformListToken};

use crate::curve_fit::fit_arcs;
use crate::piece::ProfilePiece;

/// An affine map of points: `horizontal' = a·h + c·v + e`, `vertical' = b·h + d·v + f`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AffineMap {
    a: f64,
    b: f64,
    c: f64,
    d: f64,
    e: f64,
    f: f64,
}

impl AffineMap {
    /// The map of the whole drawing: SVG has its vertical axis downwards.
    pub(super) const UPWARDS: Self = Self::new([1.0, 0.0, 0.0, -1.0, 0.0, 0.0]);

    const fn new([a, b, c, d, e, f]: [f64; 6]) -> Self {
        Self { a, b, c, d, e, f }
    }

    /// The map of a `transform` attribute.
    pub(super) fn parse(text: &str, line: usize) -> Result<Self, Message> {
        let mut map = Self::new([1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
        for token in TransformListParser::from(text) {
            let token = token.map_err(|_| say::outline_bad_transform(line))?;
            map = map.then_inner(Self::from_token(token));
        }
        Ok(map)
    }

    fn from_token(token: TransformListToken) -> Self {
        match token {
            TransformListToken::Matrix { a, b, c, d, e, f } => Self::new([a, b, c, d, e, f]),
            TransformListToken::Translate { tx, ty } => Self::new([1.0, 0.0, 0.0, 1.0, tx, ty]),
            TransformListToken::Scale { sx, sy } => Self::new([sx, 0.0, 0.0, sy, 0.0, 0.0]),
            TransformListToken::Rotate { angle } => {
                let (sin, cos) = sin_cos_degrees(angle);
                Self::new([cos, sin, -sin, cos, 0.0, 0.0])
            }
            TransformListToken::SkewX { angle } => {
                let slope = libm::tan(angle.to_radians());
                Self::new([1.0, 0.0, slope, 1.0, 0.0, 0.0])
            }
            TransformListToken::SkewY { angle } => {
                let slope = libm::tan(angle.to_radians());
                Self::new([1.0, slope, 0.0, 1.0, 0.0, 0.0])
            }
        }
    }

    /// The map that applies `inner` first and then this one.
    pub(super) fn then_inner(self, inner: Self) -> Self {
        let column = |h: f64, v: f64| (self.a * h + self.c * v, self.b * h + self.d * v);
        let ((a, b), (c, d)) = (column(inner.a, inner.b), column(inner.c, inner.d));
        let (e, f) = column(inner.e, inner.f);
        Self::new([a, b, c, d, e + self.e, f + self.f])
    }

    fn apply(self, point: Point) -> Point {
        Point::new(
            self.b * point.z + self.d * point.x + self.f,
            self.a * point.z + self.c * point.x + self.e,
        )
    }

    /// Whether circles stay circles.
    fn keeps_circles(self) -> bool {
        let (first, second) = (Point::new(self.b, self.a), Point::new(self.d, self.c));
        let size = first.dot(first) + second.dot(second);
        let is_right_angle = first.dot(second).abs() <= 1e-9 * size;
        is_right_angle && (first.dot(first) - second.dot(second)).abs() <= 1e-9 * size
    }

    /// The pieces that a piece becomes; an arc that becomes elliptical is fitted by arcs.
    pub(super) fn apply_to_piece(self, piece: &ProfilePiece, tolerance: f64) -> Vec<ProfilePiece> {
        if piece.is_arc() && !self.keeps_circles() {
            return fit_arcs(&|at| self.apply(piece.point_at(at)), (0.0, 1.0), tolerance);
        }
        let is_mirror = self.a * self.d - self.b * self.c < 0.0;
        vec![ProfilePiece {
            start: self.apply(piece.start),
            end: self.apply(piece.end),
            bulge: if is_mirror { -piece.bulge } else { piece.bulge },
        }]
    }

    /// The arcs of a curve whose points are given before the map.
    pub(super) fn fit_curve(
        self,
        point_at: &dyn Fn(f64) -> Point,
        span: (f64, f64),
        tolerance: f64,
    ) -> Vec<ProfilePiece> {
        fit_arcs(&|at| self.apply(point_at(at)), span, tolerance)
    }
}

/// Sine and cosine of an angle in degrees, exact for right angles.
fn sin_cos_degrees(angle: f64) -> (f64, f64) {
    let angle = libm::fmod(angle, 360.0);
    match angle {
        0.0 => (0.0, 1.0),
        90.0 | -270.0 => (1.0, 0.0),
        180.0 | -180.0 => (0.0, -1.0),
        270.0 | -90.0 => (-1.0, 0.0),
        _ => (libm::sin(angle.to_radians()), libm::cos(angle.to_radians())),
    }
}
