//! A tap: the board follows the spindle in, through its stop and reversal, and back to the start.
//! The link sends all of it at once and then follows the angle that the board reports.
//!
//! ```text
//!  kernel  order ─► entry of the board ─► reports of the encoder ─► depth for the kernel
//!  board   start ... depth ... M05, run-on, reversal ... start: `angle_state` 0 ─► count verified
//! ```

use core::time::Duration;

use super::super::StepLink;
use super::super::stops::StopReason;
use super::stretch::fine_positions;
use super::{STALLED, UNBEGUN, UNBEGUN_TURNS};
use crate::step_queue::commands::Command;
use crate::step_queue::spindle_angle::{EncoderTrack, SpindleCounts};
use crate::step_queue::step_compress::Ticks;
use crate::step_queue::tap_path::{TAP_DENOMINATOR, TapPath};
use crate::{
    Backend, FINE, HostTime, Input, LinkState, PassError, Sample, SpindleDirection, TapCapability,
    TapOrder,
};
use gsk_messages::say;
use gsk_units::{Axis, PerAxis, Pulses, alarm};

/// Time within which a spindle must stop, reverse and turn again: then the tap is given up.
const REVERSAL: Duration = Duration::from_secs(5);
/// Time without a report of the end after which a tap back at its start has ended.
const END_LOST: Duration = Duration::from_millis(60);
/// Share by which the spindle may be faster than its measured speed at a stop.
const FASTER: f64 = 1.25;

/// A tap in the board.
#[derive(Clone, Copy, Debug)]
pub(in crate::step_queue::session) struct BoardTap {
    order: TapOrder,
    path: TapPath,
    is_reverse: bool,
    /// Count of the encoder at the start; `None` before it.
    started: Option<SpindleCounts>,
    /// Counts from the start at the last report, negative before it, and the host time of the last
    /// change.
    progress: SpindleCounts,
    progressed: HostTime,
    has_been_deep: bool,
    /// Host time at which a report has first shown the spindle back at the start.
    back_since: Option<HostTime>,
    has_ended: bool,
    /// Commanded direction of the spindle, and the host time of its last change.
    commanded: (SpindleDirection, HostTime),
}

impl BoardTap {
    /// Takes the report of the start (`state` 1) or of the end (0), with the low half of the count;
    /// `known` is the last count.
    pub(super) fn state_report(&mut self, state: u32, low: u32, known: i64, now: HostTime) {
        if state == 0 {
            self.has_ended = true;
            return;
        }
        let count = known + i64::from(low.wrapping_sub(known as u32) as i32);
        self.started.get_or_insert(SpindleCounts(count));
        self.progressed = now;
    }

    /// Takes a report of the count of the encoder.
    pub(super) fn count_report(&mut self, count: SpindleCounts, now: HostTime) {
        let Some(started) = self.started else {
            return;
        };
        let turned = count - started;
        let progress = SpindleCounts(if self.is_reverse { -turned.0 } else { turned.0 });
        if progress != self.progress {
            self.progressed = now;
        }
        self.progress = progress;
        self.has_been_deep |= progress >= self.path.depth;
        if self.has_been_deep && progress.0 <= 0 {
            self.back_since.get_or_insert(now);
        }
    }

    /// Returns the distance from the start, pulses.
    fn distance(&self) -> f64 {
        if self.has_ended || self.back_since.is_some() {
            return 0.0;
        }
        self.path.distance(self.progress)
    }

    /// Returns the position by the last report, in the kernel's pulses.
    fn position(&self) -> PerAxis<Pulses> {
        let PerAxis { x, z } = self.order.start;
        let moved = libm::round(self.distance().copysign(self.order.depth)) as i64;
        PerAxis::new(x, Pulses(z.0 + moved))
    }

    fn is_over(&self, now: HostTime) -> bool {
        let is_lost = |since| now.saturating_sub(since) >= END_LOST;
        self.has_ended || self.back_since.is_some_and(is_lost)
    }

    /// Returns the host time from which on a tap without progress is given up.
    fn stalled_at(&self) -> HostTime {
        match self.commanded {
            (SpindleDirection::Stop, _) => self.progressed + REVERSAL,
            (_, since) => (self.progressed + STALLED).max(since + REVERSAL),
        }
    }
}

