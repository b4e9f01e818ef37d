//! Computes positions in the picture: the scale, the grid, the corner texts.

use gsk_core::units::Point;
use gsk_messages::Language;

use crate::dimensions::{BELOW_AXIS, Dimension};
use crate::drawing::PathDrawing;
use crate::extent::{PATH_MARGIN, PathExtent};
use crate::legend::PictureHead;
use crate::number_placement::{OccupancyMap, PictureArea, PlacedNumber, place_numbers};

/// A grid line across the path, with its label.
#[derive(Clone, Debug, PartialEq)]
pub struct GridTick {
    /// Position of the line along its axis, picture units from the left or the top.
    pub position: f64,
    /// Text of the grid line: its coordinate in mm; X as a diameter.
    pub label: String,
}

/// The mapping from mm to picture units, and the positions of grid, texts and dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct PathLayout {
    /// Width and height of the picture, picture units.
    pub size: (f64, f64),
    /// The title and legend above the path.
    pub head: PictureHead,
    /// The frame around the path, picture units.
    pub frame: PictureArea,
    scale: f64,
    left_z: f64,
    bottom_x: f64,
    /// Vertical grid lines, at round values of Z.
    pub z_ticks: Vec<GridTick>,
    /// Horizontal grid lines, at round values of the X diameter.
    pub x_ticks: Vec<GridTick>,
    /// Vertical position of the spindle axis, picture units; `None` if it is outside the
    /// frame.
    pub spindle_axis: Option<f64>,
    /// The dimensions of the part with their positions in the picture.
    pub dimensions: Vec<Dimension>,
    /// The labels of blocks with their positions in the picture.
    pub numbers: Vec<PlacedNumber>,
}

impl PathLayout {
    /// Fits a drawing into its picture: Z to the right, X up, both with the same scale.
    pub(super) fn new(drawing: &PathDrawing, language: Language) -> Self {
        let size @ (width, height) = drawing.options().size.units();
        let head = PictureHead::new(drawing, width, language);
        // A legend of a hundred tools must leave space for the picture.
        let top = head.height.min(height / 2.0);
        let frame = (PATH_MARGIN, top, width - PATH_MARGIN, height - PATH_MARGIN);
        let dimensions = &drawing.scenery().dimensions;
        let below = if dimensions.is_empty() {
            0.0
        } else {
            BELOW_AXIS
        };
        let (room_z, room_x) = (frame.2 - frame.0, frame.3 - frame.1 - below);
        let (low, high) = shown_bounds(drawing.extent());
        let (wide, tall) = (high.z - low.z, high.x - low.x);
        let scale = (room_z / wide).min(room_x / tall);
        let mut layout = Self {
            size,
            head,
            frame,
            scale,
            left_z: low.z - (room_z / scale - wide) / 2.0,
            bottom_x: low.x - below / scale - (room_x / scale - tall) / 2.0,
            z_ticks: Vec::new(),
            x_ticks: Vec::new(),
            spindle_axis: None,
            dimensions: Vec::new(),
            numbers: Vec::new(),
        };
        layout.z_ticks = tick_values(layout.left_z, room_z / scale, room_z)
            .map(|z| GridTick {
                position: layout.to_units(Point::new(0.0, z)).0,
                label: tick_label(z),
            })
            .collect();
        let room_x = room_x + below;
        layout.x_ticks = tick_values(layout.bottom_x * 2.0, room_x / scale * 2.0, room_x)
            .map(|x| GridTick {
                position: layout.to_units(Point::new(x / 2.0, 0.0)).1,
                label: tick_label(x),
            })
            .collect();
        let axis = layout.to_units(Point::default()).1;
        layout.spindle_axis = (frame.1..=frame.3).contains(&axis).then_some(axis);
        let mut taken = OccupancyMap::new(frame);
        layout.dimensions = dimensions.place_all(|point| layout.to_units(point), &mut taken);
        let numbers = drawing.labels().into_iter();
        let numbers = numbers.map(|(point, words)| (layout.to_units(point), words));
        layout.numbers = place_numbers(numbers, frame, &mut taken);
        layout
    }

    /// Returns the least and greatest point of the frame, mm; X as a radius.
    pub fn visible_range(&self) -> (Point, Point) {
        let (left, top, right, bottom) = self.frame;
        let size = Point::new(bottom - top, right - left) * (1.0 / self.scale);
        let low = Point::new(self.bottom_x, self.left_z);
        (low, low + size)
    }

    /// Whether a point, mm, is inside the frame.
    pub fn contains(&self, point: Point) -> bool {
        let (low, high) = self.visible_range();
        (low.x..=high.x).contains(&point.x) && (low.z..=high.z).contains(&point.z)
    }

    /// Converts a point, mm, to picture units from the upper left corner.
    pub fn to_units(&self, point: Point) -> (f64, f64) {
        let x = self.frame.0 + (point.z - self.left_z) * self.scale;
        let y = self.frame.3 - (point.x - self.bottom_x) * self.scale;
        (x, y)
    }
}

/// Least and greatest point to show, mm: the bounds of the path with a margin, never empty.
fn shown_bounds(extent: Option<PathExtent>) -> (Point, Point) {
    let Some(PathExtent { mut low, high }) = extent else {
        return (Point::new(0.0, -50.0), Point::new(50.0, 50.0));
    };
    // The spindle axis is part of the picture unless it is far away.
    if low.x > 0.0 && low.x < 3.0 * (high.x - low.x) {
        low.x = 0.0;
    }
    let room = Point::new(
        (high.x - low.x).max(1.0) * 0.03,
        (high.z - low.z).max(1.0) * 0.03,
    );
    (low - room, high + room)
}

/// Approximate distance between two grid lines, picture units.
const TICK_DISTANCE: f64 = 100.0;

/// Round values for grid lines in the interval of `length` from `start`, mm, that is `units`
/// long in the picture.
fn tick_values(start: f64, length: f64, units: f64) -> impl Iterator<Item = f64> {
    let raw = length / (units / TICK_DISTANCE).max(1.0);
    let power = libm::pow(10.0, libm::log10(raw).floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|step| *step >= raw)
        .unwrap_or(10.0 * power);
    let first = (start / step).ceil();
    let count = ((start + length) / step).floor() - first;
    (0..=count.clamp(0.0, 100.0) as u32).map(move |index| (first + f64::from(index)) * step)
}

fn tick_label(value: f64) -> String {
    let rounded = (value * 1000.0).round() / 1000.0;
    if rounded == 0.0 {
        "0".to_owned()
    } else {
        rounded.to_string()
    }
}
