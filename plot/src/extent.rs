//! The bounds of a path, and the size of the picture that shows it.

use std::str::FromStr;

use gsk_core::units::Point;
use gsk_messages::{Message, say};

/// Margin around the path, picture units.
pub(super) const PATH_MARGIN: f64 = 70.0;
/// Height of the texts above the path, picture units.
pub(super) const HEAD_HEIGHT: f64 = 60.0;

/// The size of a picture in pixels, limited to what the program can draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureSize {
    width: u32,
    height: u32,
}

/// The text entered for a picture size that is invalid or outside the limits.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct InvalidPictureSize(String);

impl InvalidPictureSize {
    /// The error message for the user: the size entered, and the smallest and largest size.
    pub fn message(&self) -> Message {
        let (least, most) = (PictureSize::MIN, PictureSize::MAX);
        say::picture_size(&self.0, least.width, least.height, most.width, most.height)
    }
}

impl PictureSize {
    /// Smallest size, at which the texts of a picture still fit.
    const MIN: Self = Self {
        width: 480,
        height: 320,
    };
    /// Largest size, at which the picture still fits into the memory of a small computer.
    const MAX: Self = Self {
        width: 7680,
        height: 7680,
    };
    /// The default size. A picture unit is one pixel in pictures smaller than twice this size.
    const STANDARD: Self = Self {
        width: 1280,
        height: 800,
    };

    /// Size of a wide picture that leaves space for text on a page.
    pub const WIDE: Self = Self {
        width: 1280,
        height: 600,
    };

    /// Returns the width of the picture, pixels.
    pub const fn width(self) -> u32 {
        self.width
    }

    /// Returns the height of the picture, pixels.
    pub const fn height(self) -> u32 {
        self.height
    }

    /// Pixels per picture unit, 1 or more. Texts and lines grow with the picture.
    pub(super) fn unit_px(self) -> u32 {
        let across = self.width / Self::STANDARD.width;
        across.min(self.height / Self::STANDARD.height).max(1)
    }

    /// Returns width and height in picture units.
    pub(super) fn units(self) -> (f64, f64) {
        let unit = f64::from(self.unit_px());
        (f64::from(self.width) / unit, f64::from(self.height) / unit)
    }

    /// The size of a pixel, mm, if an object of `size`, mm, fills the picture.
    pub(super) fn pixel_mm(self, size: Point) -> f64 {
        let (wide, tall) = self.units();
        let unit_mm =
            (size.z / (wide - 2.0 * PATH_MARGIN)).max(size.x / (tall - HEAD_HEIGHT - PATH_MARGIN));
        unit_mm / f64::from(self.unit_px())
    }
}

impl Default for PictureSize {
    fn default() -> Self {
        Self::STANDARD
    }
}

impl FromStr for PictureSize {
    type Err = InvalidPictureSize;

    /// Parses a size such as `1600x900`, in pixels.
    fn from_str(word: &str) -> Result<Self, InvalidPictureSize> {
        let parse = |word: &str| word.trim().parse::<u32>().ok();
        let (least, most) = (Self::MIN, Self::MAX);
        word.split_once(['x', 'X', '×', '*'])
            .and_then(|(width, height)| Some((parse(width)?, parse(height)?)))
            .filter(|(width, _)| (least.width..=most.width).contains(width))
            .filter(|(_, height)| (least.height..=most.height).contains(height))
            .map(|(width, height)| Self { width, height })
            .ok_or_else(|| InvalidPictureSize(word.to_owned()))
    }
}

/// The bounds of a path, in the program frame: X as a radius, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PathExtent {
    pub low: Point,
    pub high: Point,
}

impl PathExtent {
    /// Creates the bounds of a path that consists of this point alone.
    pub const fn from_point(point: Point) -> Self {
        Self {
            low: point,
            high: point,
        }
    }

    /// Widens the bounds to include a point.
    pub fn widen(&mut self, point: Point) {
        self.low = Point::new(self.low.x.min(point.x), self.low.z.min(point.z));
        self.high = Point::new(self.high.x.max(point.x), self.high.z.max(point.z));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_limits_and_both_sides() {
        let size: PictureSize = "1600x900".parse().expect("size");
        assert_eq!((size.width(), size.height()), (1600, 900));
        assert_eq!(size.unit_px(), 1);
        let large: PictureSize = "3840x2160".parse().expect("size");
        assert_eq!((large.unit_px(), large.units()), (2, (1920.0, 1080.0)));
        for wrong in [
            "",
            "1600",
            "1600x",
            "x900",
            "-1600x900",
            "100x100",
            "9000x900",
            "1e3x900",
        ] {
            let message = wrong.parse::<PictureSize>().expect_err(wrong).to_string();
            assert!(
                message.contains("480x320") && message.contains("7680x7680"),
                "{message}"
            );
        }
    }
}
