//! The M codes of the machine builder's ladder.

use serde::{Deserialize, Serialize};

/// A set of M codes, 0 to 127, that the machine's ladder carries out besides the control's
/// codes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MachineCodes([u64; 2]);

impl MachineCodes {
    /// The set of the M codes that a ladder declares; codes above 127 are ignored.
    pub fn from_declared(declared: &[gsk_plc::MCode]) -> Self {
        let mut codes = Self::default();
        for m in declared {
            if let Some(half) = codes.0.get_mut(usize::from(m.code / 64)) {
                *half |= 1 << (m.code % 64);
            }
        }
        codes
    }

    pub(crate) const fn contains(self, code: u8) -> bool {
        code < 128 && self.0[(code / 64) as usize] >> (code % 64) & 1 == 1
    }
}
