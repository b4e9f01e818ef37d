//! Moves of a tool relative to the part.

use gsk_units::{Axis, Point};

use crate::curve::PlaneArc;
use crate::grid::{GridPoint, to_grid};

/// One move of the imaginary tip. Points are in part coordinates, mm; X is a radius.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolMotion {
    /// Position of the imaginary tip at the start, mm.
    pub from: Point,
    /// Position of the imaginary tip at the end, mm.
    pub to: Point,
    /// The path from start to end: rapid, line, arc or thread.
    pub kind: MotionKind,
    /// Whether the spindle turns during the move.
    pub turning: bool,
    /// Whether the operator moves the slides by hand: then a tool that already overlaps an obstacle
    /// may move out of it.
    pub by_hand: bool,
}

/// The path of a move: rapid, line, arc or thread. A rapid must not cut.
#[derive(Clone, Debug, PartialEq)]
pub enum MotionKind {
    /// A straight rapid, which must not cut.
    Rapid,
    /// A straight feed move.
    Line,
    /// A circular feed move.
    Arc {
        /// The centre of the arc, mm.
        center: Point,
        /// Whether the arc is clockwise, with Z to the right and X upwards.
        clockwise: bool,
    },
    /// A thread pass. The tool passes the drawn half plane once per spindle turn, at these tip
    /// positions.
    Thread(Vec<Point>),
}

impl ToolMotion {
    /// Returns the corners of the path in grid units; arcs are split into chords.
    pub(crate) fn path(&self) -> Vec<GridPoint> {
        self.points().into_iter().map(to_grid).collect()
    }

    /// Returns the length of the path, mm; of a thread its straight length.
    pub(crate) fn length(&self) -> f64 {
        match &self.kind {
            MotionKind::Arc { center, clockwise } => {
                let arc = PlaneArc::between(self.from, self.to, *center, *clockwise);
                arc.radius * arc.sweep.abs()
            }
            _ => (self.to - self.from).length(),
        }
    }

    /// Returns the point at a fraction of the path, mm: 0 is its start, 1 its end.
    pub(crate) fn point_at(&self, fraction: f64) -> Point {
        match &self.kind {
            MotionKind::Arc { center, clockwise } => {
                PlaneArc::between(self.from, self.to, *center, *clockwise).point_at(fraction)
            }
            _ => self.from + (self.to - self.from) * fraction,
        }
    }

    /// Returns the corners of the path, mm; arcs are split into chords.
    fn points(&self) -> Vec<Point> {
        match &self.kind {
            MotionKind::Rapid | MotionKind::Line | MotionKind::Thread(_) => {
                vec![self.from, self.to]
            }
            MotionKind::Arc { center, clockwise } => {
                let arc = PlaneArc::between(self.from, self.to, *center, *clockwise);
                let mut points: Vec<Point> = arc.points().collect();
                // Sine and cosine round the end points: put the programmed ones back.
                if let [first, .., last] = &mut points[..] {
                    *first = self.from;
                    *last = self.to;
                }
                points
            }
        }
    }
}

/// A thread pass that follows the angle of the spindle.
///
/// ```text
///   distance = lead · n + lead_change · n² / 2      n: turns from the start
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadPath {
    /// Start point of the thread, mm; X is a radius.
    pub from: Point,
    /// End point of the thread, mm; X is a radius.
    pub to: Point,
    /// The axis along which the lead is measured.
    pub lead_axis: Axis,
    /// The lead at the start, mm per turn; along X as a change of the radius.
    pub lead: f64,
    /// The change of the lead, mm per turn for each turn: 0 for a constant lead.
    pub lead_change: f64,
    /// The angle of the spindle at the start, in turns from the drawn half plane.
    pub phase: f64,
}

/// Maximum number of grooves that one thread pass cuts into the drawn half section.
const MAX_IMPRINTS: u32 = 100_000;

impl ThreadPath {
    /// Computes the imprints: the tip positions at which the tool passes the drawn half plane.
    /// Also returns the angle of the spindle at the end, turns.
    pub fn imprints(&self) -> (Vec<Point>, f64) {
        let displacement = self.to - self.from;
        let along = displacement.get(self.lead_axis).abs();
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
        let imprints = (0..MAX_IMPRINTS)
            .map(|count| first + f64::from(count) - self.phase)
            .take_while(|n| *n <= turns + 1e-9)
            .map(|n| {
                let distance = lead * n + self.lead_change * n * n / 2.0;
                self.from + displacement * (distance / length).clamp(0.0, 1.0)
            })
            .collect();
        (imprints, self.phase + turns)
    }

    /// Number of spindle turns for a distance, mm, along the lead axis, with a lead in mm at
    /// the start.
    fn turns(&self, distance: f64, lead: f64) -> f64 {
        if self.lead_change == 0.0 {
            return distance / lead;
        }
        let radicand = lead * lead + 2.0 * self.lead_change * distance;
        if radicand <= 0.0 {
            // A decreasing lead becomes 0 before the end.
            return lead / self.lead_change.abs();
        }
        (libm::sqrt(radicand) - lead) / self.lead_change
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thread(lead: f64, lead_change: f64, phase: f64) -> ThreadPath {
        ThreadPath {
            from: Point::new(10.0, 5.0),
            to: Point::new(10.0, -20.0),
            lead_axis: Axis::Z,
            lead,
            lead_change,
            phase,
        }
    }

    #[test]
    fn a_constant_lead_gives_one_imprint_per_lead() {
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
    fn an_increasing_lead_spaces_the_imprints_out() {
        let (imprints, _) = thread(2.0, 0.5, 0.0).imprints();
        let distances: Vec<f64> = imprints.iter().map(|point| 5.0 - point.z).collect();
        assert!((distances[1] - 2.25).abs() < 1e-12 && (distances[2] - 5.0).abs() < 1e-12);
    }

    #[test]
    fn a_lead_that_decreases_to_zero_ends_the_thread() {
        let (imprints, phase) = thread(2.0, -0.5, 0.0).imprints();
        assert!(imprints.len() <= 5 && phase <= 4.0 + 1e-9);
    }
}
