//! Collects what a picture of a lathe program shows: the path, the tools, the times and the
//! texts.

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::units::{PerAxis, Point};

use super::extent::{Extent, Size};
use super::labels::Labels;
use super::pieces::{Made, Pieces};
use super::scenery::Scenery;
use crate::curves::{RapidRates, arc_points, rapid_bend};
use crate::machining::Machining;
use crate::times::{Spent, Times};

/// Height of a block number, pixels.
const NUMBER: f64 = 16.0;

/// Options for a drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Look {
    /// Size of the picture.
    pub size: Size,
    /// Whether the picture is fitted to the whole path. Otherwise it is fitted to the cuts,
    /// and rapids end at the frame.
    pub whole: bool,
    /// Whether the ends of blocks show their numbers.
    pub labels: bool,
    /// Whether the part has its dimensions written on it.
    pub dimensions: bool,
    /// Whether each tool is drawn at the end of its last cut.
    pub tools: bool,
}

/// The drawing of a toolpath, built move by move.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Text in the upper left corner.
    pub title: String,
    look: Look,
    pieces: Pieces,
    labels: Labels,
    /// Bounds of the cuts, and of everything.
    cuts: Option<Extent>,
    all: Option<Extent>,
    /// The tools that cut, in the order of their first cuts.
    tools: Vec<u8>,
    /// The end of the last cut of each tool.
    ends: Vec<Point>,
    times: Times,
    scenery: Scenery,
    left_out: u64,
}

impl Drawing {
    /// A drawing without a path yet.
    pub fn new(title: impl Into<String>, look: Look) -> Self {
        Self {
            title: title.into(),
            look,
            pieces: Pieces::default(),
            labels: Labels::default(),
            cuts: None,
            all: None,
            tools: Vec::new(),
            ends: Vec::new(),
            times: Times::default(),
            scenery: Scenery::default(),
            left_out: 0,
        }
    }

    /// Adds a move. Rapids bend according to `rates`.
    pub fn push(&mut self, executed: &ExecutedMove, rates: RapidRates) {
        self.times.push(executed);
        if executed.kind == MoveKind::Dwell {
            return;
        }
        if self.left_out > 0 {
            self.left_out += 1;
            return;
        }
        let made = self.made(executed);
        if let Made::Cut(index) = made
            && let Some(end) = self.ends.get_mut(usize::from(index))
        {
            *end = executed.to;
        }
        let (from, to) = (executed.from, executed.to);
        let unplaced = executed.conditions.unplaced;
        if !unplaced.is_none() {
            // To the edge of the picture, or from there.
            let known = |end: PerAxis<bool>| !end.x && !end.z;
            if known(unplaced.from) {
                self.reach(made, from);
                self.line(made, from, beyond(from, unplaced.to));
            } else if known(unplaced.to) {
                self.reach(made, to);
                self.line(made, beyond(to, unplaced.from), to);
            }
            return;
        }
        self.reach(made, from);
        self.reach(made, to);
        match executed.kind {
            MoveKind::Dwell => {}
            MoveKind::Rapid => {
                if let Some(bend) = rapid_bend(from, to, rates) {
                    self.line(made, from, bend);
                    self.line(made, bend, to);
                } else {
                    self.line(made, from, to);
                }
            }
            MoveKind::Feed | MoveKind::Thread | MoveKind::RunOut => self.line(made, from, to),
            MoveKind::Clockwise | MoveKind::CounterClockwise => {
                let clockwise = executed.kind == MoveKind::Clockwise;
                let center = executed.center.unwrap_or(from);
                let mut last = from;
                for point in arc_points(from, to, center, clockwise, self.pieces.cell_mm()) {
                    self.reach(made, point);
                    self.line(made, last, point);
                    last = point;
                }
            }
        }
        if self.look.labels {
            self.labels.push(executed.source, to);
        }
    }

    /// Ends the program at machine time `time_s`.
    pub fn end(&mut self, time_s: f64) {
        self.times.end(time_s);
        self.labels.end();
    }

