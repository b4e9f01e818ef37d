//! G81 and G82 of the Huaxing lathes: turning and facing in steps.
//!
//! ```text
//!   X ^    D <-----------4------------ A    G81: boxes like that of G90, each deeper by I
//!     |    ^                           |    (a difference of diameters) up to K before
//!     |    3                           1    the end point, the last one at the end point
//!     |    |                           v
//!     |    C <___________2____________ B    R: diameter at B of the last box; all
//!     +---------------------------------> Z cuts are parallel, and none reaches
//!                                           beyond A
//!   G82: X and Z exchanged, boxes like that of G94; R: the Z at B
//! ```

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::interpreter::codes::positioning::{check_stroke, current_feed};
use crate::interpreter::context::BlockContext;
use crate::interpreter::exact::{ExactPoint, scale_rounded, to_mm};
use crate::interpreter::moves::explanation::{
    Explanation, PassNote, axis_letter, depth_mm, formula_message,
};
use crate::interpreter::moves::{FrameShift, Move};
use crate::interpreter::state::State;
use crate::interpreter::words::{AxisWords, SortedWords};
use crate::units::{Axis, Feed};

/// The remaining moves of a G81 or G82. Lengths are in units of [`ExactPoint`], diameters
/// along X.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SteppedCycle {
    /// The axis in which the passes get deeper: X for G81, Z for G82.
    axis: Axis,
    shift: FrameShift,
    a: ExactPoint,
    /// B, the start of the cut of the last pass.
    b: ExactPoint,
    /// C, the end of the cut of the last pass.
    c: ExactPoint,
    feed: Feed,
    /// Direction in which the passes get deeper, 1 or -1.
    #[serde(rename = "way")]
    direction: i64,
    /// Distance from the start A to the deeper one of B and C, along `axis`, in units of
    /// [`ExactPoint`].
    #[serde(rename = "whole")]
    total_depth: i64,
    /// Depth of a roughing pass (I), in units of [`ExactPoint`].
    step: i64,
    /// Depth of the finishing pass (K); 0 for none.
    finish: i64,
    /// Number of the pass being cut, from 1.
    pass: i64,
    passes: i64,
    #[serde(rename = "leg")]
    move_index: u8,
}

/// Plans a G81 (`axis` X) or G82 (`axis` Z) block. The cycle ends at the start of the tool.
///
/// # Errors
/// 062 for wrong data, 043 for a corner outside the stroke, 011 without a feed.
pub(crate) fn plan_cycle(
    axis: Axis,
    state: &State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    axes: &AxisWords,
) -> Result<SteppedCycle, Alarm> {
    let (a, along) = (state.position, axis.other());
    let check = |point| check_stroke(point, context.coordinate_range());
    let c = check(axes.resolve_end(a))?;
    let mut b = a;
    b.set(axis, words.r.unwrap_or(c.get(axis)));
    let b = check(b)?;
    if c.get(along) == a.get(along) {
        let name = format_args!("{along:?}");
        return Err(stepped_alarm(axis, say::cycle_end_at_start(name)));
    }
    let (at_b, at_c) = (b.get(axis) - a.get(axis), c.get(axis) - a.get(axis));
    let (step, finish) = (words.i.unwrap_or(0), words.k.unwrap_or(0));
    // With a taper one of the two may be on the other side of A.
    let deeper = match if step == 0 { finish } else { step }.signum() {
        0 if at_b.abs() > at_c.abs() => at_b,
        0 => at_c,
        1 => at_b.max(at_c),
        _ => at_b.min(at_c),
    };
    if deeper == 0 {
        let name = format_args!("{axis:?}");
        return Err(stepped_alarm(axis, say::cycle_end_at_start(name)));
    }
    for (name, value) in [("I", step), ("K", finish)] {
        if value != 0 && value.signum() != deeper.signum() {
            let rule = say::cycle_step_wrong_way(name, to_mm(value), to_mm(deeper));
            return Err(stepped_alarm(axis, rule));
        }
    }
    let total_depth = deeper.abs();
    let finish = finish.abs().min(total_depth);
    let rough = total_depth - finish;
    let step = match step {
        0 => rough,
        step => step.abs(),
    };
    let roughing_passes = if rough == 0 {
        0
    } else {
        (rough + step - 1) / step
    };
    Ok(SteppedCycle {
        axis,
        shift: FrameShift::from_state(state),
        a,
        b,
        c,
        feed: current_feed(&state.modal)?,
        direction: deeper.signum(),
        total_depth,
        step,
        finish,
        pass: 1,
        passes: roughing_passes + i64::from(finish > 0),
        move_index: 0,
    })
}

