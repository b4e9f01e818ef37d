//! What stands behind a path: the part, the stock it was, chuck and tailstock, and marks
//! where something was hit.

use gsk_core::units::Point;
use gsk_workpiece::grid::{from_grid, to_grid};
use gsk_workpiece::region::Region;

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

const fn edge(color: [u8; 3], dash: &'static [f32]) -> Pen {
    Pen {
        color,
        width: 1.0,
        dash,
    }
}

/// Part and clamping, in the coordinates of the path.
#[derive(Clone, Debug, Default)]
pub struct Scenery {
    areas: Vec<(Look, Region)>,
    /// Where something was hit.
    pub(super) marks: Vec<Point>,
}

impl Scenery {
    /// Of a part as it is now.
    pub fn of(machining: &Machining) -> Self {
        let scene = machining.scene();
        let stock = scene.stock();
        let (chuck, jaws) = stock.chuck_section();
        let areas = vec![
            (CLAMPING, chuck),
            (CLAMPING, jaws),
            (CLAMPING, stock.tailstock_section()),
            (PART, scene.part().section()),
            (STOCK, stock.section()),
        ];
        let marks = machining.findings().iter();
        Self {
            areas,
            marks: marks.map(|finding| finding.collision.contact).collect(),
        }
    }

    /// The areas as far as they lie between two points: polygons without overlap, holes
    /// the other way round.
    pub(super) fn within(
        &self,
        low: Point,
        high: Point,
    ) -> impl Iterator<Item = (Look, Vec<Vec<Point>>)> + '_ {
        let window = Region::rectangle(to_grid(low), to_grid(high));
        self.areas.iter().map(move |(look, region)| {
            let shown = region.common(window.contours());
            let points = |contour: &Vec<_>| contour.iter().map(|it| from_grid(*it)).collect();
            (*look, shown.contours().iter().map(points).collect())
        })
    }
}
