//! Threads of the part as helices: the grooves of the half section, led around the axis.

use core::f32::consts::TAU;

use glam::{Vec2, Vec3, vec2, vec3};

use crate::mesh::polyline::simplify;
use crate::mesh::{SceneMaterial, SceneMesh};

/// The range and lead of a thread on the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadDescription {
    /// Least x of the grooves of the half section, mm.
    pub low: f32,
    /// Greatest x of the grooves of the half section, mm.
    pub high: f32,
    /// Distance along x per positive turn of the spindle, mm; negative for a right-hand
    /// thread.
    pub lead: f32,
    /// Whether the thread is internal, in a bore.
    pub is_internal: bool,
}

/// Material of the surface of a cut thread.
const THREAD_STEEL: SceneMaterial = SceneMaterial {
    color: [204, 204, 208],
    roughness: 61,
    metal: 255,
    rings: 0,
    glow: 0,
};
/// Distance before and after a step at which its radii are read, mm.
const STEP_MM: f32 = 1e-3;
/// Number of samples per lead at which the surface without grooves is stored.
const SAMPLES_PER_LEAD: f32 = 32.0;
/// Greatest number of samples of a thread's surface without grooves.
const MAX_SAMPLES: usize = 8000;
/// Greatest number of points of a profile; a longer thread is drawn as rings without a helix.
const MAX_PROFILE: usize = 1200;
/// Tolerance with which a profile is simplified, as a fraction of the lead.
const PROFILE_TOLERANCE: f32 = 0.004;
/// Number of columns of triangles in a full turn of the thread.
const COLUMNS: usize = 64;

/// The helical surface of a thread within its range along the axis.
#[derive(Clone, Debug, PartialEq)]
pub struct ThreadSurface {
    /// Least x of the thread, mm.
    pub low: f32,
    /// Greatest x of the thread, mm.
    pub high: f32,
    /// Whether the thread is internal, in a bore.
    pub is_internal: bool,
    lead: f32,
    /// Radius at `low` and `high` in the plane of the half section, mm.
    ends: [f32; 2],
    /// Depth of the grooves below the surface, as points (x, depth), in the plane of the half
    /// section, mm.
    depths: Vec<Vec2>,
    /// Radius of the surface without grooves, mm, at equal steps from `low` on.
    body: Vec<f32>,
}

/// Reads radii from the polygons of a half section.
pub struct SectionSampler<'a> {
    lines: &'a [Vec<Vec2>],
}

impl<'a> SectionSampler<'a> {
    /// Creates a reader of closed polygons of points (x, radius), mm.
    pub const fn new(lines: &'a [Vec<Vec2>]) -> Self {
        Self { lines }
    }

