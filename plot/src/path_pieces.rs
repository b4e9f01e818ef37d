//! Stores the toolpath as it will be visible: points on a grid finer than a pixel, every piece
//! once. What a program draws repeatedly takes no more memory than once.
//!
//! The picture is fitted to the path, whose extent is known at its end only. So the grid
//! begins fine and becomes coarser with the box around the path:
//!
//! ```text
//!   box so far        a pixel of it     cell of the grid
//!   |<--- 1140 px --->|  -->  |p|  -->  at most a quarter of p, a power of two
//! ```

use std::collections::HashSet;

use gsk_core::units::Point;

/// Size of the finest grid cell, mm: less than the least increment of the control.
const FINEST_MM: f64 = 1.0 / 1024.0;

/// Least number of grid cells across a pixel, unless memory is exhausted.
const CELLS_PER_PIXEL: f64 = 4.0;

/// Maximum number of stored pieces: about 100 MB.
const MAX_PIECES: usize = 1 << 20;

/// Whether a line of the path is a rapid, or a cut of a certain tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PathLine {
    /// The line is a rapid.
    Rapid,
    /// The line is a cut of this tool; tools count from 0 in the order of their first cuts.
    Cut(u8),
}

/// A grid point, as the number of cells in X and Z from the zero of the program frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
struct GridCell {
    x: i32,
    z: i32,
}

/// Successive straight pieces of the same kind, through these grid points.
#[derive(Clone, Debug, PartialEq)]
struct PathStroke {
    line_kind: PathLine,
    cells: Vec<GridCell>,
}

/// All straight pieces of a path, rounded to a grid, in the order of execution.
#[derive(Clone, Debug)]
pub(super) struct PathPieces {
    strokes: Vec<PathStroke>,
    /// Every piece in the strokes, with its lesser end first, to find pieces that are drawn
    /// again.
    drawn: HashSet<(GridCell, GridCell, PathLine)>,
    cell_mm: f64,
    max_pieces: usize,
}

impl Default for PathPieces {
    fn default() -> Self {
        Self {
            strokes: Vec::new(),
            drawn: HashSet::new(),
            cell_mm: FINEST_MM,
            max_pieces: MAX_PIECES,
        }
    }
}

impl PathPieces {
    /// Returns the size of a grid cell, mm.
    pub const fn cell_mm(&self) -> f64 {
        self.cell_mm
    }

    /// The strokes in the order of execution, each with its kind and its points, mm.
    pub fn strokes(
        &self,
    ) -> impl Iterator<Item = (PathLine, impl Iterator<Item = Point> + Clone + '_)> {
        self.strokes.iter().map(|stroke| {
            let points = stroke.cells.iter().map(|cell| {
                Point::new(
                    f64::from(cell.x) * self.cell_mm,
                    f64::from(cell.z) * self.cell_mm,
                )
            });
            (stroke.line_kind, points)
        })
    }

    /// Adds a straight line of the kind `made` from `from` to `to`, mm.
    pub fn add_line(&mut self, made: PathLine, from: Point, to: Point) {
        let (from, to) = (self.grid_cell(from), self.grid_cell(to));
        self.add_piece(made, from, to);
    }

    /// Whether there is memory for one more line.
    pub fn has_room(&self) -> bool {
        self.drawn.len() < self.max_pieces
    }

    /// Enlarges the grid cells as far as a pixel of `pixel_mm` permits.
    pub fn fit_grid(&mut self, pixel_mm: f64) {
        let cell = pixel_mm / CELLS_PER_PIXEL;
        if self.cell_mm * 2.0 <= cell {
            self.coarsen(cell);
        }
    }

    /// Coarsens the grid so that more pieces fit, with cells up to the size of a pixel, mm.
    pub fn make_room(&mut self, pixel_mm: f64) {
        self.fit_grid(pixel_mm);
        if !self.has_room() && self.cell_mm * 2.0 <= pixel_mm {
            self.coarsen(self.cell_mm * 2.0);
        }
    }

    /// Adds a straight piece, unless its ends are the same grid point or the piece is already
    /// stored.
    fn add_piece(&mut self, made: PathLine, from: GridCell, to: GridCell) {
        if from == to || !self.drawn.insert((from.min(to), from.max(to), made)) {
            return;
        }
        match self.strokes.last_mut() {
            Some(last) if last.line_kind == made && last.cells.last() == Some(&from) => {
                last.cells.push(to);
            }
            _ => self.strokes.push(PathStroke {
                line_kind: made,
                cells: vec![from, to],
            }),
        }
    }

    fn grid_cell(&self, point: Point) -> GridCell {
        // The cast saturates far beyond any machine.
        GridCell {
            x: (point.x / self.cell_mm).round() as i32,
            z: (point.z / self.cell_mm).round() as i32,
        }
    }

    /// Makes the grid as coarse as possible, but with cells not larger than `most_mm`.
    fn coarsen(&mut self, most_mm: f64) {
        let mut halvings = 0;
        while self.cell_mm * 2.0 <= most_mm {
            self.cell_mm *= 2.0;
            halvings += 1;
        }
        let halve = |value: i32| {
            let unit = 1_i64 << halvings;
            ((i64::from(value) + unit / 2).div_euclid(unit)) as i32
        };
        let strokes = std::mem::take(&mut self.strokes);
        self.drawn = HashSet::new();
        for stroke in strokes {
            let mut cells = stroke.cells.iter().map(|cell| GridCell {
                x: halve(cell.x),
                z: halve(cell.z),
            });
            let Some(mut last) = cells.next() else {
                continue;
            };
            for cell in cells {
                self.add_piece(stroke.line_kind, last, cell);
                last = cell;
            }
        }
    }

    /// Returns the number of stored straight pieces.
    pub fn len(&self) -> usize {
        self.drawn.len()
    }

    /// Creates an empty path that stores at most `max_pieces`, for tests.
    #[cfg(test)]
    pub fn with_limit(max_pieces: usize) -> Self {
        Self {
            max_pieces,
            ..Self::default()
        }
    }
}
