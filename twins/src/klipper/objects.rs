//! Objects that the host configures besides steppers.

use std::collections::VecDeque;

/// A switch input that stops steppers through its trsync during homing.
#[derive(Clone, Debug, Default)]
pub(super) struct Endstop {
    pub(super) pin: u32,
    /// Clock of the next sample, ticks; `None` if homing is not active.
    pub(super) next: Option<i64>,
    pub(super) sample_ticks: i64,
    pub(super) sample_count: u32,
    pub(super) rest_ticks: i64,
    pub(super) level: bool,
    pub(super) trsync: u32,
    pub(super) reason: u32,
    /// Number of successive samples with the expected level.
    pub(super) matching_samples: u32,
}

impl Endstop {
    /// Samples the pin. Returns true if the switch has had the expected level for the required
    /// number of samples.
    pub(super) fn sample_level(&mut self, level: bool) -> bool {
        let Some(now) = self.next else {
            return false;
        };
        if level != self.level {
            // Return to the slow sampling interval.
            let elapsed = i64::from(self.matching_samples) * self.sample_ticks;
            self.next = Some(now - elapsed + self.rest_ticks);
            self.matching_samples = 0;
            return false;
        }
        self.matching_samples += 1;
        self.next = Some(now + self.sample_ticks);
        if self.matching_samples < self.sample_count {
            return false;
        }
        self.next = None;
        true
    }
}

/// A group of steppers that stop together (Klipper's `trsync`).
#[derive(Clone, Debug, Default)]
pub(super) struct Trsync {
    pub(super) can_trigger: bool,
    pub(super) reason: u32,
    pub(super) expire_reason: u32,
    pub(super) expires: Option<i64>,
    pub(super) report: Option<i64>,
    pub(super) report_ticks: i64,
}

/// A digital or PWM output with its queue of future values.
#[derive(Clone, Debug, Default)]
pub(super) struct TwinOutput {
    pub(super) pin: u32,
    pub(super) default: u32,
    pub(super) max_duration: i64,
    pub(super) queue: VecDeque<(i64, u32)>,
    /// Clock, ticks, until which the host must renew the value; `None` without a limit.
    pub(super) max_duration_end: Option<i64>,
    pub(super) pulse_width: bool,
}

impl TwinOutput {
    pub(super) const fn missed_reason(&self) -> &'static str {
        if self.pulse_width {
            "Missed scheduling of next hard pwm event"
        } else {
            "Missed scheduling of next digital out event"
        }
    }

    pub(super) const fn exceeded_reason(&self) -> &'static str {
        if self.pulse_width {
            "Scheduled pwm event will exceed max_duration"
        } else {
            "Scheduled digital out event will exceed max_duration"
        }
    }

    pub(super) fn due(&self) -> Option<i64> {
        self.queue
            .front()
            .map(|(clock, _)| *clock)
            .or(self.max_duration_end)
    }
}

/// A counter of level changes at an input.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgeCounter {
    pub(super) pin: u32,
    pub(super) next: Option<i64>,
    pub(super) poll: i64,
    pub(super) report: i64,
    pub(super) report_every: i64,
    pub(super) level: bool,
    pub(super) count: u32,
    pub(super) count_clock: i64,
}
