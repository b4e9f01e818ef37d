//! Cuts the part while the control runs, tick by tick, in manual and automatic operation.

use gsk_core::cnc::Event;
use gsk_core::command::{BlockNumber, ProgramId, Source};
use gsk_core::operation::RunState;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_workpiece::motion::{MotionKind, ToolMotion};

use super::{Finding, Machining};

/// Greatest distance of a tick from a straight piece that it extends, mm: a grid unit.
const STRAIGHT: f64 = 0.000_1;
/// Ticks after which a piece is cut even if it continues: the time of a picture.
const LONGEST: u32 = 25;
/// Below this speed the spindle counts as stopped, r/min.
const STANDS: f64 = 1.0;

/// A part that follows a running control.
#[derive(Clone, Debug)]
pub struct Live {
    machining: Machining,
    /// Slide and spindle at the last tick.
    last: Option<Last>,
    piece: Option<Piece>,
    /// Number of findings that the caller has received.
    reported: usize,
    /// Whether the program has ended; the next one begins with new stock.
    ended: bool,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    /// Slide position, machine coordinates.
    slide: Point,
    /// Tip of the tool, part coordinates.
    tip: Point,
    turns: f64,
}

/// Ticks that continue straight in the same manner.
#[derive(Clone, Debug)]
struct Piece {
    from: Point,
    to: Point,
    ticks: u32,
    manner: Manner,
    /// Positions of the tool where it passed the drawn plane.
    imprints: Vec<Point>,
}

/// What must stay the same within a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Manner {
    tool: u8,
    rapid: bool,
    thread: bool,
    turning: bool,
    source: Option<Source>,
}

impl Live {
    /// Follows a control with this part, which must be uncut.
    pub const fn new(machining: Machining) -> Self {
        Self {
            machining,
            last: None,
            piece: None,
            reported: 0,
            ended: false,
        }
    }

    /// The part and its collisions so far.
    pub const fn machining(&self) -> &Machining {
        &self.machining
    }

    /// Clamps new stock and discards the findings.
    pub fn fresh_stock(&mut self) {
        self.piece = None;
        self.machining.fresh_stock();
        self.reported = 0;
    }

    /// Follows one tick of the control. Call it after every tick. Returns the collisions found
    /// since the last call.
    pub fn ticked(&mut self, simulation: &Simulation) -> &[Finding] {
        let cnc = &simulation.cnc;
        let tool = simulation.lathe.station().unwrap_or(cnc.tool().0);
        let frame = cnc.frame();
        let manner = Manner {
            tool,
            rapid: cnc.moves_at_rapid(),
            thread: cnc.in_thread(),
            turning: simulation.lathe.spindle_rpm().abs() > STANDS,
            source: moving(simulation),
        };
        self.change_stock(simulation);
        if !manner.rapid && manner.source.is_some() && cnc.is_moving() {
            self.machining.track.mounting_mut().settle(tool, &frame);
        }
        let tip = |slide| self.machining.mounting().tip(tool, slide, &frame);
        let slide = cnc.position_machine();
        let now = Last {
            slide,
            tip: tip(slide),
            turns: simulation.lathe.spindle_turns(),
        };
        // Position before, in present coordinates: G50 and T move nothing.
        let before = self.last.map(|last| Last {
            tip: tip(last.slide),
            ..last
        });
        self.last = Some(now);
        match before {
            Some(before) if before.slide != slide => self.step(manner, before, now),
            // At standstill the pending motion shows at once.
            _ => self.flush(),
        }
        let first = self.reported.min(self.machining.findings.len());
        self.reported = self.machining.findings.len();
        &self.machining.findings[first..]
    }

    /// Clamps new stock when the next program starts after the end of one.
    fn change_stock(&mut self, simulation: &Simulation) {
        for event in simulation.cnc.events() {
            match event {
                Event::ProgramEnded { .. } => self.ended = true,
                Event::BlockBegan(source, _) if self.ended && source.program != ProgramId::Mdi => {
                    self.ended = false;
                    self.fresh_stock();
                }
                _ => {}
            }
        }
    }

    fn step(&mut self, manner: Manner, before: Last, now: Last) {
        let goes_on = self
            .piece
            .as_ref()
            .is_some_and(|piece| piece.manner == manner && piece.goes_on(before.tip, now.tip));
        if !goes_on {
            self.flush();
        }
        let piece = self.piece.get_or_insert_with(|| Piece {
            from: before.tip,
            to: before.tip,
            ticks: 0,
            manner,
            imprints: Vec::new(),
        });
        piece.to = now.tip;
        piece.ticks += 1;
        if manner.thread {
            piece.imprints.extend(crossing(before, now));
        }
        if piece.ticks >= LONGEST {
            self.flush();
        }
    }

    /// Cuts the pending piece.
    fn flush(&mut self) {
        let Some(piece) = self.piece.take() else {
            return;
        };
        let kind = match (piece.manner.thread, piece.manner.rapid) {
            (true, _) => MotionKind::Thread(piece.imprints),
            (false, true) => MotionKind::Rapid,
            (false, false) => MotionKind::Line,
        };
        let motion = ToolMotion {
            from: piece.from,
            to: piece.to,
            kind,
            turning: piece.manner.turning,
        };
        self.machining
            .carry_out(piece.manner.source, piece.manner.tool, &motion);
    }
}

impl Piece {
    /// Whether a tick continues at the end of the piece, in its direction.
    fn goes_on(&self, from: Point, to: Point) -> bool {
        let along = self.to - self.from;
        let Some(direction) = along.unit() else {
            return from == self.to;
        };
        let beyond = to - self.from;
        from == self.to
            && direction.cross(beyond).abs() <= STRAIGHT
            && direction.dot(to - from) > 0.0
    }
}

/// The block in execution in automatic operation; between two blocks the last one. `None`
/// after the end of an MDI block and when nothing runs.
pub fn running(simulation: &Simulation) -> Option<Source> {
    let cnc = &simulation.cnc;
    let cursor = cnc.cursor();
    let program = cursor.program.filter(|program| match cnc.run_state() {
        RunState::Reset => false,
        RunState::Stop => *program != ProgramId::Mdi,
        RunState::Run | RunState::Hold => true,
    });
    program.map(|program| Source {
        program,
        line: cursor.line,
        sequence: cursor.sequence.map(BlockNumber::from),
    })
}

/// The block that moves the tool; `None` in manual operation.
fn moving(simulation: &Simulation) -> Option<Source> {
    let by_program = matches!(simulation.cnc.run_state(), RunState::Run | RunState::Hold);
    running(simulation).filter(|_| by_program)
}

/// Position of the tip when the spindle passed the drawn plane between two ticks.
fn crossing(before: Last, now: Last) -> Option<Point> {
    let (low, high) = (before.turns.min(now.turns), before.turns.max(now.turns));
    let whole = high.floor();
    if whole <= low || high <= low {
        return None;
    }
    let part = (whole - before.turns) / (now.turns - before.turns);
    Some(before.tip + (now.tip - before.tip) * part)
}
