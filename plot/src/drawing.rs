//! Collects what a picture of a lathe program shows: the path, the tools, the times and the
//! texts.

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::units::{PerAxis, Point};
use gsk_workpiece::grid::from_grid;

use crate::block_labels::BlockLabels;
use crate::extent::{PathExtent, PictureSize};
use crate::path_pieces::{PathLine, PathPieces};
use crate::scenery::PathScenery;
use gsk_runner::curves::{RapidRates, arc_points, rapid_bend};
use gsk_runner::machining::Machining;
use gsk_runner::times::{ProgramTimes, TimesByUse};

/// Height of a block label, pixels.
const NUMBER_HEIGHT_PX: f64 = 16.0;

/// Options for the drawing of a toolpath: its size, and whether it contains part, tools and
/// dimensions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DrawingOptions {
    /// Size of the picture, pixels.
    pub size: PictureSize,
    /// Whether the picture is fitted to the whole path. If not, it is fitted to the cuts, and
    /// rapids end at the frame.
    pub shows_whole_path: bool,
    /// Whether the end of each block is labelled with the number of the block.
    pub labels: bool,
    /// Whether dimensions are drawn on the part.
    pub dimensions: bool,
    /// Whether each tool is drawn at the end of its last cut.
    pub tools: bool,
}

/// The drawing of a toolpath, built move by move.
#[derive(Clone, Debug)]
pub struct PathDrawing {
    /// Text that is drawn in the upper left corner.
    pub title: String,
    options: DrawingOptions,
    pieces: PathPieces,
    labels: BlockLabels,
    /// Bounds of the cuts (`cut_extent`) and of the whole path (`full_extent`); `None` while
    /// empty.
    cut_extent: Option<PathExtent>,
    full_extent: Option<PathExtent>,
    /// Numbers of the tools that cut, in the order of their first cuts.
    tools: Vec<u8>,
    /// The end of the last cut of each tool, in the order of `tools`.
    last_cut_ends: Vec<Point>,
    times: ProgramTimes,
    scenery: PathScenery,
    omitted_moves: u64,
}

impl PathDrawing {
    /// Creates a drawing without a path. `title` is the text in its upper left corner.
    pub fn new(title: impl Into<String>, options: DrawingOptions) -> Self {
        Self {
            title: title.into(),
            options,
            pieces: PathPieces::default(),
            labels: BlockLabels::default(),
            cut_extent: None,
            full_extent: None,
            tools: Vec::new(),
            last_cut_ends: Vec::new(),
            times: ProgramTimes::default(),
            scenery: PathScenery::default(),
            omitted_moves: 0,
        }
    }

    /// Adds a move to the path. `rates` determine where rapids bend.
    pub fn add_move(&mut self, executed: &ExecutedMove, rates: RapidRates) {
        self.times.add_move(executed);
        if executed.kind == MoveKind::Dwell {
            return;
        }
        if self.omitted_moves > 0 {
            self.omitted_moves += 1;
            return;
        }
        let line_kind = self.line_kind(executed);
        if let PathLine::Cut(index) = line_kind
            && let Some(end) = self.last_cut_ends.get_mut(usize::from(index))
        {
            *end = executed.to;
        }
        let (from, to) = (executed.from, executed.to);
        let unplaced = executed.conditions.unplaced;
        if !unplaced.is_none() {
            // To the edge of the picture, or from there.
            let known = |end: PerAxis<bool>| !end.x && !end.z;
            if known(unplaced.from) {
                self.widen(line_kind, from);
                self.add_line(line_kind, from, far_point(from, unplaced.to));
            } else if known(unplaced.to) {
                self.widen(line_kind, to);
                self.add_line(line_kind, far_point(to, unplaced.from), to);
            }
            return;
        }
        self.widen(line_kind, from);
        self.widen(line_kind, to);
        match executed.kind {
            MoveKind::Dwell => {}
            MoveKind::Rapid => {
                if let Some(bend) = rapid_bend(from, to, rates) {
                    self.add_line(line_kind, from, bend);
                    self.add_line(line_kind, bend, to);
                } else {
                    self.add_line(line_kind, from, to);
                }
            }
            MoveKind::Feed | MoveKind::Thread | MoveKind::RunOut => {
                self.add_line(line_kind, from, to);
            }
            MoveKind::Clockwise | MoveKind::CounterClockwise => {
                let clockwise = executed.kind == MoveKind::Clockwise;
                let center = executed.center.unwrap_or(from);
                let mut last = from;
                for point in arc_points(from, to, center, clockwise, self.pieces.cell_mm()) {
                    self.widen(line_kind, point);
                    self.add_line(line_kind, last, point);
                    last = point;
                }
            }
        }
        if self.options.labels {
            self.labels.add_move(executed.source, to);
        }
    }

