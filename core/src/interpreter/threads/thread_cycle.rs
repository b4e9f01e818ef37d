//! G92: thread cycle (manual I-3.2.4.4).
//!
//! ```text
//!   X ^    D <-----------4------------ A       1 rapid X to B
//!     |    ^                           |       2 thread B -> C, leaving it K
//!     |    3                           1         before the end by the height J
//!     |    |\                          v       3 rapid X to the start
//!     |    C \___________2____________ B       4 rapid Z to A
//!     +---------------------------------> Z    L starts: all again, 360°/L on
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

/// Greatest X of a run-out, and where the tool goes after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leaving {
    /// Height of the run-out on the short axis and its length on the long one;
    /// radii along X.
    pub(crate) height: i64,
    pub(crate) length: i64,
    /// The start A of the cycle: the tail goes towards it and not beyond.
    pub(crate) start: Exact,
}

impl Leaving {
    /// The cut from B to C with its tail.
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

/// The threads of one G92 block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ThreadCycle {
    /// A, B and D in machine coordinates.
    a: Point,
    b: Point,
    d: Point,
    thread: Option<Action>,
    tail: Option<Action>,
    /// The programmed A and C, R, and the run-out, as they are explained.
    words: (Exact, Exact, i64, (i64, i64)),
    start: u32,
    starts: u32,
    step: u8,
}

/// The cycle from the programmed position to the data's end point and back.
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
    // Move 3 goes along X alone, from where the tool has left the thread.
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

/// The run-out by parameter 019, in units of [`Exact`]: tenths of the lead.
pub(crate) fn run_out_width(parameters: &Parameters, lead: f64) -> i64 {
    to_units(f64::from(parameters.run_out_tenths()) * 0.1 * lead * PER_MM as f64)
}

impl ThreadCycle {
    /// How far each axis goes a revolution in its cuts, mm.
    pub(crate) fn per_revolution(&self, tied: bool) -> Point {
        thread::per_revolution(
            self.b,
            [self.thread.as_ref(), self.tail.as_ref().filter(|_| tied)],
        )
    }

    /// What makes its cuts more than one straight pass.
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

/// The same thread begun at another angle.
pub(crate) fn started(thread: &Action, degrees: f64) -> Action {
    let mut action = *thread;
    if let Action::Thread { start, .. } = &mut action {
        *start = ThreadStart::AtIndex { degrees };
    }
    action
}
