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
use crate::interpreter::codes::positioning::{check_stroke, current_feed};
use crate::interpreter::context::BlockContext;
use crate::interpreter::cycles::roughing::step_move;
use crate::interpreter::exact::{ExactPoint, UNITS_PER_MM, scale_rounded, to_mm};
use crate::interpreter::moves::explanation::{Explanation, PassNote, formula_message};
use crate::interpreter::moves::{FrameShift, Move};
use crate::interpreter::parameter_writes::ParameterWrites;
use crate::interpreter::profile::{self, ProfileRange, ProfileSegment, StepShape};
use crate::interpreter::state::State;
use crate::interpreter::words::SortedWords;
use crate::memory::parameter;
use crate::units::Feed;

/// Number of units of [`ExactPoint`] in a thousandth of a millimetre.
const UNITS_PER_MICRON: i64 = UNITS_PER_MM / 1000;

/// The moves of a G73 that are not executed yet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PatternCycle {
    start: ExactPoint,
    entry: ProfileSegment,
    steps: Vec<ProfileSegment>,
    home: FrameShift,
    allowance: ExactPoint,
    /// Δi and Δk, the distance of the first pass from the last; X as a diameter.
    relief: ExactPoint,
    feed: Feed,
    pass: i64,
    passes: i64,
    /// Number of equal parts into which the passes divide the relief.
    gaps: i64,
    /// Next move of the pass: 0 is that to the start of the pass, 1 the entry, from 2 on the
    /// steps.
    step: usize,
}

/// Stores the data of a G73 without P and Q: Δi, Δk and d into parameters 053, 054 and 055.
///
/// # Errors
/// 062 for a wrong number of passes.
pub(crate) fn store_data(words: &SortedWords, writes: &mut ParameterWrites) -> Result<(), Alarm> {
    if let Some(relief) = words.u {
        writes.push_length(parameter::PATTERN_RELIEF_X, relief);
    }
    if let Some(relief) = words.w {
        writes.push_length(parameter::PATTERN_RELIEF_Z, relief);
    }
    store_passes(words, writes)
}

/// Stores the number of passes, R(d), which either block of the cycle may contain, into parameter
/// 055. Returns an alarm as error if it is less than 1.
fn store_passes(words: &SortedWords, writes: &mut ParameterWrites) -> Result<(), Alarm> {
    if let Some(passes) = words.r {
        if passes < UNITS_PER_MM {
            return Err(pattern_alarm(say::cycle_passes_below_one(to_mm(passes))));
        }
        writes.push(parameter::PATTERN_PASSES, passes / UNITS_PER_MM);
    }
    Ok(())
}

/// Plans the G73 over the profile `range`; U and W are the finishing allowances.
///
/// # Errors
/// 062 for a wrong number of passes, 043 for a point outside the stroke, and the alarms of the
/// profile.
pub(crate) fn plan_cycle(
    state: &State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    range: ProfileRange,
    writes: &mut ParameterWrites,
) -> Result<PatternCycle, Alarm> {
    store_passes(words, writes)?;
    let parameter = |number| i64::from(writes.value_after(number, context.parameters));
    let passes = parameter(parameter::PATTERN_PASSES);
    if passes <= 0 {
        return Err(pattern_alarm(say::cycle_passes_missing()));
    }
    // The control carries out one pass as two.
    let passes = passes.max(2);
    let repetition = PatternPasses {
        allowance: ExactPoint::new(
            words.u.unwrap_or(0).saturating_mul(context.x_factor),
            words.w.unwrap_or(0),
        ),
        relief: ExactPoint::new(
            2 * parameter(parameter::PATTERN_RELIEF_X) * UNITS_PER_MICRON,
            parameter(parameter::PATTERN_RELIEF_Z) * UNITS_PER_MICRON,
        ),
        passes,
        gaps: passes - 1,
    };
    plan_passes(state, context, range, &repetition)
}

