//! Where the groups of meshes are at one moment: their model matrices.

pub mod hand_wheels;

use core::f32::consts::{FRAC_PI_2, TAU};

use glam::{Mat4, Vec3, vec3};

use crate::description::{
    LatheDescription, LatheDimensions, LatheKind, MountedTool, MountedToolForm,
};
use hand_wheels::{HandWheels, WheelMotion};

/// Angle about the spindle axis between the tool directions of a flat bed and of a slant bed,
/// radians: away from the operator and up at 45 degrees.
const SLANT: f32 = -3.0 * FRAC_PI_2 / 2.0;
/// Distance of the tailstock body from the point of its centre, mm.
const QUILL_OUT_MM: f32 = 95.0;
/// Default overhang of a shank without a described holder, mm.
const USUAL_OVERHANG_MM: f32 = 30.0;

/// Returns the matrix of the frame of the tools, in which z points from the spindle axis to the
/// tool post.
pub fn tool_side(kind: LatheKind) -> Mat4 {
    match kind {
        LatheKind::FlatBed | LatheKind::Bench => Mat4::IDENTITY,
        LatheKind::SlantBed => Mat4::from_rotation_x(SLANT),
    }
}

/// Returns the scale of tool post, turret and slides relative to a lathe of 190 mm centre height.
pub fn tool_scale(dimensions: &LatheDimensions) -> f32 {
    (dimensions.centre_height / 190.0).clamp(0.45, 2.0)
}

/// Returns half the side of a tool post, or the radius of a turret, mm.
pub fn carrier_radius(kind: LatheKind, dimensions: &LatheDimensions) -> f32 {
    let scale = tool_scale(dimensions);
    match kind {
        LatheKind::FlatBed | LatheKind::Bench => 52.0 * scale,
        LatheKind::SlantBed => 112.0 * scale,
    }
}

/// Returns the position of the tool tip in the scene, mm.
pub fn tip(lathe: &LatheDescription) -> Vec3 {
    let finite = |value: f32| {
        if value.is_finite() {
            value.clamp(-9000.0, 9000.0)
        } else {
            0.0
        }
    };
    let at = vec3(finite(lathe.tip.x), 0.0, finite(lathe.tip.radius));
    tool_side(lathe.kind).transform_point3(at)
}

/// Returns least x, greatest x and greatest radius of the part, mm; those of the jaws without a
/// part.
pub fn part_bounds(lathe: &LatheDescription) -> (f32, f32, f32) {
    let jaws = lathe.dimensions.sanitized().jaw_length;
    lathe.part.bounds().unwrap_or((0.0, jaws, lathe.jaw_radius))
}

/// Returns the distance of a tool's tip from the end of its holder, mm.
fn overhang(tool: &MountedTool) -> f32 {
    let points = tool.holder.iter().flatten();
    let far = |axis: usize| points.clone().map(|it| it[axis]).fold(0.0, f32::max);
    let reach = match tool.form {
        MountedToolForm::Shank => far(1),
        MountedToolForm::Bar => far(0),
        MountedToolForm::Drill { reach, .. } => reach.max(far(0)),
    };
    match reach.is_finite() && reach > 1.0 {
        true => reach.min(400.0),
        false => USUAL_OVERHANG_MM,
    }
}

/// Returns the position of a tool's tip relative to the centre of tool post or turret while its
/// station is in the working position, mm, in the frame of the tools.
pub fn mounted_tip(
    kind: LatheKind,
    dimensions: &LatheDimensions,
    tool: Option<&MountedTool>,
) -> Vec3 {
    let radius = carrier_radius(kind, dimensions);
    let (out, is_axial) = match tool {
        Some(tool) => (overhang(tool), tool.form != MountedToolForm::Shank),
        None => (USUAL_OVERHANG_MM, false),
    };
    let is_turret = kind == LatheKind::SlantBed;
    match (is_turret, is_axial) {
        (false, false) => vec3(-radius, 0.0, -radius - out),
        (false, true) => vec3(-radius - out, 0.0, -radius + 14.0),
        (true, false) => vec3(8.0, 0.0, -radius - out),
        (true, true) => vec3(-out, 0.0, -radius + 22.0),
    }
}

/// Returns the rotation of a station from the working position, in the frame of the tools.
pub fn station_turn(kind: LatheKind, station: usize) -> Mat4 {
    carrier_turn(kind, station as f32)
}

/// Returns the rotation of tool post or turret by a number of stations, in the frame of the tools.
fn carrier_turn(kind: LatheKind, stations: f32) -> Mat4 {
    let share = match stations.is_finite() {
        true => stations / kind.station_count() as f32 % 1.0,
        false => 0.0,
    };
    match kind {
        LatheKind::FlatBed | LatheKind::Bench => Mat4::from_rotation_y(share * TAU),
        LatheKind::SlantBed => Mat4::from_rotation_x(share * TAU),
    }
}

