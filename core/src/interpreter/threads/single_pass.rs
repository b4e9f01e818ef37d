//! G33 and G34 of the Huaxing lathes: one pass of a thread.
//!
//! ```text
//!   X ^            A      1 rapid by D, a difference of diameters with its sign
//!     |     E      |1     2 thread to X, Z; without X parallel to Z
//!     |    3|      v      3 rapid by I, likewise
//!     |     C <-2- B      The tool stays at E.
//!     +-------------> Z
//! ```

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::command::{Action, ThreadStart};
use crate::interpreter::codes::positioning::within_stroke;
use crate::interpreter::context::Context;
use crate::interpreter::context::exact::Exact;
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::moves::{Move, Shift};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{AxisWords, LeadUnit, Words};
use crate::interpreter::threads::lead_word;
use crate::interpreter::threads::thread::{self, Cut, long_axis};
use crate::units::Point;

/// The three moves of a pass, machine coordinates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SinglePass {
    begin: Point,
    thread: Action,
    leave: Point,
    note: Note,
    step: u8,
}

/// Plans a G33 or G34 block. Sets `state.position` to E, where the tool stays.
///
/// # Errors
/// 062 for a pass without length, 011 or 043 for the lead, 043 for a point outside the stroke.
pub(crate) fn plan(
    state: &mut State,
    context: &Context<'_>,
    words: &Words,
    axes: &AxisWords,
    unit: LeadUnit,
) -> Result<SinglePass, Alarm> {
    let code = match unit {
        LeadUnit::Millimetres => 33,
        LeadUnit::PerInch => 34,
    };
    let lead = lead_word::lead(words, unit, code)?;
    let a = state.position;
    let by = |x: Option<i64>| x.unwrap_or(0);
    let reach = |point| within_stroke(point, context.reach());
    let begin = reach(Exact::new(a.x.saturating_add(by(words.d_exact)), a.z))?;
    let end = reach(axes.target(begin))?;
    if end == begin {
        return Err(fault(code, say::thread_pass_without_length()));
    }
    let leave = reach(Exact::new(end.x.saturating_add(by(words.i)), end.z))?;
    let cut = Cut {
        from: begin,
        to: end,
        long: long_axis(begin, end),
        lead,
        increase: 0.0,
        tail: None,
    };
    let shift = Shift::of(state);
    let start = ThreadStart::AtIndex { degrees: 0.0 };
    let pass = SinglePass {
        begin: shift.machine(begin),
        thread: cut.action(shift, end, lead, start),
        leave: shift.machine(leave),
        note: Note::SinglePass {
            code,
            a,
            begin,
            end,
        },
        step: 0,
    };
    state.position = leave;
    state.return_here();
    Ok(pass)
}

impl SinglePass {
    /// Travel of each axis per revolution in the cut, mm.
    pub(crate) fn per_revolution(&self) -> Point {
        thread::per_revolution(self.begin, [Some(&self.thread), None])
    }

    pub(crate) fn make(&mut self) -> Option<Move> {
        let step = self.step;
        self.step = step.saturating_add(1);
        match step {
            0 => Some(Move::rapid(self.begin, self.note)),
            1 => Some(Move::of(self.thread, self.note)),
            2 => Some(Move::rapid(self.leave, self.note)),
            _ => None,
        }
    }
}

fn fault(code: u8, detail: Message) -> Alarm {
    let detail = say::dialect_decided(say::cycle_in_code(code, detail));
    Alarm::new(number::CYCLE_DATA).because(detail)
}
