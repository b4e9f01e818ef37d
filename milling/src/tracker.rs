//! Turns steps into moves with their duration, and adds up times, lengths and bounds.

use gsk_core::alarm::{Alarm, number};
use gsk_core::command::Source;
use gsk_core::units::Feed;
use gsk_messages::say;

use crate::axes::Axes;
use crate::bounds::{Bounds, Lengths};
use crate::memory::{MillMemory, parameter};
use crate::moves::{Arc, Move, MoveKind};
use crate::space::{Axis, Position};
use crate::time::Rates;

/// A step of a program, machine coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    pub(crate) source: Source,
    pub(crate) kind: MoveKind,
    pub(crate) to: Position,
    pub(crate) arc: Option<Arc>,
    pub(crate) feed: Option<Feed>,
    /// Work zero in machine coordinates, without and with the length offset.
    pub(crate) zero: Position,
    pub(crate) frame: Position,
    pub(crate) tool: u16,
    /// Spindle speed for a feed per revolution, r/min.
    pub(crate) speed: f64,
    /// Whether the motion stops at its end.
    pub(crate) exact: bool,
    /// For a rigid tap, whether it moves out of the hole.
    pub(crate) rigid_out: Option<bool>,
    /// Duration of a dwell, s.
    pub(crate) dwell_s: f64,
}

/// Callback that receives each move.
pub(crate) type OnMove<'a> = dyn FnMut(&Move) + 'a;

/// Turns steps into moves and adds them up.
pub(crate) struct Tracker<'a> {
    rates: Rates,
    axes: Axes,
    /// Travel limits, if they act.
    travel: Option<(Position, Position)>,
    pub(crate) machine: Position,
    pub(crate) now: f64,
    pub(crate) cutting_s: f64,
    pub(crate) moves: u64,
    pub(crate) lengths: Lengths,
    pub(crate) bounds: Option<Bounds>,
    /// The last cut and the duration of a stop at its end, s. The next step determines whether
    /// the motion stops there.
    running: Option<(Move, f64)>,
    on_move: &'a mut OnMove<'a>,
}

impl<'a> Tracker<'a> {
    pub(crate) fn new(memory: &MillMemory, start: Position, on_move: &'a mut OnMove<'a>) -> Self {
        Self {
            rates: Rates::of(memory),
            axes: Axes::of(memory),
            travel: (!memory.bit(parameter::LIMITS, 4)).then(|| {
                (
                    memory.point(parameter::TRAVEL_MINUS),
                    memory.point(parameter::TRAVEL_PLUS),
                )
            }),
            machine: start,
            now: 0.0,
            cutting_s: 0.0,
            moves: 0,
            lengths: Lengths::default(),
            bounds: None,
            running: None,
            on_move,
        }
    }

    /// Makes a step. Errors: the alarm of a travel limit.
    pub(crate) fn make(&mut self, step: &Step) -> Result<(), Alarm> {
        let turns = step.arc.is_some();
        if step.kind != MoveKind::Dwell && !turns && step.to == self.machine {
            return Ok(());
        }
        self.check_travel(step)?;
        let from = self.axes.rolled(self.machine - step.frame);
        let mut made = Move {
            source: step.source,
            kind: step.kind,
            from,
            to: from + (step.to - self.machine),
            axes: self.axes,
            zero: step.zero,
            arc: step.arc.map(|arc| Arc {
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
            MoveKind::Rapid => {
                self.stand();
                made.start_s = self.now;
                let way = step.to - self.machine;
                made.duration_s = self.rates.rapid(&way);
                made.arrivals = self.rates.arrivals(&way);
                self.lengths.rapid += length;
            }
            MoveKind::Dwell => {
                self.stand();
                made.start_s = self.now;
                made.duration_s = step.dwell_s;
            }
            _ => {
                let feed = match step.feed {
                    Some(Feed::PerMinute(feed)) => feed,
                    Some(Feed::PerRevolution(feed)) => feed * step.speed,
                    None => 0.0,
                };
                // The lead of a thread is along its longest axis.
                let way = match step.kind {
                    MoveKind::Thread => made.longest(),
                    _ => made.way(),
                };
                made.duration_s = way / self.rates.cutting(feed);
                self.cutting_s += made.duration_s;
                settling = match step.rigid_out {
                    Some(out) => self.rates.settling_of_tap(out),
                    None => self.rates.settling(feed),
                };
                *match step.kind {
                    MoveKind::Clockwise => &mut self.lengths.clockwise,
                    MoveKind::CounterClockwise => &mut self.lengths.counter_clockwise,
                    MoveKind::Tap => &mut self.lengths.tap,
                    MoveKind::Thread => &mut self.lengths.thread,
                    _ => &mut self.lengths.feed,
                } += length;
            }
        }
        self.now += made.duration_s;
        self.machine = self.axes.rolled(step.to);
        self.moves += 1;
        if step.kind != MoveKind::Dwell {
            Bounds::reach(&mut self.bounds, &made);
        }
        if matches!(step.kind, MoveKind::Rapid | MoveKind::Dwell) {
            (self.on_move)(&made);
        } else {
            if let Some((before, _)) = self.running.replace((made, settling)) {
                (self.on_move)(&before);
            }
            if step.exact {
                self.stand();
            }
        }
        Ok(())
    }

    /// Ends the last cut with a stop.
    pub(crate) fn stand(&mut self) {
        if let Some((mut last, settling)) = self.running.take() {
            last.duration_s += settling;
            self.now += settling;
            self.cutting_s += settling;
            (self.on_move)(&last);
        }
    }

    fn check_travel(&self, step: &Step) -> Result<(), Alarm> {
        let Some((minus, plus)) = self.travel else {
            return Ok(());
        };
        for axis in self.axes.all() {
            let to = step.to.get(axis);
            let (low, high) = (minus.get(axis), plus.get(axis));
            if (low..=high).contains(&to) || self.axes.rolls(axis) {
                continue;
            }
            let beyond = match (axis, to > high) {
                (Axis::X, true) => number::X_PLUS_LIMIT,
                (Axis::X, false) => number::X_MINUS_LIMIT,
                (Axis::Y, true) => number::Y_PLUS_LIMIT,
                (Axis::Y, false) => number::Y_MINUS_LIMIT,
                (Axis::Z, true) => number::Z_PLUS_LIMIT,
                (Axis::Z, false) => number::Z_MINUS_LIMIT,
                // The alarm list of this control family has no number for them.
                (Axis::Fourth | Axis::Fifth, _) => number::OUT_OF_RANGE,
            };
            let name = self.axes.letter(axis);
            let unit = if self.axes.is_rotary(axis) {
                "°"
            } else {
                "mm"
            };
            let (to, low, high) = (to.mm(), low.mm(), high.mm());
            let detail = match Axis::FURTHER.contains(&axis) {
                true => say::mill_beyond_further(name, to, low, high, unit),
                false => say::mill_beyond_travel(name, to, low, high),
            };
            return Err(Alarm::new(beyond).because(detail).at(step.source));
        }
        Ok(())
    }
}
