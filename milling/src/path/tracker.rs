//! Turns steps into moves with their duration, and adds up times, lengths and bounds.

use gsk_core::alarm::{Alarm, number};
use gsk_core::command::SourcePosition;
use gsk_core::units::Feed;
use gsk_messages::say;

use crate::axes::Axes;
use crate::memory::{MillMemory, parameter};
use crate::path::bounds::{MillBounds, MillPathLengths};
use crate::path::moves::{MillArc, MillMove, MillMoveKind};
use crate::path::time::MillRates;
use crate::space::{MillAxis, MillPosition};

/// A motion or dwell of a program, machine coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PathStep {
    pub(crate) source: SourcePosition,
    pub(crate) kind: MillMoveKind,
    pub(crate) to: MillPosition,
    pub(crate) arc: Option<MillArc>,
    pub(crate) feed: Option<Feed>,
    /// Work zero in force, machine coordinates, without the length offset.
    pub(crate) zero: MillPosition,
    pub(crate) frame: MillPosition,
    pub(crate) tool: u16,
    /// Spindle speed that a feed per revolution refers to, r/min.
    pub(crate) speed: f64,
    /// Whether the axes stop at the end of the step.
    pub(crate) exact: bool,
    /// Whether a rigid tap moves out of the hole; `None` if the step is no rigid tap.
    pub(crate) rigid_out: Option<bool>,
    /// Duration of the dwell, s; 0 for a motion.
    pub(crate) dwell_s: f64,
}

/// Callback that receives each move of the preview.
pub(crate) type MoveCallback<'a> = dyn FnMut(&MillMove) + 'a;

/// Converts steps into moves, and adds up their times, lengths and bounds.
pub(crate) struct Tracker<'a> {
    rates: MillRates,
    axes: Axes,
    /// Negative and positive travel limits, machine coordinates; `None` if they do not act.
    travel: Option<(MillPosition, MillPosition)>,
    /// The axes whose travel limits act (012.1): all, or those that have returned to machine zero.
    limited: [bool; MillAxis::ALL.len()],
    pub(crate) machine: MillPosition,
    pub(crate) now: f64,
    pub(crate) cutting_s: f64,
    pub(crate) moves: u64,
    pub(crate) lengths: MillPathLengths,
    pub(crate) bounds: Option<MillBounds>,
    /// The last cut and the duration of a stop at its end, s; `None` if the last move was no
    /// cut. The next step determines whether the motion stops there.
    pending: Option<(MillMove, f64)>,
    /// The gear of the spindle, 0 to 3, if S selects it; the first one at power-on.
    gear: usize,
    /// The spindle speed of the last cut, r/min; `None` after a rapid or a dwell.
    cut_speed: Option<f64>,
    /// The direction in which each axis moved last: -1, 1, or 0 before its first move.
    directions: [i8; MillAxis::ALL.len()],
    on_move: &'a mut MoveCallback<'a>,
}

impl<'a> Tracker<'a> {
    pub(crate) fn new(
        memory: &MillMemory,
        start: MillPosition,
        on_move: &'a mut MoveCallback<'a>,
    ) -> Self {
        Self {
            rates: MillRates::from_memory(memory),
            axes: Axes::from_memory(memory),
            travel: (!memory.bit(parameter::LIMITS, 4)).then(|| {
                (
                    memory.point(parameter::TRAVEL_MINUS),
                    memory.point(parameter::TRAVEL_PLUS),
                )
            }),
            limited: [!memory.bit(parameter::MOTION, 1); MillAxis::ALL.len()],
            machine: start,
            now: 0.0,
            cutting_s: 0.0,
            moves: 0,
            lengths: MillPathLengths::default(),
            bounds: None,
            pending: None,
            gear: 0,
            cut_speed: None,
            directions: [0; MillAxis::ALL.len()],
            on_move,
        }
    }

    /// Converts a step into a move. Errors: the alarm of a travel limit.
    pub(crate) fn make(&mut self, step: &PathStep) -> Result<(), Alarm> {
        let turns = step.arc.is_some();
        if step.kind != MillMoveKind::Dwell && !turns && step.to == self.machine {
            return Ok(());
        }
        self.check_travel(step)?;
        self.change_gear(step);
        self.wait_for_spindle(step);
        self.take_up_backlash(step);
        let from = self.axes.wrapped(self.machine - step.frame);
        let mut made = MillMove {
            source: step.source,
            kind: step.kind,
            from,
            to: from + (step.to - self.machine),
            axes: self.axes,
            zero: step.zero,
            arc: step.arc.map(|arc| MillArc {
                center: arc.center - step.frame.flat(arc.plane),
                ..arc
            }),
            arrivals: None,
            feed: step.feed,
            start_s: self.now,
            duration_s: 0.0,
            tool: step.tool,
        };
        let length = made.length();
        let mut settling = 0.0;
        match step.kind {
            MillMoveKind::Rapid => {
                self.stop();
                made.start_s = self.now;
                let distance = step.to - self.machine;
                made.duration_s = self.rates.rapid(&distance);
                made.arrivals = self.rates.arrivals(&distance);
                self.lengths.rapid += length;
            }
            MillMoveKind::Dwell => {
                self.stop();
                made.start_s = self.now;
                made.duration_s = step.dwell_s;
            }
            _ => {
                let feed = match step.feed {
                    Some(Feed::PerMinute(feed)) => feed,
                    Some(Feed::PerRevolution(feed)) => feed * self.rates.turning(step.speed),
                    None => 0.0,
                };
                // The lead of a thread is along its longest axis.
                let distance = match step.kind {
                    MillMoveKind::Thread => made.longest_distance(),
                    _ => made.path_length(),
                };
                made.duration_s = distance / self.rates.cutting(feed);
                self.cutting_s += made.duration_s;
                settling = match (step.rigid_out, step.kind) {
                    (Some(out), _) => self.rates.tap_settling_s(out),
                    (None, MillMoveKind::Tap) => self.rates.flexible_tap_settling_s(feed),
                    (None, _) => self.rates.settling(feed, &(step.to - self.machine)),
                };
                *match step.kind {
                    MillMoveKind::Clockwise => &mut self.lengths.clockwise,
                    MillMoveKind::CounterClockwise => &mut self.lengths.counter_clockwise,
                    MillMoveKind::Tap => &mut self.lengths.tap,
                    MillMoveKind::Thread => &mut self.lengths.thread,
                    _ => &mut self.lengths.feed,
                } += length;
            }
        }
        self.now += made.duration_s;
        self.machine = self.axes.wrapped(step.to);
        self.moves += 1;
        if step.kind != MillMoveKind::Dwell {
            MillBounds::extend(&mut self.bounds, &made);
        }
        if matches!(step.kind, MillMoveKind::Rapid | MillMoveKind::Dwell) {
            (self.on_move)(&made);
        } else {
            if let Some((before, _)) = self.pending.replace((made, settling)) {
                (self.on_move)(&before);
            }
            if step.exact {
                self.stop();
            }
        }
        Ok(())
    }

