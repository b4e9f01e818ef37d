//! Bodies of triangles: half sections turned about the spindle axis, or drawn out along Y.

use core::f32::consts::TAU;

use glam::{Vec2, Vec3, vec3};
use gsk_workpiece::grid::GridContour;
use gsk_workpiece::region::Region;
use gsk_workpiece::trapezoid::{SectionFill, trapezoids};

use super::finish::Finish;
use super::profile::{self, Edge};
use super::vertex::Vertex;

/// A body, or one of its surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    pub(super) finish: Finish,
    pub(super) vertices: Vec<Vertex>,
    /// Seen from outside they go counter-clockwise.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Edges that are drawn as lines.
    pub(super) lines: Vec<[Vec3; 2]>,
}

/// Part of a turn, in radians from X towards Y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    pub from: f32,
    pub to: f32,
    /// Flat sides it is made of.
    pub sides: u16,
}

impl Arc {
    /// A whole turn.
    pub(super) const fn whole(sides: u16) -> Self {
        Self {
            from: 0.0,
            to: TAU,
            sides,
        }
    }

    /// What is left when the quarter between X and Y is cut out; `sides` of a whole turn.
    pub(super) const fn three_quarters(sides: u16) -> Self {
        Self {
            from: TAU / 4.0,
            to: TAU,
            sides: sides / 4 * 3,
        }
    }

    /// The directions of its corners: X and Y.
    fn directions(&self) -> impl Iterator<Item = Vec2> + use<> {
        let Self { from, to, sides } = *self;
        (0..=sides).map(move |side| {
            let angle = from + (to - from) * f32::from(side) / f32::from(sides.max(1));
            Vec2::new(libm::cosf(angle), libm::sinf(angle))
        })
    }
}

impl Body {
    pub(super) const fn new(finish: Finish) -> Self {
        Self {
            finish,
            vertices: Vec::new(),
            triangles: Vec::new(),
            lines: Vec::new(),
        }
    }

    /// Turns pieces of an outline about the axis of the spindle.
    pub(super) fn turn<'a>(&mut self, edges: impl IntoIterator<Item = &'a Edge>, arc: Arc) {
        let directions: Vec<Vec2> = arc.directions().collect();
        for edge in edges.into_iter().filter(|edge| edge.is_off_axis()) {
            let first = self.vertices.len() as u32;
            for direction in &directions {
                let out = |radius: f32, z: f32| vec3(z, direction.x * radius, direction.y * radius);
                for (end, normal) in edge.ends.iter().zip(edge.normals) {
                    self.vertices.push(Vertex {
                        at: out(end.y.max(0.0), end.x),
                        normal: out(normal.y, normal.x),
                        marks: vec3(0.0, -direction.y, direction.x),
                    });
                }
            }
            for side in 0..directions.len().saturating_sub(1) as u32 {
                let corner = first + 2 * side;
                self.strip([corner, corner + 1, corner + 2, corner + 3]);
            }
        }
    }

    /// The section of a region in the half plane at an angle, seen from the cut-out
    /// quarter: that of X or that of Y.
    pub(super) fn section(&mut self, region: &Region, half: Half) {
        let (out, normal) = match half {
            Half::X => (Vec3::Y, Vec3::Z),
            Half::Y => (Vec3::Z, Vec3::Y),
        };
        let place = |z: f32, x: f32| vec3(z, 0.0, 0.0) + out * x;
        self.flat(region, normal, place, half == Half::X);
        let lines = profile::lines(region).into_iter();
        let lines = lines.filter(|(a, b)| a.y.max(b.y) > 0.0 || half == Half::X);
        self.lines
            .extend(lines.map(|(a, b)| [place(a.x, a.y), place(b.x, b.y)]));
    }

    /// Draws a convex polygon of Z and X out between two Y, mm, turned about the axis of
    /// the spindle; it may be simplified by a tolerance, mm.
    pub(super) fn draw_out(
        &mut self,
        contour: &GridContour,
        (low, high): (f32, f32),
        angle: f32,
        tolerance: f32,
    ) {
        let (sine, cosine) = (libm::sinf(angle), libm::cosf(angle));
        let turned = |z: f32, x: f32, y: f32| vec3(z, x * cosine - y * sine, x * sine + y * cosine);
        for edge in profile::of_contour(contour, tolerance) {
            let first = self.vertices.len() as u32;
            for y in [low, high] {
                for (end, normal) in edge.ends.iter().zip(edge.normals) {
                    self.vertices.push(Vertex {
                        at: turned(end.x, end.y, y),
                        normal: turned(normal.x, normal.y, 0.0),
                        marks: Vec3::ZERO,
                    });
                }
            }
            self.strip([first, first + 1, first + 2, first + 3]);
        }
        let region = Region::from_contours(core::slice::from_ref(contour));
        let up = turned(0.0, 0.0, 1.0);
        self.flat(&region, up, |z, x| turned(z, x, high), true);
        self.flat(&region, -up, |z, x| turned(z, x, low), false);
    }

    /// A filled region in a plane; `direct`: the plane faces its viewer with Z to the right
    /// and X up.
    fn flat(
        &mut self,
        region: &Region,
        normal: Vec3,
        place: impl Fn(f32, f32) -> Vec3,
        direct: bool,
    ) {
        for trapezoid in trapezoids(region, SectionFill::Material) {
            let first = self.vertices.len() as u32;
            for (z, x) in trapezoid.corners() {
                self.vertices.push(Vertex {
                    at: place(z, x),
                    normal,
                    marks: Vec3::ZERO,
                });
            }
            let [a, b, c, d] = [first, first + 1, first + 2, first + 3];
            self.strip(if direct { [a, c, b, d] } else { [a, b, c, d] });
        }
    }

    /// Two triangles: `a b c` goes counter-clockwise.
    fn strip(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangles.extend([[a, b, c], [c, b, d]]);
    }
}

