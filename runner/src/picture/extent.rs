//! How far a path reaches, and how large the picture is that it must fit in.

use gsk_core::units::Point;

/// Width of the picture, pixels.
pub const WIDTH: u32 = 1280;
/// Height of the picture, pixels.
pub const HEIGHT: u32 = 800;

/// Pixels around the path.
pub(super) const MARGIN: f64 = 70.0;
/// Pixels above it, with the words.
pub(super) const TOP: f64 = 60.0;

/// The box around a path, program frame, X as a radius, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    pub low: Point,
    pub high: Point,
}

/// Pixels across and down that the path may fill.
pub(super) fn room() -> (f64, f64) {
    (
        f64::from(WIDTH) - 2.0 * MARGIN,
        f64::from(HEIGHT) - TOP - MARGIN,
    )
}

/// The size of a pixel, mm, when something of this size fills the picture.
pub(super) fn pixel_mm(size: Point) -> f64 {
    let (room_z, room_x) = room();
    (size.z / room_z).max(size.x / room_x)
}