/// A tap that a stop has ended.
#[derive(Clone, Copy, Debug)]
pub(in crate::step_queue::session) struct StoppedTap {
    order: TapOrder,
    /// Speed of Z at the stop, mm/min, and its direction.
    pub(in crate::step_queue::session) speed: f64,
    pub(in crate::step_queue::session) direction: i64,
}

impl StoppedTap {
    /// Whether a position in the kernel's pulses is between the start of the tap and its bound.
    pub(in crate::step_queue::session) fn contains(&self, kernel: PerAxis<Pulses>) -> bool {
        let start = self.order.start;
        let inwards = (kernel.z.0 - start.z.0) as f64 * 1_f64.copysign(self.order.depth);
        let deepest = self.order.bound.max(self.order.depth.abs()) + 1.0;
        kernel.x == start.x && (-1.0..=deepest).contains(&inwards)
    }
}

impl StepLink {
    /// Returns whether the board can tap, or what is missing.
    pub(in crate::step_queue::session) fn tap_capability(&self) -> TapCapability {
        if !self.has_spindle_encoder() {
            TapCapability::NoEncoder
        } else if self.wire.dictionary.has(Command::BeginTap) {
            TapCapability::Followed
        } else {
            TapCapability::OldFirmware
        }
    }

    /// Sends a tap to the board.
    ///
    /// # Errors
    /// The unmet condition; nothing was sent.
    pub(in crate::step_queue::session) fn begin_tap(
        &mut self,
        order: &TapOrder,
    ) -> Result<(), PassError> {
        let stands = self.session.state == LinkState::Ready
            && self.stopping.is_none()
            && !self.opening.is_shut_down()
            && !self.motion.is_under_way()
            && !self.angle.is_engaged()
            && self.angle.tap.is_none()
            && self.motion.count.commanded == order.start;
        if !stands || self.tap_capability() != TapCapability::Followed {
            return Err(PassError::NotReady);
        }
        if self.input(Input::LimitZ) == Some(true) {
            return Err(PassError::Limit(Axis::Z));
        }
        let speed = self.measured_speed();
        let sent = self.periodic.outputs.sent.spindle;
        if speed == 0.0 {
            return Err(PassError::Standing);
        }
        if is_against(sent, speed) {
            return Err(PassError::EncoderReversed);
        }
        let path = TapPath::new(order, self.config.io.encoder_counts);
        let path = path.ok_or(PassError::TapLead)?;
        let turn_s = 1.0 / (speed.abs() * FASTER);
        let turn = [0, libm::ceil(order.lead) as i64];
        let allowed = self.motion.rates.allow(turn, turn_s);
        allowed.map_err(|_| PassError::TapLead)?;
        // The answer to a query at standstill would end the tap as verified.
        self.query.pending = None;
        self.send_tap(order, &path, speed < 0.0);
        self.angle.begin_tap(BoardTap {
            order: *order,
            path,
            is_reverse: speed < 0.0,
            started: None,
            progress: SpindleCounts(0),
            progressed: self.session.now,
            has_been_deep: false,
            back_since: None,
            has_ended: false,
            commanded: (sent, HostTime::ZERO),
        });
        self.motion.queue.last_step = None;
        self.session.enter(LinkState::Moving);
        Ok(())
    }

    fn send_tap(&mut self, order: &TapOrder, path: &TapPath, is_reverse: bool) {
        let Some(oid) = self.wiring.as_ref().map(|wiring| wiring.axes.z) else {
            return;
        };
        let begun = self.farthest();
        let clock = i64::from(begun as u32);
        let due = begun.unsigned_abs();
        if !self.motion.queue.steps[1].is_clock_set() {
            self.wire
                .send_timed(Command::ResetStepClock, &[oid, clock], due);
        }
        let counts_per_turn = i64::from(self.config.io.encoder_counts);
        let turns = order.start_degrees / 360.0;
        let start = libm::round(turns * counts_per_turn as f64) as i64;
        // The angle after the index, in the direction in which the encoder counts.
        let angle = if is_reverse { -start } else { start }.rem_euclid(counts_per_turn);
        let sign = self.direction_signs()[1];
        // The part of a pulse that the position already has; the kernel rounds to the nearest.
        let newest = &self.motion.path.newest;
        let part = fine_positions(newest)[1] - newest.pulses.z.0 * FINE;
        let phase = TAP_DENOMINATOR / 2 + sign * part * (TAP_DENOMINATOR / FINE);
        let begin = [
            oid,
            clock,
            angle,
            TAP_DENOMINATOR,
            phase,
            is_reverse.into(),
            path.depth.0,
        ];
        self.wire.send_timed(Command::BeginTap, &begin, due);
        let inwards = if order.depth < 0.0 { -sign } else { sign };
        for [length, numerator, add] in path.segments(inwards) {
            let segment = [oid, length, numerator, add];
            self.wire.send_timed(Command::QueueAngle, &segment, due);
        }
        self.wire.send_timed(Command::EndAngle, &[oid], due);
        self.wire.traffic.segments += 1;
        self.send();
    }

