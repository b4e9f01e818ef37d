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
use crate::interpreter::codes::positioning::{feed, within_stroke};
use crate::interpreter::context::Context;
use crate::interpreter::context::exact::along;
use crate::interpreter::context::exact::{Exact, PER_MM, mm};
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::moves::{Move, Shift};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{AxisWords, Target, Words};
use crate::interpreter::context::writes::Writes;
use crate::memory::{Parameters, parameter};
use crate::units::{Axis, Feed, Point};

/// Units of [`Exact`] in a thousandth of a millimetre.
const PER_MICRON: i64 = PER_MM / 1000;

/// The next move of a pecking cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    Feed,
    Back,
    Relief,
    Out,
    Across,
    Home,
    Done,
}

/// A running G74, G75 or G83. Lengths are in units of [`Exact`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Pecking {
    /// The axis of the pecks: Z for G74, X for G75.
    axis: Axis,
    shift: Shift,
    start: Exact,
    end: Exact,
    feed: Feed,
    /// Peck depth, retract, step between columns and relief, signed towards the end point.
    /// Step and relief are on the other axis.
    peck: i64,
    retract: i64,
    step: i64,
    relief: i64,
    /// Number of the current column, from 1.
    column: i64,
    columns: i64,
    pecked: i64,
    pecks: i64,
    phase: Phase,
    /// Whether the cycle is a G83 of the Huaxing lathes.
    #[serde(default)]
    deep_hole: bool,
}

/// Plans a G74 (`axis` Z) or G75 (`axis` X) block. With axis words, P or Q it is the cycle.
/// Without them it stores the retract, and the result is `None`.
///
/// # Errors
/// 062 for wrong data, 043 for an end outside the stroke, 011 without a feed.
pub(crate) fn plan(
    axis: Axis,
    state: &State,
    context: &Context<'_>,
    words: &Words,
    axes: &AxisWords,
    writes: &mut Writes,
) -> Result<Option<Pecking>, Alarm> {
    if !axes.any() && words.p.or(words.q).is_none() {
        if let Some(retract) = words.r {
            if retract < 0 {
                return Err(fault(axis, say::cycle_retract_negative(mm(retract))));
            }
            writes.push_length(parameter::PECKING_RETRACT, retract);
        }
        return Ok(None);
    }
    let end = within_stroke(axes.target(state.position), context.reach())?;
    Pecking::new(axis, state, context.parameters, words, axes, end).map(Some)
}

/// Plans a G83 of the Huaxing lathes: one hole along Z. The tool pecks by I, retracts by K
/// after each peck but not beyond the start, and leaves the hole. The signs of I and K have no
/// effect.
///
/// # Errors
/// 062 for wrong data, 043 for an end outside the stroke, 011 without a feed.
pub(crate) fn deep_hole(
    state: &State,
    context: &Context<'_>,
    words: &Words,
    axes: &AxisWords,
) -> Result<Pecking, Alarm> {
    let start = state.position;
    let end = within_stroke(axes.target(start), context.reach())?;
    let deep = end.z - start.z;
    let peck = words.i.unwrap_or(0).saturating_abs();
    let broken = if end.x != start.x {
        Some(say::hole_moves_x())
    } else if deep == 0 {
        Some(say::cycle_end_at_start("Z"))
    } else if peck == 0 {
        Some(say::cycle_peck_missing("I"))
    } else {
        None
    };
    if let Some(rule) = broken {
        let rule = say::dialect_decided(say::cycle_in_code(83, rule));
        return Err(Alarm::new(number::CYCLE_DATA).because(rule));
    }
    Ok(Pecking {
        axis: Axis::Z,
        shift: Shift::of(state),
        start,
        end,
        feed: feed(&state.modal)?,
        peck: peck * deep.signum(),
        retract: words.k.unwrap_or(0).saturating_abs() * deep.signum(),
        step: 0,
        relief: 0,
        column: 1,
        columns: 1,
        pecked: 0,
        pecks: whole(deep, peck),
        phase: Phase::Feed,
        deep_hole: true,
    })
}

