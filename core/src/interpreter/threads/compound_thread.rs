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
use crate::command::{Action, BeyondPass, ThreadStart};
use crate::interpreter::codes::positioning::within_stroke;
use crate::interpreter::context::Context;
use crate::interpreter::context::exact::{Exact, PER_MM, mm, to_units};
use crate::interpreter::context::explanation::{DepthRule, Note};
use crate::interpreter::context::moves::{Move, Shift};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{AxisWords, Words};
use crate::interpreter::context::writes::Writes;
use crate::interpreter::threads::thread;
use crate::interpreter::threads::thread_cycle::{Leaving, run_out_width};
use crate::memory::{Parameters, parameter};
use crate::units::Point;

/// Units of [`Exact`] in a thousandth of a millimetre.
const PER_MICRON: i64 = PER_MM / 1000;
/// Greatest length in thousandths of a millimetre.
const LONGEST: i64 = 9_999_999;
/// Greatest number of passes.
const MOST_PASSES: f64 = 9_999_999.0;

/// The geometry of a thread. Lengths are in mm, X as a radius.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Shape {
    shift: Shift,
    a: Exact,
    /// X of B, the depth reference.
    b_x: i64,
    /// Z of the end D.
    end_z: i64,
    /// X of D minus X of C.
    rise: i64,
    /// +1 for an outer thread, -1 for an inner one.
    side: f64,
    /// +1 towards +Z.
    heading: f64,
    /// Radius per mm of Z of the line C-D.
    slope: f64,
    /// tan(a/2).
    tangent: f64,
    lead: f64,
    run_out: i64,
}

/// A running G76.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CompoundThread {
    #[serde(rename = "shape")]
    shape: Shape,
    /// Δd, Δdmin, k - d and k in units of [`Exact`], radii.
    first: i64,
    least: i64,
    rough: i64,
    height: i64,
    finishing: u32,
    /// The current pass.
    pass: Pass,
    step: u8,
}

/// A pass of G76.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Pass {
    number: u64,
    depth: i64,
    previous: i64,
    rule: DepthRule,
    /// Number of finishing passes left, this one included; 0 in roughing.
    finishing_left: u32,
    /// Distance of the start from Z_A along Z, mm.
    along: f64,
}

/// Plans a G76 block. With X(U) or Z(W) it is the cycle. Without them it stores the data of
/// the cycle, and the result is `None`.
///
/// # Errors
/// 062 for wrong data, 011 without a lead, 043 for a point outside the stroke.
pub(crate) fn plan(
    state: &mut State,
    context: &Context<'_>,
    words: &Words,
    axes: &AxisWords,
    writes: &mut Writes,
) -> Result<Option<CompoundThread>, Alarm> {
    if !axes.any() {
        store(context.parameters, words, writes)?;
        return Ok(None);
    }
    let end = within_stroke(axes.target(state.position), context.reach())?;
    CompoundThread::new(state, context, words, end).map(Some)
}

/// Stores P(m)(r)(a), Q(Δdmin) and R(d) into parameters 057, 019, 058, 059 and 060.
fn store(parameters: &Parameters, words: &Words, writes: &mut Writes) -> Result<(), Alarm> {
    if let Some(data) = words.p.map(i64::abs) {
        if data > 999_999 {
            return Err(Alarm::new(number::OUT_OF_RANGE).because(say::thread_data_six_digits(data)));
        }
        let (passes, run_out, angle) = (data / 10_000, data / 100 % 100, data % 100);
        writes.push(parameter::THREAD_PASSES, passes.max(1));
        writes.push(parameter::THREAD_RUN_OUT, run_out);
        writes.push(parameter::THREAD_ANGLE, angle);
    } else if parameters.value(parameter::THREAD_PASSES) == 0 {
        writes.push(parameter::THREAD_PASSES, 1);
    }
    if let Some(least) = words.q {
        writes.push(parameter::THREAD_LEAST, unsigned(least, "Q(Δdmin)")?);
    }
    if let Some(allowance) = words.r {
        // An integer counts in 0.001 mm, a number with a point in mm.
        let unit = if words.r_has_point {
            PER_MICRON
        } else {
            PER_MM
        };
        writes.push(
            parameter::THREAD_ALLOWANCE,
            unsigned(allowance / unit, "R(d)")?,
        );
    }
    Ok(())
}

