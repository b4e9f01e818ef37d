//! What is drawn under a path: the part, the original stock, chuck and tailstock, and marks at
//! collisions.

use std::collections::BTreeMap;

use gsk_core::units::Point;
use gsk_workpiece::grid::{GridContour, from_grid, to_grid};
use gsk_workpiece::region::Region;
use gsk_workpiece::tool::{BodyPart, Tool, ToolShape};

use crate::dimensions::Dimensions;
use crate::pens::LinePen;
use gsk_runner::machining::Machining;

/// How an area is drawn: fill and edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AreaStyle {
    /// Fill colour of the area: red, green, blue; `None` for an area that is not filled.
    pub fill: Option<[u8; 3]>,
    /// Style of the outline of the area.
    pub edge: LinePen,
}

const CLAMPING: AreaStyle = AreaStyle {
    fill: Some([0xC8; 3]),
    edge: edge_pen([0x90; 3], &[]),
};
const PART: AreaStyle = AreaStyle {
    fill: Some([0xDC, 0xE6, 0xF0]),
    edge: edge_pen([0x60, 0x70, 0x80], &[]),
};
const STOCK: AreaStyle = AreaStyle {
    fill: None,
    edge: edge_pen([0xA0; 3], &[6.0, 4.0]),
};

const HOLDER: AreaStyle = AreaStyle {
    fill: Some([0xE4; 3]),
    edge: edge_pen([0xA0; 3], &[]),
};
const INSERT: AreaStyle = AreaStyle {
    fill: Some([0xF5, 0xD8, 0x60]),
    edge: edge_pen([0x80, 0x68, 0x10], &[]),
};

const fn edge_pen(color: [u8; 3], dash: &'static [f32]) -> LinePen {
    LinePen {
        color,
        width: 1.0,
        dash,
    }
}

/// Part, clamping and tools that are drawn under a path, in the coordinates of the path.
#[derive(Clone, Debug, Default)]
pub(super) struct PathScenery {
    areas: Vec<(AreaStyle, Region)>,
    /// The tools of the job, by their T number.
    pub tools: BTreeMap<u8, Tool>,
    pub dimensions: Dimensions,
    /// Points at which collisions are marked, mm.
    pub marks: Vec<Point>,
}

impl PathScenery {
    /// Collects the current part, the clamping, and the tools in `tips` at those tip
    /// positions. `dimensions` adds the dimensions of the part.
    pub fn from_machining(machining: &Machining, tips: Vec<(u8, Point)>, dimensions: bool) -> Self {
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
            areas.extend(
                tools
                    .get(&number)
                    .into_iter()
                    .flat_map(|it| tool_areas(it, tip)),
            );
        }
        let marks = machining.findings().iter();
        Self {
            areas,
            tools: tools.clone(),
            dimensions: match dimensions {
                true => Dimensions::measure(&section),
                false => Dimensions::default(),
            },
            marks: marks.map(|finding| finding.collision.contact).collect(),
        }
    }

    /// The areas clipped to a rectangle, each as polygons without overlap. The corners of
    /// holes go in the opposite direction.
    pub fn clip_to(
        &self,
        low: Point,
        high: Point,
    ) -> impl Iterator<Item = (AreaStyle, Vec<Vec<Point>>)> + '_ {
        let window = Region::rectangle(to_grid(low), to_grid(high));
        self.areas.iter().map(move |(look, region)| {
            let shown = region.intersection(window.contours());
            let points = |contour: &Vec<_>| contour.iter().map(|it| from_grid(*it)).collect();
            (*look, shown.contours().iter().map(points).collect())
        })
    }
}

/// The holder and the insert of a tool with its tip at `tip`, each with its style.
fn tool_areas(tool: &Tool, tip: Point) -> Vec<(AreaStyle, Region)> {
    let shape = ToolShape::from_tool(tool);
    let placed = |contour: &GridContour| {
        let points = contour.iter().map(|at| to_grid(from_grid(*at) + tip));
        Region::from_contours(&[points.collect()])
    };
    // The insert is on top of its holder. The turret would hide the part.
    let mut areas = Vec::new();
    for (wanted, look) in [(BodyPart::Holder, HOLDER), (BodyPart::InsertBack, INSERT)] {
        let parts = shape.body.iter().filter(|(part, _)| *part == wanted);
        areas.extend(parts.map(|(_, contour)| (look, placed(contour))));
    }
    areas.push((INSERT, placed(&shape.cutting)));
    areas
}
