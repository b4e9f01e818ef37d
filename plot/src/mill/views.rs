//! Lays out the four views of a mill's path, each in its frame.

use gsk_messages::{Language, say};

use super::PathBox;
use crate::legend::EDGE;
use crate::number_placement::PictureArea;

/// Gap between views, picture units.
const VIEW_GAP: f64 = 30.0;
/// Space at the side of and below a view for its numbers, picture units.
const SIDE_MARGIN: f64 = 60.0;
const BOTTOM_MARGIN: f64 = 36.0;

/// A direction from which the path of a mill is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MillView {
    /// View from above: X to the right, Y up.
    Xy,
    /// View from the front: X to the right, Z up.
    Xz,
    /// View from the right: Y to the right, Z up.
    Yz,
    /// Isometric view from above, from the front and the left.
    Isometric,
}

impl MillView {
    const ALL: [Self; 4] = [Self::Xy, Self::Isometric, Self::Xz, Self::Yz];

    /// Projects a point, mm, to the plane of the view: right and up, mm.
    fn project(self, [x, y, z]: [f64; 3]) -> (f64, f64) {
        // Half of the root of three.
        const COS_30: f64 = 0.866_025_403_784_438_6;
        match self {
            Self::Xy => (x, y),
            Self::Xz => (x, z),
            Self::Yz => (y, z),
            Self::Isometric => ((x - y) * COS_30, (x + y) * 0.5 + z),
        }
    }

    /// Returns the caption of the view: `XY`, or the word for isometric.
    pub fn name(self, language: Language) -> String {
        match self {
            Self::Xy => "XY".to_owned(),
            Self::Xz => "XZ".to_owned(),
            Self::Yz => "YZ".to_owned(),
            Self::Isometric => say::picture_mill_isometric().text(language),
        }
    }

    /// Indexes of the axes (0 to 2 for X, Y, Z) to the right and up; `None` for the isometric
    /// view.
    pub const fn axes(self) -> Option<[usize; 2]> {
        match self {
            Self::Xy => Some([0, 1]),
            Self::Xz => Some([0, 2]),
            Self::Yz => Some([1, 2]),
            Self::Isometric => None,
        }
    }
}

/// A view and the frame in which it is drawn.
pub struct MillPane {
    /// The direction from which this frame shows the path.
    pub view: MillView,
    /// The frame in picture units: left, top, right, bottom.
    pub frame: PictureArea,
    /// Coordinates, mm, at the left (`left`) and the lower (`bottom`) edge of the frame, and
    /// its scale in picture units per mm.
    left: f64,
    bottom: f64,
    pub(super) units_per_mm: f64,
}

impl MillPane {
    /// Converts a point, mm, to picture units.
    pub fn to_units(&self, point: [f64; 3]) -> (f64, f64) {
        let (right, up) = self.view.project(point);
        let x = self.frame.0 + (right - self.left) * self.units_per_mm;
        (x, self.frame.3 - (up - self.bottom) * self.units_per_mm)
    }
}

/// The range of a box in a view, mm: least and greatest to the right, then least and greatest
/// up.
fn view_range(view: MillView, cube: &PathBox) -> [f64; 4] {
    let seen = cube.corners().map(|corner| view.project(corner));
    seen.iter().fold(
        [f64::MAX, f64::MIN, f64::MAX, f64::MIN],
        |[a, b, c, d], (right, up)| [a.min(*right), b.max(*right), c.min(*up), d.max(*up)],
    )
}

/// Lays out the four views in equal fields below `top`; those along an axis have the same
/// scale.
pub fn lay_out_panes(cube: &PathBox, (wide, tall): (f64, f64), top: f64) -> [MillPane; 4] {
    let room = (
        (wide - 2.0 * SIDE_MARGIN - VIEW_GAP - EDGE).max(80.0) / 2.0,
        (tall - top - 2.0 * BOTTOM_MARGIN - VIEW_GAP).max(80.0) / 2.0,
    );
    let fits = |view: MillView| {
        let [left, right, bottom, up] = view_range(view, cube);
        (room.0 / (right - left)).min(room.1 / (up - bottom))
    };
    let flat = MillView::ALL
        .into_iter()
        .filter(|view| *view != MillView::Isometric);
    let flat = flat.map(fits).fold(f64::MAX, f64::min);
    core::array::from_fn(|index| {
        let view = MillView::ALL[index];
        let (column, row) = (index % 2, index / 2);
        let left = SIDE_MARGIN + column as f64 * (room.0 + SIDE_MARGIN);
        let upper = top + row as f64 * (room.1 + BOTTOM_MARGIN);
        let frame = (left, upper, left + room.0, upper + room.1);
        let scale = if view == MillView::Isometric {
            fits(view)
        } else {
            flat
        };
        let [least, most, bottom, up] = view_range(view, cube);
        MillPane {
            view,
            frame,
            left: (least + most - room.0 / scale) / 2.0,
            bottom: (bottom + up - room.1 / scale) / 2.0,
            units_per_mm: scale,
        }
    })
}
