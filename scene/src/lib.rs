//! Draws a lathe in space: a description in, pixels out.
//!
//! Coordinates of the scene, mm: x is the spindle axis away from the chuck, with 0 at the front
//! of the chuck's body; y points up; z points to the operator.
//!
//! ```text
//!        y
//!        |   chuck      part        tailstock
//!   head |  ______                    ____
//!   stock|==|    |================---<____|==   axis -> x
//!        | z (to the operator)
//! ```

pub mod camera;
mod chip_mesh;
pub mod chips;
pub mod description;
pub mod effects;
mod frame;
pub mod lathe;
pub mod level;
pub mod mesh;
pub mod opengl;
pub mod part;
mod part_details;
pub mod placement;
pub mod section_cut;
pub mod software;
pub mod tool_path;
mod viewport;
