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
    /// DNC: execution of a program that comes in through the serial line.
    Dnc,
    /// 手动示教: jog, and positions are taken into the program.
    TeachJog,
    /// 单步示教: steps, and positions are taken into the program (001.3 = 0).
    TeachStep,
    /// 手轮示教: handwheel, and positions are taken into the program (001.3 = 1).
    TeachHandwheel,
}

impl Mode {
    /// Every mode.
    pub const ALL: [Self; 12] = [
        Self::Edit,
        Self::Auto,
        Self::Mdi,
        Self::Step,
        Self::Handwheel,
        Self::Jog,
        Self::MachineZero,
        Self::ProgramZero,
        Self::Dnc,
        Self::TeachJog,
        Self::TeachStep,
        Self::TeachHandwheel,
    ];

    /// The mode that G43 commands (manual PLC-II 3.6), or `None` for a code without
    /// one: the mode then stays as it is.
    pub(crate) const fn from_code(g43: u8, handwheel_fitted: bool) -> Option<Self> {
        Some(match g43 & 0b1010_0111 {
            0 => Self::Mdi,
            1 => Self::Auto,
            2 => Self::ProgramZero,
            3 => Self::Edit,
            4 if handwheel_fitted => Self::Handwheel,
            4 => Self::Step,
            5 => Self::Jog,
            6 => Self::TeachJog,
            7 if handwheel_fitted => Self::TeachHandwheel,
            7 => Self::TeachStep,
            0x21 => Self::Dnc,
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
            Self::Dnc => "DNC方式",
            Self::TeachJog => "手动示教",
            Self::TeachStep => "单步示教",
            Self::TeachHandwheel => "手轮示教",
        }
    }

    /// Whether programs or MDI blocks run in this mode.
    pub const fn runs_programs(self) -> bool {
        matches!(self, Self::Auto | Self::Mdi | Self::Dnc)
    }

    /// Whether the axes are moved by hand in this mode; selecting one holds a
    /// running program (PLC signal *SP).
    pub const fn is_manual(self) -> bool {
        matches!(
            self,
            Self::Step
                | Self::Handwheel
                | Self::Jog
                | Self::MachineZero
                | Self::ProgramZero
                | Self::TeachJog
                | Self::TeachStep
                | Self::TeachHandwheel
        )
    }

    /// How the axes move: a teach-in mode moves them as the one it is named after.
    pub const fn motion(self) -> Self {
        match self {
            Self::TeachJog => Self::Jog,
            Self::TeachStep => Self::Step,
            Self::TeachHandwheel => Self::Handwheel,
            other => other,
        }
    }

    /// Whether positions are taken into the program.
    pub const fn teaches(self) -> bool {
        matches!(
            self,
            Self::TeachJog | Self::TeachStep | Self::TeachHandwheel
        )
    }

    /// Whether the selected program can be edited.
    pub const fn edits(self) -> bool {
        matches!(self, Self::Edit) || self.teaches()
    }
}
