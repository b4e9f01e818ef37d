//! Draws stock, chuck, tailstock and tool as a half section: cut open on the side of the tool,
//! seen from outside on the other side.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, Vec2, pos2};
use gsk_host::kernel::part::PartView;
use gsk_workpiece::convex::convex_hull;
use gsk_workpiece::grid::{GridContour, from_grid};
use gsk_workpiece::job::Job;
use gsk_workpiece::region::Region;
use gsk_workpiece::tool::{BodyPart, Tool, ToolShape};
use gsk_workpiece::trapezoid::{SectionFill, Trapezoid, trapezoids};

use super::animation::SpindleAnimation;
use super::camera::Camera;
use crate::theme;

/// Distance of the lines of a hatching along X and Y of the screen, points.
const HATCHING_DISTANCE: f32 = 12.0;

/// Index of the jaws in the list of clamping areas.
const JAWS_INDEX: usize = 1;

/// Draws half sections; keeps their trapezoids until the sections change.
#[derive(Default)]
pub struct SectionDrawing {
    section: Arc<Region>,
    material: Vec<Trapezoid>,
    outside: Vec<Trapezoid>,
    drawn_job: Option<(Arc<Job>, bool)>,
    /// Sections of chuck, jaws and tailstock: trapezoids, section and colour.
    clamping: Vec<(Vec<Trapezoid>, Region, Color32)>,
    spindle: SpindleAnimation,
    /// The parts of those tools of the job that were already drawn, by T number.
    tools: BTreeMap<u8, Vec<ToolPart>>,
}

impl SectionDrawing {
    /// Draws stock, clamping and the turning spindle.
    pub fn draw(&mut self, painter: &Painter, camera: &Camera, part: &PartView) {
        self.update(part);
        for (filled, region, color) in &self.clamping {
            for mirrored in [true, false] {
                fill_trapezoids(painter, camera, filled, mirrored, *color);
                draw_outline(
                    painter,
                    camera,
                    region.contours(),
                    mirrored,
                    theme::CLAMPING_EDGE,
                );
            }
        }
        for mirrored in [true, false] {
            if let Some(steps) = self.jaw_steps() {
                let line = steps
                    .iter()
                    .map(|at| camera.screen_position(mirror_if(*at, mirrored)));
                let stroke = Stroke::new(1.0, theme::CLAMPING_EDGE);
                painter.add(Shape::line(line.collect(), stroke));
            }
        }
        self.spindle.draw(painter, camera, part);
        fill_trapezoids(painter, camera, &self.outside, true, theme::PART_OUTSIDE);
        draw_silhouette(painter, camera, &self.outside);
        fill_trapezoids(painter, camera, &self.material, false, theme::SECTION);
        hatch_trapezoids(painter, camera, &self.material);
        draw_outline(
            painter,
            camera,
            self.section.contours(),
            false,
            theme::PART_EDGE,
        );
    }

    /// Draws the tool of the job with its tip at `tip`. Returns `false` if the job does not
    /// describe the tool.
    pub fn draw_job_tool(
        &mut self,
        painter: &Painter,
        camera: &Camera,
        part: &PartView,
        tip: Pos2,
    ) -> bool {
        let Some(tool) = part.job.tools.get(&part.tool) else {
            return false;
        };
        self.update(part);
        let parts = self.tools.entry(part.tool);
        for part in parts.or_insert_with(|| make_tool_parts(tool)) {
            part.draw(painter, camera, tip);
        }
        true
    }

    /// The edges of the two outer steps of the jaws, part coordinates.
    fn jaw_steps(&self) -> Option<[Pos2; 5]> {
        let (_, jaws, _) = self.clamping.get(JAWS_INDEX)?;
        let bounds = jaws.bounds()?;
        let [low, high] = [bounds.low, bounds.high].map(from_grid);
        let at = |length: f64, height: f64| {
            let z = high.z - length * (high.z - low.z);
            let x = low.x + height * (high.x - low.x);
            pos2(z as f32, x as f32)
        };
        Some([
            at(0.0, 0.4),
            at(0.35, 0.4),
            at(0.35, 0.7),
            at(0.7, 0.7),
            at(0.7, 1.0),
        ])
    }

