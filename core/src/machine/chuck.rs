//! Things with two places moved by two outputs: chuck, tailstock; and gears.

use serde::{Deserialize, Serialize};

/// A cylinder between two places; without output it stays where it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Cylinder {
    /// 0 = second place … `travel` = first place, ms of travel.
    place: u32,
    travel: u32,
}

impl Cylinder {
    /// In its second place.
    pub fn new(travel_ms: u32) -> Self {
        Self {
            place: 0,
            travel: travel_ms.max(1),
        }
    }

    /// One millisecond.
    pub fn tick(&mut self, to_first: bool, to_second: bool) {
        if to_first && !to_second {
            self.place = (self.place + 1).min(self.travel);
        } else if to_second && !to_first {
            self.place = self.place.saturating_sub(1);
        }
    }

    /// In the first place.
    pub(crate) const fn in_first(&self) -> bool {
        self.place == self.travel
    }

    /// In the second place.
    pub(crate) const fn in_second(&self) -> bool {
        self.place == 0
    }
}

/// The gearbox: the gear of the output is in position some time after it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Gearbox {
    gear: u8,
    since: u32,
    travel: u32,
}

impl Gearbox {
    /// In gear 1, in position.
    pub fn new(travel_ms: u32) -> Self {
        Self {
            gear: 1,
            since: travel_ms,
            travel: travel_ms,
        }
    }

    /// One millisecond; `output` is the gear whose output is on.
    pub fn tick(&mut self, output: Option<u8>) {
        match output {
            Some(gear) if gear != self.gear => {
                self.gear = gear;
                self.since = 0;
            }
            _ => self.since = (self.since + 1).min(self.travel),
        }
    }

    /// The gear engaged or being engaged.
    pub const fn gear(&self) -> u8 {
        self.gear
    }

    /// Whether this gear is in position.
    pub(crate) const fn in_position(&self, gear: u8) -> bool {
        self.gear == gear && self.since >= self.travel
    }
}
