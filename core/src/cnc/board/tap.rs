//! Taps that the board makes: it follows the spindle in and back, and the control takes the depth
//! from its reports.

use crate::alarm::{Alarm, number};
use crate::cnc::Cnc;
use crate::operation::RunState;
use crate::units::{Axis, PerAxis, Point, Pulses};
use gsk_link::{TapCapability, TapOrder};
use gsk_messages::say;

/// Time for which a spindle may run on below the programmed depth until the board stops the tap, s.
const RUN_ON_S: f64 = 3.0;
/// Turns that are added to those of this time.
const RUN_ON_TURNS: f64 = 2.0;

impl Cnc {
    /// Whether the board makes the taps.
    pub(crate) fn is_tapping_by_board(&self) -> bool {
        let follows = |board: crate::board::BoardDrives| board.taps == TapCapability::Followed;
        self.drives.board.is_some_and(follows)
    }

    /// Whether machine lock keeps Z of a board from moving: a tap is then two plain cuts.
    pub(crate) fn is_tap_locked(&self) -> bool {
        self.drives.board.is_some() && self.plc.signals.machine_lock.z
    }

    /// Starts a tap that the board makes: takes up the backlash of the screw, then waits until the
    /// board begins.
    pub(crate) fn request_tap(&mut self, to: Point, lead: f64, start_degrees: f64) {
        let displacement = to - self.drives.interpolator.position();
        self.drives
            .interpolator
            .start_external_tap(to, lead, start_degrees);
        self.drives.axis_chain.take_up_backlash(displacement);
    }

    /// Returns the tap that the board must start now; `None` without one, while backlash is being
    /// taken up, and during feed hold.
    pub(crate) fn pending_tap(&self) -> Option<TapOrder> {
        let tap = self.drives.interpolator.pending_external_tap()?;
        let board = self.drives.board?;
        if self.drives.axis_chain.is_settling() || self.run.automatic.state != RunState::Run {
            return None;
        }
        let mut at_bottom = self.drives.axis_chain.clone();
        at_bottom.advance(tap.bottom(), PerAxis::default());
        let start = self.drives.axis_chain.pulses();
        let is_up = at_bottom.pulses().z >= start.z;
        let pulses_per_mm = board.pulses_per_mm[Axis::Z as usize];
        let depth_mm = (tap.bottom().z - tap.from().z).abs();
        let turns_per_s = self.thread_rpm() / 60.0;
        let run_on_turns = turns_per_s * RUN_ON_S + RUN_ON_TURNS;
        let law = self.drives.limits.gear_law();
        let first_share = law.lowest_rate(tap.lead(), turns_per_s);
        Some(TapOrder {
            start,
            depth: depth_mm * pulses_per_mm * if is_up { 1.0 } else { -1.0 },
            bound: (depth_mm + run_on_turns * tap.lead()) * pulses_per_mm,
            lead: tap.lead() * pulses_per_mm,
            start_degrees: tap.start_degrees(),
            lead_in_turns: turns_per_s * law.time_constant_s * (1.0 - first_share),
            first_share,
        })
    }

    /// Whether the control follows a tap that the board has started.
    pub(crate) const fn follows_board_tap(&self) -> bool {
        self.drives.interpolator.follows_external_tap()
    }

    /// Sets the depth of the current tap that the board has reported, mm.
    pub(crate) fn report_tap_depth(&mut self, depth_mm: f64) {
        self.drives.interpolator.report_tap_depth(depth_mm);
    }

    /// Ends the current tap at the pulse count `end` of its start, which the board has confirmed.
    /// Raises an alarm if the spindle has turned back before the control reversed it.
    pub(crate) fn finish_tap(&mut self, end: PerAxis<Pulses>) {
        let ended = self.drives.interpolator.end_external_tap();
        if ended.is_some() {
            let locked = self.plc.signals.machine_lock;
            self.drives.axis_chain.advance(self.position(), locked);
        }
        // With backlash the slide is still deeper by it: the count tells where it is.
        if self.drives.axis_chain.pulses() != end {
            self.set_count(end);
        }
        if ended.is_some_and(|tap| !tap.is_reversed()) {
            self.run.automatic.tap = None;
            let alarm = Alarm::new(number::SPINDLE_ENCODER).with_detail(say::tap_turned_back());
            self.raise_at_last_block(alarm);
        }
    }
}
