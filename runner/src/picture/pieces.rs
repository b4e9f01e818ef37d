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

/// The finest cell, mm: less than the least increment of the control.
const FINEST_MM: f64 = 1.0 / 1024.0;

/// Least number of cells across a pixel, while there is memory.
const CELLS_PER_PIXEL: f64 = 4.0;

/// Limit of the stored pieces: about 100 MB.
const MOST_PIECES: usize = 1 << 20;

/// The kind of a line of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Made {
    /// A rapid.
    Rapid,
    /// A cut; tools count from 0 in the order of their first cuts.
    Cut(u8),
}

/// A point of the grid, in cells from the zero of the program frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
struct Cell {
    x: i32,
    z: i32,
}

/// Successive pieces of the same kind.
#[derive(Clone, Debug, PartialEq)]
struct Stroke {
    made: Made,
    cells: Vec<Cell>,
}

/// All pieces of a path, in the order of execution.
#[derive(Clone, Debug)]
pub(super) struct Pieces {
    strokes: Vec<Stroke>,
    /// Every piece in the strokes, its ends in order.
    drawn: HashSet<(Cell, Cell, Made)>,
    cell_mm: f64,
    most: usize,
}

impl Default for Pieces {
    fn default() -> Self {
        Self {
            strokes: Vec::new(),
            drawn: HashSet::new(),
            cell_mm: FINEST_MM,
            most: MOST_PIECES,
        }
    }
}

impl Pieces {
    /// The size of a cell, mm.
    pub const fn cell_mm(&self) -> f64 {
        self.cell_mm
    }

    /// The strokes in the order of execution: their kind, and their points, mm.
    pub fn strokes(
        &self,
    ) -> impl Iterator<Item = (Made, impl Iterator<Item = Point> + Clone + '_)> {
        self.strokes.iter().map(|stroke| {
            let points = stroke.cells.iter().map(|cell| {
                Point::new(
                    f64::from(cell.x) * self.cell_mm,
                    f64::from(cell.z) * self.cell_mm,
                )
            });
            (stroke.made, points)
        })
    }

    /// Adds a straight line.
    pub fn line(&mut self, made: Made, from: Point, to: Point) {
        let (from, to) = (self.cell(from), self.cell(to));
        self.piece(made, from, to);
    }

    /// Whether there is memory for another line.
    pub fn has_room(&self) -> bool {
        self.drawn.len() < self.most
    }

    /// Makes the grid as coarse as a pixel of this size allows, mm.
    pub fn suit(&mut self, pixel_mm: f64) {
        let cell = pixel_mm / CELLS_PER_PIXEL;
        if self.cell_mm * 2.0 <= cell {
            self.coarsen(cell);
        }
    }

    /// Coarsens the grid for more pieces, with cells up to a pixel.
    pub fn make_room(&mut self, pixel_mm: f64) {
        self.suit(pixel_mm);
        if !self.has_room() && self.cell_mm * 2.0 <= pixel_mm {
            self.coarsen(self.cell_mm * 2.0);
        }
    }

    /// Adds a piece, unless it is smaller than a cell or already stored.
    fn piece(&mut self, made: Made, from: Cell, to: Cell) {
        if from == to || !self.drawn.insert((from.min(to), from.max(to), made)) {
            return;
        }
        match self.strokes.last_mut() {
            Some(last) if last.made == made && last.cells.last() == Some(&from) => {
                last.cells.push(to);
            }
            _ => self.strokes.push(Stroke {
                made,
                cells: vec![from, to],
            }),
        }
    }

    fn cell(&self, point: Point) -> Cell {
        // The cast saturates far beyond any machine.
        Cell {
            x: (point.x / self.cell_mm).round() as i32,
            z: (point.z / self.cell_mm).round() as i32,
        }
    }

    /// Changes to the coarsest grid whose cells are not larger than `most_mm`.
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
            let mut cells = stroke.cells.iter().map(|cell| Cell {
                x: halve(cell.x),
                z: halve(cell.z),
            });
            let Some(mut last) = cells.next() else {
                continue;
            };
            for cell in cells {
                self.piece(stroke.made, last, cell);
                last = cell;
            }
        }
    }

    /// Number of stored pieces.
    pub fn len(&self) -> usize {
        self.drawn.len()
    }

    /// With a limit of few pieces, for tests.
    #[cfg(test)]
    pub fn with_room(most: usize) -> Self {
        Self {
            most,
            ..Self::default()
        }
    }
}