    fn update(&mut self, part: &PartView) {
        if !Arc::ptr_eq(&self.section, &part.section) {
            self.section = Arc::clone(&part.section);
            self.material = trapezoids(&self.section, SectionFill::Material);
            self.outside = trapezoids(&self.section, SectionFill::Outside);
        }
        let same = self.drawn_job.as_ref();
        if same.is_some_and(|(job, open)| Arc::ptr_eq(job, &part.job) && *open == part.chuck_open) {
            return;
        }
        self.drawn_job = Some((Arc::clone(&part.job), part.chuck_open));
        self.tools.clear();
        let stock = &part.job.stock;
        let (body, jaws) = stock.chuck_section();
        let jaws = if part.chuck_open {
            stock.open_jaws()
        } else {
            jaws
        };
        self.clamping = [
            (body, theme::CHUCK),
            (jaws, theme::CHUCK_JAWS),
            (stock.tailstock_section(), theme::CHUCK),
        ]
        .map(|(region, color)| (trapezoids(&region, SectionFill::Material), region, color))
        .into();
    }
}

/// The holder or the insert of a tool, relative to the tool's tip.
struct ToolPart {
    filled: Vec<Trapezoid>,
    edge: Vec<Pos2>,
    color: Color32,
    edge_color: Color32,
}

impl ToolPart {
    /// Draws this part of a tool with the tool's tip at `tip`.
    fn draw(&self, painter: &Painter, camera: &Camera, tip: Pos2) {
        let shift = |(z, low, high): (f32, f32, f32)| (z + tip.x, low + tip.y, high + tip.y);
        let moved = self.filled.iter().map(|it| Trapezoid {
            sides: it.sides.map(shift),
        });
        let moved: Vec<Trapezoid> = moved.collect();
        fill_trapezoids(painter, camera, &moved, false, self.color);
        let edge = self.edge.iter();
        let edge = edge.map(|at| camera.screen_position(*at + tip.to_vec2()));
        let stroke = Stroke::new(1.0, self.edge_color);
        painter.add(Shape::closed_line(edge.collect(), stroke));
    }

    fn new(contour: &GridContour, color: Color32, edge_color: Color32) -> Self {
        let region = Region::from_contours(std::slice::from_ref(contour));
        Self {
            filled: trapezoids(&region, SectionFill::Material),
            edge: contour_points(contour, false).collect(),
            color,
            edge_color,
        }
    }
}

/// Draws a tool with its tip at the origin of the part coordinates.
pub fn draw_tool(painter: &Painter, camera: &Camera, tool: &Tool) {
    for part in make_tool_parts(tool) {
        part.draw(painter, camera, Pos2::ZERO);
    }
}

/// The box around inserts and holders of a job, without the turret, with their tips at the origin, part coordinates.
pub fn tool_bounds(job: &Job) -> Rect {
    let shapes = job.tools.values().map(ToolShape::from_tool);
    let points = shapes.flat_map(|shape| {
        let body = shape.body.iter();
        let body = body.filter(|(part, _)| *part != BodyPart::Turret);
        let body = body.map(|(_, contour)| contour);
        let contours = body.chain([&shape.cutting]);
        contours
            .flat_map(|contour| contour_points(contour, false))
            .collect::<Vec<_>>()
    });
    let mut bounds = Rect::from_min_max(Pos2::ZERO, Pos2::ZERO);
    points.for_each(|at| bounds.extend_with(at));
    bounds
}

