//! What is renewed all the time: clock, heartbeat, enable of the drives, inputs.

use core::time::Duration;

use super::super::super::{
    BoardOutputs, HostTime, Input, LinkState, Output, Refused, RunTime, SpindleWay,
};
use super::super::commands::Command;
use super::super::delivery::{Mark, Message};
use super::super::wiring::{Drain, Switch, Wiring};
use super::StepLink;

/// Between two questions for the clock; while it is being learned.
const CLOCK_EVERY: Duration = Duration::from_millis(500);
const CLOCK_FIRST: Duration = Duration::from_millis(50);
/// Between two questions whether the board is still set up.
const CONFIG_EVERY: Duration = Duration::from_secs(1);
/// The stop group is renewed so often, for so long.
const HEARTBEAT_EVERY: Duration = Duration::from_millis(50);
const HEARTBEAT_LASTS: Duration = Duration::from_millis(250);
/// The enable of the drives is renewed so often.
const ENABLE_EVERY: Duration = Duration::from_millis(100);
/// Between two moments of the enable lies no more than this; the board lets 500 ms pass.
const ENABLE_APART: Duration = Duration::from_millis(400);
/// What an earlier host did not renew has its effect within this.
const INHERITED: Duration = Duration::from_millis(800);
/// Between two questions for a switch, standing and moving.
const SWITCH_EVERY: Duration = Duration::from_millis(10);
const SWITCH_MOVING: Duration = Duration::from_millis(40);
/// Between two questions for a contact of the control.
const CONTACT_EVERY: Duration = Duration::from_millis(20);
/// Another spindle speed is told at most so often: under G96 it changes every tick.
const SPEED_EVERY: Duration = Duration::from_millis(20);
/// An output is told so long before nothing is sure to arrive in time any more.
const AHEAD: Duration = Duration::from_millis(30);
/// Full spindle voltage, mV.
const FULL_MV: i64 = 10_000;

/// State of what is renewed.
#[derive(Clone, Debug, Default)]
pub(super) struct Upkeep {
    pub(super) drives_on: bool,
    /// Until then a shutdown may be the fault of an earlier host.
    pub(super) inherited_until: HostTime,
    /// What the enable pin was last told, and for when.
    enabled: bool,
    enabled_at: u64,
    clock_asked: Option<HostTime>,
    clock_due: HostTime,
    config_due: HostTime,
    heartbeat_due: HostTime,
    enable_due: HostTime,
    switch_due: HostTime,
    next_switch: usize,
    contact_due: HostTime,
    next_contact: usize,
    switches: Vec<(Input, bool)>,
    /// What spindle and coolant are to do, and what the board was told.
    wanted: BoardOutputs,
    told: BoardOutputs,
    /// Motion and host time at which it was last told a speed.
    speed_told: (RunTime, HostTime),
    /// What each output was last told, and for when.
    outputs: Vec<(Drain, i64, u64)>,
}

impl Upkeep {
    pub(super) fn input(&self, input: Input) -> Option<bool> {
        let told = self.switches.iter().find(|(told, _)| *told == input);
        told.map(|(_, operated)| *operated)
    }

    /// Whether every switch was told once.
    pub(super) fn all_told(&self, wiring: Option<&Wiring>) -> bool {
        wiring.is_some_and(|wiring| wiring.switches.len() == self.switches.len())
    }

    pub(super) fn switch_told(&mut self, wiring: Option<&Wiring>, oid: i64, level: u32) {
        let mut switches = wiring.iter().flat_map(|wiring| &wiring.switches);
        let Some(switch) = switches.find(|switch| switch.oid == oid) else {
            return;
        };
        let operated = i64::from(level != 0) == switch.level;
        match self
            .switches
            .iter_mut()
            .find(|(input, _)| *input == switch.input)
        {
            Some((_, told)) => *told = operated,
            None => self.switches.push((switch.input, operated)),
        }
    }

    /// The board was stopped by a pin that came to this level.
    pub(super) fn level_met(&mut self, switch: Switch, level: i64) {
        let told = self.switches.iter_mut();
        for (_, operated) in told.filter(|(input, _)| *input == switch.input) {
            *operated = level == switch.level;
        }
    }
}

