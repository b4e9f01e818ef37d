//! The explanation of a pass to a learner, and the numbers that a cycle stores for it.

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::interpreter::exact::{ExactPoint, to_mm};
use crate::units::Axis;

/// Explains to a learner why a pass of a cycle is at its depth or position.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// Number of the cycle's G code, 71 for G71.
    pub code: u8,
    /// Number of the pass, column or thread start, from 1.
    pub pass: u64,
    /// Number of passes; `None` if the cycle calculates one pass after another and does not
    /// know how many follow.
    pub passes: Option<u64>,
    /// Programmed X (diameter) or Z of the level or column, mm; `None` for passes that follow
    /// a contour.
    pub level: Option<f64>,
    /// Depth that the pass reaches, mm; a radius in X.
    pub depth: f64,
    /// Depth left for the following passes, mm; a radius in X.
    pub remaining: f64,
    /// The formula by which the cycle calculates the depth or position of the pass, with the
    /// numbers inserted.
    pub formula: Message,
    /// The words and parameters that the formula reads.
    pub words: &'static str,
}

/// The rule by which G76 finds the depth of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum DepthRule {
    /// √n·Δd: Δd is the depth of the first pass, n the number of the pass.
    Root,
    /// The previous depth plus the least infeed Δdmin.
    Least,
    /// k - d: the last roughing pass, which leaves the finishing allowance d of the height k.
    Last,
    /// k: a finishing pass at the full height of the thread.
    Finish,
}

/// The numbers that [`Explanation`] is computed from, stored with each move of a cycle.
/// Lengths are in units of [`ExactPoint`], diameters in X if not stated otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum PassNote {
    /// The move has no explanation.
    None,
    /// A pass of G90 (level in X) or G94 (level in Z): from the start A to B, cut to C, and
    /// back to A.
    Box {
        axis: Axis,
        a: ExactPoint,
        c: ExactPoint,
        /// R, the distance from C to B along `axis`; a radius in X.
        taper: i64,
    },
    /// One start of a G92 thread: from the start A to B, cut to C, and back to A.
    Thread {
        start: u32,
        starts: u32,
        a: ExactPoint,
        c: ExactPoint,
        taper: i64,
        /// Height (a radius) and length of the run-out at the end of the thread.
        run_out: (i64, i64),
    },
    /// One thread start of a tapping cycle: G33, or G84 and G85 of the Huaxing lathes.
    Tap {
        start: u32,
        starts: u32,
        a: i64,
        bottom: i64,
        /// G code of the tapping cycle; 0 means G33.
        #[serde(default)]
        code: u8,
    },
    /// A pass of G76; depths and the height are radii.
    ThreadPass {
        number: u64,
        depth: i64,
        previous: i64,
        height: i64,
        first: i64,
        least: i64,
        rule: DepthRule,
    },
    /// A roughing pass of G71 (level in X) or G72 (level in Z).
    Level {
        axis: Axis,
        number: i64,
        levels: i64,
        /// Coordinate from which the levels count, finishing allowance included, in units of
        /// [`ExactPoint`].
        from: i64,
        /// Signed step from one level to the next.
        step: i64,
        /// Coordinate of the deepest level, finishing allowance included.
        last: i64,
    },
    /// The last pass of G71 or G72, which follows the contour at the finishing allowance.
    Contour {
        axis: Axis,
        levels: i64,
        allowance: ExactPoint,
    },
    /// A pass of G73: the contour, shifted by `shift`.
    Shifted {
        number: i64,
        passes: i64,
        shift: ExactPoint,
        allowance: ExactPoint,
        /// Δi and Δk, the shift of the first pass from the last; X as a diameter.
        relief: ExactPoint,
    },
    /// A move in a column of G74 (pecks along Z) or G75 (pecks along X).
    Column {
        axis: Axis,
        number: i64,
        columns: i64,
        /// Coordinate of the column on the axis across the pecks.
        at: i64,
        from: i64,
        step: i64,
        /// Number of the current peck from 1; 0 outside pecks.
        peck: i64,
        /// Number of pecks in the column.
        pecks: i64,
        /// Depth of a peck, with the sign of the cutting direction.
        feed: i64,
        bottom: i64,
        /// Whether the cycle is G83 of the Huaxing lathes instead of G74 or G75.
        #[serde(default)]
        deep_hole: bool,
    },
    /// A pass of G81 (level in X) or G82 (level in Z) of the Huaxing lathes.
    Stepped {
        axis: Axis,
        pass: i64,
        passes: i64,
        /// Coordinate of the start along `axis`.
        a: i64,
        /// Signed distance of this pass from the start; `whole` is that of the last pass,
        /// without sign.
        depth: i64,
        whole: i64,
        step: i64,
        finish: i64,
    },
    /// The single thread pass of G33 or G34 of the Huaxing lathes.
    SinglePass {
        code: u8,
        a: ExactPoint,
        begin: ExactPoint,
        end: ExactPoint,
    },
    /// A thread pass of G86 or G87; depths are differences of diameters.
    CountedThread {
        code: u8,
        pass: i64,
        passes: i64,
        /// Number of the thread start, counted from 0.
        start: u32,
        starts: u32,
        /// X of the start, which is the crest of the thread.
        crest: i64,
        depth: i64,
        whole: i64,
    },
}

/// Converts a displacement along `axis`, in units of [`ExactPoint`], to a depth in mm; along X
/// a diameter becomes a radius.
pub(crate) fn depth_mm(axis: Axis, units: i64) -> f64 {
    match axis {
        Axis::X => to_mm(units) / 2.0,
        Axis::Z => to_mm(units),
    }
}

/// The letter of an axis, X or Z, for a formula.
pub(crate) const fn axis_letter(axis: Axis) -> char {
    match axis {
        Axis::X => 'X',
        Axis::Z => 'Z',
    }
}

/// Formats the formula, with its numbers in mm, of B, the start of a tapered cut: `X_B = X_C +
/// 2R` or `Z_B = Z_C + R`.
pub(crate) fn format_corner_b(axis: Axis, c: ExactPoint, taper: i64) -> String {
    let (c, factor, taper_shift) = match axis {
        Axis::X => (c.x, "2·", 2 * taper),
        Axis::Z => (c.z, "", taper),
    };
    let name = axis_letter(axis);
    format!(
        "{name}_B = {name}_C + {factor}R = {:.3} {:+.3} = {:.3}",
        to_mm(c),
        to_mm(taper_shift),
        to_mm(c + taper_shift)
    )
}

/// Adds the start angle of a multi-start thread to a formula. `start` counts from 1; a thread
/// of one start keeps its formula.
pub(crate) fn add_start_angle(formula: Message, start: u32, starts: u32) -> Message {
    if starts <= 1 {
        return formula;
    }
    say::explain_start_angle(formula, start.saturating_sub(1), starts)
}

/// A message that consists only of `formula`, the same in every language.
pub(crate) fn formula_message(formula: String) -> Message {
    say::as_written(formula)
}
