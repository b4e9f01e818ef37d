//! The write switches of the setting page.

use serde::{Deserialize, Serialize};

/// The switches 参数开关 (parameters) and 程序开关 (programs). Each permits changes of its data
/// while on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct WriteSwitches {
    /// Whether 参数开关 is on: parameters may be changed.
    pub parameters: bool,
    /// Whether 程序开关 is on: programs may be changed.
    pub programs: bool,
}
