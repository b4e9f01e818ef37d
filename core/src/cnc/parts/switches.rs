//! The write switches of the setting page.

use serde::{Deserialize, Serialize};

/// The switches 参数开关 (parameters) and 程序开关 (programs). Each permits changes of its data
/// while on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct WriteSwitches {
    /// 参数开关: parameters may be written.
    pub parameters: bool,
    /// 程序开关: programs may be written.
    pub programs: bool,
}
