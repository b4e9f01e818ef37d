//! G76: compound thread cycle (manual I-3.2.4.5).
//!
//! ```text
//!   X ^   E <---------4---------- A      depth of pass n, on the line B-C:
//!     |   ^                    1 /         d_n = max(√n·Δd, d_(n-1) + Δdmin)
//!     |   3                     v          up to k - d, then m times k
//!     |   |\                   B_n  :B   1 rapid to B_n: along the half angle a/2
//!     |   | \_______2_________/     :k   2 thread parallel to C-D, run-out
//!     |   D                         C    3 rapid X to E, 4 rapid Z to A
//!     +--------------------------------> Z
//! ```

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::command::{Action, ThreadPassFeature, ThreadStart};
use crate::interpreter::codes::positioning::check_stroke;
use crate::interpreter::context::BlockContext;
use crate::interpreter::exact::{ExactPoint, UNITS_PER_MM, round_to_units, to_mm};
use crate::interpreter::moves::explanation::{DepthRule, Explanation, PassNote, formula_message};
use crate::interpreter::moves::{FrameShift, Move};
use crate::interpreter::parameter_writes::ParameterWrites;
use crate::interpreter::state::State;
use crate::interpreter::threads::thread;
use crate::interpreter::threads::thread_cycle::{RunOutLimits, run_out_width_units};
use crate::interpreter::words::{AxisWords, SortedWords};
use crate::memory::{ControlParameters, parameter};
use crate::units::Point;

/// Number of units of [`ExactPoint`] in a thousandth of a millimetre.
const UNITS_PER_MICRON: i64 = UNITS_PER_MM / 1000;
/// Greatest length that a word of G76 may give, in thousandths of a millimetre.
const MAX_LENGTH: i64 = 9_999_999;
/// Greatest number of roughing passes without a least infeed.
const MAX_PASSES: f64 = 9_999_999.0;

/// The geometry of a G76 thread. Integers are in units of [`ExactPoint`], real lengths in mm,
/// X as a radius.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ThreadGeometry {
    shift: FrameShift,
    a: ExactPoint,
    /// X of B, the crest of the thread, from which the depths count.
    b_x: i64,
    /// Z of D, the end of the thread, in units of [`ExactPoint`].
    end_z: i64,
    /// X of D, the end at full depth, minus X of C, the start at full depth.
    rise: i64,
    /// +1 for an outer thread, -1 for an inner thread.
    side: f64,
    /// Direction of the cut: +1 towards +Z, -1 towards -Z.
    heading: f64,
    /// Slope of the taper: change of the radius per mm of Z.
    slope: f64,
    /// Tangent of half the thread angle, along which the tool feeds in.
    tangent: f64,
    lead: f64,
    run_out: i64,
}

/// The moves of a G76 that are not executed yet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CompoundThread {
    #[serde(rename = "shape")]
    geometry: ThreadGeometry,
    /// Δd, the depth of the first pass. This depth and the next three are radii in units of
    /// [`ExactPoint`].
    first: i64,
    /// Δdmin, the least infeed of a pass, in units of [`ExactPoint`].
    least: i64,
    /// k - d, the depth at which roughing ends, in units of [`ExactPoint`].
    rough: i64,
    /// k, the height of the thread, in units of [`ExactPoint`].
    height: i64,
    finishing: u32,
    /// The pass whose moves the cycle currently makes.
    pass: CompoundPass,
    step: u8,
}

/// Number, depth and start of a pass of G76.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct CompoundPass {
    number: u64,
    depth: i64,
    previous: i64,
    rule: DepthRule,
    /// Number of finishing passes left, this one included; 0 in roughing.
    finishing_left: u32,
    /// Distance of the start of the pass from the start A of the cycle, along Z, mm.
    along: f64,
}

/// Plans a G76 block. A block with X(U) or Z(W) makes the cycle. Another one only stores the
/// data of the cycle and returns `None`.
///
/// # Errors
/// 062 for wrong data, 011 without a lead, 043 for a point outside the stroke.
pub(crate) fn plan_cycle(
    state: &mut State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    axes: &AxisWords,
    writes: &mut ParameterWrites,
) -> Result<Option<CompoundThread>, Alarm> {
    if !axes.has_any() {
        store_data(context.parameters, words, writes)?;
        return Ok(None);
    }
    let end = check_stroke(axes.resolve_end(state.position), context.coordinate_range())?;
    CompoundThread::new(state, context, words, end).map(Some)
}

