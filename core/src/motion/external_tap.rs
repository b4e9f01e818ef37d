//! A tap that a board makes: Z follows the spindle at the board, and the control follows the
//! depth that the board reports.

use serde::{Deserialize, Serialize};

use crate::units::Point;

/// Greatest number of ticks over which the displayed depth follows a report.
const MAX_REPORT_TICKS: u32 = 20;
/// Depth below the programmed one at which the bottom counts as reached, mm.
const DEPTH_TOLERANCE_MM: f64 = 1e-6;

/// A tap that a board makes and whose depth the control only follows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ExternalTap {
    from: Point,
    to: Point,
    lead: f64,
    start_degrees: f64,
    /// Whether the board has started the tap. Then only the board can end it.
    is_begun: bool,
    is_reversed: bool,
    /// Depth below the start, mm: the displayed one and the last reported one.
    depth: f64,
    reported_depth: f64,
    /// Amount by which the displayed depth changes in a tick, mm, and ticks since the report.
    step_mm: f64,
    ticks: u32,
}

impl ExternalTap {
    /// Creates a tap from `from` to the bottom `to`, mm. `lead` is in mm per turn, `start_degrees`
    /// the spindle angle after the one-turn signal at which it starts.
    pub(super) const fn new(from: Point, to: Point, lead: f64, start_degrees: f64) -> Self {
        Self {
            from,
            to,
            lead: lead.abs(),
            start_degrees,
            is_begun: false,
            is_reversed: false,
            depth: 0.0,
            reported_depth: 0.0,
            step_mm: 0.0,
            ticks: 0,
        }
    }

    /// Lead, mm per turn.
    pub(crate) const fn lead(&self) -> f64 {
        self.lead
    }

    /// Spindle angle after the one-turn signal at which the tap starts, degrees.
    pub(crate) const fn start_degrees(&self) -> f64 {
        self.start_degrees
    }

    /// Start point, mm.
    pub(crate) const fn from(&self) -> Point {
        self.from
    }

    /// Programmed bottom, mm.
    pub(crate) const fn bottom(&self) -> Point {
        self.to
    }

    /// End point of the current direction, mm: the bottom, or the start after the reversal.
    pub(super) const fn to(&self) -> Point {
        if self.is_reversed { self.from } else { self.to }
    }

    pub(super) const fn is_begun(&self) -> bool {
        self.is_begun
    }

    pub(super) const fn begin(&mut self) {
        self.is_begun = true;
    }

    pub(super) const fn is_at_bottom(&self) -> bool {
        let depth = (self.to.z - self.from.z).abs();
        !self.is_reversed && self.is_begun && self.reported_depth >= depth - DEPTH_TOLERANCE_MM
    }

    pub(super) const fn reverse(&mut self) {
        self.is_reversed = true;
    }

    /// Whether the spindle has been reversed.
    pub(crate) const fn is_reversed(&self) -> bool {
        self.is_reversed
    }

    /// Sets the depth that the board has reported, mm. The displayed depth moves evenly to it in
    /// the time that the report has taken.
    pub(super) fn report_depth(&mut self, depth: f64) {
        if depth == self.reported_depth {
            return;
        }
        self.reported_depth = depth;
        let ticks = self.ticks.clamp(1, MAX_REPORT_TICKS);
        self.step_mm = (depth - self.depth) / f64::from(ticks);
        self.ticks = 0;
    }

    pub(super) fn advance(&mut self) {
        self.ticks = self.ticks.saturating_add(1);
        let rest = self.reported_depth - self.depth;
        self.depth += if rest.abs() <= self.step_mm.abs() {
            rest
        } else {
            self.step_mm
        };
    }

    pub(super) fn is_moving(&self) -> bool {
        self.depth != self.reported_depth
    }

    pub(super) fn position(&self) -> Point {
        let inwards = if self.to.z < self.from.z { -1.0 } else { 1.0 };
        Point::new(self.from.x, self.from.z + inwards * self.depth)
    }

    pub(super) fn shifted(self, by: Point) -> Self {
        Self {
            from: self.from + by,
            to: self.to + by,
            ..self
        }
    }
}
