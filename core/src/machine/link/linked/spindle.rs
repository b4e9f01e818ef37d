//! The spindle of the control is the one whose index the board sees.

use super::Linked;
use crate::machine::link::SpindleWay;
use crate::operation::{BoardSpindle, SpindleTrouble};
use crate::simulation::Simulation;
use crate::spindle::SpindleTurn;

/// What an axis behind the spindle may be corrected by in a tick, mm: 2 µm in 10 ms.
const GIVE: f64 = 0.0002;

impl Linked {
    /// The spindle in the control's next tick; none: it stays the simulated one.
    pub(super) fn look_at_spindle(
        &mut self,
        simulation: &Simulation,
        wanted: SpindleWay,
    ) -> Option<BoardSpindle> {
        let way = match wanted {
            SpindleWay::Forward => 1.0,
            SpindleWay::Reverse => -1.0,
            SpindleWay::Stop => self.spindle_way,
        };
        if way != self.spindle_way {
            self.spindle_way = way;
            self.link.spindle_reversed();
        }
        let lead = simulation.cnc.lead_followed();
        self.spindle_view = self.link.spindle(lead.map(|lead| GIVE / lead));
        let view = self.spindle_view?;
        if view.passed {
            self.spindle_index = way * view.now.floor();
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
                index: self.spindle_index,
                zero: 0.0,
            },
            passed: view.passed,
            commanded: wanted != SpindleWay::Stop,
            variation: view.variation,
            trouble,
        })
    }
}
