//! Draws the scene with OpenGL: the device with the unsafe calls, the objects in its memory, and
//! the renderer that a paint callback calls.

mod chip_objects;
mod device;
mod gpu_meshes;
mod objects;
mod overlay_objects;
mod part_objects;
pub mod renderer;
mod shader;
mod tally;
mod targets;
