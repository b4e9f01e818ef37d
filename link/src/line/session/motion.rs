//! Motion handed over to a line board: waiting in the link, queued in the board, in its
//! pulse timer, and executed.
//!
//! ```text
//!  samples ─► Segments ─► backlog ─► queued ─► handed ─► executed
//!                         (here)     (board)   (timer)
//! ```

use core::time::Duration;
use std::collections::VecDeque;

use crate::line::response::StatusReport;
use crate::line::segments::{Segments, StreamedSegment};
use crate::{HostTime, RunTime};
use gsk_units::{PerAxis, Point, Pulses};

/// Assumed greatest time from the execution of a motion to the report of a limit switch that it has
/// operated.
const PREPARED: Duration = Duration::from_millis(200);
/// Greatest age of the position in a report that the link has not queried.
const LATE_REPORT: Duration = Duration::from_millis(300);
/// Time beyond its duration after which a segment in the board's queue is overdue.
const LATE: Duration = Duration::from_secs(1);

/// A segment in the board's queue that is not executed yet.
#[derive(Clone, Debug)]
pub(super) struct Queued {
    pub(super) duration: RunTime,
    pub(super) end: RunTime,
    pub(super) pulses: PerAxis<Pulses>,
    pub(super) answered: bool,
}

/// The motion passed to the board, with its progress.
#[derive(Clone, Debug)]
pub(super) struct LineMotion {
    pulses_per_mm: [f64; 2],
    pub(super) segments: Segments,
    pub(super) backlog: VecDeque<StreamedSegment>,
    pub(super) queued: VecDeque<Queued>,
    /// Segments in the board's pulse timer, each with the host time by which it is executed.
    handed: VecDeque<(HostTime, Queued)>,
    /// Start points of the segments executed recently, each with the host time at which the segment
    /// counted as executed.
    past: VecDeque<(HostTime, PerAxis<Pulses>)>,
    /// Host time at which the pending status query was sent; `None` without one. Segments executed
    /// since then remain in `past`.
    queried_at: Option<HostTime>,
    /// Position of the last sample that was added, in the kernel's pulses.
    pub(super) commanded: PerAxis<Pulses>,
    /// The board's count minus the kernel's, pulses.
    pub(super) offset: PerAxis<Pulses>,
    /// Kernel time at the end of the motion that the board has certainly executed.
    pub(super) executed: RunTime,
    /// Position at the time `executed`, in the kernel's pulses.
    pub(super) made: PerAxis<Pulses>,
    /// Host time since which the oldest segment in the board's queue has been the oldest.
    pub(super) progressed: HostTime,
    /// Host times of the last motion of X and of Z, each in positive and in negative direction;
    /// `None` without such a motion.
    moved: [[Option<HostTime>; 2]; 2],
    /// Whether the next sample continues at the end of a thread pass.
    pub(super) resumes: bool,
}

impl LineMotion {
    pub(super) fn new(segments: Segments, pulses_per_mm: [f64; 2], now: HostTime) -> Self {
        Self {
            pulses_per_mm,
            segments,
            backlog: VecDeque::new(),
            queued: VecDeque::new(),
            handed: VecDeque::new(),
            past: VecDeque::new(),
            queried_at: None,
            commanded: PerAxis::default(),
            offset: PerAxis::default(),
            executed: RunTime::ZERO,
            made: PerAxis::default(),
            progressed: now,
            moved: [[None; 2]; 2],
            resumes: false,
        }
    }

    /// Stores that the count `board` of the board and the count `kernel` of the kernel, both in
    /// pulses, are the same position, at standstill at the kernel time `at`.
    pub(super) fn align(&mut self, kernel: PerAxis<Pulses>, board: PerAxis<Pulses>, at: RunTime) {
        self.offset = PerAxis::new(
            Pulses(board.x.0 - kernel.x.0),
            Pulses(board.z.0 - kernel.z.0),
        );
        self.executed = at;
        self.stand_at(kernel);
    }

    /// Stores `kernel`, in the kernel's pulses, as the commanded and the executed position of
    /// the axes at standstill, and restarts the segments there.
    pub(super) fn stand_at(&mut self, kernel: PerAxis<Pulses>) {
        self.commanded = kernel;
        self.made = kernel;
        self.segments.begin(kernel, self.executed);
    }

    /// Drops all motion that waits in the link, is queued or is in the board's pulse timer.
    pub(super) fn forget(&mut self) {
        self.backlog.clear();
        self.queued.clear();
        self.handed.clear();
        self.past.clear();
        self.queried_at = None;
        self.resumes = false;
        self.segments.begin(self.commanded, self.executed);
    }

    /// Drops the motion that the link has not sent to the board.
    pub(super) fn drop_unsent(&mut self) {
        self.backlog.clear();
        self.segments.begin(self.commanded, self.executed);
    }

