//! Executes a program in the full kernel, as fast as the PC can. It presses the keys that an
//! operator presses, and the ladder reacts. With a pulse board the board sets the pace, and
//! the operator presses cycle start after each stop.

mod board;
mod board_restart;

use gsk_core::alarm::Alarm;
use gsk_core::cnc::Event;
use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::interpreter::{Explanation, ModalState};
use gsk_core::machine::LatheFault;
use gsk_core::memory::ControlParameters;
use gsk_core::operation::{OperatingMode, RunState};
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::simulation::Simulation;
use gsk_core::units::{Point, TICK_MS};
use gsk_messages::{Language, Message, say};

use board::StopState;
pub use board::SupervisedBoard;

use crate::machining::live_part::LivePart;
use crate::move_output::{is_reported, round_to_millionth};
use crate::partner::{PartnerWait, ProgramPartner};
use crate::report::{self, AlarmReport, FinalPositions, ProgramReport};

const AUTO_KEY: BitAddress = BitAddress::new(Area::X, 20, 1);
const START_KEY: BitAddress = BitAddress::new(Area::X, 25, 0);
const M03_OUTPUT: BitAddress = BitAddress::new(Area::Y, 1, 2);
const M04_OUTPUT: BitAddress = BitAddress::new(Area::Y, 0, 4);
/// Time for which a panel key is held, and duration of the pause after it, ms.
const PRESS_MS: u32 = 100;
/// Time limit for the axes to stop and for the last outputs to switch off after the end, ms.
const SETTLE_MS: u32 = 5000;

/// Why a program cannot be executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum ExecutionError {
    /// DNC is requested, but the ladder has no keys to select DNC.
    NoDncKeys,
}

impl ExecutionError {
    /// Returns the message that explains why the program cannot be executed.
    pub fn message(self) -> Message {
        match self {
            Self::NoDncKeys => say::dnc_no_way(),
        }
    }
}

/// The limits at which an execution ends if the program does not end earlier.
#[derive(Clone, Copy, Debug)]
pub struct ExecutionLimits {
    /// The execution ends after this number of parts.
    pub parts: u32,
    /// The execution ends after this machine time, ms.
    pub time_ms: u64,
}

/// The reason for which a watcher ends an execution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WatcherStop {
    /// A tool has collided, and the run was set to end then.
    Collision,
    /// The run has reached the location at which it was set to end.
    Location,
    /// A cut above the limits has stalled the spindle or loosened the stock.
    Overload,
}

/// Receives the progress of an execution.
pub trait ExecutionWatcher {
    /// Called when a move has been executed. The times of `executed`, s, count from cycle
    /// start.
    fn on_move(&mut self, executed: &ExecutedMove);
    /// Called after each tick, `time_ms` after cycle start. `machine` is the position of the
    /// slides in machine coordinates. Returns why the run must end; `None` to continue.
    fn on_tick(
        &mut self,
        time_ms: u64,
        machine: Point,
        simulation: &Simulation,
    ) -> Option<WatcherStop>;
    /// The fault that the cut of the last tick has caused in the simulated lathe; `None` without
    /// one.
    fn cut_fault(&self) -> Option<LatheFault> {
        None
    }
    /// Called when a block begins. `line` counts from 1; `modal` holds the G codes, F, S and T
    /// in force.
    fn on_block(&mut self, line: u32, text: &str, modal: &ModalState);
    /// Called when a pass of a cycle begins, only if [`ExecutionWatcher::wants_explanations`]
    /// is true.
    fn on_pass(&mut self, explanation: &Explanation);
    /// Whether the control should explain the passes of cycles to `on_pass`.
    fn wants_explanations(&self) -> bool;
    /// Shows a message to the operator at the terminal.
    fn show(&mut self, message: &Message);
    /// Called when a run on a board begins in the middle of its program, with the part that the
    /// skipped blocks leave.
    fn on_restart(&mut self, _part: Option<LivePart>) {}
}

/// The reason for which an execution ended.
#[derive(Clone, Debug, PartialEq)]
enum ExecutionEnd {
    M30,
    M02,
    M99,
    Text,
    /// An alarm, or a message of the PLC ladder, holds the program.
    Alarm(Alarm),
    /// Cycle start has no effect, for the reason in the message.
    Refused(Message),
    /// The program stopped on a board, and no operator is at the terminal to continue it; the
    /// message describes the stop.
    Stop(Message),
    /// The user requested the end: Ctrl-C or `kill`.
    Requested,
    /// The watcher ends the run.
    Watcher(WatcherStop),
    Limit,
}

