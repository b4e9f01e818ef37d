//! Where things lie in the picture: the scale, the grid, the corner texts.

use gsk_core::units::Point;

use super::extent::{Extent, HEIGHT, MARGIN, TOP, WIDTH, pixel_mm, room};

/// A grid line with its label.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Pixel coordinate across the line.
    pub at: f64,
    /// mm, as a diameter for X.
    pub label: String,
}

/// The mapping from mm to pixels and what is derived from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    scale: f64,
    left_z: f64,
    bottom_x: f64,
    /// Vertical grid lines (Z).
    pub z_ticks: Vec<Tick>,
    /// Horizontal grid lines (X as a diameter).
    pub x_ticks: Vec<Tick>,
    /// Pixel height of the spindle axis, if it is in the picture.
    pub spindle_axis: Option<f64>,
}

impl Layout {
    /// Fits what reaches so far into the picture; Z to the right, X up, one scale.
    pub(super) fn new(extent: Option<Extent>) -> Self {
        let (low, high) = bounds(extent);
        let (wide, tall) = (high.z - low.z, high.x - low.x);
        let (room_z, room_x) = room();
        let scale = 1.0 / pixel_mm(high - low);
        let mut layout = Self {
            scale,
            left_z: low.z - (room_z / scale - wide) / 2.0,
            bottom_x: low.x - (room_x / scale - tall) / 2.0,
            z_ticks: Vec::new(),
            x_ticks: Vec::new(),
            spindle_axis: None,
        };
        layout.z_ticks = ticks(layout.left_z, room_z / scale)
            .map(|z| Tick {
                at: layout.place(Point::new(0.0, z)).0,
                label: label(z),
            })
            .collect();
        layout.x_ticks = ticks(layout.bottom_x * 2.0, room_x / scale * 2.0)
            .map(|x| Tick {
                at: layout.place(Point::new(x / 2.0, 0.0)).1,
                label: label(x),
            })
            .collect();
        let axis = layout.place(Point::default()).1;
        layout.spindle_axis = (TOP..=f64::from(HEIGHT) - MARGIN)
            .contains(&axis)
            .then_some(axis);
        layout
    }

    /// The pixel of a point.
    pub fn place(&self, point: Point) -> (f64, f64) {
        let x = MARGIN + (point.z - self.left_z) * self.scale;
        let y = f64::from(HEIGHT) - MARGIN - (point.x - self.bottom_x) * self.scale;
        (x, y)
    }

    /// Pixels from left to right that the grid covers.
    pub fn across() -> (f64, f64) {
        (MARGIN, f64::from(WIDTH) - MARGIN)
    }

    /// Pixels from top to bottom that the grid covers.
    pub fn down() -> (f64, f64) {
        (TOP, f64::from(HEIGHT) - MARGIN)
    }
}

/// The box that is shown: the one around the path with some room, never empty.
fn bounds(extent: Option<Extent>) -> (Point, Point) {
    let Some(Extent { mut low, high }) = extent else {
        return (Point::new(0.0, -50.0), Point::new(50.0, 50.0));
    };
    // The spindle axis belongs to the picture unless it is far away.
    if low.x > 0.0 && low.x < 3.0 * (high.x - low.x) {
        low.x = 0.0;
    }
    let room = Point::new(
        (high.x - low.x).max(1.0) * 0.03,
        (high.z - low.z).max(1.0) * 0.03,
    );
    (low - room, high + room)
}

/// Round values inside a stretch, about ten of them.
fn ticks(start: f64, length: f64) -> impl Iterator<Item = f64> {
    let raw = length / 10.0;
    let power = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|step| *step >= raw)
        .unwrap_or(10.0 * power);
    let first = (start / step).ceil();
    let count = ((start + length) / step).floor() - first;
    (0..=count.clamp(0.0, 100.0) as u32).map(move |index| (first + f64::from(index)) * step)
}

fn label(value: f64) -> String {
    let rounded = (value * 1000.0).round() / 1000.0;
    if rounded == 0.0 {
        "0".to_owned()
    } else {
        rounded.to_string()
    }
}
