//! Collects samples of one millisecond into motion segments for the board, each as long as the
//! configured period.

use core::fmt::Write;

use super::super::{MotionRefused, RunTime, Sample};
use gsk_units::{PerAxis, Pulses};

/// Greatest duration of standstill at the beginning of a segment.
const LONGEST: RunTime = RunTime::from_millis(500);

/// A straight segment of motion, ready for the board.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StreamedSegment {
    /// The line of G code for the board, with its line end.
    pub(super) line: String,
    /// Duration of the segment's motion.
    pub(super) duration: RunTime,
    /// Kernel time at the end of the segment.
    pub(super) end: RunTime,
    /// Position at the end of the segment, in the kernel's pulses.
    pub(super) pulses: PerAxis<Pulses>,
}

/// Collects samples of the commanded position until a segment is due.
#[derive(Clone, Debug)]
pub(super) struct Segments {
    period: RunTime,
    max_rate: f64,
    pulses_per_mm: [f64; 2],
    /// Kernel time at the end of the last segment.
    from: RunTime,
    at: PerAxis<Pulses>,
    /// The newest sample that is not in a segment yet; `None` without one.
    newest: Option<Sample>,
    /// Least duration of the first segment of a motion; that segment ends with the first pulse
    /// of the motion. 0 once that segment is made: later segments have the usual duration.
    run_up: RunTime,
}

impl Segments {
    pub(super) fn new(period: RunTime, max_rate: u32, pulses_per_mm: [f64; 2]) -> Self {
        Self {
            period,
            max_rate: max_rate.into(),
            pulses_per_mm,
            from: RunTime::ZERO,
            at: PerAxis::default(),
            newest: None,
            run_up: RunTime::ZERO,
        }
    }

    /// Sets the least duration of the segment with the first pulse of a motion to `run_up`.
    /// Meanwhile the board reads the next lines into its queue. Otherwise a short pause of the host
    /// at the start of a motion would leave the board without motion.
    pub(super) const fn begin_slowly(&mut self, run_up: RunTime) {
        self.run_up = run_up;
    }

    /// Restarts at the position `at`, in the kernel's pulses, and at the kernel time `from`, and
    /// drops the newest sample.
    pub(super) fn begin(&mut self, at: PerAxis<Pulses>, from: RunTime) {
        self.at = at;
        self.from = from;
        self.newest = None;
    }

    /// Returns the duration of the motion that is not yet part of a segment.
    pub(super) fn pending(&self) -> RunTime {
        self.newest
            .filter(|sample| sample.pulses != self.at)
            .map_or(RunTime::ZERO, |sample| sample.end.saturating_sub(self.from))
    }

    /// Takes a sample and returns a segment if one is due; otherwise `None`. `offset` is the
    /// board's count minus the kernel's, pulses.
    ///
    /// # Errors
    /// The segment needs more pulses per second than the board can make.
    pub(super) fn push(
        &mut self,
        sample: Sample,
        offset: PerAxis<Pulses>,
    ) -> Result<Option<StreamedSegment>, MotionRefused> {
        if self.newest.is_some_and(|before| self.turns(before, sample)) {
            let turning = self.cut(offset)?;
            self.newest = Some(sample);
            return Ok(turning);
        }
        self.newest = Some(sample);
        let duration = sample.end.saturating_sub(self.from);
        let first = self.run_up > RunTime::ZERO && sample.pulses != self.at;
        if duration < self.period && !first {
            return Ok(None);
        }
        if sample.pulses == self.at {
            if duration >= LONGEST {
                self.from = sample.end - self.period;
            }
            return Ok(None);
        }
        self.cut(offset)
    }

    /// Whether an axis reverses between the sample `before` and `sample`. The segment must end at
    /// the reversal, or the board would not reach that position.
    fn turns(&self, before: Sample, sample: Sample) -> bool {
        let turns = |at: Pulses, before: Pulses, now: Pulses| {
            (before.0 - at.0).signum() * (now.0 - before.0).signum() < 0
        };
        let (at, before, now) = (self.at, before.pulses, sample.pulses);
        turns(at.x, before.x, now.x) || turns(at.z, before.z, now.z)
    }

    /// Returns the rest of the motion as a segment of any duration, when the kernel is at
    /// standstill; `None` without motion. `offset` is the board's count minus the kernel's, pulses.
    ///
    /// # Errors
    /// The segment needs more pulses per second than the board can make.
    pub(super) fn finish(
        &mut self,
        offset: PerAxis<Pulses>,
    ) -> Result<Option<StreamedSegment>, MotionRefused> {
        match self.newest {
            Some(sample) if sample.pulses != self.at => self.cut(offset),
            Some(sample) => {
                // The next motion does not continue from the end of this one.
                self.from = sample.end;
                self.newest = None;
                Ok(None)
            }
            None => Ok(None),
        }
    }