/// Stores the data of a G76 into parameters: P(m)(r)(a) into 057, 019 and 058, Q(Δdmin) into
/// 059 and R(d) into 060.
fn store_data(
    parameters: &ControlParameters,
    words: &SortedWords,
    writes: &mut ParameterWrites,
) -> Result<(), Alarm> {
    if let Some(data) = words.p.map(i64::abs) {
        if data > 999_999 {
            return Err(
                Alarm::new(number::OUT_OF_RANGE).with_detail(say::thread_data_six_digits(data))
            );
        }
        let (passes, run_out, angle) = (data / 10_000, data / 100 % 100, data % 100);
        writes.push(parameter::THREAD_PASSES, passes.max(1));
        writes.push(parameter::THREAD_RUN_OUT, run_out);
        writes.push(parameter::THREAD_ANGLE, angle);
    } else if parameters.value(parameter::THREAD_PASSES) == 0 {
        writes.push(parameter::THREAD_PASSES, 1);
    }
    if let Some(least) = words.q {
        writes.push(parameter::THREAD_LEAST, check_unsigned(least, "Q(Δdmin)")?);
    }
    if let Some(allowance) = words.r {
        // An integer counts in 0.001 mm, a number with a point in mm.
        let unit = if words.r_has_point {
            UNITS_PER_MICRON
        } else {
            UNITS_PER_MM
        };
        writes.push(
            parameter::THREAD_ALLOWANCE,
            check_unsigned(allowance / unit, "R(d)")?,
        );
    }
    Ok(())
}

fn check_unsigned(value: i64, name: &str) -> Result<i64, Alarm> {
    if (0..=MAX_LENGTH).contains(&value) {
        return Ok(value);
    }
    Err(thread_alarm(say::cycle_length_out_of_range(
        name, value, MAX_LENGTH,
    )))
}

impl CompoundThread {
    fn new(
        state: &State,
        context: &BlockContext<'_>,
        words: &SortedWords,
        d: ExactPoint,
    ) -> Result<Self, Alarm> {
        let parameters = context.parameters;
        let read_microns = |value: Option<i64>, name: Message| match value {
            Some(value @ 1..=MAX_LENGTH) => Ok(value * UNITS_PER_MICRON),
            Some(value) => Err(thread_alarm(say::thread_length_not_positive(
                name, value, MAX_LENGTH,
            ))),
            None => Err(thread_alarm(say::thread_length_missing(name))),
        };
        let height = read_microns(words.p, say::thread_word_height())?;
        let first = read_microns(words.q, say::thread_word_first_depth())?;
        let least = i64::from(parameters.value(parameter::THREAD_LEAST)) * UNITS_PER_MICRON;
        let allowance = i64::from(parameters.value(parameter::THREAD_ALLOWANCE)) * UNITS_PER_MICRON;
        if allowance > height {
            return Err(thread_alarm(say::thread_allowance_above_height(
                to_mm(allowance),
                to_mm(height),
            )));
        }
        let rough = height - allowance;
        let depth_ratio = to_mm(rough) / to_mm(first);
        if least == 0 && depth_ratio * depth_ratio > MAX_PASSES {
            return Err(thread_alarm(say::thread_too_many_passes(to_mm(first))));
        }
        let lead = thread::current_lead(state)?;
        let geometry = ThreadGeometry::new(state, context, words.r.unwrap_or(0), d, height, lead)?;
        let finishing = u32::try_from(parameters.value(parameter::THREAD_PASSES))
            .unwrap_or(0)
            .max(1);
        let mut cycle = Self {
            geometry,
            first,
            least,
            rough,
            height,
            finishing,
            pass: CompoundPass {
                number: 0,
                depth: 0,
                previous: 0,
                rule: DepthRule::Root,
                finishing_left: 0,
                along: 0.0,
            },
            step: 0,
        };
        cycle.advance_pass();
        cycle.check_infeed()?;
        Ok(cycle)
    }

