//! What stands in the lathe, as bodies: the part, what clamps it, and the tools.

use core::f32::consts::TAU;

use gsk_workpiece::grid::{GridContour, GridPoint, from_grid};
use gsk_workpiece::region::{GridBounds, Region};
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::{BodyPart, Holder, Insert, Tool, ToolShape};

use super::body::{Arc, Body, Half};
use super::finish::Finish;
use super::profile::{self, Edge};

/// How far a chord may lie beside its arc, pixels.
const OFF: f32 = 0.2;
/// Flat sides of a turn, least and most.
const SIDES: (f32, f32) = (36.0, 144.0);
/// Surfaces of a part at most: beyond that its outline is made coarser.
const MOST: usize = 60_000;
/// Width of a jaw, share of the chuck's radius.
const JAW: f32 = 0.5;
/// From where to where an insert, a holder and a turret lie across the plane of the tools,
/// mm: behind it, where they hide nothing, but so little in front of it that they are seen
/// where they stand in the part.
const INSERT: (f32, f32) = (-4.8, 0.02);
const HOLDER: (f32, f32) = (-20.0, 0.01);
const TURRET: (f32, f32) = (-60.0, 0.01);

/// How fine a body is made: as fine as it is seen at a scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// How far a surface may be off, mm.
    tolerance: f32,
}

impl Fineness {
    /// For a scale, pixels a millimetre; it changes with each doubling of it.
    pub fn of(scale: f32) -> Self {
        let mut tolerance = 4.0;
        while tolerance * scale > OFF && tolerance > 1e-4 {
            tolerance /= 2.0;
        }
        Self { tolerance }
    }

    /// Flat sides of a whole turn of a radius, mm; a multiple of 4.
    fn sides(self, radius: f32) -> u16 {
        // 1 − cos(π / sides) is about (π / sides)² / 2.
        let sides = TAU / 2.0 * (radius.max(0.0) / (2.0 * self.tolerance)).sqrt();
        let sides = sides.clamp(SIDES.0, SIDES.1) as u16;
        sides.div_ceil(4) * 4
    }
}

/// The part: surfaces that were cut, those of the stock, and the faces of the quarter.
///
/// A thread is drawn as the rings that its half section makes: at the size of a screen
/// they look like the thread, and a helix would be another solid than the section.
pub fn part(section: &Region, stock: &Region, fineness: Fineness) -> [Body; 3] {
    let radius = section.bounds().map_or(0.0, |it| reach(&it));
    let sides = fineness.sides(radius);
    let mut tolerance = fineness.tolerance;
    let mut edges = profile::edges(section, tolerance);
    while edges.len() * usize::from(sides) > MOST && tolerance < 1.0 {
        tolerance *= 2.0;
        edges = profile::edges(section, tolerance);
    }
    let outline = profile::lines(stock);
    let (skin, fresh): (Vec<Edge>, Vec<Edge>) =
        edges.into_iter().partition(|edge| edge.lies_on(&outline));
    let arc = Arc::three_quarters(sides);
    let [mut cut, mut rough, mut faces] =
        [Finish::CUT, Finish::SKIN, Finish::SECTION].map(Body::new);
    cut.turn(&fresh, arc);
    rough.turn(&skin, arc);
    faces.section(section, Half::X);
    faces.section(section, Half::Y);
    [cut, rough, faces]
}

/// Chuck, jaws and tailstock; `open`: a power chuck has let the stock go.
pub fn clamping(stock: &Stock, open: bool, fineness: Fineness) -> Vec<Body> {
    let (chuck, jaws) = stock.chuck_section();
    let jaws = if open { stock.open_jaws() } else { jaws };
    // The bar goes into the chuck.
    let chuck = chuck.difference(stock.section().contours());
    let sides = fineness.sides(chuck.bounds().map_or(0.0, |it| reach(&it)));
    let mut body = Body::new(Finish::CHUCK);
    let edges = profile::edges(&chuck, fineness.tolerance);
    body.turn(&edges, Arc::three_quarters(sides));
    let mut face = Body::new(Finish::CHUCK_SECTION);
    face.section(&chuck, Half::X);
    face.section(&chuck, Half::Y);
    let mut bodies = vec![body, face];
    let mut teeth = Body::new(Finish::JAWS);
    let half = JAW * stock.chuck.diameter.radius() as f32 / 2.0;
    for contour in jaws.contours() {
        // One stands in the plane of the tools, and is cut by it.
        teeth.draw_out(contour, (-half, 0.0), 0.0, fineness.tolerance);
        for third in [1.0, 2.0] {
            let angle = TAU / 3.0 * third;
            teeth.draw_out(contour, (-half, half), angle, fineness.tolerance);
        }
    }
    bodies.push(teeth);
    let tailstock = stock.tailstock_section();
    if let Some(bounds) = tailstock.bounds() {
        let mut body = Body::new(Finish::TAILSTOCK);
        let edges = profile::edges(&tailstock, fineness.tolerance);
        body.turn(&edges, Arc::whole(fineness.sides(reach(&bounds))));
        bodies.push(body);
    }
    bodies
}

/// A tool, its tip at the zero: its cutting face lies in the plane of the section.
pub fn tool(tool: &Tool, fineness: Fineness) -> Vec<Body> {
    let shape = ToolShape::from_tool(tool);
    let [mut gold, mut steel, mut turret] =
        [Finish::INSERT, Finish::HOLDER, Finish::TURRET].map(Body::new);
    let tolerance = fineness.tolerance;
    for (part, contour) in &shape.body {
        match (part, tool.holder) {
            (BodyPart::InsertBack, _) => {
                gold.draw_out(contour, INSERT, 0.0, tolerance);
            }
            (BodyPart::Turret, _) => turret.draw_out(contour, TURRET, 0.0, tolerance),
            (BodyPart::Holder, Holder::Bar { .. }) => round(&mut steel, contour, fineness),
            (BodyPart::Holder, _) => {
                steel.draw_out(contour, HOLDER, 0.0, tolerance);
            }
        }
    }
    match tool.insert {
        Insert::Drill { .. } => round(&mut gold, &shape.cutting, fineness),
        _ => gold.draw_out(&shape.cutting, INSERT, 0.0, tolerance),
    }
    vec![gold, steel, turret]
}

/// A round bar along Z of which a polygon is the outline, turned about its own middle.
fn round(body: &mut Body, contour: &GridContour, fineness: Fineness) {
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
    let radius = half.bounds().map_or(0.0, |it| reach(&it));
    let edges = profile::edges(&half, fineness.tolerance);
    body.turn(&edges, Arc::whole(fineness.sides(radius)));
    let by = from_grid(GridPoint::new(0, middle)).x as f32;
    for vertex in body.vertices.iter_mut().skip(first) {
        vertex.at.y += by;
    }
}

/// The greatest radius in a box, mm.
fn reach(bounds: &GridBounds) -> f32 {
    from_grid(bounds.high).x as f32
}
