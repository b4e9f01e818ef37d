//! Finds the holes of a mill's path: cuts along one axis between rapids across it.

use gsk_milling::MillMoveKind;

/// A hole of the path: a cut along one axis, without a cut across it at its bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HoleMark {
    /// A point on the axis of the hole, mm.
    pub(super) point: [f64; 3],
    /// Index of the axis along the hole: 0 to 2 for X, Y, Z.
    pub(super) along: usize,
    /// Index of the tool in the legend.
    pub(super) tool: u8,
}

/// The holes found so far.
#[derive(Clone, Debug, Default)]
pub(super) struct HoleFinder {
    holes: Vec<HoleMark>,
    /// The last cut along one axis, while the tool has not left that axis.
    open: Option<HoleMark>,
}

/// Returns the only axis along which a move goes; `None` if it goes along several or none.
fn only_axis(from: [f64; 3], to: [f64; 3]) -> Option<usize> {
    let mut moved = (0..3).filter(|axis| from[*axis] != to[*axis]);
    moved.next().filter(|_| moved.next().is_none())
}

impl HoleFinder {
    /// Follows a move from `from` to `to`, mm, with the tool of this index in the legend.
    pub(super) fn follow(
        &mut self,
        kind: MillMoveKind,
        (from, to): ([f64; 3], [f64; 3]),
        tool: u8,
    ) {
        let axis = only_axis(from, to);
        if let Some(open) = self.open {
            if axis == Some(open.along) {
                return;
            }
            // A rapid across the hole leaves it. A cut across it makes it the start of a pocket.
            if kind == MillMoveKind::Rapid {
                self.holes.push(open);
            }
            self.open = None;
        }
        let drills = matches!(kind, MillMoveKind::Feed | MillMoveKind::Tap);
        if let Some(along) = axis.filter(|axis| drills && to[*axis] < from[*axis]) {
            self.open = Some(HoleMark {
                point: to,
                along,
                tool,
            });
        }
    }

    /// Returns the holes, also the last one.
    pub(super) fn marks(&self) -> impl Iterator<Item = HoleMark> + '_ {
        self.holes.iter().copied().chain(self.open)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holes(path: &[(MillMoveKind, [f64; 3])]) -> Vec<[f64; 3]> {
        let mut finder = HoleFinder::default();
        let mut from = [0.0, 0.0, 5.0];
        for (kind, to) in path {
            finder.follow(*kind, (from, *to), 0);
            from = *to;
        }
        finder.marks().map(|mark| mark.point).collect()
    }

    #[test]
    fn a_hole_is_a_cut_between_rapids() {
        use MillMoveKind::{Feed, Rapid, Tap};
        let pecks = [
            (Rapid, [10.0, 0.0, 5.0]),
            (Feed, [10.0, 0.0, -2.0]),
            (Rapid, [10.0, 0.0, 2.0]),
            (Feed, [10.0, 0.0, -4.0]),
            (Rapid, [10.0, 0.0, 5.0]),
            (Rapid, [20.0, 0.0, 5.0]),
            (Tap, [20.0, 0.0, -4.0]),
        ];
        assert_eq!(holes(&pecks), [[10.0, 0.0, -2.0], [20.0, 0.0, -4.0]]);
    }

    #[test]
    fn a_pocket_and_a_way_out_are_no_holes() {
        use MillMoveKind::{Feed, Rapid};
        let pocket = [
            (Feed, [0.0, 0.0, -3.0]),
            (Feed, [20.0, 0.0, -3.0]),
            (Feed, [20.0, 0.0, 5.0]),
            (Rapid, [0.0, 0.0, 5.0]),
        ];
        assert!(holes(&pocket).is_empty());
    }
}
