//! Makes the bodies in the lathe: the part, its clamping, and the tools.

use core::f32::consts::TAU;

use gsk_workpiece::grid::{GridContour, GridPoint, from_grid};
use gsk_workpiece::region::{GridBounds, Region};
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::{BodyPart, Holder, Insert, Tool, ToolShape};

use super::body::{SectionPlane, SolidBody, TurnArc};
use super::finish::SurfaceFinish;
use super::profile::{self, ProfileEdge};

/// Greatest distance of a chord from the arc that it approximates, pixels.
const MAX_CHORD_ERROR_PX: f32 = 0.2;
/// Least and greatest number of flat sides that approximate a turn.
const SIDE_LIMITS: (f32, f32) = (36.0, 144.0);
/// Maximum number of surfaces of a part. A part with more surfaces gets a coarser outline.
const MAX_SURFACES: usize = 60_000;
/// Ratio of the width of a jaw to the radius of the chuck.
const JAW_WIDTH_RATIO: f32 = 0.5;
/// Extent of an insert, a holder and a turret across the plane of the tools (Y), mm. They are
/// on the far side of the plane, where they hide nothing, and only slightly in front of it, so
/// that they are visible inside the part.
const INSERT_RANGE_MM: (f32, f32) = (-4.8, 0.02);
const HOLDER_RANGE_MM: (f32, f32) = (-20.0, 0.01);
const TURRET_RANGE_MM: (f32, f32) = (-60.0, 0.01);

/// The tolerances with which bodies are approximated, so that no step is visible at a scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyResolution {
    /// Greatest deviation of a drawn surface from the exact one, mm.
    tolerance_mm: f32,
}

impl BodyResolution {
    /// Creates the resolution for a scale in pixels per millimetre. It changes with each
    /// doubling of the scale.
    pub fn for_scale(scale: f32) -> Self {
        let mut tolerance_mm = 4.0;
        while tolerance_mm * scale > MAX_CHORD_ERROR_PX && tolerance_mm > 1e-4 {
            tolerance_mm /= 2.0;
        }
        Self { tolerance_mm }
    }

    /// Number of flat sides that approximate a whole turn of `radius`, mm; a multiple of 4.
    fn side_count(self, radius: f32) -> u16 {
        // 1 − cos(π / sides) is about (π / sides)² / 2.
        let sides = TAU / 2.0 * (radius.max(0.0) / (2.0 * self.tolerance_mm)).sqrt();
        let sides = sides.clamp(SIDE_LIMITS.0, SIDE_LIMITS.1) as u16;
        sides.div_ceil(4) * 4
    }
}

/// Creates the bodies of the part from half sections: cut surfaces, uncut surfaces of the
/// stock, and faces of the cut-out quarter.
///
/// A thread is drawn as the rings of its half section. At the size of a screen they look like
/// a thread, and a helix would be another solid than the section.
pub fn part_bodies(section: &Region, stock: &Region, fineness: BodyResolution) -> [SolidBody; 3] {
    let radius = section.bounds().map_or(0.0, |it| max_radius(&it));
    let sides = fineness.side_count(radius);
    let mut tolerance = fineness.tolerance_mm;
    let mut edges = profile::region_edges(section, tolerance);
    while edges.len() * usize::from(sides) > MAX_SURFACES && tolerance < 1.0 {
        tolerance *= 2.0;
        edges = profile::region_edges(section, tolerance);
    }
    let outline = profile::region_lines(stock);
    let (skin, fresh): (Vec<ProfileEdge>, Vec<ProfileEdge>) =
        edges.into_iter().partition(|edge| edge.is_on(&outline));
    let arc = TurnArc::three_quarters(sides);
    let [mut cut, mut rough, mut faces] = [
        SurfaceFinish::CUT,
        SurfaceFinish::SKIN,
        SurfaceFinish::SECTION,
    ]
    .map(SolidBody::new);
    cut.add_turned(&fresh, arc);
    rough.add_turned(&skin, arc);
    faces.add_section(section, SectionPlane::X);
    faces.add_section(section, SectionPlane::Y);
    [cut, rough, faces]
}

