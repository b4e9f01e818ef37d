//! A board without hardware: a clock, pins, a spindle, and step outputs that record.

#![allow(dead_code, reason = "each test uses a part")]

use gsk_motion::messages::{Command, Response};
use gsk_motion::{Engine, Event, Request, StepPort};

/// Ticks between two polls of the engine: 2.56 µs.
pub const POLL_TICKS: u64 = 40;
/// Length of a step with its pause, ticks: 4 µs.
const PULSE_TICKS: u64 = 62;
/// Hash of the configuration.
pub const CRC: u32 = 0x1234_5678;
/// Objects of the configuration.
pub const Z: u32 = 0;
pub const X: u32 = 1;
pub const GROUP: u32 = 2;
pub const LIMIT: u32 = 3;
pub const ENABLE: u32 = 4;
pub const SPINDLE: u32 = 5;
pub const GUARD: u32 = 6;
/// Pins of the configuration.
pub const LIMIT_PIN: u32 = 10;
pub const ENABLE_PIN: u32 = 14;
pub const GUARD_PIN: u32 = 11;
pub const INDEX_PIN: u32 = 18;

/// A recorded step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordedStep {
    pub axis: usize,
    pub is_up: bool,
    pub at: u64,
    /// Count of the spindle at the step.
    pub count: i32,
}

/// The pins and the clock.
#[derive(Debug, Default)]
pub struct TestPort {
    pub now: u64,
    pub levels: u32,
    pub counts: [i32; 4],
    /// Counts per turn of an index signal one count long; 0 without one.
    pub index_turn: i32,
    busy_until: [u64; 2],
    pending: [Option<(bool, u64)>; 2],
    pub steps: Vec<RecordedStep>,
    pub outputs: Vec<(u32, u32)>,
    pub restarts: u32,
}

impl TestPort {
    pub fn advance(&mut self, ticks: u64) {
        self.now += ticks;
        for axis in 0..2 {
            if let Some((is_up, at)) = self.pending[axis]
                && at <= self.now
            {
                self.pending[axis] = None;
                self.record(axis, is_up, at);
            }
        }
    }

    fn record(&mut self, axis: usize, is_up: bool, at: u64) {
        self.busy_until[axis] = at + PULSE_TICKS;
        let count = self.counts[0];
        self.steps.push(RecordedStep {
            axis,
            is_up,
            at,
            count,
        });
    }

    pub fn sum(&self, axis: usize) -> i32 {
        let steps = self.steps.iter().filter(|step| step.axis == axis);
        steps.map(|step| if step.is_up { 1 } else { -1 }).sum()
    }
}

impl StepPort for TestPort {
    fn clock(&mut self) -> u64 {
        self.now
    }

    fn pins(&mut self) -> u32 {
        let turn = self.index_turn;
        let is_index = turn > 0 && self.counts[0].rem_euclid(turn) == 0;
        self.levels | u32::from(is_index) << INDEX_PIN
    }

    fn encoder(&mut self, index: usize) -> i32 {
        self.counts[index]
    }

    fn try_step(&mut self, axis: usize, is_up: bool, at: u32, _: u32) -> bool {
        if self.pending[axis].is_some() || self.busy_until[axis] > self.now {
            return false;
        }
        let delay = at.wrapping_sub(self.now as u32);
        if delay == 0 {
            self.record(axis, is_up, self.now);
        } else {
            self.pending[axis] = Some((is_up, self.now + u64::from(delay)));
        }
        true
    }

    fn cancel_steps(&mut self, axis: usize) -> i32 {
        self.pending[axis]
            .take()
            .map_or(0, |(is_up, _)| if is_up { 1 } else { -1 })
    }

    fn set_up_stepper(&mut self, _: usize, _: [u32; 2], _: bool, _: u32) {}

    fn set_up_input(&mut self, _: u32, _: bool) {}

    fn set_up_output(&mut self, pin: u32, _: u32, value: u32) {
        self.outputs.push((pin, value));
    }

    fn set_up_encoder(&mut self, _: usize, _: u32) {}

