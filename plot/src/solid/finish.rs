//! Computes how surfaces look: colour, and the reflection of turned steel.
//!
//! The lights move with the viewer: a strong one from above on the left, a weak one from below
//! on the right, and the ambient light of a workshop, bright from above and dark from below.

use glam::{Mat3, Vec3, vec3};

use super::vertex::Vertex;

/// Directions of the strong (`KEY`) and the weak (`FILL`) light: right, up, near; and the
/// half-way direction between each and the viewer.
const KEY_LIGHT: Vec3 = vec3(-0.359_336, 0.499_078, 0.788_543);
const KEY_HALFWAY: Vec3 = vec3(-0.189_992, 0.263_878, 0.945_659);
const FILL_LIGHT: Vec3 = vec3(0.413_597, -0.709_024, 0.571_158);
const FILL_HALFWAY: Vec3 = vec3(0.233_320, -0.399_978, 0.886_329);

/// The appearance of a surface: colour, gloss and hatching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceFinish {
    /// Red, green, blue; 255 reflects all light. Section faces are brighter than that, so that
    /// they are easy to see.
    color: Vec3,
    /// Glossiness of the surface, from 0 (matt) to 1.
    glossiness: f32,
    /// Whether the surface is hatched as a section.
    pub(super) hatched: bool,
}

impl SurfaceFinish {
    /// Finish of freshly cut metal.
    pub(super) const CUT: Self = Self::with_color([196.0, 202.0, 210.0], 1.0);
    /// Finish of uncut stock.
    pub(super) const SKIN: Self = Self::with_color([136.0, 122.0, 112.0], 0.3);
    /// Finish of a face of the cut-out quarter.
    pub(super) const SECTION: Self = Self {
        hatched: true,
        ..Self::with_color([280.0, 211.0, 142.0], 0.0)
    };
    /// Finish of the chuck body.
    pub(super) const CHUCK: Self = Self::with_color([104.0, 113.0, 126.0], 0.5);
    pub(super) const JAWS: Self = Self::with_color([128.0, 140.0, 158.0], 0.4);
    pub(super) const CHUCK_SECTION: Self = Self::with_color([92.0, 98.0, 108.0], 0.0);
    /// Finish of the tailstock's centre and quill.
    pub(super) const TAILSTOCK: Self = Self::with_color([140.0, 146.0, 156.0], 0.9);
    /// Finish of the insert of a tool.
    pub(super) const INSERT: Self = Self::with_color([340.0, 276.0, 84.0], 0.5);
    pub(super) const HOLDER: Self = Self::with_color([124.0, 132.0, 144.0], 0.4);
    pub(super) const TURRET: Self = Self::with_color([86.0, 93.0, 104.0], 0.3);

    const fn with_color([red, green, blue]: [f32; 3], glossiness: f32) -> Self {
        Self {
            color: vec3(red, green, blue),
            glossiness,
            hatched: false,
        }
    }

    /// The colour of a corner in the light: red, green, blue, 0 to 255 and above. `seen` maps
    /// the body's directions to right, up and near.
    ///
    /// Turning marks scatter light across themselves. A highlight appears where they are at
    /// right angles to the half-way direction: along a cylinder, and in two rays on a face.
    pub(super) fn lit_color(&self, vertex: &Vertex, seen: &Mat3) -> Vec3 {
        let normal = *seen * vertex.normal;
        let key = normal.dot(KEY_LIGHT).max(0.0);
        let fill = normal.dot(FILL_LIGHT).max(0.0);
        // The share of ambient light that the surface reflects.
        let mirrored = 2.0 * normal.z.max(0.0) * normal.y;
        let sky = ((mirrored + 0.35) / 1.1).clamp(0.0, 1.0);
        let sky = sky * sky * (3.0 - 2.0 * sky);
        let steady = 0.3 + 0.08 * normal.y + 0.56 * key + 0.24 * fill;
        let light = steady * (1.0 - 0.25 * self.glossiness) + 0.3 * self.glossiness * sky;
        let shining = if vertex.marks == Vec3::ZERO {
            0.6 * square_repeatedly(normal.dot(KEY_HALFWAY).max(0.0), 5)
        } else {
            let marks = *seen * vertex.marks;
            let across = |half: Vec3| {
                let along = marks.dot(half);
                (1.0 - along * along).max(0.0)
            };
            let (strong, weak) = (across(KEY_HALFWAY), across(FILL_HALFWAY));
            (0.3 * square_repeatedly(strong, 3) + 0.6 * square_repeatedly(strong, 6))
                * (2.0 * key).min(1.0)
                + 0.4 * square_repeatedly(weak, 5) * (2.0 * fill).min(1.0)
        };
        // A bore gets less ambient light than the outside.
        let outward = vertex.position.y * vertex.normal.y + vertex.position.z * vertex.normal.z;
        let inside = if vertex.marks != Vec3::ZERO && outward < 0.0 {
            0.72
        } else {
            1.0
        };
        (self.color * light + Vec3::splat(255.0 * self.glossiness * 0.62 * shining)) * inside
    }
}

/// Raises a number to the power of 2, 4, 8 …: squares it `squarings` times.
fn square_repeatedly(base: f32, squarings: u8) -> f32 {
    (0..squarings).fold(base, |value, _| value * value)
}

/// The hatching of a section: parallel lines at 45°.
#[derive(Clone, Copy, Debug)]
pub(super) struct SectionHatch {
    /// Number of hatch lines per millimetre, along Z and along X.
    lines_per_mm: f32,
}

impl SectionHatch {
    /// Least distance between two hatch lines along Z, pixels.
    const MIN_LINE_DISTANCE_PX: f32 = 13.0;

    /// Creates the hatching for a scale in pixels per millimetre. The distance of its lines
    /// changes in steps of 2, so it remains the same while the view only turns.
    pub(super) fn new(scale: f32) -> Self {
        let mut step = 65_536.0;
        while step > 1e-4 && step / 2.0 * scale >= Self::MIN_LINE_DISTANCE_PX {
            step /= 2.0;
        }
        Self {
            lines_per_mm: 1.0 / step,
        }
    }

    /// The coordinate of a position across the hatch lines, in distances of two lines; whole
    /// numbers are in the middle of a line.
    pub(super) fn line_coordinate(self, at: Vec3) -> f32 {
        (at.x - at.y - at.z) * self.lines_per_mm
    }

    /// The share of light, up to 1, at a position with hatch coordinate `line`; less on a
    /// line. `step` is the increase of the coordinate per pixel, `width` the width of a line
    /// in pixels.
    pub(super) fn light_share(line: f32, step: f32, width: f32) -> f32 {
        let off = (line - line.floor() - 0.5).abs();
        let beside = (0.5 - off) / step.max(1e-6);
        let covered = (width / 2.0 + 0.5 - beside).clamp(0.0, 1.0);
        1.0 - 0.3 * covered
    }
}
