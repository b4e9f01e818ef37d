//! The codes of group 01: the motion that axis words mean.

use serde::{Deserialize, Serialize};

/// A code of group 01, which stays in force until the next one. Serialized as its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(into = "u8", try_from = "u8")]
#[repr(u8)]
pub enum MotionCode {
    /// G00: rapid traverse.
    Rapid = 0,
    /// G01: straight line at feed.
    Line = 1,
    /// G02: clockwise arc.
    ArcClockwise = 2,
    /// G03: counterclockwise arc.
    ArcCounterclockwise = 3,
    /// G32: one pass of a thread.
    Thread = 32,
    /// G33: tapping along Z.
    Tapping = 33,
    /// G34: one pass of a thread with variable lead.
    VariableThread = 34,
    /// G90: turning cycle.
    TurningCycle = 90,
    /// G92: thread cutting cycle.
    ThreadCycle = 92,
    /// G94: facing cycle.
    FacingCycle = 94,
}

impl MotionCode {
    /// The code with the number after G on the GSK980TD; `None` for numbers outside group 01.
    pub const fn from_number(number: u32) -> Option<Self> {
        Some(match number {
            0 => Self::Rapid,
            1 => Self::Line,
            2 => Self::ArcClockwise,
            3 => Self::ArcCounterclockwise,
            32 => Self::Thread,
            33 => Self::Tapping,
            34 => Self::VariableThread,
            90 => Self::TurningCycle,
            92 => Self::ThreadCycle,
            94 => Self::FacingCycle,
            _ => return None,
        })
    }

    /// Returns the number of the G code, such as 1 for G01.
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// Whether F and I of a block are a lead: G32, G33, G34 and G92.
    pub const fn is_thread(self) -> bool {
        matches!(self, Self::Tapping | Self::ThreadCycle) || self.is_thread_pass()
    }

    /// Whether the code cuts one pass that the next block may continue: G32 and G34.
    pub const fn is_thread_pass(self) -> bool {
        matches!(self, Self::Thread | Self::VariableThread)
    }

    /// Whether the code moves along the contour of a part: G00 to G03.
    pub const fn is_contour(self) -> bool {
        matches!(self, Self::Rapid | Self::Line) || self.is_arc()
    }

    /// Whether the code is an arc, G02 or G03.
    pub const fn is_arc(self) -> bool {
        matches!(self, Self::ArcClockwise | Self::ArcCounterclockwise)
    }

    /// Whether the code is one of the canned cycles G90, G92 and G94.
    pub const fn is_canned_cycle(self) -> bool {
        matches!(
            self,
            Self::TurningCycle | Self::ThreadCycle | Self::FacingCycle
        )
    }
}

impl From<MotionCode> for u8 {
    fn from(code: MotionCode) -> Self {
        code.number()
    }
}

impl TryFrom<u8> for MotionCode {
    type Error = &'static str;

    fn try_from(number: u8) -> Result<Self, Self::Error> {
        Self::from_number(number.into()).ok_or("not a code of group 01")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_serialized_form_is_the_number() {
        let codes: Vec<MotionCode> = (0..256).filter_map(MotionCode::from_number).collect();
        let text = ron::to_string(&codes).unwrap();
        assert_eq!(text, "[0,1,2,3,32,33,34,90,92,94]");
        assert_eq!(ron::from_str::<Vec<MotionCode>>(&text).unwrap(), codes);
        assert!(ron::from_str::<MotionCode>("76").is_err());
    }
}
