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
use crate::interpreter::codes::positioning::{feed, within_stroke};
use crate::interpreter::context::Context;
use crate::interpreter::context::exact::{Exact, mm, scaled};
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::moves::{Move, Shift};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{AxisWords, Words};
use crate::units::{Axis, Feed};

/// A running G81 or G82. Lengths are in units of [`Exact`], diameters along X.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Stepped {
    /// The axis of the levels: X for G81, Z for G82.
    axis: Axis,
    shift: Shift,
    a: Exact,
    /// B and C of the last box.
    b: Exact,
    c: Exact,
    feed: Feed,
    /// Direction of the levels, 1 or -1.
    #[serde(rename = "way")]
    way: i64,
    /// Distance from A to the deeper one of B and C; depths per pass by I and K.
    #[serde(rename = "whole")]
    whole: i64,
    step: i64,
    finish: i64,
    /// Number of the current pass, from 1.
    pass: i64,
    passes: i64,
    #[serde(rename = "leg")]
    leg: u8,
}

/// Plans a G81 (`axis` X) or G82 (`axis` Z) block. The tool ends at its start.
///
/// # Errors
/// 062 for wrong data, 043 for a corner outside the stroke, 011 without a feed.
pub(crate) fn plan(
    axis: Axis,
    state: &State,
    context: &Context<'_>,
    words: &Words,
    axes: &AxisWords,
) -> Result<Stepped, Alarm> {
    let (a, along) = (state.position, axis.other());
    let reach = |point| within_stroke(point, context.reach());
    let c = reach(axes.target(a))?;
    let mut b = a;
    b.set(axis, words.r.unwrap_or(c.get(axis)));
    let b = reach(b)?;
    if c.get(along) == a.get(along) {
        let name = format_args!("{along:?}");
        return Err(fault(axis, say::cycle_end_at_start(name)));
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
        return Err(fault(axis, say::cycle_end_at_start(name)));
    }
    for (name, value) in [("I", step), ("K", finish)] {
        if value != 0 && value.signum() != deeper.signum() {
            let rule = say::cycle_step_wrong_way(name, mm(value), mm(deeper));
            return Err(fault(axis, rule));
        }
    }
    let whole = deeper.abs();
    let finish = finish.abs().min(whole);
    let rough = whole - finish;
    let step = match step {
        0 => rough,
        step => step.abs(),
    };
    let cuts = if rough == 0 {
        0
    } else {
        (rough + step - 1) / step
    };
    Ok(Stepped {
        axis,
        shift: Shift::of(state),
        a,
        b,
        c,
        feed: feed(&state.modal)?,
        way: deeper.signum(),
        whole,
        step,
        finish,
        pass: 1,
        passes: cuts + i64::from(finish > 0),
        leg: 0,
    })
}

impl Stepped {
    /// Depth of the current pass from A.
    const fn depth(&self) -> i64 {
        let roughed = self.whole - self.finish;
        let stepped = self.step.saturating_mul(self.pass);
        if self.pass >= self.passes {
            self.whole
        } else if stepped < roughed {
            stepped
        } else {
            roughed
        }
    }

    /// B and C of the current pass, cut off at the level of A.
    fn corners(&self) -> (Exact, Exact) {
        let axis = self.axis;
        let left = self.way.saturating_mul(self.whole - self.depth());
        let moved = |point: Exact| {
            let mut moved = point;
            moved.set(axis, point.get(axis).saturating_sub(left));
            moved
        };
        let (b, c) = (moved(self.b), moved(self.c));
        (self.cut_off(b, c), self.cut_off(c, b))
    }

    /// A corner or, if it is beyond the level of A, the point of the cut at that level.
    fn cut_off(&self, corner: Exact, other: Exact) -> Exact {
        let (axis, along) = (self.axis, self.axis.other());
        let level = self.a.get(axis);
        let beyond = corner.get(axis) - level;
        if beyond.signum() != -self.way {
            return corner;
        }
        let mut cut = corner;
        cut.set(axis, level);
        let to_other = other.get(along) - corner.get(along);
        let by = scaled(to_other, beyond, corner.get(axis) - other.get(axis));
        cut.set(along, corner.get(along) + by);
        cut
    }

    pub(crate) fn make(&mut self) -> Option<Move> {
        if self.pass > self.passes {
            return None;
        }
        let note = Note::Stepped {
            axis: self.axis,
            pass: self.pass,
            passes: self.passes,
            a: self.a.get(self.axis),
            depth: self.way * self.depth(),
            whole: self.whole,
            step: self.step,
            finish: self.finish,
        };
        let (b, c) = self.corners();
        let leg = self.leg;
        self.leg = (leg + 1) % 4;
        let at = |point| self.shift.machine(point);
        Some(match leg {
            0 => Move::rapid(at(b), note),
            1 => Move::line(at(c), self.feed, note),
            2 => {
                let mut d = c;
                d.set(self.axis, self.a.get(self.axis));
                Move::line(at(d), self.feed, note)
            }
            _ => {
                self.pass += 1;
                Move::rapid(at(self.a), note)
            }
        })
    }
}

fn fault(axis: Axis, detail: Message) -> Alarm {
    let code = match axis {
        Axis::X => 81,
        Axis::Z => 82,
    };
    let detail = say::dialect_decided(say::cycle_in_code(code, detail));
    Alarm::new(number::CYCLE_DATA).because(detail)
}
