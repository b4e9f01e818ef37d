//! Runs a simulation whose axes a pulse board moves: the link beside a [`Simulation`], in
//! which everything that the board has not wired stays simulated.
//!
//! ```text
//!            bytes, host time            before            tick              after
//!   port ──► pump ─► link ─► reports ─► Inputs ─► Cnc ─► Outputs ─► samples, orders ─► link ─► port
//! ```
//!
//! Reports of the board enter the control with the inputs of a tick. The control's orders
//! leave with its outputs. The control reacts in its own tick; this module writes nothing
//! into it.
//!
//! While slides move the kernel's time follows the board's, ahead of it by at most the
//! lookahead. Otherwise it follows the host's clock, so that ladder, RESET and alarm page
//! stay alive.
//!
//! The link is kept beside the simulation, not in it: a saved state never contains an open
//! port.

mod drives;
mod events;
mod log;
mod motion;
mod pace;
mod pass;
mod position;
mod reports;
mod spindle;
mod stopping;

use core::time::Duration;

use crate::board::{BoardOrders, CheckedParameters};
use crate::machine::{BoardContacts, LimitSwitches};
use crate::simulation::Simulation;
use crate::units::{PerAxis, Point, Pulses};
pub use drives::drives_from_parameters;
use gsk_link::{
    BoardInfo, BoardOutputs, EncoderReading, HostTime, Input, Link, LinkConfig, LinkState, Output,
    Pins, Protocol, SpindleDirection, SpindleView, Traffic,
};
use gsk_messages::Message;
use log::LinkLog;
pub use log::LinkNote;
use motion::CommandedMotion;
use pace::{LinkClock, PowerChange, PowerWatch};
use pass::BoardThread;
pub use position::MotionStamp;
use reports::PendingReports;
use spindle::MeasuredSpindle;
use stopping::StopInProgress;

/// Keys of the control at the last tick. Their rising edges stop the board.
#[derive(Clone, Copy, Debug, Default)]
struct StopKeys {
    resetting: bool,
    emergency: bool,
}

/// State of the board connection as the control last received it.
#[derive(Clone, Copy, Debug)]
struct LinkedConnection {
    state: LinkState,
    /// Set when RESET was pressed while the connection to the board was lost.
    reopen_requested: bool,
    /// Set when the guard process has stopped the lost board.
    guard_stopped: bool,
    /// Set when spindle and coolant were on at the loss of the board or before it was
    /// ready. They stay off until the ladder has switched them off.
    outputs_withheld: bool,
}

/// Pulse counts and orders of the control after its last tick.
#[derive(Clone, Copy, Debug, Default)]
struct ControlSnapshot {
    pulses: PerAxis<Pulses>,
    orders: BoardOrders,
}

impl ControlSnapshot {
    fn from_simulation(simulation: &Simulation) -> Self {
        Self {
            pulses: simulation.cnc.pulses(),
            orders: simulation.board_orders(),
        }
    }
}

/// Data of the reference returns that the control drives itself.
#[derive(Clone, Copy, Debug, Default)]
struct ReturnSearch {
    /// Pulse count of each axis at the start of its search for a switch.
    search_start: PerAxis<Pulses>,
    /// Set when the board has just completed its homing.
    homed: bool,
    /// Distance between the limit switches of an axis, mm; X as a diameter. `None`: no
    /// limit switches.
    travel_mm: PerAxis<Option<f64>>,
}

/// Connects a simulated control to a pulse board through a [`Link`].
#[derive(Clone, Debug)]
pub struct LinkedControl {
    link: Link,
    config: LinkConfig,
    /// Parameter values when the link was opened; a later change of them prevents motion.
    checked: CheckedParameters,
    connection: LinkedConnection,
    clock: LinkClock,
    power: PowerWatch,
    keys: StopKeys,
    motion: CommandedMotion,
    stopping: StopInProgress,
    returns: ReturnSearch,
    thread: BoardThread,
    spindle: MeasuredSpindle,
    control: ControlSnapshot,
    reports: PendingReports,
    log: LinkLog,
}

