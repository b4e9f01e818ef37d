//! Where the hand wheels of the machines are, and how far they have turned.

use core::f32::consts::{FRAC_PI_2, TAU};

use glam::{Mat4, Vec3, vec3};

use super::tool_scale;
use crate::description::{LatheDimensions, LatheKind};

/// Travel of the carriage for one turn of its hand wheel, mm.
const CARRIAGE_MM_PER_TURN: f32 = 60.0;
const CROSS_MM_PER_TURN: f32 = 10.0;
const QUILL_MM_PER_TURN: f32 = 10.0;
/// Number of detents in one turn of the electronic hand wheel.
const DETENTS_PER_TURN: i32 = 100;

/// The model matrices of the hand wheels, each about the x axis; `None` for a wheel that the
/// machine does not have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandWheels {
    /// Matrix of the hand wheel on the apron, which turns with the carriage; `None` without it.
    pub carriage: Option<Mat4>,
    /// Matrix of the hand wheel of the cross slide; `None` without it.
    pub cross_slide: Option<Mat4>,
    /// Matrix of the hand wheel of the tailstock, which turns with the quill; `None` without it.
    pub tailstock: Option<Mat4>,
    /// Matrix of the electronic hand wheel on the operator panel; `None` without it.
    pub panel: Option<Mat4>,
}

/// Positions of the slides and the quill, which turn their hand wheels, with the frames that carry
/// the wheels.
#[derive(Clone, Copy, Debug)]
pub struct WheelMotion {
    /// Matrix of the carriage, and its position along the axis, mm.
    pub carriage: (Mat4, f32),
    /// Matrix of the cross slide, and its distance from the axis, mm.
    pub cross_slide: (Mat4, f32),
    /// Matrix of the tailstock body, and the retraction of the quill, mm.
    pub tailstock: (Mat4, f32),
    /// Position of the electronic hand wheel, detents, clockwise positive.
    pub detents: i32,
}

impl HandWheels {
    /// Computes the matrices of all hand wheels.
    pub fn new(kind: LatheKind, dimensions: &LatheDimensions, motion: &WheelMotion) -> Self {
        let turned = |wheel: Option<Mat4>, (frame, travel): (Mat4, f32), pitch: f32| {
            wheel.map(|wheel| frame * wheel * Mat4::from_rotation_x(travel / pitch % 1.0 * TAU))
        };
        let detents = motion.detents.rem_euclid(DETENTS_PER_TURN);
        // Seen by the operator, who looks against the axis of the wheel.
        let clockwise = -(detents as f32) / DETENTS_PER_TURN as f32;
        Self {
            carriage: turned(
                carriage_wheel(kind, dimensions),
                motion.carriage,
                CARRIAGE_MM_PER_TURN,
            ),
            cross_slide: turned(
                cross_wheel(kind, dimensions),
                motion.cross_slide,
                CROSS_MM_PER_TURN,
            ),
            tailstock: turned(
                tailstock_wheel(kind, dimensions),
                motion.tailstock,
                QUILL_MM_PER_TURN,
            ),
            panel: turned(
                panel_wheel(kind, dimensions),
                (Mat4::IDENTITY, clockwise),
                1.0,
            ),
        }
    }
}

/// Returns the matrix of a hand wheel at `at` whose axis points to the operator.
fn facing(at: Vec3) -> Mat4 {
    Mat4::from_translation(at) * Mat4::from_rotation_y(-FRAC_PI_2)
}

/// Returns the heights of the apron's lower edge and of the carriage's top, mm.
pub fn apron_span(kind: LatheKind, dimensions: &LatheDimensions) -> (f32, f32) {
    let below = match kind {
        LatheKind::Bench => 78.0,
        LatheKind::FlatBed | LatheKind::SlantBed => 165.0,
    };
    let height = dimensions.centre_height;
    let top = -height + 42.0 * tool_scale(dimensions);
    (-height - below * height / 190.0, top)
}

/// Returns the distance of the apron's front from the spindle axis, mm.
pub fn apron_front(kind: LatheKind, dimensions: &LatheDimensions) -> f32 {
    let front = match kind {
        LatheKind::Bench => 150.0,
        LatheKind::FlatBed | LatheKind::SlantBed => 208.0,
    };
    front * dimensions.centre_height / 190.0
}

/// Returns the matrix of the hand wheel on the apron, relative to the carriage; `None` without it.
fn carriage_wheel(kind: LatheKind, dimensions: &LatheDimensions) -> Option<Mat4> {
    let (foot, top) = apron_span(kind, dimensions);
    let at = vec3(
        35.0 * tool_scale(dimensions),
        foot + (top - foot) * 0.46,
        apron_front(kind, dimensions),
    );
    (kind != LatheKind::SlantBed).then(|| facing(at))
}

