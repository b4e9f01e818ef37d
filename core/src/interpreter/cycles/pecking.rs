//! G74 and G75: pecking along Z or along X, column by column (manual I-3.2.6.5, I-3.2.6.6).
//! G83 of the Huaxing lathes pecks a single hole.
//!
//! ```text
//!   X ^                     A_1 = A   G74: 1 feed Δk, 2 rapid back e, …, to Z_Bf
//!     |  C_1 ______4______ D_1             3 rapid relief Δd in X
//!     |    3|                 |5           4 rapid to Z_A
//!     |  B_1 <-->_<-->_<--_ A_1            5 rapid to the next column, Δi on,
//!     |                     A_2              the last one exactly at X_Bf
//!     |  B_f ...                           6 rapid to A
//!     +--------------------------> Z   G75: the same with X and Z exchanged
//! ```

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::interpreter::codes::positioning::{check_stroke, current_feed};
use crate::interpreter::context::BlockContext;
use crate::interpreter::exact::length_on_axis;
use crate::interpreter::exact::{ExactPoint, UNITS_PER_MM, to_mm};
use crate::interpreter::moves::explanation::{Explanation, PassNote, axis_letter, depth_mm};
use crate::interpreter::moves::{FrameShift, Move};
use crate::interpreter::parameter_writes::ParameterWrites;
use crate::interpreter::state::State;
use crate::interpreter::words::{AxisTarget, AxisWords, SortedWords};
use crate::memory::{ControlParameters, parameter};
use crate::units::{Axis, Feed, Point};

/// Number of units of [`ExactPoint`] in a thousandth of a millimetre.
const UNITS_PER_MICRON: i64 = UNITS_PER_MM / 1000;

/// Names the next move of a pecking cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum PeckingPhase {
    Feed,
    Back,
    Relief,
    Out,
    Across,
    Home,
    Done,
}

/// The remaining moves of a G74, G75 or G83. Lengths are in units of [`ExactPoint`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PeckingCycle {
    /// The axis along which the tool pecks: Z for G74, X for G75.
    axis: Axis,
    shift: FrameShift,
    start: ExactPoint,
    end: ExactPoint,
    feed: Feed,
    /// Depth of a peck. This length and the next three are signed towards the end point.
    peck: i64,
    /// Length of the retract after a peck.
    retract: i64,
    /// Step from one column to the next, on the other axis.
    step: i64,
    /// Relief at the bottom of a column, on the other axis.
    relief: i64,
    /// Number of the current column of pecks, from 1.
    column: i64,
    columns: i64,
    pecked: i64,
    pecks: i64,
    phase: PeckingPhase,
    /// Whether the cycle is a G83 of the Huaxing lathes.
    #[serde(default)]
    deep_hole: bool,
}

/// Plans a G74 (`axis` Z) or G75 (`axis` X) block. A block with axis words, P or Q makes the
/// cycle. Another one only stores the retract R(e) and returns `None`.
///
/// # Errors
/// 062 for wrong data, 043 for an end outside the stroke, 011 without a feed.
pub(crate) fn plan_cycle(
    axis: Axis,
    state: &State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    axes: &AxisWords,
    writes: &mut ParameterWrites,
) -> Result<Option<PeckingCycle>, Alarm> {
    if !axes.has_any() && words.p.or(words.q).is_none() {
        if let Some(retract) = words.r {
            if retract < 0 {
                return Err(pecking_alarm(
                    axis,
                    say::cycle_retract_negative(to_mm(retract)),
                ));
            }
            writes.push_length(parameter::PECKING_RETRACT, retract);
        }
        return Ok(None);
    }
    let end = check_stroke(axes.resolve_end(state.position), context.coordinate_range())?;
    PeckingCycle::new(axis, state, context.parameters, words, axes, end).map(Some)
}

