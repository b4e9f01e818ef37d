//! A control whose motion a pulse board makes: the link beside a simulation, of
//! which everything that the board has not wired stays simulated.
//!
//! ```text
//!            bytes, host time                 before      tick       after
//!   port ──► pump ─► link ─► events ─► control ──► inputs ─► Cnc ─► sample ─► link ─► port
//! ```
//!
//! The kernel's time is bound to the board's while slides move: it runs ahead of it
//! by no more than the lookahead. In every other state it follows the host's clock,
//! so that ladder, RESET and alarm page live on.
//!
//! The link stands beside the [`Simulation`], not in it: what is saved never holds an
//! open port.

mod control;
mod pace;
mod pass;
mod place;
mod spindle;

use core::time::Duration;

use super::{
    BoardInfo, BoardOutputs, Checked, Difference, FINE, HostTime, Input, Link, LinkConfig,
    LinkState, Output, Pass, Pins, Protocol, Refused, RunTime, Sample, SpindleView, Stop, Traffic,
    contacts,
};
use crate::alarm::Alarm;
use crate::command::ProgramId;
use crate::machine::BoardContacts;
use crate::simulation::Simulation;
use crate::units::{Axis, PerAxis, Point, Pulses};
pub use place::Stamp;

const UPON_LIMIT: &str = "the limit switch is operated, and nobody knows on which end of the axis: \
                          look which way leads off it, then RESET; each RESET lets it go 1 mm";

/// Something for the log of the link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Note {
    /// The board's count was compared with the commanded one.
    Checked {
        /// The program that has just ended, if it was that.
        program: Option<ProgramId>,
        /// What was commanded.
        commanded: PerAxis<Pulses>,
        /// What the board has counted, where it said so.
        counted: Option<PerAxis<Pulses>>,
        /// They agree.
        agrees: bool,
    },
    /// What a board said it understands, for [`Linked::know`] at the next opening.
    Learned {
        /// Processor and version.
        name: String,
        /// As it goes over the wire.
        packed: Vec<u8>,
    },
    /// A setting of the board is not what it has to be.
    Differs(Difference),
}

/// A link and what it does with the control beside it.
#[derive(Clone, Debug)]
pub struct Linked {
    link: Link,
    config: LinkConfig,
    now: HostTime,
    /// Kernel time since the link was opened.
    run: RunTime,
    /// Control ticks at the last look: a stop or a jump back is the power.
    ticks: u64,
    pulses: PerAxis<Pulses>,
    /// End of the last tick that made a pulse.
    last_motion: RunTime,
    moved: bool,
    pace: pace::Pace,
    /// The parameters as they were when the link was opened.
    checked: Checked,
    /// The count from which the control seeks a switch.
    sought_from: PerAxis<Pulses>,
    /// The board has just found its switches.
    homed: bool,
    /// The board is being stopped; where it comes to stand the control goes on from.
    flushing: bool,
    /// The board cuts a pass by itself.
    pass: Option<Pass>,
    waiting: Option<pass::Waiting>,
    /// The board stops the axes by itself; whether at a switch that was waited for.
    halting: Option<bool>,
    resetting: bool,
    emergency: bool,
    powered: bool,
    /// RESET was pressed while the board was lost.
    reopen: bool,
    /// The board is being asked who it is and how it is set.
    opening: bool,
    /// It stands as long as its cause, whatever RESET does.
    standing: Option<Alarm>,
    /// Alarms that do not say yet where the slides stand.
    untold: Vec<Alarm>,
    /// The reference was dropped where the axes can be moved on.
    fell: bool,
    /// Why motion came late, when it is not sure yet that the board is there.
    late: Option<String>,
    /// See [`Stamp`].
    stops: u64,
    /// Way the spindle turns as it was last switched, 1 or -1, and the index it last
    /// passed, turns.
    spindle_way: f64,
    spindle_index: f64,
    spindle_view: Option<SpindleView>,
    /// Spindle and coolant were on when the board was lost, or before it was there: they
    /// stay off until they have been switched off.
    withheld: bool,
    /// Somebody wants to know whether the counts agree; the board has been asked.
    checking: bool,
    /// A count that agreed at a standstill and has not been noted yet.
    agreed: Option<PerAxis<Pulses>>,
    /// The program that ended and whose end has not been checked yet.
    ended: Option<ProgramId>,
    notes: Vec<Note>,
}

