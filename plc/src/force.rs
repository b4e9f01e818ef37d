//! Forced bits: bits that hold a value set by hand.

use serde::{Deserialize, Serialize};

use crate::address::BitAddress;
use crate::memory::{SIZE, offset};

/// A bit that the operator has forced, with its fixed value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Force {
    /// Address of the forced bit.
    pub bit: BitAddress,
    /// Value that the forced bit keeps, whatever the ladder writes.
    pub value: bool,
}

/// All forced bits, in address order. Power-off clears them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Forces(pub Vec<Force>);

impl Forces {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Writes the forced values to memory again, because the ladder or the machine may have
    /// changed the bits.
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
