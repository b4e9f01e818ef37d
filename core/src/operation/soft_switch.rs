//! The switches of the page 机床面板 (manual III-2.6.2): requests to the ladder, which decides
//! about them.

use serde::{Deserialize, Serialize};

/// A switch of the soft machine panel, in the order of the page's keys 1 to 5.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SoftSwitch {
    /// 机床锁住: the machine lock switch, MLKO F75.4.
    MachineLock,
    /// 辅助锁住: the auxiliary lock switch, AFLO F75.1.
    AuxiliaryLock,
    /// 单程序段: the single block switch, SBKO F75.3.
    SingleBlock,
    /// 空运行: the dry run switch, DRNO F75.5.
    DryRun,
    /// 程序选跳: the block skip switch, BDTO F75.2.
    BlockSkip,
}

impl SoftSwitch {
    /// All switches, in the order of the page.
    pub const ALL: [Self; 5] = [
        Self::MachineLock,
        Self::AuxiliaryLock,
        Self::SingleBlock,
        Self::DryRun,
        Self::BlockSkip,
    ];

    /// The bit of F75 for this switch, as a mask.
    pub(crate) const fn mask(self) -> u8 {
        match self {
            Self::AuxiliaryLock => 1 << 1,
            Self::BlockSkip => 1 << 2,
            Self::SingleBlock => 1 << 3,
            Self::MachineLock => 1 << 4,
            Self::DryRun => 1 << 5,
        }
    }
}

/// A switch of the soft machine panel that is changing to a new state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct SoftSwitchChange {
    pub switch: SoftSwitch,
    #[serde(rename = "to")]
    pub target: bool,
    pub left_ms: u32,
}
