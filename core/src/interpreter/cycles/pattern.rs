//! G73: the whole contour several times, nearer to the part each time (manual I-3.2.6.3).
//!
//! ```text
//!   X ^   ______ A_1        pass n of d is shifted by
//!     |  _______\__ A_2       X  Δu + 2Δi·(d-n)/(d-1)
//!     |         \ \  A_3      Z  Δw +  Δk·(d-n)/(d-1)
//!     |          \_\__
//!     +---------------> Z   rapid to A_n, contour, rapid to A_(n+1)
//! ```

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::interpreter::codes::positioning::{feed, within_stroke};
use crate::interpreter::context::Context;
use crate::interpreter::context::exact::{Exact, PER_MM, mm, scaled};
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::moves::{Move, Shift};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::Words;
use crate::interpreter::context::writes::Writes;
use crate::interpreter::cycles::roughing::follow;
use crate::interpreter::profile::{self, Range, Shape, Step};
use crate::memory::parameter;
use crate::units::Feed;

/// Units of [`Exact`] in a thousandth of a millimetre.
const PER_MICRON: i64 = PER_MM / 1000;

/// A running G73.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Pattern {
    start: Exact,
    entry: Step,
    steps: Vec<Step>,
    home: Shift,
    allowance: Exact,
    /// Δi and Δk, X as a diameter.
    relief: Exact,
    feed: Feed,
    pass: i64,
    passes: i64,
    /// Number of parts into which the relief is divided.
    gaps: i64,
    /// 0 the move to A_n, 1 the entry, then the steps.
    step: usize,
}

/// Stores the data of a G73 without P and Q: Δi, Δk and d into parameters 053, 054 and 055.
///
/// # Errors
/// 062 for a wrong number of passes.
pub(crate) fn store(words: &Words, writes: &mut Writes) -> Result<(), Alarm> {
    if let Some(relief) = words.u {
        writes.push_length(parameter::PATTERN_RELIEF_X, relief);
    }
    if let Some(relief) = words.w {
        writes.push_length(parameter::PATTERN_RELIEF_Z, relief);
    }
    store_passes(words, writes)
}

/// Stores R(d), which either block of the cycle may hold.
fn store_passes(words: &Words, writes: &mut Writes) -> Result<(), Alarm> {
    if let Some(passes) = words.r {
        if passes < PER_MM {
            return Err(fault(say::cycle_passes_below_one(mm(passes))));
        }
        writes.push(parameter::PATTERN_PASSES, passes / PER_MM);
    }
    Ok(())
}

/// Plans the cycle over a profile.
///
/// # Errors
/// 062 for a wrong number of passes, 043 for a point outside the stroke, and the alarms of the
/// profile.
pub(crate) fn plan(
    state: &State,
    context: &Context<'_>,
    words: &Words,
    range: Range,
    writes: &mut Writes,
) -> Result<Pattern, Alarm> {
    store_passes(words, writes)?;
    let parameter = |number| i64::from(writes.value(number, context.parameters));
    let passes = parameter(parameter::PATTERN_PASSES);
    if passes <= 0 {
        return Err(fault(say::cycle_passes_missing()));
    }
    // The control carries out one pass as two.
    let passes = passes.max(2);
    let repetition = Repetition {
        allowance: Exact::new(
            words.u.unwrap_or(0).saturating_mul(context.x_factor),
            words.w.unwrap_or(0),
        ),
        relief: Exact::new(
            2 * parameter(parameter::PATTERN_RELIEF_X) * PER_MICRON,
            parameter(parameter::PATTERN_RELIEF_Z) * PER_MICRON,
        ),
        passes,
        gaps: passes - 1,
    };
    over(state, context, range, &repetition)
}

/// Plans the cycle of the Huaxing lathes over the next blocks. Cut p of L is shifted by I·(1 -
/// p/L), where I is a diameter.
///
/// # Errors
/// As for [`plan`].
pub(crate) fn counted(
    state: &State,
    context: &Context<'_>,
    words: &Words,
) -> Result<Pattern, Alarm> {
    let range = profile::following(context, words)?;
    let passes = words.l.unwrap_or(1).max(1);
    let repetition = Repetition {
        allowance: Exact::new(words.x.unwrap_or(0), words.z.unwrap_or(0)),
        relief: Exact::new(words.i.unwrap_or(0), words.k.unwrap_or(0)),
        passes,
        gaps: passes,
    };
    over(state, context, range, &repetition)
}

/// How often the contour is cut, and how far apart.
struct Repetition {
    allowance: Exact,
    relief: Exact,
    passes: i64,
    gaps: i64,
}

fn over(
    state: &State,
    context: &Context<'_>,
    range: Range,
    repetition: &Repetition,
) -> Result<Pattern, Alarm> {
    let feed = feed(&state.modal)?;
    let profile = profile::evaluate(state, context, range)?;
    let pattern = Pattern {
        start: profile.start,
        entry: profile.entry,
        steps: profile.steps,
        home: Shift::of(state),
        allowance: repetition.allowance,
        relief: repetition.relief,
        feed,
        pass: 1,
        passes: repetition.passes,
        gaps: repetition.gaps,
        step: 0,
    };
    for shift in [pattern.allowance, pattern.allowance + pattern.relief] {
        let ends = [pattern.start, pattern.entry.to];
        let ends = ends
            .into_iter()
            .chain(pattern.steps.iter().map(|step| step.to));
        for end in ends {
            within_stroke(end + shift, context.reach())?;
        }
    }
    Ok(pattern)
}

impl Pattern {
    /// The shift of the current pass.
    fn shift(&self) -> Exact {
        let (left, gaps) = (self.passes - self.pass, self.gaps);
        self.allowance
            + Exact::new(
                scaled(self.relief.x, left, gaps),
                scaled(self.relief.z, left, gaps),
            )
    }

    pub(crate) fn make(&mut self) -> Option<Move> {
        if self.pass > self.passes {
            return None;
        }
        let by = self.shift();
        let shift = self.home.moved(by);
        let note = Note::Shifted {
            number: self.pass,
            passes: self.passes,
            shift: by,
            allowance: self.allowance,
            relief: self.relief,
        };
        let step = self.step;
        self.step += 1;
        match step {
            0 => return Some(Move::rapid(shift.machine(self.start), note)),
            1 => {
                let to = shift.machine(self.entry.to);
                return Some(match self.entry.shape {
                    Shape::Straight { rapid: true } => Move::rapid(to, note),
                    _ => Move::line(to, self.feed, note),
                });
            }
            _ => {}
        }
        if let Some(found) = self.steps.get(step - 2) {
            return Some(follow(found, shift, self.feed, note));
        }
        self.step = 0;
        self.pass += 1;
        if self.pass > self.passes {
            return Some(Move::rapid(self.home.machine(self.start), note));
        }
        self.make()
    }
}

fn fault(detail: Message) -> Alarm {
    Alarm::new(number::CYCLE_DATA).because(say::cycle_in_code(73, detail))
}