impl Linked {
    /// Opens the link of a control: its slides are real from now on, and nobody knows
    /// where they stand.
    pub fn open(config: LinkConfig, simulation: &mut Simulation, now: HostTime) -> Self {
        let checked = Checked::new(simulation.cnc.parameters(), config.protocol);
        let link = Link::open(config.clone(), simulation.cnc.parameters(), now);
        simulation.lathe.set_real_slides(true);
        simulation.cnc.drop_reference();
        let mut linked = Self {
            link,
            config,
            now,
            run: RunTime::ZERO,
            ticks: simulation.cnc.ticks(),
            pulses: simulation.cnc.pulses(),
            last_motion: RunTime::ZERO,
            moved: false,
            pace: pace::Pace::default(),
            checked,
            sought_from: PerAxis::default(),
            homed: false,
            flushing: false,
            pass: None,
            waiting: None,
            halting: None,
            resetting: false,
            emergency: false,
            powered: true,
            reopen: false,
            opening: true,
            standing: None,
            untold: Vec::new(),
            fell: false,
            late: None,
            stops: 0,
            spindle_way: 1.0,
            spindle_index: 0.0,
            spindle_view: None,
            withheld: true,
            checking: false,
            agreed: None,
            ended: None,
            notes: Vec::new(),
        };
        linked.show_board(simulation);
        linked
    }

    /// What boards met before said they understand; to be told before the first
    /// [`pump`](Self::pump).
    pub fn know(&mut self, dictionaries: Vec<Vec<u8>>) {
        self.link.know(dictionaries);
    }

    /// The link is over; the slides are simulated again. The last bytes for the board
    /// stop it.
    pub fn close(mut self, simulation: &mut Simulation) -> Vec<u8> {
        self.link.close();
        simulation.cnc.halt_for_board();
        simulation.cnc.drop_reference();
        simulation.cnc.board = None;
        simulation.lathe.set_real_slides(false);
        self.link.tx().to_vec()
    }

    /// Bytes came from the port, time passed. To be called at least every 5 ms, and
    /// before [`may_tick`](Self::may_tick) is asked.
    pub fn pump(&mut self, simulation: &mut Simulation, bytes: &[u8], now: HostTime) {
        let gap = now.saturating_sub(self.now);
        self.now = self.now.max(now);
        self.pace.passes(gap);
        let starved = self.has_starved(simulation, gap);
        self.link.rx(bytes, self.now);
        self.link.tick(self.now);
        for event in self.link.events() {
            self.hear(simulation, event);
        }
        if starved {
            self.samples_late(simulation);
        }
        self.show_pass(simulation);
        self.stand_where_counted(simulation);
        self.tell_late(simulation);
        self.tell_place(simulation);
        self.settle(simulation);
    }

    /// The port failed.
    pub fn lost(&mut self, simulation: &mut Simulation, cause: &str) {
        self.link.lost(cause);
        for event in self.link.events() {
            self.hear(simulation, event);
        }
        self.stand_where_counted(simulation);
        self.tell_place(simulation);
    }

    /// Bytes to be written to the port.
    pub fn tx(&self) -> &[u8] {
        self.link.tx()
    }

    /// So many of them were written.
    pub fn consumed(&mut self, count: usize) {
        self.link.consumed(count);
    }

    /// One tick of a simulation that stands by itself, without a panel.
    pub fn tick(&mut self, simulation: &mut Simulation) {
        self.before(simulation);
        simulation.tick();
        self.after(simulation);
    }

    /// To be called before each tick of the simulation.
    pub fn before(&mut self, simulation: &mut Simulation) {
        self.show_board(simulation);
    }

