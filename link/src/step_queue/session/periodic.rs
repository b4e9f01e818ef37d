//! Periodic messages: clock queries, heartbeat, enable of the drives, switch queries.

use core::time::Duration;

use super::StepLink;
use super::lease::Lease;
use super::outputs::StepQueueOutputs;
use super::switches::Switches;
use super::wheel::Wheel;
use crate::HostTime;
use crate::step_queue::commands::Command;
use crate::step_queue::send_queue::Mark;

/// Interval of queries for the board's clock.
const CLOCK_EVERY: Duration = Duration::from_millis(500);
/// Interval of queries for the board's clock during the opening.
const CLOCK_FIRST: Duration = Duration::from_millis(50);
/// Interval of queries for the board's configuration.
const CONFIG_EVERY: Duration = Duration::from_secs(1);
/// Interval at which the link renews the time limit of the stop group.
const HEARTBEAT_EVERY: Duration = Duration::from_millis(50);
/// Time after a renewal within which the link must renew the stop group again; otherwise it stops
/// the axes.
const HEARTBEAT_DURATION: Duration = Duration::from_millis(250);
/// Interval at which the link renews the output that enables the drives.
const ENABLE_EVERY: Duration = Duration::from_millis(100);
/// Greatest time between the board clocks of two renewals of the enable; the board allows 500 ms.
const ENABLE_APART: Duration = Duration::from_millis(400);
/// Time after the opening within which the board may shut down because an earlier host no longer
/// renews its outputs.
const INHERITED: Duration = Duration::from_millis(800);

/// The enable of the drives. The board disables the drives when the link does not renew the
/// enable.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Enable {
    pub(super) on: bool,
    /// Whether the last message for the enable output has enabled the drives.
    sent: bool,
    /// The board clock at which the last message for the enable output takes effect, ticks.
    sent_for: u64,
    due: HostTime,
}

/// Due times and states of the periodic messages.
#[derive(Clone, Debug, Default)]
pub(super) struct Periodic {
    pub(super) enable: Enable,
    /// Host time until which a shutdown of the board may be caused by an earlier host.
    pub(super) inherited_until: HostTime,
    clock_queried_at: Option<HostTime>,
    clock_due: HostTime,
    config_due: HostTime,
    heartbeat_due: HostTime,
    pub(super) lease: Lease,
    pub(super) switches: Switches,
    pub(super) wheel: Wheel,
    pub(super) outputs: StepQueueOutputs,
}

impl StepLink {
    pub(super) fn query_clock(&mut self) {
        let lost = |queried_at: HostTime| self.session.since(queried_at) >= CLOCK_EVERY;
        if self
            .periodic
            .clock_queried_at
            .is_some_and(|queried_at| !lost(queried_at))
            || self.session.now < self.periodic.clock_due
        {
            return;
        }
        self.periodic.clock_queried_at = Some(self.session.now);
        let every = if self.is_opened() {
            CLOCK_EVERY
        } else {
            CLOCK_FIRST
        };
        self.periodic.clock_due = self.session.now + every;
        self.wire.send_query(Command::GetUptime, &[], Mark::Uptime);
    }

    pub(super) fn uptime_reply(&mut self, numbers: [u32; 4]) {
        let Some(queried_at) = self.periodic.clock_queried_at.take() else {
            return;
        };
        let clock = u64::from(numbers[0]) << 32 | u64::from(numbers[1]);
        self.wire.traffic.reports += 1;
        self.wire.traffic.round_trip = Some(self.session.since(queried_at));
        if self.is_opened() && clock < self.clock.at(queried_at.saturating_sub(CLOCK_EVERY)) {
            self.board_restarted();
            return;
        }
        self.clock.add_answer(queried_at, self.session.now, clock);
    }

    /// Sends all periodic messages that are due.
    pub(super) fn run_periodic(&mut self) {
        self.query_clock();
        if self.session.now >= self.periodic.config_due {
            self.periodic.config_due = self.session.now + CONFIG_EVERY;
            self.wire.send_query(Command::GetConfig, &[], Mark::Config);
        }
        if let Some(oid) = self.group.armed_oid(self.wiring.as_ref())
            && self.session.now >= self.periodic.heartbeat_due
        {
            self.periodic.heartbeat_due = self.session.now + HEARTBEAT_EVERY;
            let until = self.clock.at(self.session.now + HEARTBEAT_DURATION);
            let arguments = [oid, i64::from(until as u32)];
            self.wire
                .send_urgent_until(Command::TrsyncSetTimeout, &arguments, until);
        }
        self.renew_lease();
        self.keep_enabled();
        self.query_switch();
        self.send_wanted();
    }

    fn keep_enabled(&mut self) {
        let Some(enable) = self.wiring.as_ref().map(|wiring| wiring.enable) else {
            return;
        };
        let on = self.periodic.enable.on;
        let renew = on && self.session.now >= self.periodic.enable.due;
        if !renew && on == self.periodic.enable.sent {
            return;
        }
        let mut at = self.soon();
        if renew && self.periodic.enable.sent {
            // After a gap in the host: before the timeout of the board, if that is still
            // possible.
            let latest = self.periodic.enable.sent_for + self.clock.ticks(ENABLE_APART);
            at = at.min(latest.max(self.earliest()));
        }
        let at = at.max(self.periodic.enable.sent_for + 1);
        self.periodic.enable.due = self.session.now + ENABLE_EVERY;
        self.periodic.enable.sent = on;
        self.periodic.enable.sent_for = at;
        let value = i64::from(on != enable.inverted);
        let arguments = [enable.oid, i64::from(at as u32), value];
        self.wire
            .send_urgent_until(Command::QueueDigitalOut, &arguments, at);
    }

    /// Resets outputs that an earlier host has left on: disables the drives and releases the stop
    /// groups.
    pub(super) fn take_over_outputs(&mut self) {
        self.periodic.enable.sent = true;
        self.periodic.inherited_until = self.session.now + INHERITED;
        let groups = self.wiring.as_ref().map(|wiring| wiring.groups);
        for oid in groups.into_iter().flatten() {
            self.wire.send(Command::TrsyncTrigger, &[oid, 0]);
        }
    }
}
