//! Triangles with materials, and the frame in which primitives are added.

#[cfg(test)]
pub mod checks;
pub mod marks;
pub mod occlusion;
pub mod polyline;
pub mod primitives;

use glam::{Mat4, Vec3};

/// How a surface reflects light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneMaterial {
    /// Colour as sRGB bytes.
    pub color: [u8; 3],
    /// Roughness, 0 (mirror) to 255 (chalk).
    pub roughness: u8,
    /// Metallic reflection of the surface, 0 (none) to 255 (metal).
    pub metal: u8,
    /// Strength of turning marks around the spindle axis, 0 to 255.
    pub rings: u8,
    /// Light that the surface emits, 0 to 255.
    pub glow: u8,
}

impl SceneMaterial {
    /// Creates a painted surface with this sRGB colour.
    pub const fn paint(red: u8, green: u8, blue: u8) -> Self {
        Self {
            color: [red, green, blue],
            roughness: 115,
            metal: 0,
            rings: 0,
            glow: 0,
        }
    }

    /// Creates bare steel with a grey level and a roughness, 0 to 255.
    pub const fn steel(level: u8, roughness: u8) -> Self {
        Self {
            color: [level, level, level.saturating_add(5)],
            roughness,
            metal: 255,
            rings: 0,
            glow: 0,
        }
    }

    /// Returns the material with turning marks.
    #[must_use]
    pub const fn turned(self) -> Self {
        Self { rings: 255, ..self }
    }

    /// Returns the material with light that it emits, 0 to 255.
    #[must_use]
    pub const fn glowing(self, glow: u8) -> Self {
        Self { glow, ..self }
    }
}

/// A corner of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneVertex {
    /// Position, mm.
    pub position: Vec3,
    /// Outward direction of the surface, length 1.
    pub normal: Vec3,
    /// How the surface reflects light at the vertex.
    pub material: SceneMaterial,
    /// Share of the sky that is visible from the vertex, 0 to 255; the rest is in ambient
    /// occlusion.
    pub exposure: u8,
}

/// Size of a vertex in a buffer, bytes.
pub const VERTEX_BYTES: usize = 24;

impl SceneVertex {
    /// Appends the vertex in the layout of the shaders: position as 3 floats, normal as 4
    /// signed bytes, colour and exposure as 4 bytes, roughness, metal, rings and glow as 4
    /// bytes.
    pub fn write_bytes(&self, bytes: &mut Vec<u8>) {
        for length in self.position.to_array() {
            bytes.extend_from_slice(&length.to_ne_bytes());
        }
        let normal = (self.normal * 127.0).to_array().map(|it| it as i8);
        bytes.extend(normal.map(|it| it as u8));
        bytes.push(0);
        let it = &self.material;
        bytes.extend_from_slice(&it.color);
        bytes.push(self.exposure);
        bytes.extend_from_slice(&[it.roughness, it.metal, it.rings, it.glow]);
    }
}

/// A triangle mesh, with the frame, material and step for the next primitive that is added.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneMesh {
    /// Corners of the triangles.
    pub vertices: Vec<SceneVertex>,
    /// Three indices per triangle, counter-clockwise seen from outside.
    pub indices: Vec<u32>,
    /// Matrix that places the next primitive.
    pub frame: Mat4,
    /// Material that the next primitive gets.
    pub material: SceneMaterial,
    /// Greatest distance between vertices on flat surfaces, mm: ambient occlusion is stored per
    /// vertex.
    pub step_mm: f32,
}

impl Default for SceneMesh {
    fn default() -> Self {
        Self {
            vertices: Vec::new(),
            indices: Vec::new(),
            frame: Mat4::IDENTITY,
            material: SceneMaterial::steel(170, 90),
            step_mm: 40.0,
        }
    }
}

impl SceneMesh {
    /// Returns the number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }

    /// Adds a vertex given in the current frame. Returns its index. Coordinates that are not
    /// finite become 0.
    pub fn add_vertex(&mut self, position: Vec3, normal: Vec3) -> u32 {
        let finite = |it: Vec3| if it.is_finite() { it } else { Vec3::ZERO };
        let position = finite(self.frame.transform_point3(finite(position)));
        let normal = self.frame.transform_vector3(finite(normal));
        self.vertices.push(SceneVertex {
            position,
            normal: normal.try_normalize().unwrap_or(Vec3::Y),
            material: self.material,
            exposure: 230,
        });
        (self.vertices.len() - 1) as u32
    }

    /// Adds a triangle of three vertex indices.
    pub fn add_triangle(&mut self, corners: [u32; 3]) {
        self.indices.extend(corners);
    }

    /// Calls `add` with a frame relative to the current one, then restores the frame.
    pub fn within(&mut self, frame: Mat4, add: impl FnOnce(&mut Self)) {
        let outer = self.frame;
        self.frame = outer * frame;
        add(self);
        self.frame = outer;
    }

    /// Appends the triangles of another mesh, moved by `frame`.
    pub fn append(&mut self, other: &Self, frame: Mat4) {
        let first = self.vertices.len() as u32;
        let moved = other.vertices.iter().map(|vertex| SceneVertex {
            position: frame.transform_point3(vertex.position),
            normal: frame.transform_vector3(vertex.normal).normalize_or(Vec3::Y),
            ..*vertex
        });
        self.vertices.extend(moved);
        self.indices
            .extend(other.indices.iter().map(|at| at + first));
    }

    /// Returns the vertices in the layout of [`SceneVertex::write_bytes`].
    pub fn vertex_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.vertices.len() * VERTEX_BYTES);
        for vertex in &self.vertices {
            vertex.write_bytes(&mut bytes);
        }
        bytes
    }

    /// Returns the indices of the triangles as bytes.
    pub fn index_bytes(&self) -> Vec<u8> {
        self.indices
            .iter()
            .flat_map(|at| at.to_ne_bytes())
            .collect()
    }
}
