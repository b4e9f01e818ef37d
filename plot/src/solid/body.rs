//! Makes bodies of triangles: half sections turned about the spindle axis, or extruded along
//! Y.

use core::f32::consts::TAU;

use glam::{Vec2, Vec3, vec3};
use gsk_workpiece::grid::GridContour;
use gsk_workpiece::region::Region;
use gsk_workpiece::trapezoid::{SectionFill, trapezoids};

use super::finish::SurfaceFinish;
use super::profile::{self, ProfileEdge};
use super::vertex::Vertex;

/// A body, or one of its surfaces, as triangles with one finish.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidBody {
    pub(super) finish: SurfaceFinish,
    pub(super) vertices: Vec<Vertex>,
    /// Corners of each triangle as vertex indexes, counter-clockwise seen from outside.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Both ends of each edge that is drawn as a line, mm.
    pub(super) lines: Vec<[Vec3; 2]>,
}

/// A part of a turn about the spindle axis: angles in radians from X towards Y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TurnArc {
    pub from: f32,
    pub to: f32,
    /// Number of flat sides that approximate the arc.
    pub sides: u16,
}

impl TurnArc {
    /// Creates a whole turn, approximated by `sides` flat sides.
    pub(super) const fn full_turn(sides: u16) -> Self {
        Self {
            from: 0.0,
            to: TAU,
            sides,
        }
    }

    /// The three quarters that remain when the quarter between X and Y is cut out. `sides` is
    /// the number of flat sides of a whole turn.
    pub(super) const fn three_quarters(sides: u16) -> Self {
        Self {
            from: TAU / 4.0,
            to: TAU,
            sides: sides / 4 * 3,
        }
    }

    /// The directions from the axis to the corners between flat sides, as X and Y, length 1.
    fn directions(&self) -> impl Iterator<Item = Vec2> + use<> {
        let Self { from, to, sides } = *self;
        (0..=sides).map(move |side| {
            let angle = from + (to - from) * f32::from(side) / f32::from(sides.max(1));
            Vec2::new(libm::cosf(angle), libm::sinf(angle))
        })
    }
}

impl SolidBody {
    pub(super) const fn new(finish: SurfaceFinish) -> Self {
        Self {
            finish,
            vertices: Vec::new(),
            triangles: Vec::new(),
            lines: Vec::new(),
        }
    }

    /// Adds the surfaces that pieces of an outline sweep when they turn about the spindle
    /// axis.
    pub(super) fn add_turned<'a>(
        &mut self,
        edges: impl IntoIterator<Item = &'a ProfileEdge>,
        arc: TurnArc,
    ) {
        let directions: Vec<Vec2> = arc.directions().collect();
        for edge in edges.into_iter().filter(|edge| edge.is_off_axis()) {
            let first = self.vertices.len() as u32;
            for direction in &directions {
                let out = |radius: f32, z: f32| vec3(z, direction.x * radius, direction.y * radius);
                for (end, normal) in edge.ends.iter().zip(edge.normals) {
                    self.vertices.push(Vertex {
                        position: out(end.y.max(0.0), end.x),
                        normal: out(normal.y, normal.x),
                        marks: vec3(0.0, -direction.y, direction.x),
                    });
                }
            }
            for side in 0..directions.len().saturating_sub(1) as u32 {
                let corner = first + 2 * side;
                self.add_strip([corner, corner + 1, corner + 2, corner + 3]);
            }
        }
    }

    /// Adds the flat section of a region in the plane `half`, seen from the cut-out quarter.
    pub(super) fn add_section(&mut self, region: &Region, half: SectionPlane) {
        let (out, normal) = match half {
            SectionPlane::X => (Vec3::Y, Vec3::Z),
            SectionPlane::Y => (Vec3::Z, Vec3::Y),
        };
        let place = |z: f32, x: f32| vec3(z, 0.0, 0.0) + out * x;
        self.add_flat(region, normal, place, half == SectionPlane::X);
        let lines = profile::region_lines(region).into_iter();
        let lines = lines.filter(|(a, b)| a.y.max(b.y) > 0.0 || half == SectionPlane::X);
        self.lines
            .extend(lines.map(|(a, b)| [place(a.x, a.y), place(b.x, b.y)]));
    }

    /// Extrudes a convex polygon of Z and X from the first to the second Y, mm, turned by
    /// `angle`, radians, about the spindle axis. Corners may move by `tolerance`, mm.
    pub(super) fn extrude(
        &mut self,
        contour: &GridContour,
        (low, high): (f32, f32),
        angle: f32,
        tolerance: f32,
    ) {
        let (sine, cosine) = (libm::sinf(angle), libm::cosf(angle));
        let turned = |z: f32, x: f32, y: f32| vec3(z, x * cosine - y * sine, x * sine + y * cosine);
        for edge in profile::contour_edges(contour, tolerance) {
            let first = self.vertices.len() as u32;
            for y in [low, high] {
                for (end, normal) in edge.ends.iter().zip(edge.normals) {
                    self.vertices.push(Vertex {
                        position: turned(end.x, end.y, y),
                        normal: turned(normal.x, normal.y, 0.0),
                        marks: Vec3::ZERO,
                    });
                }
            }
            self.add_strip([first, first + 1, first + 2, first + 3]);
        }
        let region = Region::from_contours(core::slice::from_ref(contour));
        let up = turned(0.0, 0.0, 1.0);
        self.add_flat(&region, up, |z, x| turned(z, x, high), true);
        self.add_flat(&region, -up, |z, x| turned(z, x, low), false);
    }

    /// Adds a filled flat region. `place` converts Z and X to a position in the body. `direct`
    /// means that the viewer sees Z to the right and X up.
    fn add_flat(
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
                    position: place(z, x),
                    normal,
                    marks: Vec3::ZERO,
                });
            }
            let [a, b, c, d] = [first, first + 1, first + 2, first + 3];
            self.add_strip(if direct { [a, c, b, d] } else { [a, b, c, d] });
        }
    }

    /// Adds two triangles that share the side `b c`; `a b c` goes counter-clockwise.
    fn add_strip(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangles.extend([[a, b, c], [c, b, d]]);
    }
}