impl LinkedControl {
    /// Opens the link to a board and connects it to the control. The position of the slides
    /// is unknown from now on.
    pub fn open(config: LinkConfig, simulation: &mut Simulation, now: HostTime) -> Self {
        let checked = CheckedParameters::new(simulation.cnc.parameters(), config.protocol);
        let link = Link::open(
            config.clone(),
            &drives_from_parameters(simulation.cnc.parameters()),
            now,
        );
        simulation.attach_board();
        let lathe = simulation.lathe.config();
        let travel =
            |limits: Option<LimitSwitches>| limits.map(|switches| switches.plus - switches.minus);
        Self {
            link,
            config,
            checked,
            connection: LinkedConnection {
                state: LinkState::Opening,
                reopen_requested: false,
                guard_stopped: false,
                outputs_withheld: true,
            },
            clock: LinkClock::new(now),
            power: PowerWatch::new(simulation.cnc.ticks()),
            keys: StopKeys::default(),
            motion: CommandedMotion::new(simulation.cnc.pulses()),
            stopping: StopInProgress::None,
            returns: ReturnSearch {
                travel_mm: PerAxis::new(travel(lathe.x.limits), travel(lathe.z.limits)),
                ..ReturnSearch::default()
            },
            thread: BoardThread::default(),
            spindle: MeasuredSpindle::default(),
            control: ControlSnapshot::from_simulation(simulation),
            reports: PendingReports::default(),
            log: LinkLog::default(),
        }
    }

    /// Adds data dictionaries that boards sent in earlier sessions. Call it before the
    /// first [`pump`](Self::pump).
    pub fn add_dictionaries(&mut self, dictionaries: Vec<Vec<u8>>) {
        self.link.add_dictionaries(dictionaries);
    }

    /// Closes the link and connects the simulated slides again. Returns the last bytes to
    /// write to the board, which stop it.
    pub fn close(mut self, simulation: &mut Simulation) -> Vec<u8> {
        self.link.close();
        simulation.detach_board();
        self.link.tx().to_vec()
    }

    /// Passes received bytes and the host time to the link. Call it at least every 5 ms,
    /// and before [`can_tick`](Self::can_tick).
    pub fn pump(&mut self, bytes: &[u8], now: HostTime) {
        let gap = self.clock.advance(now);
        self.handle_host_gap(gap);
        self.link.rx(bytes, self.clock.now);
        self.link.tick(self.clock.now);
        for event in self.link.events() {
            self.handle_event(event);
        }
        self.adopt_count();
        self.report_late();
        self.report_standstill();
        self.issue_requests();
    }

    /// Handles a failure of the port: `cause` becomes the reason of the alarm.
    pub fn handle_port_failure(&mut self, cause: Message) {
        self.link.lost(cause);
        for event in self.link.events() {
            self.handle_event(event);
        }
        self.adopt_count();
        self.report_standstill();
    }

    /// Handles a stop of the board by the guard process. `answered` are the bytes that the
    /// board sent in answer; they show whether its outputs are off although the link is
    /// lost.
    pub fn handle_guard_stop(&mut self, answered: &[u8]) {
        self.connection.guard_stopped = self.link.has_answered_stop(answered);
    }

    /// Whether the guard process must stop the board if this program falls silent. False
    /// for a board of timed steps, which then stops without a command.
    pub fn needs_guard(&self) -> bool {
        let is_on =
            |outputs: BoardOutputs| outputs.spindle != SpindleDirection::Stop || outputs.coolant;
        self.config.protocol == Protocol::Line
            && (self.has_pending_motion()
                || self.thread.is_active()
                || self.link.switched().is_none_or(is_on))
    }

    /// Bytes that wait to be written to the port.
    pub fn tx(&self) -> &[u8] {
        self.link.tx()
    }

    /// Drops the first `count` bytes of [`tx`](Self::tx), which have been written.
    pub fn mark_written(&mut self, count: usize) {
        self.link.consumed(count);
    }

