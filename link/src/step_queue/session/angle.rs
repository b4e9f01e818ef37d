//! Motion on the angle of the spindle: the kernel plans a thread for a spindle of the planned
//! speed, the board makes each step at the true angle.
//!
//! ```text
//!  kernel  position after each tick ─► position at an angle ─► segments ─┐
//!  board   steps at the true angle ◄─────────────────────────────────────┘
//!          counts since the start ─► progress: how far the kernel may plan ahead
//! ```
//!
//! In a thread the time of the kernel is an angle: a tick is the same part of a turn, however
//! fast the spindle turns. The *path clock* is the board clock at the planned speed.

mod planned_spindle;
mod stretch;
mod tap;

use std::collections::VecDeque;

use core::time::Duration;

use super::StepLink;
use super::stops::StopReason;
use crate::step_queue::angle_segments::{DENOMINATOR, PER_FINE};
use crate::step_queue::clock_sync::near;
use crate::step_queue::commands::Command;
use crate::step_queue::spindle_angle::{EncoderTrack, SpindleCounts};
use crate::step_queue::step_compress::Ticks;
use crate::{EncoderReading, FINE, LinkState, MotionRefused, Sample, SpindleView, ThreadPlan};
use gsk_messages::say;
use gsk_units::alarm;
use planned_spindle::{PlannedSpindle, TICKS_PER_S};
use stretch::{AngleStretch, fine_positions};
use tap::{BoardTap, StoppedTap, is_against, last_count};

/// Time without progress after which a thread is given up.
const STALLED: Duration = Duration::from_secs(1);
/// Number of turns, and time, after which a thread that has not begun is given up.
const UNBEGUN_TURNS: f64 = 2.0;
const UNBEGUN: Duration = Duration::from_secs(2);
/// Interval of the reports of the spindle encoder.
const REPORT_EVERY: Duration = Duration::from_millis(10);
/// Share by which the spindle may be faster than measured when the link computes how early a
/// segment is due.
const FASTER: f64 = 1.25;

/// The motion on the angle of the spindle.
#[derive(Clone, Debug, Default)]
pub(super) struct AngleDrive {
    track: Option<EncoderTrack>,
    /// The spindle that the kernel sees.
    spindle: PlannedSpindle,
    stretch: Option<AngleStretch>,
    /// The tap in the board; `None` without one.
    pub(super) tap: Option<BoardTap>,
    /// The tap that the stop in progress has ended.
    pub(super) stopped_tap: Option<StoppedTap>,
    /// Samples after a thread that has not ended in the board.
    waiting: VecDeque<Sample>,
    /// Whether a stop has ended a thread, at an angle that the board has not reported.
    pub(super) was_dropped: bool,
    /// Greatest phase error that the board has reported in the current or last thread, thousandths
    /// of a pulse; `None` before the first report.
    phase_error: Option<u32>,
}

impl AngleDrive {
    /// Creates the state for a board whose spindle has an encoder.
    pub(super) fn new(counts_per_turn: u32, rate: f64) -> Self {
        Self {
            track: Some(EncoderTrack::new(counts_per_turn, rate)),
            ..Self::default()
        }
    }

    /// Takes a report of the phase error of the thread in the board, thousandths of a pulse.
    pub(super) fn note_phase_error(&mut self, error: u32) {
        self.phase_error = self.phase_error.max(Some(error));
    }

    /// Begins a tap.
    pub(super) const fn begin_tap(&mut self, tap: BoardTap) {
        self.tap = Some(tap);
        self.phase_error = None;
    }

    /// Whether the motion of the kernel depends on the angle.
    pub(super) const fn is_planned(&self) -> bool {
        self.spindle.ticks_per_turn().is_some()
    }

    /// Whether a thread is in the board or on its way there.
    pub(super) const fn is_engaged(&self) -> bool {
        self.stretch.is_some()
    }

    /// Whether the next motion must wait for the end of a thread or tap in the board.
    pub(super) fn blocks_motion(&self) -> bool {
        self.tap.is_some()
            || !self.waiting.is_empty()
            || self.stretch.as_ref().is_some_and(|thread| thread.is_closed)
    }

    /// Drops the thread in the board, after a stop.
    pub(super) fn drop_motion(&mut self) {
        self.was_dropped |= self.stretch.take().is_some();
        self.waiting.clear();
    }

    /// Returns the path clock of a thread at the board clock `now`, ticks.
    fn path_clock(&self, now: Ticks) -> Ticks {
        match &self.stretch {
            None => now,
            Some(thread) if thread.progress.0 <= 0 => now.min(thread.begun),
            Some(thread) => thread.clock_at(thread.progress.0 as f64),
        }
    }
}