    /// Ends the program at machine time `time_s`: completes the times and the last label.
    pub fn end(&mut self, time_s: f64) {
        self.times.end_at(time_s);
        self.labels.end();
    }

    /// Draws part and clamping under the path, and tools and dimensions if the options include
    /// them. The legend then describes the tools.
    pub fn add_scenery(&mut self, machining: &Machining) {
        let ends = self
            .tools
            .iter()
            .copied()
            .zip(self.last_cut_ends.iter().copied());
        let ends = ends.filter(|_| self.options.tools).collect();
        self.scenery = PathScenery::from_machining(machining, ends, self.options.dimensions);
    }

    /// Fits a drawing without a path to the part, from the spindle axis on.
    pub fn fit_to_part(&mut self, machining: &Machining) {
        let section = machining.scene().part().section();
        for point in section.contours().iter().flatten() {
            let point = from_grid(*point);
            self.widen(PathLine::Cut(0), point);
            self.widen(PathLine::Cut(0), Point::new(0.0, point.z));
        }
    }

    /// Returns the part and its clamping, which are drawn under the path.
    pub(super) const fn scenery(&self) -> &PathScenery {
        &self.scenery
    }

    /// Number of moves that are missing in the drawing because they did not fit into memory.
    pub fn omitted_moves(&self) -> u64 {
        self.omitted_moves
    }

    /// Returns the options of the drawing.
    pub const fn options(&self) -> DrawingOptions {
        self.options
    }

    /// The bounds that the picture is fitted to; `None` without a path. A path without cuts is
    /// shown whole.
    pub(super) fn extent(&self) -> Option<PathExtent> {
        if self.options.shows_whole_path {
            return self.full_extent;
        }
        self.cut_extent.or(self.full_extent)
    }

    /// Returns the lines of the path.
    pub(super) const fn pieces(&self) -> &PathPieces {
        &self.pieces
    }

    /// Returns the end points of blocks with their labels, earlier blocks first.
    pub(super) fn labels(&self) -> Vec<(Point, String)> {
        self.labels.all()
    }

    /// The tools that cut, in the order of their first cuts: tool number, first offset number,
    /// times.
    pub(super) fn tools(&self) -> impl Iterator<Item = (u8, u8, TimesByUse)> + '_ {
        self.tools.iter().filter_map(|tool| {
            let mut times = self.times.tools().iter();
            times
                .find(|time| time.tool == *tool)
                .map(|time| (time.tool, time.offset, time.times))
        })
    }

    /// Returns the machine time of the whole program, by kind of activity.
    pub(super) const fn spent(&self) -> &TimesByUse {
        self.times.spent()
    }

    /// Whether a move is drawn as a rapid or as a cut of its tool. Adds a new tool to the
    /// list.
    fn line_kind(&mut self, executed: &ExecutedMove) -> PathLine {
        if executed.kind == MoveKind::Rapid {
            return PathLine::Rapid;
        }
        let tool = executed.conditions.tool;
        let known = self.tools.iter().position(|known| *known == tool);
        let index = known.unwrap_or_else(|| {
            self.tools.push(tool);
            self.last_cut_ends.push(executed.to);
            self.tools.len() - 1
        });
        // A control has no more than 100 tools.
        PathLine::Cut(u8::try_from(index).unwrap_or(u8::MAX))
    }

    fn add_line(&mut self, made: PathLine, from: Point, to: Point) {
        self.pieces.add_line(made, from, to);
        if self.pieces.has_room() {
            return;
        }
        let extent = self.extent();
        let size = extent.map_or(Point::default(), |extent| extent.high - extent.low);
        self.pieces.make_room(self.options.size.pixel_mm(size));
        if !self.pieces.has_room() {
            self.omitted_moves = 1;
        }
    }

    /// Widens the bounds of the path to include `point`, and coarsens the grid. If only the
    /// cuts are shown, the grid stays fine until the first cut shows how large the picture
    /// will be.
    fn widen(&mut self, made: PathLine, point: Point) {
        self.full_extent
            .get_or_insert(PathExtent::from_point(point))
            .widen(point);
        if made != PathLine::Rapid {
            self.cut_extent
                .get_or_insert(PathExtent::from_point(point))
                .widen(point);
        }
        let shown = if self.options.shows_whole_path {
            self.full_extent
        } else {
            self.cut_extent
        };
        if let Some(extent) = shown {
            let pixel = self.options.size.pixel_mm(extent.high - extent.low);
            self.pieces.fit_grid(pixel);
            self.labels.fit_cells(pixel * NUMBER_HEIGHT_PX);
        }
    }
}