    /// Draws part and clamping under the path, and tools and dimensions if the options include
    /// them. The legend then describes the tools.
    pub fn stand_before(&mut self, machining: &Machining) {
        let ends = self.tools.iter().copied().zip(self.ends.iter().copied());
        let ends = ends.filter(|_| self.look.tools).collect();
        self.scenery = Scenery::of(machining, ends, self.look.dimensions);
    }

    /// The part and clamping drawn under the path.
    pub(super) const fn scenery(&self) -> &Scenery {
        &self.scenery
    }

    /// Number of moves that did not fit into memory.
    pub fn left_out(&self) -> u64 {
        self.left_out
    }

    /// The options of the drawing.
    pub const fn look(&self) -> Look {
        self.look
    }

    /// The bounds that the picture is fitted to. A path without cuts is shown whole.
    pub(super) fn extent(&self) -> Option<Extent> {
        if self.look.whole {
            return self.all;
        }
        self.cuts.or(self.all)
    }

    /// The path.
    pub(super) const fn pieces(&self) -> &Pieces {
        &self.pieces
    }

    /// The numbers of blocks at their ends.
    pub(super) fn labels(&self) -> Vec<(Point, String)> {
        self.labels.all()
    }

    /// The tools that cut, in the order of their first cuts: tool number, first offset number,
    /// times.
    pub(super) fn tools(&self) -> impl Iterator<Item = (u8, u8, Spent)> + '_ {
        self.tools.iter().filter_map(|tool| {
            let mut times = self.times.tools().iter();
            times
                .find(|time| time.tool == *tool)
                .map(|time| (time.tool, time.offset, time.spent))
        })
    }

    /// The time of the whole program.
    pub(super) const fn spent(&self) -> &Spent {
        self.times.spent()
    }

    /// The kind of line for a move.
    fn made(&mut self, executed: &ExecutedMove) -> Made {
        if executed.kind == MoveKind::Rapid {
            return Made::Rapid;
        }
        let tool = executed.conditions.tool;
        let known = self.tools.iter().position(|known| *known == tool);
        let index = known.unwrap_or_else(|| {
            self.tools.push(tool);
            self.ends.push(executed.to);
            self.tools.len() - 1
        });
        // A control has no more than 100 tools.
        Made::Cut(u8::try_from(index).unwrap_or(u8::MAX))
    }

    fn line(&mut self, made: Made, from: Point, to: Point) {
        self.pieces.line(made, from, to);
        if self.pieces.has_room() {
            return;
        }
        let extent = self.extent();
        let size = extent.map_or(Point::default(), |extent| extent.high - extent.low);
        self.pieces.make_room(self.look.size.pixel_mm(size));
        if !self.pieces.has_room() {
            self.left_out = 1;
        }
    }

    /// Widens the bounds and coarsens the grid. If only the cuts are shown, the grid stays
    /// fine until the first cut shows how large the picture will be.
    fn reach(&mut self, made: Made, point: Point) {
        self.all.get_or_insert(Extent::of(point)).reach(point);
        if made != Made::Rapid {
            self.cuts.get_or_insert(Extent::of(point)).reach(point);
        }
        let shown = if self.look.whole { self.all } else { self.cuts };
        if let Some(extent) = shown {
            let pixel = self.look.size.pixel_mm(extent.high - extent.low);
            self.pieces.suit(pixel);
            self.labels.suit(pixel * NUMBER);
        }
    }
}

