//! Spindle state of the preview, as needed for feeds per revolution.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::SpindleCommand;
use crate::interpreter::surface_rpm;
use crate::setup::Setup;

/// Direction in which the spindle turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpindleRotation {
    /// The spindle is stopped.
    #[default]
    Stopped,
    /// The spindle turns clockwise, as after M03.
    Clockwise,
    /// The spindle turns counter-clockwise, as after M04.
    CounterClockwise,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum CommandedSpeed {
    Fixed(f64),
    Surface(f64),
}

/// The state of the spindle as commanded by the program so far.
pub(super) struct PreviewSpindle {
    rotation: SpindleRotation,
    /// M code (3 or 4) that starts the spindle in parallel with the rest of its block; `None`
    /// without one.
    pending: Option<u8>,
    /// Direction before the last tap, which stopped the spindle.
    rotation_before_tap: SpindleRotation,
    speed: CommandedSpeed,
    /// Speeds of the spindle steps S1 to S4 of the lathe, r/min.
    steps: [f64; 4],
    limit_rpm: Option<f64>,
    lowest_rpm: f64,
    /// Speeds at 10 V in gears 1 to 4 of an analog spindle, r/min; `None` for a spindle with
    /// stepped speeds.
    gear_top_rpm: Option<[f64; 4]>,
    gear: u8,
    /// Whether M41–M44 engaged the gear; before that it is assumed.
    engaged: bool,
}

impl PreviewSpindle {
    pub(super) fn new(setup: &Setup) -> Self {
        let initial_rpm = setup.spindle_rpm.unwrap_or(0.0);
        Self {
            rotation: if initial_rpm > 0.0 {
                SpindleRotation::Clockwise
            } else {
                SpindleRotation::Stopped
            },
            pending: None,
            rotation_before_tap: SpindleRotation::Stopped,
            speed: CommandedSpeed::Fixed(initial_rpm),
            steps: setup.lathe.spindle.steps,
            limit_rpm: None,
            lowest_rpm: setup.memory.parameters.lowest_surface_speed_rpm(),
            gear_top_rpm: (setup.memory.parameters.has_analog_spindle())
                .then(|| [1, 2, 3, 4].map(|gear| setup.memory.parameters.gear_top_speed(gear))),
            gear: 1,
            engaged: false,
        }
    }

    /// Engages the gear `gear` (M41–M44); returns whether the gear changes.
    pub(super) const fn change_gear(&mut self, gear: u8) -> bool {
        let changes = !self.engaged || self.gear != gear;
        self.gear = gear;
        self.engaged = true;
        changes
    }

    pub(super) const fn rotation(&self) -> SpindleRotation {
        self.rotation
    }

    pub(super) const fn execute_m(&mut self, code: u8) {
        match code {
            3 => self.rotation = SpindleRotation::Clockwise,
            4 => self.rotation = SpindleRotation::CounterClockwise,
            5 => self.rotation = SpindleRotation::Stopped,
            _ => {}
        }
    }

    /// Executes an M code in parallel with the rest of its block; M03 and M04 wait for
    /// [`Self::start_pending`].
    pub(super) const fn start_m_in_parallel(&mut self, code: u8) {
        match code {
            3 | 4 => self.pending = Some(code),
            _ => self.execute_m(code),
        }
    }

    /// Starts the spindle if an M03 or M04 is waiting.
    pub(super) fn start_pending(&mut self) {
        if let Some(code) = self.pending.take() {
            self.execute_m(code);
        }
    }

    /// Stops the spindle after a tap and stores its direction.
    pub(super) const fn stop_for_tap(&mut self) {
        self.rotation_before_tap = self.rotation;
        self.rotation = SpindleRotation::Stopped;
    }

    /// Turns the spindle in the direction that it had before the tap.
    pub(super) const fn restart_after_tap(&mut self) {
        self.rotation = self.rotation_before_tap;
    }

    pub(super) fn set_speed(&mut self, command: SpindleCommand) {
        match command {
            SpindleCommand::Step(step) => {
                let rpm = usize::from(step)
                    .checked_sub(1)
                    .and_then(|step| self.steps.get(step));
                self.speed = CommandedSpeed::Fixed(rpm.copied().unwrap_or(0.0));
            }
            SpindleCommand::Speed(rpm) => self.speed = CommandedSpeed::Fixed(rpm),
            SpindleCommand::Surface(speed) => self.speed = CommandedSpeed::Surface(speed),
            SpindleCommand::Limit(rpm) => self.limit_rpm = Some(rpm),
        }
    }

    /// Whether the speed depends on the radius: constant surface speed (G96).
    pub(super) const fn follows_radius(&self) -> bool {
        matches!(self.speed, CommandedSpeed::Surface(_))
    }

    /// The spindle speed, r/min, limited to the speed of the gear at 10 V; 0 while the spindle
    /// is stopped. Under G96 it depends on `radius`, mm.
    #[inline]
    pub(super) fn rpm(&self, radius: f64) -> f64 {
        let commanded = match self.speed {
            _ if self.rotation == SpindleRotation::Stopped => 0.0,
            CommandedSpeed::Fixed(rpm) => rpm,
            CommandedSpeed::Surface(speed) => {
                surface_rpm(speed, 2.0 * radius, self.limit_rpm, self.lowest_rpm)
            }
        };
        let gear = usize::from(self.gear.clamp(1, 4) - 1);
        self.gear_top_rpm
            .map_or(commanded, |top| commanded.min(top[gear]))
    }

    /// The spindle speed for a feed per revolution, r/min. Under G96 `radius`, mm, is that at
    /// the middle of the cut, which yields the right duration. Alarm 011 if the spindle is
    /// stopped.
    pub(super) fn rpm_for_feed(&self, radius: f64) -> Result<f64, Alarm> {
        let rpm = self.rpm(radius);
        if rpm < 1.0 {
            return Err(Alarm::new(number::NO_FEED).with_detail(say::spindle_stands_at_feed()));
        }
        Ok(rpm)
    }
}
