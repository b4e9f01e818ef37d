//! The words that G90, G92 and G94 keep from block to block (manual I-3.2.5.3).

use serde::{Deserialize, Serialize};

use crate::interpreter::context::exact::Exact;
use crate::interpreter::context::words::{AxisWords, Words};

/// Stored words; an increment is stored as the absolute point it led to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct CycleWords {
    x: Option<i64>,
    z: Option<i64>,
    r: i64,
    /// Run-out of G92: height and length.
    j: Option<i64>,
    k: Option<i64>,
    /// Thread starts of G92.
    l: Option<i64>,
}

/// What a cycle block amounts to after the stored words are added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CycleData {
    /// Cutting end point C.
    pub(crate) end: Exact,
    /// R in millionths of a millimetre; a radius when it is along X.
    pub(crate) r: i64,
    /// J of G92, if ever given.
    pub(crate) j: Option<i64>,
    /// K of G92, if ever given.
    pub(crate) k: Option<i64>,
    /// L of G92.
    pub(crate) starts: i64,
}

impl CycleWords {
    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Forgets the end point and R, as a code of group 00 other than G04 and a
    /// code of group 01 that is no cycle do; J, K and L stay.
    pub(crate) fn clear_end(&mut self) {
        *self = Self {
            j: self.j,
            k: self.k,
            l: self.l,
            ..Self::default()
        };
    }

    /// Whether a repetition has anything to repeat.
    pub(crate) const fn is_set(&self) -> bool {
        self.x.is_some() || self.z.is_some()
    }

    /// Takes over the words of a block of G92: those of G90 and G94, and J, K and L.
    pub(crate) fn take_thread(&mut self, words: &Words, axes: &AxisWords, at: Exact) -> CycleData {
        self.j = words.j.or(self.j);
        self.k = words.k.or(self.k);
        self.l = words.l.or(self.l);
        self.take(words, axes, at)
    }

    /// Takes over the words of a block of G90 or G94. An axis never given ends where the
    /// tool stands.
    pub(crate) fn take(&mut self, words: &Words, axes: &AxisWords, at: Exact) -> CycleData {
        if let Some(x) = axes.x.target(axes.base.x) {
            self.x = Some(x);
        }
        if let Some(z) = axes.z.target(axes.base.z) {
            self.z = Some(z);
        }
        if let Some(r) = words.r {
            self.r = r;
        }
        CycleData {
            end: Exact::new(self.x.unwrap_or(at.x), self.z.unwrap_or(at.z)),
            r: self.r,
            j: self.j,
            k: self.k,
            starts: self.l.unwrap_or(1),
        }
    }
}