/// A point outside every picture, in the axes whose position is unknown.
fn beyond(point: Point, unplaced: PerAxis<bool>) -> Point {
    /// mm.
    const FAR: f64 = 100_000.0;
    let outwards = if point.x < 0.0 { -FAR } else { FAR };
    Point::new(
        if unplaced.x {
            point.x + outwards
        } else {
            point.x
        },
        if unplaced.z { point.z + FAR } else { point.z },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::command::{Conditions, ProgramId, Source};

    const RATES: RapidRates = RapidRates {
        x: 3800.0,
        z: 7600.0,
        straight: false,
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
    fn what_is_drawn_again_takes_no_room() {
        let mut drawing = Drawing::new("", Look::default());
        let (left, right) = (Point::new(10.0, -60.0), Point::new(10.0, 0.0));
        for _ in 0..1000 {
            cut(&mut drawing, left, right);
            cut(&mut drawing, right, left);
        }
        assert_eq!(drawing.pieces.len(), 1);
        assert_eq!(drawing.pieces.strokes().count(), 1);
    }

    #[test]
    fn a_path_of_micrometres_becomes_pieces_of_a_fraction_of_a_pixel() {
        let mut drawing = Drawing::new("", Look::default());
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
        let pixel = Size::default().pixel_mm(Point::new(0.0, 60.0));
        assert!(drawing.pieces.cell_mm() <= pixel / 4.0 && drawing.pieces.cell_mm() > pixel / 8.0);
        assert!(drawing.pieces.len() <= (60.0 / drawing.pieces.cell_mm()) as usize + 2);
        assert_eq!(drawing.left_out(), 0);
    }

    #[test]
    fn a_path_without_end_is_cut_off_and_counted() {
        let mut drawing = Drawing::new("", Look::default());
        drawing.pieces = Pieces::with_room(1000);
        // Lines from one point to a thousand others, a pixel apart and more.
        for step in 0..3000 {
            let end = Point::new(f64::from(step % 50) * 10.0, f64::from(step / 50) * 10.0);
            cut(&mut drawing, Point::new(-7.0, -7.0), end);
        }
        assert!(drawing.pieces.len() <= 1000);
        assert_eq!(drawing.left_out(), 3000 - 999);
    }

    #[test]
    fn a_coarser_grid_keeps_the_shape() {
        let mut drawing = Drawing::new("", Look::default());
        cut(&mut drawing, Point::new(1.0, 0.0), Point::new(1.0, 1.0));
        cut(&mut drawing, Point::new(1.0, 1.0), Point::new(2.0, 1.0));
        cut(&mut drawing, Point::new(2.0, 1.0), Point::new(2.0, 500.0));
        let points: Vec<_> = drawing
            .pieces
            .strokes()
            .flat_map(|(_, points)| points)
            .collect();
        let wanted = [
            Point::new(1.0, 0.0),
            Point::new(1.0, 1.0),
            Point::new(2.0, 1.0),
            Point::new(2.0, 500.0),
        ];
        for (point, wanted) in points.iter().zip(wanted) {
            assert!((*point - wanted).length() < 2.0 * drawing.pieces.cell_mm());
        }
        assert_eq!(points.len(), 4);
    }

    #[test]
    fn it_is_fitted_to_the_cuts_unless_all_is_asked_for() {
        let rapid = |from, to| executed(MoveKind::Rapid, from, to);
        let (far, near) = (Point::new(150.0, 300.0), Point::new(20.0, 2.0));
        let end = Point::new(20.0, -40.0);
        let fitted = |look: Look| {
            let mut drawing = Drawing::new("", look);
            drawing.push(&rapid(far, near), RATES);
            cut(&mut drawing, near, end);
            drawing.push(&rapid(end, far), RATES);
            drawing.extent().expect("extent").high
        };
        assert_eq!(fitted(Look::default()), near);
        let whole = Look {
            whole: true,
            ..Look::default()
        };
        assert_eq!(fitted(whole), far);
        let mut drawing = Drawing::new("", Look::default());
        drawing.push(&rapid(far, near), RATES);
        assert_eq!(drawing.extent().map(|extent| extent.high), Some(far));
    }

    #[test]
    fn every_tool_has_a_colour_of_its_own_in_the_order_of_its_cuts() {
        let mut drawing = Drawing::new("", Look::default());
        for (tool, kind) in [
            (4, MoveKind::Rapid),
            (7, MoveKind::Feed),
            (2, MoveKind::Thread),
            (7, MoveKind::Clockwise),
        ] {
            let mut made = executed(kind, Point::new(10.0, 0.0), Point::new(10.0, -10.0));
            made.conditions.tool = tool;
            drawing.push(&made, RATES);
        }
        let tools: Vec<u8> = drawing.tools().map(|(tool, ..)| tool).collect();
        assert_eq!(tools, [7, 2]);
        // The last cut is on the first one of its tool.
        let made: Vec<Made> = drawing.pieces.strokes().map(|(made, _)| made).collect();
        assert_eq!(made, [Made::Rapid, Made::Cut(0), Made::Cut(1)]);
    }
}