/// Returns the point moved outside every picture along the axes whose position is unknown.
fn far_point(point: Point, unplaced: PerAxis<bool>) -> Point {
    /// Distance by which a point is moved outside every picture, mm.
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
    use gsk_core::command::{MoveConditions, ProgramId, SourcePosition};

    const RATES: RapidRates = RapidRates {
        x: 3800.0,
        z: 7600.0,
        straight: false,
    };

    fn executed(kind: MoveKind, from: Point, to: Point) -> ExecutedMove {
        ExecutedMove {
            source: SourcePosition {
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
            conditions: MoveConditions::default(),
        }
    }

    fn cut(drawing: &mut PathDrawing, from: Point, to: Point) {
        drawing.add_move(&executed(MoveKind::Feed, from, to), RATES);
    }

    #[test]
    fn what_is_drawn_again_takes_no_room() {
        let mut drawing = PathDrawing::new("", DrawingOptions::default());
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
        let mut drawing = PathDrawing::new("", DrawingOptions::default());
        drawing.add_move(
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
        let pixel = PictureSize::default().pixel_mm(Point::new(0.0, 60.0));
        assert!(drawing.pieces.cell_mm() <= pixel / 4.0 && drawing.pieces.cell_mm() > pixel / 8.0);
        assert!(drawing.pieces.len() <= (60.0 / drawing.pieces.cell_mm()) as usize + 2);
        assert_eq!(drawing.omitted_moves(), 0);
    }

    #[test]
    fn a_path_without_end_is_cut_off_and_counted() {
        let mut drawing = PathDrawing::new("", DrawingOptions::default());
        drawing.pieces = PathPieces::with_limit(1000);
        // Lines from one point to a thousand others, a pixel apart and more.
        for step in 0..3000 {
            let end = Point::new(f64::from(step % 50) * 10.0, f64::from(step / 50) * 10.0);
            cut(&mut drawing, Point::new(-7.0, -7.0), end);
        }
        assert!(drawing.pieces.len() <= 1000);
        assert_eq!(drawing.omitted_moves(), 3000 - 999);
    }

    #[test]
    fn a_coarser_grid_keeps_the_shape() {
        let mut drawing = PathDrawing::new("", DrawingOptions::default());
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
    fn the_picture_is_fitted_to_the_cuts_by_default() {
        let rapid = |from, to| executed(MoveKind::Rapid, from, to);
        let (far, near) = (Point::new(150.0, 300.0), Point::new(20.0, 2.0));
        let end = Point::new(20.0, -40.0);
        let fitted = |look: DrawingOptions| {
            let mut drawing = PathDrawing::new("", look);
            drawing.add_move(&rapid(far, near), RATES);
            cut(&mut drawing, near, end);
            drawing.add_move(&rapid(end, far), RATES);
            drawing.extent().expect("extent").high
        };
        assert_eq!(fitted(DrawingOptions::default()), near);
        let whole = DrawingOptions {
            shows_whole_path: true,
            ..DrawingOptions::default()
        };
        assert_eq!(fitted(whole), far);
        let mut drawing = PathDrawing::new("", DrawingOptions::default());
        drawing.add_move(&rapid(far, near), RATES);
        assert_eq!(drawing.extent().map(|extent| extent.high), Some(far));
    }

    #[test]
    fn every_tool_has_a_separate_colour_in_the_order_of_its_cuts() {
        let mut drawing = PathDrawing::new("", DrawingOptions::default());
        for (tool, kind) in [
            (4, MoveKind::Rapid),
            (7, MoveKind::Feed),
            (2, MoveKind::Thread),
            (7, MoveKind::Clockwise),
        ] {
            let mut made = executed(kind, Point::new(10.0, 0.0), Point::new(10.0, -10.0));
            made.conditions.tool = tool;
            drawing.add_move(&made, RATES);
        }
        let tools: Vec<u8> = drawing.tools().map(|(tool, ..)| tool).collect();
        assert_eq!(tools, [7, 2]);
        // The last cut is on the first one of its tool.
        let made: Vec<PathLine> = drawing.pieces.strokes().map(|(made, _)| made).collect();
        assert_eq!(made, [PathLine::Rapid, PathLine::Cut(0), PathLine::Cut(1)]);
    }
}
