//! The engine: takes requests, makes what is due, and reports.

mod commands;
mod configuration;
mod watch;

use crate::storage::{Deque, Vec};

use crate::encoders::{AxisEncoder, EdgeCounter, Handwheel, SpindleEncoder};
use crate::messages::{Command, FIRST_REASON_ID, RESPONSES, Reason, Response, parameter_count};
use crate::outputs::OutputChannel;
use crate::stepper::Stepper;
use crate::stops::{Guard, PlannedStop, StopGroup, StopInput, WatchedLevels};

/// Number of axes.
pub const AXES: usize = 2;
/// Greatest number of parameters of a command.
const MAX_PARAMETERS: usize = 8;
/// Greatest number of stop groups, of inputs, of outputs, of guards and of counters.
const GROUPS: usize = 4;
const INPUTS: usize = 16;
const OUTPUTS: usize = 8;
const GUARDS: usize = 8;
const COUNTERS: usize = 2;
/// Number of the encoder of the handwheel.
const WHEEL_ENCODER: usize = 3;
/// Capacity of the queue of events.
const EVENTS: usize = 32;
/// Number of turns of the slow work: one kind of object at every second call of [`Engine::poll`].
const SLOW_TURNS: u32 = 16;

/// A command with its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// The command; `Identify` stands for a fault of the block.
    pub command: Command,
    /// The parameters in the order of the command's format.
    pub values: [u32; MAX_PARAMETERS],
}

impl Request {
    /// Creates a request with all parameters 0.
    pub const fn new(command: Command) -> Self {
        Self {
            command,
            values: [0; MAX_PARAMETERS],
        }
    }

    /// Creates the request to shut down because a block is invalid.
    pub(crate) const fn fault(reason: Reason) -> Self {
        let mut request = Self::new(Command::Identify);
        request.values[0] = reason as u32;
        request
    }
}

/// A reply with its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// The reply.
    pub response: Response,
    values: [i64; 4],
}

impl Event {
    /// Returns the parameters in the order of the reply's format.
    pub fn values(&self) -> &[i64] {
        let format = RESPONSES[self.response as usize].1;
        &self.values[..parameter_count(format).min(self.values.len())]
    }
}

/// The hardware of the board.
pub trait StepPort {
    /// Returns the clock, ticks.
    fn clock(&mut self) -> u64;
    /// Returns the levels of all pins, a bit for each.
    fn pins(&mut self) -> u32;
    /// Returns the count of an encoder: 0 of the spindle, 1 and 2 of the axes, 3 of the handwheel.
    fn encoder(&mut self, index: usize) -> i32;
    /// Makes a step at the clock `at`, ticks, or as soon as possible after it. Returns whether the
    /// step output takes it: not more than `waiting` steps wait in it, besides the one under way.
    fn try_step(&mut self, axis: usize, is_up: bool, at: u32, waiting: u32) -> bool;
    /// Drops the steps of an axis that are not begun; returns their sum, positive minus negative.
    fn cancel_steps(&mut self, axis: usize) -> i32;
    /// Sets up the step output of an axis.
    fn set_up_stepper(&mut self, axis: usize, pins: [u32; 2], is_inverted: bool, pulse_ticks: u32);
    /// Sets up an input.
    fn set_up_input(&mut self, pin: u32, pulls_up: bool);
    /// Sets up a digital output (`cycle_ticks` 0) or a PWM output, and writes its value.
    fn set_up_output(&mut self, pin: u32, cycle_ticks: u32, value: u32);
    /// Sets up an encoder with its signals A at a pin and B at the next.
    fn set_up_encoder(&mut self, index: usize, pin_a: u32);
    /// Writes the value of a digital output or of a PWM output.
    fn write_output(&mut self, pin: u32, is_pwm: bool, value: u32);
    /// Restarts the board.
    fn restart(&mut self);
}

/// Whether the board moves, is stopping, or is shut down.
#[derive(Clone, Copy, Debug)]
pub enum EngineState {
    /// The board takes commands.
    Running,
    /// The lease has expired: the axes slow down on their path.
    Stopping(PlannedStop),
    /// The board is shut down for this reason.
    ShutDown(Reason),
}

/// The clock and the levels of the pins at a call of [`Engine::poll`].
#[derive(Clone, Copy, Debug)]
struct Moment {
    clock: u32,
    pins: u32,
}