impl StepLink {
    /// Whether the spindle has an encoder at the board.
    pub(super) const fn has_spindle_encoder(&self) -> bool {
        !self.config.io.encoder.is_empty()
    }

    /// The board clock, in a thread that at the planned speed, ticks: the clock of the path.
    pub(super) fn path_now(&self) -> Ticks {
        self.angle
            .path_clock(self.clock.at(self.session.now) as Ticks)
    }

    /// Asks the board for periodic reports of the spindle encoder.
    pub(super) fn query_encoder(&mut self) {
        if let Some(oid) = self.wiring.as_ref().and_then(|wiring| wiring.spindle) {
            let at = self.soon();
            let every = self.clock.ticks(REPORT_EVERY) as i64;
            self.wire
                .send(Command::QueryEncoder, &[oid, i64::from(at as u32), every]);
        }
    }

    /// Returns the measured speed of the spindle, turns per second, negative if the encoder counts
    /// down.
    pub(super) fn measured_speed(&self) -> f64 {
        let now = self.clock.at(self.session.now) as Ticks;
        let track = self.angle.track.as_ref();
        track.map_or(0.0, |track| track.speed(now))
    }

    /// The spindle as its encoder reports it; `None` without an encoder.
    pub(super) fn encoder_reading(&self) -> Option<EncoderReading> {
        let track = self.angle.track.as_ref()?;
        let now = self.clock.at(self.session.now) as Ticks;
        Some(EncoderReading {
            angle: track.angle(),
            ripple: track.ripple(now),
            phase_error: self
                .angle
                .phase_error
                .map(|error| f64::from(error) / 1000.0),
        })
    }

    /// Takes the plan for the kernel's next tick; `None` if its motion does not depend on the
    /// angle of the spindle.
    pub(super) fn plan_thread_angle(&mut self, plan: Option<ThreadPlan>) {
        let measured = self.measured_speed().abs();
        let plan = plan.filter(|_| self.has_spindle_encoder());
        self.angle.spindle.follow(plan, measured);
    }

    /// Returns the spindle for the kernel's next tick: the planned one in a thread, else the
    /// measured speed.
    pub(super) fn next_angle_view(&mut self) -> SpindleView {
        let measured = self.measured_speed().abs();
        let shown = self.angle.spindle.turns[1];
        let [before, now] = self.angle.spindle.turn(measured);
        SpindleView {
            rpm: (now - before) * TICKS_PER_S * 60.0,
            before,
            now,
            passed: shown.floor() < now.floor(),
            // The angle is measured: the speed may vary.
            variation: (measured > 0.0).then_some(0.0),
            ..SpindleView::default()
        }
    }

    /// Takes a sample whose motion depends on the angle.
    ///
    /// # Errors
    /// The sample cannot begin a thread now.
    pub(super) fn take_angle_sample(
        &mut self,
        before: &Sample,
        sample: Sample,
    ) -> Result<(), MotionRefused> {
        let rests = sample.pulses == before.pulses && sample.fine == before.fine;
        if self.angle.blocks_motion() {
            return Err(MotionRefused::NotReady);
        }
        if self.angle.stretch.is_none() {
            if rests {
                // The board waits for the true index; the kernel's wait takes no time.
                self.motion.path.rest(sample);
                self.motion.path.rested = true;
                return Ok(());
            }
            self.begin_stretch(before)?;
        }
        let signs = self.direction_signs();
        let counts_per_turn = f64::from(self.config.io.encoder_counts);
        let turns = self
            .angle
            .spindle
            .turns
            .map(|turns| turns * counts_per_turn);
        let Some(thread) = &mut self.angle.stretch else {
            return Err(MotionRefused::NotReady);
        };
        thread.add(
            turns,
            fine_positions(before),
            fine_positions(&sample),
            signs,
        );
        let from = self
            .motion
            .path
            .end
            .unwrap_or(thread.begun)
            .max(thread.begun);
        let end = thread.clock_at(turns[1] - thread.start.0 as f64);
        self.motion.path.push(sample, from, end.max(from), rests);
        self.motion.count.commanded = sample.pulses;
        let flush_due = self.session.now + super::samples::FLUSH_EVERY;
        self.motion.queue.flush_due.get_or_insert(flush_due);
        self.motion.queue.last_step = None;
        self.session.enter(LinkState::Moving);
        Ok(())
    }

