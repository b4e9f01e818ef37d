//! Cylinders with two end positions and two outputs (chuck, tailstock), and the gearbox.

use serde::{Deserialize, Serialize};

/// A simulated cylinder with two end positions. Without an output it keeps its
/// position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Cylinder {
    /// Position, ms of travel: 0 = second end, `travel` = first end.
    #[serde(rename = "place")]
    position_ms: u32,
    #[serde(rename = "travel")]
    travel_ms: u32,
}

impl Cylinder {
    /// Creates a cylinder at its second end; `travel_ms` is the time from end to end.
    pub fn new(travel_ms: u32) -> Self {
        Self {
            position_ms: 0,
            travel_ms: travel_ms.max(1),
        }
    }

    /// Advances by one tick (1 ms) with the outputs towards the first and the second end.
    pub fn tick(&mut self, to_first: bool, to_second: bool) {
        if to_first && !to_second {
            self.position_ms = (self.position_ms + 1).min(self.travel_ms);
        } else if to_second && !to_first {
            self.position_ms = self.position_ms.saturating_sub(1);
        }
    }

    /// Whether the cylinder is at the first end.
    pub(crate) const fn is_at_first_end(&self) -> bool {
        self.position_ms == self.travel_ms
    }

    /// Whether the cylinder is at the second end.
    pub(crate) const fn is_at_second_end(&self) -> bool {
        self.position_ms == 0
    }
}

/// The simulated gearbox: a gear is in position some time after its output switches on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Gearbox {
    gear: u8,
    since: u32,
    travel: u32,
}

impl Gearbox {
    /// Creates a gearbox in gear 1, in position; `travel_ms` is the time of a gear change.
    pub fn new(travel_ms: u32) -> Self {
        Self {
            gear: 1,
            since: travel_ms,
            travel: travel_ms,
        }
    }

    /// Advances by one tick (1 ms); `output` is the gear whose output is on, from 1.
    pub fn tick(&mut self, output: Option<u8>) {
        match output {
            Some(gear) if gear != self.gear => {
                self.gear = gear;
                self.since = 0;
            }
            _ => self.since = (self.since + 1).min(self.travel),
        }
    }

    /// The gear that is engaged or being engaged, from 1.
    pub const fn gear(&self) -> u8 {
        self.gear
    }

    /// Whether the gear with this number is in position.
    pub(crate) const fn is_in_position(&self, gear: u8) -> bool {
        self.gear == gear && self.since >= self.travel
    }
}
