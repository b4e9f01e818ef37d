//! G86 and G87 of the Huaxing lathes: a thread in L passes.
//!
//! ```text
//!   X ^   E <--------4--------- (E)     A is on the crest of the thread, and so is the
//!     |   ^                      : 5    end X, Z. 1 rapid to the depth of pass p,
//!     |   3\                     v         d_p = R·√(p/L), a difference of diameters
//!     |     \                    A      2 thread, run-out over J by I
//!     |      \________2_________ :1     3 rapid X to E, clear of the crest
//!     |        :<J>              B_p    4 rapid Z, 5 to the next pass or to A
//!     +--------------------------> Z    N starts for each depth, 360°/N apart
//! ```
//!
//! A negative I leaves the thread towards the axis, as on an inner thread.

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::command::{Action, BeyondPass, ThreadStart};
use crate::interpreter::codes::positioning::within_stroke;
use crate::interpreter::context::Context;
use crate::interpreter::context::exact::{Exact, PER_MM, mm, to_units};
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::moves::{Move, Shift};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{AxisWords, LeadUnit, Words};
use crate::interpreter::threads::lead_word;
use crate::interpreter::threads::tapping::phase;
use crate::interpreter::threads::thread::{self, Cut, Tail, long_axis};
use crate::units::Point;

/// Least increment of a depth, units of [`Exact`].
const PER_MICRON: i64 = PER_MM / 1000;
/// Greatest number of starts, and of passes.
const MOST_STARTS: i64 = 99;
const MOST_PASSES: i64 = 99;

/// A running G86 or G87. Lengths are in units of [`Exact`], diameters along X.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CountedThread {
    code: u8,
    shift: Shift,
    /// Start and end on the crest.
    a: Exact,
    c: Exact,
    /// +1 for an outer thread, -1 for an inner one.
    side: i64,
    depth: i64,
    /// I and J, without signs.
    #[serde(rename = "out")]
    out: i64,
    #[serde(rename = "back")]
    back: i64,
    lead: f64,
    passes: i64,
    starts: u32,
    /// Number of the current pass, from 1.
    pass: i64,
    /// The current thread start, from 0.
    start: u32,
    #[serde(rename = "leg")]
    leg: Leg,
}

/// The next move of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Leg {
    Infeed,
    Thread,
    Tail,
    Clear,
    Back,
    Home,
    Done,
}

/// Plans a G86 or G87 block. The tool ends at its start.
///
/// # Errors
/// 062 for wrong data, 011 or 043 for the lead, 043 for a point outside the stroke.
pub(crate) fn plan(
    state: &State,
    context: &Context<'_>,
    words: &Words,
    axes: &AxisWords,
    unit: LeadUnit,
) -> Result<CountedThread, Alarm> {
    let code = match unit {
        LeadUnit::Millimetres => 86,
        LeadUnit::PerInch => 87,
    };
    let lead = lead_word::lead(words, unit, code)?;
    let a = state.position;
    let reach = |point| within_stroke(point, context.reach());
    let c = reach(axes.target(a))?;
    if c.z == a.z {
        return Err(fault(code, say::cycle_end_at_start("Z")));
    }
    let depth = match words.r {
        Some(depth) if depth > 0 => depth,
        Some(depth) => {
            let rule = say::cycle_depth_not_positive("R", mm(depth));
            return Err(fault(code, rule));
        }
        None => return Err(fault(code, say::cycle_peck_missing("R"))),
    };
    let (out, back) = (words.i.unwrap_or(0), words.j.unwrap_or(0).saturating_abs());
    if out == 0 && back != 0 {
        return Err(fault(code, say::thread_leaves_without_height()));
    }
    let count = |name: &str, value: i64, most: i64| match (1..=most).contains(&value) {
        true => Ok(value),
        false => Err(fault(
            code,
            say::thread_count_out_of_range(name, value, most),
        )),
    };
    let passes = count("L", words.l.unwrap_or(1), MOST_PASSES)?;
    let starts = count("N", words.n.unwrap_or(1).into(), MOST_STARTS)?;
    let cycle = CountedThread {
        code,
        shift: Shift::of(state),
        a,
        c,
        side: if out < 0 { -1 } else { 1 },
        depth,
        out: out.saturating_abs(),
        back,
        lead,
        passes,
        starts: u32::try_from(starts).unwrap_or(1),
        pass: 1,
        start: 0,
        leg: Leg::Infeed,
    };
    for pass in [1, passes] {
        let (begin, end) = cycle.ends(pass);
        for point in [begin, end, cycle.left(pass), cycle.clear(pass)] {
            reach(point)?;
        }
    }
    Ok(cycle)
}