    /// Returns the least and greatest radius of the surfaces at x; `None` outside the part. The
    /// least one is 0 without a bore.
    pub fn radii(&self, x: f32) -> Option<(f32, f32)> {
        let mut found: Option<(f32, f32, usize)> = None;
        for points in self.lines {
            for (a, b) in points.iter().zip(points.iter().cycle().skip(1)) {
                if (a.x > x) == (b.x > x) || (a.y <= 0.0 && b.y <= 0.0) {
                    continue;
                }
                let radius = a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x);
                let (low, high, count) = found.unwrap_or((radius, radius, 0));
                found = Some((low.min(radius), high.max(radius), count + 1));
            }
        }
        // The side on the axis was left out: an odd number of sides is solid to the axis.
        found.map(|(low, high, count)| {
            if count % 2 == 1 {
                (0.0, high)
            } else {
                (low, high)
            }
        })
    }

    fn radius(&self, x: f32, is_internal: bool) -> Option<f32> {
        let (low, high) = self.radii(x)?;
        match is_internal {
            true => (low > 0.0).then_some(low),
            false => Some(high),
        }
    }

    /// Returns the range of x, within `low` and `high`, in which the outer surface or the bore
    /// exists; `None` if it does not exist there.
    fn extent(&self, low: f32, high: f32, is_internal: bool) -> Option<(f32, f32)> {
        let x = self.lines.iter().flatten().map(|it| it.x);
        let inner = x.filter(|x| *x > low && *x < high);
        let mut stops: Vec<f32> = inner.chain([low, high]).collect();
        stops.sort_by(f32::total_cmp);
        stops.dedup();
        let solid = |pair: &&[f32]| {
            self.radius((pair[0] + pair[1]) * 0.5, is_internal)
                .is_some()
        };
        let mut pairs = stops.windows(2).filter(solid);
        let first = pairs.next()?;
        let last = pairs.next_back().unwrap_or(first);
        Some((first[0], last[1]))
    }

    /// Returns the outer surface, or the bore, as points from `low` to `high`, with two points at a
    /// step.
    fn profile(&self, low: f32, high: f32, is_internal: bool) -> Vec<Vec2> {
        let x = self.lines.iter().flatten().map(|it| it.x);
        let inner = x.filter(|x| *x > low + 2.0 * STEP_MM && *x < high - 2.0 * STEP_MM);
        let mut stops: Vec<f32> = inner.collect();
        stops.sort_by(f32::total_cmp);
        stops.dedup_by(|a, b| (*a - *b).abs() < STEP_MM);
        let at = |x: f32, read: f32| self.radius(read, is_internal).map(|radius| vec2(x, radius));
        let mut points: Vec<Vec2> = at(low, low + STEP_MM).into_iter().collect();
        for x in stops {
            let [before, after] = [x - STEP_MM, x + STEP_MM].map(|read| at(x, read));
            let is_step = before
                .zip(after)
                .is_none_or(|(before, after)| (before.y - after.y).abs() > 8.0 * STEP_MM);
            points.extend(before);
            if is_step {
                points.extend(after);
            }
        }
        points.extend(at(high, high - STEP_MM));
        points
    }
}

/// Returns the radius of a profile at x, interpolated between its points; `None` outside it.
fn read_profile(points: &[Vec2], x: f32) -> Option<f32> {
    let next = points.partition_point(|it| it.x <= x);
    let before = points.get(next.checked_sub(1)?)?;
    let Some(after) = points.get(next) else {
        return (x <= before.x + STEP_MM).then_some(before.y);
    };
    let share = (x - before.x) / (after.x - before.x).max(1e-6);
    Some(before.y + (after.y - before.y) * share)
}

/// Removes grooves narrower than `width` samples: takes the greatest, then the least value within a
/// window.
fn close_grooves(samples: &[f32], width: usize) -> Vec<f32> {
    let half = width / 2;
    let window = |values: &[f32], at: usize, pick: fn(f32, f32) -> f32| {
        let (from, to) = (at.saturating_sub(half), (at + half + 1).min(values.len()));
        values[from..to].iter().copied().reduce(pick).unwrap_or(0.0)
    };
    // Beyond the ends there is no material.
    let beyond = vec![f32::MIN; half];
    let wide: Vec<f32> = [&beyond[..], samples, &beyond[..]].concat();
    let grown: Vec<f32> = (0..wide.len())
        .map(|at| window(&wide, at, f32::max))
        .collect();
    (half..half + samples.len())
        .map(|at| window(&grown, at, f32::min))
        .collect()
}