impl StepLink {
    pub(super) fn ask_clock(&mut self) {
        let lost = |asked: HostTime| self.now.saturating_sub(asked) >= CLOCK_EVERY;
        if self.upkeep.clock_asked.is_some_and(|asked| !lost(asked))
            || self.now < self.upkeep.clock_due
        {
            return;
        }
        self.upkeep.clock_asked = Some(self.now);
        let every = if self.is_running() {
            CLOCK_EVERY
        } else {
            CLOCK_FIRST
        };
        self.upkeep.clock_due = self.now + every;
        self.say_marked(Command::GetUptime, &[], Mark::Uptime);
    }

    pub(super) fn uptime(&mut self, numbers: [u32; 4]) {
        let Some(asked) = self.upkeep.clock_asked.take() else {
            return;
        };
        let clock = u64::from(numbers[0]) << 32 | u64::from(numbers[1]);
        self.traffic.reports += 1;
        self.traffic.round_trip = Some(self.now.saturating_sub(asked));
        if self.is_running() && clock < self.clock.at(asked.saturating_sub(CLOCK_EVERY)) {
            self.board_restarted();
            return;
        }
        self.clock.hear(asked, self.now, clock);
    }

    /// Everything whose time has come.
    pub(super) fn keep_up(&mut self) {
        self.ask_clock();
        if self.now >= self.upkeep.config_due {
            self.upkeep.config_due = self.now + CONFIG_EVERY;
            self.say_marked(Command::GetConfig, &[], Mark::Config);
        }
        if let Some(oid) = self.group.armed_oid(self.wiring.as_ref())
            && self.now >= self.upkeep.heartbeat_due
        {
            self.upkeep.heartbeat_due = self.now + HEARTBEAT_EVERY;
            let until = self.clock.at(self.now + HEARTBEAT_LASTS);
            self.delivery.say_first(Message {
                due: Some(until),
                ..Message::plain(
                    self.dictionary
                        .message(Command::TrsyncSetTimeout, &[oid, i64::from(until as u32)]),
                )
            });
        }
        self.keep_enabled();
        self.ask_switch();
        self.tell_wanted();
    }

    /// What spindle and coolant are to do: it is switched where the motion handed over
    /// so far ends.
    pub fn set_outputs(&mut self, outputs: BoardOutputs) {
        self.upkeep.wanted = outputs;
        if self.tell_wanted() {
            // At once: when the host looks at its port again it may be too late.
            self.send();
        }
    }

    /// What the board was told; orders do not wait for a standstill.
    pub const fn switched(&self) -> Option<BoardOutputs> {
        Some(self.upkeep.told)
    }

    /// Whether there was something to tell.
    fn tell_wanted(&mut self) -> bool {
        let (mut wanted, told) = (self.upkeep.wanted, self.upkeep.told);
        if wanted == told || !self.is_running() || self.down || self.state == LinkState::Lost {
            return false;
        }
        let at = self.motion.newest_end();
        let (run, host) = self.upkeep.speed_told;
        let soon =
            at.saturating_sub(run) < SPEED_EVERY && self.now.saturating_sub(host) < SPEED_EVERY;
        if wanted.spindle == told.spindle && soon {
            wanted.millivolts = told.millivolts;
        } else if wanted.millivolts != told.millivolts {
            self.upkeep.speed_told = (at, self.now);
        }
        let turns = |way| i32::from(wanted.spindle == way);
        // What is not wired stays simulated.
        for (output, value) in [
            (Output::SpindleForward, turns(SpindleWay::Forward)),
            (Output::SpindleReverse, turns(SpindleWay::Reverse)),
            (Output::SpindleSpeed, wanted.millivolts.into()),
            (Output::Coolant, wanted.coolant.into()),
        ] {
            let _ = self.output(at, output, value);
        }
        self.upkeep.told = wanted;
        true
    }

    fn keep_enabled(&mut self) {
        let Some(enable) = self.wiring.as_ref().map(|wiring| wiring.enable) else {
            return;
        };
        let on = self.upkeep.drives_on;
        let renew = on && self.now >= self.upkeep.enable_due;
        if !renew && on == self.upkeep.enabled {
            return;
        }
        let mut at = self.soon();
        if renew && self.upkeep.enabled {
            // However long the host was away: before the board gives up, if that is still
            // to be had.
            let latest = self.upkeep.enabled_at + self.clock.ticks(ENABLE_APART);
            at = at.min(latest.max(self.earliest()));
        }
        let at = at.max(self.upkeep.enabled_at + 1);
        self.upkeep.enable_due = self.now + ENABLE_EVERY;
        self.upkeep.enabled = on;
        self.upkeep.enabled_at = at;
        let value = i64::from(on != enable.inverted);
        self.delivery.say_first(Message {
            due: Some(at),
            ..Message::plain(self.dictionary.message(
                Command::QueueDigitalOut,
                &[enable.oid, i64::from(at as u32), value],
            ))
        });
    }