    /// Checks that the first and the last pass begin before the end of the thread. Every other pass
    /// begins between them. Returns an alarm as error if not.
    fn check_infeed(&self) -> Result<(), Alarm> {
        let geometry = &self.geometry;
        let length = (to_mm(geometry.end_z) - to_mm(geometry.a.z)).abs();
        let deepest = geometry.infeed_along(to_mm(self.height));
        let fits = |along: f64| along.is_finite() && along >= 0.0 && along < length;
        if fits(deepest) && fits(self.pass.along) {
            return Ok(());
        }
        Err(thread_alarm(say::thread_infeed_too_long(deepest, length)))
    }

    /// Advances to the next pass; `false` after the last one.
    fn advance_pass(&mut self) -> bool {
        let before = self.pass;
        let pass = &mut self.pass;
        pass.number += 1;
        pass.previous = before.depth;
        if before.finishing_left > 0 || before.depth >= self.rough {
            pass.finishing_left = match before.finishing_left {
                0 => self.finishing,
                left => left - 1,
            };
            (pass.depth, pass.rule) = (self.height, DepthRule::Finish);
            pass.along = self.geometry.infeed_along(to_mm(pass.depth));
            return pass.finishing_left > 0;
        }
        let number = pass.number as f64;
        let root = round_to_units(number.sqrt() * self.first as f64);
        let least = before.depth.saturating_add(self.least);
        (pass.depth, pass.rule) = if number > 1.0 && least > root {
            (least, DepthRule::Least)
        } else {
            (root, DepthRule::Root)
        };
        if pass.depth >= self.rough {
            (pass.depth, pass.rule) = (self.rough, DepthRule::Last);
        }
        pass.along = self.geometry.infeed_along(to_mm(pass.depth));
        true
    }

    /// Greatest travel of each axis per spindle revolution in a cut, mm, X as a radius. The
    /// run-out is included if the spindle drives it (`is_run_out_tied`).
    pub(crate) fn travel_per_revolution(&self, is_run_out_tied: bool) -> Point {
        let begin = self.geometry.pass_begin(&self.pass);
        let (cut, run_out) = self.geometry.pass_actions(begin, &self.pass);
        let from = self.geometry.shift.to_machine(begin);
        thread::travel_per_revolution(
            from,
            [cut.as_ref(), run_out.as_ref().filter(|_| is_run_out_tied)],
        )
    }

    /// `RunOut` if the cuts end in a run-out; `None` for straight passes.
    pub(crate) fn beyond_pass(&self) -> Option<ThreadPassFeature> {
        let (_, tail) = self
            .geometry
            .pass_actions(self.geometry.pass_begin(&self.pass), &self.pass);
        tail.map(|_| ThreadPassFeature::RunOut)
    }

    pub(crate) fn next_move(&mut self) -> Option<Move> {
        if self.step > 4 {
            self.step = 0;
            if !self.advance_pass() {
                // Later calls return `None` again.
                self.step = 5;
                self.pass.finishing_left = 1;
                return None;
            }
        }
        let note = PassNote::ThreadPass {
            number: self.pass.number,
            depth: self.pass.depth,
            previous: self.pass.previous,
            height: self.height,
            first: self.first,
            least: self.least,
            rule: self.pass.rule,
        };
        let geometry = &self.geometry;
        let begin = geometry.pass_begin(&self.pass);
        let e = ExactPoint::new(geometry.a.x, geometry.end_z);
        let step = self.step;
        self.step += 1;
        match step {
            0 => Some(Move::rapid(geometry.shift.to_machine(begin), note)),
            1 => match geometry.pass_actions(begin, &self.pass) {
                (Some(action), tail) => Some(Move {
                    action,
                    stops: tail.is_none(),
                    note,
                }),
                (None, tail) => {
                    self.step += 1;
                    tail.map(|action| Move::from_action(action, note))
                }
            },
            2 => match geometry.pass_actions(begin, &self.pass).1 {
                Some(tail) => Some(Move::from_action(tail, note)),
                None => self.next_move(),
            },
            3 => Some(Move::rapid(geometry.shift.to_machine(e), note)),
            _ => Some(Move::rapid(geometry.shift.to_machine(geometry.a), note)),
        }
    }
}

