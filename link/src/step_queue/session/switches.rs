//! Queries switches and contacts of the board in turn, and keeps their levels.

use core::time::Duration;

use super::StepLink;
use crate::step_queue::commands::Command;
use crate::step_queue::wiring::{Switch, Wiring};
use crate::{HostTime, Input, LinkState};

/// Interval of switch queries while the axes are at standstill.
const SWITCH_EVERY: Duration = Duration::from_millis(10);
/// Interval of switch queries while the axes move.
const SWITCH_MOVING: Duration = Duration::from_millis(40);
/// Interval of queries for the contacts of the control that are wired to the board.
const CONTACT_EVERY: Duration = Duration::from_millis(20);

/// A schedule that queries several pins in turn, one at each due time.
#[derive(Clone, Copy, Debug, Default)]
struct Round {
    next: usize,
    due: HostTime,
}

impl Round {
    /// Returns the index of the pin, of `count` pins, whose query is due at the host time `now`,
    /// and sets the next due time `every` later; `None` if none is due.
    fn turn(&mut self, count: usize, every: Duration, now: HostTime) -> Option<usize> {
        if now < self.due || count == 0 {
            return None;
        }
        self.due = now + every;
        self.next = (self.next + 1) % count;
        Some(self.next)
    }
}

/// The reported states of the switches, and the schedules of their queries.
#[derive(Clone, Debug, Default)]
pub(super) struct Switches {
    levels: Vec<(Input, bool)>,
    of_axes: Round,
    contacts: Round,
}

impl Switches {
    pub(super) fn input(&self, input: Input) -> Option<bool> {
        let level = self.levels.iter().find(|(known, _)| *known == input);
        level.map(|(_, operated)| *operated)
    }

    /// Whether the board has reported the levels of all wired switches.
    pub(super) fn all_reported(&self, wiring: Option<&Wiring>) -> bool {
        wiring.is_some_and(|wiring| wiring.switches.len() == self.levels.len())
    }

    pub(super) fn report(&mut self, wiring: Option<&Wiring>, oid: i64, level: u32) {
        let mut switches = wiring.iter().flat_map(|wiring| &wiring.switches);
        let Some(switch) = switches.find(|switch| switch.oid == oid) else {
            return;
        };
        let operated = i64::from(level != 0) == switch.level;
        match self
            .levels
            .iter_mut()
            .find(|(input, _)| *input == switch.input)
        {
            Some((_, level)) => *level = operated,
            None => self.levels.push((switch.input, operated)),
        }
    }

    /// Stores the level, 0 or 1, at which the pin of a switch has stopped the axes.
    pub(super) fn level_met(&mut self, switch: Switch, level: i64) {
        let levels = self.levels.iter_mut();
        for (_, operated) in levels.filter(|(input, _)| *input == switch.input) {
            *operated = level == switch.level;
        }
    }
}

impl StepLink {
    pub(super) fn query_switch(&mut self) {
        let Some(wiring) = &self.wiring else {
            return;
        };
        // The contacts of the control follow the switches of the axes.
        let is_contact = |switch: &Switch| matches!(switch.input, Input::Contact { .. });
        let (of_axes, contacts) = wiring.switches.split_at(
            wiring
                .switches
                .partition_point(|switch| !is_contact(switch)),
        );
        let moving = self.session.state == LinkState::Moving;
        if moving && self.wire.send_queue.is_congested() {
            return;
        }
        let now = self.session.now;
        let every = if moving { SWITCH_MOVING } else { SWITCH_EVERY };
        let rounds = &mut self.periodic.switches;
        let due_oids = [
            (rounds.of_axes.turn(of_axes.len(), every, now)).map(|next| of_axes[next].oid),
            (rounds.contacts.turn(contacts.len(), CONTACT_EVERY, now))
                .map(|next| contacts[next].oid),
        ];
        for oid in due_oids.into_iter().flatten() {
            self.wire.send(Command::EndstopQueryState, &[oid]);
        }
    }
}
