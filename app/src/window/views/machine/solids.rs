//! Stock, chuck, tailstock and tool, drawn as the half section they are: cut open on the
//! side of the tool, from outside on the other.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{Color32, Painter, Pos2, Shape, Stroke, Vec2, pos2};
use gsk_workpiece::grid::{GridContour, from_grid};
use gsk_workpiece::job::Job;
use gsk_workpiece::region::Region;
use gsk_workpiece::tool::{Tool, ToolShape};
use gsk_workpiece::trapezoid::{SectionFill, Trapezoid, trapezoids};

use super::alive::Turning;
use super::camera::Camera;
use crate::kernel::part::PartView;
use crate::window::surroundings::white;

const SECTION: Color32 = Color32::from_rgb(118, 116, 112);
const OUTSIDE: Color32 = Color32::from_rgb(74, 74, 76);
const EDGE: Color32 = Color32::from_rgb(196, 196, 192);
const CHUCK: Color32 = Color32::from_rgb(44, 50, 60);
const JAWS: Color32 = Color32::from_rgb(62, 72, 88);
const CLAMP_EDGE: Color32 = Color32::from_rgb(104, 116, 136);
const INSERT: Color32 = Color32::from_rgb(240, 200, 60);
const HOLDER: Color32 = Color32::from_rgb(98, 104, 112);
const HOLDER_EDGE: Color32 = Color32::from_rgb(150, 156, 164);

/// Sections as they were cut into trapezoids.
#[derive(Default)]
pub struct Solids {
    section: Arc<Region>,
    material: Vec<Trapezoid>,
    outside: Vec<Trapezoid>,
    job: Option<(Arc<Job>, bool)>,
    /// Chuck, jaws and tailstock.
    clamps: Vec<(Vec<Trapezoid>, Region, Color32)>,
    turning: Turning,
    /// The tools of the job that were drawn, by their T number.
    tools: BTreeMap<u8, Vec<ToolPart>>,
}

impl Solids {
    /// Draws what is clamped and what clamps it, the spindle as it turns.
    pub fn draw(&mut self, painter: &Painter, camera: &Camera, part: &PartView) {
        self.take(part);
        for (filled, region, color) in &self.clamps {
            for mirrored in [true, false] {
                fill(painter, camera, filled, mirrored, *color);
                outline(painter, camera, region.contours(), mirrored, CLAMP_EDGE);
            }
        }
        self.turning.draw(painter, camera, part);
        fill(painter, camera, &self.outside, true, OUTSIDE);
        silhouette(painter, camera, &self.outside);
        fill(painter, camera, &self.material, false, SECTION);
        outline(painter, camera, self.section.contours(), false, EDGE);
    }

    /// Draws the tool with its tip at a position; `false` for one that the job does not
    /// describe.
    pub fn tool(&mut self, painter: &Painter, camera: &Camera, part: &PartView, tip: Pos2) -> bool {
        let Some(tool) = part.job.tools.get(&part.tool) else {
            return false;
        };
        self.take(part);
        let parts = self.tools.entry(part.tool);
        for part in parts.or_insert_with(|| tool_parts(tool)) {
            part.draw(painter, camera, tip);
        }
        true
    }

    fn take(&mut self, part: &PartView) {
        if !Arc::ptr_eq(&self.section, &part.section) {
            self.section = Arc::clone(&part.section);
            self.material = trapezoids(&self.section, SectionFill::Material);
            self.outside = trapezoids(&self.section, SectionFill::Outside);
        }
        let same = self.job.as_ref();
        if same.is_some_and(|(job, open)| Arc::ptr_eq(job, &part.job) && *open == part.chuck_open) {
            return;
        }
        self.job = Some((Arc::clone(&part.job), part.chuck_open));
        self.tools.clear();
        let stock = &part.job.stock;
        let (body, jaws) = stock.chuck_section();
        let jaws = if part.chuck_open {
            stock.open_jaws()
        } else {
            jaws
        };
        self.clamps = [
            (body, CHUCK),
            (jaws, JAWS),
            (stock.tailstock_section(), CHUCK),
        ]
        .map(|(region, color)| (trapezoids(&region, SectionFill::Material), region, color))
        .into();
    }
}

