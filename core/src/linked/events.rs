//! Events from the board to the control, and orders from the control to the board.

use gsk_plc::address::{Area, BitAddress};

use super::stopping::StopInProgress;
use super::{ControlSnapshot, LinkNote, LinkedControl};
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

impl LinkedControl {
    /// Collects the board's inputs for the control's next tick.
    pub(super) fn inputs_of_tick(&mut self) -> BoardInputs {
        let (reports, settled) = self.reports.take_for_tick();
        let is_stop = |report: &&BoardReport| matches!(report, BoardReport::StoppedAt(_));
        self.motion.resync_count += reports.iter().filter(is_stop).count() as u64;
        BoardInputs {
            drives: self.board_drives(),
            reports,
            dropped: self.dropped_outputs(),
            pass_fraction: self.pass_fraction(),
            tap_depth_mm: self.tap_depth_mm(),
            standstill: settled,
        }
    }

    fn board_drives(&mut self) -> BoardDrives {
        let wanted = self.control.orders.outputs;
        let timed = self.link.times_outputs();
        let switching = match self.link.switched() {
            _ if timed => false,
            None => true,
            Some(switched) if self.has_pending_motion() => {
                // A change of speed waits for the next standstill. A spindle or coolant
                // that must still be switched on does not.
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
            is_prepared: self.link.is_prepared() && !stopping,
            is_moving: self.link.state() == LinkState::Moving,
            position_known: self.link.knows_position(),
            has_pending_motion: self.has_pending_motion(),
            ticks_ahead: self.ticks_ahead(),
            resync_count: self.motion.resync_count,
            outputs_switching: switching,
            has_timed_outputs: timed,
            speed_follows_motion: timed && !self.config.io.spindle_pwm.is_empty(),
            rates: self.link.rates(),
            pulses_per_mm: self.link.pulses_per_mm(),
            threads: self.link.threads(),
            taps: self.link.taps(),
            spindle,
            pass_speed_mm_per_min: f64::from(self.config.flush_keep_speed),
            homes_axes_separately: self.link.homes_alone(),
            zero_wiring: (!self.link.homes())
                .then(|| PerAxis::new(self.zero_wiring(Axis::X), self.zero_wiring(Axis::Z))),
            armed_inputs: armed,
            checked_parameters: Some(self.checked),
        }
    }

    /// Returns which switches of an axis are wired to the board, and their data for a reference
    /// return.
    fn zero_wiring(&self, axis: Axis) -> ZeroWiring {
        let (wires, at) = match axis {
            Axis::X => (&self.config.x, self.config.x.home_at / 2.0),
            Axis::Z => (&self.config.z, self.config.z.home_at),
        };
        let pins = self.link.pins();
        ZeroWiring {
            has_deceleration_switch: !wires.dec.is_empty(),
            has_zero_signal: !wires.zero.is_empty(),
            has_limit_switch: !wires.limit.is_empty(),
            is_on_limit: match axis {
                Axis::X => pins.x,
                Axis::Z => pins.z,
            },
            pull_off_mm: f64::from(self.config.line.home.pull_off_um) / 1000.0,
            home_mm: at,
        }
    }

    /// Arms the board to stop at the switches that the control's returns wait for.
    fn arm_switches(&mut self) {
        for axis in [Axis::X, Axis::Z] {
            let wanted = *self.control.orders.returns.awaited.get(axis);
            if wanted == self.link.awaited(axis) {
                if let Some(awaited) = wanted {
                    self.check_search_length(axis, awaited);
                }
                continue;
            }
            *self.returns.search_start.get_mut(axis) = *self.control.pulses.get(axis);
            match wanted {
                // Not possible yet: the next call tries again.
                Some(awaited) => drop(self.link.arm(awaited)),
                None => self.link.disarm(axis),
            }
        }
    }

    /// Abandons a return that has travelled the whole slide without reaching its switch.
    fn check_search_length(&mut self, axis: Axis, awaited: AwaitedInput) {
        let (scale, name) = match axis {
            Axis::X => (2.0, 'x'),
            Axis::Z => (1.0, 'z'),
        };
        let Some(length) = *self.returns.travel_mm.get(axis) else {
            return;
        };
        let max_pulses = length / scale * self.link.pulses_per_mm()[axis as usize];
        let travelled = self.control.pulses.get(axis).0 - self.returns.search_start.get(axis).0;
        if travelled.unsigned_abs() as f64 <= max_pulses {
            return;
        }
        let pin = match awaited.input {
            Input::DecelerationX | Input::DecelerationZ => "dec",
            Input::ZeroX | Input::ZeroZ => "zero",
            _ => "limit",
        };
        self.report(BoardReport::ReturnsAbandoned);
        let alarm = Alarm::new(number::BOARD_ZERO_RETURN)
            .with_detail(say::zero_switch_never_met(name, pin, length));
        self.report(BoardReport::PositionlessFault(alarm));
    }

    /// Passes RESET, emergency stop, outputs and the ends of programs to the link.
    pub(super) fn apply_orders(&mut self) {
        let dropped = self.has_dropped_outputs();
        let orders = self.control.orders;
        let mut wanted = orders.outputs;
        self.connection.outputs_withheld &=
            dropped || wanted.spindle != SpindleDirection::Stop || wanted.coolant;
        if self.connection.outputs_withheld {
            wanted = BoardOutputs::default();
        }
        self.link.set_outputs(wanted);
        if orders.run.ended.is_some() {
            self.log.ended_program = orders.run.ended;
        }
        let emergency = core::mem::replace(&mut self.keys.emergency, orders.is_emergency_stop);
        let resetting = core::mem::replace(&mut self.keys.resetting, orders.is_resetting);
        if self.keys.emergency && !emergency {
            self.report(BoardReport::MotionEnded);
            self.stopping.end_flush();
            self.thread.pass = None;
            self.thread.tap = None;
            self.link.stop(Stop::Kill);
        } else if self.keys.resetting && !resetting {
            self.report(BoardReport::MotionEnded);
            // A pass ends with a dead stop: there is no position to continue from.
            let passing = self.thread.pass.take().is_some();
            self.thread.tap = None;
            if self.link.state() == LinkState::Moving && !passing {
                self.stopping.flush();
            }
            self.connection.reopen_requested |= self.link.state() == LinkState::Lost;
            self.link.reset();
        }
    }

    /// Whether spindle and coolant at the board are off although the control commands them:
    /// the board failed and was reset or stopped. A line board that does not answer keeps
    /// them on, unless the guard process has stopped it.
    fn has_dropped_outputs(&self) -> bool {
        self.connection.outputs_withheld
            && match self.link.state() {
                LinkState::Fault | LinkState::Tripped => true,
                LinkState::Lost => {
                    self.connection.guard_stopped || self.config.protocol == Protocol::StepQueue
                }
                _ => false,
            }
    }

    /// Outputs of the ladder that the board drives and has switched off.
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

    /// Handles one event of the link to the board.
    pub(super) fn handle_event(&mut self, event: LinkEvent) {
        match event {
            LinkEvent::State(state) => self.enter_state(state),
            LinkEvent::Alarm { number, detail } => {
                let alarm = Alarm::new(number).with_detail(detail);
                if number == number::POSITION_CHECK {
                    self.log_count_check(false, None);
                }
                if groups::CONNECTION_ALARMS.contains(&number) {
                    self.report(BoardReport::PersistentAlarm(alarm.clone()));
                }
                self.raise(alarm);
                self.report(BoardReport::MotionEnded);
                self.stopping.end_flush();
            }
            LinkEvent::Position(pulses) => {
                let stopped = self.stopping.take();
                let reached = stopped == StopInProgress::AtSwitch;
                if !stopped.is_none() {
                    if !reached {
                        self.report(BoardReport::MotionEnded);
                    }
                    self.adopt_stop(pulses);
                    // A reference return took up the backlash long before.
                    if !reached && self.control.orders.compensates_backlash {
                        // It is unknown whether the backlash was taken up at this position.
                        self.link.invalidate_position(Uncertainty::Play);
                        self.report(BoardReport::ReferenceLost { raise_alarm: true });
                    }
                }
                let agreed_count = self.link.knows_position().then_some(pulses);
                if core::mem::take(&mut self.log.checking) {
                    if agreed_count.is_some() {
                        self.log_count_check(true, agreed_count);
                    }
                } else {
                    self.log.agreed_count = agreed_count;
                }
            }
            LinkEvent::WheelTurned(graduations) => self.queue_wheel_turn(graduations),
            LinkEvent::Halting { reached } => {
                let stops_at_switch = self.stopping.halt(reached);
                self.report(if stops_at_switch {
                    BoardReport::StoppedAtSwitch
                } else {
                    BoardReport::MotionEnded
                });
            }
            LinkEvent::Reached(input, _) => {
                if let Some(axis) = input.axis() {
                    self.report(BoardReport::SwitchReached(axis));
                }
            }
            LinkEvent::Drained => self.end_pass(),
            LinkEvent::Homed(axes) => {
                self.returns.homed = true;
                let at = self.home_position();
                self.report(BoardReport::Homed { axes, at });
            }
            LinkEvent::Learned { name, packed } => {
                self.log.notes.push(LinkNote::DictionaryReceived {
                    name,
                    compressed: packed,
                });
            }
            LinkEvent::Differs(difference) => {
                self.log.notes.push(LinkNote::SettingDiffers(difference));
            }
        }
    }

    fn enter_state(&mut self, state: LinkState) {
        let position_unknown = matches!(
            state,
            LinkState::Locked | LinkState::Tripped | LinkState::Fault | LinkState::Lost
        );
        let homed = core::mem::take(&mut self.returns.homed) && state == LinkState::Locked;
        // A return that moves both axes leaves neither at its position, even if it fails.
        let moves_all = state == LinkState::Homing && !self.link.homes_alone();
        if moves_all {
            self.report(BoardReport::ReferenceLost { raise_alarm: false });
        } else if position_unknown && !homed && !self.link.keeps_count() {
            self.report(BoardReport::ReferenceLost { raise_alarm: true });
        }
        if position_unknown && state != LinkState::Locked {
            // The alarm with the reason follows, up to a second later. Until then the program must not
            // continue: an M30 after the limited move would end it well.
            self.report(BoardReport::RunStopped);
            self.stopping = StopInProgress::None;
            self.connection.outputs_withheld = true;
        }
        if position_unknown {
            self.thread.pass = None;
            self.thread.tap = None;
        }
        let was_opening = self.is_opening();
        self.connection.state = state;
        if matches!(state, LinkState::Opening | LinkState::Locked) {
            self.report(BoardReport::CauseRecheck);
        }
        if state == LinkState::Locked && was_opening {
            self.report(BoardReport::BoardReady);
        }
    }

    pub(super) fn log_count_check(&mut self, agrees: bool, counted: Option<PerAxis<Pulses>>) {
        self.log.notes.push(LinkNote::CountChecked {
            program: self.log.ended_program.take(),
            commanded: self.motion.pulses,
            counted: counted.or_else(|| self.link.counted()),
            agrees,
        });
    }

    /// Passes requests of the control (homing, position, release) to the link, if the board
    /// can execute them now.
    pub(super) fn issue_requests(&mut self) {
        if !self.reports.are_delivered() {
            // The control's orders follow after its next tick.
            return;
        }
        let ControlSnapshot { pulses, orders } = self.control;
        let returning = orders.returns.by_board;
        let referenced = orders.returns.referenced.x && orders.returns.referenced.z;
        let is_idle = !orders.is_emergency_stop && !orders.is_resetting;
        let at = self.clock.run;
        let position_set = match self.link.state() {
            LinkState::Homing if !(returning.x || returning.z) => {
                self.link.reset();
                false
            }
            LinkState::Locked | LinkState::Ready if returning.x || returning.z => {
                // Not possible yet: the next report tries again.
                let _ = self.link.home(returning);
                false
            }
            LinkState::Locked if is_idle && referenced => {
                self.link.set_position(pulses, at).is_ok()
            }
            LinkState::Locked
                if is_idle && !self.link.takes_motion() && !orders.has_board_alarm =>
            {
                self.link.release(pulses, at).is_ok()
            }
            LinkState::Tripped if is_idle && !self.link.takes_motion() && referenced => {
                self.link.retreat(pulses, at).is_ok()
            }
            _ => false,
        };
        if position_set {
            self.motion.pulses = pulses;
        }
        self.arm_switches();
        self.log_stops(orders.run.run_state);
    }

    /// Logs a stop of the program with the board's count. The end of a program is logged
    /// even if no axis has moved since the last stop.
    fn log_stops(&mut self, state: RunState) {
        if self.link.state() != LinkState::Ready
            || self.has_pending_motion()
            || state == RunState::Run
        {
            return;
        }
        let agreed = self.log.agreed_count.take();
        let stopped = agreed.is_some() && matches!(state, RunState::Hold | RunState::Stop);
        if stopped || self.log.ended_program.is_some() {
            self.log_count_check(true, agreed);
        }
    }
}
