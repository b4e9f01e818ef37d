//! Executes a program in the full kernel, as fast as the PC can. It presses the keys that an
//! operator presses, and the ladder reacts. With a pulse board the board sets the pace, and
//! the operator presses cycle start after each stop.

mod board;

use gsk_core::alarm::Alarm;
use gsk_core::cnc::Event;
use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::interpreter::{Explanation, Modal};
use gsk_core::operation::{Mode, RunState};
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::simulation::Simulation;
use gsk_core::units::{Point, TICK_MS};
use gsk_messages::{Language, Message, say};

pub use board::Board;
use board::Standing;

use crate::moves::{counts, rounded};
use crate::partner::{Partner, Patience};
use crate::report::{self, AlarmReport, Final, Report};

const AUTO_KEY: BitAddress = BitAddress::new(Area::X, 20, 1);
const START_KEY: BitAddress = BitAddress::new(Area::X, 25, 0);
const M03_OUTPUT: BitAddress = BitAddress::new(Area::Y, 1, 2);
const M04_OUTPUT: BitAddress = BitAddress::new(Area::Y, 0, 4);
/// How long a key is held, and the pause after it.
const PRESS_MS: u32 = 100;
/// Time limit for the axes to stop and for the last outputs to switch off after the end.
const SETTLE_MS: u32 = 5000;

/// Why a program cannot be executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum ExecutionError {
    /// DNC is requested, but the ladder has no keys to select DNC.
    NoWayToDnc,
}

impl ExecutionError {
    /// The message for the user.
    pub fn message(self) -> Message {
        match self {
            Self::NoWayToDnc => say::dnc_no_way(),
        }
    }
}

/// When an execution ends, if the program does not end it.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// After this number of parts.
    pub parts: u32,
    /// After this machine time, ms.
    pub time_ms: u64,
}

/// Receives the progress of an execution.
pub trait Watcher {
    /// A move was executed. Its times, s, count from cycle start.
    fn moved(&mut self, executed: &ExecutedMove);
    /// A tick has passed, `time_ms` after cycle start. `machine` is the position of the
    /// slides. Returning true ends the run: a tool hit something.
    fn ticked(&mut self, time_ms: u64, machine: Point, simulation: &Simulation) -> bool;
    /// A block begins. `line` counts from 1, `modal` holds the words in force.
    fn block(&mut self, line: u32, text: &str, modal: &Modal);
    /// A pass of a cycle begins. Called only if [`Watcher::wants_explanations`] is true.
    fn pass(&mut self, explanation: &Explanation);
    /// Whether the passes of cycles are to be explained.
    fn wants_explanations(&self) -> bool;
    /// Shows a message to the operator at the terminal.
    fn tell(&mut self, said: &Message);
}

/// How a program ended.
#[derive(Clone, Debug, PartialEq)]
enum End {
    M30,
    M02,
    M99,
    Text,
    /// An alarm or a message of the ladder. Both hold the program.
    Alarm(Alarm),
    /// Cycle start has no effect, for this reason.
    Refused(Message),
    /// The program is stopped at a board, and no operator is there to press cycle start.
    Stop(Message),
    /// The end was requested: Ctrl-C, `kill`.
    Asked,
    /// A tool hit something, and the watcher ends the run for it.
    Collision,
    Limit,
}

struct Run<'a> {
    simulation: Simulation,
    partner: Option<&'a mut dyn Partner>,
    board: Option<Board>,
    standing: Standing,
    watcher: &'a mut dyn Watcher,
    start_ticks: u64,
    /// Whether the run has started.
    begun: bool,
    wanted_parts: u32,
    parts: u32,
    stops: u32,
    blocks: u64,
    moves: u64,
    cutting_s: f64,
    /// End of the last counted move and modal state of the last counted block.
    last_point: Option<Point>,
    last_modal: Option<Modal>,
    ended: Option<End>,
}

