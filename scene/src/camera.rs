//! The camera around the lathe: orbit, pan, zoom and presets.

use core::f32::consts::FRAC_PI_2;

use glam::{Mat4, Vec2, Vec3, vec3};

use crate::description::{LatheDescription, LatheKind};
use crate::placement;

/// Vertical field of view, radians.
const FIELD_OF_VIEW: f32 = 0.56;
/// Angle by which the camera turns when the pointer is dragged by one point, radians.
const TURN_PER_POINT: f32 = 0.006;
/// Least and greatest angle of the camera above the horizontal, radians.
const PITCH_LIMITS: (f32, f32) = (-0.12, FRAC_PI_2);
/// Least and greatest distance of the camera from its target, mm.
const DISTANCE_LIMITS: (f32, f32) = (60.0, 20_000.0);

/// A camera that turns about a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrbitCamera {
    /// The position at which the camera points, mm.
    pub target: Vec3,
    /// Turn to the right about the vertical, radians; 0 looks from the operator's side.
    pub yaw: f32,
    /// Angle of the camera above the horizontal, radians.
    pub pitch: f32,
    /// Distance of the camera from its target, mm.
    pub distance: f32,
    /// Whether the projection is parallel, as in a drawing.
    pub is_parallel: bool,
}

/// A camera position that the operator can choose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CameraPreset {
    /// The camera shows the work area as the operator sees it.
    #[default]
    Operator,
    /// The camera follows the tool tip.
    Tool,
    /// The camera shows the chuck with the part, seen from the tailstock.
    Chuck,
    /// The camera shows the work area from above.
    Top,
    /// The camera faces the plane of the half section, in parallel projection.
    Section,
}

impl CameraPreset {
    /// All presets, in the order of their buttons.
    pub const ALL: [Self; 5] = [
        Self::Operator,
        Self::Tool,
        Self::Chuck,
        Self::Top,
        Self::Section,
    ];

    /// Whether the camera follows the tool.
    pub const fn follows_tool(self) -> bool {
        matches!(self, Self::Tool)
    }

    /// Creates the camera of the preset for a lathe.
    pub fn camera(self, lathe: &LatheDescription) -> OrbitCamera {
        let dimensions = lathe.dimensions.sanitized();
        let chuck = dimensions.chuck_diameter;
        let (_, end, radius) = placement::part_bounds(lathe);
        // What is turned, with half of the chuck and some space for the tool.
        let length = (end + dimensions.chuck_length * 0.5 + 60.0).max(chuck);
        let middle = vec3(end * 0.5 - dimensions.chuck_length * 0.25 + 25.0, 0.0, 0.0);
        let is_slant = lathe.kind == LatheKind::SlantBed;
        let camera = match self {
            Self::Operator => OrbitCamera {
                target: middle + Vec3::Y * if is_slant { 0.0 } else { -0.10 * chuck },
                yaw: 0.42,
                pitch: if is_slant { 0.24 } else { 0.40 },
                distance: 1.75 * length + 1.35 * chuck,
                is_parallel: false,
            },
            Self::Tool => OrbitCamera {
                target: placement::tip(lathe),
                yaw: if is_slant { 0.30 } else { 0.55 },
                pitch: if is_slant { 0.30 } else { 0.62 },
                distance: 260.0 + radius * 1.5,
                is_parallel: false,
            },
            Self::Chuck => OrbitCamera {
                target: vec3(dimensions.jaw_length, 0.0, 0.0),
                yaw: 1.02,
                pitch: 0.26,
                distance: end + 2.6 * chuck,
                is_parallel: false,
            },
            Self::Top => OrbitCamera {
                target: middle,
                yaw: 0.0,
                pitch: PITCH_LIMITS.1 - 0.02,
                distance: 1.6 * length + 1.3 * chuck,
                is_parallel: false,
            },
            Self::Section => OrbitCamera {
                target: middle,
                yaw: 0.0,
                // Perpendicular to the plane in which the tool moves.
                pitch: if is_slant { FRAC_PI_2 * 0.5 } else { FRAC_PI_2 },
                distance: 1.3 * length + 1.1 * chuck,
                is_parallel: true,
            },
        };
        camera.limited()
    }
}