    /// Bytes that stop the board; the guard process sends them when this program has ended.
    pub fn stop_bytes(&self) -> Vec<u8> {
        self.link.stop_bytes()
    }

    /// Runs one tick of `simulation` with the board, from `before_tick` to `after_tick`.
    pub fn tick(&mut self, simulation: &mut Simulation) {
        self.before_tick(simulation);
        simulation.tick();
        self.after_tick(simulation);
    }

    /// Passes the board's reports to the simulation. Call it before each tick.
    pub fn before_tick(&mut self, simulation: &mut Simulation) {
        let inputs = self.inputs_of_tick();
        simulation.set_board(inputs);
        let turned = self.take_wheel_turn();
        simulation.lathe.turn_handwheel(turned);
    }

    /// Passes motion and orders of the control to the board. Call it after each tick.
    pub fn after_tick(&mut self, simulation: &mut Simulation) {
        self.clock.run += Duration::from_millis(1);
        match self.power.tick(simulation.cnc.ticks()) {
            PowerChange::None => {}
            PowerChange::Lost => self.handle_power_change(simulation),
            PowerChange::Tick => {
                self.control = ControlSnapshot::from_simulation(simulation);
                self.push_motion();
                self.apply_orders();
                self.stop_abandoned_tap();
                self.offer_pass();
            }
        }
        simulation.add_board_contacts(&self.board_contacts());
    }

    /// Reads the inputs of the board as contacts of the control.
    fn board_contacts(&self) -> BoardContacts {
        let pins = self.link.pins();
        let input = |x, z| PerAxis::new(self.link.input(x), self.link.input(z));
        let mut contacts = BoardContacts {
            emergency_stop_open: pins.emergency,
            door_open: pins.door,
            deceleration_switch: input(Input::DecelerationX, Input::DecelerationZ),
            zero_signal: input(Input::ZeroX, Input::ZeroZ),
            ..BoardContacts::default()
        };
        for contact in self.config.contacts() {
            if let Input::Contact { byte, bit } = contact
                && let Some(closed) = self.link.input(contact)
            {
                contacts.wired[usize::from(byte)] |= 1 << bit;
                contacts.closed[usize::from(byte)] |= u8::from(closed) << bit;
            }
        }
        contacts
    }

    /// All inputs that a board can have, each with its state: true = active, `None` = not
    /// wired.
    pub fn inputs(&self) -> Vec<(Input, Option<bool>)> {
        let usual = [
            Input::LimitX,
            Input::LimitZ,
            Input::EmergencyStop,
            Input::DriveAlarm,
            Input::DecelerationX,
            Input::DecelerationZ,
            Input::ZeroX,
            Input::ZeroZ,
        ];
        let contacts = self.config.contacts();
        let all = usual.into_iter().chain(contacts);
        all.map(|input| (input, self.link.input(input))).collect()
    }

    /// Outputs that are not wired to the board and stay with the simulated lathe.
    pub fn missing_outputs(&self) -> Vec<Output> {
        if self.config.protocol == Protocol::Line {
            return Vec::new();
        }
        let io = &self.config.io;
        let outputs = [
            (Output::SpindleForward, &io.spindle_cw),
            (Output::SpindleReverse, &io.spindle_ccw),
            (Output::SpindleSpeed, &io.spindle_pwm),
            (Output::Coolant, &io.coolant),
        ];
        let missing = outputs.into_iter().filter(|(_, pin)| pin.is_empty());
        missing.map(|(output, _)| output).collect()
    }

    /// Handles the loss or return of the control's power, after which its pulse count
    /// starts at zero.
    fn handle_power_change(&mut self, simulation: &mut Simulation) {
        self.stopping = StopInProgress::None;
        self.thread.pass = None;
        self.thread.tap = None;
        self.link.forget_position();
        self.link.set_outputs(BoardOutputs::default());
        simulation.attach_board();
        self.reports = PendingReports::default();
        self.control = ControlSnapshot::from_simulation(simulation);
        self.motion.set_count(self.control.pulses);
    }

