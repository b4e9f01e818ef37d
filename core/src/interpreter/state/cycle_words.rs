//! The words that G90, G92 and G94 keep from block to block (manual I-3.2.5.3).

use serde::{Deserialize, Serialize};

use crate::interpreter::exact::ExactPoint;
use crate::interpreter::words::{AxisWords, SortedWords};

/// The words of earlier G90, G92 and G94 blocks. An increment is stored as its absolute end
/// point, in units of [`ExactPoint`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct CycleWords {
    x: Option<i64>,
    z: Option<i64>,
    r: i64,
    /// J of G92: height of the run-out, in units of [`ExactPoint`]; `None` if it is not programmed.
    j: Option<i64>,
    /// K of G92: length of the run-out, in units of [`ExactPoint`]; `None` if it is not programmed.
    k: Option<i64>,
    /// L of G92: number of thread starts; `None` if it is not programmed.
    l: Option<i64>,
}

/// The data of a G90, G92 or G94 block. Words that the block does not have are those of
/// earlier blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CycleData {
    /// The end point of the cut (C in the figures of the manual).
    pub(crate) end: ExactPoint,
    /// R, the taper, in millionths of a millimetre; a radius for a taper in X.
    pub(crate) r: i64,
    /// J of G92, the height of the run-out, in units of [`ExactPoint`]; `None` if no block
    /// gave J.
    pub(crate) j: Option<i64>,
    /// K of G92, the length of the run-out, in units of [`ExactPoint`]; `None` if no block
    /// gave K.
    pub(crate) k: Option<i64>,
    /// L of G92, the number of thread starts; 1 if no block gave L.
    pub(crate) starts: i64,
}

impl CycleWords {
    /// Deletes all stored words.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Deletes the end point and R, but keeps J, K and L. A code of group 00 other than G04
    /// does this, and a code of group 01 other than G90, G92 and G94.
    pub(crate) fn clear_end(&mut self) {
        *self = Self {
            j: self.j,
            k: self.k,
            l: self.l,
            ..Self::default()
        };
    }

    /// Whether an end point is stored, so that a block without words can repeat the cycle.
    pub(crate) const fn is_set(&self) -> bool {
        self.x.is_some() || self.z.is_some()
    }

    /// Stores the words of a G92 block (J, K and L besides those of G90) and returns the data
    /// of the cycle. `position` is the current position.
    pub(crate) fn store_thread_words(
        &mut self,
        words: &SortedWords,
        axes: &AxisWords,
        position: ExactPoint,
    ) -> CycleData {
        self.j = words.j.or(self.j);
        self.k = words.k.or(self.k);
        self.l = words.l.or(self.l);
        self.store_words(words, axes, position)
    }

    /// Stores the words of a G90 or G94 block and returns the data of the cycle. An axis that
    /// no block gave ends at the current position `position`.
    pub(crate) fn store_words(
        &mut self,
        words: &SortedWords,
        axes: &AxisWords,
        position: ExactPoint,
    ) -> CycleData {
        if let Some(x) = axes.x.resolve(axes.base.x) {
            self.x = Some(x);
        }
        if let Some(z) = axes.z.resolve(axes.base.z) {
            self.z = Some(z);
        }
        if let Some(r) = words.r {
            self.r = r;
        }
        CycleData {
            end: ExactPoint::new(self.x.unwrap_or(position.x), self.z.unwrap_or(position.z)),
            r: self.r,
            j: self.j,
            k: self.k,
            starts: self.l.unwrap_or(1),
        }
    }
}