impl OrbitCamera {
    /// Returns the camera with all values finite and in their limits.
    #[must_use]
    fn limited(self) -> Self {
        let finite = |value: f32, usual: f32| if value.is_finite() { value } else { usual };
        let target = if self.target.is_finite() {
            self.target
        } else {
            Vec3::ZERO
        };
        Self {
            target: target.clamp(Vec3::splat(-20_000.0), Vec3::splat(20_000.0)),
            yaw: finite(self.yaw, 0.4) % core::f32::consts::TAU,
            pitch: finite(self.pitch, 0.3).clamp(PITCH_LIMITS.0, PITCH_LIMITS.1),
            distance: finite(self.distance, 900.0).clamp(DISTANCE_LIMITS.0, DISTANCE_LIMITS.1),
            is_parallel: self.is_parallel,
        }
    }

    /// Returns the unit vectors of the picture: right, up, and from the target to the camera.
    fn axes(&self) -> [Vec3; 3] {
        let (yaw_sine, yaw_cosine) = self.yaw.sin_cos();
        let (pitch_sine, pitch_cosine) = self.pitch.sin_cos();
        let back = vec3(
            yaw_sine * pitch_cosine,
            pitch_sine,
            yaw_cosine * pitch_cosine,
        );
        let right = vec3(yaw_cosine, 0.0, -yaw_sine);
        [right, back.cross(right), back]
    }

    /// Returns the position of the camera, mm.
    pub fn eye(&self) -> Vec3 {
        self.target + self.axes()[2] * self.distance
    }

    /// Turns the camera about its target. `by` is the drag of the pointer, points of the window.
    pub fn orbit(&mut self, by: Vec2) {
        self.yaw -= by.x * TURN_PER_POINT;
        self.pitch += by.y * TURN_PER_POINT;
        *self = self.limited();
    }

    /// Moves the target so that the picture follows the pointer. `by` is the drag and `height` that
    /// of the window, points.
    pub fn pan(&mut self, by: Vec2, height: f32) {
        let mm_per_point = self.mm_per_point(height);
        let [right, up, _] = self.axes();
        self.target += (up * by.y - right * by.x) * mm_per_point;
        *self = self.limited();
    }

    /// Divides the distance from the target by `factor`. The position shown at `offset` from the
    /// middle of the window stays there; `offset` and `height` of the window are in points.
    pub fn zoom(&mut self, factor: f32, offset: Vec2, height: f32) {
        let before = self.mm_per_point(height);
        let distance = self.distance;
        self.distance /= if factor.is_finite() && factor > 0.0 {
            factor
        } else {
            1.0
        };
        *self = self.limited();
        let shift = before * (1.0 - self.distance / distance);
        let [right, up, _] = self.axes();
        self.target += (right * offset.x - up * offset.y) * shift;
        *self = self.limited();
    }

    fn mm_per_point(&self, height: f32) -> f32 {
        2.0 * self.distance * (FIELD_OF_VIEW * 0.5).tan() / height.max(1.0)
    }

    /// Returns the matrix that projects scene positions to clip coordinates. `aspect` is the width
    /// of the picture divided by its height.
    pub fn projection(&self, aspect: f32) -> Mat4 {
        let camera = self.limited();
        let aspect = if aspect.is_finite() {
            aspect.clamp(0.05, 20.0)
        } else {
            1.0
        };
        // A narrow picture keeps its width in view.
        let half = (FIELD_OF_VIEW * 0.5).tan() * (1.25 / aspect).max(1.0);
        let near = (camera.distance * 0.06).max(5.0);
        let far = camera.distance * 3.0 + 6000.0;
        let [right, up, back] = camera.axes();
        let eye = camera.eye();
        let view = Mat4::from_cols(
            vec3(right.x, up.x, back.x).extend(0.0),
            vec3(right.y, up.y, back.y).extend(0.0),
            vec3(right.z, up.z, back.z).extend(0.0),
            vec3(-right.dot(eye), -up.dot(eye), -back.dot(eye)).extend(1.0),
        );
        match camera.is_parallel {
            true => parallel(half * camera.distance, aspect, far) * view,
            false => perspective(half, aspect, near, far) * view,
        }
    }
}

