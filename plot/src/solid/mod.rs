//! Draws the part in space: a solid of revolution with a quarter cut out, its clamping and the
//! tool, with lighting. The CPU draws it with a depth buffer, so that the picture is the same
//! on every computer.
//!
//! ```text
//!            X  plane of the tools
//!            |___
//!            |   |          the quarter between X and Y is cut out
//!       _____|   |___
//!      /     +---/--/|--- Z
//!      |    /___/__/ |
//!      |____________/
//!          Y
//! ```

mod body;
mod finish;
mod lathe_bodies;
mod profile;
mod raster;
mod vertex;
mod view;

use glam::{Mat3, Vec3};

pub use body::SolidBody;
pub use lathe_bodies::{BodyResolution, clamping_bodies, part_bodies, tool_bodies};
pub use raster::SolidPixel;
pub use view::{SolidView, ViewDirection};

use finish::SectionHatch;
use gsk_workpiece::grid::from_grid;
use gsk_workpiece::region::Region;
use raster::{Raster, TriangleCorner};
use vertex::Vertex;
use view::Projection;

/// Largest side of a picture, pixels. Of a larger picture the rest stays empty.
const MAX_SIDE_PX: usize = 16_384;
/// Colour of the lines along the edges of a section.
const EDGE_COLOR: SolidPixel = [60, 40, 24, 255];
/// Width of the lines along edges, pixels.
const LINE_WIDTH_PX: f32 = 1.0;
/// Offset of lines towards the viewer, pixels, so that the surfaces they bound do not hide
/// them.
const LINE_DEPTH_OFFSET_PX: f32 = 0.75;

/// Draws solid bodies into a picture; reuses its memory for the next picture.
#[derive(Clone, Debug, Default)]
pub struct SolidCanvas {
    raster: Raster,
    /// Corners of the current body after projection, pixels: right, down, near.
    corners: Vec<Vec3>,
    lights: Vec<[f32; 3]>,
}

/// A body, and its displacement in the plane of the tools: Z and X, mm.
pub type PlacedBody<'a> = (&'a SolidBody, (f32, f32));

impl SolidCanvas {
    /// Draws bodies on a picture of `width` by `height` pixels with a transparent background.
    /// Returns the pixels row by row from the top. Each pixel is the mean of `samples` by
    /// `samples`; 2 gives smooth edges.
    pub fn draw<'a>(
        &mut self,
        bodies: impl IntoIterator<Item = PlacedBody<'a>>,
        view: &SolidView,
        (width, height): (usize, usize),
        samples: usize,
    ) -> Vec<SolidPixel> {
        let samples = samples.clamp(1, 4);
        let sides = [width, height].map(|side| side.min(MAX_SIDE_PX) * samples);
        self.raster.clear(sides[0], sides[1]);
        let projection = Projection::new(view, (sides[0], sides[1]), samples);
        let hatch = SectionHatch::new(view.pixels_per_mm);
        for (body, (z, x)) in bodies {
            let displacement = Vec3::new(z, x, 0.0);
            self.corners.clear();
            let project = |vertex: &Vertex| projection.project(vertex.position + displacement);
            self.corners.extend(body.vertices.iter().map(project));
            if body.finish.hatched {
                self.draw_hatched(
                    body,
                    &projection.matrix,
                    projection.mirrored,
                    hatch,
                    samples,
                );
            } else {
                self.draw_smooth(body, &projection.matrix, projection.mirrored);
            }
            for line in &body.lines {
                let [from, to] = line.map(|end| {
                    projection.project(end + displacement)
                        + Vec3::Z * (LINE_DEPTH_OFFSET_PX * samples as f32)
                });
                self.raster
                    .draw_line(from, to, LINE_WIDTH_PX * samples as f32, EDGE_COLOR);
            }
        }
        self.raster.downsample(samples)
    }

    /// Draws a body whose light changes evenly between the corners of its triangles. `seen`
    /// maps its directions to those of the viewer.
    fn draw_smooth(&mut self, body: &SolidBody, seen: &Mat3, mirrored: bool) {
        self.lights.clear();
        let light = |vertex: &Vertex| body.finish.lit_color(vertex, seen).to_array();
        self.lights.extend(body.vertices.iter().map(light));
        for corners in &body.triangles {
            let Some(places) = facing_corners(&self.corners, *corners, mirrored) else {
                continue;
            };
            let mut index = corners.iter();
            let corners = places.map(|at| {
                let light = index.next().and_then(|it| self.lights.get(*it as usize));
                TriangleCorner {
                    position: at,
                    values: light.copied().unwrap_or_default(),
                }
            });
            self.raster.draw_triangle(corners, |_| {
                |[red, green, blue]: [f32; 3]| [red as u8, green as u8, blue as u8, 255]
            });
        }
    }

    /// Draws the hatched faces of a section. `seen` maps their directions to those of the
    /// viewer.
    fn draw_hatched(
        &mut self,
        body: &SolidBody,
        seen: &Mat3,
        mirrored: bool,
        hatch: SectionHatch,
        samples: usize,
    ) {
        let width = 1.2 * samples as f32;
        for corners in &body.triangles {
            let Some(places) = facing_corners(&self.corners, *corners, mirrored) else {
                continue;
            };
            let vertices = corners.map(|corner| body.vertices.get(corner as usize));
            let [Some(a), Some(b), Some(c)] = vertices else {
                continue;
            };
            let [pa, pb, pc] = places;
            let corner = |at, vertex: &Vertex| TriangleCorner {
                position: at,
                values: [hatch.line_coordinate(vertex.position)],
            };
            let color = body.finish.lit_color(a, seen);
            let corners = [corner(pa, a), corner(pb, b), corner(pc, c)];
            self.raster.draw_triangle(corners, |[slope]| {
                let step = slope.length();
                move |[line]: [f32; 1]| {
                    let lit = color * SectionHatch::light_share(line, step, width);
                    [lit.x as u8, lit.y as u8, lit.z as u8, 255]
                }
            });
        }
    }
}