    /// The direction of the board's steps for positive pulses of each axis, 1 or -1.
    pub(super) fn direction_signs(&self) -> [i64; 2] {
        [&self.config.x, &self.config.z].map(
            |axis| {
                if axis.is_direction_inverted() { -1 } else { 1 }
            },
        )
    }

    /// Begins a thread at the position of `at`, at the start of the kernel's tick.
    fn begin_stretch(&mut self, at: &Sample) -> Result<(), MotionRefused> {
        let speed = self.measured_speed();
        if is_against(self.periodic.outputs.sent.spindle, speed) {
            return Err(MotionRefused::EncoderReversed);
        }
        self.compress();
        let begun = self.next_begin();
        let Some(ticks_per_turn) = self.angle.spindle.ticks_per_turn() else {
            return Err(MotionRefused::NotReady);
        };
        let counts_per_turn = i64::from(self.config.io.encoder_counts);
        let start =
            SpindleCounts(libm::floor(self.angle.spindle.turns[0] * counts_per_turn as f64) as i64);
        let per_second = counts_per_turn as f64 * TICKS_PER_S / ticks_per_turn;
        let base = fine_positions(at);
        let is_reverse = speed < 0.0;
        let mut thread = AngleStretch {
            begun,
            start,
            counts_per_tick: per_second / self.clock.rate,
            is_reverse,
            axes: Default::default(),
            base,
            is_closed: false,
            started: None,
            has_ended: [false; 2],
            progress: SpindleCounts(0),
            reported: begun,
            progressed: self.session.now,
            outgoing: VecDeque::new(),
            in_board: VecDeque::new(),
        };
        // The angle after the index, in the direction in which the encoder counts.
        let angle = if is_reverse { -start.0 } else { start.0 }.rem_euclid(counts_per_turn);
        let signs = self.direction_signs();
        let pulses = [at.pulses.x.0, at.pulses.z.0];
        let zero = [SpindleCounts(0); 2];
        for axis in 0..2 {
            let clock = i64::from(begun as u32);
            if !self.motion.queue.steps[axis].is_clock_set() {
                thread.push(Command::ResetStepClock, axis, &[clock], zero);
            }
            // The part of a pulse that the position already has; the kernel rounds to the nearest.
            let part = signs[axis] * (base[axis] - pulses[axis] * FINE) * PER_FINE;
            let phase = DENOMINATOR / 2 + part;
            let arguments = [clock, angle, DENOMINATOR, phase, is_reverse.into()];
            thread.push(Command::BeginAngle, axis, &arguments, zero);
        }
        self.angle.stretch = Some(thread);
        self.angle.phase_error = None;
        Ok(())
    }

    /// Queues the end of the thread: the kernel continues on the clock, or is at rest.
    pub(super) fn close_stretch(&mut self) {
        let signs = self.direction_signs();
        let end = fine_positions(&self.motion.path.newest);
        let Some(thread) = self
            .angle
            .stretch
            .as_mut()
            .filter(|thread| !thread.is_closed)
        else {
            return;
        };
        thread.queue_segments(Some((end, signs)));
        thread.is_closed = true;
        self.motion.path.finished = true;
        self.hand_over_angle();
    }

    /// Takes a sample on the clock while a thread is in the board: it waits for the end of the
    /// thread.
    pub(super) fn take_sample_after_thread(&mut self, sample: Sample) {
        self.close_stretch();
        let newest = self
            .angle
            .waiting
            .back()
            .unwrap_or(&self.motion.path.newest);
        let rests = sample.pulses == newest.pulses && sample.fine == newest.fine;
        if rests && self.angle.waiting.is_empty() {
            self.motion.path.rest(sample);
        } else {
            self.angle.waiting.push_back(sample);
        }
    }

    /// Converts the positions so far to segments and sends these.
    pub(super) fn compress_angle(&mut self) {
        if let Some(thread) = self
            .angle
            .stretch
            .as_mut()
            .filter(|thread| !thread.is_closed)
        {
            thread.queue_segments(None);
        }
        self.hand_over_angle();
    }

