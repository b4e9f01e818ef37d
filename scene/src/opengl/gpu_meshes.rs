//! The meshes of a lathe in the memory of OpenGL. Their ambient occlusion is computed over
//! several frames.

use crate::description::LatheDescription;
use crate::lathe::{MeshDesign, MeshGroup};
use crate::mesh::SceneMesh;
use crate::mesh::occlusion::OcclusionBake;
use crate::opengl::device::{Device, GpuMesh, SceneError, VertexLayout};

/// Number of triangles in depth pictures that one frame may draw to compute ambient occlusion.
const TRIANGLES_PER_FRAME: usize = 130_000;

/// The buffers of a mesh group, with the progress of its ambient occlusion.
#[derive(Debug)]
struct GroupMesh {
    group: MeshGroup,
    buffers: GpuMesh,
    triangles: usize,
    /// The mesh and the computation of its ambient occlusion; `None` once that is complete.
    bake: Option<(SceneMesh, OcclusionBake)>,
}

impl GroupMesh {
    fn create(
        device: Device<'_>,
        design: &MeshDesign,
        group: MeshGroup,
    ) -> Result<Self, SceneError> {
        let mesh = design.build(group);
        let buffers = device.create_mesh(
            VertexLayout::Surface,
            &mesh.vertex_bytes(),
            &mesh.index_bytes(),
        )?;
        let triangles = mesh.triangle_count();
        let needs_bake = !group.is_transparent() && group != MeshGroup::Floor;
        let bake = needs_bake.then(|| {
            let bake = OcclusionBake::new(&mesh);
            (mesh, bake)
        });
        Ok(Self {
            group,
            buffers,
            triangles,
            bake,
        })
    }
}

/// The OpenGL buffers of all mesh groups.
#[derive(Debug)]
pub struct GpuMeshes {
    design: MeshDesign,
    groups: Vec<GroupMesh>,
}

impl GpuMeshes {
    /// Builds and uploads the meshes of a lathe.
    pub fn create(device: Device<'_>, lathe: &LatheDescription) -> Result<Self, SceneError> {
        let design = MeshDesign::new(lathe);
        let mut meshes = Self {
            design,
            groups: Vec::new(),
        };
        for group in MeshGroup::ALL {
            let made = GroupMesh::create(device, &meshes.design, group)?;
            meshes.groups.push(made);
        }
        // Small groups first: the tool looks right at once.
        meshes.groups.sort_by_key(|it| {
            it.bake
                .as_ref()
                .map_or(0, |(mesh, _)| mesh.triangle_count())
        });
        Ok(meshes)
    }

    /// Whether these meshes fit the type, dimensions and tools of a description.
    pub fn is_design_of(&self, lathe: &LatheDescription) -> bool {
        self.design.is_design_of(lathe)
    }

    /// Rebuilds the mesh groups for which a new description differs.
    pub fn update(
        &mut self,
        device: Device<'_>,
        lathe: &LatheDescription,
    ) -> Result<(), SceneError> {
        let design = MeshDesign::new(lathe);
        for known in &mut self.groups {
            if !design.has_same_group(&self.design, known.group) {
                let made = GroupMesh::create(device, &design, known.group)?;
                device.delete_mesh(&core::mem::replace(known, made).buffers);
            }
        }
        self.design = design;
        Ok(())
    }

    /// Returns the number of triangles of all groups.
    pub fn triangle_count(&self) -> usize {
        self.groups.iter().map(|it| it.triangles).sum()
    }

    /// Whether ambient occlusion is still computed.
    pub fn is_baking(&self) -> bool {
        self.groups.iter().any(|it| it.bake.is_some())
    }

    /// Continues the computation of ambient occlusion. Returns true if a mesh has changed.
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

    /// Returns the buffers of a mesh group; `None` if they do not exist.
    pub fn get(&self, group: MeshGroup) -> Option<&GpuMesh> {
        let found = self.groups.iter().find(|it| it.group == group);
        found.map(|it| &it.buffers)
    }

    /// Deletes the OpenGL buffers of all groups.
    pub fn release(&self, device: Device<'_>) {
        for group in &self.groups {
            device.delete_mesh(&group.buffers);
        }
    }
}
