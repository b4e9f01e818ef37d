//! What the shaders need to know of one picture.

use core::f32::consts::TAU;

use glam::{Mat4, Vec3, vec3};

use crate::camera::OrbitCamera;
use crate::description::{LatheDescription, SceneTheme};
use crate::lathe::MeshGroup;
use crate::part_details::part_model;
use crate::placement::{LathePlacement, tool_side};

/// Direction from the scene to the main light.
pub const LIGHT: Vec3 = vec3(0.40, 0.80, 0.45);

/// Opacity of panes, 0 (invisible) to 1.
pub const PANE_ALPHA: f32 = 0.10;
/// Opacity of coolant, 0 (invisible) to 1.
pub const COOLANT_ALPHA: f32 = 0.42;
/// Opacity of a blurred jaw of a fast spindle, 0 (invisible) to 1.
pub const HAZE_ALPHA: f32 = 0.13;

/// The mesh groups that do not move while a program runs.
pub const STILL_GROUPS: [MeshGroup; 6] = [
    MeshGroup::Floor,
    MeshGroup::Fixed,
    MeshGroup::Tailstock,
    MeshGroup::Quill,
    MeshGroup::SteadyRest,
    MeshGroup::Door,
];

/// Number of transparent jaws that are drawn for a fast spindle.
const HAZY_JAWS: usize = 12;

/// Matrices, colours and states that the shaders need for one picture.
pub struct FrameInputs {
    pub placement: LathePlacement,
    pub part_model: Mat4,
    /// Matrix of the side of the spindle axis on which the tools are: it tilts the tools of a slant
    /// bed.
    pub tool_side: Mat4,
    pub projection: Mat4,
    pub light_projection: Mat4,
    pub eye: Vec3,
    pub centre: Vec3,
    pub fade: [f32; 2],
    pub ground: [Vec3; 2],
    pub sky: f32,
    pub rows: f32,
    pub has_coolant: bool,
    /// Which lamps of the tower are lit, from below.
    pub lit_lamps: [bool; 3],
    /// Whether the jaws are drawn blurred, as of a fast spindle.
    pub is_spindle_blurred: bool,
}

/// Matrices and colours on which the picture of the stationary parts depends: camera, quill, door
/// and background. The picture is drawn again when one changes.
pub type LayerInputs = ([Mat4; 3], [Vec3; 2]);

impl FrameInputs {
    /// Returns the matrices and colours on which the picture of the stationary parts depends.
    pub fn layer(&self) -> LayerInputs {
        let LathePlacement { quill, door, .. } = self.placement;
        ([self.projection, quill, door], self.ground)
    }

    /// Computes the inputs for a picture of `size` pixels.
    pub fn new(lathe: &LatheDescription, camera: &OrbitCamera, size: [i32; 2]) -> Self {
        let dimensions = lathe.dimensions.sanitized();
        let [width, height] = size.map(|it| it as f32);
        let centre = vec3(
            dimensions.bed_length * 0.35,
            -dimensions.centre_height * 0.6,
            0.0,
        );
        let radius = dimensions.bed_length * 0.62 + dimensions.centre_height * 2.6;
        let light = LIGHT.normalize();
        let (ground, sky) = match lathe.theme {
            SceneTheme::Night => ([vec3(0.135, 0.15, 0.165), vec3(0.235, 0.26, 0.29)], 0.92),
            SceneTheme::Day => ([vec3(0.73, 0.755, 0.775), vec3(0.885, 0.905, 0.92)], 1.12),
        };
        let placement = LathePlacement::new(lathe);
        Self {
            part_model: part_model(lathe, &placement),
            tool_side: tool_side(lathe.kind),
            placement,
            projection: camera.projection(width / height.max(1.0)),
            light_projection: light_projection(centre, light, radius),
            eye: camera.eye(),
            centre,
            fade: [radius * 1.15, radius * 2.6],
            ground,
            sky,
            rows: height,
            has_coolant: lathe.has_coolant,
            lit_lamps: lathe.effects.lit_lamps,
            is_spindle_blurred: lathe.effects.is_spindle_blurred,
        }
    }

    /// Returns the model matrices of the blurred jaws; empty while the spindle turns slowly.
    pub fn hazy_jaws(&self) -> Vec<Mat4> {
        let count = if self.is_spindle_blurred {
            HAZY_JAWS
        } else {
            0
        };
        let turned = |at: usize| {
            Mat4::from_rotation_x(at as f32 * TAU / HAZY_JAWS as f32) * self.placement.jaws[0]
        };
        (0..count).map(turned).collect()
    }

    /// Returns the model matrices with which a mesh group is drawn, one for each copy.
    pub fn models(&self, group: MeshGroup) -> Vec<Mat4> {
        let placement = &self.placement;
        match group {
            MeshGroup::Floor | MeshGroup::Fixed | MeshGroup::SteadyRest => vec![Mat4::IDENTITY],
            MeshGroup::Chuck => vec![placement.spindle],
            MeshGroup::Jaw if self.is_spindle_blurred => Vec::new(),
            MeshGroup::Jaw => placement.jaws.to_vec(),
            MeshGroup::Carriage => vec![placement.carriage],
            MeshGroup::CrossSlide => vec![placement.cross_slide],
            MeshGroup::Carrier => vec![placement.carrier],
            MeshGroup::Tailstock => vec![placement.tailstock],
            MeshGroup::Quill => vec![placement.quill],
            MeshGroup::CarriageWheel => placement.wheels.carriage.into_iter().collect(),
            MeshGroup::CrossWheel => placement.wheels.cross_slide.into_iter().collect(),
            MeshGroup::TailstockWheel => placement.wheels.tailstock.into_iter().collect(),
            MeshGroup::PanelWheel => placement.wheels.panel.into_iter().collect(),
            MeshGroup::SteadyJaw => placement.steady_jaws.into_iter().flatten().collect(),
            MeshGroup::Lamp(lamp) if self.lit_lamps[lamp as usize] => vec![Mat4::IDENTITY],
            MeshGroup::Door | MeshGroup::Pane => vec![placement.door],
            MeshGroup::Coolant if self.has_coolant => vec![placement.coolant],
            MeshGroup::Lamp(_) | MeshGroup::Coolant => Vec::new(),
        }
    }
}

/// Returns the projection from the main light: a cube with half side `radius` around `centre`.
fn light_projection(centre: Vec3, light: Vec3, radius: f32) -> Mat4 {
    let right = Vec3::Y.cross(light).normalize();
    let up = light.cross(right);
    let rows = [right / radius, up / radius, -light / (radius * 1.4)];
    let shift = rows.map(|row| -row.dot(centre));
    Mat4::from_cols(
        vec3(rows[0].x, rows[1].x, rows[2].x).extend(0.0),
        vec3(rows[0].y, rows[1].y, rows[2].y).extend(0.0),
        vec3(rows[0].z, rows[1].z, rows[2].z).extend(0.0),
        Vec3::from_array(shift).extend(1.0),
    )
}
