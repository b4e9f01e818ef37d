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
use crate::command::{Action, ThreadPassFeature, ThreadStart};
use crate::interpreter::codes::positioning::check_stroke;
use crate::interpreter::cycles::box_cycle::check_taper;
use crate::interpreter::exact::length_on_axis;
use crate::interpreter::exact::{CoordinateRange, ExactPoint, UNITS_PER_MM, round_to_units, to_mm};
use crate::interpreter::moves::explanation::{
    Explanation, PassNote, add_start_angle, depth_mm, format_corner_b,
};
use crate::interpreter::moves::{FrameShift, Move};
use crate::interpreter::state::State;
use crate::interpreter::state::cycle_words::CycleData;
use crate::interpreter::threads::tapping::start_angle_degrees;
use crate::interpreter::threads::thread::{self, RunOut, ThreadCut, long_axis};
use crate::memory::ControlParameters;
use crate::units::{Axis, Point};

/// The size of a run-out, and the start of the cycle, which limits the run-out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RunOutLimits {
    /// Height of the run-out, on the short axis, in units of [`ExactPoint`]; a radius along X.
    pub(crate) height: i64,
    /// Length of the run-out, on the long axis, in units of [`ExactPoint`]; a radius along X.
    pub(crate) length: i64,
    /// The start A of the cycle: the run-out leads towards this point and not beyond it.
    pub(crate) start: ExactPoint,
}

impl RunOutLimits {
    /// The cut from `from` to `to` with a run-out that does not reach beyond the start of the
    /// cycle.
    pub(crate) fn limited_cut(self, from: ExactPoint, to: ExactPoint, lead: f64) -> ThreadCut {
        let long = long_axis(from, to);
        let short = long.other();
        let distance_back = self.start.get(short) - to.get(short);
        let height = length_on_axis(short, self.height).min(distance_back.abs());
        let mut end = to;
        end.set(short, to.get(short) + distance_back.signum() * height);
        let run_out = (height != 0).then_some(RunOut {
            length: self.length,
            end,
        });
        ThreadCut {
            from,
            to,
            long_axis: long,
            lead,
            increase: 0.0,
            run_out,
        }
    }
}

/// The moves of a G92 that are not executed yet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ThreadCycle {
    /// Start A of the cycle. This point, B and D are machine coordinates in mm, X as a radius.
    a: Point,
    b: Point,
    d: Point,
    thread: Option<Action>,
    #[serde(rename = "tail")]
    run_out: Option<Action>,
    /// For the explanation: programmed start A and end C, R, and height and length of the
    /// run-out.
    #[serde(rename = "words")]
    programmed: (ExactPoint, ExactPoint, i64, (i64, i64)),
    start: u32,
    starts: u32,
    step: u8,
}

/// Plans a G92 from the current position to the end point of `data` and back.
///
/// # Errors
/// 015 for the taper or a thread without length, 011 without a lead, 043 for a corner outside
/// the stroke.
pub(crate) fn plan_cycle(
    state: &State,
    parameters: &ControlParameters,
    data: CycleData,
    range: CoordinateRange<'_>,
) -> Result<ThreadCycle, Alarm> {
    let (a, c) = (state.position, data.end);
    check_taper(data.r, (c.x - a.x) / 2, ("G92", "U/2"))?;
    if c.z == a.z {
        return Err(Alarm::new(number::CYCLE_TAPER).with_detail(say::thread_without_length()));
    }
    let lead = thread::current_lead(state)?;
    let b = ExactPoint::new(c.x + 2 * data.r, a.z);
    let d = ExactPoint::new(a.x, c.z);
    for corner in [b, c, d] {
        check_stroke(corner, range)?;
    }
    let width = run_out_width_units(parameters, lead);
    let height = data.j.map_or(width, i64::saturating_abs);
    let limits = RunOutLimits {
        height,
        length: data.k.map_or(height, i64::saturating_abs),
        start: a,
    };
    let shift = FrameShift::from_state(state);
    let (thread, run_out) = limits
        .limited_cut(b, c, lead)
        .to_actions(shift, ThreadStart::AtIndex { degrees: 0.0 });
    // Move 3 is along X only, from the end of the run-out.
    let mut d = shift.to_machine(d);
    if let Some(Action::Thread { to, .. }) = run_out.as_ref().or(thread.as_ref()) {
        d.z = to.z;
    }
    let cycle = ThreadCycle {
        a: shift.to_machine(a),
        b: shift.to_machine(b),
        d,
        thread,
        run_out,
        programmed: (a, c, data.r, (limits.height, limits.length)),
        start: 0,
        starts: u32::try_from(data.starts).unwrap_or(1),
        step: 0,
    };
    Ok(cycle)
}

