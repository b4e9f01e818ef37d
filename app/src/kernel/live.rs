//! Runs a control without a window while a board moves its slides: it ticks at the pace of
//! the board, for scripts and for computers without a display.

use std::thread;

use gsk_core::alarm::{Alarm, number};
use gsk_core::simulation::Simulation;
use gsk_link::LinkState;
use gsk_messages::{Message, say};
use gsk_runner::board::PulseBoard;
use web_time::{Duration, Instant};

use super::Connection;
use super::drive::Drive;
use super::journal::Journal;
use crate::board::GET_KNOWN;
use crate::ending::{Ending, SignalError};
use crate::output;

/// Time between two checks of a link without a port.
const WITHOUT_PORT: Duration = Duration::from_millis(4);
/// Longest time the control makes ticks before it reads the port again.
const AT_ONCE: Duration = Duration::from_millis(3);
/// Longest time from the last command to the end of all motion, ticks.
const STANDS_WITHIN: u32 = 2000;

/// Why a board is not ready for work.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum NotReady {
    /// The operator has requested the end of the program.
    Asked,
    /// The board raises an alarm.
    Refused(Message),
    /// The settings of the board differ from the configuration.
    Settings(Box<Alarm>),
    /// The board has not answered in time.
    Silent,
}

impl NotReady {
    /// Returns the message for the operator.
    pub fn message(&self) -> Message {
        match self {
            Self::Asked => say::link_ended_unknown(),
            Self::Refused(why) => say::link_board_not_ready(why.clone()),
            Self::Settings(alarm) => say::link_settings_differ(alarm),
            Self::Silent => say::link_board_silent(),
        }
    }
}

/// The board of a control without a window. Dropping it without [`Live::close`] stops the
/// board at once.
#[derive(Debug)]
pub struct Live {
    /// `None` after a termination signal: the board has been stopped.
    drive: Option<Drive>,
    ending: Ending,
    heard: Instant,
    journal: Journal,
}

impl Live {
    /// Opens the port and handles Ctrl-C and `kill` from now on: they stop the board.
    ///
    /// # Errors
    /// The signal handlers cannot be installed.
    pub fn open(connection: Connection, simulation: &mut Simulation) -> Result<Self, SignalError> {
        Ok(Self {
            ending: Ending::heard()?,
            drive: Some(Drive::open(connection, simulation)),
            heard: Instant::now(),
            journal: Journal::default(),
        })
    }

    /// Whether a termination signal has arrived and the board has been stopped.
    pub const fn is_over(&self) -> bool {
        self.drive.is_none()
    }

    /// Ticks until the board is ready; `tick` makes one tick of the control.
    ///
    /// # Errors
    /// The board does not answer in time, raises an alarm or has other settings; or the
    /// end of the program is requested.
    pub fn get_known<M>(
        &mut self,
        machine: &mut M,
        simulation: impl Fn(&mut M) -> &mut Simulation,
        tick: impl Fn(&mut M),
    ) -> Result<(), NotReady> {
        let begun = Instant::now();
        while begun.elapsed() < GET_KNOWN {
            if !self.wait(simulation(machine)) {
                return Err(NotReady::Asked);
            }
            tick(machine);
            self.after(simulation(machine));
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

    /// Waits until the board has made its remaining motion, then closes the port: this
    /// stops spindle and coolant, too.
    pub fn close<M>(
        mut self,
        machine: &mut M,
        simulation: impl Fn(&mut M) -> &mut Simulation,
        tick: impl Fn(&mut M),
    ) {
        for _ in 0..STANDS_WITHIN {
            let behind = self.drive.as_ref().is_some_and(Drive::is_behind);
            if !behind || !self.wait(simulation(machine)) {
                break;
            }
            tick(machine);
            self.after(simulation(machine));
        }
        if let Some(drive) = self.drive.take() {
            drive.close(simulation(machine));
        }
    }
}

impl PulseBoard for Live {
    fn wait(&mut self, simulation: &mut Simulation) -> bool {
        loop {
            if self.ending.is_asked()
                && let Some(drive) = self.drive.take()
            {
                drive.close(simulation);
            }
            let Some(drive) = &mut self.drive else {
                return false;
            };
            let late = self.heard.elapsed() >= AT_ONCE;
            if !late && drive.may_tick() {
                drive.before(simulation);
                return true;
            }
            // Messages of the last tick are written only after a recent read of the port.
            drive.speak(None);
            drive.hear();
            for said in drive.said() {
                output::complain_of(&said);
            }
            if !drive.has_port() {
                thread::sleep(WITHOUT_PORT);
            }
            if drive.is_to_be_reopened()
                && let Some(drive) = self.drive.take()
            {
                let connection = drive.close(simulation);
                self.drive = Some(Drive::open(connection, simulation));
            }
            // Set after all slow work: the control ticks on without a port, too.
            self.heard = Instant::now();
        }
    }

    fn after(&mut self, simulation: &mut Simulation) {
        if let Some(drive) = &mut self.drive {
            drive.after(simulation);
        }
        let state = self.drive.as_ref().map(Drive::state);
        self.journal.look(&simulation.cnc, state);
    }

    fn close(self: Box<Self>, simulation: &mut Simulation) {
        Self::close(*self, simulation, |simulation| simulation, Simulation::tick);
    }
}
