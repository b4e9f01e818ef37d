//! The M codes of the machine.

use serde::{Deserialize, Serialize};

/// M codes that the machine's ladder carries out beside the control's own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MachineCodes([u64; 2]);

impl MachineCodes {
    /// Those that a ladder declares.
    pub fn of(declared: &[gsk_plc::MCode]) -> Self {
        let mut codes = Self::default();
        for m in declared {
            if let Some(half) = codes.0.get_mut(usize::from(m.code / 64)) {
                *half |= 1 << (m.code % 64);
            }
        }
        codes
    }

    pub(crate) const fn has(self, code: u8) -> bool {
        code < 128 && self.0[(code / 64) as usize] >> (code % 64) & 1 == 1
    }
}
