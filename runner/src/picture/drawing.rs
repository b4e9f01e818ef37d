//! The toolpath as it will be seen: points on a grid finer than a pixel, every
//! piece once. What a program draws over and over takes no more memory than once.
//!
//! The picture is fitted to the path, and how far that reaches is known at its end
//! only. So the grid begins fine and becomes coarser with the box around the path:
//!
//! ```text
//!   box so far        a pixel of it     cell of the grid
//!   |<--- 1140 px --->|  -->  |p|  -->  at most a quarter of p, a power of two
//! ```

use std::collections::HashSet;

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::memory::Parameters;
use gsk_core::units::{Axis, Point};

use super::extent::{Extent, pixel_mm};

/// The finest cell, mm: beyond the least increment of the control.
const FINEST_MM: f64 = 1.0 / 1024.0;

/// Cells across a pixel, at least, while there is room.
const CELLS_PER_PIXEL: f64 = 4.0;

/// Pieces that are kept at most: about 100 MB.
const MOST_PIECES: usize = 1 << 20;

/// Rapid rates, for the bend in the path of a rapid with both axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RapidRates {
    /// mm/min of radius.
    pub x: f64,
    /// mm/min.
    pub z: f64,
}

impl RapidRates {
    /// Of a control.
    pub fn of(parameters: &Parameters) -> Self {
        Self {
            x: parameters.rapid_rate(Axis::X),
            z: parameters.rapid_rate(Axis::Z),
        }
    }
}

/// A point of the grid, cells from the zero of the program frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
struct Cell {
    x: i32,
    z: i32,
}

/// Pieces that follow each other: rapids (dashed) or cuts.
#[derive(Clone, Debug, PartialEq)]
struct Stroke {
    rapid: bool,
    cells: Vec<Cell>,
}

/// The drawing: what the path looks like, and the words around it.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Text in the upper left corner.
    pub title: String,
    strokes: Vec<Stroke>,
    /// Every piece that is in the strokes, its ends in order.
    drawn: HashSet<(Cell, Cell, bool)>,
    cell_mm: f64,
    extent: Option<Extent>,
    most_pieces: usize,
    left_out: u64,
}

impl Drawing {
    /// A drawing without a path yet.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            strokes: Vec::new(),
            drawn: HashSet::new(),
            cell_mm: FINEST_MM,
            extent: None,
            most_pieces: MOST_PIECES,
            left_out: 0,
        }
    }

    /// Adds a move.
    pub fn push(&mut self, executed: &ExecutedMove, rates: RapidRates) {
        if executed.kind == MoveKind::Dwell {
            return;
        }
        if self.left_out > 0 {
            self.left_out += 1;
            return;
        }
        let (from, to) = (executed.from, executed.to);
        self.reach(from);
        self.reach(to);
        match executed.kind {
            MoveKind::Dwell => {}
            MoveKind::Rapid => {
                if let Some(bend) = rapid_bend(from, to, rates) {
                    self.line(true, from, bend);
                    self.line(true, bend, to);
                } else {
                    self.line(true, from, to);
                }
            }
            MoveKind::Feed | MoveKind::Thread | MoveKind::RunOut => self.line(false, from, to),
            MoveKind::Clockwise | MoveKind::CounterClockwise => {
                let clockwise = executed.kind == MoveKind::Clockwise;
                let center = executed.center.unwrap_or(from);
                let mut last = from;
                for point in arc_points(from, to, center, clockwise, self.cell_mm) {
                    self.reach(point);
                    self.line(false, last, point);
                    last = point;
                }
            }
        }
    }

    /// Moves that found no room any more.
    pub fn left_out(&self) -> u64 {
        self.left_out
    }

    /// The box around the path.
    pub(super) fn extent(&self) -> Option<Extent> {
        self.extent
    }

    /// The strokes in the order of execution: whether rapid, and the points, mm.
    pub(super) fn strokes(
        &self,
    ) -> impl Iterator<Item = (bool, impl Iterator<Item = Point> + Clone + '_)> {
        self.strokes.iter().map(|stroke| {
            let points = stroke.cells.iter().map(|cell| {
                Point::new(
                    f64::from(cell.x) * self.cell_mm,
                    f64::from(cell.z) * self.cell_mm,
                )
            });
            (stroke.rapid, points)
        })
    }

    fn line(&mut self, rapid: bool, from: Point, to: Point) {
        let (from, to) = (self.cell(from), self.cell(to));
        self.piece(rapid, from, to);
        if self.drawn.len() >= self.most_pieces {
            self.make_room();
        }
    }

    /// Adds a piece, unless it is smaller than a cell or drawn already.
    fn piece(&mut self, rapid: bool, from: Cell, to: Cell) {
        if from == to || !self.drawn.insert((from.min(to), from.max(to), rapid)) {
            return;
        }
        match self.strokes.last_mut() {
            Some(last) if last.rapid == rapid && last.cells.last() == Some(&from) => {
                last.cells.push(to);
            }
            _ => self.strokes.push(Stroke {
                rapid,
                cells: vec![from, to],
            }),
        }
    }

    fn cell(&self, point: Point) -> Cell {
        // Saturates far beyond any machine.
        Cell {
            x: (point.x / self.cell_mm).round() as i32,
            z: (point.z / self.cell_mm).round() as i32,
        }
    }

    /// Widens the box, and with it the grid.
    fn reach(&mut self, point: Point) {
        let extent = self.extent.get_or_insert(Extent {
            low: point,
            high: point,
        });
        let (low, high) = (&mut extent.low, &mut extent.high);
        *low = Point::new(low.x.min(point.x), low.z.min(point.z));
        *high = Point::new(high.x.max(point.x), high.z.max(point.z));
        let cell = pixel_mm(extent.high - extent.low) / CELLS_PER_PIXEL;
        if self.cell_mm * 2.0 <= cell {
            self.coarsen(cell);
        }
    }

    /// Makes room for more pieces: with cells up to a pixel, or not at all.
    fn make_room(&mut self) {
        let pixel = self
            .extent
            .map_or(0.0, |extent| pixel_mm(extent.high - extent.low));
        if self.cell_mm * 2.0 <= pixel {
            self.coarsen(self.cell_mm * 2.0);
        }
        if self.drawn.len() >= self.most_pieces {
            self.left_out = 1;
        }
    }

    /// Goes over to the coarsest grid whose cells are not larger than `most_mm`.
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
                self.piece(stroke.rapid, last, cell);
                last = cell;
            }
        }
    }
}