fn unsigned(value: i64, name: &str) -> Result<i64, Alarm> {
    if (0..=LONGEST).contains(&value) {
        return Ok(value);
    }
    Err(fault(say::cycle_length_out_of_range(name, value, LONGEST)))
}

impl CompoundThread {
    fn new(state: &State, context: &Context<'_>, words: &Words, d: Exact) -> Result<Self, Alarm> {
        let parameters = context.parameters;
        let microns = |value: Option<i64>, name: Message| match value {
            Some(value @ 1..=LONGEST) => Ok(value * PER_MICRON),
            Some(value) => Err(fault(say::thread_length_not_positive(name, value, LONGEST))),
            None => Err(fault(say::thread_length_missing(name))),
        };
        let height = microns(words.p, say::thread_word_height())?;
        let first = microns(words.q, say::thread_word_first_depth())?;
        let least = i64::from(parameters.value(parameter::THREAD_LEAST)) * PER_MICRON;
        let allowance = i64::from(parameters.value(parameter::THREAD_ALLOWANCE)) * PER_MICRON;
        if allowance > height {
            return Err(fault(say::thread_allowance_above_height(
                mm(allowance),
                mm(height),
            )));
        }
        let rough = height - allowance;
        let many = mm(rough) / mm(first);
        if least == 0 && many * many > MOST_PASSES {
            return Err(fault(say::thread_too_many_passes(mm(first))));
        }
        let lead = thread::lead(state)?;
        let shape = Shape::new(state, context, words.r.unwrap_or(0), d, height, lead)?;
        let finishing = u32::try_from(parameters.value(parameter::THREAD_PASSES))
            .unwrap_or(0)
            .max(1);
        let mut cycle = Self {
            shape,
            first,
            least,
            rough,
            height,
            finishing,
            pass: Pass {
                number: 0,
                depth: 0,
                previous: 0,
                rule: DepthRule::Root,
                finishing_left: 0,
                along: 0.0,
            },
            step: 0,
        };
        cycle.advance();
        cycle.check()?;
        Ok(cycle)
    }

    /// Checks that the first and the last pass begin before the end of the thread. Every other
    /// pass begins between them.
    fn check(&self) -> Result<(), Alarm> {
        let shape = &self.shape;
        let length = (mm(shape.end_z) - mm(shape.a.z)).abs();
        let deepest = shape.along(mm(self.height));
        let fits = |along: f64| along.is_finite() && along >= 0.0 && along < length;
        if fits(deepest) && fits(self.pass.along) {
            return Ok(());
        }
        Err(fault(say::thread_infeed_too_long(deepest, length)))
    }

