//! Where the slides stand: what the kernel says, and what the board counts.

use super::super::super::HostTime;
use super::super::commands::Command;
use super::super::send_queue::Mark;
use super::super::step_compress::Ticks;
use super::{GIVE_UP, PositionQuery, QueryPurpose, StepLink};
use gsk_messages::say;

impl StepLink {
    /// The board does not report any more where the axes stand: they are where its clock
    /// had them at this time.
    pub(super) fn estimate_position(&mut self, at: HostTime) {
        self.stopping = None;
        let clock = self.clock.at(at.min(self.session.now)) as Ticks;
        self.motion.stand_at_clocks([clock; 2]);
    }

    /// The board has shut down and will not report where the axes stand: they are where its
    /// clock had them, and no farther than the steps it had been sent. `in_last`: it may
    /// have given up in the block that it confirmed last.
    pub(super) fn estimate_position_sent(&mut self, at: HostTime, in_last: bool) {
        self.stopping = None;
        let clock = self.clock.at(at.min(self.session.now)) as Ticks;
        let (missing, kept) = (
            self.wire.send_queue.first_missing(in_last),
            self.motion.queue.first_kept(),
        );
        // Before the first step that is missing.
        let clocks = [0, 1].map(|axis| {
            let first = missing[axis].or(kept[axis]);
            first.map_or(clock, |first| clock.min(first as Ticks - 1))
        });
        self.motion.stand_at_clocks(clocks);
    }

    /// Asks where the axes stand.
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
            // Replies to either are newer than the first question.
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
        if self.session.since(reading.since) >= GIVE_UP {
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
