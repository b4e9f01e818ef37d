//! Passes the spindle that the board measures to the control.

use super::LinkedControl;
use crate::board::{BoardSpindle, SpindleFault};
use crate::spindle::SpindleTurn;
use gsk_link::{SpindleDirection, SpindleView, ThreadPlan};

/// Greatest correction of an axis that follows the spindle, mm per tick: 2 µm in 10 ms.
const MAX_CORRECTION_MM: f64 = 0.0002;

/// The spindle as the control last received it.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeasuredSpindle {
    /// Direction of the last commanded rotation, 1 or -1, and spindle angle at the last
    /// index, turns.
    direction: f64,
    index_turns: f64,
    /// Whether the motion of the last tick depended on the spindle angle.
    follows: bool,
    pub(super) view: Option<SpindleView>,
}

impl Default for MeasuredSpindle {
    fn default() -> Self {
        Self {
            direction: 1.0,
            index_turns: 0.0,
            follows: false,
            view: None,
        }
    }
}

impl LinkedControl {
    /// Reads the measured spindle for the control's next tick; `None`: the simulated
    /// spindle applies. `wanted` is the commanded direction.
    pub(super) fn read_spindle(&mut self, wanted: SpindleDirection) -> Option<BoardSpindle> {
        let direction = match wanted {
            SpindleDirection::Forward => 1.0,
            SpindleDirection::Reverse => -1.0,
            SpindleDirection::Stop => self.spindle.direction,
        };
        if direction != self.spindle.direction {
            self.spindle.direction = direction;
            self.link.spindle_reversed();
        }
        let orders = self.control.orders.spindle;
        let in_thread = orders.waits_for_angle || orders.lead_mm.is_some() || orders.continues;
        // A thread that was stopped brakes on the angle, too.
        self.spindle.follows = in_thread || (self.spindle.follows && orders.is_braking);
        let plan = ThreadPlan {
            rpm: orders.planned_rpm,
            waits: orders.waits_for_angle,
        };
        self.link.plan_thread(self.spindle.follows.then_some(plan));
        let lead = orders.lead_mm;
        self.spindle.view = self.link.spindle(lead.map(|lead| MAX_CORRECTION_MM / lead));
        let view = self.spindle.view?;
        if view.passed {
            self.spindle.index_turns = direction * view.now.floor();
        }
        let trouble = if view.lost {
            Some(SpindleFault::Lost)
        } else {
            view.deviation.map(SpindleFault::Deviates)
        };
        Some(BoardSpindle {
            rpm: direction * view.rpm,
            turn: SpindleTurn {
                before: direction * view.before,
                now: direction * view.now,
                index: self.spindle.index_turns,
                zero: 0.0,
            },
            index_passed: view.passed,
            is_commanded: wanted != SpindleDirection::Stop,
            variation: view.variation,
            fault: trouble,
        })
    }
}
