//! Moves of a program as motions of the tool's tip about the part.

use gsk_core::command::{ExecutedMove, MoveKind, ThreadStart};
use gsk_core::units::{Feed, Point};
use gsk_workpiece::job::Job;
use gsk_workpiece::motion::{MotionKind, ThreadPath, ToolMotion};

use super::Mounting;
use crate::curves::{RapidRates, rapid_bend};

/// Where tools stand to the part, and where on its turn the spindle is.
#[derive(Clone, Debug, Default)]
pub(super) struct Track {
    mounting: Mounting,
    /// Angle of the spindle where the last thread ended, turns.
    phase: f64,
}

impl Track {
    /// Of a job.
    pub(super) fn of(job: &Job) -> Self {
        Self {
            mounting: Mounting::of(job),
            phase: 0.0,
        }
    }

    /// How tools and part stand to the slide.
    pub(super) const fn mounting(&self) -> &Mounting {
        &self.mounting
    }

    /// The same, to be settled by a control that runs.
    pub(super) const fn mounting_mut(&mut self) -> &mut Mounting {
        &mut self.mounting
    }

    /// The motions of a move: none of a dwell, and of one to or from a machine zero that
    /// may lie anywhere; two of a rapid that bends.
    pub(super) fn motions(
        &mut self,
        executed: &ExecutedMove,
        rates: RapidRates,
    ) -> Vec<ToolMotion> {
        let conditions = &executed.conditions;
        if executed.kind == MoveKind::Dwell || !conditions.unplaced.is_none() {
            return Vec::new();
        }
        let (tool, frame) = (conditions.tool, &conditions.frame);
        if executed.kind != MoveKind::Rapid {
            self.mounting.settle(tool, frame);
        }
        let shift = frame.machine(Point::default()) - self.mounting.zero_of(tool, frame);
        let at = |point: Point| point + shift;
        let (from, to) = (at(executed.from), at(executed.to));
        let turning = conditions.rpm > 0.0;
        let motion = |from, to, kind| ToolMotion {
            from,
            to,
            kind,
            turning,
        };
        let kind = match executed.kind {
            MoveKind::Dwell | MoveKind::Rapid => {
                let bend = rapid_bend(from, to, rates).unwrap_or(to);
                let mut motions = vec![motion(from, bend, MotionKind::Rapid)];
                if bend != to {
                    motions.push(motion(bend, to, MotionKind::Rapid));
                }
                return motions;
            }
            MoveKind::Feed => MotionKind::Line,
            MoveKind::Clockwise | MoveKind::CounterClockwise => match executed.center {
                Some(center) => MotionKind::Arc {
                    center: at(center),
                    clockwise: executed.kind == MoveKind::Clockwise,
                },
                None => MotionKind::Line,
            },
            MoveKind::Thread | MoveKind::RunOut => self.thread(executed, from, to),
        };
        vec![motion(from, to, kind)]
    }

    /// Where a thread meets the drawn plane; a tap is a straight cut.
    fn thread(&mut self, executed: &ExecutedMove, from: Point, to: Point) -> MotionKind {
        let (Some(thread), Some(Feed::PerRevolution(lead))) =
            (executed.conditions.thread, executed.feed)
        else {
            return MotionKind::Line;
        };
        let path = ThreadPath {
            from,
            to,
            lead_axis: thread.long,
            lead,
            lead_change: thread.increase,
            phase: match thread.start {
                ThreadStart::AtIndex { degrees } => degrees / 360.0,
                ThreadStart::Continued => self.phase,
            },
        };
        let (imprints, phase) = path.imprints();
        self.phase = phase;
        MotionKind::Thread(imprints)
    }
}