    /// Returns the distance of the tap in the board from its start by the last report, pulses;
    /// `None` without a tap.
    pub(in crate::step_queue::session) fn tap_distance(&self) -> Option<f64> {
        self.angle.tap.as_ref().map(BoardTap::distance)
    }

    /// Takes a sample while a tap is in the board: only the time passes.
    pub(in crate::step_queue::session) fn pass_time_in_tap(&mut self, sample: Sample) {
        let newest = self.motion.path.newest;
        self.motion.path.rest(Sample {
            end: sample.end,
            ..newest
        });
    }

    /// Ends a tap that the board has made, and stops one that the spindle does not make.
    pub(in crate::step_queue::session) fn watch_tap(&mut self) {
        let (now, speed) = (self.session.now, self.measured_speed().abs());
        let sent = self.periodic.outputs.sent.spindle;
        let Some(tap) = self.angle.tap.as_mut() else {
            return;
        };
        if tap.commanded.0 != sent {
            tap.commanded = (sent, now);
        }
        if self.stopping.is_some() {
            return;
        }
        if tap.is_over(now) {
            self.angle.tap = None;
            self.motion.queue.forget_steps();
            // The count is read and compared with the start.
            self.motion.queue.last_step = Some(self.clock.at(now) as Ticks);
            return;
        }
        let text = if tap.started.is_some() {
            if now < tap.stalled_at() {
                return;
            }
            say::spindle_stands_in_tap()
        } else {
            let turns = Duration::from_secs_f64(UNBEGUN_TURNS / speed.max(0.05));
            if now.saturating_sub(tap.progressed) < UNBEGUN + turns {
                return;
            }
            say::spindle_index_never()
        };
        self.session.alarm(alarm::SPINDLE_ENCODER, text);
        self.halt(StopReason::SpindleStands);
    }

    /// Returns the position by the last report of a tap, in the kernel's pulses; `None` without a
    /// tap.
    pub(in crate::step_queue::session) fn tap_position(&self) -> Option<PerAxis<Pulses>> {
        self.angle.tap.as_ref().map(BoardTap::position)
    }

    /// Drops the tap in the board, after a stop; keeps what the position of the stop depends on.
    pub(in crate::step_queue::session) fn drop_tap(&mut self) {
        let speed = self.measured_speed();
        let Some(tap) = self.angle.tap.take() else {
            return;
        };
        let lead_mm = tap.order.lead / self.pulses_per_mm[1];
        let is_in = (speed < 0.0) == tap.is_reverse;
        let inwards = if tap.order.depth < 0.0 { -1 } else { 1 };
        let has_begun = tap.started.is_some() && speed != 0.0;
        self.angle.stopped_tap = Some(StoppedTap {
            order: tap.order,
            speed: speed.abs() * FASTER * lead_mm * 60.0,
            direction: match (has_begun, is_in) {
                (false, _) => 0,
                (true, true) => inwards,
                (true, false) => -inwards,
            },
        });
    }
}

/// Whether the encoder counts against the commanded direction; `speed` is negative if it counts
/// down.
pub(super) fn is_against(commanded: SpindleDirection, speed: f64) -> bool {
    match commanded {
        SpindleDirection::Forward => speed < 0.0,
        SpindleDirection::Reverse => speed > 0.0,
        SpindleDirection::Stop => false,
    }
}

/// Returns the last count of the encoder; 0 before its first report.
pub(super) fn last_count(track: Option<&EncoderTrack>) -> i64 {
    track.and_then(EncoderTrack::count).unwrap_or_default().0
}