impl ThreadSurface {
    /// Reads a thread from a half section; `None` if its grooves are shorter than one lead.
    pub fn from_section(section: &SectionSampler<'_>, thread: &ThreadDescription) -> Option<Self> {
        let (lead, is_internal) = (thread.lead, thread.is_internal);
        let turn = lead.abs();
        if !(turn > 0.01 && thread.low.is_finite() && thread.high.is_finite()) {
            return None;
        }
        let (low, high) = (thread.low - turn * 0.5, thread.high + turn * 0.5);
        let (low, high) = section.extent(low, high, is_internal)?;
        // The neighbourhood tells which hollows are grooves.
        let (wide_low, wide_high) = section.extent(low - turn, high + turn, is_internal)?;
        let profile = section.profile(wide_low, wide_high, is_internal);
        let step = turn / SAMPLES_PER_LEAD;
        let count = ((wide_high - wide_low) / step) as usize + 1;
        if high - low < turn || count > MAX_SAMPLES {
            return None;
        }
        let sign = if is_internal { -1.0 } else { 1.0 };
        let sample =
            |at: usize| read_profile(&profile, wide_low + step * at as f32).unwrap_or(0.0) * sign;
        let samples: Vec<f32> = (0..count).map(sample).collect();
        let closed = close_grooves(&samples, SAMPLES_PER_LEAD as usize);
        let closed: Vec<Vec2> = closed
            .iter()
            .enumerate()
            .map(|(at, value)| vec2(wide_low + step * at as f32, value * sign))
            .collect();
        let steps = (((high - low) / step) as usize).max(1);
        let body = (0..=steps).map(|at| {
            let x = low + (high - low) * at as f32 / steps as f32;
            read_profile(&closed, x).unwrap_or(0.0)
        });
        let mut surface = Self {
            low,
            high,
            is_internal,
            lead,
            ends: [0.0; 2],
            depths: Vec::new(),
            body: body.collect(),
        };
        let inside = section.profile(low, high, is_internal);
        surface.ends = [inside.first()?.y, inside.last()?.y];
        let depths: Vec<Vec2> = inside
            .iter()
            .map(|it| vec2(it.x, surface.body_radius(it.x) - it.y))
            .collect();
        surface.depths = simplify(&depths, turn * PROFILE_TOLERANCE);
        (surface.depths.len() <= MAX_PROFILE).then_some(surface)
    }

    /// Whether the thread covers the edge from `a` to `b` of the half section, so that the edge is
    /// not drawn.
    pub fn replaces(&self, section: &SectionSampler<'_>, a: Vec2, b: Vec2, tolerance: f32) -> bool {
        let middle = (a + b) * 0.5;
        if middle.x <= self.low + STEP_MM || middle.x >= self.high - STEP_MM {
            return false;
        }
        let sides = [middle.x - 2.0 * STEP_MM, middle.x + 2.0 * STEP_MM];
        let radii = sides.map(|x| section.radius(x, self.is_internal));
        let mut radii = radii.into_iter().flatten();
        match self.is_internal {
            true => radii.any(|radius| middle.y <= radius + tolerance),
            false => radii.any(|radius| middle.y >= radius - tolerance),
        }
    }

    /// Returns the points at which the thread begins and ends.
    pub fn corners(&self) -> [Vec2; 2] {
        let radius = self.body.iter().copied().fold(0.0, f32::max);
        [vec2(self.low, radius), vec2(self.high, radius)]
    }

    fn body_radius(&self, x: f32) -> f32 {
        let last = self.body.len().saturating_sub(1);
        let at = (x - self.low) / (self.high - self.low) * last as f32;
        let at = at.clamp(0.0, last as f32);
        let before = (at as usize).min(last.saturating_sub(1));
        let share = at - before as f32;
        let read = |index: usize| self.body.get(index).copied().unwrap_or(0.0);
        read(before) * (1.0 - share) + read(before + 1) * share
    }

    /// Returns the shift of the grooves along the axis at an angle of the part, mm.
    fn shift(&self, angle: f32) -> f32 {
        -self.lead * angle / TAU
    }

    fn depth(&self, x: f32) -> f32 {
        let turn = self.lead.abs();
        let below = ((self.low - x) / turn).ceil().max(0.0);
        let above = ((x - self.high) / turn).ceil().max(0.0);
        let within = (x + (below - above) * turn).clamp(self.low, self.high);
        read_profile(&self.depths, within).unwrap_or(0.0)
    }

    /// Returns the radius at x and at an angle of the part, mm. At angle 0 it is that of the half
    /// section.
    pub fn radius(&self, x: f32, angle: f32) -> f32 {
        (self.body_radius(x) - self.depth(x - self.shift(angle))).max(0.0)
    }

    /// Returns the profile at an angle of the part, as points from low to high x.
    pub fn profile(&self, angle: f32) -> Vec<Vec2> {
        let rows = self.rows([angle, angle]);
        rows.iter().map(|row| self.row_point(*row, angle)).collect()
    }

