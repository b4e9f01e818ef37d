//! Everything that stops the axes, and what is known afterwards.
//!
//! The stop group lives in the board: limit switches, emergency stop, drive alarm,
//! the silence of the host and the link's own flush trigger it; both axes then stop
//! at once, and the board knows where.

use core::time::Duration;

use super::super::super::{Awaited, Doubt, Event, HostTime, Input, LinkState, Refused, Until};
use super::super::commands::Command;
use super::super::delivery::{Mark, Message};
use super::super::wiring::{Switch, Wiring};
use super::{GIVE_UP, Purpose, StepLink};
use crate::units::{Axis, PerAxis, Pulses};

/// Reasons of the group.
const LIMIT_X: u32 = 1;
const LIMIT_Z: u32 = 2;
const EMERGENCY: u32 = 3;
const SILENT_HOST: u32 = 4;
const DRIVES: u32 = 5;
/// An input that was waited for, of X and of Z.
const REACHED: u32 = 6;
const REACHED_Z: u32 = 7;
const FLUSH: u32 = 9;
/// A switch counts when it was operated in so many samples, so far apart; between
/// two looks.
const SAMPLES: i64 = 4;
const SAMPLE: Duration = Duration::from_micros(15);
const LOOK: Duration = Duration::from_millis(1);
/// At an input that is waited for it looks so often between two pulses, but not
/// more often than this.
const LOOKS: f64 = 4.0;
const OFTEN: Duration = Duration::from_micros(50);
/// The group reports itself so often, and is doubted when it has not for longer.
const REPORT: Duration = Duration::from_millis(100);
const DOUBT: Duration = Duration::from_millis(450);
/// First time-out of the group, as all later ones.
const FIRST: Duration = Duration::from_millis(250);

/// The stop group in the board. Two take turns, so that a late report of the one
/// that has done its work is not taken for the other's.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Group {
    which: usize,
    used: bool,
    armed: bool,
    reported: HostTime,
    /// Inputs that are waited for, of X and of Z.
    waits: [Option<Wait>; 2],
    /// Limit switches left out because they were operated.
    left_out: [bool; 2],
}

/// An input that is waited for.
#[derive(Clone, Copy, Debug)]
struct Wait {
    awaited: Awaited,
    /// When the board was asked for its level, which it has not told yet.
    asked: Option<HostTime>,
    /// Level of the pin that stops the axes, and from when on it does.
    level: i64,
    from: u64,
}

impl Group {
    fn wait_for(&self, input: Input) -> Option<(usize, Wait)> {
        let mut waits = self.waits.iter().enumerate();
        waits
            .find_map(|(axis, wait)| Some((axis, wait.filter(|wait| wait.awaited.input == input)?)))
    }

    pub(super) fn armed_oid(&self, wiring: Option<&Wiring>) -> Option<i64> {
        wiring
            .filter(|_| self.armed)
            .map(|wiring| wiring.groups[self.which])
    }
}

/// Why the axes are being stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Why {
    /// The kernel asked for it.
    Flush,
    /// Motion came late, or could not be brought to the board in time.
    Late(&'static str),
    /// Motion of so many turns and bends that the board cannot be told in time.
    TooFine,
    /// The group has not reported itself.
    Doubt,
    /// The group was triggered.
    Trip(u32),
}

/// A stop under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stopping {
    why: Why,
    since: HostTime,
    asked: HostTime,
    /// The board has confirmed it.
    stands: bool,
}

impl StepLink {
    /// Arms the group: at a standstill, with everything that may stop the axes.
    pub(super) fn arm_group(&mut self) {
        let Some(wiring) = self.wiring.clone() else {
            return;
        };
        if self.group.used {
            // Triggered, the old group lets go of the axes.
            let old = wiring.groups[self.group.which];
            self.say(Command::TrsyncTrigger, &[old, FLUSH.into()]);
        }
        self.group = Group {
            which: 1 - self.group.which,
            used: true,
            armed: true,
            reported: self.now,
            waits: [None; 2],
            left_out: [false; 2],
        };
        let oid = wiring.groups[self.group.which];
        let at = self.soon();
        let report = self.clock.ticks(REPORT) as i64;
        let start = [oid, i64::from(at as u32), report, SILENT_HOST.into()];
        self.delivery.say(Message {
            mark: Some(Mark::Group),
            due: Some(at),
            vital: true,
            ..Message::plain(self.dictionary.message(Command::TrsyncStart, &start))
        });
        let timeout = self.clock.at(self.now + FIRST);
        for axis in [wiring.axes.x, wiring.axes.z] {
            self.say(Command::StepperStopOnTrigger, &[axis, oid]);
        }
        for switch in &wiring.switches {
            self.watch_switch(*switch, at);
        }
        let first = [oid, i64::from(timeout as u32)];
        self.say_vital(Command::TrsyncSetTimeout, &first, timeout);
        self.motion.forget_steps();
    }

