//! Motion of a tool's tip as the part sees it.

use gsk_units::{Axis, Point};

use crate::curve::Arc;
use crate::grid::{GridPoint, to_grid};

/// A piece of motion, part coordinates (X a radius, mm).
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Where it begins.
    pub from: Point,
    /// Where it ends.
    pub to: Point,
    /// What kind of motion it is.
    pub kind: Kind,
    /// Whether the spindle turns.
    pub turning: bool,
}

/// Kinds of motion.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A rapid, straight.
    Rapid,
    /// A straight cut.
    Line,
    /// A circular cut.
    Arc {
        /// Its centre.
        center: Point,
        /// Clockwise, Z to the right and X up.
        clockwise: bool,
    },
    /// A cut tied to the spindle: the tool passes the drawn half plane once a turn, in
    /// these positions.
    Thread(Vec<Point>),
}

impl Motion {
    /// Its straight pieces on the grid.
    pub(crate) fn path(&self) -> Vec<GridPoint> {
        self.points().into_iter().map(to_grid).collect()
    }

    /// Its straight pieces, from point to point.
    fn points(&self) -> Vec<Point> {
        match &self.kind {
            Kind::Rapid | Kind::Line | Kind::Thread(_) => vec![self.from, self.to],
            Kind::Arc { center, clockwise } => {
                let arc = Arc::between(self.from, self.to, *center, *clockwise);
                let mut points: Vec<Point> = arc.points().collect();
                // The ends as programmed, without the rounding of sine and cosine.
                if let [first, .., last] = &mut points[..] {
                    *first = self.from;
                    *last = self.to;
                }
                points
            }
        }
    }
}

/// A thread that follows the angle of the spindle.
///
/// ```text
///   way = lead · n + increase · n² / 2      n: turns from its start
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadPath {
    /// Where it begins.
    pub from: Point,
    /// Where it ends.
    pub to: Point,
    /// The axis its lead counts on.
    pub long: Axis,
    /// mm per turn at its start; X as a radius.
    pub lead: f64,
    /// mm per turn and turn.
    pub increase: f64,
    /// Angle of the spindle at its start, turns after the drawn plane.
    pub phase: f64,
}

/// Imprints of a thread at most: the pitch of a hair on the longest part.
const MOST_IMPRINTS: u32 = 100_000;

impl ThreadPath {
    /// Where the tool passes the drawn half plane, and the angle of the spindle at the
    /// end, turns.
    pub fn imprints(&self) -> (Vec<Point>, f64) {
        let displacement = self.to - self.from;
        let along = displacement.get(self.long).abs();
        let length = if along > 0.0 {
            along
        } else {
            displacement.length()
        };
        let lead = self.lead.abs();
        if length <= 0.0 || lead <= 0.0 {
            return (Vec::new(), self.phase);
        }
        let turns = self.turns(length, lead);
        let first = libm::ceil(self.phase - 1e-9);
        let imprints = (0..MOST_IMPRINTS)
            .map(|count| first + f64::from(count) - self.phase)
            .take_while(|n| *n <= turns + 1e-9)
            .map(|n| {
                let way = lead * n + self.increase * n * n / 2.0;
                self.from + displacement * (way / length).clamp(0.0, 1.0)
            })
            .collect();
        (imprints, self.phase + turns)
    }

    /// Turns for a way along the long axis.
    fn turns(&self, way: f64, lead: f64) -> f64 {
        if self.increase == 0.0 {
            return way / lead;
        }
        let root = lead * lead + 2.0 * self.increase * way;
        if root <= 0.0 {
            // A falling lead is used up on the way.
            return lead / self.increase.abs();
        }
        (libm::sqrt(root) - lead) / self.increase
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thread(lead: f64, increase: f64, phase: f64) -> ThreadPath {
        ThreadPath {
            from: Point::new(10.0, 5.0),
            to: Point::new(10.0, -20.0),
            long: Axis::Z,
            lead,
            increase,
            phase,
        }
    }

    #[test]
    fn a_thread_passes_the_plane_once_a_lead() {
        let (imprints, phase) = thread(2.0, 0.0, 0.0).imprints();
        assert_eq!(imprints.len(), 13);
        assert!((phase - 12.5).abs() < 1e-12);
        for (index, point) in imprints.iter().enumerate() {
            assert!((point.z - (5.0 - 2.0 * index as f64)).abs() < 1e-12);
        }
        // A second start, half a turn later.
        let (second, _) = thread(2.0, 0.0, 0.5).imprints();
        assert!((second[0].z - 4.0).abs() < 1e-12);
    }

    #[test]
    fn a_lead_that_grows_parts_the_passes() {
        let (imprints, _) = thread(2.0, 0.5, 0.0).imprints();
        let ways: Vec<f64> = imprints.iter().map(|point| 5.0 - point.z).collect();
        assert!((ways[1] - 2.25).abs() < 1e-12 && (ways[2] - 5.0).abs() < 1e-12);
    }

    #[test]
    fn a_lead_that_falls_to_nothing_ends() {
        let (imprints, phase) = thread(2.0, -0.5, 0.0).imprints();
        assert!(imprints.len() <= 5 && phase <= 4.0 + 1e-9);
    }
}