/// Executes the selected program on the simulated lathe or on a board. With `partner` the
/// program comes from the partner in DNC operation. Returns the report, with texts in
/// `language` (English if `None`), and the control as it is after the end.
///
/// # Errors
/// The ladder has no keys to select DNC.
pub fn execute<'a>(
    name: &str,
    simulation: Simulation,
    limits: Limits,
    partner: Option<&'a mut dyn Partner>,
    board: Option<Board>,
    watcher: &'a mut dyn Watcher,
    language: Option<Language>,
) -> Result<(Report, Simulation), ExecutionError> {
    let before = simulation.cnc.parameters().clone();
    let mut run = Run {
        simulation,
        partner,
        board,
        standing: Standing::default(),
        watcher,
        start_ticks: 0,
        begun: false,
        wanted_parts: limits.parts,
        parts: 0,
        stops: 0,
        blocks: 0,
        moves: 0,
        cutting_s: 0.0,
        last_point: None,
        last_modal: None,
        ended: None,
    };
    run.simulation.cnc.explain(run.watcher.wants_explanations());
    run.prepare_board();
    run.press(AUTO_KEY);
    if run.partner.is_some() {
        run.press(AUTO_KEY);
        if run.ended.is_none() && run.simulation.cnc.mode() != Mode::Dnc {
            return Err(ExecutionError::NoWayToDnc);
        }
    }
    if run.ended.is_none() {
        run.start();
    }
    let end = run.run_to_end(limits);
    let time_ms = run.time_ms();
    let waits_for = match &end {
        End::Refused(why) | End::Stop(why) => Some(report::said(why, language)),
        End::Limit => (run.simulation.cnc.waits_for()).map(|what| report::said(&what, language)),
        _ => None,
    };
    run.come_to_rest();
    run.close_board();
    let cnc = &run.simulation.cnc;
    let alarm = match &end {
        End::Alarm(alarm) => Some(AlarmReport::new(alarm, cnc.programs(), language)),
        _ => None,
    };
    let turns = |address| cnc.plc().memory().bit(address);
    // After the last requested part an M99 has started another one.
    let (beyond, modal) = match end {
        End::M99 => (
            run.last_point
                .map_or(Point::default(), |point| cnc.position_absolute() - point),
            run.last_modal.unwrap_or(*cnc.modal()),
        ),
        _ => (Point::default(), *cnc.modal()),
    };
    let report = Report {
        file: name.to_owned(),
        end: match end {
            End::M30 => report::End::M30,
            End::M02 => report::End::M02,
            End::M99 => report::End::M99,
            End::Text => report::End::Text,
            End::Alarm(_) => report::End::Alarm,
            End::Refused(_) => report::End::Refused,
            End::Stop(_) => report::End::Stop,
            End::Asked => report::End::Asked,
            End::Collision => report::End::Collision,
            End::Limit => report::End::Limit,
        },
        alarm,
        waits_for,
        time_s: time_ms as f64 / 1000.0,
        cutting_s: rounded(run.cutting_s),
        blocks: run.blocks,
        moves: run.moves,
        parts: run.parts,
        stops: run.stops,
        position: Final::new(
            cnc.position_absolute() - beyond,
            cnc.position_machine() - beyond,
            cnc.position_relative() - beyond,
        ),
        modal: report::modal_codes(&modal),
        f: modal.feed,
        s: modal.spindle,
        t: report::tool_word(cnc.tool()),
        spindle: if turns(M03_OUTPUT) {
            "cw"
        } else if turns(M04_OUTPUT) {
            "ccw"
        } else {
            "stop"
        },
        coolant: cnc.plc().memory().y(5) & 1 != 0,
        parameters_changed: report::changed(&before, cnc.parameters()),
        warnings: Vec::new(),
        path: None,
        part: None,
    };
    Ok((report, run.simulation))
}

