//! The box of G90 and G94: a rapid, two cuts, and a rapid back to the start (manual I-3.2.5).

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::command::Action;
use crate::compensation::{Nose, box_corners};
use crate::interpreter::codes::positioning;
use crate::interpreter::context::emission::Emission;
use crate::interpreter::context::exact::{Exact, Reach, mm};
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::state::State;
use crate::units::{Feed, Point};

/// A running box. Single block stops after each move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct BoxCycle {
    /// B, C, D, A in machine coordinates.
    corners: [Point; 4],
    feed: Feed,
    step: u8,
    note: Note,
}

impl BoxCycle {
    /// A box through the programmed corners B, C and D and back to the start A.
    ///
    /// # Errors
    /// 043 for a corner outside the stroke, 011 without a feed.
    pub(crate) fn over(
        state: &State,
        corners: [Exact; 4],
        reach: Reach<'_>,
        note: Note,
    ) -> Result<Self, Alarm> {
        for corner in corners {
            positioning::within_stroke(corner, reach)?;
        }
        Ok(Self {
            corners: corners.map(|corner| state.machine(corner).point()),
            feed: positioning::feed(&state.modal)?,
            step: 0,
            note,
        })
    }

    /// Shifts the legs for the tool nose under G41 and G42. The box begins and ends at the
    /// machine point `start`.
    pub(crate) fn follow_nose(&mut self, start: Point, nose: Nose) {
        self.corners = box_corners(start, self.corners, nose);
    }

    pub(crate) fn next(&mut self) -> Option<Emission> {
        let to = *self.corners.get(usize::from(self.step))?;
        let cuts = matches!(self.step, 1 | 2);
        self.step += 1;
        let action = if cuts {
            Action::Line {
                to,
                feed: self.feed,
            }
        } else {
            Action::Rapid { to }
        };
        Some(Emission::stopping(action))
    }

    pub(crate) const fn is_done(&self) -> bool {
        self.step >= 4
    }

    /// The explanation data of the move taken last.
    pub(crate) fn note(&self) -> Option<Note> {
        (self.step > 0).then_some(self.note)
    }
}

/// Checks that the taper R does not reach beyond the start: against the infeed, R is at most
/// as long as the infeed. Both are in units of [`Exact`]. `names` are the cycle's code and its
/// infeed word, for the message.
///
/// # Errors
/// 015.
pub(crate) fn check_taper(r: i64, infeed: i64, names: (&str, &str)) -> Result<(), Alarm> {
    let against = r != 0 && r.signum() != infeed.signum();
    if !against || (infeed != 0 && r.abs() <= infeed.abs()) {
        return Ok(());
    }
    let (cycle, infeed_name) = names;
    Err(
        Alarm::new(number::CYCLE_TAPER).because(say::cycle_taper_longer_than_infeed(
            cycle,
            mm(r),
            infeed_name,
            mm(infeed),
        )),
    )
}
