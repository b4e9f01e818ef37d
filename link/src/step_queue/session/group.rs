//! The stop group in the board (Klipper's `trsync`), which stops both axes without the host,
//! and the awaited inputs.

use crate::Backend;
use core::time::Duration;

use super::StepLink;
use crate::step_queue::commands::Command;
use crate::step_queue::send_queue::Mark;
use crate::step_queue::wiring::{Switch, Wiring};
use crate::{AwaitedInput, HostTime, Input, InputCondition, LinkState, MotionRefused};
use gsk_units::Axis;

/// Trigger reason of the stop group: the limit switch of X is operated. The constants below are
/// further trigger reasons.
pub(super) const LIMIT_X: u32 = 1;
pub(super) const LIMIT_Z: u32 = 2;
pub(super) const EMERGENCY: u32 = 3;
pub(super) const SILENT_HOST: u32 = 4;
pub(super) const DRIVES: u32 = 5;
/// Trigger reason of the stop group: the awaited input of X meets its condition. The next number is
/// that of Z.
pub(super) const REACHED: u32 = 6;
pub(super) const REACHED_Z: u32 = 7;
pub(super) const FLUSH: u32 = 9;
/// Number of consecutive samples with the same level after which a switch counts as operated.
const SAMPLES: i64 = 4;
/// Interval between the samples that confirm an operated switch.
const SAMPLE: Duration = Duration::from_micros(15);
/// Interval at which the board polls a limit switch.
const LOOK: Duration = Duration::from_millis(1);
/// Number of polls of an awaited input between two pulses.
const LOOKS: f64 = 4.0;
/// Least interval at which the board polls an awaited input.
const OFTEN: Duration = Duration::from_micros(50);
/// Interval at which the board reports the state of the stop group.
const REPORT: Duration = Duration::from_millis(100);
/// Time without a report after which the stop group counts as failed.
pub(super) const SILENT: Duration = Duration::from_millis(450);
/// Time after arming within which the link must renew the stop group; otherwise it stops the axes.
const FIRST: Duration = Duration::from_millis(250);

/// The state of the group of steppers that stop together (Klipper's `trsync`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum GroupState {
    /// The stop group was never armed.
    #[default]
    Unused,
    /// The stop group is armed: a trigger will stop the axes.
    Armed,
    /// The stop group was triggered and has stopped the axes.
    Triggered,
}

/// The stop group. The board has two, used alternately: a late report of a triggered group
/// cannot be mistaken for one of the other group.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Group {
    which: usize,
    state: GroupState,
    /// Host time of the last report of the stop group.
    reported: HostTime,
    /// The awaited inputs of X and of Z; `None` without one.
    waits: [Option<Wait>; 2],
    /// Whether the limit switch of X or Z is not watched because it was operated.
    left_out: [bool; 2],
    /// Pin levels, 0 or 1, that end the wait of X and of Z for a change of an input; `None` without
    /// such a wait. A level remains valid across a stop by another input.
    edges: [Option<i64>; 2],
}

/// An input of an axis that the board watches, or will watch once its level is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wait {
    pub(super) awaited: AwaitedInput,
    /// Host time at which the pending query for the pin's level was sent; `None` without a query.
    queried_at: Option<HostTime>,
    /// The level of the pin at which the board stops the axes, 0 or 1.
    pub(super) level: i64,
    /// The board clock from which on the board polls the pin, ticks.
    from: u64,
}

impl Group {
    fn wait_for(&self, input: Input) -> Option<(usize, Wait)> {
        let mut waits = self.waits.iter().enumerate();
        waits
            .find_map(|(axis, wait)| Some((axis, wait.filter(|wait| wait.awaited.input == input)?)))
    }

    /// Whether the stop group is armed: a trigger will stop the axes.
    pub(super) const fn is_armed(&self) -> bool {
        matches!(self.state, GroupState::Armed)
    }

    /// Returns the awaited input of an axis; `None` without one.
    pub(super) fn awaited(&self, axis: Axis) -> Option<AwaitedInput> {
        self.waits[axis as usize].map(|wait| wait.awaited)
    }

    /// Whether the board watches the awaited input of an axis at the board clock `now`.
    pub(super) fn watches(&self, axis: Axis, now: u64) -> bool {
        self.is_armed()
            && self.waits[axis as usize]
                .is_some_and(|wait| wait.queried_at.is_none() && now >= wait.from)
    }

    /// Returns Klipper's object number of the stop group.
    pub(super) const fn oid(&self, wiring: &Wiring) -> i64 {
        wiring.groups[self.which]
    }

    /// Returns Klipper's object number of the stop group while it is armed; otherwise `None`.
    pub(super) fn armed_oid(&self, wiring: Option<&Wiring>) -> Option<i64> {
        wiring
            .filter(|_| self.is_armed())
            .map(|wiring| self.oid(wiring))
    }

