//! The meshes of a lathe in the memory of OpenGL. Their ambient occlusion is computed over
//! several frames.

use crate::description::LatheDescription;
use crate::device::{Device, GpuMesh, SceneError, VertexLayout};
use crate::lathe::{MeshDesign, MeshGroup};
use crate::mesh::SceneMesh;
use crate::occlusion::OcclusionBake;

/// Triangles of depth pictures that one frame may draw for ambient occlusion.
const TRIANGLES_PER_FRAME: usize = 130_000;

/// A group with its state of occlusion.
#[derive(Debug)]
struct GroupMesh {
    group: MeshGroup,
    buffers: GpuMesh,
    /// The mesh and its computation; `None` once it is complete.
    bake: Option<(SceneMesh, OcclusionBake)>,
}

/// The meshes of all groups.
#[derive(Debug)]
pub struct GpuMeshes {
    design: MeshDesign,
    groups: Vec<GroupMesh>,
    triangles: usize,
}

impl GpuMeshes {
    /// Builds and uploads the meshes of a lathe.
    pub fn create(device: Device<'_>, lathe: &LatheDescription) -> Result<Self, SceneError> {
        let design = MeshDesign::new(lathe);
        let mut meshes = Self {
            design,
            groups: Vec::new(),
            triangles: 0,
        };
        for group in MeshGroup::ALL {
            let mesh = meshes.design.build(group);
            meshes.triangles += mesh.triangle_count();
            let buffers = device.create_mesh(
                VertexLayout::Surface,
                &mesh.vertex_bytes(),
                &mesh.index_bytes(),
            )?;
            let needs_bake = !group.is_transparent() && group != MeshGroup::Floor;
            let bake = needs_bake.then(|| {
                let bake = OcclusionBake::new(&mesh);
                (mesh, bake)
            });
            meshes.groups.push(GroupMesh {
                group,
                buffers,
                bake,
            });
        }
        // Small groups first: the tool looks right at once.
        meshes.groups.sort_by_key(|it| {
            it.bake
                .as_ref()
                .map_or(0, |(mesh, _)| mesh.triangle_count())
        });
        Ok(meshes)
    }

    /// Whether these are the meshes of a description.
    pub fn is_design_of(&self, lathe: &LatheDescription) -> bool {
        self.design.is_design_of(lathe)
    }

    /// Number of triangles.
    pub const fn triangle_count(&self) -> usize {
        self.triangles
    }

    /// Whether ambient occlusion is still computed.
    pub fn is_baking(&self) -> bool {
        self.groups.iter().any(|it| it.bake.is_some())
    }

    /// Continues ambient occlusion. Returns true if a mesh has changed.
    pub fn continue_bake(&mut self, device: Device<'_>) -> Result<bool, SceneError> {
        let mut budget = TRIANGLES_PER_FRAME;
        let mut has_changed = false;
        for group in &mut self.groups {
            while let Some((mesh, bake)) = &mut group.bake {
                if budget == 0 {
                    return Ok(has_changed);
                }
                budget = budget.saturating_sub(mesh.triangle_count());
                if bake.add_direction(mesh) {
                    bake.apply(mesh);
                    let buffers = device.create_mesh(
                        VertexLayout::Surface,
                        &mesh.vertex_bytes(),
                        &mesh.index_bytes(),
                    )?;
                    device.delete_mesh(&core::mem::replace(&mut group.buffers, buffers));
                    group.bake = None;
                    has_changed = true;
                }
            }
        }
        Ok(has_changed)
    }

    /// The buffers of a group.
    pub fn get(&self, group: MeshGroup) -> Option<&GpuMesh> {
        let found = self.groups.iter().find(|it| it.group == group);
        found.map(|it| &it.buffers)
    }

    /// Deletes all buffers.
    pub fn release(&self, device: Device<'_>) {
        for group in &self.groups {
            device.delete_mesh(&group.buffers);
        }
    }
}
