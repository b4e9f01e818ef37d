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
use crate::interpreter::codes::positioning::check_stroke;
use crate::interpreter::context::BlockContext;
use crate::interpreter::exact::{ExactPoint, to_mm};
use crate::interpreter::moves::explanation::{Explanation, PassNote, depth_mm, formula_message};
use crate::interpreter::moves::{FrameShift, Move};
use crate::interpreter::state::State;
use crate::interpreter::threads::lead_word;
use crate::interpreter::threads::thread::{self, ThreadCut, long_axis};
use crate::interpreter::words::{AxisWords, LeadUnit, SortedWords};
use crate::units::{Axis, Point};

/// The three moves of a G33 or G34: rapid to the depth, thread, rapid out. Machine coordinates
/// in mm, X as a radius.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SinglePass {
    begin: Point,
    thread: Action,
    leave: Point,
    note: PassNote,
    step: u8,
}

/// Plans a G33 or G34 block. Sets `state.position` to the end of the last move, where the tool
/// stays.
///
/// # Errors
/// 062 for a pass without length, 011 or 043 for the lead, 043 for a point outside the stroke.
pub(crate) fn plan_pass(
    state: &mut State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    axes: &AxisWords,
    unit: LeadUnit,
) -> Result<SinglePass, Alarm> {
    let code = match unit {
        LeadUnit::Millimetres => 33,
        LeadUnit::PerInch => 34,
    };
    let lead = lead_word::read_lead(words, unit, code)?;
    let a = state.position;
    let or_zero = |x: Option<i64>| x.unwrap_or(0);
    let check = |point| check_stroke(point, context.coordinate_range());
    let begin = check(ExactPoint::new(
        a.x.saturating_add(or_zero(words.d_exact)),
        a.z,
    ))?;
    let end = check(axes.resolve_end(begin))?;
    if end == begin {
        return Err(pass_alarm(code, say::thread_pass_without_length()));
    }
    let leave = check(ExactPoint::new(
        end.x.saturating_add(or_zero(words.i)),
        end.z,
    ))?;
    let cut = ThreadCut {
        from: begin,
        to: end,
        long_axis: long_axis(begin, end),
        lead,
        increase: 0.0,
        run_out: None,
    };
    let shift = FrameShift::from_state(state);
    let start = ThreadStart::AtIndex { degrees: 0.0 };
    let pass = SinglePass {
        begin: shift.to_machine(begin),
        thread: cut.thread_action(shift, end, lead, start),
        leave: shift.to_machine(leave),
        note: PassNote::SinglePass {
            code,
            a,
            begin,
            end,
        },
        step: 0,
    };
    state.position = leave;
    state.end_at_position();
    Ok(pass)
}

impl SinglePass {
    /// Travel of each axis per spindle revolution in the cut, mm, X as a radius.
    pub(crate) fn travel_per_revolution(&self) -> Point {
        thread::travel_per_revolution(self.begin, [Some(&self.thread), None])
    }

    pub(crate) fn next_move(&mut self) -> Option<Move> {
        let step = self.step;
        self.step = step.saturating_add(1);
        match step {
            0 => Some(Move::rapid(self.begin, self.note)),
            1 => Some(Move::from_action(self.thread, self.note)),
            2 => Some(Move::rapid(self.leave, self.note)),
            _ => None,
        }
    }
}

fn pass_alarm(code: u8, detail: Message) -> Alarm {
    let detail = say::dialect_decided(say::cycle_in_code(code, detail));
    Alarm::new(number::CYCLE_DATA).with_detail(detail)
}

/// Explains G33 or G34 of the Huaxing lathes; `None` for the note of another cycle.
pub(crate) fn explain_single_pass(note: PassNote) -> Option<Explanation> {
    let PassNote::SinglePass {
        code,
        a,
        begin,
        end,
    } = note
    else {
        return None;
    };
    Some(Explanation {
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
    })
}