impl SteppedCycle {
    /// Depth of the current pass from the start A, without sign.
    const fn pass_depth(&self) -> i64 {
        let roughed = self.total_depth - self.finish;
        let stepped = self.step.saturating_mul(self.pass);
        if self.pass >= self.passes {
            self.total_depth
        } else if stepped < roughed {
            stepped
        } else {
            roughed
        }
    }

    /// Start B and end C of the cut of the current pass, cut off at the level of the start A.
    fn pass_corners(&self) -> (ExactPoint, ExactPoint) {
        let axis = self.axis;
        let remaining = self
            .direction
            .saturating_mul(self.total_depth - self.pass_depth());
        let move_back = |point: ExactPoint| {
            let mut moved = point;
            moved.set(axis, point.get(axis).saturating_sub(remaining));
            moved
        };
        let (b, c) = (move_back(self.b), move_back(self.c));
        (self.cut_off(b, c), self.cut_off(c, b))
    }

    /// Returns `corner`, or if that corner is beyond the level of the start A, the point of
    /// the cut at that level. `other` is the other end of the cut.
    fn cut_off(&self, corner: ExactPoint, other: ExactPoint) -> ExactPoint {
        let (axis, along) = (self.axis, self.axis.other());
        let level = self.a.get(axis);
        let beyond = corner.get(axis) - level;
        if beyond.signum() != -self.direction {
            return corner;
        }
        let mut cut = corner;
        cut.set(axis, level);
        let to_other = other.get(along) - corner.get(along);
        let shift = scale_rounded(to_other, beyond, corner.get(axis) - other.get(axis));
        cut.set(along, corner.get(along) + shift);
        cut
    }

    pub(crate) fn next_move(&mut self) -> Option<Move> {
        if self.pass > self.passes {
            return None;
        }
        let note = PassNote::Stepped {
            axis: self.axis,
            pass: self.pass,
            passes: self.passes,
            a: self.a.get(self.axis),
            depth: self.direction * self.pass_depth(),
            whole: self.total_depth,
            step: self.step,
            finish: self.finish,
        };
        let (b, c) = self.pass_corners();
        let move_index = self.move_index;
        self.move_index = (move_index + 1) % 4;
        let to_machine = |point| self.shift.to_machine(point);
        Some(match move_index {
            0 => Move::rapid(to_machine(b), note),
            1 => Move::line(to_machine(c), self.feed, note),
            2 => {
                let mut d = c;
                d.set(self.axis, self.a.get(self.axis));
                Move::line(to_machine(d), self.feed, note)
            }
            _ => {
                self.pass += 1;
                Move::rapid(to_machine(self.a), note)
            }
        })
    }
}

fn stepped_alarm(axis: Axis, detail: Message) -> Alarm {
    let code = match axis {
        Axis::X => 81,
        Axis::Z => 82,
    };
    let detail = say::dialect_decided(say::cycle_in_code(code, detail));
    Alarm::new(number::CYCLE_DATA).with_detail(detail)
}

/// Explains a pass of G81 or G82; `None` for the note of another cycle.
pub(crate) fn explain_step(note: PassNote) -> Option<Explanation> {
    let PassNote::Stepped {
        axis,
        pass,
        passes,
        a,
        depth,
        whole,
        step,
        finish,
    } = note
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
