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
use crate::command::{Action, MotionCode, ThreadStart};
use crate::interpreter::codes::positioning::check_stroke;
use crate::interpreter::exact::{
    CoordinateRange, ExactPoint, UNITS_PER_MM, length_on_axis, scale_rounded, to_mm,
};
use crate::interpreter::moves::{FrameShift, MovePair};
use crate::interpreter::state::State;
use crate::interpreter::words::{AxisWords, OneShot, SortedWords};
use crate::units::{Axis, Point};

/// Permitted leads of threads, mm per revolution.
pub(super) const LEAD_RANGE_MM: core::ops::RangeInclusive<f64> = 0.001..=500.0;
/// Allowed numbers of threads per inch, in millionths.
pub(super) const PER_INCH_RANGE: core::ops::RangeInclusive<i64> = 60_000..=25_400 * UNITS_PER_MM;
/// Allowed changes of the lead per revolution (R of G34, without sign), in millionths of a
/// millimetre.
const LEAD_CHANGE_RANGE: core::ops::RangeInclusive<i64> = 1_000..=500 * UNITS_PER_MM;
/// The same in a block whose lead is I, threads per inch (decision THREAD-11).
const LEAD_CHANGE_RANGE_PER_INCH: core::ops::RangeInclusive<i64> = PER_INCH_RANGE;
pub(super) const MM_PER_INCH: f64 = 25.4;

/// Whether F and I of a block set a thread lead. `motion` is the code of group 01 in force.
pub(crate) fn is_lead_block(words: &SortedWords, motion: MotionCode) -> bool {
    match words.one_shot {
        Some(OneShot::CompoundThread) => true,
        Some(_) => false,
        None => motion.is_thread(),
    }
}

/// Stores the lead of a block in the state: F in mm per revolution, or I in threads per inch.
/// Both share one register, separate from the feed.
///
/// # Errors
/// 043 for a lead out of range.
pub(crate) fn store_lead(state: &mut State, words: &SortedWords) -> Result<(), Alarm> {
    if let Some(lead) = words.f {
        if !LEAD_RANGE_MM.contains(&lead) {
            return Err(out_of_range_alarm(say::thread_lead_out_of_range(lead)));
        }
        state.lead = lead;
    } else if let Some(threads) = words.i {
        if !PER_INCH_RANGE.contains(&threads) {
            return Err(out_of_range_alarm(say::threads_per_inch_out_of_range(
                to_mm(threads),
            )));
        }
        state.lead = MM_PER_INCH / to_mm(threads);
    }
    Ok(())
}

/// The lead in force, mm per revolution.
///
/// # Errors
/// 011 if no lead is set.
pub(crate) fn current_lead(state: &State) -> Result<f64, Alarm> {
    if state.lead > 0.0 {
        return Ok(state.lead);
    }
    Err(Alarm::new(number::NO_FEED).with_detail(say::thread_lead_missing()))
}

/// Returns the axis to which the lead of a thread applies: the one with the greater displacement,
/// where X counts as a radius.
pub(crate) const fn long_axis(from: ExactPoint, to: ExactPoint) -> Axis {
    let (x, z) = (to.x.abs_diff(from.x), to.z.abs_diff(from.z));
    if x >= z.saturating_mul(2) {
        Axis::X
    } else {
        Axis::Z
    }
}

/// A thread from one point to another, with or without a run-out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ThreadCut {
    pub(crate) from: ExactPoint,
    pub(crate) to: ExactPoint,
    pub(crate) long_axis: Axis,
    pub(crate) lead: f64,
    /// Change of the lead (mm per revolution) with each revolution, mm.
    pub(crate) increase: f64,
    pub(crate) run_out: Option<RunOut>,
}

/// The run-out of a thread: the move that leaves the thread before its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RunOut {
    /// Distance from the start of the run-out to the end of the thread along the long axis, in
    /// units of [`ExactPoint`]; a radius for X.
    pub(crate) length: i64,
    /// The point at which the run-out ends.
    pub(crate) end: ExactPoint,
}

impl ThreadCut {
    /// The actions of the thread and of its run-out. The first is `None` if the run-out is as
    /// long as the whole thread, the second if there is no run-out.
    pub(crate) fn to_actions(
        self,
        shift: FrameShift,
        start: ThreadStart,
    ) -> (Option<Action>, Option<Action>) {
        let Some(run_out) = self.run_out else {
            return (
                Some(self.thread_action(shift, self.to, self.lead, start)),
                None,
            );
        };
        let total = self.to.get(self.long_axis) - self.from.get(self.long_axis);
        let cut_length = (total.abs() - length_on_axis(self.long_axis, run_out.length)).max(0);
        let displacement = self.to - self.from;
        let run_out_start = self.from
            + ExactPoint::new(
                scale_rounded(displacement.x, cut_length, total.abs()),
                scale_rounded(displacement.z, cut_length, total.abs()),
            );
        let run_out_action = |start, lead| Action::Thread {
            to: shift.to_machine(run_out.end),
            lead_axis: self.long_axis,
            lead,
            increase: self.increase,
            start,
            run_out: true,
        };
        if cut_length == 0 {
            return (None, Some(run_out_action(start, self.lead)));
        }
        let length = self.length_mm(cut_length);
        let run_out_lead = lead_after(self.lead, self.increase, length);
        (
            Some(self.thread_action(shift, run_out_start, self.lead, start)),
            Some(run_out_action(ThreadStart::Continued, run_out_lead)),
        )
    }

