//! How far a boring bar and the stock give way to a force across the spindle axis.

use core::f64::consts::PI;

use gsk_units::Point;

use super::CuttingMaterial;
use crate::grid::PER_MM;
use crate::part::TurnedPart;
use crate::scene::LatheScene;
use crate::tool::Holder;

/// Elastic modulus of a steel bar, N/mm².
const STEEL_MODULUS: f64 = 210_000.0;
/// Number of pieces into which the stock is divided between the jaws and the tool.
const PIECE_COUNT: u32 = 24;
/// Shift of a section against the grid, grid units: no section then lies on an edge of the part.
const OFF_GRID_UNITS: f64 = 0.41;

/// The distance by which a round bar that is clamped at one end gives way to a force at its
/// other end, mm for each newton. Lengths in mm, modulus in N/mm².
pub fn cantilever_mm_per_n(length_mm: f64, diameter_mm: f64, modulus: f64) -> f64 {
    let inertia = PI * libm::pow(diameter_mm, 4.0) / 64.0;
    match inertia > 0.0 {
        true => libm::pow(length_mm, 3.0) / (3.0 * modulus * inertia),
        false => 0.0,
    }
}

impl Holder {
    /// The distance by which a steel boring bar gives way, mm for each newton; 0 for a shank.
    pub fn flexibility_mm_per_n(&self) -> f64 {
        match *self {
            Self::Bar { diameter, length } => cantilever_mm_per_n(length, diameter, STEEL_MODULUS),
            Self::None | Self::Shank { .. } => 0.0,
        }
    }
}

impl CuttingMaterial {
    /// The elastic modulus of the material, N/mm², by its group.
    pub fn modulus(&self) -> f64 {
        let number = self.group.get(1..).and_then(|it| it.parse::<u8>().ok());
        match (self.group.as_bytes().first(), number) {
            (Some(b'K'), _) | (Some(b'S'), Some(36..)) => 110_000.0,
            (Some(b'N'), Some(26..)) => 105_000.0,
            (Some(b'N'), _) => 70_000.0,
            _ => STEEL_MODULUS,
        }
    }
}

impl LatheScene {
    /// The distance by which the stock gives way to a force across its axis at `z`, mm for each
    /// newton, multiplied by its elastic modulus, N/mm². The jaws clamp rigidly; a tailstock
    /// supports the front end. 0 within the jaws.
    pub fn stock_flexibility(&self, z: f64) -> f64 {
        let (clamped, stock) = (self.stock().jaw_front(), self.stock());
        let length = z.min(stock.front()) - clamped;
        if length <= 0.0 {
            return 0.0;
        }
        let step = length / f64::from(PIECE_COUNT);
        let free: f64 = (0..PIECE_COUNT)
            .filter_map(|piece| {
                let at = (f64::from(piece) + 0.5) * step;
                let inertia = section_inertia(self.part(), clamped + at, stock.radius());
                let lever = length - at;
                (inertia > 0.0).then(|| lever * lever * step / inertia)
            })
            .sum();
        if stock.tailstock.is_none() {
            return free;
        }
        // A beam clamped at the jaws and supported at the centre, a and b from the force.
        let whole = stock.overhang.max(length);
        let rest = whole - length;
        let share = rest * rest * (3.0 * length + 4.0 * rest) / (4.0 * whole * whole * whole);
        free * share
    }
}

/// The second moment of area of the round section at `z`, mm⁴.
fn section_inertia(part: &TurnedPart, z: f64, radius: f64) -> f64 {
    let z = z * PER_MM + OFF_GRID_UNITS;
    let top = (radius + 1.0) * PER_MM;
    let (from, to) = (Point::new(-OFF_GRID_UNITS, z), Point::new(top, z));
    let at = |share: f64| ((to.x - from.x) * share + from.x).max(0.0) / PER_MM;
    let rings = part.shares_within(from, to);
    let ring = |(begin, end): &(f64, f64)| libm::pow(at(*end), 4.0) - libm::pow(at(*begin), 4.0);
    PI / 4.0 * rings.iter().map(ring).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stock::{Stock, Tailstock};
    use gsk_units::Diameter;

    #[test]
    fn a_bar_gives_way_as_a_cantilever_and_less_with_a_tailstock() {
        let mut stock = Stock::bar(20.0, 0.0, 100.0);
        let expected = |length: f64| cantilever_mm_per_n(length, 20.0, 1.0);
        let free = LatheScene::new(&stock);
        for (z, length) in [(0.0, 100.0), (-40.0, 60.0), (-90.0, 10.0)] {
            let ratio = free.stock_flexibility(z) / expected(length);
            assert!((ratio - 1.0).abs() < 0.002, "{z} {ratio}");
        }
        assert_eq!(free.stock_flexibility(-110.0), 0.0, "within the jaws");
        stock.tailstock = Some(Tailstock {
            quill: Diameter(30.0),
            center: Diameter(4.0),
        });
        let held = LatheScene::new(&stock);
        // In the middle: 7 F L³ / (768 E I).
        let inertia = PI * 160_000.0 / 64.0;
        let middle = 7.0 * 1e6 / (768.0 * inertia);
        assert!((held.stock_flexibility(-50.0) / middle - 1.0).abs() < 0.002);
        assert!(held.stock_flexibility(0.0).abs() < 1e-12);
    }

    #[test]
    fn a_thin_neck_and_a_bore_make_the_stock_flexible() {
        let whole = LatheScene::new(&Stock::bar(20.0, 0.0, 100.0)).stock_flexibility(0.0);
        let mut stock = Stock::bar(20.0, 0.0, 100.0);
        stock.form = crate::stock::StockForm::Tube {
            diameter: Diameter(20.0),
            bore: Diameter(10.0),
        };
        let tube = LatheScene::new(&stock).stock_flexibility(0.0);
        assert!((tube / whole - 1.0 / (1.0 - 0.0625)).abs() < 0.003);
        stock.form = crate::stock::StockForm::Contour {
            corners: vec![
                (Diameter(20.0), 0.0),
                (Diameter(20.0), -90.0),
                (Diameter(10.0), -90.0),
                (Diameter(10.0), -100.0),
                (Diameter(20.0), -100.0),
                (Diameter(20.0), -150.0),
            ],
            bore: Diameter(0.0),
        };
        let neck = LatheScene::new(&stock).stock_flexibility(0.0);
        assert!(neck > 3.0 * whole, "{neck} {whole}");
    }

    #[test]
    fn the_modulus_follows_the_group() {
        let modulus = |name| CuttingMaterial::from_name(name).map(|it| it.modulus());
        assert_eq!(modulus("C45"), Some(210_000.0));
        assert_eq!(modulus("EN-GJL-250"), Some(110_000.0));
        assert_eq!(modulus("EN AW-6082"), Some(70_000.0));
        assert_eq!(modulus("CuZn39Pb3"), Some(105_000.0));
        assert_eq!(modulus("TiAl6V4"), Some(110_000.0));
        assert_eq!(modulus("NiCr19NbMo"), Some(210_000.0));
    }
}
