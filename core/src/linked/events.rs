//! What the control hears of the board, and the board of the control.

use gsk_plc::address::{Area, BitAddress};

use super::stopping::Stopping;
use super::{Linked, Note};
use crate::alarm::{Alarm, groups, number};
use crate::cnc::Event as Happened;
use crate::machine::pins;
use crate::operation::{BoardDrives, RunState, ZeroWiring};
use crate::simulation::Simulation;
use crate::units::{Axis, PerAxis, Pulses};
use gsk_link::{
    Awaited, BoardOutputs, Event, Input, LinkState, Output, Protocol, SpindleDirection, Stop,
    Uncertainty,
};

impl Linked {
    /// What the control knows of its drives in the next tick.
    pub(super) fn update_drives(&mut self, simulation: &mut Simulation) {
        let wanted = outputs(simulation);
        let timed = self.link.times_outputs();
        let switching = match self.link.switched() {
            _ if timed => false,
            None => true,
            Some(switched) if self.is_behind() => {
                // Another speed waits for the next standstill, a spindle that stands
                // or coolant that is missing does not.
                (switched.spindle, switched.coolant) != (wanted.spindle, wanted.coolant)
            }
            Some(switched) => switched != wanted,
        };
        let spindle = self.read_spindle(simulation, wanted.spindle);
        let stopping = !self.stopping.is_none();
        let armed = |axis| {
            let awaited = self.link.awaited(axis);
            awaited.is_some()
                && awaited == simulation.cnc.board_awaits(axis)
                && self.link.is_armed(axis)
        };
        let armed = PerAxis::new(armed(Axis::X), armed(Axis::Z));
        simulation.cnc.drives.board = Some(BoardDrives {
            takes_motion: self.link.takes_motion() && !stopping,
            prepared: self.link.is_prepared() && !stopping,
            known: self.link.knows_position(),
            behind: self.is_behind(),
            ahead: self.ticks_ahead(),
            stops: self.motion.stops,
            switching,
            timed,
            surface: timed && !self.config.io.spindle_pwm.is_empty(),
            rates: self.link.rates(),
            pulses_per_mm: self.link.pulses_per_mm(),
            threads: self.link.threads(),
            spindle,
            pass_speed: f64::from(self.config.flush_keep_speed),
            alone: self.link.homes_alone(),
            zero: (!self.link.homes())
                .then(|| PerAxis::new(self.zero_wiring(Axis::X), self.zero_wiring(Axis::Z))),
            armed,
            checked: Some(self.checked),
        });
    }

    /// What an axis has at the board to return to.
    fn zero_wiring(&self, axis: Axis) -> ZeroWiring {
        let (wires, at) = match axis {
            Axis::X => (&self.config.x, self.config.x.home_at / 2.0),
            Axis::Z => (&self.config.z, self.config.z.home_at),
        };
        let pins = self.link.pins();
        ZeroWiring {
            switch: !wires.dec.is_empty(),
            signal: !wires.zero.is_empty(),
            limit: !wires.limit.is_empty(),
            on_limit: match axis {
                Axis::X => pins.x,
                Axis::Z => pins.z,
            },
            off: f64::from(self.config.line.home.pull_off_um) / 1000.0,
            at,
        }
    }

    /// The board looks at what the returns of the control wait for.
    fn await_switches(&mut self, simulation: &mut Simulation) {
        for axis in [Axis::X, Axis::Z] {
            let wanted = simulation.cnc.board_awaits(axis);
            if wanted == self.link.awaited(axis) {
                if let Some(awaited) = wanted {
                    self.check_length(simulation, axis, awaited);
                }
                continue;
            }
            *self.returns.sought_from.get_mut(axis) = *simulation.cnc.pulses().get(axis);
            match wanted {
                // Not yet possible: once more with the next look.
                Some(awaited) => drop(self.link.arm(awaited)),
                None => self.link.disarm(axis),
            }
        }
    }

    /// A switch that does not come within the length of the slide will never come.
    fn check_length(&self, simulation: &mut Simulation, axis: Axis, awaited: Awaited) {
        let lathe = simulation.lathe.config();
        let (limits, scale, name) = match axis {
            Axis::X => (lathe.x.limits, 2.0, 'x'),
            Axis::Z => (lathe.z.limits, 1.0, 'z'),
        };
        let Some(limits) = limits else { return };
        let length = limits.plus - limits.minus;
        let most = length / scale * self.link.pulses_per_mm()[axis as usize];
        let way = simulation.cnc.pulses().get(axis).0 - self.returns.sought_from.get(axis).0;
        if way.unsigned_abs() as f64 <= most {
            return;
        }
        let pin = match awaited.input {
            Input::DecelerationX | Input::DecelerationZ => "dec",
            Input::ZeroX | Input::ZeroZ => "zero",
            _ => "limit",
        };
        simulation.cnc.abandon_returns();
        simulation
            .cnc
            .raise(Alarm::new(number::BOARD_ZERO_RETURN).because(format!(
            "link.{name}.{pin} did not change within {length} mm, the whole length of {name}.limits"
        )));
    }

