//! A straight cut that a board makes: its drives follow the spindle and report their
//! progress now and then.

use serde::{Deserialize, Serialize};

use super::path::Path;
use crate::units::Point;

/// A cut whose progress the control only follows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Driven {
    path: Path,
    /// Whether the board has taken the cut. The control can then no longer stop it.
    #[serde(rename = "begun")]
    begun: bool,
    /// Distance to go as shown, and as last reported, mm.
    #[serde(rename = "rest")]
    rest: f64,
    #[serde(rename = "told")]
    told: f64,
    /// Distance that the shown position makes per tick, mm, and ticks since the last
    /// report.
    #[serde(rename = "pace")]
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

    /// Takes the fraction of the cut that is made. The shown position moves evenly until
    /// the next report, and never beyond the reported one.
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
