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

use crate::alarm::Alarm;
use crate::board::{BoardOrders, BoardReport, Checked};
use crate::machine::{BoardContacts, LimitSwitches};
use crate::simulation::Simulation;
use crate::units::{PerAxis, Point, Pulses};
pub use drives::drives;
use gsk_link::{
    BoardInfo, BoardOutputs, FINE, HostTime, Input, Link, LinkConfig, LinkState, MotionRefused,
    Output, Pins, Protocol, Sample, SpindleDirection, SpindleView, Stop, Traffic,
};
use gsk_messages::Message;
use log::Log;
pub use log::Note;
use motion::Commanded;
use pace::{Clock, Power, PowerEvent};
use pass::Thread;
pub use position::Stamp;
use reports::Reports;
use spindle::Spindle;
use stopping::Stopping;

/// Keys of the control at the last tick. Their rising edges stop the board.
#[derive(Clone, Copy, Debug, Default)]
struct Keys {
    resetting: bool,
    emergency: bool,
}

/// State of the connection as the control last received it.
#[derive(Clone, Copy, Debug)]
struct Connection {
    state: LinkState,
    /// Set when RESET was pressed while the board was lost.
    reopen: bool,
    /// Set when the guard process has stopped the lost board.
    stopped: bool,
    /// Set when spindle and coolant were on at the loss of the board or before it was
    /// ready. They stay off until the ladder has switched them off.
    withheld: bool,
}

/// What the control commanded in its last tick.
#[derive(Clone, Copy, Debug, Default)]
struct Control {
    pulses: PerAxis<Pulses>,
    orders: BoardOrders,
}

impl Control {
    fn of(simulation: &Simulation) -> Self {
        Self {
            pulses: simulation.cnc.pulses(),
            orders: simulation.board_orders(),
        }
    }
}

/// Reference returns that the control drives.
#[derive(Clone, Copy, Debug, Default)]
struct Returns {
    /// Pulse count at which the control began to seek a switch.
    sought_from: PerAxis<Pulses>,
    /// Set when the board has just homed.
    homed: bool,
    /// Distance between the limit switches of an axis, mm; X as a diameter.
    lengths: PerAxis<Option<f64>>,
}

/// A link to a pulse board and its exchange with the control beside it.
#[derive(Clone, Debug)]
pub struct Linked {
    link: Link,
    config: LinkConfig,
    /// Parameter values when the link was opened.
    checked: Checked,
    connection: Connection,
    clock: Clock,
    power: Power,
    keys: Keys,
    motion: Commanded,
    stopping: Stopping,
    returns: Returns,
    thread: Thread,
    spindle: Spindle,
    control: Control,
    reports: Reports,
    log: Log,
}

impl Linked {
    /// Opens the link of a control. The position of its slides is unknown from now on.
    pub fn open(config: LinkConfig, simulation: &mut Simulation, now: HostTime) -> Self {
        let checked = Checked::new(simulation.cnc.parameters(), config.protocol);
        let link = Link::open(config.clone(), &drives(simulation.cnc.parameters()), now);
        simulation.attach_board();
        let lathe = simulation.lathe.config();
        let length = |limits: Option<LimitSwitches>| limits.map(|it| it.plus - it.minus);
        Self {
            link,
            config,
            checked,
            connection: Connection {
                state: LinkState::Opening,
                reopen: false,
                stopped: false,
                withheld: true,
            },
            clock: Clock::new(now),
            power: Power::new(simulation.cnc.ticks()),
            keys: Keys::default(),
            motion: Commanded::new(simulation.cnc.pulses()),
            stopping: Stopping::None,
            returns: Returns {
                lengths: PerAxis::new(length(lathe.x.limits), length(lathe.z.limits)),
                ..Returns::default()
            },
            thread: Thread::default(),
            spindle: Spindle::default(),
            control: Control::of(simulation),
            reports: Reports::default(),
            log: Log::default(),
        }
    }

    /// Adds data dictionaries that boards sent in earlier sessions. Call it before the
    /// first [`pump`](Self::pump).
    pub fn know(&mut self, dictionaries: Vec<Vec<u8>>) {
        self.link.add_dictionaries(dictionaries);
    }

    /// Closes the link and returns to simulated slides. Returns the last bytes for the
    /// board, which stop it.
    pub fn close(mut self, simulation: &mut Simulation) -> Vec<u8> {
        self.link.close();
        simulation.detach_board();
        self.link.tx().to_vec()
    }