/// Returns the matrix of the cross slide's hand wheel, relative to the cross slide.
fn cross_wheel(kind: LatheKind, dimensions: &LatheDimensions) -> Option<Mat4> {
    let (scale, wide) = (tool_scale(dimensions), dimensions.centre_height / 190.0);
    let at = vec3(
        0.0,
        -dimensions.centre_height + 71.0 * scale,
        118.0 * wide + 66.0 * scale,
    );
    (kind == LatheKind::Bench).then(|| facing(at))
}

/// Returns the length of the tailstock body, mm.
pub fn tailstock_length(dimensions: &LatheDimensions) -> f32 {
    165.0 * tool_scale(dimensions)
}

/// Returns the matrix of the tailstock's hand wheel, relative to the tailstock; `None` without it.
fn tailstock_wheel(kind: LatheKind, dimensions: &LatheDimensions) -> Option<Mat4> {
    let at = vec3(tailstock_length(dimensions), 0.0, 0.0);
    (kind != LatheKind::SlantBed).then(|| Mat4::from_translation(at))
}

/// Returns the operator panel: its upper left front corner, then width and height, mm; `None` if
/// the machine has only switches.
pub fn operator_panel(kind: LatheKind, dimensions: &LatheDimensions) -> Option<(Vec3, [f32; 2])> {
    let (height, scale) = (dimensions.centre_height, dimensions.centre_height / 190.0);
    let head = -dimensions.chuck_length - 26.0;
    let width = 276.0 * scale;
    match kind {
        LatheKind::FlatBed => {
            let corner = vec3(head - 298.0 * scale, height * 0.86, 168.0 * scale);
            Some((corner, [width, height * 1.18]))
        }
        LatheKind::SlantBed => {
            let lintel = height * 1.78;
            let corner = vec3(head - 318.0 * scale, lintel * 0.86, 296.0 * scale);
            Some((corner, [width, lintel * 1.02]))
        }
        LatheKind::Bench => None,
    }
}

/// Returns the depth of the operator panel, mm.
pub fn panel_depth(dimensions: &LatheDimensions) -> f32 {
    14.0 * dimensions.centre_height / 190.0
}

/// Returns the matrix of the electronic hand wheel on the operator panel; `None` without it.
fn panel_wheel(kind: LatheKind, dimensions: &LatheDimensions) -> Option<Mat4> {
    let (corner, [width, height]) = operator_panel(kind, dimensions)?;
    let shift = vec3(width * 0.76, -height * 0.86, panel_depth(dimensions));
    Some(facing(corner + shift))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(travel: f32, detents: i32) -> WheelMotion {
        WheelMotion {
            carriage: (Mat4::IDENTITY, travel),
            cross_slide: (Mat4::IDENTITY, travel),
            tailstock: (Mat4::IDENTITY, travel),
            detents,
        }
    }

    #[test]
    fn each_machine_has_its_wheels() {
        let dimensions = LatheDimensions::default();
        let has = |kind| {
            let wheels = HandWheels::new(kind, &dimensions, &motion(0.0, 0));
            [
                wheels.carriage,
                wheels.cross_slide,
                wheels.tailstock,
                wheels.panel,
            ]
            .map(|it| it.is_some())
        };
        assert_eq!(has(LatheKind::FlatBed), [true, false, true, true]);
        assert_eq!(has(LatheKind::SlantBed), [false, false, false, true]);
        assert_eq!(has(LatheKind::Bench), [true, true, true, false]);
    }

    #[test]
    fn wheels_turn_with_their_slide_and_the_electronic_one_clockwise() {
        let dimensions = LatheDimensions::default();
        let wheels = |travel: f32, detents: i32| {
            HandWheels::new(LatheKind::FlatBed, &dimensions, &motion(travel, detents))
        };
        let still = wheels(0.0, 0);
        assert_eq!(wheels(CARRIAGE_MM_PER_TURN, 0).carriage, still.carriage);
        assert_ne!(wheels(7.0, 0).carriage, still.carriage);
        assert_ne!(wheels(3.0, 0).tailstock, still.tailstock);
        assert_eq!(wheels(3.0, 0).panel, still.panel);
        assert_eq!(wheels(0.0, -100).panel, still.panel);
        // A quarter turn clockwise leads from the top to the right, seen from the operator.
        let grip = |wheels: HandWheels| wheels.panel.unwrap().transform_vector3(Vec3::Y);
        assert!(grip(still).distance(Vec3::Y) < 1e-4);
        assert!(grip(wheels(0.0, 25)).distance(Vec3::X) < 1e-4);
        assert!(grip(wheels(0.0, -25)).distance(Vec3::NEG_X) < 1e-4);
    }
}
