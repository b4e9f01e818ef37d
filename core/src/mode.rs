//! Operating modes (manual III-1.3) and their code in G43.

use serde::{Deserialize, Serialize};

/// The operating mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum OperatingMode {
    /// 编辑: programs are edited.
    Edit,
    /// 自动: a stored program is executed.
    Auto,
    /// 录入: a typed block is executed (MDI).
    Mdi,
    /// 单步: the axes move in fixed increments (001.3 = 0).
    Step,
    /// 手轮: the handwheel moves the axes (001.3 = 1).
    Handwheel,
    /// 手动: the axes jog.
    Jog,
    /// 机械回零: return to the machine zero.
    MachineZero,
    /// 程序回零: return to the program zero.
    ProgramZero,
    /// DNC: executes a program that arrives through the serial port.
    Dnc,
    /// 手动示教: jog; positions are stored in the program.
    TeachJog,
    /// 单步示教: steps; positions are stored in the program (001.3 = 0).
    TeachStep,
    /// 手轮示教: handwheel; positions are stored in the program (001.3 = 1).
    TeachHandwheel,
}

impl OperatingMode {
    /// Every operating mode.
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

    /// The mode that G43 commands (manual PLC-II 3.6). `None` for an unused code: the mode
    /// then does not change.
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

    /// Whether the operator moves the axes in this mode. Selecting such a mode holds a
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

    /// The mode whose motion this mode has: a teach-in mode moves the axes like the mode it
    /// is named after.
    pub const fn motion_mode(self) -> Self {
        match self {
            Self::TeachJog => Self::Jog,
            Self::TeachStep => Self::Step,
            Self::TeachHandwheel => Self::Handwheel,
            other => other,
        }
    }

    /// Whether positions are stored in the program.
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