    /// Passes received bytes and the host time to the link. Call it at least every 5 ms,
    /// and before [`may_tick`](Self::may_tick).
    pub fn pump(&mut self, bytes: &[u8], now: HostTime) {
        let gap = self.clock.passes(now);
        self.judge_absence(gap);
        self.link.rx(bytes, self.clock.now);
        self.link.tick(self.clock.now);
        for event in self.link.events() {
            self.hear(event);
        }
        self.adopt_count();
        self.report_late();
        self.report_standstill();
        self.settle();
    }

    /// Reports that the port failed.
    pub fn lost(&mut self, cause: Message) {
        self.link.lost(cause);
        for event in self.link.events() {
            self.hear(event);
        }
        self.adopt_count();
        self.report_standstill();
    }

    /// Reports that the guard process stopped the board, with the bytes that the board
    /// answered. They show whether the outputs are off although the link is lost.
    pub fn stopped_by_holder(&mut self, answered: &[u8]) {
        self.connection.stopped = self.link.has_answered_stop(answered);
    }

    /// Whether the guard process must stop the board if this program falls silent. A board
    /// of timed steps stops on its own.
    pub fn needs_guard(&self) -> bool {
        let on =
            |outputs: BoardOutputs| outputs.spindle != SpindleDirection::Stop || outputs.coolant;
        self.config.protocol == Protocol::Line
            && (self.is_behind()
                || self.thread.pass.is_some()
                || self.link.switched().is_none_or(on))
    }

    /// Bytes to write to the port.
    pub fn tx(&self) -> &[u8] {
        self.link.tx()
    }

    /// Drops the first `count` bytes of [`tx`](Self::tx), which have been written.
    pub fn consumed(&mut self, count: usize) {
        self.link.consumed(count);
    }

    /// Bytes that stop the board; the guard process sends them when this program has ended.
    pub fn stop_bytes(&self) -> Vec<u8> {
        self.link.stop_bytes()
    }

    /// Runs one tick of a simulation without a panel.
    pub fn tick(&mut self, simulation: &mut Simulation) {
        self.before(simulation);
        simulation.tick();
        self.after(simulation);
    }

    /// Passes the board's reports to the simulation. Call it before each tick.
    pub fn before(&mut self, simulation: &mut Simulation) {
        let inputs = self.inputs_of_tick();
        simulation.set_board(inputs);
    }

    /// Passes the control's motion and orders to the board. Call it after each tick.
    pub fn after(&mut self, simulation: &mut Simulation) {
        self.clock.run += Duration::from_millis(1);
        match self.power.tick(simulation.cnc.ticks()) {
            PowerEvent::None => {}
            PowerEvent::Lost => self.without_power(simulation),
            PowerEvent::Tick => {
                self.control = Control::of(simulation);
                self.hand_over();
                self.follow();
                self.offer_pass();
            }
        }
        simulation.add_board_contacts(&self.contacts());
    }

