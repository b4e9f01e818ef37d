//! The states of automatic operation.

use serde::{Deserialize, Serialize};

/// States of automatic operation; the signals STL, SPL and OP report them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RunState {
    /// After power-on, RESET and M30: the next cycle start begins at the cursor.
    Reset,
    /// At the end of a block: cycle start continues with the next one.
    Stop,
    /// A block is running.
    Run,
    /// Feed hold: motion has stopped within a block.
    Hold,
}