/// Returns the inner and outer radius of the steady rest's ring, mm.
pub fn steady_ring(dimensions: &LatheDimensions) -> (f32, f32) {
    let inner = dimensions.centre_height * 0.5;
    (inner, inner + 26.0 * tool_scale(dimensions))
}

/// Returns the rotation of a jaw of the steady rest from one that points up: one jaw is below, two
/// are above.
pub fn steady_jaw_turn(jaw: usize) -> Mat4 {
    Mat4::from_rotation_x((jaw as f32 + 0.5) * TAU / 3.0)
}

/// Returns the matrices of the steady rest's jaws, which touch the part; `None` without a steady
/// rest.
fn steady_jaws(lathe: &LatheDescription, dimensions: &LatheDimensions) -> Option<[Mat4; 3]> {
    let x = dimensions.steady_rest?;
    let (inner, _) = steady_ring(dimensions);
    // Without material they are drawn back.
    let radius = lathe.part.radius_at(x).unwrap_or(inner).min(inner);
    let jaw = |at: usize| steady_jaw_turn(at) * Mat4::from_translation(vec3(x, radius, 0.0));
    Some([jaw(0), jaw(1), jaw(2)])
}

/// The model matrices of all moving groups of a lathe at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LathePlacement {
    /// Matrix of the chuck and the part, which turn with the spindle.
    pub spindle: Mat4,
    /// Matrices of the three jaws of the chuck.
    pub jaws: [Mat4; 3],
    /// Matrix of the carriage, which moves along the axis only.
    pub carriage: Mat4,
    /// Matrix of the cross slide.
    pub cross_slide: Mat4,
    /// Matrix of the tool post or turret with its tools.
    pub carrier: Mat4,
    /// Matrix of the tailstock body.
    pub tailstock: Mat4,
    /// Matrix of the tailstock quill.
    pub quill: Mat4,
    /// Matrices of the hand wheels.
    pub wheels: HandWheels,
    /// Matrices of the steady rest's jaws; `None` without a steady rest.
    pub steady_jaws: Option<[Mat4; 3]>,
    /// Matrix of the machine guard or door.
    pub door: Mat4,
    /// Matrix of the coolant jet at the tool tip.
    pub coolant: Mat4,
}

impl LathePlacement {
    /// Computes the matrices of a lathe at one moment.
    pub fn new(lathe: &LatheDescription) -> Self {
        let dimensions = lathe.dimensions.sanitized();
        let angle = match lathe.spindle_angle.is_finite() {
            true => lathe.spindle_angle % TAU,
            false => 0.0,
        };
        let spindle = Mat4::from_rotation_x(angle);
        let radius = match lathe.jaw_radius.is_finite() {
            true => lathe.jaw_radius.clamp(1.0, dimensions.chuck_diameter * 0.5),
            false => dimensions.chuck_diameter * 0.25,
        };
        let jaw = |at: usize| {
            spindle
                * Mat4::from_rotation_x(at as f32 * TAU / 3.0)
                * Mat4::from_translation(vec3(0.0, radius, 0.0))
        };
        let side = tool_side(lathe.kind);
        let tip = side.inverse().transform_point3(tip(lathe));
        let centre = tip - mounted_tip(lathe.kind, &dimensions, lathe.current_tool());
        let along = vec3(centre.x, 0.0, 0.0);
        let across = vec3(centre.x, 0.0, centre.z);
        let quill_x = match lathe.quill.map(|it| it.tip_x).filter(|it| it.is_finite()) {
            Some(x) => x.clamp(0.0, dimensions.bed_length - 60.0),
            None => dimensions.bed_length - 260.0 * tool_scale(&dimensions),
        };
        let retraction = lathe.quill.map_or(0.0, |it| it.retraction);
        let retraction = match retraction.is_finite() {
            true => retraction.clamp(0.0, QUILL_OUT_MM),
            false => 0.0,
        };
        let carriage = side * Mat4::from_translation(along);
        let cross_slide = side * Mat4::from_translation(across);
        let tailstock = Mat4::from_translation(vec3(quill_x + QUILL_OUT_MM, 0.0, 0.0));
        let motion = WheelMotion {
            carriage: (carriage, centre.x),
            cross_slide: (cross_slide, centre.z),
            tailstock: (tailstock, retraction),
            detents: lathe.effects.wheel_detents,
        };
        Self {
            spindle,
            jaws: [jaw(0), jaw(1), jaw(2)],
            carriage,
            cross_slide,
            carrier: side
                * Mat4::from_translation(across)
                * carrier_turn(lathe.kind, lathe.effects.station_offset)
                * station_turn(lathe.kind, lathe.station).inverse(),
            tailstock,
            wheels: HandWheels::new(lathe.kind, &dimensions, &motion),
            steady_jaws: steady_jaws(lathe, &dimensions),
            quill: Mat4::from_translation(vec3(quill_x + retraction, 0.0, 0.0)),
            door: door(lathe, &dimensions),
            coolant: side * Mat4::from_translation(tip),
        }
    }

