//! Stops of a board with timed steps and the position after them.
//!
//! The stop group is in the board. Limit switches, the emergency stop, the drive alarm, a
//! silent host and a flush by the link trigger it. Both axes stop immediately, and the board
//! reports their position.

use super::group::{
    DRIVES, EMERGENCY, FLUSH, LIMIT_X, LIMIT_Z, REACHED, REACHED_Z, SILENT_HOST, is_reached,
};
use super::{GIVE_UP, QueryPurpose, StepLink};
use crate::Backend;
use crate::position::Positioned;
use crate::step_queue::commands::Command;
use crate::step_queue::send_queue::Mark;
use crate::step_queue::step_compress::Ticks;
use crate::{HostTime, Input, InputCondition, LinkEvent, LinkState, Uncertainty};
use gsk_messages::{Message, say};
use gsk_units::{PerAxis, Pulses, alarm};

/// The reason for which the axes are being stopped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum StopReason {
    /// The kernel has requested that the axes stop and keep their position.
    Flush,
    /// The spindle stands still in a thread, and the axes with it.
    SpindleStands,
    /// Motion was late, or could not be sent in time; the alarm gives this message as its cause.
    Late(Message),
    /// The motion needs more messages per second than the board can receive.
    TooFine,
    /// The board no longer reports the state of the stop group.
    GroupSilent,
    /// The board has triggered the stop group itself, with this trigger reason.
    Trip(u32),
}

/// A stop in progress: its reason, and the times of its start and of the last query.
#[derive(Clone, Debug)]
pub(super) struct StepQueueStop {
    reason: StopReason,
    since: HostTime,
    queried_at: HostTime,
    /// Whether the board has confirmed that the axes are stopped.
    stands: bool,
}

impl StepLink {
    /// Disables the drives and stops the axes, because the emergency stop contact of the board is
    /// operated.
    pub(super) fn trip(&mut self) {
        self.periodic.enable.on = false;
        if self.takes_motion() || self.session.state == LinkState::Homing {
            self.halt(StopReason::Trip(EMERGENCY));
        } else if self.stopping.is_none() {
            self.lose_position(Uncertainty::Powerless);
            self.session.enter(LinkState::Tripped);
        }
    }

    /// Takes a report of the stop group: object number, whether it can still trigger (not 0),
    /// trigger reason, and low half of the board clock. A triggered group has stopped the axes: the
    /// link then drops the motion and queries their position.
    pub(super) fn trsync_report(&mut self, [oid, can_trigger, reason, clock]: [u32; 4]) {
        if self.group.armed_oid(self.wiring.as_ref()) != Some(i64::from(oid)) {
            return;
        }
        self.group.note_report(self.session.now);
        if can_trigger != 0 {
            self.clock.clock_report(self.session.now, clock);
            return;
        }
        self.group.note_trigger();
        let reason = match &self.stopping {
            Some(stopping) if reason == FLUSH => stopping.reason.clone(),
            _ => StopReason::Trip(reason),
        };
        self.give_up_motion();
        if let StopReason::Trip(reason) = reason {
            if self.stopping.is_none() {
                let reached = is_reached(reason);
                self.session.events.push(LinkEvent::Halting { reached });
            }
            self.report_trip(reason);
        }
        self.stopping = Some(StepQueueStop {
            reason,
            since: self.session.now,
            queried_at: self.session.now,
            stands: true,
        });
        self.query_position(QueryPurpose::Stopped);
    }

    fn report_trip(&mut self, reason: u32) {
        let (number, text) = match reason {
            LIMIT_X => (alarm::X_BOARD_LIMIT, say::board_limit_input('X')),
            LIMIT_Z => (alarm::Z_BOARD_LIMIT, say::board_limit_input('Z')),
            EMERGENCY => {
                self.periodic.enable.on = false;
                (alarm::EMERGENCY_STOP, say::board_emergency_input())
            }
            SILENT_HOST => (alarm::LINK_LOST, say::board_hears_no_computer()),
            DRIVES => (alarm::X_DRIVE_ALARM, say::board_drive_alarm_input()),
            REACHED | REACHED_Z => return,
            _ => (alarm::BOARD_FAULT, say::board_stopped_axes(reason)),
        };
        self.session.alarm(number, text);
    }

    /// Stops both axes immediately; drops the queued motion and keeps the position.
    pub(super) fn flush(&mut self) {
        if self.takes_motion() {
            self.halt(StopReason::Flush);
        }
    }

    /// Stops the axes because motion is late or missing. The alarm with the cause `detail` follows
    /// when the board has answered, because a lost board gets another alarm.
    pub(super) fn late(&mut self, detail: Message) {
        if self.stopping.is_none() && self.is_opened() {
            self.halt(StopReason::Late(detail));
        }
        self.wire.send_queue.drop_motion();
    }

    /// Stops the axes because the motion needs more messages per second than the board accepts.
    pub(super) fn too_fine(&mut self) {
        if self.stopping.is_none() && self.is_opened() {
            self.halt(StopReason::TooFine);
        }
        self.wire.send_queue.drop_motion();
    }

    pub(super) fn halt(&mut self, reason: StopReason) {
        if self.stopping.is_some() {
            return;
        }
        self.give_up_motion();
        self.session
            .events
            .push(LinkEvent::Halting { reached: false });
        self.stopping = Some(StepQueueStop {
            reason,
            since: self.session.now,
            queried_at: self.session.now,
            stands: false,
        });
        self.trigger();
        self.session.enter(LinkState::Verify);
    }