/// One of the two faces of the cut-out quarter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Half {
    /// In the plane of the tools.
    X,
    /// At right angles to it.
    Y,
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_workpiece::grid::{GridPoint, grid};

    /// The volume inside triangles that go counter-clockwise, mm³.
    fn volume(bodies: &[&Body]) -> f32 {
        let of = |body: &&Body| {
            let corner = |index: u32| body.vertices[index as usize].at;
            let all = body.triangles.iter();
            all.map(|[a, b, c]| corner(*a).dot(corner(*b).cross(corner(*c))))
                .sum::<f32>()
        };
        bodies.iter().map(of).sum::<f32>() / 6.0
    }

    fn tube() -> Region {
        let corner = |z, x| GridPoint::new(grid(z), grid(x));
        let bar = Region::rectangle(corner(-60.0, 0.0), corner(0.0, 25.0));
        bar.difference(&[vec![
            corner(-40.0, 0.0),
            corner(1.0, 0.0),
            corner(1.0, 10.0),
            corner(-40.0, 10.0),
        ]])
    }

    #[test]
    fn a_turned_region_is_closed_and_faces_outward() {
        let region = tube();
        let edges = profile::edges(&region, 0.001);
        let mut whole = Body::new(Finish::CUT);
        whole.turn(&edges, Arc::whole(360));
        assert!((volume(&[&whole]) / region.volume() as f32 - 1.0).abs() < 1e-3);
        let mut shell = Body::new(Finish::CUT);
        shell.turn(&edges, Arc::three_quarters(360));
        let mut faces = Body::new(Finish::SECTION);
        faces.section(&region, Half::X);
        faces.section(&region, Half::Y);
        let wanted = 0.75 * region.volume() as f32;
        assert!((volume(&[&shell, &faces]) / wanted - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_drawn_out_polygon_has_the_volume_of_a_prism() {
        let contour = tube()
            .bounds()
            .map(|box_| Region::rectangle(box_.low, box_.high).contours()[0].clone());
        let mut body = Body::new(Finish::CUT);
        body.draw_out(&contour.unwrap(), (-4.0, 3.0), 1.0, 0.001);
        assert!((volume(&[&body]) / (60.0 * 25.0 * 7.0) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn normals_are_those_of_the_triangles() {
        let mut body = Body::new(Finish::CUT);
        body.turn(&profile::edges(&tube(), 0.001), Arc::whole(64));
        body.section(&tube(), Half::X);
        body.section(&tube(), Half::Y);
        for corners in &body.triangles {
            let [a, b, c] = corners.map(|corner| body.vertices[corner as usize]);
            let across = (b.at - a.at).cross(c.at - a.at);
            assert!(across.length() < 1e-6 || across.normalize().dot(a.normal) > 0.9);
        }
    }
}