/// Plans a G83 of the Huaxing lathes: one hole along Z. The tool pecks by I, retracts by K
/// after each peck but not beyond the start, and leaves the hole. The signs of I and K have no
/// effect.
///
/// # Errors
/// 062 for wrong data, 043 for an end outside the stroke, 011 without a feed.
pub(crate) fn plan_deep_hole(
    state: &State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    axes: &AxisWords,
) -> Result<PeckingCycle, Alarm> {
    let start = state.position;
    let end = check_stroke(axes.resolve_end(start), context.coordinate_range())?;
    let depth = end.z - start.z;
    let peck = words.i.unwrap_or(0).saturating_abs();
    let violation = if end.x != start.x {
        Some(say::hole_moves_x())
    } else if depth == 0 {
        Some(say::cycle_end_at_start("Z"))
    } else if peck == 0 {
        Some(say::cycle_peck_missing("I"))
    } else {
        None
    };
    if let Some(rule) = violation {
        let rule = say::dialect_decided(say::cycle_in_code(83, rule));
        return Err(Alarm::new(number::CYCLE_DATA).with_detail(rule));
    }
    Ok(PeckingCycle {
        axis: Axis::Z,
        shift: FrameShift::from_state(state),
        start,
        end,
        feed: current_feed(&state.modal)?,
        peck: peck * depth.signum(),
        retract: words.k.unwrap_or(0).saturating_abs() * depth.signum(),
        step: 0,
        relief: 0,
        column: 1,
        columns: 1,
        pecked: 0,
        pecks: count_steps(depth, peck),
        phase: PeckingPhase::Feed,
        deep_hole: true,
    })
}

impl PeckingCycle {
    fn new(
        axis: Axis,
        state: &State,
        parameters: &ControlParameters,
        words: &SortedWords,
        axes: &AxisWords,
        end: ExactPoint,
    ) -> Result<Self, Alarm> {
        let side = axis.other();
        let start = state.position;
        let (p, q) = (
            read_amount(axis, 'P', words.p)?,
            read_amount(axis, 'Q', words.q)?,
        );
        // P is the step along X, Q the step along Z.
        let (peck, step, peck_name, step_name) = match axis {
            Axis::Z => (q, p, "Q(Δk)", "P(Δi)"),
            Axis::X => (p, q, "P(Δi)", "Q(Δk)"),
        };
        let relief = words.r.unwrap_or(0);
        if relief < 0 {
            return Err(pecking_alarm(
                axis,
                say::cycle_relief_negative(to_mm(relief)),
            ));
        }
        let depth = end.get(axis) - start.get(axis);
        let width = end.get(side) - start.get(side);
        if depth == 0 {
            return Err(pecking_alarm(
                axis,
                say::cycle_end_at_start(format_args!("{axis:?}")),
            ));
        }
        if peck == 0 {
            return Err(pecking_alarm(axis, say::cycle_peck_missing(peck_name)));
        }
        if width != 0 && step == 0 {
            return Err(pecking_alarm(
                axis,
                say::cycle_step_missing(step_name, format_args!("{side:?}")),
            ));
        }
        let has_relief = axes.get(side) != AxisTarget::None || step != 0;
        let columns = if width == 0 {
            1
        } else {
            count_steps(width, step) + 1
        };
        Ok(Self {
            axis,
            shift: FrameShift::from_state(state),
            start,
            end,
            feed: current_feed(&state.modal)?,
            peck: peck * depth.signum(),
            retract: length_on_axis(
                axis,
                i64::from(parameters.value(parameter::PECKING_RETRACT)) * UNITS_PER_MICRON,
            ) * depth.signum(),
            step: step * width.signum(),
            relief: if has_relief {
                relief * width.signum()
            } else {
                0
            },
            column: 1,
            columns,
            pecked: 0,
            pecks: count_steps(depth, peck),
            phase: PeckingPhase::Feed,
            deep_hole: false,
        })
    }

    /// Coordinate of the current column, on the axis across the pecks.
    fn column_coordinate(&self) -> i64 {
        let side = self.axis.other();
        if self.column >= self.columns {
            return self.end.get(side);
        }
        self.start.get(side) + self.step * (self.column - 1)
    }

