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
use crate::command::{Action, ThreadPassFeature, ThreadStart};
use crate::interpreter::codes::positioning::check_stroke;
use crate::interpreter::context::BlockContext;
use crate::interpreter::exact::{ExactPoint, UNITS_PER_MM, round_to_units, to_mm};
use crate::interpreter::moves::explanation::{
    Explanation, PassNote, add_start_angle, depth_mm, formula_message,
};
use crate::interpreter::moves::{FrameShift, Move};
use crate::interpreter::state::State;
use crate::interpreter::threads::lead_word;
use crate::interpreter::threads::tapping::start_angle_degrees;
use crate::interpreter::threads::thread::{self, RunOut, ThreadCut, long_axis};
use crate::interpreter::words::{AxisWords, LeadUnit, SortedWords};
use crate::units::{Axis, Point};

/// Least increment of a depth, units of [`ExactPoint`].
const UNITS_PER_MICRON: i64 = UNITS_PER_MM / 1000;
/// Greatest number of starts of a thread.
const MAX_STARTS: i64 = 99;
const MAX_PASSES: i64 = 99;

/// The remaining moves of a G86 or G87. Lengths are in units of [`ExactPoint`], diameters
/// along X.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CountedThread {
    code: u8,
    shift: FrameShift,
    /// Start of the thread on its crest; `c` is the end on the crest.
    a: ExactPoint,
    c: ExactPoint,
    /// +1 for an outer thread, -1 for an inner thread.
    side: i64,
    depth: i64,
    /// I, the height of the run-out, without sign; `run_out_length` is J, the length.
    #[serde(rename = "out")]
    run_out_height: i64,
    #[serde(rename = "back")]
    run_out_length: i64,
    lead: f64,
    passes: i64,
    starts: u32,
    /// Number of the pass being cut, from 1.
    pass: i64,
    /// Index of the thread start being cut, from 0.
    start: u32,
    #[serde(rename = "leg")]
    next_leg: ThreadLeg,
}

/// The next move of a pass: infeed, thread, run-out or return.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum ThreadLeg {
    Infeed,
    Thread,
    Tail,
    Clear,
    Back,
    Home,
    Done,
}

/// Plans a G86 or G87 block. The cycle ends at the start of the tool.
///
/// # Errors
/// 062 for wrong data, 011 or 043 for the lead, 043 for a point outside the stroke.
pub(crate) fn plan_cycle(
    state: &State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    axes: &AxisWords,
    unit: LeadUnit,
) -> Result<CountedThread, Alarm> {
    let code = match unit {
        LeadUnit::Millimetres => 86,
        LeadUnit::PerInch => 87,
    };
    let lead = lead_word::read_lead(words, unit, code)?;
    let a = state.position;
    let check = |point| check_stroke(point, context.coordinate_range());
    let c = check(axes.resolve_end(a))?;
    if c.z == a.z {
        return Err(thread_alarm(code, say::cycle_end_at_start("Z")));
    }
    let depth = match words.r {
        Some(depth) if depth > 0 => depth,
        Some(depth) => {
            let rule = say::cycle_depth_not_positive("R", to_mm(depth));
            return Err(thread_alarm(code, rule));
        }
        None => return Err(thread_alarm(code, say::cycle_peck_missing("R"))),
    };
    let (run_out_height, run_out_length) =
        (words.i.unwrap_or(0), words.j.unwrap_or(0).saturating_abs());
    if run_out_height == 0 && run_out_length != 0 {
        return Err(thread_alarm(code, say::thread_leaves_without_height()));
    }
    let read_count = |name: &str, value: i64, most: i64| match (1..=most).contains(&value) {
        true => Ok(value),
        false => Err(thread_alarm(
            code,
            say::thread_count_out_of_range(name, value, most),
        )),
    };
    let passes = read_count("L", words.l.unwrap_or(1), MAX_PASSES)?;
    let starts = read_count("N", words.n.unwrap_or(1).into(), MAX_STARTS)?;
    let cycle = CountedThread {
        code,
        shift: FrameShift::from_state(state),
        a,
        c,
        side: if run_out_height < 0 { -1 } else { 1 },
        depth,
        run_out_height: run_out_height.saturating_abs(),
        run_out_length,
        lead,
        passes,
        starts: u32::try_from(starts).unwrap_or(1),
        pass: 1,
        start: 0,
        next_leg: ThreadLeg::Infeed,
    };
    for pass in [1, passes] {
        let (begin, end) = cycle.pass_ends(pass);
        for point in [begin, end, cycle.run_out_end(pass), cycle.clear_point(pass)] {
            check(point)?;
        }
    }
    Ok(cycle)
}

impl CountedThread {
    /// Depth of the pass with the number `pass`: `R·√(p/L)`, a difference of diameters,
    /// rounded to the least increment.
    fn pass_depth(&self, pass: i64) -> i64 {
        if pass >= self.passes {
            return self.depth;
        }
        let share = (pass as f64 / self.passes as f64).sqrt();
        round_to_units(self.depth as f64 * share / UNITS_PER_MICRON as f64) * UNITS_PER_MICRON
    }

    /// Start and end of the cut of the pass with the number `pass`, without the run-out.
    fn pass_ends(&self, pass: i64) -> (ExactPoint, ExactPoint) {
        let into = self.side.saturating_mul(self.pass_depth(pass));
        let below_crest =
            |crest: ExactPoint| ExactPoint::new(crest.x.saturating_sub(into), crest.z);
        (below_crest(self.a), below_crest(self.c))
    }

