//! Creates and deletes objects of OpenGL.

use glow::HasContext as _;

use super::{Device, DrawTarget, GpuMesh, SceneError, SceneProgram, VertexLayout};
use crate::mesh::VERTEX_BYTES;
use crate::part::outline::{EDGE_FLOATS, MAX_EDGES};
use crate::tool_path::LINE_VERTEX_BYTES;

/// Size of the texture for the longest outline of a part, bytes.
const OUTLINE_BYTES: i64 = (MAX_EDGES * EDGE_FLOATS * 4) as i64;

impl Device<'_> {
    /// Compiles and links a shader program.
    pub fn create_program(
        self,
        definitions: &str,
        [vertex, fragment]: [&str; 2],
    ) -> Result<SceneProgram, SceneError> {
        let gl = self.gl;
        let head = match gl.version().is_embedded {
            true => "#version 300 es\nprecision highp float;\nprecision highp int;\n",
            false => "#version 330 core\n",
        };
        let kinds = [
            (glow::VERTEX_SHADER, vertex),
            (glow::FRAGMENT_SHADER, fragment),
        ];
        // SAFETY: the context is current; all names are created here; the texts outlive the
        // calls.
        unsafe {
            let program = gl.create_program().map_err(SceneError::Object)?;
            for (kind, text) in kinds {
                let shader = gl.create_shader(kind).map_err(SceneError::Object)?;
                gl.shader_source(shader, &format!("{head}{definitions}{text}"));
                gl.compile_shader(shader);
                if !gl.get_shader_compile_status(shader) {
                    return Err(SceneError::Shader(gl.get_shader_info_log(shader)));
                }
                gl.attach_shader(program, shader);
                gl.delete_shader(shader);
            }
            let names = ["a_position", "a_normal", "a_color", "a_finish"];
            for (at, name) in names.into_iter().enumerate() {
                gl.bind_attrib_location(program, at as u32, name);
            }
            if definitions.contains("PART") {
                gl.bind_attrib_location(program, 0, "a_edge");
            }
            gl.link_program(program);
            if !gl.get_program_link_status(program) {
                return Err(SceneError::Shader(gl.get_program_info_log(program)));
            }
            let active = 0..gl.get_active_uniforms(program);
            let uniforms = active.filter_map(|at| {
                let name = gl.get_active_uniform(program, at)?.name;
                let location = gl.get_uniform_location(program, &name)?;
                Some((name, location))
            });
            let uniforms = uniforms.collect();
            self.tally.add(1, 0);
            Ok(SceneProgram { program, uniforms })
        }
    }

    /// Uploads a mesh.
    pub fn create_mesh(
        self,
        layout: VertexLayout,
        vertices: &[u8],
        indices: &[u8],
    ) -> Result<GpuMesh, SceneError> {
        let gl = self.gl;
        // SAFETY: the context is current; the names are created here; attributes read within
        // the stride of the layout, and indices name vertices of the mesh.
        unsafe {
            let array = gl.create_vertex_array().map_err(SceneError::Object)?;
            let buffer = gl.create_buffer().map_err(SceneError::Object)?;
            let elements = gl.create_buffer().map_err(SceneError::Object)?;
            gl.bind_vertex_array(Some(array));
            gl.bind_buffer(glow::ARRAY_BUFFER, Some(buffer));
            gl.buffer_data_u8_slice(glow::ARRAY_BUFFER, vertices, glow::STATIC_DRAW);
            gl.bind_buffer(glow::ELEMENT_ARRAY_BUFFER, Some(elements));
            gl.buffer_data_u8_slice(glow::ELEMENT_ARRAY_BUFFER, indices, glow::STATIC_DRAW);
            let stride = VERTEX_BYTES as i32;
            match layout {
                VertexLayout::Surface => {
                    for (at, (count, kind, normalized, offset)) in [
                        (3, glow::FLOAT, false, 0),
                        (4, glow::BYTE, true, 12),
                        (4, glow::UNSIGNED_BYTE, true, 16),
                        (4, glow::UNSIGNED_BYTE, true, 20),
                    ]
                    .into_iter()
                    .enumerate()
                    {
                        let at = at as u32;
                        gl.enable_vertex_attrib_array(at);
                        gl.vertex_attrib_pointer_f32(at, count, kind, normalized, stride, offset);
                    }
                }
                VertexLayout::Line => {
                    let stride = LINE_VERTEX_BYTES as i32;
                    gl.enable_vertex_attrib_array(0);
                    gl.vertex_attrib_pointer_f32(0, 3, glow::FLOAT, false, stride, 0);
                    gl.enable_vertex_attrib_array(2);
                    gl.vertex_attrib_pointer_f32(2, 4, glow::UNSIGNED_BYTE, true, stride, 12);
                }
                VertexLayout::Edge => {
                    gl.enable_vertex_attrib_array(0);
                    gl.vertex_attrib_pointer_f32(0, 2, glow::UNSIGNED_SHORT, false, 4, 0);
                }
            }
            gl.bind_vertex_array(None);
            let count = (indices.len() / 4) as i32;
            let bytes = (vertices.len() + indices.len()) as i64;
            self.tally.add(3, bytes);
            Ok(GpuMesh {
                array,
                vertices: buffer,
                indices: elements,
                count,
                mode: match layout {
                    VertexLayout::Line => glow::LINES,
                    VertexLayout::Surface | VertexLayout::Edge => glow::TRIANGLES,
                },
                bytes,
            })
        }
    }

    /// Creates an empty vertex array, for the triangle that covers the picture.
    pub fn create_array(self) -> Result<glow::VertexArray, SceneError> {
        // SAFETY: the context is current.
        let array = unsafe { self.gl.create_vertex_array() }.map_err(SceneError::Object)?;
        self.tally.add(1, 0);
        Ok(array)
    }

    /// Creates a framebuffer with a colour texture and a depth buffer.
    pub fn create_target(self, size: [i32; 2]) -> Result<DrawTarget, SceneError> {
        let gl = self.gl;
        let [width, height] = size;
        // SAFETY: the context is current; the names are created here; no pixels are read.
        unsafe {
            let texture = gl.create_texture().map_err(SceneError::Object)?;
            gl.bind_texture(glow::TEXTURE_2D, Some(texture));
            let pixels = glow::PixelUnpackData::Slice(None);
            let format = glow::RGBA8 as i32;
            gl.tex_image_2d(
                glow::TEXTURE_2D,
                0,
                format,
                width,
                height,
                0,
                glow::RGBA,
                glow::UNSIGNED_BYTE,
                pixels,
            );
            self.set_filter(glow::LINEAR);
            let depth = gl.create_renderbuffer().map_err(SceneError::Object)?;
            gl.bind_renderbuffer(glow::RENDERBUFFER, Some(depth));
            gl.renderbuffer_storage(glow::RENDERBUFFER, glow::DEPTH_COMPONENT24, width, height);
            let framebuffer = gl.create_framebuffer().map_err(SceneError::Object)?;
            gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffer));
            gl.framebuffer_texture_2d(
                glow::FRAMEBUFFER,
                glow::COLOR_ATTACHMENT0,
                glow::TEXTURE_2D,
                Some(texture),
                0,
            );
            gl.framebuffer_renderbuffer(
                glow::FRAMEBUFFER,
                glow::DEPTH_ATTACHMENT,
                glow::RENDERBUFFER,
                Some(depth),
            );
            self.check_framebuffer()?;
            let target = DrawTarget {
                size,
                texture,
                framebuffer,
                depth: Some(depth),
            };
            let (objects, bytes) = target.weight();
            self.tally.add(objects, bytes);
            Ok(target)
        }
    }

    /// Creates a shadow map: a depth texture that is compared when it is read.
    pub fn create_shadow_map(self, side: i32) -> Result<DrawTarget, SceneError> {
        let gl = self.gl;
        // SAFETY: the context is current; the names are created here; no pixels are read.
        unsafe {
            let texture = gl.create_texture().map_err(SceneError::Object)?;
            gl.bind_texture(glow::TEXTURE_2D, Some(texture));
            let pixels = glow::PixelUnpackData::Slice(None);
            let format = glow::DEPTH_COMPONENT24 as i32;
            gl.tex_image_2d(
                glow::TEXTURE_2D,
                0,
                format,
                side,
                side,
                0,
                glow::DEPTH_COMPONENT,
                glow::UNSIGNED_INT,
                pixels,
            );
            self.set_filter(glow::LINEAR);
            for (name, value) in [
                (glow::TEXTURE_COMPARE_MODE, glow::COMPARE_REF_TO_TEXTURE),
                (glow::TEXTURE_COMPARE_FUNC, glow::LEQUAL),
            ] {
                gl.tex_parameter_i32(glow::TEXTURE_2D, name, value as i32);
            }
            let framebuffer = gl.create_framebuffer().map_err(SceneError::Object)?;
            gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffer));
            gl.framebuffer_texture_2d(
                glow::FRAMEBUFFER,
                glow::DEPTH_ATTACHMENT,
                glow::TEXTURE_2D,
                Some(texture),
                0,
            );
            gl.draw_buffers(&[glow::NONE]);
            gl.read_buffer(glow::NONE);
            self.check_framebuffer()?;
            gl.bind_texture(glow::TEXTURE_2D, None);
            let target = DrawTarget {
                size: [side, side],
                texture,
                framebuffer,
                depth: None,
            };
            let (objects, bytes) = target.weight();
            self.tally.add(objects, bytes);
            Ok(target)
        }
    }

    /// Creates the texture that holds the outline of the part.
    pub fn create_outline(self) -> Result<glow::Texture, SceneError> {
        // SAFETY: the context is current; the name is created here.
        unsafe {
            let texture = self.gl.create_texture().map_err(SceneError::Object)?;
            self.gl.bind_texture(glow::TEXTURE_2D, Some(texture));
            self.set_filter(glow::NEAREST);
            self.tally.add(1, OUTLINE_BYTES);
            Ok(texture)
        }
    }

    /// Writes the first row of the outline texture, texels of four floats.
    pub fn write_outline(self, texture: glow::Texture, texels: &[f32]) {
        let bytes: Vec<u8> = texels.iter().flat_map(|it| it.to_ne_bytes()).collect();
        let width = (texels.len() / 4) as i32;
        // SAFETY: the context is current; the slice holds `width` texels of 16 bytes.
        unsafe {
            self.gl.bind_texture(glow::TEXTURE_2D, Some(texture));
            let pixels = glow::PixelUnpackData::Slice(Some(&bytes));
            let format = glow::RGBA32F as i32;
            self.gl.tex_image_2d(
                glow::TEXTURE_2D,
                0,
                format,
                width,
                1,
                0,
                glow::RGBA,
                glow::FLOAT,
                pixels,
            );
            self.gl.bind_texture(glow::TEXTURE_2D, None);
        }
    }

    fn set_filter(self, filter: u32) {
        let edge = glow::CLAMP_TO_EDGE;
        for (name, value) in [
            (glow::TEXTURE_MIN_FILTER, filter),
            (glow::TEXTURE_MAG_FILTER, filter),
            (glow::TEXTURE_WRAP_S, edge),
            (glow::TEXTURE_WRAP_T, edge),
        ] {
            // SAFETY: the context is current; the caller has bound a texture.
            unsafe {
                self.gl
                    .tex_parameter_i32(glow::TEXTURE_2D, name, value as i32);
            };
        }
    }

    fn check_framebuffer(self) -> Result<(), SceneError> {
        // SAFETY: the context is current; the caller has bound a framebuffer.
        match unsafe { self.gl.check_framebuffer_status(glow::FRAMEBUFFER) } {
            glow::FRAMEBUFFER_COMPLETE => Ok(()),
            status => Err(SceneError::Framebuffer(status)),
        }
    }

    /// Deletes a shader program.
    pub fn delete_program(self, program: &SceneProgram) {
        // SAFETY: the context is current and has created the program.
        unsafe { self.gl.delete_program(program.program) };
        self.tally.add(-1, 0);
    }

    /// Deletes the OpenGL buffers of a mesh.
    pub fn delete_mesh(self, mesh: &GpuMesh) {
        // SAFETY: the context is current and has created the buffers.
        unsafe {
            self.gl.delete_vertex_array(mesh.array);
            self.gl.delete_buffer(mesh.vertices);
            self.gl.delete_buffer(mesh.indices);
        }
        self.tally.add(-3, -mesh.bytes);
    }

    /// Deletes a draw target with its texture.
    pub fn delete_target(self, target: &DrawTarget) {
        // SAFETY: the context is current and has created the target.
        unsafe {
            self.gl.delete_framebuffer(target.framebuffer);
            self.gl.delete_texture(target.texture);
            if let Some(depth) = target.depth {
                self.gl.delete_renderbuffer(depth);
            }
        }
        let (objects, bytes) = target.weight();
        self.tally.add(-objects, -bytes);
    }

    /// Deletes a vertex array.
    pub fn delete_array(self, array: glow::VertexArray) {
        // SAFETY: the context is current and has created the array.
        unsafe { self.gl.delete_vertex_array(array) };
        self.tally.add(-1, 0);
    }

    /// Deletes a texture that [`Device::create_outline`] has created.
    pub fn delete_outline(self, texture: glow::Texture) {
        // SAFETY: the context is current and has created the texture.
        unsafe { self.gl.delete_texture(texture) };
        self.tally.add(-1, -OUTLINE_BYTES);
    }
}