    fn cut(&mut self, offset: PerAxis<Pulses>) -> Result<Option<StreamedSegment>, MotionRefused> {
        let Some(sample) = self.newest.take() else {
            return Ok(None);
        };
        let duration = sample.end.saturating_sub(self.from);
        let duration = duration.max(core::mem::take(&mut self.run_up));
        let seconds = duration.as_secs_f64().max(1e-3);
        let steps = [
            sample.pulses.x.0 - self.at.x.0,
            sample.pulses.z.0 - self.at.z.0,
        ];
        // A segment shorter than the period may contain a pulse of the next one.
        let whole = u64::from(duration < self.period);
        if steps.iter().any(|count| {
            count.unsigned_abs().saturating_sub(whole) as f64 / seconds > self.max_rate
        }) {
            return Err(MotionRefused::TooFast);
        }
        // G53: machine coordinates ignore work offsets in the board.
        let mut line = String::from("G53");
        let positions = [
            (
                'X',
                steps[0],
                sample.pulses.x.0 + offset.x.0,
                self.pulses_per_mm[0],
            ),
            (
                'Z',
                steps[1],
                sample.pulses.z.0 + offset.z.0,
                self.pulses_per_mm[1],
            ),
        ];
        // Writing to a `String` cannot fail.
        for (letter, steps, position, per_mm) in positions {
            if steps != 0 {
                let _ = write!(line, "{letter}{:.4}", position as f64 / per_mm);
            }
        }
        // The feed, not the time (G93): if the position is damaged on the wire, the board
        // moves there at the feed and not at its greatest rate.
        let moved = [0, 1].map(|axis| steps[axis] as f64 / self.pulses_per_mm[axis]);
        let length = libm::hypot(moved[0], moved[1]);
        let feed = length / seconds * 60.0;
        // Four digits are enough; a longer line takes more time on the wire.
        let decimals = if feed < 100.0 { 2 } else { 1 };
        let _ = writeln!(line, "F{feed:.decimals$}");
        self.from = sample.end;
        self.at = sample.pulses;
        Ok(Some(StreamedSegment {
            line,
            duration,
            end: sample.end,
            pulses: sample.pulses,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(ms: u64, x: i64, z: i64) -> Sample {
        Sample::new(RunTime::from_millis(ms), PerAxis::new(Pulses(x), Pulses(z)))
    }

    #[test]
    fn ten_samples_give_a_segment() {
        let mut segments = Segments::new(RunTime::from_millis(10), 30_000, [400.0, 200.0]);
        let offset = PerAxis::new(Pulses(0), Pulses(0));
        for ms in 1..10 {
            assert_eq!(segments.push(sample(ms, 0, -(ms as i64)), offset), Ok(None));
        }
        let segment = segments.push(sample(10, 0, -10), offset).unwrap().unwrap();
        assert_eq!(segment.line, "G53Z-0.0500F300.0\n");
        assert_eq!(segments.pending(), RunTime::ZERO);
    }

    #[test]
    fn the_first_pulse_of_a_motion_is_slow() {
        let mut segments = Segments::new(RunTime::from_millis(10), 30_000, [400.0, 200.0]);
        let offset = PerAxis::default();
        segments.begin_slowly(RunTime::from_millis(80));
        assert_eq!(segments.push(sample(1, 0, 0), offset), Ok(None));
        let segment = segments.push(sample(2, 0, -1), offset).unwrap().unwrap();
        assert_eq!(segment.line, "G53Z-0.0050F3.75\n");
        assert_eq!(segment.duration, RunTime::from_millis(80));
        assert_eq!(segments.push(sample(3, 0, -2), offset), Ok(None));
        let segment = segments.push(sample(12, 0, -9), offset).unwrap().unwrap();
        assert_eq!(segment.line, "G53Z-0.0450F240.0\n");
    }

    #[test]
    fn a_segment_ends_where_an_axis_reverses() {
        let mut segments = Segments::new(RunTime::from_millis(10), 30_000, [400.0, 200.0]);
        let offset = PerAxis::default();
        // X continues, Z reverses at 4 in the fourth millisecond.
        for (ms, z) in [(1, 1), (2, 2), (3, 3), (4, 4)] {
            assert_eq!(segments.push(sample(ms, ms as i64, z), offset), Ok(None));
        }
        let turning = segments.push(sample(5, 5, 3), offset).unwrap().unwrap();
        assert_eq!(turning.pulses, PerAxis::new(Pulses(4), Pulses(4)));
        assert_eq!(turning.end, RunTime::from_millis(4));
        assert_eq!(turning.duration, RunTime::from_millis(4));
        assert_eq!(segments.pending(), RunTime::from_millis(1));
        for ms in 6..14 {
            let back = sample(ms, ms as i64, 8 - ms as i64);
            assert_eq!(segments.push(back, offset), Ok(None), "{ms}");
        }
        let next = segments.push(sample(14, 14, -6), offset).unwrap().unwrap();
        assert_eq!(next.duration, RunTime::from_millis(10));
        // The next reversal is at the end of the segment: none within it.
        assert_eq!(segments.push(sample(15, 14, -5), offset), Ok(None));
    }

    #[test]
    fn a_rate_above_the_limit_is_refused() {
        let mut segments = Segments::new(RunTime::from_millis(10), 30_000, [400.0, 200.0]);
        let offset = PerAxis::default();
        assert_eq!(
            segments.push(sample(10, 301, 0), offset),
            Err(MotionRefused::TooFast)
        );
    }

    #[test]
    fn a_long_standstill_is_not_carried_into_a_segment() {
        let mut segments = Segments::new(RunTime::from_millis(10), 30_000, [400.0, 200.0]);
        let offset = PerAxis::default();
        for ms in 1..=5000 {
            assert_eq!(segments.push(sample(ms, 0, 0), offset), Ok(None));
        }
        let segment = segments.push(sample(5001, 5, 0), offset).unwrap().unwrap();
        assert!(segment.duration <= LONGEST, "{:?}", segment.duration);
    }
}
