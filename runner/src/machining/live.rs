//! The part while the control runs: tick by tick, by hand as in automatic operation.

use gsk_core::cnc::Event;
use gsk_core::command::{BlockNumber, ProgramId, Source};
use gsk_core::operation::RunState;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_workpiece::motion::{MotionKind, ToolMotion};

use super::{Finding, Machining};

/// How far a tick may lie beside a straight piece that goes on, mm: a grid unit.
const STRAIGHT: f64 = 0.000_1;
/// Ticks after which a piece is carried out even if it goes on: a picture's time.
const LONGEST: u32 = 25;
/// Below that the spindle stands, r/min.
const STANDS: f64 = 1.0;

/// A part that follows a control.
#[derive(Clone, Debug)]
pub struct Live {
    machining: Machining,
    /// Slide and spindle at the last tick.
    last: Option<Last>,
    piece: Option<Piece>,
    /// Findings up to here were handed out.
    reported: usize,
    /// The program had ended; with the next one new stock is clamped.
    ended: bool,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    /// Of the slide, machine coordinates.
    slide: Point,
    /// Of the tool in the part.
    tip: Point,
    turns: f64,
}

/// Ticks that go straight on in the same way.
#[derive(Clone, Debug)]
struct Piece {
    from: Point,
    to: Point,
    ticks: u32,
    manner: Manner,
    /// Where the tool passed the drawn plane.
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
    /// A part that has not been touched.
    pub const fn new(machining: Machining) -> Self {
        Self {
            machining,
            last: None,
            piece: None,
            reported: 0,
            ended: false,
        }
    }

    /// The part and its findings.
    pub const fn machining(&self) -> &Machining {
        &self.machining
    }

    /// New stock is clamped.
    pub fn fresh_stock(&mut self) {
        self.piece = None;
        self.machining.fresh_stock();
        self.reported = 0;
    }

    /// After a tick: returns collisions that were met in it.
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
        // Where it was by the coordinates of now: G50 and T move nothing.
        let before = self.last.map(|last| Last {
            tip: tip(last.slide),
            ..last
        });
        self.last = Some(now);
        match before {
            Some(before) if before.slide != slide => self.step(manner, before, now),
            // It stands: what is pending is seen at once.
            _ => self.flush(),
        }
        let first = self.reported.min(self.machining.findings.len());
        self.reported = self.machining.findings.len();
        &self.machining.findings[first..]
    }

    /// After the end of a program the next one begins on new stock.
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

    /// Carries out what is pending.
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
    /// Whether a tick goes on where the piece ends, in its direction.
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

/// The block under way in automatic operation; between two blocks the one that was
/// carried out. A block of MDI is over when it has ended.
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

/// The block that moves the tool; none by hand.
fn moving(simulation: &Simulation) -> Option<Source> {
    let by_program = matches!(simulation.cnc.run_state(), RunState::Run | RunState::Hold);
    running(simulation).filter(|_| by_program)
}

/// Where the tip stood when the spindle passed the drawn plane between two ticks.
fn crossing(before: Last, now: Last) -> Option<Point> {
    let (low, high) = (before.turns.min(now.turns), before.turns.max(now.turns));
    let whole = high.floor();
    if whole <= low || high <= low {
        return None;
    }
    let part = (whole - before.turns) / (now.turns - before.turns);
    Some(before.tip + (now.tip - before.tip) * part)
}