/// What the host has configured.
#[derive(Clone, Debug)]
struct Objects {
    steppers: Vec<Stepper, AXES>,
    groups: Vec<StopGroup, GROUPS>,
    inputs: Vec<StopInput, INPUTS>,
    outputs: Vec<OutputChannel, OUTPUTS>,
    guards: Vec<Guard, GUARDS>,
    /// The levels at which a guard or a stop input begins to act.
    guard_levels: WatchedLevels,
    input_levels: WatchedLevels,
    counters: Vec<EdgeCounter, COUNTERS>,
    spindle: Option<SpindleEncoder>,
    axis_encoders: Vec<AxisEncoder, AXES>,
    wheel: Option<Handwheel>,
    /// The object numbers that are used, a bit for each.
    oids: u64,
}

impl Objects {
    const fn new() -> Self {
        Self {
            steppers: Vec::new(),
            groups: Vec::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            guards: Vec::new(),
            guard_levels: WatchedLevels::new(),
            input_levels: WatchedLevels::new(),
            counters: Vec::new(),
            spindle: None,
            axis_encoders: Vec::new(),
            wheel: None,
            oids: 0,
        }
    }
}

impl Objects {
    /// Collects the levels of the inputs that are watched, after a change.
    fn collect_input_levels(&mut self) {
        let watched = self.inputs.iter().filter(|input| input.next.is_some());
        self.input_levels = watched.map(|input| (input.pin, input.is_high)).collect();
    }
}

/// The periodic report of the spindle encoder.
#[derive(Clone, Copy, Debug, Default)]
struct EncoderReport {
    next: Option<u32>,
    rest_ticks: u32,
}

/// The engine of a board.
#[derive(Clone, Debug)]
pub struct Engine {
    state: EngineState,
    oid_count: Option<u32>,
    /// Hash of the final configuration; `None` before it is final.
    crc: Option<u32>,
    objects: Objects,
    /// Clock at which the lease expires, ticks; `None` without a lease.
    lease: Option<u32>,
    encoder_report: EncoderReport,
    slow_turn: u32,
    events: Deque<Event, EVENTS>,
}

impl Default for Engine {
    fn default() -> Self {
        Self::new()
    }
}

impl Engine {
    /// Creates the engine of a board that has just started: it reports the start.
    pub const fn new() -> Self {
        Self {
            state: EngineState::Running,
            oid_count: None,
            crc: None,
            objects: Objects::new(),
            lease: None,
            encoder_report: EncoderReport {
                next: None,
                rest_ticks: 0,
            },
            slow_turn: 0,
            events: Deque::new(),
        }
    }

    /// Reports that the board has started.
    pub fn report_start(&mut self) {
        self.send(Response::Starting, [0; 4]);
    }

    /// Returns the state.
    pub const fn state(&self) -> EngineState {
        self.state
    }

    /// Removes and returns the oldest event.
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// Whether the engine has room for the events of another request.
    pub fn takes_request(&self) -> bool {
        self.events.len() < EVENTS / 2
    }

    /// Whether no axis has anything to do.
    pub fn is_idle(&self) -> bool {
        self.objects.steppers.iter().all(Stepper::is_idle)
    }

    /// Returns the count of an axis, steps.
    pub fn position(&self, axis: usize) -> i32 {
        self.objects
            .steppers
            .get(axis)
            .map_or(0, |stepper| stepper.position)
    }

    fn send(&mut self, response: Response, values: [i64; 4]) {
        // A full queue: the host does not read, and repeats its queries.
        let _ = self.events.push_back(Event { response, values });
    }

    /// Makes what is due.
    pub fn poll(&mut self, port: &mut impl StepPort) {
        if let EngineState::ShutDown(_) = self.state {
            self.watch_encoders(port);
            return;
        }
        let moment = Moment {
            clock: port.clock() as u32,
            pins: port.pins(),
        };
        let result = self
            .follow_spindle(moment, port)
            .and_then(|()| self.make_steps(moment, port))
            .and_then(|()| self.watch_inputs(moment, port))
            .and_then(|()| self.work_slowly(moment, port));
        if let Err(reason) = result {
            self.shut_down(reason, port);
        }
    }

    /// Counts on while the board is shut down.
    fn watch_encoders(&mut self, port: &mut impl StepPort) {
        if let Some(spindle) = &mut self.objects.spindle {
            // A shut-down board does not move: lost counts do not matter.
            let _ = spindle.take_counts(port.encoder(0));
        }
    }

