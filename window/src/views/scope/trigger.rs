//! Decides when the picture of the scope stops: at the start of a motion, or at an edge of a
//! bit.

use gsk_core::units::Point;
use gsk_host::kernel::probe::ScopeSample;

/// Ticks of standstill after which a motion counts as a new one.
const STANDSTILL_TICKS: u32 = 20;
/// Speed below which the spindle counts as stopped, r/min.
const SPINDLE_STOPPED_RPM: f64 = 1.0;

/// The event for which the trigger of the scope waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TriggerSource {
    /// The trigger waits until an axis begins to move.
    Motion,
    /// The trigger waits until the spindle begins to turn.
    Spindle,
    /// The trigger waits until the watched bit with this index becomes 1.
    BitRises(usize),
    /// The trigger waits until the watched bit with this index becomes 0.
    BitFalls(usize),
}

/// How often the trigger stops the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TriggerMode {
    /// The trigger never stops the picture.
    Off,
    /// The trigger stops the picture at each event, until the next event.
    Each,
    /// The trigger stops the picture at the first event; then the scope stops.
    Once,
}

/// Checks the samples one after the other for the event of the trigger.
#[derive(Clone, Debug)]
pub struct Trigger {
    pub mode: TriggerMode,
    pub source: TriggerSource,
    /// The tick of the event, while the rest of the picture fills; `None` before the event.
    event_tick: Option<u64>,
    last_sample: Option<ScopeSample>,
    still_ticks: u32,
}

impl Trigger {
    /// Creates a trigger that is switched off.
    pub const fn new() -> Self {
        Self {
            mode: TriggerMode::Off,
            source: TriggerSource::Motion,
            event_tick: None,
            last_sample: None,
            still_ticks: 0,
        }
    }

    /// Arms the trigger for the next event.
    pub const fn arm(&mut self) {
        self.event_tick = None;
        self.last_sample = None;
        self.still_ticks = 0;
    }

    /// Whether the event has occurred and the rest of the picture is filling.
    pub const fn has_fired(&self) -> bool {
        self.event_tick.is_some()
    }

    /// Checks the next sample. Returns the tick of the event once `after` ticks have followed
    /// the event; else `None`.
    pub fn check_sample(&mut self, sample: &ScopeSample, after: u64) -> Option<u64> {
        if self.mode == TriggerMode::Off {
            return None;
        }
        let edge = self
            .last_sample
            .as_ref()
            .is_some_and(|last| self.is_edge(last, sample));
        let is_moving = self
            .last_sample
            .is_some_and(|last| last.commanded != sample.commanded);
        self.still_ticks = if is_moving {
            0
        } else {
            self.still_ticks.saturating_add(1)
        };
        self.last_sample = Some(*sample);
        if self.event_tick.is_none() && edge {
            self.event_tick = Some(sample.tick);
        }
        let edge = self.event_tick?;
        if sample.tick < edge + after {
            return None;
        }
        self.event_tick = None;
        Some(edge)
    }

    fn is_edge(&self, last: &ScopeSample, now: &ScopeSample) -> bool {
        let bit = |sample: &ScopeSample, bit_index: usize| sample.bits >> bit_index & 1 == 1;
        match self.source {
            TriggerSource::Motion => {
                let motion: Point = now.commanded - last.commanded;
                motion.length() > 0.0 && self.still_ticks >= STANDSTILL_TICKS
            }
            TriggerSource::Spindle => {
                // Without an encoder the commanded speed counts.
                let speed = |sample: &ScopeSample| {
                    let seen = sample.spindle_rpm.unwrap_or(sample.commanded_spindle_rpm);
                    seen.abs()
                };
                speed(last) < SPINDLE_STOPPED_RPM && speed(now) >= SPINDLE_STOPPED_RPM
            }
            TriggerSource::BitRises(bit_index) => !bit(last, bit_index) && bit(now, bit_index),
            TriggerSource::BitFalls(bit_index) => bit(last, bit_index) && !bit(now, bit_index),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(tick: u64, z: f64, bits: u32) -> ScopeSample {
        ScopeSample {
            tick,
            commanded: Point::new(0.0, z),
            bits,
            ..ScopeSample::default()
        }
    }

    #[test]
    fn motion_after_standstill_fires_once_the_picture_is_full() {
        let mut trigger = Trigger::new();
        trigger.mode = TriggerMode::Each;
        let place = |tick: u64| tick.saturating_sub(40) as f64 * 0.01;
        let found: Vec<u64> = (1..=100)
            .filter_map(|tick| trigger.check_sample(&sample(tick, place(tick), 0), 30))
            .collect();
        // Tick 41 is the first with another position.
        assert_eq!(found, [41]);
    }

    #[test]
    fn edges_of_bits() {
        for (source, expected) in [
            (TriggerSource::BitRises(3), 10),
            (TriggerSource::BitFalls(3), 20),
        ] {
            let mut trigger = Trigger::new();
            trigger.mode = TriggerMode::Once;
            trigger.source = source;
            let bits = |tick| if (10..20).contains(&tick) { 8 } else { 0 };
            let found =
                (1..=40).find_map(|tick| trigger.check_sample(&sample(tick, 0.0, bits(tick)), 5));
            assert_eq!(found, Some(expected));
        }
    }
}