    /// From a clock on the board looks at a switch, when the group has to do with it.
    fn watch_switch(&mut self, switch: Switch, at: u64) {
        let Some(wiring) = &self.wiring else {
            return;
        };
        let oid = wiring.groups[self.group.which];
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
            (Some((axis, wait)), _) if wait.asked.is_none() => {
                let between = Duration::from_secs_f64(1.0 / (LOOKS * wait.awaited.rate.max(1.0)));
                let reason = [REACHED, REACHED_Z][axis];
                (reason, wait.level, between.clamp(OFTEN, LOOK))
            }
            (None, Some(reason)) if !operated => (reason, switch.level, LOOK),
            (wait, _) => {
                if let (None, Some(axis)) = (wait, limit) {
                    self.group.left_out[axis] = true;
                }
                self.say(Command::EndstopHome, &[switch.oid, 0, 0, 0, 0, 0, 0, 0]);
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
        self.say_vital(Command::EndstopHome, &arguments, at);
    }

    /// Without it the axes must not move; no stop takes it back.
    fn say_vital(&mut self, command: Command, arguments: &[i64], due: u64) {
        self.delivery.say(Message {
            due: Some(due),
            vital: true,
            ..Message::plain(self.dictionary.message(command, arguments))
        });
    }

    fn switch_at(&self, input: Input) -> Option<Switch> {
        let mut switches = self.wiring.iter().flat_map(|wiring| &wiring.switches);
        switches.find(|switch| switch.input == input).copied()
    }

    /// From now on this input stops the axes as soon as it does what is awaited: the
    /// board sees it, and tells where. [`is_armed`](Self::is_armed) says from when on.
    ///
    /// # Errors
    /// No motion is taken, or it is not wired.
    pub fn arm(&mut self, awaited: Awaited) -> Result<(), Refused> {
        let (Some(switch), Some(axis)) = (self.switch_at(awaited.input), awaited.input.axis())
        else {
            return Err(Refused::NotWired);
        };
        if !self.takes_motion() || !self.group.armed {
            return Err(Refused::NotReady);
        }
        self.disarm(axis);
        let level = match awaited.until {
            Until::Operated => Some(switch.level),
            Until::Free => Some(1 - switch.level),
            // Across a stop that another input has made, it is the same edge.
            Until::Changed => self.edges[axis as usize],
        };
        let from = self.soon();
        self.group.waits[axis as usize] = Some(Wait {
            awaited,
            asked: level.is_none().then_some(self.now),
            level: level.unwrap_or_default(),
            from,
        });
        if level.is_some() {
            self.watch_switch(switch, from);
        } else {
            self.say_marked(Command::EndstopQueryState, &[switch.oid], Mark::Switch);
        }
        Ok(())
    }

    /// What is waited for at an axis.
    pub fn awaited(&self, axis: Axis) -> Option<Awaited> {
        self.group.waits[axis as usize].map(|wait| wait.awaited)
    }

    /// Whether the board looks at what is waited for.
    pub fn is_armed(&self, axis: Axis) -> bool {
        let now = self.clock.at(self.now);
        self.group.armed
            && self.group.waits[axis as usize]
                .is_some_and(|wait| wait.asked.is_none() && now >= wait.from)
    }

    /// The emergency stop contact of the board is open.
    pub(super) fn trip(&mut self) {
        self.upkeep.drives_on = false;
        if self.takes_motion() || self.state == LinkState::Homing {
            self.halt(Why::Trip(EMERGENCY));
        } else if self.stopping.is_none() {
            self.lose_position(Doubt::Powerless);
            self.enter(LinkState::Tripped);
        }
    }

    /// The input that was waited for does not stop the axes any more.
    pub fn disarm(&mut self, axis: Axis) {
        let Some(wait) = self.group.waits[axis as usize].take() else {
            return;
        };
        if wait.awaited.until != Until::Changed {
            self.edges[axis as usize] = None;
        }
        if let Some(switch) = self.switch_at(wait.awaited.input)
            && self.group.armed
            && self.stopping.is_none()
        {
            let at = self.soon();
            self.watch_switch(switch, at);
        }
    }

    /// Nothing is waited for at an axis any more, not even by and by.
    pub fn forget_awaited(&mut self, axis: Axis) {
        self.disarm(axis);
        self.edges[axis as usize] = None;
    }

    /// The level of a pin, in answer to the newest question.
    pub(super) fn level_told(&mut self, oid: i64, level: i64) {
        for axis in 0..2 {
            let Some(wait) = &mut self.group.waits[axis] else {
                continue;
            };
            let input = wait.awaited.input;
            let asked = wait.asked.is_some();
            let Some(switch) = self
                .switch_at(input)
                .filter(|switch| asked && switch.oid == oid)
            else {
                continue;
            };
            let from = self.soon();
            if let Some(wait) = &mut self.group.waits[axis] {
                wait.asked = None;
                wait.level = 1 - level;
                wait.from = from;
            }
            self.edges[axis] = Some(1 - level);
            self.watch_switch(switch, from);
        }
    }

    /// A question for a level whose answer was lost is asked again.
    pub(super) fn ask_levels_again(&mut self) {
        let patience = self.patience();
        for axis in 0..2 {
            if let Some(wait) = &mut self.group.waits[axis]
                && let Some(asked) = wait.asked
                && self.now.saturating_sub(asked) >= patience
            {
                wait.asked = Some(self.now);
                let input = wait.awaited.input;
                if let Some(switch) = self.switch_at(input) {
                    self.say_marked(Command::EndstopQueryState, &[switch.oid], Mark::Switch);
                }
            }
        }
    }

    /// The group says how it is.
    pub(super) fn group_told(&mut self, [oid, can_trigger, reason, clock]: [u32; 4]) {
        if self.group.armed_oid(self.wiring.as_ref()) != Some(i64::from(oid)) {
            return;
        }
        self.group.reported = self.now;
        if can_trigger != 0 {
            self.clock.told(self.now, clock);
            return;
        }
        self.group.armed = false;
        let why = match self.stopping {
            Some(stopping) if reason == FLUSH => stopping.why,
            _ => Why::Trip(reason),
        };
        self.give_up_motion();
        if let Why::Trip(reason) = why {
            if self.stopping.is_none() {
                let reached = is_reached(reason);
                self.events.push(Event::Halting { reached });
            }
            self.tell_trip(reason);
        }
        self.stopping = Some(Stopping {
            why,
            since: self.now,
            asked: self.now,
            stands: true,
        });
        self.read_place(Purpose::Stopped);
    }

    fn tell_trip(&mut self, reason: u32) {
        match reason {
            LIMIT_X => self.alarm(621, "limit input of X at the board"),
            LIMIT_Z => self.alarm(622, "limit input of Z at the board"),
            EMERGENCY => {
                self.upkeep.drives_on = false;
                self.alarm(207, "emergency stop input of the board");
            }
            SILENT_HOST => self.alarm(605, "the board has not heard of the PC for 250 ms"),
            DRIVES => self.alarm(221, "alarm input of the drives at the board"),
            REACHED | REACHED_Z => {}
            _ => self.alarm(
                607,
                &format!("the axes were stopped in the board, reason {reason}"),
            ),
        }
    }

    /// Both axes stop at once; nothing queued is left, the position is kept.
    pub(super) fn flush(&mut self) {
        if self.takes_motion() {
            self.halt(Why::Flush);
        }
    }

    /// Motion would come too late, or did not come: the axes are stopped.
    /// Why it did is known when the board has answered, or has not.
    pub(super) fn late(&mut self, detail: &'static str) {
        if self.stopping.is_none() && self.is_running() {
            self.halt(Why::Late(detail));
        }
        self.delivery.drop_motion();
    }

    /// The motion needs more messages than the board may be given.
    pub(super) fn too_fine(&mut self) {
        if self.stopping.is_none() && self.is_running() {
            self.halt(Why::TooFine);
        }
        self.delivery.drop_motion();
    }

    pub(super) fn halt(&mut self, why: Why) {
        if self.stopping.is_some() {
            return;
        }
        self.give_up_motion();
        self.events.push(Event::Halting { reached: false });
        self.stopping = Some(Stopping {
            why,
            since: self.now,
            asked: self.now,
            stands: false,
        });
        self.trigger();
        self.enter(LinkState::Verify);
    }

    fn trigger(&mut self) {
        if let Some(wiring) = &self.wiring {
            let oid = wiring.groups[self.group.which];
            // What is asked before and what is queued behind is without effect.
            self.say_marked(Command::TrsyncTrigger, &[oid, FLUSH.into()], Mark::Group);
        }
    }

    pub(super) fn watch_group(&mut self) {
        let patience = self.patience();
        if let Some(stopping) = &mut self.stopping {
            if stopping.stands {
                return;
            }
            if self.now.saturating_sub(stopping.since) >= GIVE_UP {
                self.lost("the board does not confirm that the axes were stopped");
            } else if self.now.saturating_sub(stopping.asked) >= patience {
                stopping.asked = self.now;
                self.trigger();
            }
            return;
        }
        let silent = self.now.saturating_sub(self.group.reported) >= DOUBT;
        if self.group.armed && silent && self.takes_motion() {
            self.alarm(605, "the stop group of the board does not report itself");
            self.halt(Why::Doubt);
            return;
        }
        self.watch_left_out();
    }

    /// A switch that was left out and is free counts again: when the axes stand, or well
    /// off it.
    fn watch_left_out(&mut self) {
        if !self.takes_motion() || !self.group.armed {
            return;
        }
        let stands = self.state != LinkState::Moving && !self.motion.is_under_way();
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

    /// Nothing more goes out, and nothing that waits.
    pub(super) fn give_up_motion(&mut self) {
        self.motion.drop_queued();
        self.delivery.drop_motion();
        self.reading = None;
    }

    /// Behind a stop that was wanted: with a position that is certain motion is taken
    /// again.
    fn go_on(&mut self) {
        if self.known {
            self.arm_group();
            self.enter(LinkState::Ready);
        } else {
            self.enter(LinkState::Locked);
        }
    }

    /// The board said where the axes stand after a stop.
    pub(super) fn stopped(&mut self, board: PerAxis<Pulses>) {
        let Some(stopping) = self.stopping.take() else {
            return;
        };
        let keep = self.config.flush_keep_speed.into();
        let now = self.clock.at(self.now);
        let stop = self.motion.stopped_at(board, now, self.pulses_per_mm);
        let reached = matches!(stopping.why, Why::Trip(reason) if is_reached(reason));
        let powerless = matches!(stopping.why, Why::Trip(EMERGENCY | DRIVES));
        // A stepper that was stopped dead may have slipped when it was fast.
        let exact = stop.on_path && (stop.speed <= keep || reached) && !powerless;
        self.released = false;
        if !exact {
            self.lose_position(match (powerless, stop.on_path) {
                (true, _) => Doubt::Powerless,
                (_, false) => Doubt::OffPath,
                _ => Doubt::TooFast,
            });
        }
        let waits = core::mem::take(&mut self.group.waits);
        if !reached {
            self.edges = [None; 2];
        }
        if let Why::Trip(reason @ (LIMIT_X | LIMIT_Z)) = stopping.why {
            let (axis, input) = match reason {
                LIMIT_X => (0, Input::LimitX),
                _ => (1, Input::LimitZ),
            };
            self.motion.limits.hit(axis, stop.way[axis]);
            // It was seen before it is asked for again.
            if let Some(switch) = self.switch_at(input) {
                self.upkeep.level_met(switch, switch.level);
            }
        }
        self.events.push(Event::Position(stop.kernel));
        self.tell_outputs_again();
        match stopping.why {
            Why::Flush => self.go_on(),
            Why::Trip(reason @ (REACHED | REACHED_Z)) => {
                let axis = (reason - REACHED) as usize;
                self.edges[axis] = None;
                if let Some(wait) = waits[axis] {
                    let input = wait.awaited.input;
                    if let Some(switch) = self.switch_at(input) {
                        self.upkeep.level_met(switch, wait.level);
                    }
                    let limit = matches!(input, Input::LimitX | Input::LimitZ);
                    if limit && wait.awaited.until == Until::Operated {
                        self.motion.limits.hit(axis, stop.way[axis]);
                    }
                    self.events.push(Event::Reached(input, stop.kernel));
                }
                self.go_on();
            }
            Why::Late(detail) => {
                self.alarm(612, detail);
                self.enter(LinkState::Fault);
            }
            Why::TooFine => {
                let text = "the motion turns and bends more often than the board can be told: \
                            a lower feed, or longer blocks";
                self.alarm(604, text);
                self.enter(LinkState::Fault);
            }
            Why::Doubt => self.enter(LinkState::Fault),
            Why::Trip(_) => self.enter(LinkState::Tripped),
        }
    }
}

/// Whether the group was triggered by an input that was waited for.
const fn is_reached(reason: u32) -> bool {
    matches!(reason, REACHED | REACHED_Z)
}
