//! Removes lines that would be drawn over themselves: it marks the half pixels that a pen has
//! covered.
//!
//! A path of micrometres that repeats thousands of times becomes a few lines. A picture has no
//! more pieces than half pixels.

use crate::number_placement::PictureArea;

type FramePoint = (f64, f64);

/// Number of grid cells per pixel along each side.
const CELLS_PER_PIXEL_SIDE: f64 = 2.0;

/// The grid cells of a frame that lines of one style have already covered.
pub(super) struct Coverage {
    /// Upper left corner of the frame.
    corner: FramePoint,
    columns: usize,
    covered: Vec<bool>,
}

impl Coverage {
    /// Creates a frame without covered cells.
    pub(super) fn new(frame: PictureArea) -> Self {
        let cells = |low: f64, high: f64| {
            ((high - low) * CELLS_PER_PIXEL_SIDE).ceil().max(0.0) as usize + 2
        };
        let (left, top, right, bottom) = frame;
        let columns = cells(left, right);
        let rows = cells(top, bottom);
        Self {
            corner: (left, top),
            columns,
            covered: vec![false; columns * rows],
        }
    }

    /// Covers the cells of a polyline and calls `each` with the parts that cover free cells.
    /// The points must be clipped to the frame.
    pub(super) fn draw_uncovered(
        &mut self,
        points: &[FramePoint],
        mut each: impl FnMut(&[FramePoint]),
    ) {
        let mut begin = 0;
        for (index, pair) in points.windows(2).enumerate() {
            if !self.cover_segment(pair[0], pair[1]) {
                if index > begin {
                    each(&points[begin..=index]);
                }
                begin = index + 1;
            }
        }
        if points.len() > begin + 1 {
            each(&points[begin..]);
        }
    }

    /// Covers the cells of a straight piece. Returns whether a cell was free before.
    fn cover_segment(&mut self, from: FramePoint, to: FramePoint) -> bool {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let steps = (dx.abs().max(dy.abs()) * CELLS_PER_PIXEL_SIDE)
            .ceil()
            .max(1.0);
        let mut has_free_cell = false;
        for step in 0..=steps as u32 {
            let part = f64::from(step) / steps;
            let column = (from.0 + dx * part - self.corner.0) * CELLS_PER_PIXEL_SIDE;
            let row = (from.1 + dy * part - self.corner.1) * CELLS_PER_PIXEL_SIDE;
            // The cast saturates: points on the frame are in its outermost cells.
            let index = row as usize * self.columns + column as usize;
            if let Some(cell) = self.covered.get_mut(index)
                && !*cell
            {
                *cell = true;
                has_free_cell = true;
            }
        }
        has_free_cell
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> PictureArea {
        (10.0, 20.0, 110.0, 70.0)
    }

    fn bare(coverage: &mut Coverage, points: &[FramePoint]) -> Vec<Vec<FramePoint>> {
        let mut parts = Vec::new();
        coverage.draw_uncovered(points, |part| parts.push(part.to_vec()));
        parts
    }

    #[test]
    fn a_line_up_and_down_is_drawn_once() {
        let mut coverage = Coverage::new(frame());
        let line = [(50.0, 30.0), (50.0, 60.0)];
        assert_eq!(bare(&mut coverage, &line), [line.to_vec()]);
        for step in 0..1000 {
            let to = 30.0 + f64::from(step) * 0.03;
            assert!(bare(&mut coverage, &[(50.0, 30.0), (50.0, to), (50.0, 31.0)]).is_empty());
        }
    }

    #[test]
    fn what_is_new_of_a_line_keeps_its_points() {
        let mut coverage = Coverage::new(frame());
        bare(&mut coverage, &[(20.0, 30.0), (60.0, 30.0)]);
        let line = [
            (20.0, 30.0),
            (60.0, 30.0),
            (60.0, 50.0),
            (80.0, 50.0),
            (60.0, 50.0),
        ];
        assert_eq!(bare(&mut coverage, &line), [line[1..4].to_vec()]);
    }

    #[test]
    fn the_edges_of_the_frame_are_part_of_it() {
        let mut coverage = Coverage::new(frame());
        let round = [
            (10.0, 20.0),
            (110.0, 20.0),
            (110.0, 70.0),
            (10.0, 70.0),
            (10.0, 20.0),
        ];
        assert_eq!(bare(&mut coverage, &round), [round.to_vec()]);
        assert!(bare(&mut coverage, &round).is_empty());
    }
}
