//! Stores the settings of the graphic page (manual III-2.5.2).

use gsk_core::units::{Axis, Point};
use serde::{Deserialize, Serialize};

/// The settings of the graphic page. Lengths are in thousandths of a millimetre as shown: X in
/// the display's unit (diameter), Z in mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct GraphicSettings {
    /// 坐标选择, the plane: `false` is XZ (0), `true` is ZX (1, Z horizontal).
    pub zx: bool,
    /// 缩放比例, the scale, in hundredths of a dot per millimetre.
    pub scale: u32,
    /// 图形中心, X of the picture's centre, 0.001 mm.
    pub center_x: i32,
    /// 图形中心, Z of the picture's centre, 0.001 mm.
    pub center_z: i32,
    /// X最大值, the greatest X that the picture shows, 0.001 mm.
    pub max_x: i32,
    /// Z最大值, the greatest Z that the picture shows, 0.001 mm.
    pub max_z: i32,
    /// X最小值, the least X that the picture shows, 0.001 mm.
    pub min_x: i32,
    /// Z最小值, the least Z that the picture shows, 0.001 mm.
    pub min_z: i32,
    /// Whether motion is added to the picture; key S starts it, key T stops it.
    pub drawing: bool,
}

/// 150 dots, which the larger range takes, in hundredths of a dot, times 1000 (0.001 mm in a
/// mm).
const SPREAD: i64 = 15_000 * 1000;

impl GraphicSettings {
    /// Computes scale and centre from the extents. Keeps both if a range is not positive.
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

    /// Returns the scale of the picture, dots per millimetre.
    pub(crate) fn dots_per_mm(&self) -> f64 {
        f64::from(self.scale) / 100.0
    }

    /// Returns the centre of the picture in mm, X as a radius. `diameter`: whether the
    /// settings contain X as a diameter.
    pub fn center(&self, diameter: bool) -> Point {
        let x = f64::from(self.center_x) / 1000.0;
        let x = if diameter { x / 2.0 } else { x };
        Point::new(x, f64::from(self.center_z) / 1000.0)
    }

    /// Returns the axis that the picture shows from left to right.
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