impl CountedThread {
    /// Depth of a pass: `R·√(p/L)`, rounded to the least increment.
    fn depth_of(&self, pass: i64) -> i64 {
        if pass >= self.passes {
            return self.depth;
        }
        let part = (pass as f64 / self.passes as f64).sqrt();
        to_units(self.depth as f64 * part / PER_MICRON as f64) * PER_MICRON
    }

    /// Start and end of the cut of a pass.
    fn ends(&self, pass: i64) -> (Exact, Exact) {
        let into = self.side.saturating_mul(self.depth_of(pass));
        let at = |crest: Exact| Exact::new(crest.x.saturating_sub(into), crest.z);
        (at(self.a), at(self.c))
    }

    /// The point where the run-out of a pass ends.
    fn left(&self, pass: i64) -> Exact {
        let (_, end) = self.ends(pass);
        Exact::new(
            end.x.saturating_add(self.side.saturating_mul(self.out)),
            end.z,
        )
    }

    /// E: the end of the run-out, clear of the crest for the move back.
    fn clear(&self, pass: i64) -> Exact {
        let outward = |x: i64| self.side.saturating_mul(x);
        let left = self.left(pass);
        let x = outward(left.x)
            .max(outward(self.a.x))
            .max(outward(self.c.x));
        Exact::new(outward(x), left.z)
    }

    /// The cut of a pass and its run-out.
    fn thread(&self, pass: i64) -> (Option<Action>, Option<Action>) {
        let (from, to) = self.ends(pass);
        let tail = (self.back != 0).then(|| Tail {
            length: self.back,
            end: self.left(pass),
        });
        let cut = Cut {
            from,
            to,
            long: long_axis(from, to),
            lead: self.lead,
            increase: 0.0,
            tail,
        };
        let degrees = phase(self.start, self.starts);
        cut.actions(self.shift, ThreadStart::AtIndex { degrees })
    }

    /// Greatest travel of each axis per revolution in a cut, mm. The run-out counts if it is
    /// `tied` to the spindle.
    pub(crate) fn per_revolution(&self, tied: bool) -> Point {
        let (begin, _) = self.ends(self.pass);
        let (cut, tail) = self.thread(self.pass);
        let from = self.shift.machine(begin);
        thread::per_revolution(from, [cut.as_ref(), tail.as_ref().filter(|_| tied)])
    }

    /// `RunOut` or `Start` if the cuts have a run-out or several starts; `None` for straight
    /// passes.
    pub(crate) const fn beyond_pass(&self) -> Option<BeyondPass> {
        match (self.back, self.starts) {
            (0, 0 | 1) => None,
            (0, _) => Some(BeyondPass::Start),
            _ => Some(BeyondPass::RunOut),
        }
    }

    pub(crate) fn make(&mut self) -> Option<Move> {
        let pass = self.pass;
        let note = Note::CountedThread {
            code: self.code,
            pass,
            passes: self.passes,
            start: self.start,
            starts: self.starts,
            crest: self.a.x,
            depth: self.depth_of(pass),
            whole: self.depth,
        };
        let rapid = |to| Some(Move::rapid(self.shift.machine(to), note));
        let (made, next) = match self.leg {
            Leg::Infeed => (rapid(self.ends(pass).0), Leg::Thread),
            Leg::Thread => {
                let (cut, tail) = self.thread(pass);
                let next = match tail.is_some() && cut.is_some() {
                    true => Leg::Tail,
                    false => Leg::Clear,
                };
                let made = cut.or(tail).map(|action| Move {
                    action,
                    stops: next == Leg::Clear,
                    note,
                });
                (made, next)
            }
            Leg::Tail => {
                let tail = self.thread(pass).1;
                (tail.map(|action| Move::of(action, note)), Leg::Clear)
            }
            Leg::Clear => (rapid(self.clear(pass)), Leg::Back),
            Leg::Back => {
                let at = self.clear(pass);
                (rapid(Exact::new(at.x, self.a.z)), self.turn())
            }
            Leg::Home => (rapid(self.a), Leg::Done),
            Leg::Done => (None, Leg::Done),
        };
        if self.leg == Leg::Back && next == Leg::Infeed {
            self.start += 1;
            if self.start >= self.starts {
                self.start = 0;
                self.pass += 1;
            }
        }
        self.leg = next;
        made
    }

    /// The move after a return along Z.
    const fn turn(&self) -> Leg {
        match self.pass >= self.passes && self.start + 1 >= self.starts {
            true => Leg::Home,
            false => Leg::Infeed,
        }
    }
}

fn fault(code: u8, detail: Message) -> Alarm {
    let detail = say::dialect_decided(say::cycle_in_code(code, detail));
    Alarm::new(number::CYCLE_DATA).because(detail)
}