    /// The point where the run-out of the pass with the number `pass` ends.
    fn run_out_end(&self, pass: i64) -> ExactPoint {
        let (_, end) = self.pass_ends(pass);
        ExactPoint::new(
            end.x
                .saturating_add(self.side.saturating_mul(self.run_out_height)),
            end.z,
        )
    }

    /// The point from which the tool moves back along Z (E): after the run-out, clear of the
    /// crest.
    fn clear_point(&self, pass: i64) -> ExactPoint {
        let outward = |x: i64| self.side.saturating_mul(x);
        let left = self.run_out_end(pass);
        let x = outward(left.x)
            .max(outward(self.a.x))
            .max(outward(self.c.x));
        ExactPoint::new(outward(x), left.z)
    }

    /// The cut of a pass and its run-out; `None` for a part that the pass does not have.
    fn pass_actions(&self, pass: i64) -> (Option<Action>, Option<Action>) {
        let (from, to) = self.pass_ends(pass);
        let run_out = (self.run_out_length != 0).then(|| RunOut {
            length: self.run_out_length,
            end: self.run_out_end(pass),
        });
        let cut = ThreadCut {
            from,
            to,
            long_axis: long_axis(from, to),
            lead: self.lead,
            increase: 0.0,
            run_out,
        };
        let degrees = start_angle_degrees(self.start, self.starts);
        cut.to_actions(self.shift, ThreadStart::AtIndex { degrees })
    }

    /// Greatest travel of each axis per spindle revolution in a cut, mm, X as a radius. The
    /// run-out is included if the spindle drives it (`is_run_out_tied`).
    pub(crate) fn travel_per_revolution(&self, is_run_out_tied: bool) -> Point {
        let (begin, _) = self.pass_ends(self.pass);
        let (cut, run_out) = self.pass_actions(self.pass);
        let from = self.shift.to_machine(begin);
        thread::travel_per_revolution(
            from,
            [cut.as_ref(), run_out.as_ref().filter(|_| is_run_out_tied)],
        )
    }

    /// `RunOut` if the cuts end in a run-out, else `StartAngle` if the thread has several
    /// starts; `None` for straight passes.
    pub(crate) const fn beyond_pass(&self) -> Option<ThreadPassFeature> {
        match (self.run_out_length, self.starts) {
            (0, 0 | 1) => None,
            (0, _) => Some(ThreadPassFeature::StartAngle),
            _ => Some(ThreadPassFeature::RunOut),
        }
    }

    pub(crate) fn next_move(&mut self) -> Option<Move> {
        let pass = self.pass;
        let note = PassNote::CountedThread {
            code: self.code,
            pass,
            passes: self.passes,
            start: self.start,
            starts: self.starts,
            crest: self.a.x,
            depth: self.pass_depth(pass),
            whole: self.depth,
        };
        let rapid = |to| Some(Move::rapid(self.shift.to_machine(to), note));
        let (next_move, next) = match self.next_leg {
            ThreadLeg::Infeed => (rapid(self.pass_ends(pass).0), ThreadLeg::Thread),
            ThreadLeg::Thread => {
                let (cut, tail) = self.pass_actions(pass);
                let next = match tail.is_some() && cut.is_some() {
                    true => ThreadLeg::Tail,
                    false => ThreadLeg::Clear,
                };
                let made = cut.or(tail).map(|action| Move {
                    action,
                    stops: next == ThreadLeg::Clear,
                    note,
                });
                (made, next)
            }
            ThreadLeg::Tail => {
                let tail = self.pass_actions(pass).1;
                (
                    tail.map(|action| Move::from_action(action, note)),
                    ThreadLeg::Clear,
                )
            }
            ThreadLeg::Clear => (rapid(self.clear_point(pass)), ThreadLeg::Back),
            ThreadLeg::Back => {
                let at = self.clear_point(pass);
                (
                    rapid(ExactPoint::new(at.x, self.a.z)),
                    self.leg_after_return(),
                )
            }
            ThreadLeg::Home => (rapid(self.a), ThreadLeg::Done),
            ThreadLeg::Done => (None, ThreadLeg::Done),
        };
        if self.next_leg == ThreadLeg::Back && next == ThreadLeg::Infeed {
            self.start += 1;
            if self.start >= self.starts {
                self.start = 0;
                self.pass += 1;
            }
        }
        self.next_leg = next;
        next_move
    }

    /// The move after the return along Z: the infeed of the next pass, or the last move to the
    /// start of the cycle.
    const fn leg_after_return(&self) -> ThreadLeg {
        match self.pass >= self.passes && self.start + 1 >= self.starts {
            true => ThreadLeg::Home,
            false => ThreadLeg::Infeed,
        }
    }
}

fn thread_alarm(code: u8, detail: Message) -> Alarm {
    let detail = say::dialect_decided(say::cycle_in_code(code, detail));
    Alarm::new(number::CYCLE_DATA).with_detail(detail)
}

/// Explains a pass of G86 or G87; `None` for the note of another cycle.
pub(crate) fn explain_counted_pass(note: PassNote) -> Option<Explanation> {
    let PassNote::CountedThread {
        code,
        pass,
        passes,
        start,
        starts,
        crest,
        depth,
        whole,
    } = note
    else {
        return None;
    };
    let formula = formula_message(format!(
        "d{pass} = {:.3}·√({pass}/{passes}) = {:.3}",
        to_mm(whole),
        to_mm(depth)
    ));
    Some(Explanation {
        code,
        pass: pass.unsigned_abs(),
        passes: Some(passes.unsigned_abs()),
        level: Some(to_mm(crest)),
        depth: depth_mm(Axis::X, depth),
        remaining: depth_mm(Axis::X, whole - depth),
        formula: add_start_angle(formula, start + 1, starts),
        words: "R, L, N, K, I, J",
    })
}