impl ExecutionEnd {
    /// Converts to the kind of end that reports name.
    const fn to_run_end(&self) -> report::RunEnd {
        match self {
            Self::M30 => report::RunEnd::M30,
            Self::M02 => report::RunEnd::M02,
            Self::M99 => report::RunEnd::M99,
            Self::Text => report::RunEnd::Text,
            Self::Alarm(_) => report::RunEnd::Alarm,
            Self::Refused(_) => report::RunEnd::Refused,
            Self::Stop(_) => report::RunEnd::Stop,
            Self::Requested => report::RunEnd::Requested,
            Self::Watcher(WatcherStop::Collision) => report::RunEnd::Collision,
            Self::Watcher(WatcherStop::Location) => report::RunEnd::Location,
            Self::Watcher(WatcherStop::Overload) => report::RunEnd::Overload,
            Self::Limit => report::RunEnd::Limit,
        }
    }
}

struct ProgramRun<'a> {
    simulation: Simulation,
    partner: Option<&'a mut dyn ProgramPartner>,
    board: Option<SupervisedBoard>,
    stop_state: StopState,
    watcher: &'a mut dyn ExecutionWatcher,
    start_ticks: u64,
    /// Whether the program has run since cycle start was pressed.
    has_begun: bool,
    wanted_parts: u32,
    parts: u32,
    stops: u32,
    blocks: u64,
    moves: u64,
    cutting_s: f64,
    /// End of the last counted move, mm; `None` before the first one. The next field is the modal
    /// state of the last counted block.
    last_point: Option<Point>,
    last_modal: Option<ModalState>,
    pending_end: Option<ExecutionEnd>,
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
    limits: ExecutionLimits,
    partner: Option<&'a mut dyn ProgramPartner>,
    board: Option<SupervisedBoard>,
    watcher: &'a mut dyn ExecutionWatcher,
    language: Option<Language>,
) -> Result<(ProgramReport, Simulation), ExecutionError> {
    let before = simulation.cnc.parameters().clone();
    let mut run = ProgramRun {
        simulation,
        partner,
        board,
        stop_state: StopState::default(),
        watcher,
        start_ticks: 0,
        has_begun: false,
        wanted_parts: limits.parts,
        parts: 0,
        stops: 0,
        blocks: 0,
        moves: 0,
        cutting_s: 0.0,
        last_point: None,
        last_modal: None,
        pending_end: None,
    };
    run.simulation
        .cnc
        .set_explaining(run.watcher.wants_explanations());
    run.prepare_board();
    run.prepare_board_restart();
    run.press(AUTO_KEY);
    if run.partner.is_some() {
        run.press(AUTO_KEY);
        if run.pending_end.is_none() && run.simulation.cnc.mode() != OperatingMode::Dnc {
            return Err(ExecutionError::NoDncKeys);
        }
    }
    if run.pending_end.is_none() {
        run.press_cycle_start();
    }
    let end = run.run_to_end(limits);
    let time_ms = run.time_ms();
    let waits_for = run.wait_text(&end, language);
    if end == ExecutionEnd::Watcher(WatcherStop::Overload) {
        // Moving slides would cut stock that does not turn.
        run.press(board::FEED_HOLD_KEY);
    }
    run.stop_motion();
    run.close_board();
    let time_s = time_ms as f64 / 1000.0;
    let report = run.report(name, &end, time_s, waits_for, &before, language);
    Ok((report, run.simulation))
}