    /// Keys, outputs and the ends of programs go to the link.
    pub(super) fn follow(&mut self, simulation: &mut Simulation) {
        let dropped = self.has_dropped_outputs();
        if dropped {
            simulation.cnc.drop_outputs(self.switched_outputs());
        }
        let mut wanted = outputs(simulation);
        self.connection.withheld &=
            dropped || wanted.spindle != SpindleDirection::Stop || wanted.coolant;
        if self.connection.withheld {
            wanted = BoardOutputs::default();
        }
        self.link.set_outputs(wanted);
        let cnc = &mut simulation.cnc;
        for event in cnc.events() {
            if let Happened::ProgramEnded { .. } = event {
                self.log.ended = cnc.cursor().program;
            }
        }
        let emergency = core::mem::replace(&mut self.keys.emergency, cnc.emergency_stop);
        let resetting = core::mem::replace(&mut self.keys.resetting, cnc.resetting());
        if self.keys.emergency && !emergency {
            cnc.halt_for_board();
            self.stopping.end_flush();
            self.thread.pass = None;
            self.link.stop(Stop::Kill);
        } else if self.keys.resetting && !resetting {
            cnc.halt_for_board();
            // A pass is stopped dead: there is no place to go on from.
            let passing = self.thread.pass.take().is_some();
            if self.link.state() == LinkState::Moving && !passing {
                self.stopping.flush();
            }
            self.connection.reopen |= self.link.state() == LinkState::Lost;
            self.link.reset();
        }
        if let Some(alarm) = &self.alarms.standing
            && !self.keys.resetting
        {
            cnc.raise(alarm.clone());
        }
    }

    /// Whether spindle and coolant at the board are off whatever the control wants: it
    /// failed, and was reset or told so. A line board that is not heard goes on with them.
    fn has_dropped_outputs(&self) -> bool {
        self.connection.withheld
            && match self.link.state() {
                LinkState::Fault | LinkState::Tripped => true,
                LinkState::Lost => self.config.protocol == Protocol::StepQueue,
                _ => false,
            }
    }

    /// The contacts of the control that the board switches.
    fn switched_outputs(&self) -> impl Iterator<Item = BitAddress> {
        let missing = self.missing_outputs();
        let outputs = [
            (Output::SpindleForward, pins::FORWARD),
            (Output::SpindleReverse, pins::REVERSE),
            (Output::Coolant, pins::COOLANT),
        ];
        let switched = outputs
            .into_iter()
            .filter(move |(output, _)| !missing.contains(output));
        switched.map(|(_, (byte, bit))| BitAddress::new(Area::Y, u16::from(byte), bit))
    }

    /// The link has something to say.
    pub(super) fn hear(&mut self, simulation: &mut Simulation, event: Event) {
        let cnc = &mut simulation.cnc;
        match event {
            Event::State(state) => self.change(simulation, state),
            Event::Alarm { number, detail } => {
                let alarm = Alarm::new(number).because(detail);
                if number == number::POSITION_CHECK {
                    self.checked(false, None);
                }
                if groups::OF_OPENING.contains(&number) {
                    self.alarms.standing = Some(alarm.clone());
                }
                self.raise(simulation, alarm);
                simulation.cnc.halt_for_board();
                self.stopping.end_flush();
            }
            Event::Position(pulses) => {
                let stopped = self.stopping.take();
                let reached = stopped == Stopping::Reaching;
                if !stopped.is_none() {
                    if !reached {
                        cnc.halt_for_board();
                    }
                    cnc.stand_at(pulses);
                    self.stopped_at(simulation);
                    let parameters = simulation.cnc.parameters();
                    // On the way to its zero an axis has long made up for it.
                    if !reached
                        && [Axis::X, Axis::Z].map(|axis| parameters.backlash(axis)) != [0.0; 2]
                    {
                        // Whether the play was made up for there nobody knows.
                        self.link.invalidate_position(Uncertainty::Play);
                        self.drop_reference(simulation);
                    }
                }
                let agreed = self.link.knows_position().then_some(pulses);
                if core::mem::take(&mut self.log.checking) {
                    if agreed.is_some() {
                        self.checked(true, agreed);
                    }
                } else {
                    self.log.agreed = agreed;
                }
            }
            Event::Halting { reached } => {
                if self.stopping.halt(reached) {
                    cnc.pause_for_board();
                } else {
                    cnc.halt_for_board();
                }
            }
            Event::Reached(input, _) => {
                if let Some(axis) = input.axis() {
                    cnc.board_reached(axis);
                }
            }
            Event::Drained => self.end_pass(simulation),
            Event::Homed(axes) => {
                self.returns.homed = true;
                cnc.board_returned(axes, self.home());
            }
            Event::Learned { name, packed } => self.log.notes.push(Note::Learned { name, packed }),
            Event::Differs(difference) => self.log.notes.push(Note::Differs(difference)),
        }
    }