/// A part of a tool, its tip at the zero.
struct ToolPart {
    filled: Vec<Trapezoid>,
    edge: Vec<Pos2>,
    color: Color32,
    edge_color: Color32,
}

impl ToolPart {
    /// With the tip at a position.
    fn draw(&self, painter: &Painter, camera: &Camera, tip: Pos2) {
        let by = |(z, low, high): (f32, f32, f32)| (z + tip.x, low + tip.y, high + tip.y);
        let moved = self.filled.iter().map(|it| Trapezoid {
            sides: it.sides.map(by),
        });
        let moved: Vec<Trapezoid> = moved.collect();
        fill(painter, camera, &moved, false, self.color);
        let edge = self.edge.iter();
        let edge = edge.map(|at| camera.screen(*at + tip.to_vec2()));
        let stroke = Stroke::new(1.0, self.edge_color);
        painter.add(Shape::closed_line(edge.collect(), stroke));
    }

    fn new(contour: &GridContour, color: Color32, edge_color: Color32) -> Self {
        let region = Region::from_contours(std::slice::from_ref(contour));
        Self {
            filled: trapezoids(&region, SectionFill::Material),
            edge: points(contour, false).collect(),
            color,
            edge_color,
        }
    }
}

/// Draws a tool with its tip at the zero.
pub fn draw_tool(painter: &Painter, camera: &Camera, tool: &Tool) {
    for part in tool_parts(tool) {
        part.draw(painter, camera, Pos2::ZERO);
    }
}

/// Holder and insert.
fn tool_parts(tool: &Tool) -> Vec<ToolPart> {
    let shape = ToolShape::from_tool(tool);
    let body = shape.body.iter();
    let body = body.map(|(_, contour)| ToolPart::new(contour, HOLDER, HOLDER_EDGE));
    body.chain([ToolPart::new(&shape.cutting, INSERT, Color32::WHITE)])
        .collect()
}

/// Fills trapezoids, or their mirror image beyond the axis.
fn fill(painter: &Painter, camera: &Camera, made: &[Trapezoid], mirrored: bool, color: Color32) {
    let mut mesh = Mesh::default();
    if color == INSERT {
        // What it is, its yellow says in light surroundings, too.
        mesh.texture_id = white(painter.ctx());
    }
    mesh.reserve_vertices(made.len() * 4);
    mesh.reserve_triangles(made.len() * 2);
    for trapezoid in made {
        let first = mesh.vertices.len() as u32;
        for (z, x) in trapezoid.corners() {
            mesh.vertices.push(Vertex {
                pos: camera.screen(turned(pos2(z, x), mirrored)),
                uv: WHITE_UV,
                color,
            });
        }
        mesh.add_triangle(first, first + 1, first + 2);
        mesh.add_triangle(first + 1, first + 2, first + 3);
    }
    painter.add(mesh);
}

fn outline(
    painter: &Painter,
    camera: &Camera,
    contours: &[GridContour],
    mirrored: bool,
    color: Color32,
) {
    for contour in contours {
        let line = points(contour, mirrored).map(|at| camera.screen(at));
        let stroke = Stroke::new(1.0, color);
        painter.add(Shape::closed_line(line.collect(), stroke));
    }
}

/// The edge of the part on the side that is not cut open.
fn silhouette(painter: &Painter, camera: &Camera, outside: &[Trapezoid]) {
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
    let line = line.into_iter().map(|at| camera.screen(at)).collect();
    painter.add(Shape::line(line, Stroke::new(1.0, EDGE)));
}

fn points(contour: &GridContour, mirrored: bool) -> impl Iterator<Item = Pos2> + '_ {
    contour.iter().map(move |point| {
        let point = from_grid(*point);
        turned(pos2(point.z as f32, point.x as f32), mirrored)
    })
}

fn turned(at: Pos2, mirrored: bool) -> Pos2 {
    let x = if mirrored { -at.y } else { at.y };
    pos2(at.x, x)
}

/// A cross at a tip of which no tool is known.
pub fn tip(painter: &Painter, camera: &Camera, tip: Pos2) {
    let (at, stroke) = (camera.screen(tip), Stroke::new(1.5, INSERT));
    for arm in [Vec2::new(7.0, 0.0), Vec2::new(0.0, 7.0)] {
        painter.line_segment([at - arm, at + arm], stroke);
    }
}