    /// Whether the slides may still move or the board holds motion.
    pub fn has_pending_motion(&self) -> bool {
        matches!(
            self.link.state(),
            LinkState::Moving | LinkState::Verify | LinkState::Homing
        ) || self.link.outstanding() > Duration::ZERO
    }

    /// Removes and returns the new entries for the link's log.
    pub fn take_notes(&mut self) -> Vec<LinkNote> {
        core::mem::take(&mut self.log.notes)
    }

    /// Whether RESET was pressed while the board was lost: the caller must open the port
    /// again.
    pub const fn needs_reopening(&self) -> bool {
        self.connection.reopen_requested
    }

    /// Starts a comparison of commanded and counted pulses, if the slides stand still. A
    /// log entry reports the result.
    pub fn check_count(&mut self) {
        if self.link.state() == LinkState::Ready && !self.has_pending_motion() {
            self.log.checking = self.link.compare();
            if !self.log.checking {
                // A difference raises an alarm as soon as the board reports it.
                self.log_count_check(true, None);
            }
        }
    }

    /// Logs a last comparison of the counts before the port is closed.
    pub fn check_count_before_close(&mut self) {
        if self.link.state() == LinkState::Ready && !self.has_pending_motion() {
            self.log_count_check(true, None);
        }
    }

    /// Whether the position of the slides is known.
    pub fn knows_position(&self) -> bool {
        self.link.knows_position()
    }

    /// Outputs that the board has switched; `None` while it still executes an order to
    /// switch.
    pub fn outputs(&self) -> Option<BoardOutputs> {
        self.link.switched()
    }

    /// Writes the settings that the control needs to the board, where they differ. Call it
    /// after the operator has confirmed.
    pub fn write_settings(&mut self) {
        self.link.write_settings();
    }

    /// The spindle that the board measures by its index signal, as the control last
    /// received it; `None`: the simulated spindle applies.
    pub const fn spindle(&self) -> Option<SpindleView> {
        self.spindle.view
    }

    /// The spindle as its encoder at the board reports it; `None` without an encoder.
    pub fn encoder(&self) -> Option<EncoderReading> {
        self.link.encoder()
    }

    /// Returns the state of the connection to the board.
    pub fn state(&self) -> LinkState {
        self.link.state()
    }

    /// Whether the board is still being identified and configured.
    pub const fn is_opening(&self) -> bool {
        matches!(
            self.connection.state,
            LinkState::Opening | LinkState::Identify | LinkState::Configure
        )
    }

    /// Settings of the link, from the machine file.
    pub const fn config(&self) -> &LinkConfig {
        &self.config
    }

    /// Takes the next line or block from `collected`, the bytes of one direction, and
    /// formats it as text; `None` if it is incomplete. `outward`: the bytes go to the
    /// board.
    pub fn next_traffic_text(&self, outward: bool, collected: &mut Vec<u8>) -> Option<String> {
        self.link.next_text(outward, collected)
    }

    /// Identity of the board, from its own report.
    pub fn board(&self) -> &BoardInfo {
        self.link.board()
    }

    /// Returns which switches at the board are operated, from its last report.
    pub fn pins(&self) -> Pins {
        self.link.pins()
    }

    /// Counters of the serial traffic with the board.
    pub fn traffic(&self) -> Traffic {
        self.link.traffic()
    }

    /// Duration of motion that the board may not have executed yet.
    pub fn outstanding(&self) -> Duration {
        self.link.outstanding()
    }

    /// Pulse count of each axis that was commanded to the board.
    pub const fn commanded(&self) -> PerAxis<Pulses> {
        self.motion.pulses
    }

    /// The board's last reported count, in the control's pulses; `None` before the first
    /// report.
    pub fn counted(&self) -> Option<PerAxis<Pulses>> {
        self.link.counted()
    }

    /// Machine coordinates of both axes after the board's homing, mm, X as a radius.
    fn home_position(&self) -> Point {
        Point::new(self.config.x.home_at / 2.0, self.config.z.home_at)
    }
}