    /// Advances to the next pass; `false` after the last one.
    fn advance(&mut self) -> bool {
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
            pass.along = self.shape.along(mm(pass.depth));
            return pass.finishing_left > 0;
        }
        let number = pass.number as f64;
        let root = to_units(number.sqrt() * self.first as f64);
        let least = before.depth.saturating_add(self.least);
        (pass.depth, pass.rule) = if number > 1.0 && least > root {
            (least, DepthRule::Least)
        } else {
            (root, DepthRule::Root)
        };
        if pass.depth >= self.rough {
            (pass.depth, pass.rule) = (self.rough, DepthRule::Last);
        }
        pass.along = self.shape.along(mm(pass.depth));
        true
    }

    /// Greatest travel of each axis per revolution in a cut, mm. The run-out counts if it is
    /// `tied` to the spindle.
    pub(crate) fn per_revolution(&self, tied: bool) -> Point {
        let begin = self.shape.begin(&self.pass);
        let (cut, tail) = self.shape.thread(begin, &self.pass);
        let from = self.shape.shift.machine(begin);
        thread::per_revolution(from, [cut.as_ref(), tail.as_ref().filter(|_| tied)])
    }

    /// `RunOut` if the cuts have one; `None` for straight passes.
    pub(crate) fn beyond_pass(&self) -> Option<BeyondPass> {
        let (_, tail) = self.shape.thread(self.shape.begin(&self.pass), &self.pass);
        tail.map(|_| BeyondPass::RunOut)
    }

    pub(crate) fn make(&mut self) -> Option<Move> {
        if self.step > 4 {
            self.step = 0;
            if !self.advance() {
                // Later calls return `None` again.
                self.step = 5;
                self.pass.finishing_left = 1;
                return None;
            }
        }
        let note = Note::ThreadPass {
            number: self.pass.number,
            depth: self.pass.depth,
            previous: self.pass.previous,
            height: self.height,
            first: self.first,
            least: self.least,
            rule: self.pass.rule,
        };
        let shape = &self.shape;
        let begin = shape.begin(&self.pass);
        let e = Exact::new(shape.a.x, shape.end_z);
        let step = self.step;
        self.step += 1;
        match step {
            0 => Some(Move::rapid(shape.shift.machine(begin), note)),
            1 => match shape.thread(begin, &self.pass) {
                (Some(action), tail) => Some(Move {
                    action,
                    stops: tail.is_none(),
                    note,
                }),
                (None, tail) => {
                    self.step += 1;
                    tail.map(|action| Move::of(action, note))
                }
            },
            2 => match shape.thread(begin, &self.pass).1 {
                Some(tail) => Some(Move::of(tail, note)),
                None => self.make(),
            },
            3 => Some(Move::rapid(shape.shift.machine(e), note)),
            _ => Some(Move::rapid(shape.shift.machine(shape.a), note)),
        }
    }
}

impl Shape {
    fn new(
        state: &State,
        context: &Context<'_>,
        taper: i64,
        d: Exact,
        height: i64,
        lead: f64,
    ) -> Result<Self, Alarm> {
        let a = state.position;
        let c = within_stroke(
            Exact::new(d.x.saturating_add(taper.saturating_mul(2)), a.z),
            context.reach(),
        )?;
        if a.z == d.z {
            return Err(fault(say::thread_on_face()));
        }
        if a.x == c.x {
            return Err(fault(say::thread_start_at_its_x()));
        }
        let side = (a.x - c.x).signum();
        let b = within_stroke(Exact::new(c.x + 2 * height * side, a.z), context.reach())?;
        let heading = (d.z - a.z).signum() as f64;
        let half_angle =
            f64::from(context.parameters.value(parameter::THREAD_ANGLE)).to_radians() / 2.0;
        Ok(Self {
            shift: Shift::of(state),
            a,
            b_x: b.x,
            end_z: d.z,
            rise: d.x - c.x,
            side: side as f64,
            heading,
            slope: mm(d.x - c.x) / 2.0 / mm(d.z - a.z),
            tangent: libm::tan(half_angle),
            lead,
            run_out: run_out_width(context.parameters, lead),
        })
    }

    /// Distance along Z that the half angle leads to at a depth: `x·tan(a/2)` with `x = d / (1
    /// + s·g·t·tan(a/2))` on a taper of slope g.
    fn along(&self, depth: f64) -> f64 {
        depth * self.tangent / (1.0 + self.side * self.slope * self.heading * self.tangent)
    }

    /// B_n, the start of a pass.
    fn begin(&self, pass: &Pass) -> Exact {
        let z = pass.along;
        let x = mm(pass.depth) - self.side * self.slope * self.heading * z;
        Exact::new(
            self.b_x - to_units(2.0 * self.side * x * PER_MM as f64),
            self.a.z + to_units(self.heading * z * PER_MM as f64),
        )
    }

    /// The cut of a pass and its run-out.
    fn thread(&self, begin: Exact, pass: &Pass) -> (Option<Action>, Option<Action>) {
        let inward = 2 * pass.depth * self.side as i64;
        let end = Exact::new(self.b_x - inward + self.rise, self.end_z);
        let leaving = Leaving {
            height: self.run_out,
            length: self.run_out,
            start: self.a,
        };
        leaving
            .cut(begin, end, self.lead)
            .actions(self.shift, ThreadStart::AtIndex { degrees: 0.0 })
    }
}

fn fault(detail: Message) -> Alarm {
    Alarm::new(number::CYCLE_DATA).because(say::cycle_in_code(76, detail))
}