/// Creates the bodies of chuck, jaws and tailstock. `open` opens the jaws of a power chuck.
pub fn clamping_bodies(stock: &Stock, open: bool, fineness: BodyResolution) -> Vec<SolidBody> {
    let (chuck, jaws) = stock.chuck_section();
    let jaws = if open { stock.open_jaws() } else { jaws };
    // The bar extends into the chuck.
    let chuck = chuck.difference(stock.section().contours());
    let sides = fineness.side_count(chuck.bounds().map_or(0.0, |it| max_radius(&it)));
    let mut body = SolidBody::new(SurfaceFinish::CHUCK);
    let edges = profile::region_edges(&chuck, fineness.tolerance_mm);
    body.add_turned(&edges, TurnArc::three_quarters(sides));
    let mut face = SolidBody::new(SurfaceFinish::CHUCK_SECTION);
    face.add_section(&chuck, SectionPlane::X);
    face.add_section(&chuck, SectionPlane::Y);
    let mut bodies = vec![body, face];
    let mut teeth = SolidBody::new(SurfaceFinish::JAWS);
    let half = JAW_WIDTH_RATIO * stock.chuck.diameter.radius() as f32 / 2.0;
    for contour in jaws.contours() {
        // One jaw is in the plane of the tools, and is cut by it.
        teeth.extrude(contour, (-half, 0.0), 0.0, fineness.tolerance_mm);
        for third in [1.0, 2.0] {
            let angle = TAU / 3.0 * third;
            teeth.extrude(contour, (-half, half), angle, fineness.tolerance_mm);
        }
    }
    bodies.push(teeth);
    let tailstock = stock.tailstock_section();
    if let Some(bounds) = tailstock.bounds() {
        let mut body = SolidBody::new(SurfaceFinish::TAILSTOCK);
        let edges = profile::region_edges(&tailstock, fineness.tolerance_mm);
        body.add_turned(
            &edges,
            TurnArc::full_turn(fineness.side_count(max_radius(&bounds))),
        );
        bodies.push(body);
    }
    bodies
}

/// Creates the bodies of a tool with its tip at Z 0 and X 0. Its cutting face is in the plane
/// of the section.
pub fn tool_bodies(tool: &Tool, fineness: BodyResolution) -> Vec<SolidBody> {
    let shape = ToolShape::from_tool(tool);
    let [mut gold, mut steel, mut turret] = [
        SurfaceFinish::INSERT,
        SurfaceFinish::HOLDER,
        SurfaceFinish::TURRET,
    ]
    .map(SolidBody::new);
    let tolerance = fineness.tolerance_mm;
    for (part, contour) in &shape.body {
        match (part, tool.holder) {
            (BodyPart::InsertBack, _) => {
                gold.extrude(contour, INSERT_RANGE_MM, 0.0, tolerance);
            }
            (BodyPart::Turret, _) => turret.extrude(contour, TURRET_RANGE_MM, 0.0, tolerance),
            (BodyPart::Holder, Holder::Bar { .. }) => add_round_bar(&mut steel, contour, fineness),
            (BodyPart::Holder, _) => {
                steel.extrude(contour, HOLDER_RANGE_MM, 0.0, tolerance);
            }
        }
    }
    match tool.insert {
        Insert::Drill { .. } => add_round_bar(&mut gold, &shape.cutting, fineness),
        _ => gold.extrude(&shape.cutting, INSERT_RANGE_MM, 0.0, tolerance),
    }
    vec![gold, steel, turret]
}

/// Adds a round bar parallel to Z. `contour` is the outline of its section along its own axis;
/// its upper half is turned about that axis.
fn add_round_bar(body: &mut SolidBody, contour: &GridContour, fineness: BodyResolution) {
    let Some(GridBounds { low, high }) = GridBounds::from_points(contour) else {
        return;
    };
    let middle = low.y.midpoint(high.y);
    let lowered: GridContour = contour
        .iter()
        .map(|point| GridPoint::new(point.x, point.y.saturating_sub(middle)))
        .collect();
    let upper = Region::rectangle(
        GridPoint::new(low.x.saturating_sub(1), 0),
        GridPoint::new(
            high.x.saturating_add(1),
            high.y.saturating_sub(middle).max(1),
        ),
    );
    let half = upper.intersection(&[lowered]);
    let first = body.vertices.len();
    let radius = half.bounds().map_or(0.0, |it| max_radius(&it));
    let edges = profile::region_edges(&half, fineness.tolerance_mm);
    body.add_turned(&edges, TurnArc::full_turn(fineness.side_count(radius)));
    let by = from_grid(GridPoint::new(0, middle)).x as f32;
    for vertex in body.vertices.iter_mut().skip(first) {
        vertex.position.y += by;
    }
}

/// Returns the greatest radius in a box, mm.
fn max_radius(bounds: &GridBounds) -> f32 {
    from_grid(bounds.high).x as f32
}
