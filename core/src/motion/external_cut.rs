//! A straight cut that a board makes: its drives follow the spindle, and it reports its progress
//! from time to time.

use serde::{Deserialize, Serialize};

use super::path::CutPath;
use crate::units::Point;

/// A cut that a board makes and whose progress the control only follows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct ExternalCut {
    path: CutPath,
    /// Whether the board has started the cut. The control can then no longer stop it.
    #[serde(rename = "begun")]
    is_begun: bool,
    /// Distance to go from the displayed position, mm. `reported_remaining` is the distance to go
    /// that the board last reported, mm.
    #[serde(rename = "rest")]
    remaining: f64,
    #[serde(rename = "told")]
    reported_remaining: f64,
    /// Distance that the displayed position travels per tick, mm. `ticks` is the number of ticks
    /// since the last report.
    #[serde(rename = "pace")]
    step_mm: f64,
    ticks: u32,
}

impl ExternalCut {
    pub(super) fn new(from: Point, to: Point) -> Self {
        let path = CutPath::line(from, to);
        Self {
            path,
            is_begun: false,
            remaining: path.length(),
            reported_remaining: path.length(),
            step_mm: 0.0,
            ticks: 0,
        }
    }

    pub(super) const fn to(&self) -> Point {
        self.path.to()
    }

    pub(super) const fn is_begun(&self) -> bool {
        self.is_begun
    }

    pub(super) const fn begin(&mut self) {
        self.is_begun = true;
    }

    /// Sets the fraction of the cut that the board has made, 0–1. The displayed position moves
    /// evenly until the next report, and never beyond the reported position.
    pub(super) fn report_progress(&mut self, fraction: f64) {
        let reported = self.path.length() * (1.0 - fraction.clamp(0.0, 1.0));
        self.reported_remaining = self.reported_remaining.min(reported);
        self.step_mm = (self.remaining - self.reported_remaining) / f64::from(self.ticks.max(1));
        self.ticks = 0;
    }

    pub(super) fn advance(&mut self) {
        self.ticks = self.ticks.saturating_add(1);
        self.remaining = (self.remaining - self.step_mm).max(self.reported_remaining);
    }

    pub(super) fn is_moving(&self) -> bool {
        self.remaining > self.reported_remaining
    }

    pub(super) fn position(&self) -> Point {
        self.path.point_at(self.remaining)
    }

    pub(super) fn shifted(self, by: Point) -> Self {
        Self {
            path: self.path.shifted(by),
            ..self
        }
    }
}
