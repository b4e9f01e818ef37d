//! The pins of the board for the engine of its firmware: step outputs, inputs, encoders.

use std::collections::{BTreeMap, VecDeque};

use gsk_motion::StepPort;
use gsk_motion::messages::{PINS, PWM_MAX};

use super::PicoStep;
use super::spindle::EncoderSpindle;
use crate::klipper::TravelSwitch;

/// Duration of a tick of the board clock, ns.
pub(super) const TICK_NS: u64 = 64;
/// Ticks between the end of a pulse and the next step, besides the pulse and its pause.
const PAUSE_TICKS: u64 = 6;

/// A step output: the steps that it has taken, each with its direction and clock.
#[derive(Clone, Debug, Default)]
struct TwinStepOutput {
    waiting: VecDeque<(bool, u64)>,
    pulse_ticks: u64,
    /// Clock from which on the output can make the next step, ticks.
    free_at: u64,
}

/// An encoder of an axis: its counts in a number of steps, and the steps that the motor has lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TwinAxisEncoder {
    /// This number of counts ...
    pub counts: i64,
    /// ... in this number of steps.
    pub steps: i64,
    /// Steps that the motor did not make.
    pub lost_steps: i64,
}

/// The pins of the board.
#[derive(Clone, Debug, Default)]
pub(super) struct PicoPort {
    /// Board clock, ticks since its start.
    pub(super) clock: u64,
    /// Ticks from power-on to the start of the clock.
    pub(super) clock_zero: u64,
    levels: u32,
    switches: BTreeMap<u32, TravelSwitch>,
    outputs_of_axes: [TwinStepOutput; 2],
    /// Pulses since power-on, as a counter at the pins reads them.
    pub(super) pulses: [i64; 2],
    pub(super) last_pulse_tick: u64,
    pub(super) steps: Option<Vec<PicoStep>>,
    pub(super) step_count: u64,
    pub(super) spindle: Option<EncoderSpindle>,
    /// Counts of the handwheel's encoder.
    pub(super) wheel_count: i32,
    pub(super) axis_encoders: [Option<TwinAxisEncoder>; 2],
    /// Values of the outputs as a share of the full value.
    pub(super) outputs: BTreeMap<u32, f64>,
    pub(super) restarts: bool,
}

impl PicoPort {
    /// Sets the level of an input.
    pub(super) fn set_level(&mut self, pin: u32, is_high: bool) {
        self.switches.remove(&pin);
        if pin < PINS {
            self.levels = self.levels & !(1 << pin) | u32::from(is_high) << pin;
        }
    }

    /// Connects a switch on the travel of a slide to a pin.
    pub(super) fn place_switch(&mut self, pin: u32, switch: TravelSwitch) {
        if pin < PINS {
            self.switches.insert(pin, switch);
        }
    }

    /// Forgets what the firmware has set up; the slides stay where they are.
    pub(super) fn reset(&mut self, clock_zero: u64) {
        self.clock_zero = clock_zero;
        self.clock = 0;
        self.outputs_of_axes = Default::default();
        self.outputs.clear();
        self.restarts = false;
        self.drive_spindle();
    }

    fn drive_spindle(&mut self) {
        let outputs = &self.outputs;
        if let Some(spindle) = &mut self.spindle {
            spindle.drive(|pin| outputs.get(&pin).copied().unwrap_or(0.0));
        }
    }

    /// Advances the clock, makes the steps that are due, and turns the spindle.
    pub(super) fn advance(&mut self, ticks: u64) {
        self.clock += ticks;
        let seconds = (ticks * TICK_NS) as f64 * 1e-9;
        if let Some(spindle) = &mut self.spindle {
            spindle.advance(seconds, self.pulses);
        }
        for axis in 0..2 {
            while let Some(&(is_up, at)) = self.outputs_of_axes[axis].waiting.front() {
                let at = at.max(self.outputs_of_axes[axis].free_at);
                if at > self.clock {
                    break;
                }
                self.outputs_of_axes[axis].waiting.pop_front();
                self.make_step(axis, is_up, at);
            }
        }
    }

    fn make_step(&mut self, axis: usize, is_up: bool, at: u64) {
        let output = &mut self.outputs_of_axes[axis];
        output.free_at = at + 2 * output.pulse_ticks + PAUSE_TICKS;
        self.pulses[axis] += if is_up { 1 } else { -1 };
        self.last_pulse_tick = self.clock_zero + at;
        self.step_count += 1;
        if let Some(steps) = &mut self.steps {
            steps.push(PicoStep {
                at_ns: (self.clock_zero + at) * TICK_NS,
                stepper: axis,
                position: self.pulses[axis],
                other_position: self.pulses[1 - axis],
                turns: self.spindle.map_or(0.0, |spindle| spindle.turns),
                count: self.spindle.map_or(0, |spindle| spindle.count()),
            });
        }
    }
}

impl StepPort for PicoPort {
    fn clock(&mut self) -> u64 {
        self.clock
    }

    fn pins(&mut self) -> u32 {
        let mut levels = self.levels | self.spindle.map_or(0, |spindle| spindle.levels());
        for (pin, switch) in &self.switches {
            let is_on = switch.is_on(self.pulses);
            levels = levels & !(1 << pin) | u32::from(is_on) << pin;
        }
        levels
    }

    fn encoder(&mut self, index: usize) -> i32 {
        match index {
            0 => self.spindle.map_or(0, |spindle| spindle.count() as i32),
            3 => self.wheel_count,
            _ => self
                .axis_encoders
                .get(index - 1)
                .copied()
                .flatten()
                .map_or(0, |encoder| {
                    let steps = self.pulses[index - 1] - encoder.lost_steps;
                    (steps * encoder.counts).div_euclid(encoder.steps.max(1)) as i32
                }),
        }
    }

    fn try_step(&mut self, axis: usize, is_up: bool, at: u32, waiting: u32) -> bool {
        let output = &mut self.outputs_of_axes[axis];
        if output.waiting.len() > waiting as usize
            || (waiting == 0 && (!output.waiting.is_empty() || output.free_at > self.clock))
        {
            return false;
        }
        let delay = (at.wrapping_sub(self.clock as u32) as i32).max(0);
        let at = self.clock + u64::from(delay.unsigned_abs());
        if delay == 0 && output.waiting.is_empty() && output.free_at <= self.clock {
            self.make_step(axis, is_up, at);
        } else {
            output.waiting.push_back((is_up, at));
        }
        true
    }

    fn cancel_steps(&mut self, axis: usize) -> i32 {
        let output = &mut self.outputs_of_axes[axis];
        let waiting = core::mem::take(&mut output.waiting);
        waiting.iter().map(|step| if step.0 { 1 } else { -1 }).sum()
    }

    fn set_up_stepper(&mut self, axis: usize, _: [u32; 2], _: bool, pulse_ticks: u32) {
        if let Some(output) = self.outputs_of_axes.get_mut(axis) {
            output.pulse_ticks = pulse_ticks.into();
        }
    }

    fn set_up_input(&mut self, _: u32, _: bool) {}

    fn set_up_output(&mut self, pin: u32, cycle_ticks: u32, value: u32) {
        self.write_output(pin, cycle_ticks > 0, value);
    }

    fn set_up_encoder(&mut self, _: usize, _: u32) {}

    fn write_output(&mut self, pin: u32, is_pwm: bool, value: u32) {
        let full = if is_pwm { f64::from(PWM_MAX) } else { 1.0 };
        self.outputs.insert(pin, f64::from(value) / full);
        self.drive_spindle();
    }

    fn restart(&mut self) {
        self.restarts = true;
    }
}
