//! Steps on the angle of the spindle: rational ratios, added up exactly at each count of the
//! encoder.

use crate::storage::Deque;

use crate::messages::Reason;

/// Number of earlier segments that a spindle can turn back through.
const KEPT_SEGMENTS: usize = 4;
/// Binary logarithm of the greatest lag of an axis, steps; beyond it the axis cannot follow.
const MAX_LAG_SHIFT: u32 = 3;

/// A part of a thread with a ratio that is constant or grows by the same amount at each count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Segment {
    /// Length, counts of the spindle encoder.
    pub length: i32,
    /// Steps at the first count, in fractions of the denominator; negative for negative steps.
    pub numerator: i32,
    /// Amount by which the numerator grows at each count.
    pub add: i32,
}

/// Whether a follower is waiting for its start, following, or has reached the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Waiting,
    Following,
    Ended,
}

/// The part of a tap that the spindle has made.
#[derive(Clone, Copy, Debug)]
struct TapProgress {
    /// Counts along the tap from which on its return to the start ends it.
    depth: i32,
    /// Counts along the tap, negative before its start.
    at: i32,
    has_been_deep: bool,
}

/// What a follower does with the next segment of the queue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QueuedAngle {
    /// Follow this segment.
    Segment(Segment),
    /// The thread ends here.
    End,
    /// The host has queued nothing.
    Empty,
}

/// An axis that follows the spindle.
#[derive(Clone, Debug)]
pub struct AngleFollower {
    denominator: i64,
    phase: Phase,
    /// Whether the thread is followed while the spindle counts down.
    is_reverse: bool,
    /// `None` in a thread, which ends after its last segment. A tap ends back at its start.
    tap: Option<TapProgress>,
    segment: Segment,
    /// Count within the segment; negative before the start of the thread.
    count: i32,
    /// Steps of the next count, in fractions of the denominator.
    rate: i64,
    /// Steps that are due but not made, in fractions of the denominator.
    due: i64,
    done: Deque<Segment, KEPT_SEGMENTS>,
    /// Segments that were begun before the spindle turned back.
    undone: Deque<Segment, KEPT_SEGMENTS>,
    is_first: bool,
    /// Whether a segment before those in `done` was dropped.
    has_dropped: bool,
    /// Greatest lateness of a step since the last report, in fractions of the denominator;
    /// negative without a step.
    late: i64,
}

impl AngleFollower {
    /// Creates a follower that waits for its start. `phase` is the part of a step that is due at
    /// the start, in fractions of `denominator`: half of it rounds to the nearest step.
    pub fn new(denominator: u32, phase: u32, is_reverse: bool) -> Self {
        Self {
            denominator: i64::from(denominator.max(1)),
            phase: Phase::Waiting,
            is_reverse,
            tap: None,
            segment: Segment::default(),
            count: 0,
            rate: 0,
            due: i64::from(phase),
            done: Deque::new(),
            undone: Deque::new(),
            is_first: true,
            has_dropped: false,
            late: -1,
        }
    }

    /// Makes the thread a tap: it ends when the spindle turns back to its start after at least
    /// `depth` counts.
    pub fn end_at_start(&mut self, depth: i32) {
        self.tap = Some(TapProgress {
            depth,
            at: 0,
            has_been_deep: false,
        });
    }

    /// Returns the greatest phase error since the last call, thousandths of a step, and begins
    /// anew. An axis that makes each step at its count has up to half a step and one count.
    #[inline(never)]
    pub fn take_error(&mut self) -> u32 {
        // 16 bits of the denominator suffice, and spare the processor a division of 64 bits.
        let bits = u64::BITS - self.denominator.unsigned_abs().leading_zeros();
        let shift = bits.saturating_sub(16);
        let late = core::mem::replace(&mut self.late, -1);
        if late < 0 {
            return 0;
        }
        let error = ((late + (self.denominator >> 1)) >> shift) as u32;
        error.saturating_mul(1000) / (self.denominator >> shift) as u32
    }

    /// Whether the spindle has not passed the start of the thread.
    pub fn is_waiting(&self) -> bool {
        self.phase == Phase::Waiting
    }

    /// Whether the last segment is complete, or a tap back at its start. Steps may be due.
    #[inline(always)]
    pub fn is_ended(&self) -> bool {
        self.phase == Phase::Ended
    }

    /// Returns the counts along the thread for counts of the encoder.
    #[inline(always)]
    pub fn along(&self, counts: i32) -> i32 {
        if self.is_reverse { -counts } else { counts }
    }

    /// Starts the thread at the current count of the spindle.
    pub fn start(&mut self, mut next: impl FnMut() -> QueuedAngle) -> Result<(), Reason> {
        self.phase = Phase::Following;
        self.load(&mut next)
    }