    /// Sends entries as far as the board's queue has free slots, after the steps on the clock.
    pub(super) fn hand_over_angle(&mut self) {
        let Some(axes) = self.wiring.as_ref().map(|wiring| wiring.axes) else {
            return;
        };
        let slots = self.motion.queue.slots;
        let others = self.motion.queue.queued.len();
        if !self.motion.queue.backlog.is_empty() {
            return;
        }
        let ratio = self.measured_speed().abs() * f64::from(self.config.io.encoder_counts)
            / self.clock.rate;
        let Some(thread) = &mut self.angle.stretch else {
            return;
        };
        thread.in_board.retain(|end| *end > thread.progress);
        let fastest = thread.counts_per_tick.max(ratio * FASTER);
        while let Some(message) = thread.outgoing.front().copied() {
            if thread.in_board.len() + others >= slots {
                break;
            }
            thread.outgoing.pop_front();
            thread.in_board.push_back(message.ends);
            let ahead = (message.begins - thread.progress).0.max(0) as f64;
            let due = match thread.started {
                Some(_) => thread.reported + (ahead / fastest) as Ticks,
                None => thread.begun + (message.begins.0 as f64 / fastest) as Ticks,
            };
            let oid = if message.axis == 0 { axes.x } else { axes.z };
            let mut arguments = vec![oid];
            arguments.extend(&message.arguments[..message.count]);
            self.wire
                .send_timed(message.command, &arguments, due.unsigned_abs());
            self.wire.traffic.segments += 1;
        }
    }

    /// Takes a report of the spindle encoder: object number, clock, count, count at the last index.
    pub(super) fn encoder_report(&mut self, [_, clock, count, index]: [u32; 4]) {
        let clock = near(clock, self.clock.at(self.session.now)) as Ticks;
        let (now, angle) = (self.session.now, &mut self.angle);
        let Some(track) = &mut angle.track else {
            return;
        };
        track.report(clock, count, index);
        if let (Some(tap), Some(count)) = (&mut angle.tap, track.count()) {
            tap.count_report(count, now);
        }
        if let (Some(thread), Some(count)) = (&mut angle.stretch, track.count())
            && let Some(started) = thread.started
        {
            let turned = count - started;
            let progress = SpindleCounts(if thread.is_reverse {
                -turned.0
            } else {
                turned.0
            });
            thread.reported = clock;
            if progress > thread.progress {
                thread.progressed = now;
            }
            thread.progress = progress;
        }
    }

    /// Takes a report of a thread: object number, 1 for the start and 0 for the end, count.
    pub(super) fn angle_report(&mut self, [oid, state, count, _]: [u32; 4]) {
        let Some(axes) = self.wiring.as_ref().map(|wiring| wiring.axes) else {
            return;
        };
        let axis = usize::from(i64::from(oid) == axes.z);
        let now = self.session.now;
        let known = last_count(self.angle.track.as_ref());
        if let Some(tap) = &mut self.angle.tap {
            tap.state_report(state, count, known, now);
        }
        let Some(thread) = &mut self.angle.stretch else {
            return;
        };
        if state == 0 {
            thread.has_ended[axis] = true;
            return;
        }
        let count = known + i64::from(count.wrapping_sub(known as u32) as i32);
        thread.started.get_or_insert(SpindleCounts(count));
        thread.progressed = now;
    }

    /// Ends a thread that the board has made, and watches one that it does not make.
    pub(super) fn watch_angle(&mut self) {
        let now = self.session.now;
        let speed = self.measured_speed().abs();
        let Some(thread) = &self.angle.stretch else {
            return;
        };
        if self.stopping.is_some() {
            return;
        }
        if thread.is_over(now) {
            return self.end_stretch();
        }
        let idle = now.saturating_sub(thread.progressed);
        let text = match thread.started {
            Some(_) if idle >= STALLED => say::spindle_stands_in_thread(),
            None => {
                let turns = Duration::from_secs_f64(UNBEGUN_TURNS / speed.max(0.05));
                if idle < UNBEGUN + turns {
                    return;
                }
                say::spindle_index_never()
            }
            Some(_) => return,
        };
        self.session.alarm(alarm::SPINDLE_ENCODER, text);
        self.halt(StopReason::SpindleStands);
    }

    /// Continues on the clock after the end of a thread in the board.
    fn end_stretch(&mut self) {
        self.angle.stretch = None;
        self.motion.path.pass(Ticks::MAX);
        self.motion.path.end_if_made();
        self.motion.queue.forget_steps();
        self.motion.queue.last_step = Some(self.clock.at(self.session.now) as Ticks);
        for sample in core::mem::take(&mut self.angle.waiting) {
            if let Err(refused) = self.take_sample(sample) {
                let (number, text) = refused.to_alarm();
                self.session.alarm(number, text);
                self.halt(StopReason::GroupSilent);
                return;
            }
        }
        // The kernel may have come to rest after them.
        if !self.angle.is_planned() && self.motion.path.end.is_none() {
            self.motion.path.finished = true;
        }
    }
}
