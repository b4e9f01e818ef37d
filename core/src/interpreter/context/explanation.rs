//! Explains each pass of a cycle to a learner: depth, formula and words.

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::interpreter::context::exact::{ExactPoint, to_mm};
use crate::units::Axis;

/// Why a pass of a cycle is at its depth or position.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// G code of the cycle.
    pub code: u8,
    /// Number of the pass, column or start, from 1.
    pub pass: u64,
    /// Number of passes; `None` if only the cutting decides it.
    pub passes: Option<u64>,
    /// X (diameter) or Z of the level or column, programmed coordinates in mm; `None` for
    /// passes that follow a contour.
    pub level: Option<f64>,
    /// Depth reached, mm; a radius in X.
    pub depth: f64,
    /// Depth left for the following passes, mm; a radius in X.
    pub remaining: f64,
    /// The formula of the depth or position, with its numbers.
    pub formula: Message,
    /// The words and parameters that the formula reads.
    pub words: &'static str,
}

/// The rule by which G76 finds the depth of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum DepthRule {
    /// √n·Δd.
    Root,
    /// The previous depth plus Δdmin.
    Least,
    /// k - d: the last roughing pass.
    Last,
    /// k: a finishing pass.
    Finish,
}

/// The numbers of an explanation, stored with each move. Lengths are in units of [`ExactPoint`],
/// diameters in X if not stated otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum PassNote {
    /// A move without an explanation.
    None,
    /// A box of G90 (levels in X) or G94 (levels in Z), from A through B and C.
    Box {
        axis: Axis,
        a: ExactPoint,
        c: ExactPoint,
        /// R, a radius in X.
        taper: i64,
    },
    /// A start of G92, from A through B and C.
    Thread {
        start: u32,
        starts: u32,
        a: ExactPoint,
        c: ExactPoint,
        taper: i64,
        /// Height (a radius) and length of the run-out.
        run_out: (i64, i64),
    },
    /// A start of G33.
    Tap {
        start: u32,
        starts: u32,
        a: i64,
        bottom: i64,
        /// Its G code; 0 is G33.
        #[serde(default)]
        code: u8,
    },
    /// A pass of G76; depths are radii.
    ThreadPass {
        number: u64,
        depth: i64,
        previous: i64,
        height: i64,
        first: i64,
        least: i64,
        rule: DepthRule,
    },
    /// A level of G71 (X) or G72 (Z).
    Level {
        axis: Axis,
        number: i64,
        levels: i64,
        /// Level of the start, allowance included.
        from: i64,
        /// Signed step from one level to the next.
        step: i64,
        /// Level of the deepest point, allowance included.
        last: i64,
    },
    /// The contour pass of G71 and G72.
    Contour {
        axis: Axis,
        levels: i64,
        allowance: ExactPoint,
    },
    /// A pass of G73.
    Shifted {
        number: i64,
        passes: i64,
        shift: ExactPoint,
        allowance: ExactPoint,
        /// Δi and Δk, X as a diameter.
        relief: ExactPoint,
    },
    /// A column of G74 (along Z) or G75 (along X).
    Column {
        axis: Axis,
        number: i64,
        columns: i64,
        /// Coordinate of the column on the other axis.
        at: i64,
        from: i64,
        step: i64,
        /// Number of the current peck, 0 outside pecks, and number of pecks.
        peck: i64,
        pecks: i64,
        /// Peck depth, signed.
        feed: i64,
        bottom: i64,
        /// G83 of the Huaxing lathes.
        #[serde(default)]
        deep_hole: bool,
    },
    /// A box of G81 (levels in X) or G82 (levels in Z) of the Huaxing lathes.
    Stepped {
        axis: Axis,
        pass: i64,
        passes: i64,
        /// Level of the start.
        a: i64,
        /// Signed distance of this box from the start, and distance of the last box.
        depth: i64,
        whole: i64,
        step: i64,
        finish: i64,
    },
    /// G33 or G34 of the Huaxing lathes.
    SinglePass {
        code: u8,
        a: ExactPoint,
        begin: ExactPoint,
        end: ExactPoint,
    },
    /// A pass of G86 or G87; depths are differences of diameters.
    CountedThread {
        code: u8,
        pass: i64,
        passes: i64,
        /// Counted from 0.
        start: u32,
        starts: u32,
        /// X of the start, which is the crest of the thread.
        crest: i64,
        depth: i64,
        whole: i64,
    },
}

/// A length in units of [`ExactPoint`] as a depth in mm, a radius along X.
fn depth_mm(axis: Axis, units: i64) -> f64 {
    match axis {
        Axis::X => to_mm(units) / 2.0,
        Axis::Z => to_mm(units),
    }
}

const fn axis_letter(axis: Axis) -> char {
    match axis {
        Axis::X => 'X',
        Axis::Z => 'Z',
    }
}

