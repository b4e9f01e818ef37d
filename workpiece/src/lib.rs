//! Models the part in the lathe: stock, clamping, tools, material removal, collisions
//! and measurement.
//!
//! All geometry lies in the half section of the part: Z runs along the spindle axis, X is
//! a radius. The part is the solid of revolution of this section. Part coordinates have
//! their zero at the centre of the finished face.
//!
//! ```text
//!          jaws
//!   ======█████                        tool ▚
//!   chuck █████──────────────────────┐  (rear post: from above)
//!         █████      stock           │
//!   ─ · ─ · ─ · ─ · ─ · ─ · ─ · ─ · ─0─ · ─ · ─> Z
//! ```

pub mod collision;
pub mod compare;
pub mod convex;
pub mod curve;
pub mod cutting;
pub mod grid;
pub mod job;
pub mod measure;
pub mod motion;
pub mod part;
pub mod region;
pub mod scene;
pub mod stock;
pub mod tool;
pub mod trapezoid;