/// Returns the perspective matrix of OpenGL. `half` is half the visible height at distance 1.
fn perspective(half: f32, aspect: f32, near: f32, far: f32) -> Mat4 {
    let depth = near - far;
    Mat4::from_cols_array(&[
        1.0 / (half * aspect),
        0.0,
        0.0,
        0.0,
        0.0,
        1.0 / half,
        0.0,
        0.0,
        0.0,
        0.0,
        (near + far) / depth,
        -1.0,
        0.0,
        0.0,
        2.0 * near * far / depth,
        0.0,
    ])
}

/// Returns the matrix of a parallel projection. `half` is half the visible height, mm. Depths start
/// far before the camera, so that a close camera cuts nothing off.
fn parallel(half: f32, aspect: f32, far: f32) -> Mat4 {
    Mat4::from_cols_array(&[
        1.0 / (half * aspect),
        0.0,
        0.0,
        0.0,
        0.0,
        1.0 / half,
        0.0,
        0.0,
        0.0,
        0.0,
        -1.0 / far,
        0.0,
        0.0,
        0.0,
        0.0,
        1.0,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::{LatheDimensions, TipPosition};
    use crate::part::outline::PartOutline;
    use std::sync::Arc;

    fn lathe(kind: LatheKind) -> LatheDescription {
        let bar = vec![[-20.0, 0.0], [160.0, 0.0], [160.0, 30.0], [-20.0, 30.0]];
        LatheDescription {
            kind,
            part: Arc::new(PartOutline::from_polygons(&[bar], 30.0)),
            tip: TipPosition {
                x: 120.0,
                radius: 31.0,
            },
            ..LatheDescription::default()
        }
    }

    #[test]
    fn presets_see_the_part_and_the_tool() {
        for kind in [LatheKind::FlatBed, LatheKind::SlantBed, LatheKind::Bench] {
            let lathe = lathe(kind);
            for preset in CameraPreset::ALL {
                for aspect in [0.6, 1.78] {
                    let projection = preset.camera(&lathe).projection(aspect);
                    let seen = match preset {
                        CameraPreset::Tool => vec![placement::tip(&lathe)],
                        _ => vec![vec3(40.0, 0.0, 0.0), vec3(160.0, 0.0, 0.0)],
                    };
                    for at in seen {
                        let at_picture = projection.project_point3(at);
                        let within = at_picture.abs().max_element() < 0.95;
                        assert!(within, "{kind:?} {preset:?} {aspect} {at}: {at_picture}");
                    }
                }
            }
        }
    }

    #[test]
    fn zoom_keeps_the_position_at_the_pointer() {
        let mut camera = CameraPreset::Operator.camera(&lathe(LatheKind::FlatBed));
        let height = 600.0;
        let offset = glam::vec2(120.0, -80.0);
        let at_pointer = |camera: &OrbitCamera| {
            let [right, up, _] = camera.axes();
            camera.target + (right * offset.x - up * offset.y) * camera.mm_per_point(height)
        };
        let before = at_pointer(&camera);
        camera.zoom(2.5, offset, height);
        assert!(at_pointer(&camera).distance(before) < 0.1);
    }

    #[test]
    fn a_pan_moves_the_picture_with_the_pointer() {
        let mut camera = CameraPreset::Operator.camera(&lathe(LatheKind::FlatBed));
        let (height, aspect) = (600.0, 1.5);
        let at = camera.target;
        let before = camera.projection(aspect).project_point3(at);
        camera.pan(glam::vec2(30.0, -60.0), height);
        let moved = camera.projection(aspect).project_point3(at) - before;
        let points = glam::vec2(moved.x * height * aspect, -moved.y * height) / 2.0;
        assert!(points.distance(glam::vec2(30.0, -60.0)) < 1.0, "{points}");
    }

    #[test]
    fn degenerate_input_gives_finite_matrices() {
        let wrong = f32::NAN;
        let mut lathe = lathe(LatheKind::SlantBed);
        lathe.tip = TipPosition {
            x: wrong,
            radius: wrong,
        };
        lathe.dimensions = LatheDimensions {
            chuck_diameter: wrong,
            ..lathe.dimensions
        };
        for preset in CameraPreset::ALL {
            let mut camera = preset.camera(&lathe);
            camera.orbit(Vec2::splat(wrong));
            camera.pan(Vec2::splat(f32::INFINITY), 0.0);
            camera.zoom(wrong, Vec2::splat(wrong), 0.0);
            camera.zoom(0.0, Vec2::ZERO, 600.0);
            assert!(camera.projection(wrong).is_finite());
        }
    }
}
