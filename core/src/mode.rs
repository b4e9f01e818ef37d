//! Operating modes (manual III-1.3) and their code in G43.

use serde::{Deserialize, Serialize};

/// The operating mode of the control, selected by the operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum OperatingMode {
    /// 编辑: edits programs.
    Edit,
    /// 自动: executes the selected stored program.
    Auto,
    /// 录入 (MDI): executes a typed block.
    Mdi,
    /// 单步: moves the axes in fixed steps (001.3 = 0).
    Step,
    /// 手轮: moves the axes by the handwheel (001.3 = 1).
    Handwheel,
    /// 手动: jogs the axes while a key is pressed.
    Jog,
    /// 机械回零: returns the axes to the machine zero.
    MachineZero,
    /// 程序回零: returns the axes to the program zero.
    ProgramZero,
    /// DNC: executes a program that arrives through the serial port.
    Dnc,
    /// 手动示教: jogs the axes and stores positions in the program.
    TeachJog,
    /// 单步示教: moves the axes in steps and stores positions in the program (001.3 = 0).
    TeachStep,
    /// 手轮示教: moves the axes by the handwheel and stores positions in the program (001.3 = 1).
    TeachHandwheel,
}

impl OperatingMode {
    /// All operating modes, in the order of their declaration.
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

    /// The mode that the byte G43 of the PLC commands (manual PLC-II 3.6); `None` for an
    /// unused code, at which the mode does not change.
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

    /// The name of the mode on the status line, in Chinese.
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

    /// Whether the operator moves the axes in this mode. Selecting such a mode holds a running
    /// program (PLC signal *SP).
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

    /// Returns the mode whose motion this mode has: for a teach-in mode the same mode without
    /// teach-in, otherwise the mode itself.
    pub const fn motion_mode(self) -> Self {
        match self {
            Self::TeachJog => Self::Jog,
            Self::TeachStep => Self::Step,
            Self::TeachHandwheel => Self::Handwheel,
            other => other,
        }
    }

    /// Whether positions of the axes are stored in the program in this mode (teach-in).
    pub const fn teaches(self) -> bool {
        matches!(
            self,
            Self::TeachJog | Self::TeachStep | Self::TeachHandwheel
        )
    }

    /// Whether the selected program can be edited in this mode.
    pub const fn edits(self) -> bool {
        matches!(self, Self::Edit) || self.teaches()
    }
}
