//! The machines: meshes generated from kind and dimensions.

mod bench;
mod chuck;
mod control_panel;
mod flat_bed;
mod palette;
mod slant_bed;
mod slides;
mod steady_rest;
mod tailstock;
mod tool_carrier;
mod tools;
mod tower;
mod wheels;

use crate::description::{LatheDescription, LatheDimensions, LatheKind, MountedTool, TowerLamp};
use crate::mesh::SceneMesh;

/// A group of triangles that moves as a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshGroup {
    /// The floor of the workshop.
    Floor,
    /// The stationary parts: bed, headstock and walls.
    Fixed,
    /// The body of the chuck.
    Chuck,
    /// One jaw of the chuck, drawn three times.
    Jaw,
    /// The carriage.
    Carriage,
    /// The cross slide with the base of the tool carrier.
    CrossSlide,
    /// Tool post or turret with its tools.
    Carrier,
    /// The body of the tailstock.
    Tailstock,
    /// The quill with its centre.
    Quill,
    /// The hand wheel on the apron, which moves the carriage.
    CarriageWheel,
    /// The hand wheel of the cross slide.
    CrossWheel,
    /// The hand wheel of the tailstock.
    TailstockWheel,
    /// The electronic hand wheel of the operator panel.
    PanelWheel,
    /// Ring and foot of the steady rest.
    SteadyRest,
    /// One jaw of the steady rest, drawn three times.
    SteadyJaw,
    /// The glass of a lit lamp of the tower.
    Lamp(TowerLamp),
    /// The frame of the machine guard.
    Door,
    /// The pane of the machine guard, which is transparent.
    Pane,
    /// The jet of coolant, which is transparent.
    Coolant,
}

impl MeshGroup {
    /// All mesh groups.
    pub const ALL: [Self; 21] = [
        Self::Floor,
        Self::Fixed,
        Self::Chuck,
        Self::Jaw,
        Self::Carriage,
        Self::CrossSlide,
        Self::Carrier,
        Self::Tailstock,
        Self::Quill,
        Self::CarriageWheel,
        Self::CrossWheel,
        Self::TailstockWheel,
        Self::PanelWheel,
        Self::SteadyRest,
        Self::SteadyJaw,
        Self::Lamp(TowerLamp::Green),
        Self::Lamp(TowerLamp::Yellow),
        Self::Lamp(TowerLamp::Red),
        Self::Door,
        Self::Pane,
        Self::Coolant,
    ];

    /// Whether the group is drawn transparent: a pane or the coolant.
    pub const fn is_transparent(self) -> bool {
        matches!(self, Self::Pane | Self::Coolant)
    }
}

/// Type, dimensions and tools of a lathe, from which its meshes are built.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshDesign {
    kind: LatheKind,
    dimensions: LatheDimensions,
    tools: Vec<Option<MountedTool>>,
    quill_diameter: Option<f32>,
}

impl MeshDesign {
    /// Takes type, dimensions and tools from a description.
    pub fn new(lathe: &LatheDescription) -> Self {
        Self {
            kind: lathe.kind,
            dimensions: lathe.dimensions.sanitized(),
            tools: lathe.tools.clone(),
            quill_diameter: lathe.quill.map(|it| it.diameter),
        }
    }

    /// Whether the meshes of a description are those of this design.
    pub fn is_design_of(&self, lathe: &LatheDescription) -> bool {
        self.kind == lathe.kind
            && self.dimensions == lathe.dimensions.sanitized()
            && self.tools == lathe.tools
            && self.quill_diameter == lathe.quill.map(|it| it.diameter)
    }

    /// Whether a group has the same mesh in the design `other`.
    pub fn has_same_group(&self, other: &Self, group: MeshGroup) -> bool {
        let is_same_machine = self.kind == other.kind && self.dimensions == other.dimensions;
        is_same_machine
            && match group {
                MeshGroup::Carrier => self.tools == other.tools,
                MeshGroup::Quill => self.quill_diameter == other.quill_diameter,
                _ => true,
            }
    }