    pub(super) fn thread_action(
        &self,
        shift: FrameShift,
        to: ExactPoint,
        lead: f64,
        start: ThreadStart,
    ) -> Action {
        Action::Thread {
            to: shift.to_machine(to),
            lead_axis: self.long_axis,
            lead,
            increase: self.increase,
            start,
            run_out: false,
        }
    }

    /// Converts a distance on the long axis to mm, X as a radius.
    fn length_mm(&self, units: i64) -> f64 {
        let length = to_mm(units);
        match self.long_axis {
            Axis::X => length / 2.0,
            Axis::Z => length,
        }
    }
}

/// The lead after the long axis has travelled `travel` mm: `lead(n) = F + R·n` after n
/// revolutions, in which the axis travels `F·n + R·n²/2`. NaN if the lead would fall below
/// zero.
fn lead_after(lead: f64, increase: f64, travel: f64) -> f64 {
    if increase == 0.0 {
        return lead;
    }
    (lead * lead + 2.0 * increase * travel).sqrt()
}

/// Greatest travel of each axis per spindle revolution, mm, X as a radius, in a thread and its
/// run-out that begin at `from`.
pub(crate) fn travel_per_revolution(from: Point, cuts: [Option<&Action>; 2]) -> Point {
    let (mut at, mut fastest) = (from, Point::default());
    for cut in cuts.into_iter().flatten() {
        let Action::Thread {
            to,
            lead_axis: long,
            lead,
            ..
        } = cut
        else {
            continue;
        };
        let displacement = *to - at;
        let revolutions = (displacement.get(*long) / lead).abs();
        if revolutions > 0.0 {
            fastest.x = fastest.x.max(displacement.x.abs() / revolutions);
            fastest.z = fastest.z.max(displacement.z.abs() / revolutions);
        }
        at = *to;
    }
    fastest
}

/// Plans a G32 or G34 block and sets `state.position` to its end.
///
/// # Errors
/// 011 without a lead, 013 with R in G32, 043 for a lead or an end out of range.
pub(crate) fn plan_thread(
    state: &mut State,
    words: &SortedWords,
    axes: &AxisWords,
    range: CoordinateRange<'_>,
) -> Result<MovePair, Alarm> {
    let is_variable_lead = state.modal.motion == MotionCode::VariableThread;
    if words.r.is_some() && !is_variable_lead {
        return Err(Alarm::new(number::ARC_DATA).with_detail(say::thread_with_corner_arc()));
    }
    let (from, to) = (
        state.position,
        check_stroke(axes.resolve_end(state.position), range)?,
    );
    let lead = current_lead(state)?;
    if from == to {
        return Ok(MovePair::default());
    }
    let long = long_axis(from, to);
    let mut cut = ThreadCut {
        from,
        to,
        long_axis: long,
        lead,
        increase: 0.0,
        run_out: None,
    };
    if is_variable_lead {
        cut.increase = read_lead_change(words)?;
        let end = lead_after(
            lead,
            cut.increase,
            cut.length_mm((to.get(long) - from.get(long)).abs()),
        );
        if !LEAD_RANGE_MM.contains(&end) {
            return Err(out_of_range_alarm(say::thread_lead_leaves_range(
                lead,
                cut.increase,
            )));
        }
    }
    let mut end = to;
    if let Some(height) = words.j.filter(|&height| height != 0) {
        let short = long.other();
        end.set(
            short,
            to.get(short).saturating_add(length_on_axis(short, height)),
        );
        cut.run_out = Some(RunOut {
            length: words.k.unwrap_or(height).saturating_abs(),
            end: check_stroke(end, range)?,
        });
    }
    let start = if state.is_threading && !words.needs_standstill() {
        ThreadStart::Continued
    } else {
        ThreadStart::AtIndex { degrees: 0.0 }
    };
    let (first, second) = cut.to_actions(FrameShift::from_state(state), start);
    let motion = MovePair { first, second };
    state.move_to(axes, end);
    state.increment_offset = state.increment_offset + to - end;
    Ok(motion)
}

/// Reads R of G34, the change of the lead per revolution, mm; 0 if missing. Returns an alarm as
/// error if it is out of range.
fn read_lead_change(words: &SortedWords) -> Result<f64, Alarm> {
    let Some(r) = words.r else {
        return Ok(0.0);
    };
    let is_per_inch = words.f.is_none() && words.i.is_some();
    let (range, rule) = if is_per_inch {
        let rule = say::thread_lead_change_per_inch_out_of_range(to_mm(r));
        (LEAD_CHANGE_RANGE_PER_INCH, rule)
    } else {
        let rule = say::thread_lead_change_out_of_range(to_mm(r));
        (LEAD_CHANGE_RANGE, rule)
    };
    match range.contains(&r.saturating_abs()) {
        true => Ok(to_mm(r)),
        false => Err(out_of_range_alarm(rule)),
    }
}

fn out_of_range_alarm(detail: Message) -> Alarm {
    Alarm::new(number::OUT_OF_RANGE).with_detail(detail)
}
