//! The toolpath as a picture: one drawing, written as PNG or as SVG.

mod layout;
mod png_file;
mod svg;

use std::path::Path;

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::memory::Parameters;
use gsk_core::units::{Axis, Point};

use layout::Layout;
pub use png_file::encode as encode_png;

/// Width of the picture, pixels.
pub const WIDTH: u32 = 1280;
/// Height of the picture, pixels.
pub const HEIGHT: u32 = 800;

/// A piece of toolpath, as points in the program frame (radius, mm).
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Rapid (dashed) or cut.
    pub rapid: bool,
    /// Its points.
    pub points: Vec<Point>,
}

/// The drawing: what the path looks like, and the words around it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Text in the upper left corner.
    pub title: String,
    /// The path in the order of execution.
    pub strokes: Vec<Stroke>,
}

/// Rapid rates, for the bend in the path of a rapid with both axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RapidRates {
    /// mm/min of radius.
    pub x: f64,
    /// mm/min.
    pub z: f64,
}

impl RapidRates {
    /// Of a control.
    pub fn of(parameters: &Parameters) -> Self {
        Self {
            x: parameters.rapid_rate(Axis::X),
            z: parameters.rapid_rate(Axis::Z),
        }
    }
}

impl Drawing {
    /// A drawing without a path yet.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            strokes: Vec::new(),
        }
    }

    /// Adds a move; neighbouring moves of one kind become one stroke.
    pub fn push(&mut self, executed: &ExecutedMove, rates: RapidRates) {
        let points = match executed.kind {
            MoveKind::Dwell => return,
            MoveKind::Rapid => rapid_points(executed.from, executed.to, rates),
            MoveKind::Feed | MoveKind::Thread | MoveKind::RunOut => {
                vec![executed.from, executed.to]
            }
            MoveKind::Clockwise | MoveKind::CounterClockwise => {
                let clockwise = executed.kind == MoveKind::Clockwise;
                let center = executed.center.unwrap_or(executed.from);
                arc_points(executed.from, executed.to, center, clockwise)
            }
        };
        let rapid = executed.kind == MoveKind::Rapid;
        match self.strokes.last_mut() {
            Some(last) if last.rapid == rapid && last.points.last() == points.first() => {
                last.points.extend_from_slice(&points[1..]);
            }
            _ => self.strokes.push(Stroke { rapid, points }),
        }
    }
}

/// Rapids move both axes at their own rates: at 45° on equal ones, then along
/// the axis that has further to go.
fn rapid_points(from: Point, to: Point, rates: RapidRates) -> Vec<Point> {
    let way = to - from;
    let time_x = way.x.abs() / rates.x.max(1.0);
    let time_z = way.z.abs() / rates.z.max(1.0);
    if time_x == 0.0 || time_z == 0.0 {
        return vec![from, to];
    }
    let both = time_x.min(time_z);
    let bend = Point::new(
        from.x + way.x * (both / time_x),
        from.z + way.z * (both / time_z),
    );
    vec![from, bend, to]
}

fn arc_points(from: Point, to: Point, center: Point, clockwise: bool) -> Vec<Point> {
    let (first, last) = (from - center, to - center);
    let radius = first.length();
    let start = first.x.atan2(first.z);
    let mut sweep = last.x.atan2(last.z) - start;
    let turn = std::f64::consts::TAU;
    if clockwise && sweep >= -1e-12 {
        sweep -= turn;
    } else if !clockwise && sweep <= 1e-12 {
        sweep += turn;
    }
    let steps = ((sweep.abs() / turn * 180.0).ceil() as usize).clamp(2, 360);
    let on_arc = |step: usize| {
        let angle = start + sweep * step as f64 / steps as f64;
        center + Point::new(angle.sin() * radius, angle.cos() * radius)
    };
    let mut points = vec![from];
    points.extend((1..steps).map(on_arc));
    points.push(to);
    points
}

/// Writes a drawing; the ending of the name decides between PNG and SVG.
pub fn write(path: &Path, drawing: &Drawing) -> Result<(), String> {
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let bytes = match ending.as_deref() {
        Some("svg") => svg::render(drawing).into_bytes(),
        Some("png") => png_file::render(drawing)?,
        _ => {
            return Err(format!(
                "{}: a picture's name ends in .png or .svg",
                path.display()
            ));
        }
    };
    std::fs::write(path, bytes)
        .map_err(|error| format!("{} cannot be written: {error}", path.display()))
}

/// Whether a name can become a picture.
pub fn check_name(path: &Path) -> Result<(), String> {
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    match ending.as_deref() {
        Some("png" | "svg") => Ok(()),
        _ => Err(format!(
            "{}: a picture's name ends in .png or .svg",
            path.display()
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arcs_stay_on_their_circle_and_go_the_right_way() {
        let (from, to) = (Point::new(10.0, 0.0), Point::new(0.0, 10.0));
        for (clockwise, sign) in [(true, 1.0), (false, -1.0)] {
            let points = arc_points(from, to, Point::default(), clockwise);
            assert_eq!((points[0], points[points.len() - 1]), (from, to));
            for point in &points {
                assert!((point.length() - 10.0).abs() < 1e-9);
            }
            // From the top, clockwise goes to the right.
            assert!(points[1].z * sign > 0.0);
        }
    }

    #[test]
    fn a_rapid_bends_where_the_first_axis_arrives() {
        let rates = RapidRates {
            x: 3800.0,
            z: 7600.0,
        };
        let points = rapid_points(Point::default(), Point::new(10.0, 100.0), rates);
        assert_eq!(
            points,
            [
                Point::default(),
                Point::new(10.0, 20.0),
                Point::new(10.0, 100.0)
            ]
        );
    }

    #[test]
    fn both_kinds_of_picture_are_made() {
        let mut drawing = Drawing::new("O0001 轴");
        drawing.strokes.push(Stroke {
            rapid: false,
            points: vec![Point::new(25.0, 0.0), Point::new(25.0, -40.0)],
        });
        let svg = svg::render(&drawing);
        assert!(svg.starts_with("<svg") && svg.contains("polyline") && svg.contains("O0001 轴"));
        let png = png_file::render(&drawing).expect("picture");
        assert!(png.starts_with(b"\x89PNG"));
        let empty = Drawing::new("<&>");
        assert!(svg::render(&empty).contains("&lt;&amp;&gt;"));
        assert!(png_file::render(&empty).is_ok());
    }
}