    /// To be called after each tick of the simulation.
    pub fn after(&mut self, simulation: &mut Simulation) {
        self.run += Duration::from_millis(1);
        let ticks = simulation.cnc.ticks();
        if ticks <= self.ticks {
            self.without_power(simulation, ticks == self.ticks);
        } else {
            self.powered = true;
            self.hand_over(simulation);
            self.follow(simulation);
            self.offer_pass(simulation);
        }
        self.ticks = ticks;
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
        for (contact, _) in contacts::wired(&self.config.inputs) {
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
        let contacts = contacts::wired(&self.config.inputs).map(|(input, _)| input);
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
    fn without_power(&mut self, simulation: &mut Simulation, off: bool) {
        if self.powered || !off {
            self.powered = !off;
            self.flushing = false;
            self.pass = None;
            self.halting = None;
            self.link.forget_position();
            self.link.set_outputs(BoardOutputs::default());
            simulation.cnc.drop_reference();
            self.pulses = simulation.cnc.pulses();
            self.moved = false;
        }
    }

    /// The motion of the tick goes to the board.
    fn hand_over(&mut self, simulation: &mut Simulation) {
        let pulses = simulation.cnc.pulses();
        if self.pass.is_some() {
            // The board goes ahead; the control only follows.
            self.pulses = pulses;
            self.moved = false;
            return;
        }
        self.moved = pulses != self.pulses;
        if !self.moved && !self.link.is_prepared() {
            return;
        }
        if self.moved && self.link.state() != LinkState::Moving && self.is_outgrown(simulation) {
            simulation.cnc.stand_at(self.pulses);
            self.moved = false;
            return;
        }
        let waits = simulation.cnc.waits_for_spindle();
        let follows = simulation.cnc.lead_followed().is_some();
        self.link.keep_time(waits || follows);
        let fine = simulation.cnc.axes.fine();
        let parts = |place: f64| (place * FINE as f64).round() as i64;
        let sample = Sample {
            end: self.run,
            pulses,
            fine: PerAxis::new(parts(fine.x), parts(fine.z)),
        };
        match self.link.push(sample) {
            Ok(()) => self.pulses = pulses,
            Err(refused) => return self.refuse(simulation, refused),
        }
        if self.moved {
            self.last_motion = self.run;
        } else if !waits
            && !simulation.cnc.is_moving()
            && let Err(refused) = self.link.finish()
        {
            self.refuse(simulation, refused);
        }
    }

    /// Motion that the board does not take is not made: the control goes back to
    /// where the slides are.
    fn refuse(&mut self, simulation: &mut Simulation, refused: Refused) {
        let (number, text) = match refused {
            Refused::TooFast => (
                604,
                "an axis would need more pulses a second than the board makes",
            ),
            Refused::TowardLimit(Axis::X) => (621, "that way lies the limit switch"),
            Refused::TowardLimit(Axis::Z) => (622, "that way lies the limit switch"),
            Refused::UponLimit(Axis::X) => (621, UPON_LIMIT),
            Refused::UponLimit(Axis::Z) => (622, UPON_LIMIT),
            Refused::NotReady | Refused::NotWired => {
                (608, "motion was made that the board does not take")
            }
        };
        self.raise(simulation, Alarm::new(number).because(text));
        simulation.cnc.halt_for_board();
        self.moved = false;
        simulation.cnc.stand_at(self.pulses);
        if self.link.state() == LinkState::Moving {
            // Where that is, the board tells when it stands.
            self.link.stop(Stop::Flush);
            self.flushing = true;
        }
    }

    /// Whether the parameters are not those any more that the board was checked
    /// against: nothing begins to move.
    fn is_outgrown(&self, simulation: &mut Simulation) -> bool {
        let outgrown = self.checked.alarm(simulation.cnc.parameters());
        let is_outgrown = outgrown.is_some();
        if let Some(alarm) = outgrown {
            simulation.cnc.raise(alarm);
            simulation.cnc.halt_for_board();
        }
        is_outgrown
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
        core::mem::take(&mut self.notes)
    }

    /// Whether the operator wants the lost board back: the port is to be opened anew.
    pub const fn is_to_be_reopened(&self) -> bool {
        self.reopen
    }

    /// Compares the counts, when the slides stand.
    pub fn check(&mut self) {
        if self.link.state() == LinkState::Ready && !self.is_behind() {
            self.checking = self.link.compare();
            if !self.checking {
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
    pub const fn knows_position(&self) -> bool {
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
        self.spindle_view
    }

    /// Where the link stands.
    pub const fn state(&self) -> LinkState {
        self.link.state()
    }

    /// Whether the board is still being asked who it is and how it is set.
    pub const fn is_opening(&self) -> bool {
        self.opening
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
    pub const fn board(&self) -> &BoardInfo {
        self.link.board()
    }

    /// Switches at the board that are operated.
    pub fn pins(&self) -> Pins {
        self.link.pins()
    }

    /// Figures of the wire.
    pub const fn traffic(&self) -> Traffic {
        self.link.traffic()
    }

    /// Motion handed over that may not have been made yet.
    pub fn outstanding(&self) -> Duration {
        self.link.outstanding()
    }

    /// Pulses commanded so far.
    pub const fn commanded(&self) -> PerAxis<Pulses> {
        self.pulses
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
