//! Homing of FluidNC: in cycles; the axes of a cycle move together.
//!
//! ```text
//!   ◄─ pulloff ─ switch operated at the start
//!   seek ──────────────────────►|switch    at most seek_scaler x max_travel, or ALARM:9
//!               ◄─ pulloff ─────|          still operated: ALARM:8
//!        feed   ───────────────►|          at most feed_scaler x pulloff, or ALARM:9
//!               ◄─ pulloff ─────|          homing_runs times; here the position is set
//! ```
//!
//! The command is answered `ok` even after an alarm.

use std::collections::VecDeque;

use super::super::{GrblState, GrblTwin};
use super::{FluidEvent, MS};

/// Index on the board, configuration path and letter of the axes X and Z.
const AXES: [(usize, &str, char); 2] = [(0, "axes/x", 'X'), (2, "axes/z", 'Z')];
/// Delay from the end of a pull-off to the check of the switch, ns.
const SWITCH_CHECK_DELAY_NS: u64 = 10 * MS;
/// Greatest number of a homing cycle in the configuration.
const MAX_CYCLE: i64 = 6;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum HomingPhase {
    /// The axis moves off a switch that is operated at the start of homing.
    Clear,
    Seek,
    PullOffAfterSeek,
    Feed,
    PullOffAfterFeed,
}

impl HomingPhase {
    const fn is_approach(self) -> bool {
        matches!(self, Self::Seek | Self::Feed)
    }
}

/// The move of one axis in a homing phase.
#[derive(Clone, Copy, Debug)]
struct AxisMove {
    /// Distance of the move with its sign, mm.
    distance_mm: f64,
    /// Speed of the move, mm/s.
    rate_mm_per_s: f64,
    /// Number of pulses of the axis per mm.
    pulses_per_mm: f64,
    travelled_mm: f64,
    pulses_made: i64,
}

/// The state of the homing cycle that the board executes.
#[derive(Clone, Debug)]
pub(super) struct HomingCycle {
    /// Position of X, Y, Z at the start of homing, pulses.
    start_position: [i64; 3],
    /// Which of X and Z the following cycles home, a pair for each cycle.
    next: VecDeque<[bool; 2]>,
    axes: [bool; 2],
    phase: HomingPhase,
    runs: u32,
    moves: [Option<AxisMove>; 2],
    /// Time at which the switch is checked after a pull-off, ns; `None` if no check is due.
    check_switch_at: Option<u64>,
}

impl GrblTwin {
    fn homing_item(&self, axis: usize, item: &str) -> f64 {
        self.config_number(&format!("{}/homing/{item}", AXES[axis].1))
    }

    fn homing_cycle_number(&self, axis: usize) -> Option<i64> {
        let path = format!("{}/homing/cycle", AXES[axis].1);
        self.config_item(&path)?.parse().ok()
    }

    /// Starts homing of axis `only` (0 for X, 1 for Z) or of all axes. Returns the error
    /// number, or `None` if the command is answered later.
    pub(super) fn start_homing(&mut self, only: Option<usize>) -> Option<Result<(), u8>> {
        if self.fluid.known_inputs[2] {
            return Some(Err(40));
        }
        if let Some(axis) = only
            && !self.is_config_on(&format!("{}/homing/allow_single_axis", AXES[axis].1))
        {
            return Some(Err(19));
        }
        if self.fluid.start.homing == [false; 2] {
            return Some(Err(5));
        }
        self.fluid.is_homing = true;
        if self.is_ambiguous() {
            self.send_text("[MSG:ERR: A switch of both ends is operated]\r\n");
            self.state = GrblState::Alarm;
            self.push_event(FluidEvent::Alarm(12));
            return None;
        }
        let mut next = VecDeque::new();
        for (axis, (number, ..)) in AXES.into_iter().enumerate() {
            if self.homing_cycle_number(axis) == Some(-1) && only.is_none_or(|only| only == axis) {
                let before = self.position[number];
                self.set_homed_position(axis);
                self.fluid.planner_error[number] += before - self.position[number];
                if only.is_some() {
                    return None;
                }
            }
        }
        match only {
            Some(axis) => next.push_back([axis == 0, axis == 1]),
            None => {
                let cycles = (1..=MAX_CYCLE)
                    .map(|cycle| [0, 1].map(|axis| self.homing_cycle_number(axis) == Some(cycle)));
                next.extend(cycles.filter(|axes| *axes != [false; 2]));
            }
        }
        if next.is_empty() {
            self.send_text("[MSG:ERR: No homing cycles defined]\r\n");
            self.state = GrblState::Alarm;
            return None;
        }
        self.state = GrblState::Home;
        self.start_next_cycle(self.position, next);
        None
    }

