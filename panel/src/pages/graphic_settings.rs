//! Stores the settings of the graphic page (manual III-2.5.2).

use gsk_core::units::{Axis, Point};
use serde::{Deserialize, Serialize};

/// The settings of the graphic page. Lengths are in thousandths of a millimetre as shown: X in
/// the display's unit (diameter), Z in mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GraphicSettings {
    /// 坐标选择: false is XZ (0), true is ZX (1, Z horizontal).
    pub zx: bool,
    /// 缩放比例: hundredths of a dot for a millimetre.
    pub scale: u32,
    /// 图形中心, X.
    pub center_x: i32,
    /// 图形中心, Z.
    pub center_z: i32,
    /// X最大值.
    pub max_x: i32,
    /// Z最大值.
    pub max_z: i32,
    /// X最小值.
    pub min_x: i32,
    /// Z最小值.
    pub min_z: i32,
    /// Whether motion is recorded (S) or not (T).
    pub drawing: bool,
}

/// Dots for the larger range, in hundredths, times 1000.
const SPREAD: i64 = 15_000 * 1000;

impl GraphicSettings {
    /// Computes scale and centre from the extents, once both ranges are positive.
    pub fn recompute(&mut self) {
        let range_x = i64::from(self.max_x) - i64::from(self.min_x);
        let range_z = i64::from(self.max_z) - i64::from(self.min_z);
        if range_x <= 0 || range_z <= 0 {
            return;
        }
        let center = |max: i32, min: i32| ((i64::from(max) + i64::from(min)) / 2) as i32;
        self.scale = u32::try_from(SPREAD / range_x.max(range_z)).unwrap_or(u32::MAX);
        self.center_x = center(self.max_x, self.min_x);
        self.center_z = center(self.max_z, self.min_z);
    }

    /// Returns the dots for a millimetre.
    pub(crate) fn dots_per_mm(&self) -> f64 {
        f64::from(self.scale) / 100.0
    }

    /// Returns the centre of the picture with X as a radius. `diameter`: whether the display
    /// shows X as a diameter.
    pub fn center(&self, diameter: bool) -> Point {
        let x = f64::from(self.center_x) / 1000.0;
        let x = if diameter { x / 2.0 } else { x };
        Point::new(x, f64::from(self.center_z) / 1000.0)
    }

    /// Returns the axis drawn from left to right.
    pub const fn horizontal(&self) -> Axis {
        if self.zx { Axis::Z } else { Axis::X }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_of_the_manual() {
        let mut settings = GraphicSettings {
            max_x: 150_000,
            max_z: 200_000,
            min_x: -10_000,
            min_z: -10_000,
            ..GraphicSettings::default()
        };
        settings.recompute();
        assert_eq!(settings.scale, 71);
        assert_eq!((settings.center_x, settings.center_z), (70_000, 95_000));
    }

    #[test]
    fn one_extent_alone_changes_nothing() {
        let mut settings = GraphicSettings {
            max_x: 150_000,
            ..GraphicSettings::default()
        };
        settings.recompute();
        assert_eq!(settings.scale, 0);
        assert_eq!((settings.center_x, settings.center_z), (0, 0));
    }
}
