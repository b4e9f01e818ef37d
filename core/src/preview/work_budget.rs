//! How much work a preview may take.
//!
//! A loop without an end is no error of the text. Work is counted in moves and blocks, and
//! never in time: a busy computer gives up the same programs as an idle one.

use super::Progress;

/// Limits of a preview.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorkBudget {
    /// Moves.
    pub moves: u64,
    /// Blocks read, as [`Progress::work`] counts them.
    pub work: u64,
    /// Commands in a row without a move: loops of calls, jumps and dwells.
    pub motionless: u64,
}

impl WorkBudget {
    /// Limits of `check` and `plot`.
    pub const FULL: Self = Self {
        moves: 200_000_000,
        work: 500_000_000,
        motionless: 10_000_000,
    };

    /// Limits of a look while a program is edited or drawn, with this many moves.
    pub const fn interactive(moves: u64) -> Self {
        Self {
            moves,
            work: 100_000_000,
            motionless: 5_000_000,
        }
    }

    /// The smaller limits of both.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        Self {
            moves: self.moves.min(other.moves),
            work: self.work.min(other.work),
            motionless: self.motionless.min(other.motionless),
        }
    }

    /// Whether a preview that has come so far is within the limits.
    pub const fn allows(&self, progress: &Progress) -> bool {
        progress.moves < self.moves
            && progress.work < self.work
            && progress.motionless < self.motionless
    }
}
