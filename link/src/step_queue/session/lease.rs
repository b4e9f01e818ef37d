//! The lease of our own board: it moves only while the link renews it. Without renewal the board
//! slows both axes down on their path, and shuts down.

use core::time::Duration;

use super::StepLink;
use crate::step_queue::commands::Command;
use crate::{BoardOutputs, HostTime};
use gsk_messages::say;
use gsk_units::alarm;

/// Interval at which the link renews the lease.
const EVERY: Duration = Duration::from_millis(20);
/// Share of the lookahead for which the lease holds, tenths: the planned stop needs the rest, so
/// that it ends before the queue of steps does.
const LOOKAHEAD_TENTHS: u32 = 9;

/// The lease that the link has taken.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lease {
    /// Whether the operator has given a reason for motion since the opening: a position, a release
    /// for manual motion, or an output that is on.
    is_taken: bool,
    due: HostTime,
}

impl StepLink {
    /// Renews the lease if it is due. The link takes it up with the first motion or output that the
    /// operator permits, and renews it until the board is closed or stopped.
    pub(super) fn renew_lease(&mut self) {
        let Some(crc) = self.wiring.as_ref().map(|wiring| wiring.crc) else {
            return;
        };
        if !self.wire.dictionary.has(Command::RenewLease) {
            return;
        }
        let is_on = self.periodic.outputs.sent != BoardOutputs::default();
        let lease = &mut self.periodic.lease;
        lease.is_taken |= self.group.is_armed() || is_on;
        if !lease.is_taken || self.session.now < lease.due {
            return;
        }
        lease.due = self.session.now + EVERY;
        let holds = self.config.lookahead() * LOOKAHEAD_TENTHS / 10
            + self.wire.send_queue.slowness_now(self.session.now);
        let until = self.clock.at(self.session.now + holds);
        self.wire.send_urgent_until(
            Command::RenewLease,
            &[crc.into(), i64::from(until as u32)],
            until,
        );
    }

    /// Takes the report that the lease has expired: the board is stopping, and shuts down at the
    /// standstill.
    pub(super) fn lease_expired(&mut self) {
        self.session
            .alarm(alarm::LINK_LOST, say::board_lease_expired());
        self.wire.send_queue.drop_motion();
    }
}