/// Rapids move both axes at their own rates: at 45° on equal ones, then along the
/// axis that has further to go. Where that bend is, if there is one.
fn rapid_bend(from: Point, to: Point, rates: RapidRates) -> Option<Point> {
    let distance = to - from;
    let time_x = distance.x.abs() / rates.x.max(1.0);
    let time_z = distance.z.abs() / rates.z.max(1.0);
    if time_x == 0.0 || time_z == 0.0 {
        return None;
    }
    let both = time_x.min(time_z);
    Some(Point::new(
        from.x + distance.x * (both / time_x),
        from.z + distance.z * (both / time_z),
    ))
}

/// The points of an arc after its first: as many as keep the chords within half a
/// cell of the arc.
///
/// ```text
///   sagitta = radius · (1 − cos(step / 2))
/// ```
fn arc_points(
    from: Point,
    to: Point,
    center: Point,
    clockwise: bool,
    cell_mm: f64,
) -> impl Iterator<Item = Point> {
    const MOST_STEPS: f64 = 4096.0;
    let (first, last) = (from - center, to - center);
    let radius = first.length();
    let start = first.x.atan2(first.z);
    let mut sweep = last.x.atan2(last.z) - start;
    let turn = std::f64::consts::TAU;
    if clockwise && sweep >= -1e-12 {
        sweep -= turn;
    } else if !clockwise && sweep <= 1e-12 {
        sweep += turn;
    }
    let step = 2.0 * (1.0 - cell_mm / 2.0 / radius.max(cell_mm)).acos();
    let steps = (sweep.abs() / step).ceil().clamp(2.0, MOST_STEPS) as u32;
    (1..=steps).map(move |index| {
        if index == steps {
            return to;
        }
        let angle = start + sweep * f64::from(index) / f64::from(steps);
        center + Point::new(angle.sin() * radius, angle.cos() * radius)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::command::{Conditions, ProgramId, Source};

    const RATES: RapidRates = RapidRates {
        x: 3800.0,
        z: 7600.0,
    };

    fn executed(kind: MoveKind, from: Point, to: Point) -> ExecutedMove {
        ExecutedMove {
            source: Source {
                program: ProgramId::External,
                line: 1,
                sequence: None,
            },
            kind,
            from,
            to,
            center: None,
            feed: None,
            start_s: 0.0,
            duration_s: 0.0,
            conditions: Conditions::default(),
        }
    }

    fn cut(drawing: &mut Drawing, from: Point, to: Point) {
        drawing.push(&executed(MoveKind::Feed, from, to), RATES);
    }

    #[test]
    fn arcs_stay_on_their_circle_and_go_the_right_way() {
        let (from, to) = (Point::new(10.0, 0.0), Point::new(0.0, 10.0));
        for (clockwise, sign) in [(true, 1.0), (false, -1.0)] {
            let points: Vec<_> = arc_points(from, to, Point::default(), clockwise, 0.01).collect();
            assert_eq!(points.last(), Some(&to));
            for (index, point) in points.iter().enumerate() {
                assert!((point.length() - 10.0).abs() < 1e-9);
                let before = if index == 0 { from } else { points[index - 1] };
                let chord_height = 10.0 - ((before + *point) * 0.5).length();
                assert!(chord_height <= 0.005 + 1e-9);
            }
            // From the top, clockwise goes to the right.
            assert!(points[0].z * sign > 0.0);
        }
    }

    #[test]
    fn a_rapid_bends_where_the_first_axis_arrives() {
        let bend = rapid_bend(Point::default(), Point::new(10.0, 100.0), RATES);
        assert_eq!(bend, Some(Point::new(10.0, 20.0)));
        assert_eq!(
            rapid_bend(Point::default(), Point::new(0.0, 5.0), RATES),
            None
        );
    }

    #[test]
    fn what_is_drawn_again_takes_no_room() {
        let mut drawing = Drawing::new("");
        let (left, right) = (Point::new(10.0, -60.0), Point::new(10.0, 0.0));
        for _ in 0..1000 {
            cut(&mut drawing, left, right);
            cut(&mut drawing, right, left);
        }
        assert_eq!(drawing.drawn.len(), 1);
        assert_eq!(drawing.strokes.len(), 1);
    }

    #[test]
    fn a_path_of_micrometres_becomes_pieces_of_a_fraction_of_a_pixel() {
        let mut drawing = Drawing::new("");
        drawing.push(
            &executed(
                MoveKind::Rapid,
                Point::new(50.0, 0.0),
                Point::new(50.0, -60.0),
            ),
            RATES,
        );
        // 60 mm in steps of 5 µm, with every fifth one back.
        let at = |step: i32| Point::new(10.0, -0.005 * f64::from(step));
        for step in 0..12_000 {
            cut(&mut drawing, at(step), at(step + 1));
            cut(&mut drawing, at(step + 1), at(step));
            cut(&mut drawing, at(step), at(step + 1));
        }
        let pixel = pixel_mm(Point::new(40.0, 60.0));
        assert!(drawing.cell_mm <= pixel / 4.0 && drawing.cell_mm > pixel / 8.0);
        assert!(drawing.drawn.len() <= (60.0 / drawing.cell_mm) as usize + 2);
        assert_eq!(drawing.left_out(), 0);
    }

    #[test]
    fn a_path_without_end_is_cut_off_and_counted() {
        let mut drawing = Drawing::new("");
        drawing.most_pieces = 1000;
        // Lines from one point to a thousand others, a pixel apart and more.
        for step in 0..3000 {
            let end = Point::new(f64::from(step % 50) * 10.0, f64::from(step / 50) * 10.0);
            cut(&mut drawing, Point::new(-7.0, -7.0), end);
        }
        assert!(drawing.drawn.len() <= 1000);
        assert_eq!(drawing.left_out(), 3000 - 999);
    }

    #[test]
    fn a_coarser_grid_keeps_the_shape() {
        let mut drawing = Drawing::new("");
        cut(&mut drawing, Point::new(1.0, 0.0), Point::new(1.0, 1.0));
        cut(&mut drawing, Point::new(1.0, 1.0), Point::new(2.0, 1.0));
        cut(&mut drawing, Point::new(2.0, 1.0), Point::new(2.0, 500.0));
        let points: Vec<_> = drawing.strokes().flat_map(|(_, points)| points).collect();
        let wanted = [
            Point::new(1.0, 0.0),
            Point::new(1.0, 1.0),
            Point::new(2.0, 1.0),
            Point::new(2.0, 500.0),
        ];
        for (point, wanted) in points.iter().zip(wanted) {
            assert!((*point - wanted).length() < 2.0 * drawing.cell_mm);
        }
        assert_eq!(points.len(), 4);
    }
}
