//! A control whose motion a pulse board makes: the link beside a simulation, of
//! which everything that the board has not wired stays simulated.
//!
//! ```text
//!            bytes, host time            before            tick              after
//!   port ──► pump ─► link ─► reports ─► Inputs ─► Cnc ─► Outputs ─► samples, orders ─► link ─► port
//! ```
//!
//! What the board says goes into the control with the inputs of a tick, what it is to
//! do comes out with the outputs: the control reacts in its own tick, and nothing here
//! writes into it.
//!
//! The kernel's time is bound to the board's while slides move: it runs ahead of it
//! by no more than the lookahead. In every other state it follows the host's clock,
//! so that ladder, RESET and alarm page live on.
//!
//! The link stands beside the [`Simulation`], not in it: what is saved never holds an
//! open port.

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

/// Keys of the control as they were in the last tick: their edges stop the board.
#[derive(Clone, Copy, Debug, Default)]
struct Keys {
    resetting: bool,
    emergency: bool,
}

/// Where the link stands with its board, as the control last heard.
#[derive(Clone, Copy, Debug)]
struct Connection {
    state: LinkState,
    /// RESET was pressed while the board was lost.
    reopen: bool,
    /// The holder of the port has stopped the board that is lost.
    stopped: bool,
    /// Spindle and coolant were on when the board was lost, or before it was there: they
    /// stay off until they have been switched off.
    withheld: bool,
}

/// What the control last wanted.
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

/// The returns of the control to its machine zero.
#[derive(Clone, Copy, Debug, Default)]
struct Returns {
    /// The count from which the control seeks a switch.
    sought_from: PerAxis<Pulses>,
    /// The board has just found its switches.
    homed: bool,
    /// How far the limit switches of an axis are apart, mm; X as a diameter.
    lengths: PerAxis<Option<f64>>,
}

/// A link and what it does with the control beside it.
#[derive(Clone, Debug)]
pub struct Linked {
    link: Link,
    config: LinkConfig,
    /// The parameters as they were when the link was opened.
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
    /// Opens the link of a control: its slides are real from now on, and nobody knows
    /// where they stand.
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

    /// What boards met before said they understand; to be told before the first
    /// [`pump`](Self::pump).
    pub fn know(&mut self, dictionaries: Vec<Vec<u8>>) {
        self.link.add_dictionaries(dictionaries);
    }

    /// The link is over; the slides are simulated again. The last bytes for the board
    /// stop it.
    pub fn close(mut self, simulation: &mut Simulation) -> Vec<u8> {
        self.link.close();
        simulation.detach_board();
        self.link.tx().to_vec()
    }

    /// Bytes came from the port, time passed. To be called at least every 5 ms, and
    /// before [`may_tick`](Self::may_tick) is asked.
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

    /// The port failed.
    pub fn lost(&mut self, cause: Message) {
        self.link.lost(cause);
        for event in self.link.events() {
            self.hear(event);
        }
        self.adopt_count();
        self.report_standstill();
    }

    /// The process that held the port has stopped the board, and this is what the board
    /// answered: whether its outputs are off is known then, although the link is lost.
    pub fn stopped_by_holder(&mut self, answered: &[u8]) {
        self.connection.stopped = self.link.has_answered_stop(answered);
    }

    /// Whether the board has to be stopped when this program falls silent. One of timed
    /// steps stops by itself then.
    pub fn needs_guard(&self) -> bool {
        let on =
            |outputs: BoardOutputs| outputs.spindle != SpindleDirection::Stop || outputs.coolant;
        self.config.protocol == Protocol::Line
            && (self.is_behind()
                || self.thread.pass.is_some()
                || self.link.switched().is_none_or(on))
    }

    /// Bytes to be written to the port.
    pub fn tx(&self) -> &[u8] {
        self.link.tx()
    }

    /// So many of them were written.
    pub fn consumed(&mut self, count: usize) {
        self.link.consumed(count);
    }

    /// What stops the board when this program is gone.
    pub fn stop_bytes(&self) -> Vec<u8> {
        self.link.stop_bytes()
    }

    /// One tick of a simulation that stands by itself, without a panel.
    pub fn tick(&mut self, simulation: &mut Simulation) {
        self.before(simulation);
        simulation.tick();
        self.after(simulation);
    }

    /// To be called before each tick of the simulation.
    pub fn before(&mut self, simulation: &mut Simulation) {
        let inputs = self.inputs_of_tick();
        simulation.set_board(inputs);
    }

