//! A motion on the angle, from its start to its end: positions, entries for the board, progress.

use std::collections::VecDeque;

use core::time::Duration;

use crate::step_queue::angle_segments::{AngleSegment, AngleSegments, PER_FINE};
use crate::step_queue::commands::Command;
use crate::step_queue::spindle_angle::SpindleCounts;
use crate::step_queue::step_compress::Ticks;
use crate::{FINE, HostTime, Sample};

/// Time after the last count of a thread after which it has ended, even if the report is lost.
const END_LOST: Duration = Duration::from_millis(60);

/// A message of a thread that waits to be sent.
#[derive(Clone, Copy, Debug)]
pub(super) struct AngleMessage {
    pub(super) command: Command,
    pub(super) axis: usize,
    /// The arguments after the object number.
    pub(super) arguments: [i64; 5],
    pub(super) count: usize,
    /// The angles from the start at which the entry begins and ends.
    pub(super) begins: SpindleCounts,
    pub(super) ends: SpindleCounts,
}

/// A motion on the angle, from its start to its end.
#[derive(Clone, Debug)]
pub(super) struct AngleStretch {
    /// Board clock from which on the axes wait for the start, ticks: the origin of the path clock.
    pub(super) begun: Ticks,
    /// The angle of the start, as the kernel counts it.
    pub(super) start: SpindleCounts,
    /// Counts per tick of the board clock at the planned speed.
    pub(super) counts_per_tick: f64,
    pub(super) is_reverse: bool,
    pub(super) axes: [AngleSegments; 2],
    /// Fine positions at the start.
    pub(super) base: [i64; 2],
    /// Whether its end is queued.
    pub(super) is_closed: bool,
    /// Count of the encoder at which the board has started; `None` before.
    pub(super) started: Option<SpindleCounts>,
    pub(super) has_ended: [bool; 2],
    /// Counts since the start at the last report, the clock of that report, and the host time of
    /// the last change.
    pub(super) progress: SpindleCounts,
    pub(super) reported: Ticks,
    pub(super) progressed: HostTime,
    pub(super) outgoing: VecDeque<AngleMessage>,
    /// The ends of the entries in the board's queue.
    pub(super) in_board: VecDeque<SpindleCounts>,
}

impl AngleStretch {
    /// Returns the path clock at an angle from the start, ticks.
    pub(super) fn clock_at(&self, counts: f64) -> Ticks {
        self.begun + (counts / self.counts_per_tick) as Ticks
    }

    /// Adds the position of a sample; `turns` are the angles before and after it, counts.
    pub(super) fn add(
        &mut self,
        [before, after]: [f64; 2],
        from: [i64; 2],
        to: [i64; 2],
        signs: [i64; 2],
    ) {
        let end = libm::floor(after);
        let share = ((end - before) / (after - before).max(1e-9)).clamp(0.0, 1.0);
        let at = SpindleCounts(end as i64) - self.start;
        if at <= SpindleCounts(0) {
            return;
        }
        for axis in 0..2 {
            let moved = (to[axis] - from[axis]) as f64 * share;
            let fine = from[axis] + libm::round(moved) as i64;
            let position = signs[axis] * (fine - self.base[axis]) * PER_FINE;
            self.axes[axis].add(at, position);
        }
    }

    pub(super) fn push(
        &mut self,
        command: Command,
        axis: usize,
        arguments: &[i64],
        angles: [SpindleCounts; 2],
    ) {
        let mut message = AngleMessage {
            command,
            axis,
            arguments: [0; 5],
            count: arguments.len(),
            begins: angles[0],
            ends: angles[1],
        };
        for (slot, argument) in message.arguments.iter_mut().zip(arguments) {
            *slot = *argument;
        }
        self.outgoing.push_back(message);
    }

    /// Queues the segments of all positions so far; with `end`, the fine positions of the end,
    /// also those after them and the end.
    pub(super) fn queue_segments(&mut self, end: Option<([i64; 2], [i64; 2])>) {
        for axis in 0..2 {
            let mut segments: Vec<AngleSegment> = Vec::new();
            let path = &mut self.axes[axis];
            let mut at = path.reached();
            match end {
                None => path.compress(&mut segments),
                Some((fine, signs)) => {
                    let position = signs[axis] * (fine[axis] - self.base[axis]) * PER_FINE;
                    path.finish(position, &mut segments);
                }
            }
            for AngleSegment { length, numerator } in segments {
                let ends = at + length;
                self.push(
                    Command::QueueAngle,
                    axis,
                    &[length.0, numerator, 0],
                    [at, ends],
                );
                at = ends;
            }
            if end.is_some() {
                self.push(Command::EndAngle, axis, &[], [at, at]);
            }
        }
        // Both axes in turn, in the order of the angle.
        self.outgoing
            .make_contiguous()
            .sort_by_key(|message| message.begins);
    }

    /// Whether the board has made all of it at the host time `now`.
    pub(super) fn is_over(&self, now: HostTime) -> bool {
        let past = self.axes.iter().all(|axis| self.progress >= axis.reached());
        let lost = past && now.saturating_sub(self.progressed) >= END_LOST;
        self.is_closed && self.outgoing.is_empty() && (self.has_ended == [true; 2] || lost)
    }
}

/// The fine positions of a sample, rounded to whole pulses as the kernel rounds them.
pub(super) fn fine_positions(sample: &Sample) -> [i64; 2] {
    let limited = |fine: i64, pulses: i64| {
        let whole = pulses * FINE;
        fine.clamp(whole - FINE / 2 + 1, whole + FINE / 2 - 1)
    };
    [
        limited(sample.fine.x, sample.pulses.x.0),
        limited(sample.fine.z, sample.pulses.z.0),
    ]
}
