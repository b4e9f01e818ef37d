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
mod profile;
mod raster;
mod stage;
mod vertex;
mod view;

use glam::{Mat3, Vec3};

pub use body::Body;
pub use raster::Pixel;
pub use stage::{Fineness, clamping, part, tool};
pub use view::{Turn, View};

use finish::Hatch;
use gsk_workpiece::grid::from_grid;
use gsk_workpiece::region::Region;
use raster::{Corner, Raster};
use vertex::Vertex;
use view::Projection;

/// Largest side of a picture, pixels. A larger picture is empty beyond it.
const LARGEST: usize = 16_384;
/// Colour of the lines at the edges of a section.
const EDGE: Pixel = [60, 40, 24, 255];
/// Width of a line, pixels of the picture.
const LINE: f32 = 1.0;
/// Depth offset of lines in front of the surfaces they bound, pixels.
const OVER: f32 = 0.75;

/// A canvas for solids. It reuses its memory for the next picture.
#[derive(Clone, Debug, Default)]
pub struct Canvas {
    raster: Raster,
    /// Projected corners of the current body: right, down, near.
    places: Vec<Vec3>,
    lights: Vec<[f32; 3]>,
}

/// A body, and its displacement in the plane of the tools: Z and X, mm.
pub type Placed<'a> = (&'a Body, (f32, f32));

impl Canvas {
    /// Draws bodies on a picture of a size, with a transparent background. Returns the pixels
    /// row by row from the top. Each pixel is the mean of `samples` by `samples`; 2 gives
    /// smooth edges.
    pub fn draw<'a>(
        &mut self,
        bodies: impl IntoIterator<Item = Placed<'a>>,
        view: &View,
        (width, height): (usize, usize),
        samples: usize,
    ) -> Vec<Pixel> {
        let samples = samples.clamp(1, 4);
        let sides = [width, height].map(|side| side.min(LARGEST) * samples);
        self.raster.clear(sides[0], sides[1]);
        let projection = Projection::new(view, (sides[0], sides[1]), samples);
        let hatch = Hatch::new(view.scale);
        for (body, (z, x)) in bodies {
            let by = Vec3::new(z, x, 0.0);
            self.places.clear();
            let place = |vertex: &Vertex| projection.place(vertex.at + by);
            self.places.extend(body.vertices.iter().map(place));
            if body.finish.hatched {
                self.hatched(
                    body,
                    &projection.matrix,
                    projection.mirrored,
                    hatch,
                    samples,
                );
            } else {
                self.smooth(body, &projection.matrix, projection.mirrored);
            }
            for line in &body.lines {
                let [from, to] =
                    line.map(|end| projection.place(end + by) + Vec3::Z * (OVER * samples as f32));
                self.raster.line(from, to, LINE * samples as f32, EDGE);
            }
        }
        self.raster.picture(samples)
    }

    /// Draws surfaces whose light changes evenly between their corners.
    fn smooth(&mut self, body: &Body, seen: &Mat3, mirrored: bool) {
        self.lights.clear();
        let light = |vertex: &Vertex| body.finish.lit(vertex, seen).to_array();
        self.lights.extend(body.vertices.iter().map(light));
        for corners in &body.triangles {
            let Some(places) = facing(&self.places, *corners, mirrored) else {
                continue;
            };
            let mut index = corners.iter();
            let corners = places.map(|at| {
                let light = index.next().and_then(|it| self.lights.get(*it as usize));
                Corner {
                    at,
                    values: light.copied().unwrap_or_default(),
                }
            });
            self.raster.triangle(corners, |_| {
                |[red, green, blue]: [f32; 3]| [red as u8, green as u8, blue as u8, 255]
            });
        }
    }

    /// Draws the faces of a section.
    fn hatched(&mut self, body: &Body, seen: &Mat3, mirrored: bool, hatch: Hatch, samples: usize) {
        let width = 1.2 * samples as f32;
        for corners in &body.triangles {
            let Some(places) = facing(&self.places, *corners, mirrored) else {
                continue;
            };
            let vertices = corners.map(|corner| body.vertices.get(corner as usize));
            let [Some(a), Some(b), Some(c)] = vertices else {
                continue;
            };
            let [pa, pb, pc] = places;
            let corner = |at, vertex: &Vertex| Corner {
                at,
                values: [hatch.line(vertex.at)],
            };
            let color = body.finish.lit(a, seen);
            let corners = [corner(pa, a), corner(pb, b), corner(pc, c)];
            self.raster.triangle(corners, |[slope]| {
                let step = slope.length();
                move |[line]: [f32; 1]| {
                    let lit = color * Hatch::share(line, step, width);
                    [lit.x as u8, lit.y as u8, lit.z as u8, 255]
                }
            });
        }
    }
}

/// The projected corners of a triangle that faces the viewer.
fn facing(places: &[Vec3], corners: [u32; 3], mirrored: bool) -> Option<[Vec3; 3]> {
    let [a, b, c] = corners.map(|corner| places.get(corner as usize).copied());
    let (a, b, c) = (a?, b?, c?);
    let turns = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    // Down is greater, so counter-clockwise is negative.
    ((turns < 0.0) != mirrored).then_some([a, b, c])
}

impl View {
    /// Projects a Z and X, mm, of the plane of the tools to a picture of a size: right and
    /// down, pixels.
    pub fn place(&self, (z, x): (f32, f32), size: (usize, usize)) -> (f32, f32) {
        let place = Projection::new(self, size, 1).place(Vec3::new(z, x, 0.0));
        (place.x, place.y)
    }

    /// A view in a direction that shows half sections, turned about the axis, completely on a
    /// picture of a size. `margin` is the free border in pixels.
    pub fn fit<'a>(
        turn: Turn,
        regions: impl IntoIterator<Item = &'a Region>,
        (width, height): (usize, usize),
        margin: f32,
    ) -> Self {
        let matrix = turn.matrix();
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
        let scale = (free(width) / size.x).min(free(height) / size.y);
        let middle = (low + high) / 2.0;
        // The Z and X that are there in the plane of the tools.
        let [(zx, zy), (xx, xy)] = turn.axes();
        let (right, down) = (middle.x, -middle.y);
        let all = zx * xy - zy * xx;
        let centre = (
            (right * xy - down * xx) / all,
            (down * zx - right * zy) / all,
        );
        Self {
            turn,
            centre,
            scale,
        }
    }
}

#[cfg(test)]
mod tests;