/// Plans the G73 of the Huaxing lathes over the next N blocks. The shift of pass p of L is
/// `1-p/L` times I in X, a diameter, and `1-p/L` times K in Z.
///
/// # Errors
/// As for [`plan_cycle`].
pub(crate) fn plan_counted(
    state: &State,
    context: &BlockContext<'_>,
    words: &SortedWords,
) -> Result<PatternCycle, Alarm> {
    let range = profile::find_following_range(context, words)?;
    let passes = words.l.unwrap_or(1).max(1);
    let repetition = PatternPasses {
        allowance: ExactPoint::new(words.x.unwrap_or(0), words.z.unwrap_or(0)),
        relief: ExactPoint::new(words.i.unwrap_or(0), words.k.unwrap_or(0)),
        passes,
        gaps: passes,
    };
    plan_passes(state, context, range, &repetition)
}

/// Number of passes over the contour, and the distances between them.
struct PatternPasses {
    allowance: ExactPoint,
    relief: ExactPoint,
    passes: i64,
    gaps: i64,
}

fn plan_passes(
    state: &State,
    context: &BlockContext<'_>,
    range: ProfileRange,
    repetition: &PatternPasses,
) -> Result<PatternCycle, Alarm> {
    let feed = current_feed(&state.modal)?;
    let profile = profile::evaluate_profile(state, context, range)?;
    let pattern = PatternCycle {
        start: profile.start,
        entry: profile.entry,
        steps: profile.steps,
        home: FrameShift::from_state(state),
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
            check_stroke(end + shift, context.coordinate_range())?;
        }
    }
    Ok(pattern)
}

impl PatternCycle {
    /// The shift of the current pass from the programmed contour, allowance included.
    fn current_shift(&self) -> ExactPoint {
        let (remaining, gaps) = (self.passes - self.pass, self.gaps);
        self.allowance
            + ExactPoint::new(
                scale_rounded(self.relief.x, remaining, gaps),
                scale_rounded(self.relief.z, remaining, gaps),
            )
    }

    pub(crate) fn next_move(&mut self) -> Option<Move> {
        if self.pass > self.passes {
            return None;
        }
        let shift_distance = self.current_shift();
        let shift = self.home.moved(shift_distance);
        let note = PassNote::Shifted {
            number: self.pass,
            passes: self.passes,
            shift: shift_distance,
            allowance: self.allowance,
            relief: self.relief,
        };
        let step = self.step;
        self.step += 1;
        match step {
            0 => return Some(Move::rapid(shift.to_machine(self.start), note)),
            1 => {
                let to = shift.to_machine(self.entry.to);
                return Some(match self.entry.shape {
                    StepShape::Straight { rapid: true } => Move::rapid(to, note),
                    _ => Move::line(to, self.feed, note),
                });
            }
            _ => {}
        }
        if let Some(contour_step) = self.steps.get(step - 2) {
            return Some(step_move(contour_step, shift, self.feed, note));
        }
        self.step = 0;
        self.pass += 1;
        if self.pass > self.passes {
            return Some(Move::rapid(self.home.to_machine(self.start), note));
        }
        self.next_move()
    }
}

fn pattern_alarm(detail: Message) -> Alarm {
    Alarm::new(number::CYCLE_DATA).with_detail(say::cycle_in_code(73, detail))
}

/// Explains a pass of G73; `None` for the note of another cycle.
pub(crate) fn explain_shifted_pass(note: PassNote) -> Option<Explanation> {
    let PassNote::Shifted {
        number,
        passes,
        shift,
        allowance,
        relief,
    } = note
    else {
        return None;
    };
    Some(Explanation {
        code: 73,
        pass: number.unsigned_abs(),
        passes: Some(passes.unsigned_abs()),
        level: None,
        depth: to_mm(relief.x + allowance.x - shift.x).abs() / 2.0,
        remaining: to_mm(shift.x - allowance.x).abs() / 2.0,
        formula: formula_message(format!(
            "X{:+.3} = {:+.3} {:+.3}·{left}/{gaps}, Z{:+.3} = {:+.3} {:+.3}·{left}/{gaps}",
            to_mm(shift.x),
            to_mm(allowance.x),
            to_mm(relief.x),
            to_mm(shift.z),
            to_mm(allowance.z),
            to_mm(relief.z),
            left = passes - number,
            gaps = passes - 1,
        )),
        words: "U(Δi), W(Δk), R(d), 053, 054, 055, U(Δu), W(Δw)",
    })
}