impl ProgramRun<'_> {
    /// Returns the text why cycle start was refused, or about the condition for which the program
    /// waits; `None` after any other end.
    fn wait_text(&self, end: &ExecutionEnd, language: Option<Language>) -> Option<String> {
        match end {
            ExecutionEnd::Refused(why) | ExecutionEnd::Stop(why) => {
                Some(report::message_text(why, language))
            }
            ExecutionEnd::Limit => (self.simulation.cnc.wait_reason())
                .map(|what| report::message_text(&what, language)),
            _ => None,
        }
    }

    /// Creates the report on a program that ran for `time_s`. `before` holds the parameters
    /// before its start.
    fn report(
        &self,
        name: &str,
        end: &ExecutionEnd,
        time_s: f64,
        waits_for: Option<String>,
        before: &ControlParameters,
        language: Option<Language>,
    ) -> ProgramReport {
        let cnc = &self.simulation.cnc;
        let alarm = match end {
            ExecutionEnd::Alarm(alarm) => Some(AlarmReport::new(alarm, cnc.programs(), language)),
            _ => None,
        };
        let is_on = |address| cnc.plc().memory().bit(address);
        // After the last requested part an M99 has started another one.
        let (beyond, modal) = match end {
            ExecutionEnd::M99 => (
                self.last_point
                    .map_or(Point::default(), |point| cnc.position_absolute() - point),
                self.last_modal.unwrap_or(*cnc.modal()),
            ),
            _ => (Point::default(), *cnc.modal()),
        };
        ProgramReport {
            naming: cnc.model().record().program_naming(),
            file: name.to_owned(),
            end: end.to_run_end(),
            alarm,
            waits_for,
            time_s,
            cutting_s: round_to_millionth(self.cutting_s),
            blocks: self.blocks,
            moves: self.moves,
            parts: self.parts,
            stops: self.stops,
            position: FinalPositions::new(
                cnc.position_absolute() - beyond,
                cnc.position_machine() - beyond,
                cnc.position_relative() - beyond,
            ),
            modal: report::modal_codes(&modal),
            f: modal.feed,
            s: modal.spindle,
            t: report::tool_word(cnc.tool()),
            spindle: if is_on(M03_OUTPUT) {
                "cw"
            } else if is_on(M04_OUTPUT) {
                "ccw"
            } else {
                "stop"
            },
            coolant: cnc.plc().memory().y(5) & 1 != 0,
            breaks: Vec::new(),
            parameters_changed: report::changed_parameters(before, cnc.parameters()),
            warnings: Vec::new(),
            warning_kinds: Vec::new(),
            path: None,
            part: None,
            load: None,
        }
    }

    fn time_ms(&self) -> u64 {
        if self.start_ticks == 0 {
            return 0;
        }
        (self.simulation.cnc.ticks() - self.start_ticks) * u64::from(TICK_MS)
    }

    fn press(&mut self, key: BitAddress) {
        self.simulation.cnc.set_panel_key(key, true);
        self.tick_for_ms(PRESS_MS);
        self.simulation.cnc.set_panel_key(key, false);
        self.tick_for_ms(PRESS_MS);
    }

    fn tick_for_ms(&mut self, ms: u32) {
        for _ in 0..ms / TICK_MS {
            self.run_tick();
        }
    }

    /// Presses cycle start and waits until the run has started. Machine time counts from
    /// there.
    fn press_cycle_start(&mut self) {
        self.simulation.cnc.set_panel_key(START_KEY, true);
        self.tick_for_ms(PRESS_MS);
        self.simulation.cnc.set_panel_key(START_KEY, false);
        let first = self.start_ticks == 0;
        for _ in 0..PRESS_MS {
            if first {
                self.start_ticks = self.simulation.cnc.ticks();
            }
            self.run_tick();
            if self.simulation.cnc.run_state() == RunState::Run || self.pending_end.is_some() {
                return;
            }
        }
    }

    fn run_to_end(&mut self, limits: ExecutionLimits) -> ExecutionEnd {
        loop {
            if let Some(end) = self.pending_end.take() {
                let more = self.parts < limits.parts;
                match end {
                    // Another part: start the cycle again.
                    ExecutionEnd::M30 | ExecutionEnd::M02 | ExecutionEnd::Text
                        if more && self.parts > 0 =>
                    {
                        if self.confirm_next_part() {
                            self.press_cycle_start_again();
                        } else if self.pending_end.is_none() {
                            self.pending_end = Some(ExecutionEnd::Stop(say::run_next_part()));
                        }
                        continue;
                    }
                    end => return end,
                }
            }
            if self.parts >= limits.parts {
                return ExecutionEnd::M99;
            }
            if self.time_ms() >= limits.time_ms {
                return ExecutionEnd::Limit;
            }
            self.run_tick();
            if self.board.is_some() {
                self.supervise_stop();
                continue;
            }
            let cnc = &self.simulation.cnc;
            let idle = cnc.run_state() == RunState::Stop && !cnc.is_moving();
            if idle && self.pending_end.is_none() {
                self.stops += 1;
                self.press_cycle_start_again();
            } else if cnc.run_state() == RunState::Reset && self.pending_end.is_none() {
                self.pending_end = Some(self.start_refusal().unwrap_or(ExecutionEnd::Text));
            }
        }
    }

    /// Returns the reason why cycle start has no effect; `None` if the program runs or may be
    /// started.
    fn start_refusal(&self) -> Option<ExecutionEnd> {
        let cnc = &self.simulation.cnc;
        let is_stopped = matches!(cnc.run_state(), RunState::Reset | RunState::Stop);
        let why = cnc.start_refusal().filter(|_| is_stopped);
        why.filter(|_| !self.has_begun || cnc.run_state() == RunState::Stop)
            .map(ExecutionEnd::Refused)
    }

    fn press_cycle_start_again(&mut self) {
        self.press_cycle_start();
        if self.pending_end.is_none() {
            self.pending_end = self.start_refusal();
        }
    }

    /// Waits until the axes stop.
    fn wait_for_axes(&mut self) {
        for _ in 0..SETTLE_MS {
            if !self.simulation.cnc.is_moving() {
                break;
            }
            self.run_tick();
        }
    }

    fn run_tick(&mut self) {
        if !self.wait_for_tick() {
            return;
        }
        if let Some(partner) = &mut self.partner {
            // A board does not wait for the partner.
            let wait = match self.board {
                Some(_) => PartnerWait::Forbidden,
                None => PartnerWait::Allowed,
            };
            partner.send_text(&mut self.simulation.cnc, wait);
        }
        self.simulation.tick();
        if let Some(board) = &mut self.board {
            board.pulse_board.finish_tick(&mut self.simulation);
        }
        self.has_begun |= self.start_ticks != 0 && self.simulation.cnc.run_state() == RunState::Run;
        let cnc = &self.simulation.cnc;
        if self.pending_end.is_none() {
            // The message holds the program, and cycle start does not continue it.
            self.pending_end = cnc.active_message().map(ExecutionEnd::Alarm);
        }
        let start_s = self.start_ticks as f64 / 1000.0;
        for event in cnc.events() {
            // A loop without motion finishes several parts in a tick. Events after the last
            // requested part do not count.
            let has_all_parts = self.parts >= self.wanted_parts;
            match event {
                Event::BlockStarted(..)
                | Event::BlockEnded(_)
                | Event::PartFinished
                | Event::MoveEnded(_)
                    if has_all_parts => {}
                Event::MoveEnded(executed) => {
                    self.last_point = Some(executed.to);
                    let mut executed = *executed;
                    executed.start_s = (executed.start_s - start_s).max(0.0);
                    if is_reported(&executed) {
                        self.moves += 1;
                        if !matches!(executed.kind, MoveKind::Rapid | MoveKind::Dwell) {
                            self.cutting_s += executed.duration_s;
                        }
                        self.watcher.on_move(&executed);
                    }
                }
                Event::BlockEnded(_) => self.blocks += 1,
                Event::Explained(explanation) => self.watcher.on_pass(explanation),
                Event::BlockStarted(source, modal) => {
                    self.last_modal = Some(*modal);
                    let program = cnc.programs().get(source.program);
                    let text = program.map_or("", |program| program.line(source.line));
                    self.watcher.on_block(source.line, text.trim(), modal);
                }
                Event::AlarmRaised(alarm) if self.pending_end.is_none() => {
                    self.pending_end = Some(ExecutionEnd::Alarm(alarm.clone()));
                }
                Event::PartFinished => self.parts += 1,
                Event::ProgramEnded { m30, m02 } if self.pending_end.is_none() => {
                    self.pending_end = Some(match (m30, m02) {
                        (_, true) => ExecutionEnd::M02,
                        (true, false) => ExecutionEnd::M30,
                        (false, false) => ExecutionEnd::Text,
                    });
                }
                Event::AlarmRaised(_) | Event::ProgramEnded { .. } | Event::Advised(_) => {}
            }
        }
        if self.has_begun {
            let time_ms = self.time_ms();
            let machine = self.simulation.cnc.position_machine();
            let stop = self.watcher.on_tick(time_ms, machine, &self.simulation);
            if self.pending_end.is_none() {
                self.pending_end = stop.map(ExecutionEnd::Watcher);
            }
            if let Some(fault) = self.watcher.cut_fault().filter(|_| self.board.is_none()) {
                self.simulation.lathe.set_fault(fault, true);
            }
        }
    }
}
