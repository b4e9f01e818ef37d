//! The stop group in the board: what stops both axes there without the host, and the
//! switches that are waited for.

use crate::Backend;
use core::time::Duration;

use super::StepLink;
use crate::step_queue::commands::Command;
use crate::step_queue::send_queue::Mark;
use crate::step_queue::wiring::{Switch, Wiring};
use crate::{AwaitedInput, HostTime, Input, InputCondition, LinkState, MotionRefused};
use gsk_units::Axis;

/// Reasons of the group.
pub(super) const LIMIT_X: u32 = 1;
pub(super) const LIMIT_Z: u32 = 2;
pub(super) const EMERGENCY: u32 = 3;
pub(super) const SILENT_HOST: u32 = 4;
pub(super) const DRIVES: u32 = 5;
/// An input that was waited for, of X and of Z.
pub(super) const REACHED: u32 = 6;
pub(super) const REACHED_Z: u32 = 7;
pub(super) const FLUSH: u32 = 9;
/// A switch counts when it was operated in so many samples, so far apart; between
/// two looks.
const SAMPLES: i64 = 4;
const SAMPLE: Duration = Duration::from_micros(15);
const LOOK: Duration = Duration::from_millis(1);
/// At an input that is waited for it looks so often between two pulses, but not
/// more often than this.
const LOOKS: f64 = 4.0;
const OFTEN: Duration = Duration::from_micros(50);
/// The group reports itself so often, and counts as silent when it has not for longer.
const REPORT: Duration = Duration::from_millis(100);
pub(super) const SILENT: Duration = Duration::from_millis(450);
/// First time-out of the group, as all later ones.
const FIRST: Duration = Duration::from_millis(250);

/// What the board does with the group.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum GroupState {
    /// It was never armed.
    #[default]
    Unused,
    /// It stops the axes when it is triggered.
    Armed,
    /// It has done its work.
    Triggered,
}

/// The stop group in the board. Two take turns, so that a late report of the one
/// that has done its work is not taken for the other's.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Group {
    which: usize,
    state: GroupState,
    /// When it last reported itself.
    reported: HostTime,
    /// Inputs that are waited for, of X and of Z.
    waits: [Option<Wait>; 2],
    /// Limit switches left out because they were operated.
    left_out: [bool; 2],
    /// Levels of the pins whose change is awaited, of X and of Z: they outlive a stop that
    /// another input has made.
    edges: [Option<i64>; 2],
}

/// An input that is waited for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wait {
    pub(super) awaited: AwaitedInput,
    /// When the board was asked for its level, which it has not reported yet.
    queried_at: Option<HostTime>,
    /// Level of the pin that stops the axes, and from when on it does.
    pub(super) level: i64,
    from: u64,
}

impl Group {
    fn wait_for(&self, input: Input) -> Option<(usize, Wait)> {
        let mut waits = self.waits.iter().enumerate();
        waits
            .find_map(|(axis, wait)| Some((axis, wait.filter(|wait| wait.awaited.input == input)?)))
    }

    /// Whether it stops the axes when it is triggered.
    pub(super) const fn is_armed(&self) -> bool {
        matches!(self.state, GroupState::Armed)
    }

    /// What is waited for at an axis.
    pub(super) fn awaited(&self, axis: Axis) -> Option<AwaitedInput> {
        self.waits[axis as usize].map(|wait| wait.awaited)
    }

    /// Whether the board looks at that by this clock.
    pub(super) fn watches(&self, axis: Axis, now: u64) -> bool {
        self.is_armed()
            && self.waits[axis as usize]
                .is_some_and(|wait| wait.queried_at.is_none() && now >= wait.from)
    }

    /// Its number in the board.
    pub(super) const fn oid(&self, wiring: &Wiring) -> i64 {
        wiring.groups[self.which]
    }

    /// The same, while it is armed.
    pub(super) fn armed_oid(&self, wiring: Option<&Wiring>) -> Option<i64> {
        wiring
            .filter(|_| self.is_armed())
            .map(|wiring| self.oid(wiring))
    }

    /// The other one takes its turn.
    fn take_turns(&mut self, now: HostTime) {
        *self = Self {
            which: 1 - self.which,
            state: GroupState::Armed,
            reported: now,
            edges: self.edges,
            ..Self::default()
        };
    }

    /// It has reported itself.
    pub(super) const fn has_reported(&mut self, now: HostTime) {
        self.reported = now;
    }

    /// It has done its work.
    pub(super) const fn is_triggered(&mut self) {
        self.state = GroupState::Triggered;
    }

    /// Whether it should have reported itself.
    pub(super) fn is_silent(&self, now: HostTime) -> bool {
        self.is_armed() && now.saturating_sub(self.reported) >= SILENT
    }

    /// Behind a stop nothing is waited for any more.
    pub(super) fn take_waits(&mut self) -> [Option<Wait>; 2] {
        core::mem::take(&mut self.waits)
    }

    /// No edge is waited for across a stop.
    pub(super) const fn forget_edges(&mut self) {
        self.edges = [None; 2];
    }

    /// The edge of an axis was met, or is not waited for any more.
    pub(super) const fn forget_edge(&mut self, axis: usize) {
        self.edges[axis] = None;
    }
}

impl StepLink {
    /// Arms the group: at a standstill, with everything that may stop the axes.
    pub(super) fn arm_group(&mut self) {
        let Some(wiring) = self.wiring.clone() else {
            return;
        };
        if self.group.state != GroupState::Unused {
            // Triggered, the old group lets go of the axes.
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

    /// From a clock on the board looks at a switch, when the group has to do with it.
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

    /// From now on this input stops the axes as soon as it does what is awaited.
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
            // Across a stop that another input has made, it is the same edge.
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

    /// The input that was waited for does not stop the axes any more.
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

    /// Nothing is waited for at an axis any more, not even by and by.
    pub(super) fn forget_awaited(&mut self, axis: Axis) {
        self.disarm_input(axis);
        self.group.edges[axis as usize] = None;
    }

    /// The level of a pin, in answer to the newest question.
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

    /// A question for a level whose answer was lost is asked again.
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

    /// A switch that was left out and is free counts again: when the axes stand, or well
    /// off it.
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

/// Whether the group was triggered by an input that was waited for.
pub(super) const fn is_reached(reason: u32) -> bool {
    matches!(reason, REACHED | REACHED_Z)
}