    fn trigger(&mut self) {
        if let Some(wiring) = &self.wiring {
            let oid = self.group.oid(wiring);
            // Earlier reports are ignored, and later steps have no effect.
            self.wire
                .send_query(Command::TrsyncTrigger, &[oid, FLUSH.into()], Mark::Group);
        }
    }

    pub(super) fn watch_group(&mut self) {
        let query_timeout = self.query_timeout();
        if let Some(stopping) = &mut self.stopping {
            if stopping.stands {
                return;
            }
            if self.session.since(stopping.since) >= GIVE_UP {
                self.lose_board(say::board_stop_not_confirmed());
            } else if self.session.since(stopping.queried_at) >= query_timeout {
                stopping.queried_at = self.session.now;
                self.trigger();
            }
            return;
        }
        if self.group.is_silent(self.session.now) && self.takes_motion() {
            self.session
                .alarm(alarm::LINK_LOST, say::board_group_silent());
            self.halt(StopReason::GroupSilent);
            return;
        }
        self.watch_left_out();
    }

    /// Drops all motion and the pending position query.
    pub(super) fn give_up_motion(&mut self) {
        self.angle.drop_motion();
        self.drop_tap();
        self.motion.drop_queued();
        self.wire.send_queue.drop_motion();
        self.query.pending = None;
    }

    /// Resumes after an intended stop: enters the state `Ready`, which accepts motion, if the
    /// position is known; otherwise the state `Locked`.
    fn resume(&mut self) {
        if self.session.knows_position() {
            self.arm_group();
            self.session.enter(LinkState::Ready);
        } else {
            self.session.enter(LinkState::Locked);
        }
    }

    /// Completes a stop at the position `board`, a count of the board in pulses: reports the
    /// position, raises the alarm of the stop, and enters the state that follows its reason.
    pub(super) fn stopped(&mut self, board: PerAxis<Pulses>) {
        let Some(stopping) = self.stopping.take() else {
            return;
        };
        let keep = self.config.flush_keep_speed.into();
        // The angle of a thread is not known to the count: the position may be anywhere on its path.
        let now = if core::mem::take(&mut self.angle.was_dropped) {
            Ticks::MAX.unsigned_abs()
        } else {
            self.clock.at(self.session.now)
        };
        let mut stop = self.motion.stopped_at(board, now, self.pulses_per_mm);
        if let Some(tap) = self.angle.stopped_tap.take() {
            stop.on_path = tap.contains(stop.kernel);
            (stop.speed, stop.direction) = (tap.speed, [0, tap.direction]);
        }
        let reached = matches!(stopping.reason, StopReason::Trip(reason) if is_reached(reason));
        let powerless = matches!(stopping.reason, StopReason::Trip(EMERGENCY | DRIVES));
        // A fast stepper motor may lose steps in a dead stop.
        let stands = stopping.reason == StopReason::SpindleStands;
        let exact = stop.on_path && (stop.speed <= keep || reached || stands) && !powerless;
        self.session.released = false;
        if !exact {
            self.lose_position(match (powerless, stop.on_path) {
                (true, _) => Uncertainty::Powerless,
                (_, false) => Uncertainty::OffPath,
                _ => Uncertainty::TooFast,
            });
        }
        let waits = self.group.take_waits();
        if !reached {
            self.group.forget_edges();
        }
        if let StopReason::Trip(reason @ (LIMIT_X | LIMIT_Z)) = stopping.reason {
            let (axis, input) = match reason {
                LIMIT_X => (0, Input::LimitX),
                _ => (1, Input::LimitZ),
            };
            self.motion.limits.hit(axis, stop.direction[axis]);
            // Note the operated switch before its next query.
            if let Some(switch) = self.switch_at(input) {
                self.periodic.switches.level_met(switch, switch.level);
            }
        }
        self.session.events.push(LinkEvent::Position(stop.kernel));
        self.resend_outputs();
        match stopping.reason {
            StopReason::Flush | StopReason::SpindleStands => self.resume(),
            StopReason::Trip(reason @ (REACHED | REACHED_Z)) => {
                let axis = (reason - REACHED) as usize;
                self.group.forget_edge(axis);
                if let Some(wait) = waits[axis] {
                    let input = wait.awaited.input;
                    if let Some(switch) = self.switch_at(input) {
                        self.periodic.switches.level_met(switch, wait.level);
                    }
                    let limit = matches!(input, Input::LimitX | Input::LimitZ);
                    if limit && wait.awaited.until == InputCondition::Operated {
                        self.motion.limits.hit(axis, stop.direction[axis]);
                    }
                    self.session
                        .events
                        .push(LinkEvent::Reached(input, stop.kernel));
                }
                self.resume();
            }
            StopReason::Late(detail) => {
                self.session.alarm(alarm::STEPS_TOO_LATE, detail);
                self.session.enter(LinkState::Fault);
            }
            StopReason::TooFine => {
                self.session
                    .alarm(alarm::BOARD_CANNOT, say::motion_too_fine());
                self.session.enter(LinkState::Fault);
            }
            StopReason::GroupSilent => self.session.enter(LinkState::Fault),
            StopReason::Trip(_) => self.session.enter(LinkState::Tripped),
        }
    }
}
