//! The states of automatic operation.

use serde::{Deserialize, Serialize};

/// The state of automatic operation, which the signals STL, SPL and OP report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RunState {
    /// No program is active (after power-on, RESET and M30): cycle start begins at the cursor.
    Reset,
    /// Stopped at the end of a block: cycle start continues with the next block.
    Stop,
    /// A block of the program is running.
    Run,
    /// Feed hold has stopped the motion within a block: cycle start continues the block.
    Hold,
}
