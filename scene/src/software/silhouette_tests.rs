//! The silhouette of the drawn part equals the half section at many moments of a cut.

use core::f32::consts::TAU;

use glam::{Mat4, vec3};
use gsk_units::Point;
use gsk_workpiece::grid::from_grid;
use gsk_workpiece::motion::{MotionKind, ToolMotion};
use gsk_workpiece::scene::{LatheScene, SceneTool};
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::{Tool, ToolShape};

use super::part;
use super::visibility::VisibilityBuffer;
use crate::part::outline::PartOutline;

const MOMENTS: u32 = 200;
const SIZE: [usize; 2] = [420, 240];
const PIXELS_PER_MM: f64 = 3.0;
/// Coordinate x at the left side of the picture, mm.
const LEFT_MM: f64 = -110.0;

/// A number from 0 to 1 that depends on its arguments only.
fn scatter(moment: u32, salt: u32) -> f64 {
    let mixed = moment
        .wrapping_mul(0x9E37_79B9)
        .wrapping_add(salt.wrapping_mul(0x85EB_CA6B));
    let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2C1B_3C6D);
    f64::from((mixed ^ (mixed >> 13)) & 0xFFFF) / 65535.0
}

/// Returns the greatest radius of the polygons at x; 0 without material.
fn radius_at(polygons: &[Vec<[f64; 2]>], x: f64) -> f64 {
    let edges = polygons.iter().flat_map(|points| {
        let next = points.iter().cycle().skip(1);
        points.iter().zip(next)
    });
    let crossings = edges.filter_map(|(&[ax, ar], &[bx, br])| {
        let is_crossed = (ax <= x) != (bx <= x);
        is_crossed.then(|| ar + (br - ar) * (x - ax) / (bx - ax))
    });
    crossings.fold(0.0, f64::max)
}

/// Returns the greatest drawn radius of each column, in pixels: above and below the axis.
fn drawn_radii(outline: &PartOutline) -> Vec<(f64, f64)> {
    let [columns, rows] = SIZE;
    let across = PIXELS_PER_MM as f32 * 2.0 / columns as f32;
    let up = PIXELS_PER_MM as f32 * 2.0 / rows as f32;
    let projection = Mat4::from_scale(vec3(across, up, -0.001))
        .mul_mat4(&Mat4::from_translation(vec3(-LEFT_MM as f32, 0.0, 0.0)));
    let projection = Mat4::from_translation(vec3(-1.0, 0.0, 0.0)) * projection;
    let mut buffer = VisibilityBuffer::new(SIZE);
    for triangle in part::triangles(outline, 192, [0.0, TAU], Mat4::from_rotation_x(0.3)) {
        buffer.add(&projection, triangle, false);
    }
    let middle = rows as f64 * 0.5;
    let column_radii = (0..columns).map(|column| {
        let is_seen = |row: &usize| buffer.surface(row * columns + column).is_some();
        let first = (0..rows).find(is_seen);
        let last = (0..rows).rfind(is_seen);
        let above = first.map_or(0.0, |row| middle - row as f64);
        let below = last.map_or(0.0, |row| row as f64 + 1.0 - middle);
        (above, below)
    });
    column_radii.collect()
}

#[test]
fn the_drawn_part_equals_the_half_section_at_200_moments() {
    let stock = Stock::bar(60.0, 0.0, 100.0);
    let mut scene = LatheScene::new(&stock);
    let tool = SceneTool::new(ToolShape::from_tool(&Tool::turning()));
    let mut removed = 0.0;
    for moment in 0..MOMENTS {
        let radius = 29.8 - f64::from(moment) * 0.1 - scatter(moment, 1) * 3.0;
        let start = 5.0 - scatter(moment, 2) * 60.0;
        let end = start - 2.0 - scatter(moment, 3) * 25.0;
        let taper = scatter(moment, 4) * 4.0;
        let motion = ToolMotion {
            from: Point::new(radius, start),
            to: Point::new(radius + taper, end),
            kind: MotionKind::Line,
            turning: true,
            by_hand: false,
        };
        removed += scene.move_tool(&tool, &motion).removed.area;
        let section = scene.part().section();
        let polygons: Vec<Vec<[f64; 2]>> = section
            .contours()
            .iter()
            .map(|contour| {
                let points = contour.iter().map(|point| from_grid(*point));
                points.map(|it| [it.z, it.x]).collect()
            })
            .collect();
        let single =
            |points: &Vec<[f64; 2]>| points.iter().map(|it| it.map(|it| it as f32)).collect();
        let outlines: Vec<Vec<[f32; 2]>> = polygons.iter().map(single).collect();
        let outline = PartOutline::from_polygons(&outlines, 30.0);
        for (column, (above, below)) in drawn_radii(&outline).into_iter().enumerate() {
            let x = LEFT_MM + (column as f64 + 0.5) / PIXELS_PER_MM;
            // Within a pixel along the axis, too: a shoulder is vertical.
            let near = (-4..=4).map(|part| x + f64::from(part) * 0.25 / PIXELS_PER_MM);
            let radii = near.map(|x| radius_at(&polygons, x) * PIXELS_PER_MM);
            let (low, high) = radii.fold((f64::MAX, 0.0_f64), |(low, high), it| {
                (low.min(it), high.max(it))
            });
            for drawn in [above, below] {
                assert!(
                    drawn >= low - 1.0 && drawn <= high + 1.0,
                    "moment {moment}, x {x}: drawn {drawn}, section {low} to {high}"
                );
            }
        }
    }
    assert!(removed > 500.0, "{removed}");
}
