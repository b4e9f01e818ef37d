//! Spindle state of the preview, as needed for feeds per revolution.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::SpindleCommand;
use crate::interpreter::surface_rpm;
use crate::setup::Setup;

/// Direction in which the spindle turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Turning {
    /// The spindle is stopped.
    #[default]
    Stopped,
    /// Clockwise, as after M03.
    Clockwise,
    /// Counter-clockwise, as after M04.
    CounterClockwise,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Speed {
    Fixed(f64),
    Surface(f64),
}

/// The commanded state of the spindle.
pub(super) struct Spindle {
    turning: Turning,
    /// M03 or M04 that started in parallel with the rest of its block.
    pending: Option<u8>,
    /// Direction before the last tap.
    before_tap: Turning,
    speed: Speed,
    /// Speeds of the steps S1 to S4 of the lathe, r/min.
    steps: [f64; 4],
    limit: Option<f64>,
    lowest: f64,
    /// Speed at 10 V in gears 1 to 4 of an analog spindle, r/min; `None`: stepped speeds.
    top: Option<[f64; 4]>,
    gear: u8,
    /// M41–M44 engaged the gear; otherwise it is assumed.
    engaged: bool,
}

impl Spindle {
    pub(super) fn new(setup: &Setup) -> Self {
        let given = setup.spindle_rpm.unwrap_or(0.0);
        Self {
            turning: if given > 0.0 {
                Turning::Clockwise
            } else {
                Turning::Stopped
            },
            pending: None,
            before_tap: Turning::Stopped,
            speed: Speed::Fixed(given),
            steps: setup.lathe.spindle.steps,
            limit: None,
            lowest: setup.memory.parameters.surface_lowest(),
            top: (setup.memory.parameters.analog_spindle())
                .then(|| [1, 2, 3, 4].map(|gear| setup.memory.parameters.gear_maximum(gear))),
            gear: 1,
            engaged: false,
        }
    }

    /// Executes M41–M44; returns whether the gear changes.
    pub(super) const fn change_gear(&mut self, gear: u8) -> bool {
        let changes = !self.engaged || self.gear != gear;
        self.gear = gear;
        self.engaged = true;
        changes
    }

    pub(super) const fn turning(&self) -> Turning {
        self.turning
    }

    pub(super) const fn output_m(&mut self, code: u8) {
        match code {
            3 => self.turning = Turning::Clockwise,
            4 => self.turning = Turning::CounterClockwise,
            5 => self.turning = Turning::Stopped,
            _ => {}
        }
    }

    /// Executes an M code in parallel with the rest of its block.
    pub(super) const fn output_m_beside(&mut self, code: u8) {
        match code {
            3 | 4 => self.pending = Some(code),
            _ => self.output_m(code),
        }
    }

    /// Starts the spindle that a block commanded in parallel with its motion.
    pub(super) fn start_pending(&mut self) {
        if let Some(code) = self.pending.take() {
            self.output_m(code);
        }
    }

    /// Stops the spindle after a tap.
    pub(super) const fn stop_for_tap(&mut self) {
        self.before_tap = self.turning;
        self.turning = Turning::Stopped;
    }

    /// Turns the spindle as before the tap.
    pub(super) const fn turn_again(&mut self) {
        self.turning = self.before_tap;
    }

    pub(super) fn command(&mut self, command: SpindleCommand) {
        match command {
            SpindleCommand::Step(step) => {
                let rpm = usize::from(step)
                    .checked_sub(1)
                    .and_then(|step| self.steps.get(step));
                self.speed = Speed::Fixed(rpm.copied().unwrap_or(0.0));
            }
            SpindleCommand::Speed(rpm) => self.speed = Speed::Fixed(rpm),
            SpindleCommand::Surface(speed) => self.speed = Speed::Surface(speed),
            SpindleCommand::Limit(rpm) => self.limit = Some(rpm),
        }
    }

    /// The speed, r/min, at a radius in mm for G96; 0 while the spindle is stopped. The
    /// speed of the gear at 10 V limits it.
    pub(super) fn rpm(&self, radius: f64) -> f64 {
        let commanded = match self.speed {
            _ if self.turning == Turning::Stopped => 0.0,
            Speed::Fixed(rpm) => rpm,
            Speed::Surface(speed) => surface_rpm(speed, 2.0 * radius, self.limit, self.lowest),
        };
        let gear = usize::from(self.gear.clamp(1, 4) - 1);
        self.top.map_or(commanded, |top| commanded.min(top[gear]))
    }

    /// The speed for a feed per revolution, r/min. Under G96 it is that at the middle of the
    /// cut, which yields the right duration. Alarm 011 is raised while the spindle is
    /// stopped.
    pub(super) fn rpm_for_feed(&self, radius: f64) -> Result<f64, Alarm> {
        let rpm = self.rpm(radius);
        if rpm < 1.0 {
            return Err(Alarm::new(number::NO_FEED).because(say::spindle_stands_at_feed()));
        }
        Ok(rpm)
    }
}