    fn change(&mut self, simulation: &mut Simulation, state: LinkState) {
        let unknown = matches!(
            state,
            LinkState::Locked | LinkState::Tripped | LinkState::Fault | LinkState::Lost
        );
        let found = core::mem::take(&mut self.returns.homed) && state == LinkState::Locked;
        // A return that moves both axes leaves none where it was, however it ends.
        let moves_all = state == LinkState::Homing && !self.link.homes_alone();
        if moves_all {
            simulation.cnc.drop_reference();
        } else if unknown && !found && !self.link.keeps_count() {
            self.drop_reference(simulation);
        }
        if unknown && state != LinkState::Locked {
            simulation.cnc.halt_for_board();
            self.stopping = Stopping::None;
            self.connection.withheld = true;
        }
        if unknown {
            self.thread.pass = None;
        }
        let was_opening = self.is_opening();
        self.connection.state = state;
        if state == LinkState::Opening {
            // Whether its cause is gone is asked now.
            self.alarms.standing = None;
        }
        if state == LinkState::Locked {
            self.alarms.standing = None;
            if was_opening {
                // Nothing begins by itself: a key that is held, a return that was asked for.
                simulation.cnc.halt_for_board();
                // The board is there, is the right one and is set as it must be.
                for number in groups::OF_OPENING {
                    simulation.cnc.alarms.remove(number);
                }
            }
        }
    }

    fn drop_reference(&mut self, simulation: &mut Simulation) {
        let referenced = simulation.cnc.referenced();
        self.alarms.fell |= referenced.x || referenced.z;
        simulation.cnc.drop_reference();
    }

    pub(super) fn checked(&mut self, agrees: bool, counted: Option<PerAxis<Pulses>>) {
        self.log.notes.push(Note::Checked {
            program: self.log.ended.take(),
            commanded: self.motion.pulses,
            counted: counted.or_else(|| self.link.counted()),
            agrees,
        });
    }

    /// What the operator has asked for and the board can do now.
    pub(super) fn settle(&mut self, simulation: &mut Simulation) {
        let returning = simulation.cnc.board_returns();
        if (returning.x || returning.z) && self.is_outgrown(simulation) {
            return;
        }
        let cnc = &mut simulation.cnc;
        match self.link.state() {
            LinkState::Homing if !(returning.x || returning.z) => self.link.reset(),
            LinkState::Locked | LinkState::Ready if returning.x || returning.z => {
                // Not yet possible: once more with the next report.
                let _ = self.link.home(returning);
            }
            LinkState::Locked if cnc.emergency_stop || cnc.resetting() => {}
            LinkState::Locked if cnc.referenced().x && cnc.referenced().z => {
                let pulses = cnc.pulses();
                if self.link.set_position(pulses, self.clock.run).is_ok() {
                    self.motion.pulses = pulses;
                }
            }
            LinkState::Locked if !self.link.takes_motion() && !cnc.has_board_alarm() => {
                let pulses = cnc.pulses();
                if self.link.release(pulses, self.clock.run).is_ok() {
                    self.motion.pulses = pulses;
                }
            }
            LinkState::Tripped if !self.link.takes_motion() => {
                let referenced = cnc.referenced();
                let quiet = !cnc.emergency_stop && !cnc.resetting();
                let pulses = cnc.pulses();
                if quiet
                    && referenced.x
                    && referenced.z
                    && self.link.retreat(pulses, self.clock.run).is_ok()
                {
                    self.motion.pulses = pulses;
                }
            }
            _ => {}
        }
        self.await_switches(simulation);
        self.note_stops(simulation.cnc.run_state());
    }

    /// A stop of a program is noted with what was counted there; its end also when
    /// nothing had moved since the last one.
    fn note_stops(&mut self, state: RunState) {
        if self.link.state() != LinkState::Ready || self.is_behind() || state == RunState::Run {
            return;
        }
        let agreed = self.log.agreed.take();
        let stopped = agreed.is_some() && matches!(state, RunState::Hold | RunState::Stop);
        if stopped || self.log.ended.is_some() {
            self.checked(true, agreed);
        }
    }
}

/// What the ladder and the spindle control want switched.
fn outputs(simulation: &Simulation) -> BoardOutputs {
    let cnc = &simulation.cnc;
    let memory = cnc.plc().memory();
    let (coolant, bit) = pins::COOLANT;
    let spindle = pins::spindle_direction(memory);
    let millivolts = match spindle {
        SpindleDirection::Stop => 0,
        _ => (cnc.spindle().volts() * 1000.0).round() as u16,
    };
    BoardOutputs {
        spindle,
        millivolts,
        coolant: memory.y(u16::from(coolant)) >> bit & 1 == 1,
    }
}