    fn load(&mut self, next: &mut impl FnMut() -> QueuedAngle) -> Result<(), Reason> {
        loop {
            let segment = match self.undone.pop_back() {
                Some(segment) => segment,
                None => match next() {
                    QueuedAngle::Segment(segment) => segment,
                    QueuedAngle::Empty => return Err(Reason::AngleUnderrun),
                    QueuedAngle::End if self.tap.is_some() => return Err(Reason::TapTooDeep),
                    QueuedAngle::End => {
                        self.phase = Phase::Ended;
                        return Ok(());
                    }
                },
            };
            if !self.is_first {
                if self.done.is_full() {
                    self.done.pop_front();
                    self.has_dropped = true;
                }
                let _ = self.done.push_back(self.segment);
            }
            self.is_first = false;
            self.segment = segment;
            self.count = 0;
            self.rate = i64::from(segment.numerator);
            if segment.length > 0 {
                return Ok(());
            }
        }
    }

    /// Takes some counts of the spindle along the thread, negative if it turns back. `next`
    /// removes the next segment from the queue.
    #[inline]
    pub fn turn(
        &mut self,
        along: i32,
        mut next: impl FnMut() -> QueuedAngle,
    ) -> Result<(), Reason> {
        if self.phase != Phase::Following {
            return Ok(());
        }
        let mut rest = along;
        while rest > 0 && self.phase == Phase::Following {
            if self.count < 0 {
                let before_start = rest.min(-self.count);
                self.count += before_start;
                rest -= before_start;
                continue;
            }
            let counts = rest.min(self.segment.length - self.count);
            for _ in 0..counts {
                self.due += self.rate;
                self.rate += i64::from(self.segment.add);
            }
            self.count += counts;
            rest -= counts;
            if self.count == self.segment.length {
                self.load(&mut next)?;
            }
        }
        if along < 0 {
            self.turn_back_by(-along)?;
        }
        if self.tap.is_some() {
            self.measure_tap(along);
        }
        let most = self.denominator << MAX_LAG_SHIFT;
        if self.due > most || self.due < -most {
            return Err(Reason::CannotFollow);
        }
        Ok(())
    }

    // Out of the way of a thread that goes forwards: it has no cycles to spare at 819 200 counts/s.
    #[cold]
    #[inline(never)]
    fn turn_back_by(&mut self, counts: i32) -> Result<(), Reason> {
        for _ in 0..counts {
            self.turn_back()?;
            if self.phase == Phase::Ended {
                break;
            }
        }
        Ok(())
    }

    #[cold]
    #[inline(never)]
    fn measure_tap(&mut self, along: i32) {
        if let Some(tap) = &mut self.tap {
            tap.at += along;
            tap.has_been_deep |= tap.at >= tap.depth;
        }
    }

    fn turn_back(&mut self) -> Result<(), Reason> {
        while self.count == 0 {
            let Some(earlier) = self.done.pop_back() else {
                break;
            };
            self.undone
                .push_back(self.segment)
                .map_err(|_| Reason::AngleReversed)?;
            self.segment = earlier;
            self.count = earlier.length;
            self.rate =
                i64::from(earlier.numerator) + i64::from(earlier.add) * i64::from(self.count);
        }
        if self.count == 0 && self.has_dropped {
            return Err(Reason::AngleReversed);
        }
        self.count -= 1;
        if self.count >= 0 {
            self.rate -= i64::from(self.segment.add);
            self.due -= self.rate;
        }
        let is_at_start = self.count == 0 && self.done.is_empty() && !self.has_dropped;
        if is_at_start && self.tap.is_some_and(|tap| tap.has_been_deep) {
            self.phase = Phase::Ended;
            // A step back that is held is made: the axis is exactly at its start.
            self.rate = 0;
        }
        Ok(())
    }

    /// Returns the direction of a step that is due, `true` for positive; `None` if no step is
    /// due. A step back waits for one more count, so that a spindle that trembles does not make
    /// the axis tremble.
    #[inline(always)]
    pub fn due_step(&self) -> Option<bool> {
        if self.due >= 0 {
            return (self.due >= self.denominator).then_some(true);
        }
        (self.due < -self.rate.abs().min(self.denominator)).then_some(false)
    }

    /// Notes that the step that was due is made. The phase error is greatest before a step: half a
    /// step and its lateness.
    pub fn made_step(&mut self, is_up: bool) {
        if is_up {
            self.due -= self.denominator;
            self.late = self.late.max(self.due);
        } else {
            self.late = self.late.max(-self.due);
            self.due += self.denominator;
        }
    }
}