    #[inline(always)]
    fn follow_spindle(&mut self, moment: Moment, port: &mut impl StepPort) -> Result<(), Reason> {
        let Some(spindle) = &mut self.objects.spindle else {
            return Ok(());
        };
        let from = spindle.angle;
        let mut counts = spindle.take_counts(port.encoder(0))?;
        if counts != 0 {
            let now = moment.clock;
            if let EngineState::Stopping(stop) = &mut self.state {
                let taken = (0..counts.abs()).filter(|_| stop.takes_count(now)).count();
                counts = counts.signum() * taken as i32;
            }
            for stepper in &mut self.objects.steppers {
                if stepper.turn(counts, from, now)? {
                    let values = [stepper.oid.into(), 1, spindle.angle.count.into(), 0];
                    let response = Response::AngleState;
                    let _ = self.events.push_back(Event { response, values });
                }
            }
        }
        if let Some(pin) = spindle.index_pin {
            spindle.take_index(moment.pins >> pin & 1 != 0)?;
        }
        Ok(())
    }

    #[inline(always)]
    fn make_steps(&mut self, moment: Moment, port: &mut impl StepPort) -> Result<(), Reason> {
        let now = moment.clock;
        let mut queue_now = now;
        if let EngineState::Stopping(stop) = self.state {
            queue_now = stop.slowed_clock(now);
        }
        for (axis, stepper) in self.objects.steppers.iter_mut().enumerate() {
            if !stepper.is_idle() && stepper.make_steps(axis, now, queue_now, port)? {
                let count = self
                    .objects
                    .spindle
                    .map_or(0, |spindle| spindle.angle.count);
                let values = [stepper.oid.into(), 0, count.into(), 0];
                let response = Response::AngleState;
                let _ = self.events.push_back(Event { response, values });
            }
        }
        Ok(())
    }

    fn stop_axis(&mut self, axis: usize, port: &mut impl StepPort) {
        let undone = port.cancel_steps(axis);
        if let Some(stepper) = self.objects.steppers.get_mut(axis) {
            stepper.stop(undone);
        }
    }

    /// Stops the axes of a stop group with a reason, unless the group has already triggered.
    fn trigger(&mut self, oid: u32, reason: u32, port: &mut impl StepPort) {
        let groups = &mut self.objects.groups;
        let Some(group) = groups.iter_mut().find(|group| group.oid == oid) else {
            return;
        };
        if !group.can_trigger {
            return;
        }
        group.can_trigger = false;
        group.reason = reason;
        group.expires = None;
        group.report = None;
        for axis in 0..self.objects.steppers.len() {
            if self.objects.steppers[axis].trsync == Some(oid) {
                self.stop_axis(axis, port);
            }
        }
        let now = port.clock() as u32;
        self.report_group(oid, now);
    }

    fn report_group(&mut self, oid: u32, now: u32) {
        let group = self.objects.groups.iter().find(|group| group.oid == oid);
        if let Some(group) = group {
            let values = [
                oid.into(),
                group.can_trigger.into(),
                group.reason.into(),
                now.into(),
            ];
            self.send(Response::TrsyncState, values);
        }
    }

    /// Stops both axes at once and switches the outputs off.
    fn shut_down(&mut self, reason: Reason, port: &mut impl StepPort) {
        for axis in 0..self.objects.steppers.len() {
            self.stop_axis(axis, port);
        }
        for output in &mut self.objects.outputs {
            output.clear();
            port.write_output(output.pin, output.cycle_ticks > 0, output.default);
        }
        for group in &mut self.objects.groups {
            *group = StopGroup {
                oid: group.oid,
                ..StopGroup::default()
            };
        }
        for input in &mut self.objects.inputs {
            input.next = None;
        }
        self.objects.collect_input_levels();
        self.lease = None;
        self.encoder_report.next = None;
        if let Some(wheel) = &mut self.objects.wheel {
            wheel.next = None;
        }
        if let EngineState::ShutDown(_) = self.state {
            return;
        }
        self.state = EngineState::ShutDown(reason);
        let id = FIRST_REASON_ID + reason as u32;
        let now = port.clock() as u32;
        self.send(Response::Shutdown, [now.into(), id.into(), 0, 0]);
    }
}