    /// To be called after each tick of the simulation.
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

    /// What the board says of its switches.
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

    /// Every input that a board may have, with its state; `None`: not wired.
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

    /// The power of the control is off, or has just come back: its count of pulses
    /// begins anew.
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

    /// The motion of the tick goes to the board.
    fn hand_over(&mut self) {
        let Control { pulses, orders } = self.control;
        if self.thread.pass.is_some() {
            // The board goes ahead; the control only follows.
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

    /// Motion that the board does not take is not made: the control goes back to
    /// where the slides are.
    fn refuse(&mut self, refused: MotionRefused) {
        let (number, text) = refused.to_alarm();
        self.raise(Alarm::new(number).because(text));
        self.report(BoardReport::Halted);
        self.motion.moved = false;
        self.report(BoardReport::NotTaken(self.motion.pulses));
        if self.link.state() == LinkState::Moving {
            // Where that is, the board tells when it stands.
            self.link.stop(Stop::Flush);
            self.stopping.flush();
        }
    }

    /// Whether the slides may still be on their way.
    pub fn is_behind(&self) -> bool {
        matches!(
            self.link.state(),
            LinkState::Moving | LinkState::Verify | LinkState::Homing
        ) || self.link.outstanding() > Duration::ZERO
    }

    /// What the owner should find in the log.
    pub fn notes(&mut self) -> Vec<Note> {
        core::mem::take(&mut self.log.notes)
    }

    /// Whether the operator wants the lost board back: the port is to be opened anew.
    pub const fn is_to_be_reopened(&self) -> bool {
        self.connection.reopen
    }

    /// Compares the counts, when the slides stand.
    pub fn check(&mut self) {
        if self.link.state() == LinkState::Ready && !self.is_behind() {
            self.log.checking = self.link.compare();
            if !self.log.checking {
                // What differs is an alarm as soon as it is reported.
                self.checked(true, None);
            }
        }
    }

    /// The port is about to be closed: the last comparison is noted.
    pub fn check_last(&mut self) {
        if self.link.state() == LinkState::Ready && !self.is_behind() {
            self.checked(true, None);
        }
    }

    /// Whether it is known where the slides stand.
    pub fn knows_position(&self) -> bool {
        self.link.knows_position()
    }

    /// What the board has switched; none while an order is under way.
    pub fn outputs(&self) -> Option<BoardOutputs> {
        self.link.switched()
    }

    /// Writes the settings that differ; the operator was asked.
    pub fn write_settings(&mut self) {
        self.link.write_settings();
    }

    /// The spindle whose index the board sees, as the control was last shown it.
    pub const fn spindle(&self) -> Option<SpindleView> {
        self.spindle.view
    }

    /// Where the link stands.
    pub fn state(&self) -> LinkState {
        self.link.state()
    }

    /// Whether the board is still being asked who it is and how it is set.
    pub const fn is_opening(&self) -> bool {
        matches!(
            self.connection.state,
            LinkState::Opening | LinkState::Identify | LinkState::Configure
        )
    }

    /// Its settings in the machine file.
    pub const fn config(&self) -> &LinkConfig {
        &self.config
    }

    /// The next piece of the traffic as text, from bytes that are collected.
    pub fn next_text(&self, outward: bool, collected: &mut Vec<u8>) -> Option<String> {
        self.link.next_text(outward, collected)
    }

    /// What the board said it is.
    pub fn board(&self) -> &BoardInfo {
        self.link.board()
    }

    /// Switches at the board that are operated.
    pub fn pins(&self) -> Pins {
        self.link.pins()
    }

    /// Figures of the wire.
    pub fn traffic(&self) -> Traffic {
        self.link.traffic()
    }

    /// Motion handed over that may not have been made yet.
    pub fn outstanding(&self) -> Duration {
        self.link.outstanding()
    }

    /// Pulses commanded so far.
    pub const fn commanded(&self) -> PerAxis<Pulses> {
        self.motion.pulses
    }

    /// The board's count in the control's pulses, as last reported.
    pub fn counted(&self) -> Option<PerAxis<Pulses>> {
        self.link.counted()
    }

    /// Where the axes stand after the board's reference return, machine coordinates.
    fn home(&self) -> Point {
        Point::new(self.config.x.home_at / 2.0, self.config.z.home_at)
    }
}
