//! Passes the spindle that the board measures to the control.

use super::Linked;
use crate::board::{BoardSpindle, SpindleTrouble};
use crate::spindle::SpindleTurn;
use gsk_link::{SpindleDirection, SpindleView};

/// Greatest correction of an axis that follows the spindle, mm per tick: 2 µm in 10 ms.
const GIVE: f64 = 0.0002;

/// The spindle as the control last received it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spindle {
    /// Direction of the last switching, 1 or -1, and the angle of the last index, turns.
    way: f64,
    index: f64,
    pub(super) view: Option<SpindleView>,
}

impl Default for Spindle {
    fn default() -> Self {
        Self {
            way: 1.0,
            index: 0.0,
            view: None,
        }
    }
}

impl Linked {
    /// The spindle in the control's next tick; `None`: the simulated one applies.
    pub(super) fn read_spindle(&mut self, wanted: SpindleDirection) -> Option<BoardSpindle> {
        let way = match wanted {
            SpindleDirection::Forward => 1.0,
            SpindleDirection::Reverse => -1.0,
            SpindleDirection::Stop => self.spindle.way,
        };
        if way != self.spindle.way {
            self.spindle.way = way;
            self.link.spindle_reversed();
        }
        let lead = self.control.orders.spindle.lead;
        self.spindle.view = self.link.spindle(lead.map(|lead| GIVE / lead));
        let view = self.spindle.view?;
        if view.passed {
            self.spindle.index = way * view.now.floor();
        }
        let trouble = if view.lost {
            Some(SpindleTrouble::Lost)
        } else {
            view.deviation.map(SpindleTrouble::Deviates)
        };
        Some(BoardSpindle {
            rpm: way * view.rpm,
            turn: SpindleTurn {
                before: way * view.before,
                now: way * view.now,
                index: self.spindle.index,
                zero: 0.0,
            },
            passed: view.passed,
            commanded: wanted != SpindleDirection::Stop,
            variation: view.variation,
            trouble,
        })
    }
}