    /// Notes that an axis has returned to machine zero: its travel limits act from now on.
    pub(crate) fn set_homed(&mut self, axis: MillAxis) {
        self.limited[axis as usize] = true;
    }

    /// Waits for the strobe of a gear change, if the speed of a step has another gear (3010).
    fn change_gear(&mut self, step: &PathStep) {
        let Some((gear, wait)) = self.rates.gear(step.speed) else {
            return;
        };
        if core::mem::replace(&mut self.gear, gear) != gear && wait > 0.0 {
            self.stop();
            self.now += wait;
        }
    }

    /// Waits at the first cut after a rapid or a dwell, and at a cut with another speed, until the
    /// speed of the spindle is checked (174.6, 3740).
    fn wait_for_spindle(&mut self, step: &PathStep) {
        if matches!(step.kind, MillMoveKind::Rapid | MillMoveKind::Dwell) {
            self.cut_speed = None;
            return;
        }
        let wait = self.rates.speed_check_s();
        if self.cut_speed.replace(step.speed) != Some(step.speed) && wait > 0.0 {
            self.stop();
            self.now += wait;
        }
    }

    /// Takes up the backlash of the axes that reverse, before the motion (034, 010, 011).
    fn take_up_backlash(&mut self, step: &PathStep) {
        if step.kind == MillMoveKind::Dwell {
            return;
        }
        let mut wait = 0.0;
        for (axis, last) in MillAxis::ALL.into_iter().zip(&mut self.directions) {
            let distance = (step.to.get(axis) - self.machine.get(axis)).mm();
            let direction = match distance {
                0.0 => continue,
                _ if distance > 0.0 => 1,
                _ => -1,
            };
            if core::mem::replace(last, direction) == -direction {
                wait = f64::max(wait, self.rates.backlash_s(axis));
            }
        }
        if wait > 0.0 {
            self.stop();
            self.now += wait;
        }
    }

    /// Lets the last cut end with a stop, and passes it to the callback.
    pub(crate) fn stop(&mut self) {
        if let Some((mut last, settling)) = self.pending.take() {
            last.duration_s += settling;
            self.now += settling;
            self.cutting_s += settling;
            (self.on_move)(&last);
        }
    }

    fn check_travel(&self, step: &PathStep) -> Result<(), Alarm> {
        let Some((minus, plus)) = self.travel else {
            return Ok(());
        };
        for axis in self.axes.all() {
            let to = step.to.get(axis);
            let (low, high) = (minus.get(axis), plus.get(axis));
            if (low..=high).contains(&to)
                || self.axes.rolls_over(axis)
                || !self.limited[axis as usize]
            {
                continue;
            }
            let beyond = match (axis, to > high) {
                (MillAxis::X, true) => number::X_PLUS_LIMIT,
                (MillAxis::X, false) => number::X_MINUS_LIMIT,
                (MillAxis::Y, true) => number::Y_PLUS_LIMIT,
                (MillAxis::Y, false) => number::Y_MINUS_LIMIT,
                (MillAxis::Z, true) => number::Z_PLUS_LIMIT,
                (MillAxis::Z, false) => number::Z_MINUS_LIMIT,
                // The alarm list of this control family has no number for them.
                (MillAxis::Fourth | MillAxis::Fifth, _) => number::OUT_OF_RANGE,
            };
            let name = self.axes.letter(axis);
            let unit = if self.axes.is_rotary(axis) {
                "°"
            } else {
                "mm"
            };
            let (to, low, high) = (to.mm(), low.mm(), high.mm());
            let detail = match MillAxis::FURTHER.contains(&axis) {
                true => say::mill_beyond_further(name, to, low, high, unit),
                false => say::mill_beyond_travel(name, to, low, high),
            };
            return Err(Alarm::new(beyond)
                .with_detail(detail)
                .with_source(step.source));
        }
        Ok(())
    }
}
