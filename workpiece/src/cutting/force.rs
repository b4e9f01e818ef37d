//! Chip, force, power, torque and roughness by formula.

use core::f64::consts::PI;

use super::CuttingMaterial;

/// Chip thickness below which the specific cutting force no longer increases, mm. Kienzle's
/// exponent was measured above it.
const LEAST_THICKNESS_MM: f64 = 0.01;

/// The cross-section of a chip before the cut.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CuttingChip {
    /// Area of the cross-section, mm².
    pub area_mm2: f64,
    /// Length of the cutting edge in the material, mm.
    pub width_mm: f64,
}

impl CuttingChip {
    /// The chip of a straight edge: depth of cut and feed per revolution, mm, and entering
    /// angle, degrees.
    pub fn from_straight_edge(depth_mm: f64, feed_mm: f64, entering_degrees: f64) -> Self {
        let sine = libm::sin(entering_degrees * PI / 180.0);
        Self {
            area_mm2: depth_mm * feed_mm,
            width_mm: if sine > 0.0 { depth_mm / sine } else { 0.0 },
        }
    }

    /// Mean thickness of the chip, mm; 0 without contact.
    pub fn thickness_mm(&self) -> f64 {
        match self.width_mm > 0.0 {
            true => self.area_mm2 / self.width_mm,
            false => 0.0,
        }
    }
}

impl CuttingMaterial {
    /// The specific cutting force for a chip thickness, mm, in N/mm².
    pub fn specific_force(&self, thickness_mm: f64) -> f64 {
        self.kc11 * libm::pow(thickness_mm.max(LEAST_THICKNESS_MM), -self.mc)
    }

    /// The cutting force of a chip, N.
    pub fn cutting_force_n(&self, chip: &CuttingChip) -> f64 {
        chip.area_mm2 * self.specific_force(chip.thickness_mm())
    }
}

/// The cutting speed at a radius, mm, with a spindle speed, r/min, in m/min.
pub fn surface_speed_m_per_min(radius_mm: f64, rpm: f64) -> f64 {
    2.0 * PI * radius_mm * rpm / 1000.0
}

/// The power of a force, N, at a cutting speed, m/min, in kW.
pub fn cutting_power_kw(force_n: f64, speed_m_per_min: f64) -> f64 {
    force_n * speed_m_per_min / 60_000.0
}

/// The torque of a force, N, at a radius, mm, in N·m.
pub fn cutting_torque_nm(force_n: f64, radius_mm: f64) -> f64 {
    force_n * radius_mm / 1000.0
}

/// The theoretical roughness Ra of a turned surface, µm, from feed per revolution and nose
/// radius, mm; `None` without a nose.
pub fn roughness_ra_um(feed_mm: f64, nose_mm: f64) -> Option<f64> {
    (nose_mm > 0.0).then(|| feed_mm * feed_mm / (32.0 * nose_mm) * 1000.0)
}