    /// Clears the record of the directions in which the axes have moved recently.
    pub(super) const fn forget_directions(&mut self) {
        self.moved = [[None; 2]; 2];
    }

    /// Returns the duration of the motion that the board may not have executed yet at the host time
    /// `now`.
    pub(super) fn outstanding(&self, now: HostTime) -> Duration {
        let handed: Duration = self.handed.iter().map(|(_, one)| one.duration).sum();
        let last = self.handed.back().map_or(now, |(made_by, _)| *made_by);
        let queued: Duration = self.queued.iter().map(|segment| segment.duration).sum();
        let waiting: Duration = self.backlog.iter().map(|segment| segment.duration).sum();
        let prepared = handed.min(last.saturating_sub(now));
        prepared + queued + waiting + self.segments.pending()
    }

    /// Whether no motion waits in the link or in the board's queue.
    pub(super) fn is_drained(&self) -> bool {
        self.backlog.is_empty()
            && self.queued.is_empty()
            && self.segments.pending() == RunTime::ZERO
    }

    /// Counts the next waiting segment as sent to the board's queue and returns it; `None` if no
    /// segment waits or its line does not fit into `free_bytes`.
    pub(super) fn next_segment(
        &mut self,
        free_bytes: usize,
        now: HostTime,
    ) -> Option<StreamedSegment> {
        let segment = self
            .backlog
            .pop_front_if(|segment| segment.line.len() <= free_bytes)?;
        if self.queued.is_empty() {
            self.progressed = now;
        }
        self.queued.push_back(Queued {
            duration: segment.duration,
            end: segment.end,
            pulses: segment.pulses,
            answered: false,
        });
        Some(segment)
    }

    /// Marks the oldest unanswered segment as answered.
    pub(super) fn segment_answered(&mut self) {
        if let Some(segment) = self.queued.iter_mut().find(|segment| !segment.answered) {
            segment.answered = true;
        }
    }

    /// Moves all answered segments except the newest `held` from the board's queue to its
    /// pulse timer, which executes them after `prepared`.
    pub(super) fn retire(&mut self, held: usize, prepared: Duration, now: HostTime) {
        let answered = self
            .queued
            .iter()
            .take_while(|segment| segment.answered)
            .count();
        let leaving = answered.saturating_sub(held);
        let mut made_by = now + prepared;
        let at = self.handed.len();
        for segment in self.queued.drain(..leaving).rev() {
            let duration = segment.duration;
            self.handed.insert(at, (made_by, segment));
            made_by = made_by.saturating_sub(duration);
            self.progressed = now;
        }
    }

    /// Stores that a status query was sent at the host time `now`. Its report describes the
    /// position at that time or later.
    pub(super) const fn report_requested(&mut self, now: HostTime) {
        self.queried_at = Some(now);
    }

    /// Clears the time of the status query: its report was received and compared.
    pub(super) const fn report_received(&mut self) {
        self.queried_at = None;
    }

    /// Counts segments in the pulse timer of the board as executed if their time has passed at the
    /// host time `now`, or all of them if the board is at standstill (`stands`).
    pub(super) fn settle(&mut self, stands: bool, now: HostTime) {
        while let Some((_, segment)) = self
            .handed
            .pop_front_if(|(made_by, _)| stands || *made_by <= now)
        {
            for (axis, way) in directions_between(self.made, segment.pulses)
                .into_iter()
                .enumerate()
            {
                match way {
                    1 => self.moved[axis][0] = Some(now),
                    -1 => self.moved[axis][1] = Some(now),
                    _ => {}
                }
            }
            self.past.push_back((now, self.made));
            self.executed = segment.end;
            self.made = segment.pulses;
        }
        let oldest = now.saturating_sub(LATE_REPORT);
        let oldest = self
            .queried_at
            .map_or(oldest, |queried_at| oldest.min(queried_at));
        while self.past.pop_front_if(|(at, _)| *at < oldest).is_some() {}
    }

    /// Whether the oldest segment in the board's queue is overdue: it takes longer than its
    /// duration by [`LATE`].
    pub(super) fn is_late(&self, now: HostTime) -> bool {
        let waits = now.saturating_sub(self.progressed);
        let oldest = self.queued.front();
        oldest.is_some_and(|segment| waits >= segment.duration + LATE)
    }

    /// Returns the segments in the board that may not be executed yet, the next one first.
    fn unmade(&self) -> impl Iterator<Item = &Queued> {
        let handed = self.handed.iter().map(|(_, segment)| segment);
        handed.chain(&self.queued)
    }

