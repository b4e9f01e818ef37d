//! The size of the program memory of a control model.

use serde::{Deserialize, Serialize};

/// What the program memory of a control model holds. As the default that of the GSK980TD
/// (manual III-8.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProgramCapacity {
    /// Greatest number of stored programs; one more raises alarm 072.
    pub programs: usize,
    /// Greatest number of characters of all programs together; more raise alarm 068.
    pub characters: usize,
}

impl Default for ProgramCapacity {
    fn default() -> Self {
        Self {
            programs: 193,
            characters: 3_000_000,
        }
    }
}

impl ProgramCapacity {
    /// Whether states need not store it: it is that of the GSK980TD.
    pub(crate) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}
