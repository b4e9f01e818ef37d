//! G32 and G34: threads (manual I-3.2.4.1, I-3.2.4.2), and the cut of all thread codes.
//!
//! ```text
//!   X ^        run-out
//!     |       E                    J  movement of the short axis, a radius if
//!     |        \                      it is X
//!     |   end   \_________ start   K  where it begins, before the end along the
//!     |    :<-K->                     long axis; left out: as long as J
//!     +---------------------> Z    lead: of the long axis, a revolution
//! ```

use gsk_messages::{Message, say};

use crate::alarm::{Alarm, number};
use crate::command::{Action, ThreadStart};
use crate::interpreter::codes::positioning::within_stroke;
use crate::interpreter::context::exact::{Exact, PER_MM, Reach, along, mm, scaled};
use crate::interpreter::context::moves::{Shift, Two};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{AxisWords, OneShot, Words};
use crate::units::{Axis, Point};

/// Leads of threads, mm per revolution.
pub(super) const LEADS: core::ops::RangeInclusive<f64> = 0.001..=500.0;
/// Threads per inch, in millionths.
pub(super) const PER_INCH: core::ops::RangeInclusive<i64> = 60_000..=25_400 * PER_MM;
/// Change of the lead per revolution, in millionths of a millimetre.
const CHANGES: core::ops::RangeInclusive<i64> = 1_000..=500 * PER_MM;
pub(super) const MM_PER_INCH: f64 = 25.4;

/// Whether F and I of a block set a thread lead.
pub(crate) fn takes_lead(words: &Words, motion: u8) -> bool {
    match words.one_shot {
        Some(OneShot::CompoundThread) => true,
        Some(_) => false,
        None => matches!(motion, 32..=34 | 92),
    }
}

/// Sets the lead of a block: F in mm, or I in threads per inch. Both share one register,
/// separate from the feed.
///
/// # Errors
/// 043 for a lead out of range.
pub(crate) fn take_lead(state: &mut State, words: &Words) -> Result<(), Alarm> {
    if let Some(lead) = words.f {
        if !LEADS.contains(&lead) {
            return Err(out_of_range(say::thread_lead_out_of_range(lead)));
        }
        state.lead = lead;
    } else if let Some(threads) = words.i {
        if !PER_INCH.contains(&threads) {
            return Err(out_of_range(say::threads_per_inch_out_of_range(mm(
                threads,
            ))));
        }
        state.lead = MM_PER_INCH / mm(threads);
    }
    Ok(())
}

/// The lead in force, mm per revolution.
///
/// # Errors
/// 011 if it is unset.
pub(crate) fn lead(state: &State) -> Result<f64, Alarm> {
    if state.lead > 0.0 {
        return Ok(state.lead);
    }
    Err(Alarm::new(number::NO_FEED).because(say::thread_lead_missing()))
}

/// The axis to which the lead applies: that of the greater displacement, X as a radius.
pub(crate) const fn long_axis(from: Exact, to: Exact) -> Axis {
    let (x, z) = (to.x.abs_diff(from.x), to.z.abs_diff(from.z));
    if x >= z.saturating_mul(2) {
        Axis::X
    } else {
        Axis::Z
    }
}

/// A thread from one point to another, with or without a run-out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cut {
    pub(crate) from: Exact,
    pub(crate) to: Exact,
    pub(crate) long: Axis,
    pub(crate) lead: f64,
    /// Change of the lead, mm per revolution and revolution.
    pub(crate) increase: f64,
    pub(crate) tail: Option<Tail>,
}

/// The run-out of a thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tail {
    /// Distance between its begin and the end of the thread, along the long axis (a radius for
    /// X).
    pub(crate) length: i64,
    /// The point where it ends.
    pub(crate) end: Exact,
}

impl Cut {
    /// The actions of the thread and of its run-out. The first is `None` if the run-out takes
    /// up the whole thread.
    pub(crate) fn actions(
        &self,
        shift: Shift,
        start: ThreadStart,
    ) -> (Option<Action>, Option<Action>) {
        let Some(tail) = self.tail else {
            return (Some(self.action(shift, self.to, self.lead, start)), None);
        };
        let whole = self.to.get(self.long) - self.from.get(self.long);
        let cut = (whole.abs() - along(self.long, tail.length)).max(0);
        let way = self.to - self.from;
        let leaves = self.from
            + Exact::new(
                scaled(way.x, cut, whole.abs()),
                scaled(way.z, cut, whole.abs()),
            );
        let run_out = |start, lead| Action::Thread {
            to: shift.machine(tail.end),
            long: self.long,
            lead,
            increase: self.increase,
            start,
            run_out: true,
        };
        if cut == 0 {
            return (None, Some(run_out(start, self.lead)));
        }
        let length = self.length(cut);
        let lead_there = lead_after(self.lead, self.increase, length);
        (
            Some(self.action(shift, leaves, self.lead, start)),
            Some(run_out(ThreadStart::Continued, lead_there)),
        )
    }

