//! Cutter radius compensation of a mill. A program names the centre of the cutter, so there
//! is no imaginary tip. Moves are passed as they lie in the plane of G17 to G19. The caller
//! keeps all other data of a move, its block included, under a number.

use super::{CommandContext, CompensationSettings, Nose, NoseCompensation};
use crate::alarm::Alarm;
use crate::command::{Action, ControlCommand, Frame, ModalState, ProgramId, SourcePosition};
use crate::units::{Feed, Point};

/// A move in the plane of G17 to G19. In its points `z` is along the first axis of the plane
/// and `x` along the second, mm; clockwise is as seen in this view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatMove {
    /// The number under which the caller keeps the other data of the move.
    pub number: u32,
    /// Line of the block in its program, for alarms.
    pub line: u32,
    /// End point of the move, mm.
    pub to: Point,
    /// Whether the move is a rapid, a line or an arc.
    pub shape: FlatShape,
}

/// The kind of a move in the plane, with the data of an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FlatShape {
    /// The move is a rapid to the end point.
    Rapid,
    /// The move is a straight cut.
    Line,
    /// The move is a cut along an arc.
    Arc {
        /// Centre of the arc, mm.
        center: Point,
        /// Whether the arc is clockwise, in the view of [`FlatMove`].
        clockwise: bool,
    },
}

/// The side of the contour on which the cutter runs, seen in the direction of the cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CutterSide {
    /// G40: the tool centre is on the contour, without compensation.
    On,
    /// G41: the tool is left of the contour.
    Left,
    /// G42: the tool is right of the contour.
    Right,
}

/// An output of the compensation: a move, or a block without a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CutterOutput {
    /// A move of the cutter centre. A corner may turn one pushed move into several; only the
    /// last of them is the move itself, the others lead around the corner before it.
    Move {
        /// The compensated move; its `number` is that of the pushed move.
        flat: FlatMove,
        /// Whether this is the last move with its `number`.
        last: bool,
    },
    /// The number of a block that was pushed without motion in the plane.
    Other(u32),
}

/// Cutter compensation: converts programmed moves into moves of the cutter centre.
#[derive(Clone, Debug, Default)]
pub struct CutterCompensation {
    stream: NoseCompensation,
}

impl CutterCompensation {
    /// Creates a compensation that is off, with the settings of the control.
    pub fn new(settings: CompensationSettings) -> Self {
        Self {
            stream: NoseCompensation::with_settings(settings),
        }
    }

    /// Whether compensation is active: from the move that starts it to the move that cancels it.
    pub const fn is_on(&self) -> bool {
        self.stream.is_on()
    }

    /// Sets the position of the cutter centre in the plane before the first move, mm.
    pub fn set_position(&mut self, point: Point) {
        self.stream.set_position(point, Frame::default());
    }

    /// Accepts a programmed move with the active side of the cutter and its radius, mm.
    pub fn push(&mut self, flat: FlatMove, side: CutterSide, radius: f64) {
        let feed = Feed::PerMinute(1.0);
        let action = match flat.shape {
            FlatShape::Rapid => Action::Rapid { to: flat.to },
            FlatShape::Line => Action::Line { to: flat.to, feed },
            FlatShape::Arc { center, clockwise } => Action::Arc {
                to: flat.to,
                center,
                clockwise,
                feed,
            },
        };
        let nose = Nose {
            radius,
            direction: 0,
        };
        self.push_action((flat.number, flat.line), action, side, nose, true);
    }

    /// Accepts a block without motion in the plane; [`take`](Self::take) returns its `number` in
    /// [`CutterOutput::Other`]. `side` is the active side of the cutter.
    pub fn push_other(&mut self, number: u32, side: CutterSide) {
        let nose = Nose::default();
        self.push_action((number, 0), Action::Nothing, side, nose, true);
    }

    /// Accepts motion that is not compensated and ends at `to`, mm; the cutter centre first ends
    /// the move before it on the programmed point. `number` is that of the motion, `side` the
    /// active side of the cutter.
    pub fn push_uncompensated(&mut self, number: u32, to: Point, side: CutterSide) {
        let nose = Nose::default();
        self.push_action((number, 0), Action::Rapid { to }, side, nose, false);
    }

    fn push_action(
        &mut self,
        (number, line): (u32, u32),
        action: Action,
        side: CutterSide,
        nose: Nose,
        contour: bool,
    ) {
        let command = ControlCommand {
            source: SourcePosition {
                program: ProgramId::External,
                line,
                // Here the sequence number is the number of the move.
                sequence: Some(number.into()),
            },
            action,
            modal: ModalState {
                nose_compensation: match side {
                    CutterSide::On => 40,
                    CutterSide::Left => 41,
                    CutterSide::Right => 42,
                },
                // Any offset number but 0: the caller knows whether the offset is 0.
                offset: 1,
                ..ModalState::default()
            },
            block_end: true,
            stop_point: true,
            defers_feed_hold: false,
            programmed_x: None,
        };
        let origin = CommandContext {
            contour,
            nose,
            offset_by_shift: false,
        };
        self.stream.push(command, origin);
        // Contours of a mill are closed: the end of a contour may cross its beginning.
        self.stream.recent_paths.keep_last();
    }

    /// Releases the last pushed move. Because no further move is known, the vector at its end is
    /// perpendicular to the move.
    pub fn flush(&mut self) {
        self.stream.flush();
    }

    /// Removes and returns the next compensated move or block; `None` until more moves are pushed.
    ///
    /// # Errors
    /// The alarm at which compensation ends; the sequence number of its source is the number
    /// of the move.
    pub fn take(&mut self) -> Option<Result<CutterOutput, Alarm>> {
        let command = match self.stream.take()? {
            Ok(command) => command,
            Err(alarm) => return Some(Err(alarm)),
        };
        let number = command.source.sequence.map_or(0, u32::from);
        let line = command.source.line;
        let (to, shape) = match command.action {
            Action::Rapid { to } => (to, FlatShape::Rapid),
            Action::Line { to, .. } => (to, FlatShape::Line),
            Action::Arc {
                to,
                center,
                clockwise,
                ..
            } => (to, FlatShape::Arc { center, clockwise }),
            _ => return Some(Ok(CutterOutput::Other(number))),
        };
        let flat = FlatMove {
            number,
            line,
            to,
            shape,
        };
        let last = command.block_end;
        Some(Ok(CutterOutput::Move { flat, last }))
    }
}
