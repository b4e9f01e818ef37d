//! What stands behind a path: the part, the stock it was, chuck and tailstock, and marks
//! where something was hit.

use std::collections::BTreeMap;

use gsk_core::units::Point;
use gsk_workpiece::grid::{GridContour, from_grid, to_grid};
use gsk_workpiece::region::Region;
use gsk_workpiece::tool::{BodyPart, Tool, ToolShape};

use super::dimensions::Dimensions;
use super::pens::Pen;
use crate::machining::Machining;

/// How an area is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    /// Colour of its inside, if it has one.
    pub fill: Option<[u8; 3]>,
    /// Its edge.
    pub edge: Pen,
}

const CLAMPING: Look = Look {
    fill: Some([0xC8; 3]),
    edge: edge([0x90; 3], &[]),
};
const PART: Look = Look {
    fill: Some([0xDC, 0xE6, 0xF0]),
    edge: edge([0x60, 0x70, 0x80], &[]),
};
const STOCK: Look = Look {
    fill: None,
    edge: edge([0xA0; 3], &[6.0, 4.0]),
};

const HOLDER: Look = Look {
    fill: Some([0xE4; 3]),
    edge: edge([0xA0; 3], &[]),
};
const INSERT: Look = Look {
    fill: Some([0xF5, 0xD8, 0x60]),
    edge: edge([0x80, 0x68, 0x10], &[]),
};

const fn edge(color: [u8; 3], dash: &'static [f32]) -> Pen {
    Pen {
        color,
        width: 1.0,
        dash,
    }
}

/// Part and clamping, in the coordinates of the path.
#[derive(Clone, Debug, Default)]
pub(super) struct Scenery {
    areas: Vec<(Look, Region)>,
    /// The tools of the job, by their T number.
    pub tools: BTreeMap<u8, Tool>,
    pub dimensions: Dimensions,
    /// Where something was hit.
    pub marks: Vec<Point>,
}

impl Scenery {
    /// Of a part as it is now, with tools whose tips are somewhere.
    pub fn of(machining: &Machining, tips: Vec<(u8, Point)>, dimensions: bool) -> Self {
        let scene = machining.scene();
        let stock = scene.stock();
        let (chuck, jaws) = stock.chuck_section();
        let section = scene.part().section();
        let mut areas = vec![
            (CLAMPING, chuck),
            (CLAMPING, jaws),
            (CLAMPING, stock.tailstock_section()),
            (PART, section.clone()),
            (STOCK, stock.section()),
        ];
        let tools = &machining.job().tools;
        for (number, tip) in tips {
            areas.extend(tools.get(&number).into_iter().flat_map(|it| drawn(it, tip)));
        }
        let marks = machining.findings().iter();
        Self {
            areas,
            tools: tools.clone(),
            dimensions: match dimensions {
                true => Dimensions::of(&section),
                false => Dimensions::default(),
            },
            marks: marks.map(|finding| finding.collision.contact).collect(),
        }
    }

    /// The areas as far as they lie between two points: polygons without overlap, holes
    /// the other way round.
    pub fn within(
        &self,
        low: Point,
        high: Point,
    ) -> impl Iterator<Item = (Look, Vec<Vec<Point>>)> + '_ {
        let window = Region::rectangle(to_grid(low), to_grid(high));
        self.areas.iter().map(move |(look, region)| {
            let shown = region.intersection(window.contours());
            let points = |contour: &Vec<_>| contour.iter().map(|it| from_grid(*it)).collect();
            (*look, shown.contours().iter().map(points).collect())
        })
    }
}

/// Holder and insert of a tool.
fn drawn(tool: &Tool, tip: Point) -> Vec<(Look, Region)> {
    let shape = ToolShape::from_tool(tool);
    let placed = |contour: &GridContour| {
        let points = contour.iter().map(|at| to_grid(from_grid(*at) + tip));
        Region::from_contours(&[points.collect()])
    };
    // The insert lies on its holder; the turret would hide the part.
    let mut areas = Vec::new();
    for (wanted, look) in [(BodyPart::Holder, HOLDER), (BodyPart::InsertBack, INSERT)] {
        let parts = shape.body.iter().filter(|(part, _)| *part == wanted);
        areas.extend(parts.map(|(_, contour)| (look, placed(contour))));
    }
    areas.push((INSERT, placed(&shape.cutting)));
    areas
}
