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
mod chip_objects;
pub mod chips;
pub mod description;
mod device;
pub mod effects;
mod frame;
mod gpu_meshes;
pub mod lathe;
pub mod level;
pub mod mesh;
mod objects;
pub mod occlusion;
mod overlay_objects;
pub mod part_material;
mod part_objects;
pub mod part_outline;
pub mod part_threads;
pub mod placement;
mod polyline;
pub mod primitives;
pub mod renderer;
pub mod section_cut;
mod shader;
pub mod software;
mod tally;
mod targets;
pub mod tool_path;
mod viewport;

#[cfg(test)]
mod checks;
