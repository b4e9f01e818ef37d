//! Collects the motion of successive ticks into one straight motion that is cut at once.

use gsk_core::command::SourcePosition;
use gsk_core::units::Point;
use gsk_workpiece::motion::{MotionKind, ToolMotion};

/// Greatest distance of the tip positions after each tick from the straight motion that is cut
/// in their place, mm: one grid unit.
const STRAIGHTNESS_MM: f64 = 0.000_1;
/// Number of ticks after which a pending motion is cut even if it continues, so that a collision
/// is found soon: a rapid and a hand go farther in that time than a cut.
const MAX_PIECE_TICKS: u32 = 25;
/// The same for a cut of a program.
const MAX_CUT_TICKS: u32 = 100;

/// Successive ticks of motion on a straight line under the same conditions, which are cut
/// together.
#[derive(Clone, Debug)]
pub(super) struct PendingCut {
    pub(super) from: Point,
    pub(super) to: Point,
    /// The directions from `from` in which the motion can continue; `None`: any.
    cone: Option<DirectionCone>,
    pub(super) ticks: u32,
    pub(super) conditions: MotionConditions,
    /// Tip positions, in part coordinates, mm, at which the spindle passed the drawn plane in a
    /// thread.
    pub(super) imprints: Vec<Point>,
    /// Turns of the spindle during the motion.
    pub(super) turns: f64,
}

/// The directions of lines from the start of a motion that pass all its tip positions within
/// [`STRAIGHTNESS_MM`].
///
/// ```text
///            left  /
///                 /  . tip
///        start  o  .
///                 \
///            right  \
/// ```
#[derive(Clone, Copy, Debug)]
struct DirectionCone {
    left: Point,
    right: Point,
}

/// Conditions that do not change within one motion, such as tool and spindle state; a change begins
/// a new motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MotionConditions {
    pub(super) tool: u8,
    pub(super) rapid: bool,
    pub(super) thread: bool,
    pub(super) turning: bool,
    pub(super) source: Option<SourcePosition>,
}

impl PendingCut {
    /// Begins a motion at a tip position, mm.
    pub(super) const fn new(from: Point, conditions: MotionConditions) -> Self {
        Self {
            from,
            to: from,
            cone: None,
            ticks: 0,
            conditions,
            imprints: Vec::new(),
            turns: 0.0,
        }
    }

    /// Whether the motion is long enough to be cut although it continues.
    pub(super) const fn is_full(&self) -> bool {
        let MotionConditions {
            rapid,
            thread,
            source,
            ..
        } = &self.conditions;
        let is_cut_of_program = !*rapid && !*thread && source.is_some();
        let most = match is_cut_of_program {
            true => MAX_CUT_TICKS,
            false => MAX_PIECE_TICKS,
        };
        self.ticks >= most
    }

    /// Returns the motion with which the tool cuts the part.
    pub(super) fn motion(&self) -> ToolMotion {
        let kind = match (self.conditions.thread, self.conditions.rapid) {
            (true, _) => MotionKind::Thread(self.imprints.clone()),
            (false, true) => MotionKind::Rapid,
            (false, false) => MotionKind::Line,
        };
        ToolMotion {
            from: self.from,
            to: self.to,
            kind,
            turning: self.conditions.turning,
            by_hand: self.conditions.source.is_none(),
        }
    }

    /// Whether a tick in which the tip moves from `from` to `to`, mm, continues the pending motion
    /// on a straight line.
    pub(super) fn is_continued_by(&self, from: Point, to: Point) -> bool {
        let along = self.to - self.from;
        let is_forward = along == Point::default() || along.dot(to - from) > 0.0;
        let is_straight = (self.cone).is_none_or(|cone| cone.contains(to - self.from));
        from == self.to && is_forward && is_straight
    }

    /// Adds a tick in which the tip moves on to `to`, mm, and the spindle by `turns`.
    pub(super) fn add_tick(&mut self, to: Point, turns: f64) {
        self.to = to;
        self.ticks += 1;
        self.turns += turns;
        if let Some(cone) = DirectionCone::around(to - self.from) {
            self.cone = Some(self.cone.map_or(cone, |before| before.narrowed_by(cone)));
        }
    }
}

impl DirectionCone {
    /// The directions that pass a position within [`STRAIGHTNESS_MM`]; `None` for a position so
    /// near to the start that all do.
    fn around(position: Point) -> Option<Self> {
        let aside = position.unit()?.left() * STRAIGHTNESS_MM;
        (position.length() > STRAIGHTNESS_MM).then(|| Self {
            left: position + aside,
            right: position - aside,
        })
    }

    fn contains(self, direction: Point) -> bool {
        self.right.cross(direction) >= 0.0 && direction.cross(self.left) >= 0.0
    }

    /// The directions that are in both cones, if there are any.
    fn narrowed_by(self, other: Self) -> Self {
        Self {
            left: if self.left.cross(other.left) < 0.0 {
                other.left
            } else {
                self.left
            },
            right: if self.right.cross(other.right) > 0.0 {
                other.right
            } else {
                self.right
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tip positions of an arc of radius 10 mm with a piece for each straight motion.
    fn pieces_of_an_arc(step_mm: f64) -> Vec<Vec<Point>> {
        let conditions = MotionConditions {
            tool: 1,
            rapid: false,
            thread: false,
            turning: true,
            source: None,
        };
        let at = |tick: u32| {
            let angle = f64::from(tick) * step_mm / 10.0;
            Point::new(10.0 * libm::sin(angle), 10.0 * libm::cos(angle))
        };
        let mut pieces = vec![vec![at(0)]];
        let mut pending = PendingCut::new(at(0), conditions);
        for tick in 0..2000 {
            let (from, to) = (at(tick), at(tick + 1));
            if !pending.is_continued_by(from, to) {
                pieces.push(vec![from]);
                pending = PendingCut::new(from, conditions);
            }
            pending.add_tick(to, 0.0);
            pieces.last_mut().expect("a piece").push(to);
        }
        pieces
    }

    #[test]
    fn a_piece_of_an_arc_is_straight_at_every_tick() {
        for step_mm in [0.001, 0.004, 0.02] {
            let pieces = pieces_of_an_arc(step_mm);
            for piece in &pieces {
                let (from, to) = (piece[0], piece[piece.len() - 1]);
                let along = (to - from).unit().expect("a length");
                for tip in piece {
                    let off = along.cross(*tip - from).abs();
                    assert!(off <= 1.001 * STRAIGHTNESS_MM, "{off} mm");
                }
            }
            // The arc leaves the line of a chord after about 0.06 mm.
            let length = 2000.0 * step_mm / pieces.len() as f64;
            assert!(length > 0.05 || step_mm > 0.01, "{length} mm");
        }
    }
}