impl PassNote {
    pub(crate) fn explain(self) -> Option<Explanation> {
        match self {
            Self::None => None,
            Self::Box { axis, a, c, taper } => Some(explain_box(axis, a, c, taper)),
            Self::Thread {
                start,
                starts,
                a,
                c,
                taper,
                run_out: (height, length),
            } => Some(Explanation {
                code: 92,
                pass: start.into(),
                passes: Some(starts.into()),
                level: Some(to_mm(c.x)),
                depth: depth_mm(Axis::X, c.x - a.x).abs(),
                remaining: 0.0,
                formula: with_start_angle(
                    say::explain_thread(
                        format_corner_b(Axis::X, c, taper),
                        to_mm(height),
                        to_mm(length),
                    ),
                    start,
                    starts,
                ),
                words: "X(U), Z(W), R, J, K, 019, L",
            }),
            Self::Tap {
                start,
                starts,
                a,
                bottom,
                code,
            } => Some(Explanation {
                code: if code == 0 { 33 } else { code },
                pass: start.into(),
                passes: Some(starts.into()),
                level: None,
                depth: to_mm(bottom - a).abs(),
                remaining: 0.0,
                formula: with_start_angle(say::explain_tap(to_mm(a), to_mm(bottom)), start, starts),
                words: match code {
                    84 => "Z, K",
                    85 => "Z, I",
                    _ => "Z(W), F(I), L",
                },
            }),
            Self::ThreadPass {
                number,
                depth,
                previous,
                height,
                first,
                least,
                rule,
            } => {
                let shown = to_mm(depth);
                let formula = match rule {
                    DepthRule::Root => formula_message(format!(
                        "d{number} = √{number}·{:.3} = {shown:.3}",
                        to_mm(first)
                    )),
                    DepthRule::Least => formula_message(format!(
                        "d{number} = d{} + Δdmin = {:.3} + {:.3} = {shown:.3}",
                        number - 1,
                        to_mm(previous),
                        to_mm(least)
                    )),
                    DepthRule::Last => formula_message(format!(
                        "d{number} = k - d = {:.3} - {:.3}",
                        to_mm(height),
                        to_mm(height - depth)
                    )),
                    DepthRule::Finish => say::explain_finish_pass(shown, to_mm(depth - previous)),
                };
                Some(Explanation {
                    code: 76,
                    pass: number,
                    passes: None,
                    level: None,
                    depth: shown,
                    remaining: to_mm(height - depth),
                    formula,
                    words: match rule {
                        DepthRule::Root => "Q(Δd)",
                        DepthRule::Least => "Q(Δdmin), 059",
                        DepthRule::Last => "P(k), R(d), 060",
                        DepthRule::Finish => "P(k), P(m), 057",
                    },
                })
            }
            Self::Level {
                axis,
                number,
                levels,
                from,
                step,
                last,
            } => {
                let level = from + step * number;
                let axis_name = axis_letter(axis);
                Some(Explanation {
                    code: roughing_code(axis),
                    pass: number.unsigned_abs(),
                    passes: Some(levels.unsigned_abs()),
                    level: Some(to_mm(level)),
                    depth: depth_mm(axis, step * number).abs(),
                    remaining: depth_mm(axis, last - level).abs(),
                    formula: formula_message(format!(
                        "{axis_name}{number} = {:.3} {:+.3}·{number} = {:.3}",
                        to_mm(from),
                        to_mm(step),
                        to_mm(level)
                    )),
                    words: match axis {
                        Axis::X => "U(Δd), 051",
                        Axis::Z => "W(Δd), 051",
                    },
                })
            }
            Self::Contour {
                axis,
                levels,
                allowance,
            } => Some(Explanation {
                code: roughing_code(axis),
                pass: levels.unsigned_abs(),
                passes: Some(levels.unsigned_abs()),
                level: None,
                depth: 0.0,
                remaining: 0.0,
                formula: say::explain_contour(to_mm(allowance.x), to_mm(allowance.z)),
                words: "U(Δu), W(Δw)",
            }),
            Self::Shifted {
                number,
                passes,
                shift,
                allowance,
                relief,
            } => Some(Explanation {
                code: 73,
                pass: number.unsigned_abs(),
                passes: Some(passes.unsigned_abs()),
                level: None,
                depth: to_mm(relief.x + allowance.x - shift.x).abs() / 2.0,
                remaining: to_mm(shift.x - allowance.x).abs() / 2.0,
                formula: formula_message(format!(
                    "X{:+.3} = {:+.3} {:+.3}·{left}/{gaps}, Z{:+.3} = {:+.3} {:+.3}·{left}/{gaps}",
                    to_mm(shift.x),
                    to_mm(allowance.x),
                    to_mm(relief.x),
                    to_mm(shift.z),
                    to_mm(allowance.z),
                    to_mm(relief.z),
                    left = passes - number,
                    gaps = passes - 1,
                )),
                words: "U(Δi), W(Δk), R(d), 053, 054, 055, U(Δu), W(Δw)",
            }),
            Self::Column {
                axis,
                number,
                columns,
                at,
                from,
                step,
                peck,
                pecks,
                feed,
                bottom,
                deep_hole,
            } => {
                let reached = if peck >= pecks {
                    bottom
                } else {
                    from + feed * peck
                };
                Some(Explanation {
                    code: match axis {
                        _ if deep_hole => 83,
                        Axis::Z => 74,
                        Axis::X => 75,
                    },
                    pass: number.unsigned_abs(),
                    passes: Some(columns.unsigned_abs()),
                    level: Some(to_mm(at)),
                    depth: depth_mm(axis, reached - from).abs(),
                    remaining: depth_mm(axis, bottom - reached).abs(),
                    formula: say::explain_peck(
                        peck,
                        pecks,
                        axis_letter(axis),
                        to_mm(reached),
                        number,
                        columns,
                        to_mm(step),
                    ),
                    words: match deep_hole {
                        true => "Z, I, K",
                        false => "P(Δi), Q(Δk), R(e), 056, R(Δd)",
                    },
                })
            }
            Self::Stepped { .. } => self.explain_stepped(),
            Self::SinglePass { .. } | Self::CountedThread { .. } => self.explain_word_thread(),
        }
    }