    /// Returns whether a switch that serves both ends is operated, so that the direction away
    /// from it is unknown.
    fn is_ambiguous(&self) -> bool {
        let all = |axis: usize| {
            let path = format!("{}/motor0/limit_all_pin", AXES[axis].1);
            self.settings
                .tree()
                .is_some_and(|tree| tree.is_wired(&path))
        };
        (0..2).any(|axis| self.fluid.known_inputs[axis] && all(axis))
    }

    fn start_next_cycle(&mut self, from: [i64; 3], mut next: VecDeque<[bool; 2]>) {
        let Some(wanted) = next.pop_front() else {
            self.fluid.cycle = None;
            self.fluid.planner_error = [0; 3];
            self.modal.position = self.position_mm();
            self.state = if self.fluid.unhomed == [false; 2] {
                GrblState::Idle
            } else {
                GrblState::Alarm
            };
            return;
        };
        let start = &self.fluid.start;
        let axes = [0, 1].map(|axis| wanted[axis] && start.homing[axis]);
        let blind = (0..2).any(|axis| axes[axis] && !start.limit[axis]);
        self.fluid.cycle = Some(HomingCycle {
            start_position: from,
            next,
            axes,
            phase: HomingPhase::Clear,
            runs: self.config_number("axes/homing_runs") as u32,
            moves: [None; 2],
            check_switch_at: None,
        });
        if blind {
            self.send_text("[MSG:ERR: An axis without limit switch cannot be homed]\r\n");
            return self.fail_cycle(9);
        }
        let operated = (0..2).any(|axis| axes[axis] && self.fluid.known_inputs[axis]);
        self.start_phase(if operated {
            HomingPhase::Clear
        } else {
            HomingPhase::Seek
        });
    }

    fn start_phase(&mut self, phase: HomingPhase) {
        let Some(mut cycle) = self.fluid.cycle.take() else {
            return;
        };
        // The longest seek sets the distance of all axes.
        let longest = (0..2)
            .filter(|axis| cycle.axes[*axis])
            .map(|axis| {
                self.settings.axis_values(130)[AXES[axis].0]
                    / self.homing_item(axis, "seek_mm_per_min")
            })
            .fold(0.0, f64::max);
        let scale = self.settings.axis_values(100);
        cycle.phase = phase;
        cycle.check_switch_at = None;
        for axis in 0..2 {
            cycle.moves[axis] = None;
            if !cycle.axes[axis] {
                continue;
            }
            self.fluid.blocked_motors[axis] = false;
            let (_, name, _) = AXES[axis];
            let pull_off = self.config_number(&format!("{name}/motor0/pulloff_mm"));
            let positive = self.is_config_on(&format!("{name}/homing/positive_direction"));
            let feed = self.homing_item(axis, "feed_mm_per_min");
            let seek = self.homing_item(axis, "seek_mm_per_min");
            let towards = if positive { 1.0 } else { -1.0 };
            let off = if self.fluid.start.positive[axis] {
                -1.0
            } else {
                1.0
            };
            let (distance_mm, rate) = match phase {
                HomingPhase::Clear if !self.fluid.known_inputs[axis] => continue,
                HomingPhase::Clear => (off * pull_off, feed),
                HomingPhase::Seek => {
                    let scaler = self.homing_item(axis, "seek_scaler");
                    (towards * longest * seek * scaler, seek)
                }
                HomingPhase::Feed => {
                    let scaler = self.homing_item(axis, "feed_scaler");
                    (towards * pull_off * scaler, feed)
                }
                HomingPhase::PullOffAfterSeek | HomingPhase::PullOffAfterFeed => {
                    (-towards * pull_off, feed)
                }
            };
            cycle.moves[axis] = Some(AxisMove {
                distance_mm,
                rate_mm_per_s: rate / 60.0,
                pulses_per_mm: scale[AXES[axis].0],
                travelled_mm: 0.0,
                pulses_made: 0,
            });
        }
        self.fluid.cycle = Some(cycle);
    }