/// Creates the drawn areas of a tool's holder and insert.
fn make_tool_parts(tool: &Tool) -> Vec<ToolPart> {
    let shape = ToolShape::from_tool(tool);
    let body = shape.body.iter();
    let body = body
        .filter(|(part, _)| *part != BodyPart::InsertBack)
        .map(|(_, contour)| ToolPart::new(contour, theme::TOOL_HOLDER, theme::TOOL_HOLDER_EDGE));
    let insert = ToolPart::new(&insert_contour(&shape), theme::INSERT, theme::INSERT_EDGE);
    body.chain([insert]).collect()
}

/// The whole insert, which is convex: its cutting part and its back.
pub fn insert_contour(shape: &ToolShape) -> GridContour {
    let body = shape.body.iter();
    let back = body.filter(|(part, _)| *part == BodyPart::InsertBack);
    let back = back.flat_map(|(_, contour)| contour.iter());
    convex_hull(shape.cutting.iter().chain(back).copied())
}

/// Fills trapezoids of a section or, if `mirrored`, their mirror image below the axis.
pub(super) fn fill_trapezoids(
    painter: &Painter,
    camera: &Camera,
    filled: &[Trapezoid],
    mirrored: bool,
    color: Color32,
) {
    let mut mesh = Mesh::default();
    if color == theme::INSERT {
        // A light theme does not recolour meshes with this texture: the insert stays yellow.
        mesh.texture_id = theme::white_texture(painter.ctx());
    }
    mesh.reserve_vertices(filled.len() * 4);
    mesh.reserve_triangles(filled.len() * 2);
    for trapezoid in filled {
        let first = mesh.vertices.len() as u32;
        for (z, x) in trapezoid.corners() {
            mesh.vertices.push(Vertex {
                pos: camera.screen_position(mirror_if(pos2(z, x), mirrored)),
                uv: WHITE_UV,
                color,
            });
        }
        mesh.add_triangle(first, first + 1, first + 2);
        mesh.add_triangle(first + 1, first + 2, first + 3);
    }
    painter.add(mesh);
}

/// Draws the hatching of a cut face: lines at 45 degrees, as in a drawing.
pub(super) fn hatch_trapezoids(painter: &Painter, camera: &Camera, filled: &[Trapezoid]) {
    let stroke = Stroke::new(1.0, theme::HATCHING);
    // The line that each number of a line has in the last trapezoids.
    let mut lines: BTreeMap<i32, [Pos2; 2]> = BTreeMap::new();
    for trapezoid in filled {
        let corners = trapezoid
            .corners()
            .map(|(z, x)| camera.screen_position(pos2(z, x)));
        let sums = corners.map(|at| (at.x + at.y) / HATCHING_DISTANCE);
        let first = sums.into_iter().fold(f32::INFINITY, f32::min).ceil() as i32;
        let last = sums.into_iter().fold(f32::NEG_INFINITY, f32::max).floor() as i32;
        for number in first..=last {
            let Some(piece) = clip_hatching(corners, number as f32 * HATCHING_DISTANCE) else {
                continue;
            };
            match lines.get_mut(&number) {
                Some(line) if (line[1].x - piece[0].x).abs() < 0.1 => line[1] = piece[1],
                _ => {
                    if let Some(line) = lines.insert(number, piece) {
                        painter.line_segment(line, stroke);
                    }
                }
            }
        }
    }
    for line in lines.into_values() {
        painter.line_segment(line, stroke);
    }
}

