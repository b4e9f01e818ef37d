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
pub mod description;
mod device;
mod frame;
mod gpu_meshes;
pub mod lathe;
pub mod level;
pub mod mesh;
mod objects;
pub mod occlusion;
pub mod part_outline;
pub mod placement;
pub mod primitives;
pub mod renderer;
mod shader;
pub mod software;
mod tally;
mod targets;
mod viewport;

#[cfg(test)]
mod checks;