impl Pecking {
    fn new(
        axis: Axis,
        state: &State,
        parameters: &Parameters,
        words: &Words,
        axes: &AxisWords,
        end: Exact,
    ) -> Result<Self, Alarm> {
        let side = axis.other();
        let start = state.position;
        let (p, q) = (amount(axis, 'P', words.p)?, amount(axis, 'Q', words.q)?);
        // P is the step along X, Q the step along Z.
        let (peck, step, peck_name, step_name) = match axis {
            Axis::Z => (q, p, "Q(Δk)", "P(Δi)"),
            Axis::X => (p, q, "P(Δi)", "Q(Δk)"),
        };
        let relief = words.r.unwrap_or(0);
        if relief < 0 {
            return Err(fault(axis, say::cycle_relief_negative(mm(relief))));
        }
        let deep = end.get(axis) - start.get(axis);
        let wide = end.get(side) - start.get(side);
        if deep == 0 {
            return Err(fault(
                axis,
                say::cycle_end_at_start(format_args!("{axis:?}")),
            ));
        }
        if peck == 0 {
            return Err(fault(axis, say::cycle_peck_missing(peck_name)));
        }
        if wide != 0 && step == 0 {
            return Err(fault(
                axis,
                say::cycle_step_missing(step_name, format_args!("{side:?}")),
            ));
        }
        let relieved = axes.get(side) != Target::None || step != 0;
        let columns = if wide == 0 { 1 } else { whole(wide, step) + 1 };
        Ok(Self {
            axis,
            shift: Shift::of(state),
            start,
            end,
            feed: feed(&state.modal)?,
            peck: peck * deep.signum(),
            retract: along(
                axis,
                i64::from(parameters.value(parameter::PECKING_RETRACT)) * PER_MICRON,
            ) * deep.signum(),
            step: step * wide.signum(),
            relief: if relieved { relief * wide.signum() } else { 0 },
            column: 1,
            columns,
            pecked: 0,
            pecks: whole(deep, peck),
            phase: Phase::Feed,
            deep_hole: false,
        })
    }

    /// Coordinate of the current column on the other axis.
    fn column_at(&self) -> i64 {
        let side = self.axis.other();
        if self.column >= self.columns {
            return self.end.get(side);
        }
        self.start.get(side) + self.step * (self.column - 1)
    }

    /// Coordinate of the end of a peck.
    fn peck_end(&self, peck: i64) -> i64 {
        if peck >= self.pecks {
            return self.end.get(self.axis);
        }
        self.start.get(self.axis) + self.peck * peck
    }

    /// Coordinate of the retract after a peck.
    fn back_from(&self, peck: i64) -> i64 {
        let back = self.peck_end(peck) - self.retract;
        let top = self.start.get(self.axis);
        let beyond = (top - back).signum() == self.peck.signum();
        if self.deep_hole && beyond { top } else { back }
    }

    fn point(&self, deep: i64, across: i64) -> Point {
        self.shift.machine(match self.axis {
            Axis::Z => Exact::new(across, deep),
            Axis::X => Exact::new(deep, across),
        })
    }

    pub(crate) fn make(&mut self) -> Option<Move> {
        let at = self.column_at();
        let top = self.start.get(self.axis);
        let aside = at - self.relief;
        let pecked = match self.phase {
            Phase::Feed => self.pecked + 1,
            _ => self.pecked,
        };
        let note = Note::Column {
            axis: self.axis,
            number: self.column,
            columns: self.columns,
            at,
            from: top,
            step: self.step,
            peck: pecked,
            pecks: self.pecks,
            feed: self.peck,
            bottom: self.end.get(self.axis),
            deep_hole: self.deep_hole,
        };
        let rapid = |deep, across| Move::rapid(self.point(deep, across), note);
        let (made, phase) = match self.phase {
            Phase::Feed => {
                let to = self.point(self.peck_end(pecked), at);
                let phase = if pecked >= self.pecks {
                    Phase::Relief
                } else {
                    Phase::Back
                };
                (Move::line(to, self.feed, note), phase)
            }
            Phase::Back => (rapid(self.back_from(pecked), at), Phase::Feed),
            Phase::Relief => (rapid(self.end.get(self.axis), aside), Phase::Out),
            Phase::Out => {
                let phase = if self.column >= self.columns {
                    Phase::Home
                } else {
                    Phase::Across
                };
                (rapid(top, aside), phase)
            }
            Phase::Across => {
                self.column += 1;
                self.pecked = 0;
                self.phase = Phase::Feed;
                return Some(Move::rapid(self.point(top, self.column_at()), note));
            }
            Phase::Home => (
                Move::rapid(self.shift.machine(self.start), note),
                Phase::Done,
            ),
            Phase::Done => return None,
        };
        self.pecked = pecked;
        self.phase = phase;
        Some(made)
    }
}

/// Number of steps in a distance, rounded up.
fn whole(distance: i64, step: i64) -> i64 {
    (distance.abs() + step - 1) / step
}

/// P or Q in units of [`Exact`]; 0 if missing.
fn amount(axis: Axis, address: char, value: Option<i64>) -> Result<i64, Alarm> {
    match value {
        None => Ok(0),
        Some(value @ 0..=9_999_999) => Ok(value * PER_MICRON),
        Some(value) => Err(fault(axis, say::cycle_amount_out_of_range(address, value))),
    }
}

fn fault(axis: Axis, detail: Message) -> Alarm {
    let code = match axis {
        Axis::Z => 74,
        Axis::X => 75,
    };
    Alarm::new(number::CYCLE_DATA).because(say::cycle_in_code(code, detail))
}
