//! The states of a run: STL, SPL and OP stand for them.

use serde::{Deserialize, Serialize};

/// States of automatic operation (STL, SPL, OP).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RunState {
    /// After power-on, RESET and M30: the next cycle start begins at the cursor.
    Reset,
    /// At the end of a block: cycle start goes on with the next one.
    Stop,
    /// Running.
    Run,
    /// Feed hold.
    Hold,
}
