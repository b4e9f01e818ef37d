//! Letters of lengths whose number is a count in some blocks: no unit of length applies to it.
//!
//! ```text
//!   G73 U5 W5 R3      R: number of passes          (manual I-3.2.6.3)
//!   G92 X20 Z-9 I10   I: threads per inch          (manual I-3.2.4)
//! ```

use crate::command::MotionCode;
use crate::program::ProgramBlock;

/// The letters of a block whose numbers are counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CountWords {
    /// Whether R is the number of passes of G73, in both of its blocks.
    pub(crate) r: bool,
    /// Whether I is the number of threads per inch.
    pub(crate) i: bool,
}

impl CountWords {
    /// Finds the letters in `block`; `motion` is the code of group 01 in force before it.
    pub(crate) fn find(block: &ProgramBlock, motion: MotionCode) -> Self {
        let motion = block.g_codes().fold(motion, |motion, code| {
            MotionCode::from_number(code.into()).unwrap_or(motion)
        });
        Self {
            r: block.has_g(73),
            i: block.has_g(76) || motion.is_thread(),
        }
    }

    /// Whether the number of `address` is a count.
    pub(crate) const fn has(self, address: u8) -> bool {
        match address {
            b'R' => self.r,
            b'I' => self.i,
            _ => false,
        }
    }
}