    /// Switches to the other of the two stop groups and marks it as armed.
    fn take_turns(&mut self, now: HostTime) {
        *self = Self {
            which: 1 - self.which,
            state: GroupState::Armed,
            reported: now,
            edges: self.edges,
            ..Self::default()
        };
    }

    /// Records that the stop group has sent a report at time `now`.
    pub(super) const fn note_report(&mut self, now: HostTime) {
        self.reported = now;
    }

    /// Marks the stop group as triggered.
    pub(super) const fn note_trigger(&mut self) {
        self.state = GroupState::Triggered;
    }

    /// Whether the stop group is armed but has sent no report for [`SILENT`].
    pub(super) fn is_silent(&self, now: HostTime) -> bool {
        self.is_armed() && now.saturating_sub(self.reported) >= SILENT
    }

    /// Removes and returns the awaited inputs of X (index 0) and of Z (index 1), after a stop;
    /// `None` for an axis that awaits no input.
    pub(super) fn take_waits(&mut self) -> [Option<Wait>; 2] {
        core::mem::take(&mut self.waits)
    }

    /// Clears the levels at which waits for a level change end, for both axes.
    pub(super) const fn forget_edges(&mut self) {
        self.edges = [None; 2];
    }

    /// Forgets the level that ends the wait of an axis (0 for X, 1 for Z) for a change.
    pub(super) const fn forget_edge(&mut self, axis: usize) {
        self.edges[axis] = None;
    }
}

impl StepLink {
    /// Arms the other stop group at standstill: the board then stops the axes at each wired switch
    /// that is not operated already.
    pub(super) fn arm_group(&mut self) {
        let Some(wiring) = self.wiring.clone() else {
            return;
        };
        if self.group.state != GroupState::Unused {
            // A trigger of the old group releases the axes.
            let old = self.group.oid(&wiring);
            self.wire.send(Command::TrsyncTrigger, &[old, FLUSH.into()]);
        }
        self.group.take_turns(self.session.now);
        let oid = self.group.oid(&wiring);
        let at = self.soon();
        let report = self.clock.ticks(REPORT) as i64;
        let start = [oid, i64::from(at as u32), report, SILENT_HOST.into()];
        self.wire
            .send_vital(Command::TrsyncStart, &start, at, Some(Mark::Group));
        let timeout = self.clock.at(self.session.now + FIRST);
        for axis in [wiring.axes.x, wiring.axes.z] {
            self.wire.send(Command::StepperStopOnTrigger, &[axis, oid]);
        }
        for switch in &wiring.switches {
            self.watch_switch(*switch, at);
        }
        let first = [oid, i64::from(timeout as u32)];
        self.wire
            .send_vital(Command::TrsyncSetTimeout, &first, timeout, None);
        self.motion.queue.forget_steps();
    }

    /// Makes the board watch a switch of the stop group from the board clock `at` on, or stop
    /// watching it if it is operated or not needed.
    fn watch_switch(&mut self, switch: Switch, at: u64) {
        let Some(wiring) = &self.wiring else {
            return;
        };
        let oid = self.group.oid(wiring);
        let limit = match switch.input {
            Input::LimitX => Some(0),
            Input::LimitZ => Some(1),
            _ => None,
        };
        let stops = match switch.input {
            Input::LimitX => Some(LIMIT_X),
            Input::LimitZ => Some(LIMIT_Z),
            Input::EmergencyStop => Some(EMERGENCY),
            Input::DriveAlarm => Some(DRIVES),
            _ => None,
        };
        let operated = self.input(switch.input) == Some(true);
        let (reason, level, look) = match (self.group.wait_for(switch.input), stops) {
            (Some((axis, wait)), _) if wait.queried_at.is_none() => {
                let between = Duration::from_secs_f64(1.0 / (LOOKS * wait.awaited.rate.max(1.0)));
                let reason = [REACHED, REACHED_Z][axis];
                (reason, wait.level, between.clamp(OFTEN, LOOK))
            }
            (None, Some(reason)) if !operated => (reason, switch.level, LOOK),
            (wait, _) => {
                if let (None, Some(axis)) = (wait, limit) {
                    self.group.left_out[axis] = true;
                }
                self.wire
                    .send(Command::EndstopHome, &[switch.oid, 0, 0, 0, 0, 0, 0, 0]);
                return;
            }
        };
        let ticks = |duration| self.clock.ticks(duration) as i64;
        let arguments = [
            switch.oid,
            i64::from(at as u32),
            ticks(SAMPLE),
            SAMPLES,
            ticks(look),
            level,
            oid,
            reason.into(),
        ];
        self.wire
            .send_vital(Command::EndstopHome, &arguments, at, None);
    }

