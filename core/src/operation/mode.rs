//! Operating modes (manual III-1.3) and their code in G43.

use serde::{Deserialize, Serialize};

/// The operating mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// 编辑: program editing.
    Edit,
    /// 自动: execution of a stored program.
    Auto,
    /// 录入: execution of a block keyed in (MDI).
    Mdi,
    /// 单步: fixed increments (001.3 = 0).
    Step,
    /// 手轮: handwheel (001.3 = 1).
    Handwheel,
    /// 手动: jog.
    Jog,
    /// 机械回零: return to the machine zero.
    MachineZero,
    /// 程序回零: return to the program zero point.
    ProgramZero,
}

impl Mode {
    /// The mode that G43 commands, or `None` for a code this control does not
    /// offer (DNC, teach): the mode then stays as it is.
    pub const fn from_code(g43: u8, handwheel_fitted: bool) -> Option<Self> {
        Some(match g43 & 0b1010_0111 {
            0 => Self::Mdi,
            1 => Self::Auto,
            2 => Self::ProgramZero,
            3 => Self::Edit,
            4 if handwheel_fitted => Self::Handwheel,
            4 => Self::Step,
            5 => Self::Jog,
            0x85 => Self::MachineZero,
            _ => return None,
        })
    }

    /// The text on the status line.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Edit => "编辑方式",
            Self::Auto => "自动方式",
            Self::Mdi => "录入方式",
            Self::Step => "单步方式",
            Self::Handwheel => "手轮方式",
            Self::Jog => "手动方式",
            Self::MachineZero => "机械回零",
            Self::ProgramZero => "程序回零",
        }
    }

    /// Whether programs or MDI blocks run in this mode.
    pub const fn runs_programs(self) -> bool {
        matches!(self, Self::Auto | Self::Mdi)
    }

    /// Whether the axes are moved by hand in this mode; selecting one holds a
    /// running program (PLC signal *SP).
    pub const fn is_manual(self) -> bool {
        matches!(
            self,
            Self::Step | Self::Handwheel | Self::Jog | Self::MachineZero | Self::ProgramZero
        )
    }
}
