//! The write switches of the setting page.

use serde::{Deserialize, Serialize};

/// 参数开关 and 程序开关: while one is on, its memory may be written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct WriteSwitches {
    /// 参数开关: parameters may be written.
    pub parameters: bool,
    /// 程序开关: programs may be written.
    pub programs: bool,
}
