//! A straight cut that is made elsewhere: the drives follow the spindle by
//! themselves and tell now and then how far they have come.

use serde::{Deserialize, Serialize};

use super::path::Path;
use crate::units::Point;

/// A cut that is only followed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Driven {
    path: Path,
    /// It has been handed over: nothing here can stop it any more.
    begun: bool,
    /// Way still to go as shown, and as told last, mm.
    rest: f64,
    told: f64,
    /// What the shown place makes good a tick, mm, and ticks since the last word.
    pace: f64,
    ticks: u32,
}

impl Driven {
    pub(super) fn new(from: Point, to: Point) -> Self {
        let path = Path::line(from, to);
        Self {
            path,
            begun: false,
            rest: path.length(),
            told: path.length(),
            pace: 0.0,
            ticks: 0,
        }
    }

    pub(super) const fn to(&self) -> Point {
        self.path.to()
    }

    pub(super) const fn is_begun(&self) -> bool {
        self.begun
    }

    pub(super) const fn begin(&mut self) {
        self.begun = true;
    }

    /// The part of the way that is made. It is shown as going on evenly until the
    /// next word, and never beyond what was told.
    pub(super) fn tell(&mut self, share: f64) {
        let told = self.path.length() * (1.0 - share.clamp(0.0, 1.0));
        self.told = self.told.min(told);
        self.pace = (self.rest - self.told) / f64::from(self.ticks.max(1));
        self.ticks = 0;
    }

    pub(super) fn advance(&mut self) {
        self.ticks = self.ticks.saturating_add(1);
        self.rest = (self.rest - self.pace).max(self.told);
    }

    pub(super) fn is_moving(&self) -> bool {
        self.rest > self.told
    }

    pub(super) fn position(&self) -> Point {
        self.path.at(self.rest)
    }

    pub(super) fn translated(self, by: Point) -> Self {
        Self {
            path: self.path.translated(by),
            ..self
        }
    }
}