    /// Builds the mesh of one group.
    pub fn build(&self, group: MeshGroup) -> SceneMesh {
        let (mut mesh, dimensions) = (SceneMesh::default(), &self.dimensions);
        match (group, self.kind) {
            (MeshGroup::Floor, kind) => add_floor(&mut mesh, kind, dimensions),
            (MeshGroup::Fixed, LatheKind::FlatBed) => flat_bed::add_fixed(&mut mesh, dimensions),
            (MeshGroup::Fixed, LatheKind::SlantBed) => slant_bed::add_fixed(&mut mesh, dimensions),
            (MeshGroup::Fixed, LatheKind::Bench) => bench::add_fixed(&mut mesh, dimensions),
            (MeshGroup::Chuck, _) => chuck::add_body(&mut mesh, dimensions),
            (MeshGroup::Jaw, _) => chuck::add_jaw(&mut mesh, dimensions),
            (MeshGroup::Carriage, LatheKind::SlantBed) => {
                slides::add_slant_carriage(&mut mesh, dimensions);
            }
            (MeshGroup::Carriage, kind) => slides::add_carriage(&mut mesh, kind, dimensions),
            (MeshGroup::CrossSlide, LatheKind::SlantBed) => {
                slides::add_turret_slide(&mut mesh, dimensions);
            }
            (MeshGroup::CrossSlide, kind) => slides::add_cross_slide(&mut mesh, kind, dimensions),
            (MeshGroup::Carrier, kind) => {
                tool_carrier::add_carrier(&mut mesh, kind, dimensions, &self.tools);
            }
            (MeshGroup::Tailstock, kind) => tailstock::add_body(&mut mesh, kind, dimensions),
            (MeshGroup::Quill, _) => {
                tailstock::add_quill(&mut mesh, dimensions, self.quill_diameter);
            }
            (MeshGroup::CarriageWheel, kind) => {
                wheels::add_carriage_wheel(&mut mesh, kind, dimensions);
            }
            (MeshGroup::CrossWheel, _) => wheels::add_cross_wheel(&mut mesh, dimensions),
            (MeshGroup::TailstockWheel, _) => wheels::add_tailstock_wheel(&mut mesh, dimensions),
            (MeshGroup::PanelWheel, _) => wheels::add_panel_wheel(&mut mesh, dimensions),
            (MeshGroup::SteadyRest, kind) => steady_rest::add_body(&mut mesh, kind, dimensions),
            (MeshGroup::SteadyJaw, _) => steady_rest::add_jaw(&mut mesh, dimensions),
            (MeshGroup::Lamp(lamp), kind) => {
                tower::add_lit_lamp(&mut mesh, kind, dimensions, lamp);
            }
            (MeshGroup::Door, LatheKind::SlantBed) => slant_bed::add_door(&mut mesh, dimensions),
            (MeshGroup::Door, kind) => chuck::add_guard_frame(&mut mesh, kind, dimensions),
            (MeshGroup::Pane, LatheKind::SlantBed) => slant_bed::add_pane(&mut mesh, dimensions),
            (MeshGroup::Pane, _) => chuck::add_guard_pane(&mut mesh, dimensions),
            (MeshGroup::Coolant, kind) => slides::add_jet(&mut mesh, kind, dimensions),
        }
        mesh
    }
}

/// Adds the floor of the workshop to the mesh. A bench lathe stands on a bench instead.
fn add_floor(mesh: &mut SceneMesh, kind: LatheKind, dimensions: &LatheDimensions) {
    let bench = match kind {
        LatheKind::Bench => 640.0 * dimensions.centre_height / 190.0,
        LatheKind::FlatBed | LatheKind::SlantBed => 0.0,
    };
    let y = floor_y(kind, dimensions) - bench;
    let side = (dimensions.bed_length * 6.0).max(9000.0);
    mesh.material = palette::FLOOR;
    mesh.step_mm = side;
    let corner = glam::vec3(-side, y, side);
    mesh.add_plate(
        corner,
        glam::Vec3::X * side * 2.0,
        glam::Vec3::NEG_Z * side * 2.0,
    );
}

