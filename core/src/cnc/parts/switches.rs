//! The switches of the setting page.

use serde::{Deserialize, Serialize};

/// 参数开关 and 程序开关: on, their memory may be written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Switches {
    /// 参数开关.
    pub parameters: bool,
    /// 程序开关.
    pub programs: bool,
}
