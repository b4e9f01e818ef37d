//! The load of a cut: chip, cutting force, power, torque and roughness.
//!
//! ```text
//!   h = f · sin κ    b = ap / sin κ    A = b · h = f · ap
//!   Fc = b · h · kc    kc = kc1.1 · h^−mc                     (Kienzle)
//!   Pc = Fc · vc / 60 000    M = Fc · d / 2    Ra = f² / (32 r)
//!   Fn = 0.5 · Fc at right angles to the edge: its parts are feed force and radial force
//!   y = F · L³ / (3 · E · I)                                  (bar, stock)
//! ```
//!
//! On a real part the width b is the length of the cutting edge in the material, the nose
//! included, and the thickness h is the mean A / b.

mod chip_samples;
mod edge_contact;
mod flexibility;
mod force;
mod material;
mod starting_values;

pub use chip_samples::ChipSample;
pub use flexibility::cantilever_mm_per_n;
pub use force::{
    CuttingChip, chisel_edge_factors, cutting_power_kw, cutting_torque_nm, pressing_force_n,
    roughness_ra_um, surface_speed_m_per_min,
};
pub use material::CuttingMaterial;
pub use starting_values::{CuttingOperation, StartingValues};
