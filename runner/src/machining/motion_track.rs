//! Converts the moves of a program to motions of the tool's tip relative to the part.

use gsk_core::command::{ExecutedMove, MoveKind, ThreadStart};
use gsk_core::units::{Feed, Point};
use gsk_workpiece::job::Job;
use gsk_workpiece::motion::{MotionKind, ThreadPath, ToolMotion};

use super::Mounting;
use crate::curves::{RapidRates, rapid_bend};

/// Converts executed moves to motions of the tool tips; stores the position of tools and part, and
/// the spindle angle at which the last thread ended.
#[derive(Clone, Debug, Default)]
pub(super) struct MotionTrack {
    mounting: Mounting,
    /// Spindle angle at which the last thread ended, turns.
    phase_turns: f64,
}

impl MotionTrack {
    /// Creates a track from the tool lengths and the work zero of a job.
    pub(super) fn from_job(job: &Job) -> Self {
        Self {
            mounting: Mounting::from_job(job),
            phase_turns: 0.0,
        }
    }

    /// Returns the mapping from slide positions to tip positions in the part.
    pub(super) const fn mounting(&self) -> &Mounting {
        &self.mounting
    }

    /// The mapping from slide positions to tip positions, mutable, so that a running control can
    /// fix the position of a tool.
    pub(super) const fn mounting_mut(&mut self) -> &mut Mounting {
        &mut self.mounting
    }

    /// Returns the tip motions of a move in part coordinates: none for a dwell and for a move to or
    /// from a machine zero at an unknown position, two for a rapid with a bend. `rates` are the
    /// rapid rates.
    pub(super) fn tip_motions(
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
            self.mounting.fix_tool(tool, frame);
        }
        let shift =
            frame.to_machine(Point::default()) - self.mounting.slide_at_part_zero(tool, frame);
        let in_part = |point: Point| point + shift;
        let (from, to) = (in_part(executed.from), in_part(executed.to));
        let turning = conditions.rpm > 0.0;
        let motion = |from, to, kind| ToolMotion {
            from,
            to,
            kind,
            turning,
            by_hand: false,
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
                    center: in_part(center),
                    clockwise: executed.kind == MoveKind::Clockwise,
                },
                None => MotionKind::Line,
            },
            MoveKind::Thread | MoveKind::RunOut => self.thread_motion(executed, from, to),
        };
        vec![motion(from, to, kind)]
    }

    /// Returns the motion of a thread from `from` to `to`, part coordinates, mm, as its imprints in
    /// the drawn plane; a straight cut for a tap.
    fn thread_motion(&mut self, executed: &ExecutedMove, from: Point, to: Point) -> MotionKind {
        let (Some(thread), Some(Feed::PerRevolution(lead))) =
            (executed.conditions.thread, executed.feed)
        else {
            return MotionKind::Line;
        };
        let path = ThreadPath {
            from,
            to,
            lead_axis: thread.lead_axis,
            lead,
            lead_change: thread.increase,
            phase: match thread.start {
                ThreadStart::AtIndex { degrees } => degrees / 360.0,
                ThreadStart::Continued => self.phase_turns,
            },
        };
        let (imprints, phase) = path.imprints();
        self.phase_turns = phase;
        MotionKind::Thread(imprints)
    }
}