    /// Explains a box of G81 or G82.
    fn explain_stepped(self) -> Option<Explanation> {
        let Self::Stepped {
            axis,
            pass,
            passes,
            a,
            depth,
            whole,
            step,
            finish,
        } = self
        else {
            return None;
        };
        let (level, remaining, at) = (a + depth, whole - depth.abs(), axis_letter(axis));
        let formula = match depth.abs() {
            full if full == whole => format!("{at}{pass} = {:.3}", to_mm(level)),
            rough if rough == whole - finish => format!(
                "{at}{pass} = {:.3} {:+.3} = {:.3}",
                to_mm(a + whole * depth.signum()),
                to_mm(-finish * depth.signum()),
                to_mm(level)
            ),
            _ => format!(
                "{at}{pass} = {:.3} {:+.3}·{pass} = {:.3}",
                to_mm(a),
                to_mm(step * depth.signum()),
                to_mm(level)
            ),
        };
        Some(Explanation {
            code: match axis {
                Axis::X => 81,
                Axis::Z => 82,
            },
            pass: pass.unsigned_abs(),
            passes: Some(passes.unsigned_abs()),
            level: Some(to_mm(level)),
            depth: depth_mm(axis, depth).abs(),
            remaining: depth_mm(axis, remaining).abs(),
            formula: formula_message(formula),
            words: "X, Z, R, I, K",
        })
    }

    /// Explains a thread of the Huaxing lathes.
    fn explain_word_thread(self) -> Option<Explanation> {
        match self {
            Self::SinglePass {
                code,
                a,
                begin,
                end,
            } => Some(Explanation {
                code,
                pass: 1,
                passes: Some(1),
                level: Some(to_mm(end.x)),
                depth: depth_mm(Axis::X, begin.x - a.x).abs(),
                remaining: 0.0,
                formula: formula_message(format!(
                    "X_B = {:.3} {:+.3} = {:.3}",
                    to_mm(a.x),
                    to_mm(begin.x - a.x),
                    to_mm(begin.x)
                )),
                words: "D, X, Z, K, I",
            }),
            Self::CountedThread {
                code,
                pass,
                passes,
                start,
                starts,
                crest,
                depth,
                whole,
            } => {
                let formula = formula_message(format!(
                    "d{pass} = {:.3}·√({pass}/{passes}) = {:.3}",
                    to_mm(whole),
                    to_mm(depth)
                ));
                Some(Explanation {
                    code,
                    pass: pass.unsigned_abs(),
                    passes: Some(passes.unsigned_abs()),
                    level: Some(to_mm(crest)),
                    depth: depth_mm(Axis::X, depth),
                    remaining: depth_mm(Axis::X, whole - depth),
                    formula: with_start_angle(formula, start + 1, starts),
                    words: "R, L, N, K, I, J",
                })
            }
            _ => None,
        }
    }
}

/// Explains the box of G90 or G94.
fn explain_box(axis: Axis, a: ExactPoint, c: ExactPoint, taper: i64) -> Explanation {
    let (code, words) = match axis {
        Axis::X => (90, "X(U), Z(W), R: a radius"),
        Axis::Z => (94, "X(U), Z(W), R"),
    };
    Explanation {
        code,
        pass: 1,
        passes: Some(1),
        level: Some(to_mm(c.get(axis))),
        depth: depth_mm(axis, c.get(axis) - a.get(axis)).abs(),
        remaining: 0.0,
        formula: formula_message(format_corner_b(axis, c, taper)),
        words,
    }
}

/// The formula of B, the first corner of the cut: `X_B = X_C + 2R` or `Z_B = Z_C + R`.
fn format_corner_b(axis: Axis, c: ExactPoint, taper: i64) -> String {
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

/// Adds the start angle of a multi-start thread to a formula.
fn with_start_angle(formula: Message, start: u32, starts: u32) -> Message {
    if starts <= 1 {
        return formula;
    }
    say::explain_start_angle(formula, start.saturating_sub(1), starts)
}

/// A formula without words, the same in every language.
fn formula_message(formula: String) -> Message {
    say::as_written(formula)
}

const fn roughing_code(axis: Axis) -> u8 {
    match axis {
        Axis::X => 71,
        Axis::Z => 72,
    }
}
