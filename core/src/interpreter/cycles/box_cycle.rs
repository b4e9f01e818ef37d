//! The box of G90 and G94: a rapid, two cuts, and a rapid back to the start (manual I-3.2.5).

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::command::Action;
use crate::compensation::{Nose, box_corners};
use crate::interpreter::codes::positioning;
use crate::interpreter::exact::{CoordinateRange, ExactPoint, to_mm};
use crate::interpreter::moves::explanation::{
    Explanation, PassNote, depth_mm, format_corner_b, formula_message,
};
use crate::interpreter::moves::planned_action::PlannedAction;
use crate::interpreter::state::State;
use crate::units::{Axis, Feed, Point};

/// The remaining moves of a G90 or G94. Single block stops after each move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct BoxCycle {
    /// The ends of the four moves (B, C, D, A) in machine coordinates, mm, X as a radius.
    corners: [Point; 4],
    feed: Feed,
    step: u8,
    note: PassNote,
}

impl BoxCycle {
    /// Plans the four moves of a G90 or G94 through the programmed corners B, C and D and back
    /// to the start A.
    ///
    /// # Errors
    /// 043 for a corner outside the stroke, 011 without a feed.
    pub(crate) fn new(
        state: &State,
        corners: [ExactPoint; 4],
        range: CoordinateRange<'_>,
        note: PassNote,
    ) -> Result<Self, Alarm> {
        for corner in corners {
            positioning::check_stroke(corner, range)?;
        }
        Ok(Self {
            corners: corners.map(|corner| state.to_machine(corner).to_point()),
            feed: positioning::current_feed(&state.modal)?,
            step: 0,
            note,
        })
    }

    /// Shifts the four moves for the tool nose under G41 and G42. They begin and end at the
    /// machine point `start` (mm, X as a radius).
    pub(crate) fn shift_for_nose(&mut self, start: Point, nose: Nose) {
        self.corners = box_corners(start, self.corners, nose);
    }

    pub(crate) fn next_action(&mut self) -> Option<PlannedAction> {
        let to = *self.corners.get(usize::from(self.step))?;
        let is_cut = matches!(self.step, 1 | 2);
        self.step += 1;
        let action = if is_cut {
            Action::Line {
                to,
                feed: self.feed,
            }
        } else {
            Action::Rapid { to }
        };
        Some(PlannedAction::with_stop(action))
    }

    pub(crate) const fn is_done(&self) -> bool {
        self.step >= 4
    }

    /// The explanation data of the move taken last; `None` before the first move.
    pub(crate) fn pass_note(&self) -> Option<PassNote> {
        (self.step > 0).then_some(self.note)
    }
}

/// Checks that the taper R does not reach beyond the start: against the direction of the
/// infeed, R is at most as long as the infeed. Both are in units of [`ExactPoint`]. `names`
/// are the code of the cycle and its infeed word, for the message.
///
/// # Errors
/// 015 for a taper that reaches beyond the start.
pub(crate) fn check_taper(r: i64, infeed: i64, names: (&str, &str)) -> Result<(), Alarm> {
    let is_against = r != 0 && r.signum() != infeed.signum();
    if !is_against || (infeed != 0 && r.abs() <= infeed.abs()) {
        return Ok(());
    }
    let (cycle, infeed_name) = names;
    Err(
        Alarm::new(number::CYCLE_TAPER).with_detail(say::cycle_taper_longer_than_infeed(
            cycle,
            to_mm(r),
            infeed_name,
            to_mm(infeed),
        )),
    )
}

/// Explains a pass of G90 or G94; `None` for the note of another cycle.
pub(crate) fn explain_box(note: PassNote) -> Option<Explanation> {
    let PassNote::Box { axis, a, c, taper } = note else {
        return None;
    };
    let (code, words) = match axis {
        Axis::X => (90, "X(U), Z(W), R: a radius"),
        Axis::Z => (94, "X(U), Z(W), R"),
    };
    Some(Explanation {
        code,
        pass: 1,
        passes: Some(1),
        level: Some(to_mm(c.get(axis))),
        depth: depth_mm(axis, c.get(axis) - a.get(axis)).abs(),
        remaining: 0.0,
        formula: formula_message(format_corner_b(axis, c, taper)),
        words,
    })
}
