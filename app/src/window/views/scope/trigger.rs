//! Decides when the picture of the scope stops: at the start of a motion, or at an edge of a
//! bit.

use gsk_core::units::Point;

use crate::kernel::probe::Sample;

/// Ticks of standstill before a motion counts as a new one.
const STANDSTILL: u32 = 20;
/// Speed below which the spindle counts as stopped, r/min.
const SPINDLE_STANDS: f64 = 1.0;

/// The event that the trigger waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// An axis begins to move.
    Motion,
    /// The spindle begins to turn.
    Spindle,
    /// A watched bit becomes 1.
    BitRises(usize),
    /// A watched bit becomes 0.
    BitFalls(usize),
}

/// How often the trigger stops the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Never: the picture rolls.
    Off,
    /// At each event, until the next.
    Each,
    /// At the first event; then the scope stops.
    Once,
}

/// Checks the samples one after the other.
#[derive(Clone, Debug)]
pub struct Trigger {
    pub mode: Mode,
    pub source: Source,
    /// The tick of the event, while the rest of the picture fills.
    fired: Option<u64>,
    last: Option<Sample>,
    still: u32,
}

impl Trigger {
    /// Creates a trigger that is off.
    pub const fn new() -> Self {
        Self {
            mode: Mode::Off,
            source: Source::Motion,
            fired: None,
            last: None,
            still: 0,
        }
    }

    /// Waits for the next event.
    pub const fn arm(&mut self) {
        self.fired = None;
        self.last = None;
        self.still = 0;
    }

    /// Whether the event has occurred and the rest of the picture fills.
    pub const fn fired(&self) -> bool {
        self.fired.is_some()
    }

    /// Checks the next sample. Returns the tick of the event once `after` ticks have followed
    /// it.
    pub fn look(&mut self, sample: &Sample, after: u64) -> Option<u64> {
        if self.mode == Mode::Off {
            return None;
        }
        let edge = self
            .last
            .as_ref()
            .is_some_and(|last| self.edge(last, sample));
        let moves = self
            .last
            .is_some_and(|last| last.commanded != sample.commanded);
        self.still = if moves {
            0
        } else {
            self.still.saturating_add(1)
        };
        self.last = Some(*sample);
        if self.fired.is_none() && edge {
            self.fired = Some(sample.tick);
        }
        let edge = self.fired?;
        if sample.tick < edge + after {
            return None;
        }
        self.fired = None;
        Some(edge)
    }

    fn edge(&self, last: &Sample, now: &Sample) -> bool {
        let bit = |sample: &Sample, place: usize| sample.bits >> place & 1 == 1;
        match self.source {
            Source::Motion => {
                let way: Point = now.commanded - last.commanded;
                way.length() > 0.0 && self.still >= STANDSTILL
            }
            Source::Spindle => {
                // Without an encoder the commanded speed counts.
                let speed = |sample: &Sample| {
                    let seen = sample.spindle.unwrap_or(sample.spindle_commanded);
                    seen.abs()
                };
                speed(last) < SPINDLE_STANDS && speed(now) >= SPINDLE_STANDS
            }
            Source::BitRises(place) => !bit(last, place) && bit(now, place),
            Source::BitFalls(place) => bit(last, place) && !bit(now, place),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(tick: u64, z: f64, bits: u32) -> Sample {
        Sample {
            tick,
            commanded: Point::new(0.0, z),
            bits,
            ..Sample::default()
        }
    }

    #[test]
    fn motion_after_standstill_fires_once_the_picture_is_full() {
        let mut trigger = Trigger::new();
        trigger.mode = Mode::Each;
        let place = |tick: u64| tick.saturating_sub(40) as f64 * 0.01;
        let found: Vec<u64> = (1..=100)
            .filter_map(|tick| trigger.look(&sample(tick, place(tick), 0), 30))
            .collect();
        // Tick 41 is the first with another position.
        assert_eq!(found, [41]);
    }

    #[test]
    fn edges_of_bits() {
        for (source, expected) in [(Source::BitRises(3), 10), (Source::BitFalls(3), 20)] {
            let mut trigger = Trigger::new();
            trigger.mode = Mode::Once;
            trigger.source = source;
            let bits = |tick| if (10..20).contains(&tick) { 8 } else { 0 };
            let found = (1..=40).find_map(|tick| trigger.look(&sample(tick, 0.0, bits(tick)), 5));
            assert_eq!(found, Some(expected));
        }
    }
}
