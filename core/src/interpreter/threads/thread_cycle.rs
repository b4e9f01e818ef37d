//! G92: thread cycle (manual I-3.2.4.4).
//!
//! ```text
//!   X ^    D <-----------4------------ A       1 rapid X to B
//!     |    ^                           |       2 thread B -> C, run-out over the length
//!     |    3                           1         K before the end by the height J
//!     |    |\                          v       3 rapid X to the start
//!     |    C \___________2____________ B       4 rapid Z to A
//!     +---------------------------------> Z    L starts: repeat all, 360°/L further
//! ```

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::command::{Action, BeyondPass, ThreadStart};
use crate::interpreter::codes::positioning::within_stroke;
use crate::interpreter::context::cycle_words::CycleData;
use crate::interpreter::context::exact::along;
use crate::interpreter::context::exact::{Exact, PER_MM, Reach, to_units};
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::moves::{Move, Shift};
use crate::interpreter::context::state::State;
use crate::interpreter::cycles::box_cycle::check_taper;
use crate::interpreter::threads::tapping::phase;
use crate::interpreter::threads::thread::{self, Cut, Tail, long_axis};
use crate::memory::Parameters;
use crate::units::Point;

/// The size of a run-out, and the X that limits it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leaving {
    /// Height of the run-out on the short axis and its length on the long one; radii along X.
    pub(crate) height: i64,
    pub(crate) length: i64,
    /// The start A of the cycle: the run-out leads towards it and not beyond.
    pub(crate) start: Exact,
}

impl Leaving {
    /// The cut from B to C with its run-out.
    pub(crate) fn cut(self, from: Exact, to: Exact, lead: f64) -> Cut {
        let long = long_axis(from, to);
        let short = long.other();
        let back = self.start.get(short) - to.get(short);
        let height = along(short, self.height).min(back.abs());
        let mut end = to;
        end.set(short, to.get(short) + back.signum() * height);
        let tail = (height != 0).then_some(Tail {
            length: self.length,
            end,
        });
        Cut {
            from,
            to,
            long,
            lead,
            increase: 0.0,
            tail,
        }
    }
}

/// A running G92.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ThreadCycle {
    /// A, B and D in machine coordinates.
    a: Point,
    b: Point,
    d: Point,
    thread: Option<Action>,
    #[serde(rename = "tail")]
    tail: Option<Action>,
    /// The programmed A and C, R, and the run-out, for the explanation.
    #[serde(rename = "words")]
    words: (Exact, Exact, i64, (i64, i64)),
    start: u32,
    starts: u32,
    step: u8,
}

/// Plans the cycle from the current position to the end point of `data` and back.
///
/// # Errors
/// 015 for the taper or a thread without length, 011 without a lead, 043 for a corner outside
/// the stroke.
pub(crate) fn plan(
    state: &State,
    parameters: &Parameters,
    data: CycleData,
    reach: Reach<'_>,
) -> Result<ThreadCycle, Alarm> {
    let (a, c) = (state.position, data.end);
    check_taper(data.r, (c.x - a.x) / 2, ("G92", "U/2"))?;
    if c.z == a.z {
        return Err(Alarm::new(number::CYCLE_TAPER).because(say::thread_without_length()));
    }
    let lead = thread::lead(state)?;
    let b = Exact::new(c.x + 2 * data.r, a.z);
    let d = Exact::new(a.x, c.z);
    for corner in [b, c, d] {
        within_stroke(corner, reach)?;
    }
    let width = run_out_width(parameters, lead);
    let height = data.j.map_or(width, i64::saturating_abs);
    let leaving = Leaving {
        height,
        length: data.k.map_or(height, i64::saturating_abs),
        start: a,
    };
    let shift = Shift::of(state);
    let (thread, tail) = leaving
        .cut(b, c, lead)
        .actions(shift, ThreadStart::AtIndex { degrees: 0.0 });
    // Move 3 is along X only, from the end of the run-out.
    let mut d = shift.machine(d);
    if let Some(Action::Thread { to, .. }) = tail.as_ref().or(thread.as_ref()) {
        d.z = to.z;
    }
    let cycle = ThreadCycle {
        a: shift.machine(a),
        b: shift.machine(b),
        d,
        thread,
        tail,
        words: (a, c, data.r, (leaving.height, leaving.length)),
        start: 0,
        starts: u32::try_from(data.starts).unwrap_or(1),
        step: 0,
    };
    Ok(cycle)
}

/// Width of the run-out by parameter 019 (tenths of the lead), units of [`Exact`].
pub(crate) fn run_out_width(parameters: &Parameters, lead: f64) -> i64 {
    to_units(f64::from(parameters.run_out_tenths()) * 0.1 * lead * PER_MM as f64)
}

impl ThreadCycle {
    /// Greatest travel of each axis per revolution in a cut, mm. The run-out counts if it is
    /// `tied` to the spindle.
    pub(crate) fn per_revolution(&self, tied: bool) -> Point {
        thread::per_revolution(
            self.b,
            [self.thread.as_ref(), self.tail.as_ref().filter(|_| tied)],
        )
    }

    /// `RunOut` or `Start` if the cuts have a run-out or several starts; `None` for straight
    /// passes.
    pub(crate) const fn beyond_pass(&self) -> Option<BeyondPass> {
        match (&self.tail, self.starts) {
            (Some(_), _) => Some(BeyondPass::RunOut),
            (None, 0 | 1) => None,
            (None, _) => Some(BeyondPass::Start),
        }
    }

    pub(crate) fn make(&mut self) -> Option<Move> {
        if self.start >= self.starts {
            return None;
        }
        let (a, c, taper, run_out) = self.words;
        let note = Note::Thread {
            start: self.start + 1,
            starts: self.starts,
            a,
            c,
            taper,
            run_out,
        };
        let degrees = phase(self.start, self.starts);
        let step = self.step;
        self.step += 1;
        match step {
            0 => Some(Move::rapid(self.b, note)),
            1 => Some(match (&self.thread, &self.tail) {
                (Some(thread), tail) => Move {
                    action: started(thread, degrees),
                    stops: tail.is_none(),
                    note,
                },
                (None, Some(tail)) => {
                    self.step += 1;
                    Move::of(started(tail, degrees), note)
                }
                (None, None) => return None,
            }),
            2 => match &self.tail {
                Some(tail) => Some(Move::of(*tail, note)),
                None => self.make(),
            },
            3 => Some(Move::rapid(self.d, note)),
            _ => {
                self.start += 1;
                self.step = 0;
                Some(Move::rapid(self.a, note))
            }
        }
    }
}

/// The same thread with another start angle, degrees.
pub(crate) fn started(thread: &Action, degrees: f64) -> Action {
    let mut action = *thread;
    if let Action::Thread { start, .. } = &mut action {
        *start = ThreadStart::AtIndex { degrees };
    }
    action
}