    /// What an earlier host has left switched on: the drives lose their enable, the
    /// stop groups let go of the axes.
    pub(super) fn take_over_outputs(&mut self) {
        self.upkeep.enabled = true;
        self.upkeep.inherited_until = self.now + INHERITED;
        let groups = self.wiring.as_ref().map(|wiring| wiring.groups);
        for oid in groups.into_iter().flatten() {
            self.say(Command::TrsyncTrigger, &[oid, 0]);
        }
    }

    fn ask_switch(&mut self) {
        let Some(wiring) = &self.wiring else {
            return;
        };
        // The contacts of the control stand behind the switches of the axes.
        let is_contact = |switch: &Switch| matches!(switch.input, Input::Contact { .. });
        let (switches, contacts) = wiring.switches.split_at(
            wiring
                .switches
                .partition_point(|switch| !is_contact(switch)),
        );
        let mut asked = [None; 2];
        let moving = self.state == LinkState::Moving;
        let waits = moving && self.delivery.is_congested();
        if self.now >= self.upkeep.switch_due && !switches.is_empty() && !waits {
            self.upkeep.switch_due = self.now + if moving { SWITCH_MOVING } else { SWITCH_EVERY };
            self.upkeep.next_switch = (self.upkeep.next_switch + 1) % switches.len();
            asked[0] = Some(switches[self.upkeep.next_switch].oid);
        }
        if self.now >= self.upkeep.contact_due && !contacts.is_empty() && !waits {
            self.upkeep.contact_due = self.now + CONTACT_EVERY;
            self.upkeep.next_contact = (self.upkeep.next_contact + 1) % contacts.len();
            asked[1] = Some(contacts[self.upkeep.next_contact].oid);
        }
        for oid in asked.into_iter().flatten() {
            self.say(Command::EndstopQueryState, &[oid]);
        }
    }

    /// Switches an output when the motion up to a time has been made.
    ///
    /// # Errors
    /// The board is not ready, or the output is not wired.
    pub fn output(&mut self, at: RunTime, output: Output, value: i32) -> Result<(), Refused> {
        if !self.is_running() || self.down || self.state == LinkState::Lost {
            return Err(Refused::NotReady);
        }
        let wiring = self.wiring.as_ref().ok_or(Refused::NotReady)?;
        let drain = wiring.outputs.iter().find(|drain| drain.output == output);
        let (drain, full) = (*drain.ok_or(Refused::NotWired)?, i64::from(wiring.full));
        let value = if output == Output::SpindleSpeed {
            let part = i64::from(value).clamp(0, FULL_MV) * full / FULL_MV;
            if drain.inverted { full - part } else { part }
        } else {
            i64::from((value != 0) != drain.inverted)
        };
        let told = self.upkeep.outputs.iter();
        if told.copied().any(|told| (told.0, told.1) == (drain, value)) {
            return Ok(());
        }
        let made = self.motion.piece_at(at).map_or(0, |piece| {
            let rest = at.saturating_sub(piece.sample.end);
            piece.clock.unsigned_abs() + self.clock.ticks(rest)
        });
        let earliest = self.clock.at(self.now + self.margin() + AHEAD);
        self.switch(drain, value, made.max(earliest));
        Ok(())
    }

    fn switch(&mut self, drain: Drain, value: i64, clock: u64) {
        let told = self
            .upkeep
            .outputs
            .iter_mut()
            .find(|(told, ..)| *told == drain);
        let clock = match told {
            Some(told) => {
                let clock = clock.max(told.2 + 1);
                *told = (drain, value, clock);
                clock
            }
            None => {
                self.upkeep.outputs.push((drain, value, clock));
                clock
            }
        };
        let command = if drain.output == Output::SpindleSpeed {
            Command::QueuePwmOut
        } else {
            Command::QueueDigitalOut
        };
        self.say_timed(command, &[drain.oid, i64::from(clock as u32), value], clock);
    }

    /// Behind a stop: what was told before may not have arrived.
    pub(super) fn tell_outputs_again(&mut self) {
        let soon = self.soon();
        for (drain, value, _) in self.upkeep.outputs.clone() {
            self.switch(drain, value, soon);
        }
    }
}
