//! Fixed and compound cycles that cut without a thread (G70–G75, G90, G94).

pub(super) mod box_cycle;
pub(super) mod contour;
pub(super) mod facing_cycle;
pub(super) mod finishing;
pub(super) mod pattern;
pub(super) mod pecking;
pub(super) mod roughing;
pub(super) mod stepped;
pub(super) mod turning_cycle;