    /// Returns the matrices of all groups but jaws, hand wheels and steady rest.
    pub fn all(&self) -> [Mat4; 11] {
        let [a, b, c] = self.jaws;
        let Self {
            spindle,
            carriage,
            cross_slide,
            carrier,
            ..
        } = *self;
        let Self {
            tailstock,
            quill,
            door,
            coolant,
            ..
        } = *self;
        [
            spindle,
            a,
            b,
            c,
            carriage,
            cross_slide,
            carrier,
            tailstock,
            quill,
            door,
            coolant,
        ]
    }
}

/// Returns the matrix of the guard: a chuck guard swings up and back, the door of a slant bed
/// slides to the right.
fn door(lathe: &LatheDescription, dimensions: &LatheDimensions) -> Mat4 {
    let opening = match lathe.door_opening.is_finite() {
        true => lathe.door_opening.clamp(0.0, 1.0),
        false => 0.0,
    };
    match lathe.kind {
        LatheKind::FlatBed | LatheKind::Bench => Mat4::from_rotation_x(-opening * 1.6),
        LatheKind::SlantBed => {
            Mat4::from_translation(vec3(opening * dimensions.bed_length * 0.62, 0.0, 0.0))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::TipPosition;

    #[test]
    fn the_tip_of_the_mounted_tool_is_where_the_control_has_it() {
        let shank = MountedTool {
            form: MountedToolForm::Shank,
            insert: vec![vec![[0.0, 0.0], [10.0, 2.0], [2.0, 10.0]]],
            holder: vec![vec![[1.0, 5.0], [21.0, 5.0], [21.0, 60.0], [1.0, 60.0]]],
        };
        let drill = MountedTool {
            form: MountedToolForm::Drill {
                diameter: 10.0,
                point: 118.0,
                reach: 80.0,
            },
            insert: vec![],
            holder: vec![],
        };
        for kind in [LatheKind::FlatBed, LatheKind::SlantBed, LatheKind::Bench] {
            for (station, tool) in [(0, &shank), (3, &drill), (1, &shank)] {
                let mut lathe = LatheDescription {
                    kind,
                    station,
                    tip: TipPosition {
                        x: 130.0,
                        radius: 12.5,
                    },
                    ..LatheDescription::default()
                };
                lathe.tools = vec![Some(tool.clone()); kind.station_count()];
                let mounted = mounted_tip(kind, &lathe.dimensions, Some(tool));
                let at = station_turn(kind, station).transform_point3(mounted);
                let drawn = LathePlacement::new(&lathe).carrier.transform_point3(at);
                assert!(
                    drawn.distance(tip(&lathe)) < 1e-2,
                    "{kind:?} {station}: {drawn}"
                );
            }
        }
    }

    #[test]
    fn a_carrier_turns_from_its_last_station_to_the_next() {
        for kind in [LatheKind::FlatBed, LatheKind::SlantBed] {
            let carrier = |station: usize, station_offset: f32| {
                let mut lathe = LatheDescription {
                    kind,
                    station,
                    ..LatheDescription::default()
                };
                lathe.effects.station_offset = station_offset;
                LathePlacement::new(&lathe).carrier
            };
            // Two stations before the third one is the first one.
            assert!(carrier(2, 2.0).abs_diff_eq(carrier(0, 0.0), 1e-3));
            assert!(!carrier(2, 0.5).abs_diff_eq(carrier(2, 0.0), 1e-3));
        }
    }

    #[test]
    fn degenerate_input_gives_finite_matrices() {
        let wrong = f32::NAN;
        for kind in [LatheKind::FlatBed, LatheKind::SlantBed] {
            let lathe = LatheDescription {
                kind,
                spindle_angle: wrong,
                jaw_radius: wrong,
                tip: TipPosition {
                    x: wrong,
                    radius: f32::INFINITY,
                },
                station: 77,
                door_opening: wrong,
                ..LatheDescription::default()
            };
            assert!(
                LathePlacement::new(&lathe)
                    .all()
                    .iter()
                    .all(Mat4::is_finite)
            );
        }
    }
}