/// The part of the line x + y = `sum` inside a trapezoid with these corners, from left to
/// right; `None` if they do not meet. The corners are in the order of a triangle strip.
fn clip_hatching(corners: [Pos2; 4], sum: f32) -> Option<[Pos2; 2]> {
    let [left, left_other, right, right_other] = corners;
    let (mut begin, mut end) = (left.x.min(right.x), left.x.max(right.x));
    let mut clip = |value_left: f32, value_right: f32| {
        // The value is linear in x; the line is inside where it is not negative.
        let zero = left.x + (right.x - left.x) * value_left / (value_left - value_right);
        match (value_left >= 0.0, value_right >= 0.0) {
            (true, true) => {}
            (true, false) => end = end.min(zero),
            (false, true) => begin = begin.max(zero),
            (false, false) => end = f32::NEG_INFINITY,
        }
    };
    let (top_left, bottom_left) = (left.y.min(left_other.y), left.y.max(left_other.y));
    let (top_right, bottom_right) = (right.y.min(right_other.y), right.y.max(right_other.y));
    clip(sum - left.x - top_left, sum - right.x - top_right);
    clip(bottom_left - sum + left.x, bottom_right - sum + right.x);
    let at = |x: f32| pos2(x, sum - x);
    (begin < end).then(|| [at(begin), at(end)])
}

/// Draws the contours of a section or, if `mirrored`, their mirror image below the axis.
pub(super) fn draw_outline(
    painter: &Painter,
    camera: &Camera,
    contours: &[GridContour],
    mirrored: bool,
    color: Color32,
) {
    for contour in contours {
        let line = contour_points(contour, mirrored).map(|at| camera.screen_position(at));
        let stroke = Stroke::new(1.0, color);
        painter.add(Shape::closed_line(line.collect(), stroke));
    }
}

/// Draws the outline of the part on the half that is not cut open.
pub(super) fn draw_silhouette(painter: &Painter, camera: &Camera, outside: &[Trapezoid]) {
    let corner = |(z, _, high): (f32, f32, f32)| pos2(z, -high);
    let mut line: Vec<Pos2> = Vec::with_capacity(outside.len() * 2 + 2);
    for trapezoid in outside {
        if line.is_empty() {
            line.push(pos2(trapezoid.sides[0].0, 0.0));
        }
        line.extend(trapezoid.sides.map(corner));
    }
    if let Some(last) = line.last().copied() {
        line.push(pos2(last.x, 0.0));
    }
    let line = line
        .into_iter()
        .map(|at| camera.screen_position(at))
        .collect();
    painter.add(Shape::line(line, Stroke::new(1.0, theme::PART_EDGE)));
}

fn contour_points(contour: &GridContour, mirrored: bool) -> impl Iterator<Item = Pos2> + '_ {
    contour.iter().map(move |point| {
        let point = from_grid(*point);
        mirror_if(pos2(point.z as f32, point.x as f32), mirrored)
    })
}

fn mirror_if(at: Pos2, mirrored: bool) -> Pos2 {
    let x = if mirrored { -at.y } else { at.y };
    pos2(at.x, x)
}

/// Draws a cross at the tip of a tool that the job does not describe.
pub fn draw_tip_cross(painter: &Painter, camera: &Camera, tip: Pos2) {
    let (at, stroke) = (camera.screen_position(tip), Stroke::new(1.5, theme::INSERT));
    for arm in [Vec2::new(7.0, 0.0), Vec2::new(0.0, 7.0)] {
        painter.line_segment([at - arm, at + arm], stroke);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hatching_ends_at_the_edges_of_the_section() {
        let corners = [(10.0, 10.0), (10.0, 30.0), (50.0, 10.0), (50.0, 30.0)];
        let corners = corners.map(|(x, y)| pos2(x, y));
        let line = clip_hatching(corners, 40.0);
        assert_eq!(line, Some([pos2(10.0, 30.0), pos2(30.0, 10.0)]));
        assert_eq!(clip_hatching(corners, 15.0), None);
        assert_eq!(clip_hatching(corners, 90.0), None);
        let cone = [(0.0, 0.0), (0.0, 40.0), (40.0, 20.0), (40.0, 20.0)].map(|(x, y)| pos2(x, y));
        let [from, to] = clip_hatching(cone, 30.0).unwrap();
        assert!((to.y - to.x * 0.5).abs() < 0.01, "{to:?}");
        assert!(
            (from.y - (40.0 - from.x * 0.5)).abs() < 0.01 || from.x == 0.0,
            "{from:?}"
        );
    }
}
