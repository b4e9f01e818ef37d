//! Limits the work of a preview.
//!
//! An endless loop is not an error of the text. Work is counted in moves and blocks, not in
//! time: a busy computer stops at the same programs as an idle one.

use super::PreviewProgress;

/// Limits of the work of a preview; it stops when it reaches one of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorkBudget {
    /// Greatest number of moves that a preview may make.
    pub moves: u64,
    /// Greatest number of blocks read, as [`PreviewProgress::work`] counts them.
    pub work: u64,
    /// Greatest number of consecutive commands without a move: loops of calls, jumps and
    /// dwells.
    pub motionless: u64,
}

impl WorkBudget {
    /// The limits for the commands `check` and `plot`.
    pub const FULL: Self = Self {
        moves: 200_000_000,
        work: 500_000_000,
        motionless: 10_000_000,
    };

    /// The limits for a program that is being edited or drawn, with at most `moves` moves.
    pub const fn interactive(moves: u64) -> Self {
        Self {
            moves,
            work: 100_000_000,
            motionless: 5_000_000,
        }
    }

    /// A budget with the smaller of the two limits in each field.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        Self {
            moves: self.moves.min(other.moves),
            work: self.work.min(other.work),
            motionless: self.motionless.min(other.motionless),
        }
    }

    /// Whether a preview with the progress `progress` is below all limits.
    pub const fn allows(&self, progress: &PreviewProgress) -> bool {
        progress.moves < self.moves
            && progress.work < self.work
            && progress.motionless < self.motionless
    }
}