    /// Returns the points (x in the plane of the half section, depth) of all grooves that are
    /// visible within a range of angles.
    fn rows(&self, angles: [f32; 2]) -> Vec<Vec2> {
        let turn = self.lead.abs();
        let shifts = angles.map(|angle| self.shift(angle));
        let from = self.low - shifts[0].max(shifts[1]);
        let to = self.high - shifts[0].min(shifts[1]);
        let mut rows = Vec::new();
        for copy in -3..=3 {
            let moved = self.depths.iter().filter(|it| match copy {
                ..0 => it.x < self.low + turn,
                0 => true,
                1.. => it.x > self.high - turn,
            });
            let moved = moved.map(|it| vec2(it.x + copy as f32 * turn, it.y));
            rows.extend(moved.filter(|it| it.x >= from - turn && it.x <= to + turn));
        }
        rows
    }

    fn row_point(&self, row: Vec2, angle: f32) -> Vec2 {
        let x = row.x + self.shift(angle);
        if x < self.low || x > self.high {
            let x = x.clamp(self.low, self.high);
            return vec2(x, self.radius(x, angle));
        }
        vec2(x, (self.body_radius(x) - row.y).max(0.0))
    }

    /// Adds the thread surface over a range of angles of the part to the mesh: start and extent,
    /// radians.
    pub fn add_to(&self, mesh: &mut SceneMesh, [start, extent]: [f32; 2]) {
        mesh.material = THREAD_STEEL;
        let columns = ((extent / TAU * COLUMNS as f32).round() as usize).max(1);
        let angles = (0..=columns).map(|it| start + extent * it as f32 / columns as f32);
        let angles: Vec<f32> = angles.collect();
        let rows = self.rows([start, start + extent]);
        for pair in rows.windows(2) {
            let side = |angle: &f32| [pair[0], pair[1]].map(|row| self.row_point(row, *angle));
            let sides: Vec<[Vec2; 2]> = angles.iter().map(side).collect();
            if sides.iter().all(|[a, b]| a == b) {
                continue;
            }
            let first = mesh.vertices.len() as u32;
            for (angle, ends) in angles.iter().zip(&sides) {
                for end in ends {
                    mesh.add_vertex(revolved(*end, *angle), self.normal(*ends, end.y, *angle));
                }
            }
            add_strip(mesh, first, columns);
        }
        self.add_walls(mesh, &angles);
    }

    fn normal(&self, [a, b]: [Vec2; 2], radius: f32, angle: f32) -> Vec3 {
        let (dx, dr) = (b.x - a.x, b.y - a.y);
        // A step is steep and not infinite.
        let slope = dr / dx.max(1e-4);
        let around = -slope * self.lead / (TAU * radius.max(0.1));
        let (sine, cosine) = angle.sin_cos();
        let outward = vec3(-slope, cosine - sine * around, sine + cosine * around);
        if self.is_internal { -outward } else { outward }
    }

    /// Closes the gaps between the thread and the revolved surfaces at both ends.
    fn add_walls(&self, mesh: &mut SceneMesh, angles: &[f32]) {
        for (x, end, normal) in [
            (self.low, self.ends[0], Vec3::NEG_X),
            (self.high, self.ends[1], Vec3::X),
        ] {
            let first = mesh.vertices.len() as u32;
            for angle in angles {
                let radius = self.radius(x, *angle);
                mesh.add_vertex(revolved(vec2(x, radius), *angle), normal);
                mesh.add_vertex(revolved(vec2(x, end), *angle), normal);
            }
            add_strip(mesh, first, angles.len() - 1);
        }
    }
}

fn revolved(point: Vec2, angle: f32) -> Vec3 {
    let (sine, cosine) = angle.sin_cos();
    vec3(point.x, point.y * cosine, point.y * sine)
}

