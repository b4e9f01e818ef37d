//! Bits held at a value by hand.

use serde::{Deserialize, Serialize};

use crate::address::BitAddress;
use crate::memory::{SIZE, offset};

/// A bit held at a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Force {
    /// The bit.
    pub bit: BitAddress,
    /// Its value.
    pub value: bool,
}

/// All forced bits, in address order. They go with the power.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Forces(pub Vec<Force>);

impl Forces {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Puts the forced values back after something may have written others.
    pub fn apply(&self, bytes: &mut [u8; SIZE]) {
        for Force { bit, value } in &self.0 {
            if let Some(at) = offset(bit.byte_address()) {
                let mask = 1u8 << (bit.bit & 7);
                let byte = &mut bytes[at];
                *byte = if *value { *byte | mask } else { *byte & !mask };
            }
        }
    }
}