    /// The switches of the board as contacts of the control.
    fn contacts(&self) -> BoardContacts {
        let pins = self.link.pins();
        let input = |x, z| PerAxis::new(self.link.input(x), self.link.input(z));
        let mut contacts = BoardContacts {
            emergency: pins.emergency,
            door: pins.door,
            switch: input(Input::DecelerationX, Input::DecelerationZ),
            signal: input(Input::ZeroX, Input::ZeroZ),
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

    /// All inputs that a board can have, with their state; `None` = not wired.
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

    /// Handles the loss or return of the control's power: its pulse count starts again from
    /// zero.
    fn without_power(&mut self, simulation: &mut Simulation) {
        self.stopping = Stopping::None;
        self.thread.pass = None;
        self.link.forget_position();
        self.link.set_outputs(BoardOutputs::default());
        simulation.attach_board();
        self.reports = Reports::default();
        self.control = Control::of(simulation);
        self.motion.stand_at(self.control.pulses);
    }

    /// Passes the motion of the tick to the board.
    fn hand_over(&mut self) {
        let Control { pulses, orders } = self.control;
        if self.thread.pass.is_some() {
            // The board moves first; the control follows its count.
            self.motion.stand_at(pulses);
            return;
        }
        self.motion.moved = pulses != self.motion.pulses;
        if !self.motion.moved && !self.link.is_prepared() {
            return;
        }
        let waits = orders.spindle.waits;
        self.link.keep_time(waits || orders.spindle.lead.is_some());
        let parts = |position: f64| (position * FINE as f64).round() as i64;
        let sample = Sample {
            end: self.clock.run,
            pulses,
            fine: PerAxis::new(parts(orders.fine.x), parts(orders.fine.z)),
        };
        match self.link.push(sample) {
            Ok(()) => self.motion.pulses = pulses,
            Err(refused) => return self.refuse(refused),
        }
        if self.motion.moved {
            self.motion.last = self.clock.run;
        } else if !waits
            && !orders.moving
            && let Err(refused) = self.link.finish()
        {
            self.refuse(refused);
        }
    }

    /// Handles motion that the board rejects: the control returns to the position of the
    /// slides.
    fn refuse(&mut self, refused: MotionRefused) {
        let (number, text) = refused.to_alarm();
        self.raise(Alarm::new(number).because(text));
        self.report(BoardReport::Halted);
        self.motion.moved = false;
        self.report(BoardReport::NotTaken(self.motion.pulses));
        if self.link.state() == LinkState::Moving {
            // The board reports that position when it has stopped.
            self.link.stop(Stop::Flush);
            self.stopping.flush();
        }
    }

    /// Whether the slides may still move or the board holds motion.
    pub fn is_behind(&self) -> bool {
        matches!(
            self.link.state(),
            LinkState::Moving | LinkState::Verify | LinkState::Homing
        ) || self.link.outstanding() > Duration::ZERO
    }

    /// Takes the entries for the link's log.
    pub fn notes(&mut self) -> Vec<Note> {
        core::mem::take(&mut self.log.notes)
    }

    /// Whether the operator wants the lost board back: the caller then opens the port
    /// again.
    pub const fn is_to_be_reopened(&self) -> bool {
        self.connection.reopen
    }

    /// Starts a comparison of the counts, if the slides stand still.
    pub fn check(&mut self) {
        if self.link.state() == LinkState::Ready && !self.is_behind() {
            self.log.checking = self.link.compare();
            if !self.log.checking {
                // A difference raises an alarm as soon as the board reports it.
                self.checked(true, None);
            }
        }
    }

    /// Logs a last comparison of the counts before the port is closed.
    pub fn check_last(&mut self) {
        if self.link.state() == LinkState::Ready && !self.is_behind() {
            self.checked(true, None);
        }
    }

    /// Whether the position of the slides is known.
    pub fn knows_position(&self) -> bool {
        self.link.knows_position()
    }

    /// Outputs that the board has switched; `None` while an order is under way.
    pub fn outputs(&self) -> Option<BoardOutputs> {
        self.link.switched()
    }

    /// Writes the settings that differ to the board. The operator has confirmed it.
    pub fn write_settings(&mut self) {
        self.link.write_settings();
    }

    /// The spindle whose index the board measures, as the control last received it.
    pub const fn spindle(&self) -> Option<SpindleView> {
        self.spindle.view
    }

    /// State of the connection.
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

    /// Settings of the link in the machine file.
    pub const fn config(&self) -> &LinkConfig {
        &self.config
    }

    /// The next message of the traffic as text, taken from the collected bytes; `outward`
    /// selects the direction.
    pub fn next_text(&self, outward: bool, collected: &mut Vec<u8>) -> Option<String> {
        self.link.next_text(outward, collected)
    }

    /// Identity of the board as it reported it.
    pub fn board(&self) -> &BoardInfo {
        self.link.board()
    }

    /// Switches at the board that are operated.
    pub fn pins(&self) -> Pins {
        self.link.pins()
    }

    /// Counters of the traffic on the line.
    pub fn traffic(&self) -> Traffic {
        self.link.traffic()
    }

    /// Duration of motion that the board may not have executed yet.
    pub fn outstanding(&self) -> Duration {
        self.link.outstanding()
    }

    /// Pulses commanded to the board.
    pub const fn commanded(&self) -> PerAxis<Pulses> {
        self.motion.pulses
    }

    /// The board's last reported count, in the control's pulses; `None` before the first
    /// report.
    pub fn counted(&self) -> Option<PerAxis<Pulses>> {
        self.link.counted()
    }

    /// Machine coordinates after the board's homing, X as a radius.
    fn home(&self) -> Point {
        Point::new(self.config.x.home_at / 2.0, self.config.z.home_at)
    }
}