    /// Advances homing by a time step of `seconds`.
    pub(super) fn advance_homing_cycle(&mut self, seconds: f64) {
        let Some(mut cycle) = self.fluid.cycle.take() else {
            return;
        };
        let mut missed = false;
        for (move_slot, (number, ..)) in cycle.moves.iter_mut().zip(AXES) {
            let Some(axis_move) = move_slot else {
                continue;
            };
            axis_move.travelled_mm = (axis_move.travelled_mm + axis_move.rate_mm_per_s * seconds)
                .min(axis_move.distance_mm.abs());
            let due =
                (axis_move.travelled_mm * axis_move.distance_mm.signum() * axis_move.pulses_per_mm)
                    .round() as i64;
            let count = due - axis_move.pulses_made;
            axis_move.pulses_made = due;
            self.count_pulses(number, count);
            if axis_move.travelled_mm >= axis_move.distance_mm.abs() {
                *move_slot = None;
                missed |= cycle.phase.is_approach();
            }
        }
        let stands = cycle.moves.iter().all(Option::is_none);
        let (phase, axes) = (cycle.phase, cycle.axes);
        if stands && !missed && cycle.check_switch_at.is_none() {
            let wait = if phase.is_approach() {
                0
            } else {
                SWITCH_CHECK_DELAY_NS
            };
            cycle.check_switch_at = Some(self.now + wait);
        }
        let check_switch_at = cycle.check_switch_at;
        self.fluid.cycle = Some(cycle);
        if missed {
            // The board reports without a request.
            let text = self.status_report();
            self.fail_cycle(9);
            return self.send_text(&text);
        }
        if check_switch_at.is_none_or(|at| self.now < at) {
            return;
        }
        let on_switch = (0..2).any(|axis| axes[axis] && self.fluid.known_inputs[axis]);
        if !phase.is_approach() && on_switch {
            return self.fail_cycle(8);
        }
        self.finish_phase(phase, axes);
    }

    fn finish_phase(&mut self, phase: HomingPhase, axes: [bool; 2]) {
        let settle = (0..2)
            .filter(|axis| axes[*axis])
            .map(|axis| self.homing_item(axis, "settle_ms"))
            .fold(0.0, f64::max);
        self.fluid.blocked_until = self.now + settle as u64 * MS;
        let Some(cycle) = &mut self.fluid.cycle else {
            return;
        };
        let phase = match phase {
            HomingPhase::Clear => Some(HomingPhase::Seek),
            HomingPhase::Seek => Some(HomingPhase::PullOffAfterSeek),
            HomingPhase::PullOffAfterSeek if cycle.runs <= 1 => None,
            HomingPhase::PullOffAfterSeek => Some(HomingPhase::Feed),
            HomingPhase::Feed => Some(HomingPhase::PullOffAfterFeed),
            HomingPhase::PullOffAfterFeed => {
                cycle.runs -= 1;
                (cycle.runs > 1).then_some(HomingPhase::Feed)
            }
        };
        if let Some(phase) = phase {
            return self.start_phase(phase);
        }
        let from = cycle.start_position;
        let next = core::mem::take(&mut cycle.next);
        let mut names = String::new();
        for axis in 0..2 {
            if axes[axis] {
                self.set_homed_position(axis);
                self.fluid.unhomed[axis] = false;
                names.push(AXES[axis].2);
            }
        }
        self.send_text(&format!("[MSG:Homed:{names}]\r\n"));
        self.start_next_cycle(from, next);
    }

    fn set_homed_position(&mut self, axis: usize) {
        let (number, ..) = AXES[axis];
        let position = self.homing_item(axis, "mpos_mm") * self.settings.axis_values(100)[number];
        self.position[number] = position.round() as i64;
        self.position_error[number] = 0;
    }

    /// Ends homing with this alarm number. The command is answered after the delay of the
    /// alarm.
    fn fail_cycle(&mut self, number: u8) {
        if let Some(cycle) = self.fluid.cycle.take() {
            for (axis, from) in cycle.start_position.into_iter().enumerate() {
                self.fluid.planner_error[axis] += from - self.position[axis];
            }
        }
        self.push_event(FluidEvent::Alarm(number));
    }

    /// Stops an axis (0 for X, 1 for Z) at the edge of its switch.
    pub(super) fn stop_axis_at_switch(&mut self, axis: usize) {
        let Some(cycle) = &mut self.fluid.cycle else {
            return;
        };
        if cycle.phase.is_approach() {
            self.fluid.blocked_motors[axis] = true;
            cycle.moves[axis] = None;
        }
    }
}
