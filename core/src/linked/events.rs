//! What the control hears of the board, and the board of the control.

use gsk_plc::address::{Area, BitAddress};

use super::stopping::Stopping;
use super::{Control, Linked, Note};
use crate::alarm::{Alarm, groups, number};
use crate::board::{BoardDrives, BoardInputs, BoardReport, ZeroWiring};
use crate::machine::pins;
use crate::run_state::RunState;
use crate::units::{Axis, PerAxis, Pulses};
use gsk_link::{
    AwaitedInput, BoardOutputs, Input, LinkEvent, LinkState, Output, Protocol, SpindleDirection,
    Stop, Uncertainty,
};
use gsk_messages::say;

impl Linked {
    /// What the control hears of its board in the next tick.
    pub(super) fn inputs_of_tick(&mut self) -> BoardInputs {
        let (reports, settled) = self.reports.take();
        let stands = |report: &&BoardReport| matches!(report, BoardReport::StandsAt(_));
        self.motion.stops += reports.iter().filter(stands).count() as u64;
        BoardInputs {
            drives: self.drives(),
            reports,
            dropped: self.dropped_outputs(),
            pass_made: self.pass_made(),
            settled,
        }
    }

    fn drives(&mut self) -> BoardDrives {
        let wanted = self.control.orders.outputs;
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
        let spindle = self.read_spindle(wanted.spindle);
        let stopping = !self.stopping.is_none();
        let armed = |axis| {
            let awaited = self.link.awaited(axis);
            awaited.filter(|_| self.link.is_armed(axis))
        };
        let armed = PerAxis::new(armed(Axis::X), armed(Axis::Z));
        BoardDrives {
            takes_motion: self.link.takes_motion() && !stopping,
            prepared: self.link.is_prepared() && !stopping,
            moving: self.link.state() == LinkState::Moving,
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
        }
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
    fn await_switches(&mut self) {
        for axis in [Axis::X, Axis::Z] {
            let wanted = *self.control.orders.returns.awaited.get(axis);
            if wanted == self.link.awaited(axis) {
                if let Some(awaited) = wanted {
                    self.check_length(axis, awaited);
                }
                continue;
            }
            *self.returns.sought_from.get_mut(axis) = *self.control.pulses.get(axis);
            match wanted {
                // Not yet possible: once more with the next look.
                Some(awaited) => drop(self.link.arm(awaited)),
                None => self.link.disarm(axis),
            }
        }
    }

    /// A switch that does not come within the length of the slide will never come.
    fn check_length(&mut self, axis: Axis, awaited: AwaitedInput) {
        let (scale, name) = match axis {
            Axis::X => (2.0, 'x'),
            Axis::Z => (1.0, 'z'),
        };
        let Some(length) = *self.returns.lengths.get(axis) else {
            return;
        };
        let most = length / scale * self.link.pulses_per_mm()[axis as usize];
        let gone = self.control.pulses.get(axis).0 - self.returns.sought_from.get(axis).0;
        if gone.unsigned_abs() as f64 <= most {
            return;
        }
        let pin = match awaited.input {
            Input::DecelerationX | Input::DecelerationZ => "dec",
            Input::ZeroX | Input::ZeroZ => "zero",
            _ => "limit",
        };
        self.report(BoardReport::ReturnsAbandoned);
        let alarm = Alarm::new(number::BOARD_ZERO_RETURN)
            .because(say::zero_switch_never_met(name, pin, length));
        self.report(BoardReport::Failed(alarm));
    }

    /// Keys, outputs and the ends of programs go to the link.
    pub(super) fn follow(&mut self) {
        let dropped = self.has_dropped_outputs();
        let orders = self.control.orders;
        let mut wanted = orders.outputs;
        self.connection.withheld &=
            dropped || wanted.spindle != SpindleDirection::Stop || wanted.coolant;
        if self.connection.withheld {
            wanted = BoardOutputs::default();
        }
        self.link.set_outputs(wanted);
        if orders.run.ended.is_some() {
            self.log.ended = orders.run.ended;
        }
        let emergency = core::mem::replace(&mut self.keys.emergency, orders.emergency_stop);
        let resetting = core::mem::replace(&mut self.keys.resetting, orders.resetting);
        if self.keys.emergency && !emergency {
            self.report(BoardReport::Halted);
            self.stopping.end_flush();
            self.thread.pass = None;
            self.link.stop(Stop::Kill);
        } else if self.keys.resetting && !resetting {
            self.report(BoardReport::Halted);
            // A pass is stopped dead: there is no place to go on from.
            let passing = self.thread.pass.take().is_some();
            if self.link.state() == LinkState::Moving && !passing {
                self.stopping.flush();
            }
            self.connection.reopen |= self.link.state() == LinkState::Lost;
            self.link.reset();
        }
    }

    /// Whether spindle and coolant at the board are off whatever the control wants: it
    /// failed, and was reset or told so. A line board that is not heard goes on with them,
    /// unless the holder of the port has stopped it.
    fn has_dropped_outputs(&self) -> bool {
        self.connection.withheld
            && match self.link.state() {
                LinkState::Fault | LinkState::Tripped => true,
                LinkState::Lost => {
                    self.connection.stopped || self.config.protocol == Protocol::StepQueue
                }
                _ => false,
            }
    }

    /// The outputs of the ladder that the board switches and has dropped.
    fn dropped_outputs(&self) -> Vec<BitAddress> {
        if !self.has_dropped_outputs() {
            return Vec::new();
        }
        let missing = self.missing_outputs();
        let outputs = [
            (Output::SpindleForward, pins::FORWARD),
            (Output::SpindleReverse, pins::REVERSE),
            (Output::Coolant, pins::COOLANT),
        ];
        let switched = outputs
            .into_iter()
            .filter(|(output, _)| !missing.contains(output));
        switched
            .map(|(_, (byte, bit))| BitAddress::new(Area::Y, u16::from(byte), bit))
            .collect()
    }

    /// The link has something to say.
    pub(super) fn hear(&mut self, event: LinkEvent) {
        match event {
            LinkEvent::State(state) => self.change(state),
            LinkEvent::Alarm { number, detail } => {
                let alarm = Alarm::new(number).because(detail);
                if number == number::POSITION_CHECK {
                    self.checked(false, None);
                }
                if groups::OF_OPENING.contains(&number) {
                    self.report(BoardReport::Standing(alarm.clone()));
                }
                self.raise(alarm);
                self.report(BoardReport::Halted);
                self.stopping.end_flush();
            }
            LinkEvent::Position(pulses) => {
                let stopped = self.stopping.take();
                let reached = stopped == Stopping::Reaching;
                if !stopped.is_none() {
                    if !reached {
                        self.report(BoardReport::Halted);
                    }
                    self.stopped_at(pulses);
                    // On the way to its zero an axis has long made up for it.
                    if !reached && self.control.orders.backlash {
                        // Whether the play was made up for there nobody knows.
                        self.link.invalidate_position(Uncertainty::Play);
                        self.report(BoardReport::ReferenceLost { told: true });
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
            LinkEvent::Halting { reached } => {
                let pauses = self.stopping.halt(reached);
                self.report(if pauses {
                    BoardReport::Paused
                } else {
                    BoardReport::Halted
                });
            }
            LinkEvent::Reached(input, _) => {
                if let Some(axis) = input.axis() {
                    self.report(BoardReport::Reached(axis));
                }
            }
            LinkEvent::Drained => self.end_pass(),
            LinkEvent::Homed(axes) => {
                self.returns.homed = true;
                let at = self.home();
                self.report(BoardReport::Returned { axes, at });
            }
            LinkEvent::Learned { name, packed } => {
                self.log.notes.push(Note::Learned { name, packed });
            }
            LinkEvent::Differs(difference) => self.log.notes.push(Note::Differs(difference)),
        }
    }

    fn change(&mut self, state: LinkState) {
        let unknown = matches!(
            state,
            LinkState::Locked | LinkState::Tripped | LinkState::Fault | LinkState::Lost
        );
        let found = core::mem::take(&mut self.returns.homed) && state == LinkState::Locked;
        // A return that moves both axes leaves none where it was, however it ends.
        let moves_all = state == LinkState::Homing && !self.link.homes_alone();
        if moves_all {
            self.report(BoardReport::ReferenceLost { told: false });
        } else if unknown && !found && !self.link.keeps_count() {
            self.report(BoardReport::ReferenceLost { told: true });
        }
        if unknown && state != LinkState::Locked {
            self.report(BoardReport::Halted);
            self.stopping = Stopping::None;
            self.connection.withheld = true;
        }
        if unknown {
            self.thread.pass = None;
        }
        let was_opening = self.is_opening();
        self.connection.state = state;
        if matches!(state, LinkState::Opening | LinkState::Locked) {
            self.report(BoardReport::CauseGone);
        }
        if state == LinkState::Locked && was_opening {
            self.report(BoardReport::Opened);
        }
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
    pub(super) fn settle(&mut self) {
        if !self.reports.are_heard() {
            // What the control wants now it says after its next tick.
            return;
        }
        let Control { pulses, orders } = self.control;
        let returning = orders.returns.by_board;
        let referenced = orders.returns.referenced.x && orders.returns.referenced.z;
        let quiet = !orders.emergency_stop && !orders.resetting;
        let at = self.clock.run;
        let goes_on = match self.link.state() {
            LinkState::Homing if !(returning.x || returning.z) => {
                self.link.reset();
                false
            }
            LinkState::Locked | LinkState::Ready if returning.x || returning.z => {
                // Not yet possible: once more with the next report.
                let _ = self.link.home(returning);
                false
            }
            LinkState::Locked if quiet && referenced => self.link.set_position(pulses, at).is_ok(),
            LinkState::Locked if quiet && !self.link.takes_motion() && !orders.board_alarm => {
                self.link.release(pulses, at).is_ok()
            }
            LinkState::Tripped if quiet && !self.link.takes_motion() && referenced => {
                self.link.retreat(pulses, at).is_ok()
            }
            _ => false,
        };
        if goes_on {
            self.motion.pulses = pulses;
        }
        self.await_switches();
        self.note_stops(orders.run.state);
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