    fn write_output(&mut self, pin: u32, _: bool, value: u32) {
        self.outputs.push((pin, value));
    }

    fn restart(&mut self) {
        self.restarts += 1;
    }
}

/// An engine with its port.
#[derive(Debug, Default)]
pub struct TestBoard {
    pub engine: Engine,
    pub port: TestPort,
    pub events: Vec<Event>,
    /// Clock of the last renewal of the lease; `None` for a host that does not renew it.
    pub renewed: Option<u64>,
}

impl TestBoard {
    pub fn send(&mut self, command: Command, values: &[i64]) {
        let mut request = Request::new(command);
        for (slot, value) in request.values.iter_mut().zip(values) {
            *slot = *value as u32;
        }
        self.engine.execute(&request, &mut self.port);
        self.take_events();
    }

    fn take_events(&mut self) {
        while let Some(event) = self.engine.next_event() {
            self.events.push(event);
        }
    }

    /// Runs the engine for a time in which the spindle does not turn.
    pub fn run(&mut self, ticks: u64) {
        self.run_with(ticks, |_| None);
    }

    /// Runs the engine; `spindle` gives the count at a clock.
    pub fn run_with(&mut self, ticks: u64, mut spindle: impl FnMut(u64) -> Option<i32>) {
        let end = self.port.now + ticks;
        while self.port.now < end {
            self.port.advance(POLL_TICKS);
            if let Some(count) = spindle(self.port.now) {
                self.port.counts[0] = count;
            }
            self.poll();
        }
    }

    /// Calls the engine once.
    pub fn poll(&mut self) {
        if let Some(renewed) = self.renewed
            && self.port.now >= renewed + 500_000
        {
            self.renew();
        }
        self.engine.poll(&mut self.port);
        self.take_events();
    }

    /// Renews the lease for 100 ms.
    pub fn renew(&mut self) {
        self.renewed = Some(self.port.now);
        let end = self.port.now as u32 as i64 + 1_562_500;
        self.send(Command::RenewLease, &[CRC.into(), end]);
    }

    /// Configures two axes, a stop group, a limit switch, a guard, an output and the spindle.
    pub fn configure(&mut self, counts_per_turn: u32) {
        self.port.index_turn = counts_per_turn as i32;
        self.send(Command::AllocateOids, &[7]);
        self.send(Command::ConfigStepper, &[Z.into(), 2, 3, 0, 31]);
        self.send(Command::ConfigStepper, &[X.into(), 4, 5, 0, 31]);
        self.send(Command::ConfigTrsync, &[GROUP.into()]);
        self.send(Command::ConfigEndstop, &[LIMIT.into(), LIMIT_PIN.into(), 1]);
        self.send(
            Command::ConfigDigitalOut,
            &[ENABLE.into(), ENABLE_PIN.into(), 0, 0, 0],
        );
        self.send(
            Command::ConfigSpindle,
            &[SPINDLE.into(), 16, INDEX_PIN.into(), counts_per_turn.into()],
        );
        self.send(
            Command::ConfigGuard,
            &[GUARD.into(), GUARD_PIN.into(), 1, 1, 80],
        );
        self.send(Command::FinalizeConfig, &[CRC.into()]);
    }

    /// Takes up the lease and clears both axes for steps.
    pub fn begin(&mut self) {
        self.renew();
        for axis in [Z, X] {
            self.send(
                Command::ResetStepClock,
                &[axis.into(), self.port.now as u32 as i64],
            );
        }
    }

    pub fn has(&self, response: Response) -> bool {
        self.events.iter().any(|event| event.response == response)
    }

    /// Returns the text of the reason for which the board has shut down.
    pub fn shutdown_text(&self) -> Option<&'static str> {
        let event = self
            .events
            .iter()
            .find(|event| event.response == Response::Shutdown)?;
        let id = event.values()[1] as usize - gsk_motion::messages::FIRST_REASON_ID as usize;
        gsk_motion::messages::REASONS.get(id).copied()
    }
}
