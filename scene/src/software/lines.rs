//! Lines over a picture: the programmed path and the marks of collisions.

use glam::{Mat4, Vec3, Vec4, vec3};

use super::visibility::VisibilityBuffer;
use crate::description::LatheDescription;
use crate::frame::FrameInputs;
use crate::mesh::marks::{MARK_COLOR, mark_rings};

/// Depth by which lines are drawn before the surfaces in which they lie, 0 to 1.
const DEPTH_SHIFT: f32 = 0.0006;
/// Greatest number of pixels that are drawn along a line.
const MAX_STEPS: f32 = 8192.0;

/// Draws the programmed path and the collision marks. Marks are before everything: a bent bar would
/// hide them.
pub fn draw_lines(
    lathe: &LatheDescription,
    scene: &FrameInputs,
    buffer: &VisibilityBuffer,
    size: [usize; 2],
    colors: &mut [Vec3],
) {
    if let Some(path) = &lathe.overlay.path {
        let projection = scene.projection * scene.tool_side;
        for piece in path.pieces() {
            let ends = piece.ends.map(|[x, out]| vec3(x, 0.0, out));
            let color = Vec3::from_array(piece.color.map(share));
            draw_line(&projection, ends, size, |at, depth| {
                if depth - DEPTH_SHIFT < buffer.depths()[at] {
                    colors[at] = color;
                }
            });
        }
    }
    let [red, green, blue, _] = MARK_COLOR.map(share);
    for ring in mark_rings(&lathe.effects.marks) {
        let next = ring.iter().cycle().skip(1);
        for (from, to) in ring.iter().zip(next) {
            draw_line(&scene.projection, [*from, *to], size, |at, _| {
                colors[at] = vec3(red, green, blue);
            });
        }
    }
}

fn share(byte: u8) -> f32 {
    f32::from(byte) / 255.0
}

/// Calls `visit` with index and depth of each pixel of a line.
fn draw_line(
    projection: &Mat4,
    ends: [Vec3; 2],
    [columns, rows]: [usize; 2],
    mut visit: impl FnMut(usize, f32),
) {
    let [mut from, mut to] = ends.map(|it| *projection * it.extend(1.0));
    let inside = |at: Vec4| at.z + at.w;
    let (near, far) = (inside(from), inside(to));
    if near <= 0.0 && far <= 0.0 {
        return;
    }
    let crossing = from.lerp(to, near / (near - far));
    if near <= 0.0 {
        from = crossing;
    } else if far <= 0.0 {
        to = crossing;
    }
    let (width, height) = (columns as f32, rows as f32);
    let [from, to] = [from, to].map(|at| {
        let at = at.truncate() / at.w.max(1e-6);
        vec3(
            (at.x * 0.5 + 0.5) * width,
            (0.5 - at.y * 0.5) * height,
            at.z,
        )
    });
    let along = to - from;
    let steps = along.truncate().abs().max_element().ceil();
    if !steps.is_finite() {
        return;
    }
    let steps = steps.clamp(1.0, MAX_STEPS);
    for step in 0..=steps as u32 {
        let at = from + along * (step as f32 / steps);
        if at.x >= 0.0 && at.y >= 0.0 && at.x < width && at.y < height {
            visit(at.y as usize * columns + at.x as usize, at.z);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_a_row_of_pixels_and_ends_at_the_near_plane() {
        let pixels = |ends: [Vec3; 2]| {
            let mut pixels = Vec::new();
            draw_line(&Mat4::IDENTITY, ends, [20, 10], |at, _| pixels.push(at));
            pixels.dedup();
            pixels
        };
        let row = pixels([vec3(-0.95, -0.05, 0.0), vec3(0.95, -0.05, 0.0)]);
        assert_eq!(row, (100..120).collect::<Vec<usize>>());
        let half = pixels([vec3(-0.95, -0.05, 0.0), vec3(0.95, -0.05, -2.0)]);
        assert_eq!(half, (100..=110).collect::<Vec<usize>>());
        assert!(pixels([vec3(-0.9, 0.0, -2.0), vec3(0.9, 0.0, -3.0)]).is_empty());
        assert!(pixels([Vec3::NAN, vec3(0.9, 0.0, 0.0)]).is_empty());
    }
}