impl ThreadGeometry {
    fn new(
        state: &State,
        context: &BlockContext<'_>,
        taper: i64,
        d: ExactPoint,
        height: i64,
        lead: f64,
    ) -> Result<Self, Alarm> {
        let a = state.position;
        let c = check_stroke(
            ExactPoint::new(d.x.saturating_add(taper.saturating_mul(2)), a.z),
            context.coordinate_range(),
        )?;
        if a.z == d.z {
            return Err(thread_alarm(say::thread_on_face()));
        }
        if a.x == c.x {
            return Err(thread_alarm(say::thread_start_at_its_x()));
        }
        let side = (a.x - c.x).signum();
        let b = check_stroke(
            ExactPoint::new(c.x + 2 * height * side, a.z),
            context.coordinate_range(),
        )?;
        let heading = (d.z - a.z).signum() as f64;
        let half_angle =
            f64::from(context.parameters.value(parameter::THREAD_ANGLE)).to_radians() / 2.0;
        Ok(Self {
            shift: FrameShift::from_state(state),
            a,
            b_x: b.x,
            end_z: d.z,
            rise: d.x - c.x,
            side: side as f64,
            heading,
            slope: to_mm(d.x - c.x) / 2.0 / to_mm(d.z - a.z),
            tangent: libm::tan(half_angle),
            lead,
            run_out: run_out_width_units(context.parameters, lead),
        })
    }

    /// Distance along Z, mm, that the infeed along the half angle reaches at `depth`, mm:
    /// `x·tan(a/2)` with `x = d / (1 + s·g·t·tan(a/2))` on a taper of slope g.
    fn infeed_along(&self, depth: f64) -> f64 {
        depth * self.tangent / (1.0 + self.side * self.slope * self.heading * self.tangent)
    }

    /// The start of the cut of a pass (B_n), programmed coordinates.
    fn pass_begin(&self, pass: &CompoundPass) -> ExactPoint {
        let z = pass.along;
        let x = to_mm(pass.depth) - self.side * self.slope * self.heading * z;
        ExactPoint::new(
            self.b_x - round_to_units(2.0 * self.side * x * UNITS_PER_MM as f64),
            self.a.z + round_to_units(self.heading * z * UNITS_PER_MM as f64),
        )
    }

    /// The cut of a pass and its run-out; `None` for a part that the pass does not have.
    fn pass_actions(
        &self,
        begin: ExactPoint,
        pass: &CompoundPass,
    ) -> (Option<Action>, Option<Action>) {
        let inward = 2 * pass.depth * self.side as i64;
        let end = ExactPoint::new(self.b_x - inward + self.rise, self.end_z);
        let limits = RunOutLimits {
            height: self.run_out,
            length: self.run_out,
            start: self.a,
        };
        limits
            .limited_cut(begin, end, self.lead)
            .to_actions(self.shift, ThreadStart::AtIndex { degrees: 0.0 })
    }
}

fn thread_alarm(detail: Message) -> Alarm {
    Alarm::new(number::CYCLE_DATA).with_detail(say::cycle_in_code(76, detail))
}

/// Explains a pass of G76; `None` for the note of another cycle.
pub(crate) fn explain_thread_pass(note: PassNote) -> Option<Explanation> {
    let PassNote::ThreadPass {
        number,
        depth,
        previous,
        height,
        first,
        least,
        rule,
    } = note
    else {
        return None;
    };
    let shown = to_mm(depth);
    let formula = match rule {
        DepthRule::Root => formula_message(format!(
            "d{number} = √{number}·{:.3} = {shown:.3}",
            to_mm(first)
        )),
        DepthRule::Least => formula_message(format!(
            "d{number} = d{} + Δdmin = {:.3} + {:.3} = {shown:.3}",
            number - 1,
            to_mm(previous),
            to_mm(least)
        )),
        DepthRule::Last => formula_message(format!(
            "d{number} = k - d = {:.3} - {:.3}",
            to_mm(height),
            to_mm(height - depth)
        )),
        DepthRule::Finish => say::explain_finish_pass(shown, to_mm(depth - previous)),
    };
    Some(Explanation {
        code: 76,
        pass: number,
        passes: None,
        level: None,
        depth: shown,
        remaining: to_mm(height - depth),
        formula,
        words: match rule {
            DepthRule::Root => "Q(Δd)",
            DepthRule::Least => "Q(Δdmin), 059",
            DepthRule::Last => "P(k), R(d), 060",
            DepthRule::Finish => "P(k), P(m), 057",
        },
    })
}