/// The projected corners of a triangle; `None` if it faces away from the viewer.
fn facing_corners(places: &[Vec3], corners: [u32; 3], mirrored: bool) -> Option<[Vec3; 3]> {
    let [a, b, c] = corners.map(|corner| places.get(corner as usize).copied());
    let (a, b, c) = (a?, b?, c?);
    let turns = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    // Down is greater, so counter-clockwise is negative.
    ((turns < 0.0) != mirrored).then_some([a, b, c])
}

impl SolidView {
    /// Projects a Z and X, mm, in the plane of the tools to a picture of `size` pixels.
    /// Returns right and down in pixels.
    pub fn project(&self, (z, x): (f32, f32), size: (usize, usize)) -> (f32, f32) {
        let place = Projection::new(self, size, 1).project(Vec3::new(z, x, 0.0));
        (place.x, place.y)
    }

    /// Creates a view that shows half sections, turned about the axis, completely on a picture
    /// of a size. `margin` is the free border in pixels.
    pub fn fit<'a>(
        direction: ViewDirection,
        regions: impl IntoIterator<Item = &'a Region>,
        (width, height): (usize, usize),
        margin: f32,
    ) -> Self {
        let matrix = direction.matrix();
        let mut low = Vec3::INFINITY;
        let mut high = Vec3::NEG_INFINITY;
        for bounds in regions.into_iter().filter_map(Region::bounds) {
            let (near, far) = (from_grid(bounds.low), from_grid(bounds.high));
            let radius = far.x as f32;
            for z in [near.z as f32, far.z as f32] {
                // The silhouette of a circle about Z.
                let middle = matrix * Vec3::new(z, 0.0, 0.0);
                let axis = matrix.x_axis;
                let reach = Vec3::new(
                    radius * (1.0 - axis.x * axis.x).max(0.0).sqrt(),
                    radius * (1.0 - axis.y * axis.y).max(0.0).sqrt(),
                    0.0,
                );
                low = low.min(middle - reach);
                high = high.max(middle + reach);
            }
        }
        if !(low.is_finite() && high.is_finite()) {
            (low, high) = (Vec3::splat(-50.0), Vec3::splat(50.0));
        }
        let size = (high - low).max(Vec3::splat(1e-3));
        let free = |side: usize| (side as f32 - 2.0 * margin).max(1.0);
        let pixels_per_mm = (free(width) / size.x).min(free(height) / size.y);
        let middle = (low + high) / 2.0;
        // The Z and X that are there in the plane of the tools.
        let [(zx, zy), (xx, xy)] = direction.axes();
        let (right, down) = (middle.x, -middle.y);
        let all = zx * xy - zy * xx;
        let centre = (
            (right * xy - down * xx) / all,
            (down * zx - right * zy) / all,
        );
        Self {
            direction,
            centre,
            pixels_per_mm,
        }
    }
}

#[cfg(test)]
mod tests;
