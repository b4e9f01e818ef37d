//! The spindle as the control sees it: commanded and measured speed (manual I-3.3,
//! II-2.8.5, PLC «spindle speed»).
//!
//! ```text
//!  S (G97) ──────────────────┐
//!  S (G96) ─► 1000 v/(π d) ──┴─► · override ─► 043 ≤ n ≤ G50 S ─► SVC = 10 V · n / 037…040
//!                                              (G96 only)             · 021/625 + 036
//! ```

mod angle;
mod control;
mod encoder;

#[cfg(test)]
mod tests;

pub use angle::{SpindleAngle, SpindleTurn};
pub use control::{SpindleControl, SpindleInputs};
pub use encoder::Encoder;