/// Adds the triangles between neighbouring rows of vertices, `columns` pairs from the index `first`
/// on.
fn add_strip(mesh: &mut SceneMesh, first: u32, columns: usize) {
    for column in 0..columns as u32 {
        let at = first + column * 2;
        mesh.add_triangle([at, at + 1, at + 2]);
        mesh.add_triangle([at + 2, at + 1, at + 3]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar of 20 mm with V grooves of 1 mm depth every 2 mm from x = 21 to 39.
    fn grooved_bar() -> Vec<Vec<Vec2>> {
        let mut points = vec![vec2(0.0, 0.0), vec2(60.0, 0.0), vec2(60.0, 10.0)];
        for groove in (0..10).rev() {
            let x = 21.0 + 2.0 * groove as f32;
            points.extend([vec2(x + 0.6, 10.0), vec2(x, 9.0), vec2(x - 0.6, 10.0)]);
        }
        points.push(vec2(0.0, 10.0));
        vec![points]
    }

    fn thread(lead: f32) -> ThreadSurface {
        let lines = grooved_bar();
        let thread = ThreadDescription {
            low: 21.0,
            high: 39.0,
            lead,
            is_internal: false,
        };
        ThreadSurface::from_section(&SectionSampler::new(&lines), &thread).unwrap()
    }

    /// Returns x of the deepest point of the groove near x = 30 mm, at an angle of the part.
    fn root(thread: &ThreadSurface, angle: f32) -> f32 {
        let x = (0..2000).map(|at| 29.0 + at as f32 * 0.001);
        x.min_by(|a, b| {
            thread
                .radius(*a, angle)
                .total_cmp(&thread.radius(*b, angle))
        })
        .unwrap()
    }

    #[test]
    fn a_groove_moves_one_lead_per_turn_to_the_side_of_its_hand() {
        // A negative lead is a right-hand thread: x grows with a positive turn about x.
        for (lead, sign) in [(-2.0, 1.0), (2.0, -1.0)] {
            let thread = thread(lead);
            for quarter in 0..4 {
                let angle = TAU * quarter as f32 / 4.0;
                let moved =
                    (root(&thread, angle) - 29.0 - sign * 0.5 * quarter as f32).rem_euclid(2.0);
                assert!(moved.min(2.0 - moved) < 0.02, "{lead} {quarter}: {moved}");
                assert!((thread.radius(root(&thread, angle), angle) - 9.0).abs() < 0.02);
            }
        }
    }

    #[test]
    fn the_drawn_plane_shows_the_half_section() {
        let (lines, thread) = (grooved_bar(), thread(-2.0));
        let section = SectionSampler::new(&lines);
        for at in 0..400 {
            let x = 20.5 + at as f32 * 0.0475;
            let (_, expected) = section.radii(x).unwrap();
            assert!((thread.radius(x, 0.0) - expected).abs() < 0.02, "{x}");
        }
    }

    #[test]
    fn two_starts_have_two_grooves_per_lead() {
        let thread = thread(-4.0);
        assert!((thread.radius(29.0, 0.0) - 9.0).abs() < 0.03);
        assert!((thread.radius(30.0, TAU / 4.0) - 9.0).abs() < 0.03);
        assert!(thread.radius(29.0, TAU / 4.0) > 9.9);
    }

    #[test]
    fn the_mesh_is_within_the_part_and_bounded() {
        let thread = thread(-2.0);
        for sweep in [[0.0, TAU], [TAU * 0.375, TAU * 0.75]] {
            let mut mesh = SceneMesh::default();
            thread.add_to(&mut mesh, sweep);
            assert!(mesh.triangle_count() > 1000 && mesh.triangle_count() < 20_000);
            for vertex in &mesh.vertices {
                let at = vertex.position;
                let radius = at.y.hypot(at.z);
                assert!(at.x >= thread.low - 1e-3 && at.x <= thread.high + 1e-3);
                assert!(radius > 8.98 && radius < 10.02, "{at}");
            }
            crate::mesh::checks::assert_unit_normals(&mesh);
        }
    }

    #[test]
    fn a_chamfer_and_a_wide_relief_do_not_turn() {
        let samples: Vec<f32> = (0..200)
            .map(|at| match at {
                60..100 => 5.0,
                180.. => 10.0 - (at - 180) as f32 * 0.2,
                _ => 10.0,
            })
            .collect();
        assert_eq!(close_grooves(&samples, 20), samples);
    }

    #[test]
    fn without_a_part_or_a_lead_there_is_no_thread() {
        let lines = grooved_bar();
        for (low, high, lead) in [(100.0, 130.0, 2.0), (21.0, 39.0, 0.0), (f32::NAN, 3.0, 1.0)] {
            let thread = ThreadDescription {
                low,
                high,
                lead,
                is_internal: false,
            };
            let section = SectionSampler::new(&lines);
            assert_eq!(ThreadSurface::from_section(&section, &thread), None);
        }
    }
}
