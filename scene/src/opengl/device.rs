//! Thin wrappers of OpenGL: the only module with `unsafe`.
//!
//! Every function of [`glow::Context`] is unsafe, because the context must be current on the
//! calling thread. egui calls a paint callback with its context current, and a [`Device`]
//! lives no longer than one such call.

mod create;

use std::collections::BTreeMap;

use glam::{Mat4, Vec3};
use glow::HasContext as _;

use crate::opengl::tally::ObjectTally;

/// The reason why OpenGL cannot draw the scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SceneError {
    /// The OpenGL context is older than OpenGL 3.3 and OpenGL ES 3.0; the value is its version.
    #[error("OpenGL {0} is too old: 3.3 or ES 3.0 is needed")]
    TooOld(String),
    /// OpenGL refused to compile or link a shader; the value is its message.
    #[error("the shader was refused: {0}")]
    Shader(String),
    /// OpenGL did not create an object; the value is its message.
    #[error("OpenGL created no object: {0}")]
    Object(String),
    /// A framebuffer is not complete; the value is the status that OpenGL returned.
    #[error("the framebuffer is not complete: {0:#x}")]
    Framebuffer(u32),
}

/// A linked shader program with the locations of its uniforms.
#[derive(Debug)]
pub struct SceneProgram {
    program: glow::Program,
    uniforms: BTreeMap<String, glow::UniformLocation>,
}

/// OpenGL buffers of a mesh: vertices and indices.
#[derive(Debug)]
pub struct GpuMesh {
    array: glow::VertexArray,
    vertices: glow::Buffer,
    indices: glow::Buffer,
    count: i32,
    /// OpenGL primitive: triangles or lines.
    mode: u32,
    /// Total size of both buffers, bytes.
    bytes: i64,
}

/// The layout of the vertices in a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VertexLayout {
    /// The layout that [`crate::mesh::SceneVertex::write_bytes`] writes.
    Surface,
    /// Two 16 bit numbers for the revolved part: the end of an edge, and the side of the turn.
    Edge,
    /// Ends of lines: position as 3 floats, colour as 4 bytes.
    Line,
}

/// A framebuffer with a texture, and a depth buffer if the texture has colours.
#[derive(Debug)]
pub struct DrawTarget {
    /// Width and height, pixels.
    pub size: [i32; 2],
    /// The texture into which the target draws.
    pub texture: glow::Texture,
    framebuffer: glow::Framebuffer,
    depth: Option<glow::Renderbuffer>,
}

impl DrawTarget {
    /// Returns the number of OpenGL objects of the target, and the bytes of their pixels.
    fn weight(&self) -> (i64, i64) {
        let [width, height] = self.size.map(i64::from);
        match self.depth {
            Some(_) => (3, width * height * 8),
            None => (2, width * height * 4),
        }
    }
}

/// Access to OpenGL during one paint callback.
#[derive(Clone, Copy)]
pub struct Device<'a> {
    gl: &'a glow::Context,
    tally: &'a ObjectTally,
}

impl<'a> Device<'a> {
    /// Wraps a context that is current on this thread.
    pub const fn new(gl: &'a glow::Context, tally: &'a ObjectTally) -> Self {
        Self { gl, tally }
    }