    /// Returns the directions in which X and Z move at the host time `now`, 1 or -1; 0 if an axis
    /// is at standstill or reverses.
    pub(super) fn ways(&self, now: HostTime) -> [i64; 2] {
        let recent = |moved: Option<HostTime>| {
            moved.is_some_and(|moved| now.saturating_sub(moved) < PREPARED)
        };
        let mut seen = self.moved.map(|ways| ways.map(recent));
        let mut from = self.made;
        for segment in self.unmade() {
            for (axis, way) in directions_between(from, segment.pulses)
                .into_iter()
                .enumerate()
            {
                seen[axis][0] |= way > 0;
                seen[axis][1] |= way < 0;
            }
            from = segment.pulses;
        }
        seen.map(|[up, down]| i64::from(up) - i64::from(down))
    }

    /// Returns the greatest speed of the motion that is not executed yet, mm/min.
    pub(super) fn fastest(&self) -> f64 {
        let mut from = self.made;
        let mut fastest = 0.0_f64;
        let queued = self.unmade().map(|piece| (piece.pulses, piece.duration));
        let waiting = self
            .backlog
            .iter()
            .map(|piece| (piece.pulses, piece.duration));
        for (to, duration) in queued.chain(waiting) {
            let distance = self.between(from, to).length();
            fastest = fastest.max(distance / duration.as_secs_f64().max(1e-3) * 60.0);
            from = to;
        }
        fastest
    }

    /// Returns the displacement of the slide from one position to another, mm.
    pub(super) fn between(&self, from: PerAxis<Pulses>, to: PerAxis<Pulses>) -> Point {
        let [per_x, per_z] = self.pulses_per_mm;
        Point::new(
            (to.x.0 - from.x.0) as f64 / per_x,
            (to.z.0 - from.z.0) as f64 / per_z,
        )
    }

    /// Returns the distance of the position `board`, a count of the board in pulses, from the
    /// commanded path, mm of the slide.
    pub(super) fn off_path(&self, board: PerAxis<Pulses>) -> f64 {
        let [per_x, per_z] = self.pulses_per_mm;
        let millimetres = |pulses: PerAxis<Pulses>| {
            Point::new(pulses.x.0 as f64 / per_x, pulses.z.0 as f64 / per_z)
        };
        let at = millimetres(self.to_kernel(board));
        let past = self.past.iter().map(|(_, position)| *position);
        let unmade = self.unmade().map(|segment| segment.pulses);
        let oldest = self.past.front().map_or(self.made, |(_, first)| *first);
        let mut from = millimetres(oldest);
        let mut nearest = (at - from).length();
        for position in past.chain([self.made]).chain(unmade) {
            let to = millimetres(position);
            nearest = nearest.min(distance_to_line(at, from, to));
            from = to;
        }
        nearest
    }

    /// Whether a position, in the kernel's pulses, equals the commanded one, within the three
    /// decimals of a report.
    pub(super) fn agrees(&self, kernel: PerAxis<Pulses>) -> bool {
        let near = |a: Pulses, b: Pulses, per_mm: f64| {
            let rounding = if per_mm > 500.0 {
                (per_mm * 0.000_5).ceil() as u64
            } else {
                0
            };
            (a.0 - b.0).unsigned_abs() <= rounding
        };
        let [x, z] = self.pulses_per_mm;
        near(kernel.x, self.commanded.x, x) && near(kernel.z, self.commanded.z, z)
    }

    /// Converts the board's count to the kernel's pulses.
    pub(super) fn to_kernel(&self, board: PerAxis<Pulses>) -> PerAxis<Pulses> {
        PerAxis::new(
            Pulses(board.x.0 - self.offset.x.0),
            Pulses(board.z.0 - self.offset.z.0),
        )
    }

    /// Returns the position in a report as the board's count, pulses; `None` for a report without a
    /// position.
    pub(super) fn board_count(&self, status: StatusReport) -> Option<PerAxis<Pulses>> {
        let [x, z] = status.position?;
        let [per_x, per_z] = self.pulses_per_mm;
        Some(PerAxis::new(
            Pulses((x * per_x).round() as i64),
            Pulses((z * per_z).round() as i64),
        ))
    }

    /// Returns the position in a report, in the kernel's pulses; `None` for a report without a
    /// position.
    pub(super) fn kernel_count(&self, status: StatusReport) -> Option<PerAxis<Pulses>> {
        self.board_count(status).map(|board| self.to_kernel(board))
    }
}

/// Returns the directions of X and Z from one position to another: 1, -1 or 0.
const fn directions_between(from: PerAxis<Pulses>, to: PerAxis<Pulses>) -> [i64; 2] {
    [(to.x.0 - from.x.0).signum(), (to.z.0 - from.z.0).signum()]
}

/// Returns the distance of the point `at` from the straight segment between `from` and `to`, mm.
fn distance_to_line(at: Point, from: Point, to: Point) -> f64 {
    let along = to - from;
    let square = along.x * along.x + along.z * along.z;
    if square == 0.0 {
        return (at - from).length();
    }
    let offset = at - from;
    let share = ((offset.x * along.x + offset.z * along.z) / square).clamp(0.0, 1.0);
    (offset - along * share).length()
}
