//! Homing as FluidNC does it: by cycles, the axes of a cycle together.
//!
//! ```text
//!   ◄─ pulloff ─ switch operated at the beginning
//!   seek ──────────────────────►|switch    at most seek_scaler x max_travel, or ALARM:9
//!               ◄─ pulloff ─────|          still operated: ALARM:8
//!        feed   ───────────────►|          at most feed_scaler x pulloff, or ALARM:9
//!               ◄─ pulloff ─────|          homing_runs times; here the place is set
//! ```
//!
//! After an alarm the command is answered `ok` all the same.

use std::collections::VecDeque;

use super::super::{GrblTwin, State};
use super::{Event, MS};

/// Axes of the board and their names in the configuration.
const AXES: [(usize, &str, char); 2] = [(0, "axes/x", 'X'), (2, "axes/z", 'Z')];
/// From the end of a way off the switch until the switch is looked at.
const LOOKS_NS: u64 = 10 * MS;
/// The highest number of a cycle.
const CYCLES: i64 = 6;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Off a switch that is operated at the beginning.
    Clear,
    Seek,
    Off,
    Feed,
    OffAgain,
}

impl Phase {
    const fn approaches(self) -> bool {
        matches!(self, Self::Seek | Self::Feed)
    }
}

/// The way of one axis in a phase.
#[derive(Clone, Copy, Debug)]
struct Leg {
    /// mm, with sign.
    way: f64,
    /// mm/s.
    rate: f64,
    /// Pulses/mm.
    scale: f64,
    done: f64,
    made: i64,
}

/// Homing under way.
#[derive(Clone, Debug)]
pub(super) struct Cycle {
    /// The count when homing began.
    from: [i64; 3],
    /// Cycles to come, the axes of each.
    next: VecDeque<[bool; 2]>,
    axes: [bool; 2],
    phase: Phase,
    runs: u32,
    legs: [Option<Leg>; 2],
    /// The way off the switch is made; it is looked at then.
    looks_at: Option<u64>,
}

impl GrblTwin {
    fn homing_item(&self, axis: usize, item: &str) -> f64 {
        self.number(&format!("{}/homing/{item}", AXES[axis].1))
    }

    fn cycle_of(&self, axis: usize) -> Option<i64> {
        let path = format!("{}/homing/cycle", AXES[axis].1);
        self.item(&path)?.parse().ok()
    }

    /// `$H`, or one axis; None where it is answered later.
    pub(super) fn begin_cycles(&mut self, only: Option<usize>) -> Option<Result<(), u8>> {
        if self.fluid.seen[2] {
            return Some(Err(40));
        }
        if let Some(axis) = only
            && !self.is_set(&format!("{}/homing/allow_single_axis", AXES[axis].1))
        {
            return Some(Err(19));
        }
        if self.fluid.start.homing == [false; 2] {
            return Some(Err(5));
        }
        self.fluid.homes = true;
        if self.is_ambiguous() {
            self.say("[MSG:ERR: A switch of both ends is operated]\r\n");
            self.state = State::Alarm;
            self.put(Event::Alarm(12));
            return None;
        }
        let mut next = VecDeque::new();
        for (axis, (number, ..)) in AXES.into_iter().enumerate() {
            if self.cycle_of(axis) == Some(-1) && only.is_none_or(|only| only == axis) {
                let before = self.position[number];
                self.set_place(axis);
                self.fluid.astray[number] += before - self.position[number];
                if only.is_some() {
                    return None;
                }
            }
        }
        match only {
            Some(axis) => next.push_back([axis == 0, axis == 1]),
            None => {
                let cycles =
                    (1..=CYCLES).map(|cycle| [0, 1].map(|axis| self.cycle_of(axis) == Some(cycle)));
                next.extend(cycles.filter(|axes| *axes != [false; 2]));
            }
        }
        if next.is_empty() {
            self.say("[MSG:ERR: No homing cycles defined]\r\n");
            self.state = State::Alarm;
            return None;
        }
        self.state = State::Home;
        self.next_cycle(self.position, next);
        None
    }

    /// A switch wired to both ends does not tell from which one it is to be left.
    fn is_ambiguous(&self) -> bool {
        let all = |axis: usize| {
            let path = format!("{}/motor0/limit_all_pin", AXES[axis].1);
            self.settings
                .tree()
                .is_some_and(|tree| tree.is_wired(&path))
        };
        (0..2).any(|axis| self.fluid.seen[axis] && all(axis))
    }

    fn next_cycle(&mut self, from: [i64; 3], mut next: VecDeque<[bool; 2]>) {
        let Some(wanted) = next.pop_front() else {
            self.fluid.cycle = None;
            self.fluid.astray = [0; 3];
            self.modal.position = self.millimetres();
            self.state = if self.fluid.unhomed == [false; 2] {
                State::Idle
            } else {
                State::Alarm
            };
            return;
        };
        let start = &self.fluid.start;
        let axes = [0, 1].map(|axis| wanted[axis] && start.homing[axis]);
        let blind = (0..2).any(|axis| axes[axis] && !start.limit[axis]);
        self.fluid.cycle = Some(Cycle {
            from,
            next,
            axes,
            phase: Phase::Clear,
            runs: self.number("axes/homing_runs") as u32,
            legs: [None; 2],
            looks_at: None,
        });
        if blind {
            self.say("[MSG:ERR: An axis without limit switch cannot be homed]\r\n");
            return self.fail(9);
        }
        let operated = (0..2).any(|axis| axes[axis] && self.fluid.seen[axis]);
        self.begin_phase(if operated { Phase::Clear } else { Phase::Seek });
    }