    /// Returns the count of the existing OpenGL objects.
    pub const fn tally(self) -> &'a ObjectTally {
        self.tally
    }

    /// Returns an error if the OpenGL context is too old for the shaders.
    pub fn check_version(self) -> Result<(), SceneError> {
        let version = self.gl.version();
        let needed = if version.is_embedded { (3, 0) } else { (3, 3) };
        match (version.major, version.minor) >= needed {
            true => Ok(()),
            false => Err(SceneError::TooOld(format!(
                "{}.{}",
                version.major, version.minor
            ))),
        }
    }

    /// Whether OpenGL is computed by the processor and not by a graphics card.
    pub fn is_software(self) -> bool {
        // SAFETY: the context is current; the query has no other condition.
        let name = unsafe { self.gl.get_parameter_string(glow::RENDERER) }.to_lowercase();
        let software = [
            "llvmpipe",
            "softpipe",
            "swiftshader",
            "gdi generic",
            "software",
        ];
        software.iter().any(|it| name.contains(it))
    }

    /// Whether a shader program of this context still exists; `false` after a loss of the context.
    pub fn is_alive(self, program: &SceneProgram) -> bool {
        // SAFETY: the context is current; a name that does not exist gives false.
        unsafe { self.gl.is_program(program.program) }
    }

    /// Sets the OpenGL state for opaque surfaces. If `clips`, surfaces seen from the back are left
    /// out.
    pub fn begin_surfaces(self, clips: bool) {
        // SAFETY: the context is current; the calls set state only.
        unsafe {
            self.gl.disable(glow::SCISSOR_TEST);
            self.gl.disable(glow::BLEND);
            self.gl.enable(glow::DEPTH_TEST);
            self.gl.depth_func(glow::LESS);
            self.gl.depth_mask(true);
            self.gl.cull_face(glow::BACK);
            match clips {
                true => self.gl.enable(glow::CULL_FACE),
                false => self.gl.disable(glow::CULL_FACE),
            }
        }
    }

    /// Sets the OpenGL state for a triangle that covers the picture.
    pub fn begin_cover(self) {
        // SAFETY: the context is current; the calls set state only.
        unsafe {
            self.gl.disable(glow::DEPTH_TEST);
            self.gl.disable(glow::CULL_FACE);
        }
    }

    /// Sets the OpenGL state for transparent surfaces, which are drawn last.
    pub fn begin_transparent(self) {
        // SAFETY: the context is current; the calls set state only.
        unsafe {
            self.gl.disable(glow::CULL_FACE);
            self.gl.enable(glow::BLEND);
            self.gl.blend_func(glow::ONE, glow::ONE_MINUS_SRC_ALPHA);
            self.gl.depth_mask(false);
        }
    }

    /// Shifts the drawn depths away from the light if `shifts`, else ends the shift; prevents
    /// surfaces from shading themselves.
    pub fn set_depth_shift(self, shifts: bool) {
        // SAFETY: the context is current; the calls set state only.
        unsafe {
            match shifts {
                true => self.gl.enable(glow::POLYGON_OFFSET_FILL),
                false => self.gl.disable(glow::POLYGON_OFFSET_FILL),
            }
            self.gl.polygon_offset(1.5, 3.0);
        }
    }

    /// Selects the target of all further drawing; if `clears`, its depths are cleared.
    pub fn bind_target(self, target: &DrawTarget, clears: bool) {
        let [width, height] = target.size;
        // SAFETY: the context is current; the target was created by it.
        unsafe {
            self.gl
                .bind_framebuffer(glow::FRAMEBUFFER, Some(target.framebuffer));
            self.gl.viewport(0, 0, width, height);
            if clears {
                self.gl.depth_mask(true);
                self.gl.clear_depth_f32(1.0);
                self.gl.clear(glow::DEPTH_BUFFER_BIT);
            }
        }
    }

    /// Copies colours and depths, or depths alone, from one target to another of the same size and
    /// kind.
    pub fn copy_target(self, from: &DrawTarget, to: &DrawTarget) {
        let [width, height] = from.size;
        let planes = match from.depth {
            Some(_) => glow::COLOR_BUFFER_BIT | glow::DEPTH_BUFFER_BIT,
            None => glow::DEPTH_BUFFER_BIT,
        };
        // SAFETY: the context is current; both targets were created by it with one size.
        unsafe {
            // egui's scissor would leave the pixels outside it as they were in an earlier picture.
            self.gl.disable(glow::SCISSOR_TEST);
            self.gl
                .bind_framebuffer(glow::READ_FRAMEBUFFER, Some(from.framebuffer));
            self.gl
                .bind_framebuffer(glow::DRAW_FRAMEBUFFER, Some(to.framebuffer));
            self.gl.blit_framebuffer(
                0,
                0,
                width,
                height,
                0,
                0,
                width,
                height,
                planes,
                glow::NEAREST,
            );
        }
    }

    /// Selects egui's framebuffer for all further drawing, within `viewport`: left, bottom, width,
    /// height, pixels.
    pub fn bind_output(self, output: Option<glow::Framebuffer>, viewport: [i32; 4]) {
        let [left, bottom, width, height] = viewport;
        // SAFETY: the context is current; the framebuffer is the one of the caller.
        unsafe {
            self.gl.bind_framebuffer(glow::FRAMEBUFFER, output);
            self.gl.viewport(left, bottom, width, height);
            self.gl.disable(glow::DEPTH_TEST);
            self.gl.disable(glow::CULL_FACE);
            self.gl.disable(glow::BLEND);
            self.gl.enable(glow::SCISSOR_TEST);
            self.gl.depth_mask(true);
        }
    }

    /// Restores the framebuffer and viewport that egui expects, after a drawing has failed.
    pub fn restore_output(self, output: Option<glow::Framebuffer>, viewport: [i32; 4]) {
        self.bind_output(output, viewport);
        // SAFETY: the context is current; the call sets state only.
        unsafe { self.gl.bind_vertex_array(None) };
    }

    /// Selects the shader program for all further drawing.
    pub fn use_program(self, program: &SceneProgram) {
        // SAFETY: the context is current; it has linked the program.
        unsafe { self.gl.use_program(Some(program.program)) };
    }

    /// Binds a texture to a texture unit; `None` removes the texture of the unit.
    pub fn bind_texture(self, unit: u32, texture: Option<glow::Texture>) {
        // SAFETY: the context is current; it has created the texture.
        unsafe {
            self.gl.active_texture(glow::TEXTURE0 + unit);
            self.gl.bind_texture(glow::TEXTURE_2D, texture);
            self.gl.active_texture(glow::TEXTURE0);
        }
    }

    /// Sets a matrix uniform of the shader program in use.
    pub fn set_matrix(self, program: &SceneProgram, name: &str, value: &Mat4) {
        let columns = value.to_cols_array();
        // SAFETY: the context is current; the location is one of the program in use.
        unsafe {
            self.gl
                .uniform_matrix_4_f32_slice(program.uniforms.get(name), false, &columns);
        };
    }

    /// Sets a vector uniform of the shader program in use.
    pub fn set_vector(self, program: &SceneProgram, name: &str, value: Vec3) {
        let Vec3 { x, y, z } = value;
        // SAFETY: the context is current; the location is one of the program in use.
        unsafe { self.gl.uniform_3_f32(program.uniforms.get(name), x, y, z) };
    }

    /// Sets a uniform of two numbers of the shader program in use.
    pub fn set_pair(self, program: &SceneProgram, name: &str, [x, y]: [f32; 2]) {
        // SAFETY: the context is current; the location is one of the program in use.
        unsafe { self.gl.uniform_2_f32(program.uniforms.get(name), x, y) };
    }

    /// Sets a number uniform of the shader program in use.
    pub fn set_number(self, program: &SceneProgram, name: &str, value: f32) {
        // SAFETY: the context is current; the location is one of the program in use.
        unsafe { self.gl.uniform_1_f32(program.uniforms.get(name), value) };
    }

    /// Sets the texture unit of a sampler of the shader program in use.
    pub fn set_sampler(self, program: &SceneProgram, name: &str, unit: i32) {
        // SAFETY: the context is current; the location is one of the program in use.
        unsafe { self.gl.uniform_1_i32(program.uniforms.get(name), unit) };
    }

    /// Draws a mesh; with `limit` only its first `limit` indices.
    pub fn draw_mesh(self, mesh: &GpuMesh, limit: Option<i32>) {
        let count = limit.map_or(mesh.count, |limit| limit.min(mesh.count));
        // SAFETY: the context is current; the buffer of indices holds at least `count`.
        unsafe {
            self.gl.bind_vertex_array(Some(mesh.array));
            self.gl
                .draw_elements(mesh.mode, count, glow::UNSIGNED_INT, 0);
            self.gl.bind_vertex_array(None);
        }
    }

    /// Draws the triangle that covers the picture.
    pub fn draw_cover(self, array: glow::VertexArray) {
        // SAFETY: the context is current; the shader reads no attribute.
        unsafe {
            self.gl.bind_vertex_array(Some(array));
            self.gl.draw_arrays(glow::TRIANGLES, 0, 3);
            self.gl.bind_vertex_array(None);
        }
    }
}
