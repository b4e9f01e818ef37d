//! Runs a control without a window while a board moves its slides: it ticks at the pace of
//! the board, for scripts and for computers without a display.

use std::thread;

use gsk_core::alarm::{Alarm, number};
use gsk_core::simulation::Simulation;
use gsk_link::LinkState;
use gsk_messages::{Message, say};
use gsk_runner::board::PulseBoard;
use web_time::{Duration, Instant};

use super::BoardConnection;
use super::drive::Drive;
use super::journal::ChangeLog;
use crate::board::READY_TIMEOUT;
use crate::output;
use crate::termination::{SignalError, TerminationFlag};

/// Time between two ticks of the link while its port is closed.
const NO_PORT_INTERVAL: Duration = Duration::from_millis(4);
/// Longest time for which the control makes ticks before the port is read again.
const MAX_TICK_TIME: Duration = Duration::from_millis(3);
/// Longest wait for the end of all motion before the port is closed, ticks.
const MAX_STOP_TICKS: u32 = 2000;

/// The reason why a board is not ready for motion.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum NotReady {
    /// A termination signal has arrived while the board was opened.
    EndRequested,
    /// The board has raised an alarm with this message.
    Refused(Message),
    /// The settings of the board differ from the configuration; the alarm lists them.
    Settings(Box<Alarm>),
    /// The board has not become ready in time.
    Silent,
}

impl NotReady {
    /// Returns the message for the operator: why the board is not ready.
    pub fn message(&self) -> Message {
        match self {
            Self::EndRequested => say::link_ended_unknown(),
            Self::Refused(why) => say::link_board_not_ready(why.clone()),
            Self::Settings(alarm) => say::link_settings_differ(alarm),
            Self::Silent => say::link_board_silent(),
        }
    }
}

/// The board of a control without a window. Dropping it without [`HeadlessBoard::close`] stops
/// the board at once.
#[derive(Debug)]
pub struct HeadlessBoard {
    /// The connection to the board; `None` after a termination signal, because the board has
    /// been stopped.
    drive: Option<Drive>,
    ending: TerminationFlag,
    last_read: Instant,
    journal: ChangeLog,
}

impl HeadlessBoard {
    /// Opens the port of the board and installs handlers for Ctrl-C and `kill`, which stop the
    /// board.
    ///
    /// # Errors
    /// The signal handlers cannot be installed.
    pub fn open(
        connection: BoardConnection,
        simulation: &mut Simulation,
    ) -> Result<Self, SignalError> {
        Ok(Self {
            ending: TerminationFlag::install_signal_handlers()?,
            drive: Some(Drive::open(connection, simulation, None)),
            last_read: Instant::now(),
            journal: ChangeLog::default(),
        })
    }

    /// Whether a termination signal has arrived and the board has been stopped.
    pub const fn has_ended(&self) -> bool {
        self.drive.is_none()
    }

    /// Makes ticks until the board is ready. `simulation` returns the simulation of `machine`;
    /// `tick` makes one tick of the control.
    ///
    /// # Errors
    /// The board does not answer in time, raises an alarm or has other settings; or the
    /// end of the program is requested.
    pub fn wait_until_ready<M>(
        &mut self,
        machine: &mut M,
        simulation: impl Fn(&mut M) -> &mut Simulation,
        tick: impl Fn(&mut M),
    ) -> Result<(), NotReady> {
        let begun = Instant::now();
        while begun.elapsed() < READY_TIMEOUT {
            if !self.wait_for_tick(simulation(machine)) {
                return Err(NotReady::EndRequested);
            }
            tick(machine);
            self.finish_tick(simulation(machine));
            let Some(drive) = &self.drive else {
                continue;
            };
            let alarm = simulation(machine).cnc.alarms().first().cloned();
            match (drive.state(), alarm) {
                (LinkState::Locked | LinkState::Tripped | LinkState::Ready, _) => return Ok(()),
                (LinkState::Fault | LinkState::Lost, alarm) => {
                    let why = alarm.map_or_else(say::board_says_nothing, |alarm| {
                        say::subject_reason(format!("{:03}", alarm.number), alarm.reason())
                    });
                    return Err(NotReady::Refused(why));
                }
                (LinkState::Configure, Some(alarm)) if alarm.number == number::BOARD_SETTINGS => {
                    return Err(NotReady::Settings(Box::new(alarm)));
                }
                _ => {}
            }
        }
        Err(NotReady::Silent)
    }

    /// Waits until the board has made its remaining motion, then closes the port, which stops
    /// spindle and coolant, too. `simulation` returns the simulation of `machine`; `tick` makes one
    /// tick of the control.
    pub fn close<M>(
        mut self,
        machine: &mut M,
        simulation: impl Fn(&mut M) -> &mut Simulation,
        tick: impl Fn(&mut M),
    ) {
        for _ in 0..MAX_STOP_TICKS {
            let has_motion = self.drive.as_ref().is_some_and(Drive::has_pending_motion);
            if !has_motion || !self.wait_for_tick(simulation(machine)) {
                break;
            }
            tick(machine);
            self.finish_tick(simulation(machine));
        }
        if let Some(drive) = self.drive.take() {
            drive.close(simulation(machine));
        }
    }
}

impl PulseBoard for HeadlessBoard {
    fn wait_for_tick(&mut self, simulation: &mut Simulation) -> bool {
        loop {
            if self.ending.is_requested()
                && let Some(drive) = self.drive.take()
            {
                drive.close(simulation);
            }
            let Some(drive) = &mut self.drive else {
                return false;
            };
            let late = self.last_read.elapsed() >= MAX_TICK_TIME;
            if !late && drive.may_tick() {
                drive.before_tick(simulation);
                return true;
            }
            // Messages of the last tick are written only after a recent read of the port.
            drive.write_board(None);
            drive.read_board();
            for message in drive.take_messages() {
                output::report_error(&message);
            }
            if !drive.has_port() {
                thread::sleep(NO_PORT_INTERVAL);
            }
            if drive.needs_reopen()
                && let Some(drive) = self.drive.take()
            {
                let (connection, _) = drive.close(simulation);
                self.drive = Some(Drive::open(connection, simulation, None));
            }
            // Set after all slow work: the control ticks on without a port, too.
            self.last_read = Instant::now();
        }
    }

    fn finish_tick(&mut self, simulation: &mut Simulation) {
        if let Some(drive) = &mut self.drive {
            drive.after_tick(simulation);
        }
        let state = self.drive.as_ref().map(Drive::state);
        self.journal.log_changes(&simulation.cnc, state);
    }

    fn close(self: Box<Self>, simulation: &mut Simulation) {
        Self::close(*self, simulation, |simulation| simulation, Simulation::tick);
    }
}