    fn begin_phase(&mut self, phase: Phase) {
        let Some(mut cycle) = self.fluid.cycle.take() else {
            return;
        };
        // The longest search gives the way of all.
        let longest = (0..2)
            .filter(|axis| cycle.axes[*axis])
            .map(|axis| {
                self.settings.axes(130)[AXES[axis].0] / self.homing_item(axis, "seek_mm_per_min")
            })
            .fold(0.0, f64::max);
        let scale = self.settings.axes(100);
        cycle.phase = phase;
        cycle.looks_at = None;
        for axis in 0..2 {
            cycle.legs[axis] = None;
            if !cycle.axes[axis] {
                continue;
            }
            self.fluid.limited[axis] = false;
            let (_, name, _) = AXES[axis];
            let pull_off = self.number(&format!("{name}/motor0/pulloff_mm"));
            let positive = self.is_set(&format!("{name}/homing/positive_direction"));
            let feed = self.homing_item(axis, "feed_mm_per_min");
            let seek = self.homing_item(axis, "seek_mm_per_min");
            let towards = if positive { 1.0 } else { -1.0 };
            let off = if self.fluid.start.positive[axis] {
                -1.0
            } else {
                1.0
            };
            let (way, rate) = match phase {
                Phase::Clear if !self.fluid.seen[axis] => continue,
                Phase::Clear => (off * pull_off, feed),
                Phase::Seek => {
                    let scaler = self.homing_item(axis, "seek_scaler");
                    (towards * longest * seek * scaler, seek)
                }
                Phase::Feed => {
                    let scaler = self.homing_item(axis, "feed_scaler");
                    (towards * pull_off * scaler, feed)
                }
                Phase::Off | Phase::OffAgain => (-towards * pull_off, feed),
            };
            cycle.legs[axis] = Some(Leg {
                way,
                rate: rate / 60.0,
                scale: scale[AXES[axis].0],
                done: 0.0,
                made: 0,
            });
        }
        self.fluid.cycle = Some(cycle);
    }

    /// A step of the search.
    pub(super) fn home_cycle(&mut self, seconds: f64) {
        let Some(mut cycle) = self.fluid.cycle.take() else {
            return;
        };
        let mut missed = false;
        for (leg_of, (number, ..)) in cycle.legs.iter_mut().zip(AXES) {
            let Some(leg) = leg_of else {
                continue;
            };
            leg.done = (leg.done + leg.rate * seconds).min(leg.way.abs());
            let due = (leg.done * leg.way.signum() * leg.scale).round() as i64;
            let count = due - leg.made;
            leg.made = due;
            self.count(number, count);
            if leg.done >= leg.way.abs() {
                *leg_of = None;
                missed |= cycle.phase.approaches();
            }
        }
        let stands = cycle.legs.iter().all(Option::is_none);
        let (phase, axes) = (cycle.phase, cycle.axes);
        if stands && !missed && cycle.looks_at.is_none() {
            let wait = if phase.approaches() { 0 } else { LOOKS_NS };
            cycle.looks_at = Some(self.now + wait);
        }
        let looks_at = cycle.looks_at;
        self.fluid.cycle = Some(cycle);
        if missed {
            // It reports itself unasked.
            let text = self.report();
            self.fail(9);
            return self.say(&text);
        }
        if looks_at.is_none_or(|at| self.now < at) {
            return;
        }
        let on_switch = (0..2).any(|axis| axes[axis] && self.fluid.seen[axis]);
        if !phase.approaches() && on_switch {
            return self.fail(8);
        }
        self.next_phase(phase, axes);
    }

    fn next_phase(&mut self, phase: Phase, axes: [bool; 2]) {
        let settle = (0..2)
            .filter(|axis| axes[*axis])
            .map(|axis| self.homing_item(axis, "settle_ms"))
            .fold(0.0, f64::max);
        self.fluid.blocked_until = self.now + settle as u64 * MS;
        let Some(cycle) = &mut self.fluid.cycle else {
            return;
        };
        let phase = match phase {
            Phase::Clear => Some(Phase::Seek),
            Phase::Seek => Some(Phase::Off),
            Phase::Off if cycle.runs <= 1 => None,
            Phase::Off => Some(Phase::Feed),
            Phase::Feed => Some(Phase::OffAgain),
            Phase::OffAgain => {
                cycle.runs -= 1;
                (cycle.runs > 1).then_some(Phase::Feed)
            }
        };
        if let Some(phase) = phase {
            return self.begin_phase(phase);
        }
        let from = cycle.from;
        let next = core::mem::take(&mut cycle.next);
        let mut names = String::new();
        for axis in 0..2 {
            if axes[axis] {
                self.set_place(axis);
                self.fluid.unhomed[axis] = false;
                names.push(AXES[axis].2);
            }
        }
        self.say(&format!("[MSG:Homed:{names}]\r\n"));
        self.next_cycle(from, next);
    }

    fn set_place(&mut self, axis: usize) {
        let (number, ..) = AXES[axis];
        let place = self.homing_item(axis, "mpos_mm") * self.settings.axes(100)[number];
        self.position[number] = place.round() as i64;
        self.miscounted[number] = 0;
    }

    /// The pulses stop; the command is answered when the alarm has had its time.
    fn fail(&mut self, number: u8) {
        if let Some(cycle) = self.fluid.cycle.take() {
            for (axis, from) in cycle.from.into_iter().enumerate() {
                self.fluid.astray[axis] += from - self.position[axis];
            }
        }
        self.put(Event::Alarm(number));
    }

    /// An edge into a switch.
    pub(super) fn limit_while_homing(&mut self, axis: usize) {
        let Some(cycle) = &mut self.fluid.cycle else {
            return;
        };
        if cycle.phase.approaches() {
            self.fluid.limited[axis] = true;
            cycle.legs[axis] = None;
        }
    }
}