impl Run<'_> {
    fn time_ms(&self) -> u64 {
        if self.start_ticks == 0 {
            return 0;
        }
        (self.simulation.cnc.ticks() - self.start_ticks) * u64::from(TICK_MS)
    }

    fn press(&mut self, key: BitAddress) {
        self.simulation.cnc.set_panel_key(key, true);
        self.ticks(PRESS_MS);
        self.simulation.cnc.set_panel_key(key, false);
        self.ticks(PRESS_MS);
    }

    fn ticks(&mut self, ms: u32) {
        for _ in 0..ms / TICK_MS {
            self.tick();
        }
    }

    /// Presses cycle start and waits until the run has started. Machine time counts from
    /// there.
    fn start(&mut self) {
        self.simulation.cnc.set_panel_key(START_KEY, true);
        self.ticks(PRESS_MS);
        self.simulation.cnc.set_panel_key(START_KEY, false);
        let first = self.start_ticks == 0;
        for _ in 0..PRESS_MS {
            if first {
                self.start_ticks = self.simulation.cnc.ticks();
            }
            self.tick();
            if self.simulation.cnc.run_state() == RunState::Run || self.ended.is_some() {
                return;
            }
        }
    }

    fn run_to_end(&mut self, limits: Limits) -> End {
        loop {
            if let Some(end) = self.ended.take() {
                let more = self.parts < limits.parts;
                match end {
                    // Another part: start the cycle again.
                    End::M30 | End::M02 | End::Text if more && self.parts > 0 => {
                        if self.may_begin_another() {
                            self.press_again();
                        } else if self.ended.is_none() {
                            self.ended = Some(End::Stop(say::run_next_part()));
                        }
                        continue;
                    }
                    end => return end,
                }
            }
            if self.parts >= limits.parts {
                return End::M99;
            }
            if self.time_ms() >= limits.time_ms {
                return End::Limit;
            }
            self.tick();
            if self.board.is_some() {
                self.attend();
                continue;
            }
            let cnc = &self.simulation.cnc;
            let idle = cnc.run_state() == RunState::Stop && !cnc.is_moving();
            if idle && self.ended.is_none() {
                self.stops += 1;
                self.press_again();
            } else if cnc.run_state() == RunState::Reset && self.ended.is_none() {
                self.ended = Some(self.refused().unwrap_or(End::Text));
            }
        }
    }

    /// Why nothing runs although cycle start was pressed; `None` if the program runs.
    fn refused(&self) -> Option<End> {
        let cnc = &self.simulation.cnc;
        let stands = matches!(cnc.run_state(), RunState::Reset | RunState::Stop);
        let why = cnc.refuses_start().filter(|_| stands);
        why.filter(|_| !self.begun || cnc.run_state() == RunState::Stop)
            .map(End::Refused)
    }

    fn press_again(&mut self) {
        self.start();
        if self.ended.is_none() {
            self.ended = self.refused();
        }
    }

    /// Waits until the axes stop.
    fn settle(&mut self) {
        for _ in 0..SETTLE_MS {
            if !self.simulation.cnc.is_moving() {
                break;
            }
            self.tick();
        }
    }

    fn tick(&mut self) {
        if !self.may_tick() {
            return;
        }
        if let Some(partner) = &mut self.partner {
            // A board does not wait for the partner.
            let patience = match self.board {
                Some(_) => Patience::None,
                None => Patience::Waits,
            };
            partner.feed(&mut self.simulation.cnc, patience);
        }
        self.simulation.tick();
        if let Some(board) = &mut self.board {
            board.live.after(&mut self.simulation);
        }
        self.begun |= self.start_ticks != 0 && self.simulation.cnc.run_state() == RunState::Run;
        let cnc = &self.simulation.cnc;
        if self.ended.is_none() {
            // The message holds the program, and cycle start does not continue it.
            self.ended = cnc.standing_message().map(End::Alarm);
        }
        let start_s = self.start_ticks as f64 / 1000.0;
        for event in cnc.events() {
            // A loop without motion finishes several parts in a tick. Events after the last
            // requested part do not count.
            let enough = self.parts >= self.wanted_parts;
            match event {
                Event::BlockBegan(..)
                | Event::BlockEnded(_)
                | Event::PartFinished
                | Event::Moved(_)
                    if enough => {}
                Event::Moved(executed) => {
                    self.last_point = Some(executed.to);
                    let mut executed = *executed;
                    executed.start_s = (executed.start_s - start_s).max(0.0);
                    if counts(&executed) {
                        self.moves += 1;
                        if !matches!(executed.kind, MoveKind::Rapid | MoveKind::Dwell) {
                            self.cutting_s += executed.duration_s;
                        }
                        self.watcher.moved(&executed);
                    }
                }
                Event::BlockEnded(_) => self.blocks += 1,
                Event::Explained(explanation) => self.watcher.pass(explanation),
                Event::BlockBegan(source, modal) => {
                    self.last_modal = Some(*modal);
                    let program = cnc.programs().get(source.program);
                    let text = program.map_or("", |program| program.line(source.line));
                    self.watcher.block(source.line, text.trim(), modal);
                }
                Event::AlarmRaised(alarm) if self.ended.is_none() => {
                    self.ended = Some(End::Alarm(alarm.clone()));
                }
                Event::PartFinished => self.parts += 1,
                Event::ProgramEnded { m30, m02 } if self.ended.is_none() => {
                    self.ended = Some(match (m30, m02) {
                        (_, true) => End::M02,
                        (true, false) => End::M30,
                        (false, false) => End::Text,
                    });
                }
                Event::AlarmRaised(_) | Event::ProgramEnded { .. } | Event::Advised(_) => {}
            }
        }
        if self.begun {
            let time_ms = self.time_ms();
            let machine = self.simulation.cnc.position_machine();
            let collided = self.watcher.ticked(time_ms, machine, &self.simulation);
            if collided && self.ended.is_none() {
                self.ended = Some(End::Collision);
            }
        }
    }
}