    /// Coordinate of the end of the peck with the number `peck`, from 1.
    fn peck_end(&self, peck: i64) -> i64 {
        if peck >= self.pecks {
            return self.end.get(self.axis);
        }
        self.start.get(self.axis) + self.peck * peck
    }

    /// Coordinate to which the tool retracts after the peck with the number `peck`.
    fn retract_end(&self, peck: i64) -> i64 {
        let retracted = self.peck_end(peck) - self.retract;
        let top = self.start.get(self.axis);
        let is_beyond_start = (top - retracted).signum() == self.peck.signum();
        if self.deep_hole && is_beyond_start {
            top
        } else {
            retracted
        }
    }

    fn point(&self, depth: i64, across: i64) -> Point {
        self.shift.to_machine(match self.axis {
            Axis::Z => ExactPoint::new(across, depth),
            Axis::X => ExactPoint::new(depth, across),
        })
    }

    pub(crate) fn next_move(&mut self) -> Option<Move> {
        let column = self.column_coordinate();
        let top = self.start.get(self.axis);
        let relieved_column = column - self.relief;
        let pecked = match self.phase {
            PeckingPhase::Feed => self.pecked + 1,
            _ => self.pecked,
        };
        let note = PassNote::Column {
            axis: self.axis,
            number: self.column,
            columns: self.columns,
            at: column,
            from: top,
            step: self.step,
            peck: pecked,
            pecks: self.pecks,
            feed: self.peck,
            bottom: self.end.get(self.axis),
            deep_hole: self.deep_hole,
        };
        let rapid = |depth, across| Move::rapid(self.point(depth, across), note);
        let (next_move, next_phase) = match self.phase {
            PeckingPhase::Feed => {
                let to = self.point(self.peck_end(pecked), column);
                let phase = if pecked >= self.pecks {
                    PeckingPhase::Relief
                } else {
                    PeckingPhase::Back
                };
                (Move::line(to, self.feed, note), phase)
            }
            PeckingPhase::Back => (rapid(self.retract_end(pecked), column), PeckingPhase::Feed),
            PeckingPhase::Relief => (
                rapid(self.end.get(self.axis), relieved_column),
                PeckingPhase::Out,
            ),
            PeckingPhase::Out => {
                let phase = if self.column >= self.columns {
                    PeckingPhase::Home
                } else {
                    PeckingPhase::Across
                };
                (rapid(top, relieved_column), phase)
            }
            PeckingPhase::Across => {
                self.column += 1;
                self.pecked = 0;
                self.phase = PeckingPhase::Feed;
                return Some(Move::rapid(self.point(top, self.column_coordinate()), note));
            }
            PeckingPhase::Home => (
                Move::rapid(self.shift.to_machine(self.start), note),
                PeckingPhase::Done,
            ),
            PeckingPhase::Done => return None,
        };
        self.pecked = pecked;
        self.phase = next_phase;
        Some(next_move)
    }
}

/// Number of steps of the length `step` in a distance, rounded up.
fn count_steps(distance: i64, step: i64) -> i64 {
    (distance.abs() + step - 1) / step
}

/// Converts P or Q from thousandths of a millimetre to units of [`ExactPoint`]; 0 if missing.
/// Returns an alarm as error if it is out of range.
fn read_amount(axis: Axis, address: char, value: Option<i64>) -> Result<i64, Alarm> {
    match value {
        None => Ok(0),
        Some(value @ 0..=9_999_999) => Ok(value * UNITS_PER_MICRON),
        Some(value) => Err(pecking_alarm(
            axis,
            say::cycle_amount_out_of_range(address, value),
        )),
    }
}

fn pecking_alarm(axis: Axis, detail: Message) -> Alarm {
    let code = match axis {
        Axis::Z => 74,
        Axis::X => 75,
    };
    Alarm::new(number::CYCLE_DATA).with_detail(say::cycle_in_code(code, detail))
}

/// Explains a peck of G74, G75 or G83; `None` for the note of another cycle.
pub(crate) fn explain_column(note: PassNote) -> Option<Explanation> {
    let PassNote::Column {
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
    } = note
    else {
        return None;
    };
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