/// Width of the run-out by parameter 019 (tenths of the lead), in units of [`ExactPoint`].
/// `lead` is in mm.
pub(crate) fn run_out_width_units(parameters: &ControlParameters, lead: f64) -> i64 {
    round_to_units(f64::from(parameters.run_out_tenths()) * 0.1 * lead * UNITS_PER_MM as f64)
}

impl ThreadCycle {
    /// Greatest travel of each axis per spindle revolution in a cut, mm, X as a radius. The
    /// run-out is included if the spindle drives it (`is_run_out_tied`).
    pub(crate) fn travel_per_revolution(&self, is_run_out_tied: bool) -> Point {
        thread::travel_per_revolution(
            self.b,
            [
                self.thread.as_ref(),
                self.run_out.as_ref().filter(|_| is_run_out_tied),
            ],
        )
    }

    /// `RunOut` if the cuts end in a run-out, else `StartAngle` if the thread has several
    /// starts; `None` for straight passes.
    pub(crate) const fn beyond_pass(&self) -> Option<ThreadPassFeature> {
        match (&self.run_out, self.starts) {
            (Some(_), _) => Some(ThreadPassFeature::RunOut),
            (None, 0 | 1) => None,
            (None, _) => Some(ThreadPassFeature::StartAngle),
        }
    }

    pub(crate) fn next_move(&mut self) -> Option<Move> {
        if self.start >= self.starts {
            return None;
        }
        let (a, c, taper, run_out) = self.programmed;
        let note = PassNote::Thread {
            start: self.start + 1,
            starts: self.starts,
            a,
            c,
            taper,
            run_out,
        };
        let degrees = start_angle_degrees(self.start, self.starts);
        let step = self.step;
        self.step += 1;
        match step {
            0 => Some(Move::rapid(self.b, note)),
            1 => Some(match (&self.thread, &self.run_out) {
                (Some(thread), tail) => Move {
                    action: with_start_angle(thread, degrees),
                    stops: tail.is_none(),
                    note,
                },
                (None, Some(tail)) => {
                    self.step += 1;
                    Move::from_action(with_start_angle(tail, degrees), note)
                }
                (None, None) => return None,
            }),
            2 => match &self.run_out {
                Some(tail) => Some(Move::from_action(*tail, note)),
                None => self.next_move(),
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

/// Copies a thread action with another start angle, degrees.
pub(crate) fn with_start_angle(thread: &Action, degrees: f64) -> Action {
    let mut action = *thread;
    if let Action::Thread { start, .. } = &mut action {
        *start = ThreadStart::AtIndex { degrees };
    }
    action
}

/// Explains one thread start of G92; `None` for the note of another cycle.
pub(crate) fn explain_thread_start(note: PassNote) -> Option<Explanation> {
    let PassNote::Thread {
        start,
        starts,
        a,
        c,
        taper,
        run_out: (height, length),
    } = note
    else {
        return None;
    };
    Some(Explanation {
        code: 92,
        pass: start.into(),
        passes: Some(starts.into()),
        level: Some(to_mm(c.x)),
        depth: depth_mm(Axis::X, c.x - a.x).abs(),
        remaining: 0.0,
        formula: add_start_angle(
            say::explain_thread(
                format_corner_b(Axis::X, c, taper),
                to_mm(height),
                to_mm(length),
            ),
            start,
            starts,
        ),
        words: "X(U), Z(W), R, J, K, 019, L",
    })
}
