//! What the host configures besides steppers.

use std::collections::VecDeque;

/// A switch.
#[derive(Clone, Debug, Default)]
pub(super) struct Endstop {
    pub(super) pin: u32,
    /// Next look; none: nobody waits for it.
    pub(super) next: Option<i64>,
    pub(super) sample_ticks: i64,
    pub(super) sample_count: u32,
    pub(super) rest_ticks: i64,
    pub(super) level: bool,
    pub(super) trsync: u32,
    pub(super) reason: u32,
    /// Samples that agreed so far.
    pub(super) matching_samples: u32,
}

impl Endstop {
    /// Looks at the pin; whether it has been operated long enough.
    pub(super) fn sample_level(&mut self, level: bool) -> bool {
        let Some(now) = self.next else {
            return false;
        };
        if level != self.level {
            // Back to the pace of slow looks.
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

/// A stop group.
#[derive(Clone, Debug, Default)]
pub(super) struct Trsync {
    pub(super) can_trigger: bool,
    pub(super) reason: u32,
    pub(super) expire_reason: u32,
    pub(super) expires: Option<i64>,
    pub(super) report: Option<i64>,
    pub(super) report_ticks: i64,
}

/// An output, switched or of pulse width.
#[derive(Clone, Debug, Default)]
pub(super) struct Output {
    pub(super) pin: u32,
    pub(super) default: u32,
    pub(super) max_duration: i64,
    pub(super) queue: VecDeque<(i64, u32)>,
    /// When it must have been told again.
    pub(super) max_duration_end: Option<i64>,
    pub(super) pulse_width: bool,
}

impl Output {
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

/// A counter of edges.
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
