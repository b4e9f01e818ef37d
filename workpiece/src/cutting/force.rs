//! Chip, force, power, torque and roughness by formula.

use core::f64::consts::PI;

use super::CuttingMaterial;

/// Chip thickness below which the specific cutting force no longer increases, mm. Kienzle's
/// exponent was measured above it.
const LEAST_THICKNESS_MM: f64 = 0.01;
/// Rake angle for which the specific cutting force of steel is tabulated, degrees (Kienzle).
const TABLE_RAKE_DEGREES: f64 = 6.0;
/// Share by which the specific cutting force falls with a degree of rake (Kienzle: 1 to 2 %).
const SHARE_PER_DEGREE: f64 = 0.015;
/// Share of the cutting force that presses the edge out of the cut, at right angles to the edge.
/// Published shares are between 0.3 and 0.67.
const PRESSING_SHARE: f64 = 0.5;
/// Torque and thrust of a drill with a chisel edge, as multiples of those of its lips alone
/// (Ghosh and Mallik, Manufacturing Science, problem 4.14: M = 0.6 Fc d, F = 5 Ft sin β).
const CHISEL_TORQUE: f64 = 1.2;
const CHISEL_THRUST: f64 = 2.5;
/// Share of a drill's radius that its chisel edge covers: a hole of this size removes its effect.
const CHISEL_SHARE: f64 = 0.1;

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
    /// The material for a tool with a rake angle, degrees: a greater rake needs less force.
    pub fn with_rake(&self, rake_degrees: f64) -> Self {
        let share = SHARE_PER_DEGREE * (rake_degrees - TABLE_RAKE_DEGREES);
        Self {
            kc11: self.kc11 * (1.0 - share).clamp(0.5, 1.5),
            ..*self
        }
    }

    /// The specific cutting force for a chip thickness, mm, in N/mm².
    pub fn specific_force(&self, thickness_mm: f64) -> f64 {
        self.kc11 * libm::pow(thickness_mm.max(LEAST_THICKNESS_MM), -self.mc)
    }

    /// The cutting force of a chip, N.
    pub fn cutting_force_n(&self, chip: &CuttingChip) -> f64 {
        chip.area_mm2 * self.specific_force(chip.thickness_mm())
    }
}

/// The force that presses the edge out of the cut, at right angles to it, N.
pub fn pressing_force_n(cutting_force_n: f64) -> f64 {
    PRESSING_SHARE * cutting_force_n
}

/// Torque and thrust of a drill as multiples of those of its lips. The chisel edge acts if the
/// lips cut from less than a tenth of the radius.
pub fn chisel_edge_factors(inner_radius_mm: f64, outer_radius_mm: f64) -> (f64, f64) {
    match inner_radius_mm < CHISEL_SHARE * outer_radius_mm {
        true => (CHISEL_TORQUE, CHISEL_THRUST),
        false => (1.0, 1.0),
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
