//! Passes steps through the cutter radius compensation of `core`, which only knows moves in a
//! plane. The rest of a step waits here under its number.

use std::collections::BTreeMap;

use gsk_core::alarm::Alarm;
use gsk_core::compensation::CompensationSettings;
use gsk_core::compensation::cutter::{
    CutterCompensation, CutterOutput, CutterSide, FlatMove, FlatShape,
};
use gsk_core::units::Point;

use crate::axes::Axes;
use crate::path::moves::{MillArc, MillMoveKind};
use crate::path::tracker::{PathStep, Tracker};
use crate::space::{MillPosition, Plane, PlanePoint};

/// Step numbers restart at 0 after this count. Far fewer steps wait at a time.
const STEP_NUMBERS: u32 = 4096;

/// The cutter radius compensation, with the steps that wait in it for the next ones.
#[derive(Debug, Default)]
pub(crate) struct CutterStream {
    stream: CutterCompensation,
    waiting: BTreeMap<u32, PathStep>,
    count: u32,
    /// The axes, with their least increments.
    axes: Axes,
    plane: Plane,
    /// End of the last step passed to the stream.
    at: MillPosition,
}

const fn point(flat: PlanePoint) -> Point {
    Point {
        x: flat.second,
        z: flat.first,
    }
}

const fn flat(point: Point) -> PlanePoint {
    PlanePoint::new(point.z, point.x)
}

impl CutterStream {
    /// Creates a stream without compensation, with the tool at `start`.
    pub(crate) fn new(start: MillPosition, axes: Axes, settings: CompensationSettings) -> Self {
        Self {
            stream: CutterCompensation::new(settings),
            axes,
            at: start,
            ..Self::default()
        }
    }

    /// Returns whether cutter radius compensation is on, G41 or G42.
    pub(crate) const fn is_on(&self) -> bool {
        self.stream.is_on()
    }

    /// Takes a step, and passes it and waiting ones to `tracker` when their compensated end is
    /// known. `radius` is the cutter's, mm. `apart` marks a step away from the contour (a
    /// hole, a reference return), which is not compensated. Errors: the alarm of the
    /// compensation or of a travel limit.
    pub(crate) fn take(
        &mut self,
        step: &PathStep,
        (side, radius): (CutterSide, f64),
        (plane, apart): (Plane, bool),
        tracker: &mut Tracker<'_>,
    ) -> Result<(), Alarm> {
        let from = core::mem::replace(&mut self.at, step.to);
        if !self.is_on() && (side == CutterSide::On || apart) {
            return tracker.make(step);
        }
        self.plane = plane;
        if !self.is_on() {
            self.stream.set_position(point(from.flat(plane)));
        }
        let number = self.count;
        self.count = (self.count + 1) % STEP_NUMBERS;
        self.waiting.insert(number, *step);
        let to = step.to.flat(plane);
        let moves = step.arc.is_some() || to != from.flat(plane);
        let shape = match (step.kind, step.arc) {
            (MillMoveKind::Rapid, _) => FlatShape::Rapid,
            (kind, Some(MillArc { center, .. })) => FlatShape::Arc {
                center: point(center),
                clockwise: kind == MillMoveKind::Clockwise,
            },
            _ => FlatShape::Line,
        };
        let to = point(to);
        if step.kind == MillMoveKind::Dwell || !(moves || apart || self.cancels(side)) {
            self.stream.push_other(number, side);
        } else if apart {
            self.stream.push_uncompensated(number, to, side);
        } else {
            self.stream.push(
                FlatMove {
                    number,
                    line: step.source.line,
                    to,
                    shape,
                },
                side,
                radius,
            );
        }
        self.make_ready_steps(tracker)
    }

    /// Whether a step cancels the compensation: G40 does, even without motion in the plane.
    fn cancels(&self, side: CutterSide) -> bool {
        side == CutterSide::On && self.is_on()
    }

    /// Processes a block without motion; a step that waits for the next motion may be completed.
    /// Errors: the alarm of that step.
    pub(crate) fn skip_block(
        &mut self,
        side: CutterSide,
        tracker: &mut Tracker<'_>,
    ) -> Result<(), Alarm> {
        if self.is_on() {
            self.stream.push_other(STEP_NUMBERS, side);
        }
        self.make_ready_steps(tracker)
    }

    /// Completes the waiting steps at the end of the program. Errors: the alarm of one of
    /// them.
    pub(crate) fn flush(&mut self, tracker: &mut Tracker<'_>) -> Result<(), Alarm> {
        self.stream.flush();
        self.make_ready_steps(tracker)
    }

    fn make_ready_steps(&mut self, tracker: &mut Tracker<'_>) -> Result<(), Alarm> {
        while let Some(ready) = self.stream.take() {
            let ready = match ready {
                Ok(ready) => ready,
                Err(mut alarm) => {
                    // The alarm has the number of the step in place of its sequence number.
                    let number = alarm.source.and_then(|source| source.sequence);
                    let number = number.map(u32::from);
                    let step = number.and_then(|number| self.waiting.get(&number));
                    alarm.source = step.map(|step| step.source);
                    return Err(alarm);
                }
            };
            match ready {
                CutterOutput::Other(number) => {
                    if let Some(mut step) = self.waiting.remove(&number) {
                        // The step moves across the plane at the position of the cutter centre.
                        let centre = tracker.machine.flat(self.plane);
                        step.to = self.axes.moved_to(step.to, self.plane, centre);
                        tracker.make(&step)?;
                    }
                }
                CutterOutput::Move { flat: made, last } => {
                    let Some(step) = self.waiting.get(&made.number) else {
                        continue;
                    };
                    let mut step = *step;
                    if last {
                        self.waiting.remove(&made.number);
                    } else {
                        // A corner move before the step.
                        let across = self.plane.across();
                        step.to.set(across, tracker.machine.get(across));
                        step.to = step.to.with_further_of(&tracker.machine);
                    }
                    step.to = self.axes.moved_to(step.to, self.plane, flat(made.to));
                    step.arc = match made.shape {
                        FlatShape::Arc { center, .. } => Some(MillArc {
                            plane: self.plane,
                            center: flat(center),
                        }),
                        FlatShape::Rapid | FlatShape::Line => None,
                    };
                    if step.arc.is_none()
                        && matches!(
                            step.kind,
                            MillMoveKind::Clockwise | MillMoveKind::CounterClockwise
                        )
                    {
                        step.kind = MillMoveKind::Feed;
                    }
                    tracker.make(&step)?;
                }
            }
        }
        Ok(())
    }
}