/// One of the two flat faces of the cut-out quarter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SectionPlane {
    /// The face of the cut-out quarter in the plane of the tools.
    X,
    /// The face of the cut-out quarter at right angles to the plane of the tools.
    Y,
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_workpiece::grid::{GridPoint, grid};

    /// Returns the volume inside closed surfaces of counter-clockwise triangles, mm³.
    fn volume(bodies: &[&SolidBody]) -> f32 {
        let of = |body: &&SolidBody| {
            let corner = |index: u32| body.vertices[index as usize].position;
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
        let edges = profile::region_edges(&region, 0.001);
        let mut whole = SolidBody::new(SurfaceFinish::CUT);
        whole.add_turned(&edges, TurnArc::full_turn(360));
        assert!((volume(&[&whole]) / region.volume() as f32 - 1.0).abs() < 1e-3);
        let mut shell = SolidBody::new(SurfaceFinish::CUT);
        shell.add_turned(&edges, TurnArc::three_quarters(360));
        let mut faces = SolidBody::new(SurfaceFinish::SECTION);
        faces.add_section(&region, SectionPlane::X);
        faces.add_section(&region, SectionPlane::Y);
        let wanted = 0.75 * region.volume() as f32;
        assert!((volume(&[&shell, &faces]) / wanted - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_drawn_out_polygon_has_the_volume_of_a_prism() {
        let contour = tube()
            .bounds()
            .map(|box_| Region::rectangle(box_.low, box_.high).contours()[0].clone());
        let mut body = SolidBody::new(SurfaceFinish::CUT);
        body.extrude(&contour.unwrap(), (-4.0, 3.0), 1.0, 0.001);
        assert!((volume(&[&body]) / (60.0 * 25.0 * 7.0) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn normals_are_those_of_the_triangles() {
        let mut body = SolidBody::new(SurfaceFinish::CUT);
        body.add_turned(
            &profile::region_edges(&tube(), 0.001),
            TurnArc::full_turn(64),
        );
        body.add_section(&tube(), SectionPlane::X);
        body.add_section(&tube(), SectionPlane::Y);
        for corners in &body.triangles {
            let [a, b, c] = corners.map(|corner| body.vertices[corner as usize]);
            let across = (b.position - a.position).cross(c.position - a.position);
            assert!(across.length() < 1e-6 || across.normalize().dot(a.normal) > 0.9);
        }
    }
}