    pub(super) fn action(&self, shift: Shift, to: Exact, lead: f64, start: ThreadStart) -> Action {
        Action::Thread {
            to: shift.machine(to),
            long: self.long,
            lead,
            increase: self.increase,
            start,
            run_out: false,
        }
    }

    /// A distance on the long axis in mm, X as a radius.
    fn length(&self, units: i64) -> f64 {
        let length = mm(units);
        match self.long {
            Axis::X => length / 2.0,
            Axis::Z => length,
        }
    }
}

/// The lead after a travel: `lead(n) = F + R·n` after n revolutions, in which the long axis
/// travels `F·n + R·n²/2`. NaN if it would fall below zero.
fn lead_after(lead: f64, increase: f64, travel: f64) -> f64 {
    if increase == 0.0 {
        return lead;
    }
    (lead * lead + 2.0 * increase * travel).sqrt()
}

/// Greatest travel of each axis per revolution, mm, in cuts that begin at `from`.
pub(crate) fn per_revolution(from: Point, cuts: [Option<&Action>; 2]) -> Point {
    let (mut at, mut fastest) = (from, Point::default());
    for cut in cuts.into_iter().flatten() {
        let Action::Thread { to, long, lead, .. } = cut else {
            continue;
        };
        let way = *to - at;
        let turns = (way.get(*long) / lead).abs();
        if turns > 0.0 {
            fastest.x = fastest.x.max(way.x.abs() / turns);
            fastest.z = fastest.z.max(way.z.abs() / turns);
        }
        at = *to;
    }
    fastest
}

/// Plans a G32 or G34 block and sets `state.position` to its end.
///
/// # Errors
/// 011 without a lead, 013 with R in G32, 043 for a lead or an end out of range.
pub(crate) fn plan(
    state: &mut State,
    words: &Words,
    axes: &AxisWords,
    reach: Reach<'_>,
) -> Result<Two, Alarm> {
    let variable = state.modal.motion == 34;
    if words.r.is_some() && !variable {
        return Err(Alarm::new(number::ARC_DATA).because(say::thread_with_corner_arc()));
    }
    let (from, to) = (
        state.position,
        within_stroke(axes.target(state.position), reach)?,
    );
    let lead = lead(state)?;
    if from == to {
        return Ok(Two::default());
    }
    let long = long_axis(from, to);
    let mut cut = Cut {
        from,
        to,
        long,
        lead,
        increase: 0.0,
        tail: None,
    };
    if variable {
        cut.increase = change(words.r)?;
        let end = lead_after(
            lead,
            cut.increase,
            cut.length((to.get(long) - from.get(long)).abs()),
        );
        if !LEADS.contains(&end) {
            return Err(out_of_range(say::thread_lead_leaves_range(
                lead,
                cut.increase,
            )));
        }
    }
    let mut end = to;
    if let Some(height) = words.j.filter(|&height| height != 0) {
        let short = long.other();
        end.set(short, to.get(short).saturating_add(along(short, height)));
        cut.tail = Some(Tail {
            length: words.k.unwrap_or(height).saturating_abs(),
            end: within_stroke(end, reach)?,
        });
    }
    let start = if state.threading && !words.waits() {
        ThreadStart::Continued
    } else {
        ThreadStart::AtIndex { degrees: 0.0 }
    };
    let (first, second) = cut.actions(Shift::of(state), start);
    let motion = Two { first, second };
    state.arrive(axes, end);
    state.ahead = state.ahead + to - end;
    Ok(motion)
}

/// R of G34, the change of the lead.
fn change(r: Option<i64>) -> Result<f64, Alarm> {
    let Some(r) = r else {
        return Ok(0.0);
    };
    if !CHANGES.contains(&r.abs()) {
        return Err(out_of_range(say::thread_lead_change_out_of_range(mm(r))));
    }
    Ok(mm(r))
}

fn out_of_range(detail: Message) -> Alarm {
    Alarm::new(number::OUT_OF_RANGE).because(detail)
}
