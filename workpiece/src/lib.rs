//! The part in the lathe: stock and how it is clamped, tools by their inserts, what
//! they cut away, what they hit, and measuring what is left.
//!
//! Everything lies in the half section of the part, Z along the spindle axis and X a
//! radius; what the spindle turns is a solid of revolution of it. The zero is that of
//! the part: the centre of its finished face.
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
