//! What the host configures besides steppers.

use std::collections::VecDeque;

/// A switch.
#[derive(Clone, Debug, Default)]
pub(super) struct Endstop {
    pub(super) pin: u32,
    /// Next look; none: nobody waits for it.
    pub(super) next: Option<i64>,
    pub(super) sample: i64,
    pub(super) samples: u32,
    pub(super) rest: i64,
    pub(super) level: bool,
    pub(super) group: u32,
    pub(super) reason: u32,
    /// Samples that agreed so far.
    pub(super) agreed: u32,
}

impl Endstop {
    /// Looks at the pin; whether it has been operated long enough.
    pub(super) fn look(&mut self, level: bool) -> bool {
        let Some(now) = self.next else {
            return false;
        };
        if level != self.level {
            // Back to the pace of slow looks.
            let behind = i64::from(self.agreed) * self.sample;
            self.next = Some(now - behind + self.rest);
            self.agreed = 0;
            return false;
        }
        self.agreed += 1;
        self.next = Some(now + self.sample);
        if self.agreed < self.samples {
            return false;
        }
        self.next = None;
        true
    }
}

/// A stop group.
#[derive(Clone, Debug, Default)]
pub(super) struct Group {
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
    pub(super) longest: i64,
    pub(super) queue: VecDeque<(i64, u32)>,
    /// When it must have been told again.
    pub(super) until: Option<i64>,
    pub(super) pulse_width: bool,
}

impl Output {
    pub(super) const fn missed(&self) -> &'static str {
        if self.pulse_width {
            "Missed scheduling of next hard pwm event"
        } else {
            "Missed scheduling of next digital out event"
        }
    }

    pub(super) const fn exceeds(&self) -> &'static str {
        if self.pulse_width {
            "Scheduled pwm event will exceed max_duration"
        } else {
            "Scheduled digital out event will exceed max_duration"
        }
    }

    pub(super) fn due(&self) -> Option<i64> {
        self.queue.front().map(|(clock, _)| *clock).or(self.until)
    }
}

/// A counter of edges.
#[derive(Clone, Debug, Default)]
pub(super) struct Counter {
    pub(super) pin: u32,
    pub(super) next: Option<i64>,
    pub(super) poll: i64,
    pub(super) report: i64,
    pub(super) report_every: i64,
    pub(super) level: bool,
    pub(super) count: u32,
    pub(super) count_clock: i64,
}