    pub(super) fn switch_at(&self, input: Input) -> Option<Switch> {
        let mut switches = self.wiring.iter().flat_map(|wiring| &wiring.switches);
        switches.find(|switch| switch.input == input).copied()
    }

    /// Arms an awaited input: the board stops the axes when its condition is met.
    ///
    /// # Errors
    /// The link accepts no motion, or the board has no such input.
    pub(super) fn arm_input(&mut self, awaited: AwaitedInput) -> Result<(), MotionRefused> {
        let (Some(switch), Some(axis)) = (self.switch_at(awaited.input), awaited.input.axis())
        else {
            return Err(MotionRefused::NotWired);
        };
        if !self.takes_motion() || !self.group.is_armed() {
            return Err(MotionRefused::NotReady);
        }
        self.disarm_input(axis);
        let level = match awaited.until {
            InputCondition::Operated => Some(switch.level),
            InputCondition::Free => Some(1 - switch.level),
            // After a stop by another input the same edge is awaited.
            InputCondition::Changed => self.group.edges[axis as usize],
        };
        let from = self.soon();
        self.group.waits[axis as usize] = Some(Wait {
            awaited,
            queried_at: level.is_none().then_some(self.session.now),
            level: level.unwrap_or_default(),
            from,
        });
        if level.is_some() {
            self.watch_switch(switch, from);
        } else {
            self.wire
                .send_query(Command::EndstopQueryState, &[switch.oid], Mark::Switch);
        }
        Ok(())
    }

    /// Disarms the awaited input of an axis: it no longer stops the axes.
    pub(super) fn disarm_input(&mut self, axis: Axis) {
        let Some(wait) = self.group.waits[axis as usize].take() else {
            return;
        };
        if wait.awaited.until != InputCondition::Changed {
            self.group.edges[axis as usize] = None;
        }
        if let Some(switch) = self.switch_at(wait.awaited.input)
            && self.group.is_armed()
            && self.stopping.is_none()
        {
            let at = self.soon();
            self.watch_switch(switch, at);
        }
    }

    /// Disarms the awaited input of an axis and forgets the level that ends its wait for a change.
    pub(super) fn forget_awaited(&mut self, axis: Axis) {
        self.disarm_input(axis);
        self.group.edges[axis as usize] = None;
    }

    /// Takes the level, 0 or 1, of the pin with the object number `oid`, which the link has
    /// queried. The board then waits for a change from this level.
    pub(super) fn level_reply(&mut self, oid: i64, level: i64) {
        for axis in 0..2 {
            let Some(wait) = &mut self.group.waits[axis] else {
                continue;
            };
            let input = wait.awaited.input;
            let queried_at = wait.queried_at.is_some();
            let Some(switch) = self
                .switch_at(input)
                .filter(|switch| queried_at && switch.oid == oid)
            else {
                continue;
            };
            let from = self.soon();
            if let Some(wait) = &mut self.group.waits[axis] {
                wait.queried_at = None;
                wait.level = 1 - level;
                wait.from = from;
            }
            self.group.edges[axis] = Some(1 - level);
            self.watch_switch(switch, from);
        }
    }

    /// Repeats the queries for the levels of awaited inputs that the board has not answered in
    /// time.
    pub(super) fn repeat_level_queries(&mut self) {
        let query_timeout = self.query_timeout();
        for axis in 0..2 {
            if let Some(wait) = &mut self.group.waits[axis]
                && let Some(queried_at) = wait.queried_at
                && self.session.since(queried_at) >= query_timeout
            {
                wait.queried_at = Some(self.session.now);
                let input = wait.awaited.input;
                if let Some(switch) = self.switch_at(input) {
                    self.wire
                        .send_query(Command::EndstopQueryState, &[switch.oid], Mark::Switch);
                }
            }
        }
    }

    /// Makes the board watch a limit switch again that was operated and is free now, at standstill
    /// or when the axis is far enough from it.
    pub(super) fn watch_left_out(&mut self) {
        if !self.takes_motion() || !self.group.is_armed() {
            return;
        }
        let stands = self.session.state != LinkState::Moving && !self.motion.is_under_way();
        for (axis, input) in [Input::LimitX, Input::LimitZ].into_iter().enumerate() {
            let free = self.input(input) == Some(false);
            if !(self.group.left_out[axis] && free) {
                continue;
            }
            if stands {
                return self.arm_group();
            }
            if let Some(switch) = self.switch_at(input)
                && self.motion.limits.has_left(axis)
                && self.group.wait_for(input).is_none()
            {
                self.group.left_out[axis] = false;
                let at = self.soon();
                self.watch_switch(switch, at);
            }
        }
    }
}

/// Whether the trigger reason means that an awaited input was reached.
pub(super) const fn is_reached(reason: u32) -> bool {
    matches!(reason, REACHED | REACHED_Z)
}
