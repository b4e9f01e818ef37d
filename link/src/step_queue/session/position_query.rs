//! Queries the position of the axes, or estimates it when the board cannot answer.

use super::super::super::HostTime;
use super::super::commands::Command;
use super::super::send_queue::Mark;
use super::super::step_compress::Ticks;
use super::{GIVE_UP, PositionQuery, QueryPurpose, StepLink};
use gsk_messages::say;

impl StepLink {
    /// Estimates the position of the axes of a board that does not answer: the commanded position
    /// at the host time `at`.
    pub(super) fn estimate_position(&mut self, at: HostTime) {
        self.stopping = None;
        if let Some(kernel) = self.tap_position() {
            return self.motion.stand_at(kernel);
        }
        let clock = self.path_clock_at(at);
        self.motion.stand_at_clocks([clock; 2]);
    }

    /// Estimates the position of the axes of a board that has shut down: the commanded position at
    /// the host time `at`, but not beyond the confirmed steps. With `in_last` the board may have
    /// shut down in the last confirmed block.
    pub(super) fn estimate_position_sent(&mut self, at: HostTime, in_last: bool) {
        self.stopping = None;
        if let Some(kernel) = self.tap_position() {
            return self.motion.stand_at(kernel);
        }
        let clock = self.path_clock_at(at);
        let (missing, kept) = (
            self.wire.send_queue.first_missing(in_last),
            self.motion.queue.first_kept(),
        );
        // The axis stopped before its first missing step.
        let clocks = [0, 1].map(|axis| {
            let first = missing[axis].or(kept[axis]);
            first.map_or(clock, |first| clock.min(first as Ticks - 1))
        });
        self.motion.stand_at_clocks(clocks);
    }

    /// Returns the clock of the path at the host time `at`, ticks; in a thread that of the last
    /// report of the spindle.
    fn path_clock_at(&self, at: HostTime) -> Ticks {
        if self.angle.is_engaged() {
            return self.path_now();
        }
        self.clock.at(at.min(self.session.now)) as Ticks
    }

    /// Queries the position of both axes; `purpose` determines what happens with the answer.
    /// Replaces a pending query.
    pub(super) fn query_position(&mut self, purpose: QueryPurpose) {
        self.query.pending = Some(PositionQuery {
            purpose,
            since: self.session.now,
            queried_at: self.session.now,
            got: [None; 2],
        });
        self.send_position_query();
    }

    fn send_position_query(&mut self) {
        if let Some(axes) = self.wiring.as_ref().map(|wiring| wiring.axes) {
            // One mark is enough: replies to both commands follow the first query.
            self.wire
                .send_query(Command::StepperGetPosition, &[axes.x], Mark::Position);
            self.wire
                .send_urgent(Command::StepperGetPosition, &[axes.z]);
        }
    }

    pub(super) fn repeat_position_query(&mut self) {
        let query_timeout = self.query_timeout();
        let Some(reading) = &mut self.query.pending else {
            return;
        };
        if self.session.since(reading.since) >= GIVE_UP && reading.purpose == QueryPurpose::ShutDown
        {
            // The estimated position remains.
            self.query.pending = None;
        } else if self.session.since(reading.since) >= GIVE_UP {
            self.lose_board(say::board_position_not_reported());
        } else if self.session.since(reading.queried_at) >= query_timeout {
            reading.queried_at = self.session.now;
            self.send_position_query();
        }
    }

    pub(super) fn position_reply(&mut self, oid: i64, pulses: u32) {
        let (Some(reading), Some(wiring)) = (&mut self.query.pending, &self.wiring) else {
            return;
        };
        let axis = [wiring.axes.x, wiring.axes.z]
            .iter()
            .position(|&axis| axis == oid);
        if let Some(axis) = axis {
            reading.got[axis] = Some(pulses);
        }
        if let [Some(x), Some(z)] = reading.got {
            let purpose = reading.purpose;
            self.query.pending = None;
            let board = self.motion.count.board_counts([x, z], &self.config);
            self.position_answered(purpose, board);
        }
    }
}