/// Returns the height of the floor relative to the spindle axis, mm.
fn floor_y(kind: LatheKind, dimensions: &LatheDimensions) -> f32 {
    let below = match kind {
        LatheKind::FlatBed => 2.6,
        LatheKind::SlantBed => 2.5,
        LatheKind::Bench => 1.75,
    };
    -dimensions.centre_height * below
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::MountedToolForm;
    use crate::mesh::checks::assert_unit_normals;

    fn designs() -> Vec<MeshDesign> {
        let shank = MountedTool {
            form: MountedToolForm::Shank,
            insert: vec![vec![[0.0, 0.0], [12.0, 2.0], [2.0, 12.0]]],
            holder: vec![vec![[1.0, 5.0], [21.0, 5.0], [21.0, 60.0], [1.0, 60.0]]],
        };
        let bar = MountedTool {
            form: MountedToolForm::Bar,
            insert: vec![],
            holder: vec![vec![[2.0, -14.0], [80.0, -14.0], [80.0, -2.0], [2.0, -2.0]]],
        };
        let drill = MountedTool {
            form: MountedToolForm::Drill {
                diameter: 12.0,
                point: 118.0,
                reach: 80.0,
            },
            insert: vec![],
            holder: vec![],
        };
        let kinds = [LatheKind::FlatBed, LatheKind::SlantBed, LatheKind::Bench];
        let sizes = [
            (620.0, 190.0, 200.0),
            (2500.0, 320.0, 400.0),
            (0.0, f32::NAN, 1e9),
        ];
        kinds
            .iter()
            .flat_map(|&kind| sizes.map(|size| (kind, size)))
            .map(|(kind, (bed_length, centre_height, chuck_diameter))| {
                let lathe = LatheDescription {
                    kind,
                    dimensions: LatheDimensions {
                        bed_length,
                        centre_height,
                        chuck_diameter,
                        steady_rest: Some(180.0),
                        ..LatheDimensions::default()
                    },
                    tools: vec![
                        Some(shank.clone()),
                        Some(bar.clone()),
                        None,
                        Some(drill.clone()),
                    ],
                    ..LatheDescription::default()
                };
                MeshDesign::new(&lathe)
            })
            .collect()
    }

    #[test]
    fn all_groups_of_all_machines_have_sound_triangles() {
        for design in designs() {
            for group in MeshGroup::ALL {
                let mesh = design.build(group);
                let what = format!("{group:?} of {:?} {:?}", design.kind, design.dimensions);
                assert!(mesh.triangle_count() > 1, "{what}");
                assert!(
                    mesh.triangle_count() < 120_000,
                    "{what}: {}",
                    mesh.triangle_count()
                );
                assert_unit_normals(&mesh);
                let count = mesh.vertices.len() as u32;
                assert!(mesh.indices.iter().all(|at| *at < count), "{what}");
                assert!(
                    mesh.vertices.iter().all(|it| it.position.is_finite()),
                    "{what}"
                );
            }
        }
    }

    #[test]
    fn a_lathe_without_a_steady_rest_draws_none_and_lit_lamps_cover_the_dark_ones() {
        let design = MeshDesign::new(&LatheDescription::default());
        for group in [MeshGroup::SteadyRest, MeshGroup::SteadyJaw] {
            assert_eq!(design.build(group).triangle_count(), 0);
        }
        let top = |lamp| {
            let mesh = design.build(MeshGroup::Lamp(lamp));
            let heights = mesh.vertices.iter().map(|it| it.position.y);
            heights.fold(f32::MIN, f32::max)
        };
        let tops = TowerLamp::ALL.map(top);
        assert!(
            tops.windows(2).all(|pair| pair[1] > pair[0] + 20.0),
            "{tops:?}"
        );
    }

    #[test]
    fn no_part_of_a_machine_is_in_the_way_of_the_part() {
        // The cylinder of a part of 40 mm, 100 mm in front of the chuck's jaws.
        for design in designs()
            .into_iter()
            .filter(|it| it.dimensions.bed_length > 300.0)
        {
            let mesh = design.build(MeshGroup::Fixed);
            let from = design.dimensions.jaw_length + 20.0;
            for vertex in &mesh.vertices {
                let at = vertex.position;
                let is_near = at.x > from && at.x < from + 100.0 && at.y.hypot(at.z) < 40.0;
                assert!(!is_near, "{:?}: {at}", design.kind);
            }
        }
    }
}
