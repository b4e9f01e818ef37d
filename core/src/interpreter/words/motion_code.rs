//! Finds the code of group 01 that a G code means on its model.

use crate::command::MotionCode;
use crate::model::GCode;

/// The code that a G code sets by its meaning; `None` for codes of other groups.
pub(crate) const fn find_motion_code(meaning: GCode) -> Option<MotionCode> {
    Some(match meaning {
        GCode::Rapid | GCode::StraightRapid => MotionCode::Rapid,
        GCode::Line => MotionCode::Line,
        GCode::ArcClockwise | GCode::LongArcClockwise | GCode::DiameterArcClockwise => {
            MotionCode::ArcClockwise
        }
        GCode::ArcCounterclockwise
        | GCode::LongArcCounterclockwise
        | GCode::DiameterArcCounterclockwise => MotionCode::ArcCounterclockwise,
        GCode::Thread => MotionCode::Thread,
        GCode::Tapping => MotionCode::Tapping,
        GCode::VariableThread => MotionCode::VariableThread,
        GCode::TurningCycle => MotionCode::TurningCycle,
        GCode::ThreadCycle => MotionCode::ThreadCycle,
        GCode::FacingCycle => MotionCode::FacingCycle,
        _ => return None,
    })
}
