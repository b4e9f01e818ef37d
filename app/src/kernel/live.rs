//! A control without a window whose slides a board moves: it ticks at the board's pace,
//! for scripts and programs at a computer without a display.

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

/// How often a link without a port is looked at.
const WITHOUT_PORT: Duration = Duration::from_millis(4);
/// So long the control makes ticks before it hears the board again.
const AT_ONCE: Duration = Duration::from_millis(3);
/// Behind the last motion the board stands within this, ticks.
const STANDS_WITHIN: u32 = 2000;

/// Why a board cannot be worked with.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum NotReady {
    /// The end was asked for.
    Asked,
    /// It raises an alarm.
    Refused(Message),
    /// Its settings differ.
    Settings(Box<Alarm>),
    /// It says nothing.
    Silent,
}

impl NotReady {
    /// What is said of it.
    pub fn message(&self) -> Message {
        match self {
            Self::Asked => say::link_ended_unknown(),
            Self::Refused(why) => say::link_board_not_ready(why.clone()),
            Self::Settings(alarm) => say::link_settings_differ(alarm),
            Self::Silent => say::link_board_silent(),
        }
    }
}

/// The board of a control without a window. Dropped without [`Live::close`] it stops.
#[derive(Debug)]
pub struct Live {
    /// None when the end was asked for: the board has been stopped.
    drive: Option<Drive>,
    ending: Ending,
    heard: Instant,
    journal: Journal,
}

impl Live {
    /// Opens the port; from now on Ctrl-C and `kill` are heard, and stop the board.
    ///
    /// # Errors
    /// Signals cannot be heard.
    pub fn open(connection: Connection, simulation: &mut Simulation) -> Result<Self, SignalError> {
        Ok(Self {
            ending: Ending::heard()?,
            drive: Some(Drive::open(connection, simulation)),
            heard: Instant::now(),
            journal: Journal::default(),
        })
    }

    /// Whether the end was asked for; the board has been stopped then.
    pub const fn is_over(&self) -> bool {
        self.drive.is_none()
    }

    /// Lets time pass until the board is known; `tick` makes a tick of the control.
    ///
    /// # Errors
    /// It is not there, or not as it must be: a sentence.
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

    /// Lets the board make what it was handed, and closes the port: it stops, spindle and
    /// coolant with it.
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
            // What was made of it before is written only if the port was looked at of late.
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
            // Behind all that takes time here: the control ticks on without a port, too.
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
