//! The blocks ns to nf that P and Q of G70 to G73 name (manual I-3.2.6): finds them, checks
//! them, and evaluates them to a contour.
//!
//! ```text
//!   G71 P10 Q50 …        N10 G00 X…      ns: A -> B
//!                        …               B -> … -> C, at most 100 blocks
//!                        N50 …           nf: ends at C
//! ```

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::command::{Action, ProgramId, Source};
use crate::interpreter::block;
use crate::interpreter::calls::special_call;
use crate::interpreter::codes::corner;
use crate::interpreter::context::exact::Exact;
use crate::interpreter::context::moves::Shift;
use crate::interpreter::context::place::Place;
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{OneShot, Words};
use crate::interpreter::context::{Compensated, Context};
use crate::interpreter::plan::Plan;
use crate::program::Program;
use crate::units::Point;

/// Greatest number of blocks of a profile.
const MOST_BLOCKS: u32 = 100;

/// The indices of the first and the last block of a profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Range {
    pub(crate) first: u32,
    pub(crate) last: u32,
    /// Whether the blocks follow the cycle (Huaxing). Then the G00 of the first one may be in
    /// force before it.
    pub(crate) follows: bool,
}

/// The geometry of one step of a contour.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Shape {
    /// A straight line; `rapid` if it was programmed as a rapid.
    Straight { rapid: bool },
    /// An arc about a programmed centre.
    Arc { center: Point, clockwise: bool },
    /// A dwell.
    Dwell { ms: u32 },
}

/// One step of a contour, in programmed coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Step {
    pub(crate) to: Exact,
    pub(crate) shape: Shape,
    /// Line of its block in the file.
    pub(crate) line: u32,
}

/// A contour: the start A, the step to B, and the steps from B to C.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Profile {
    pub(crate) start: Exact,
    pub(crate) entry: Step,
    pub(crate) steps: Vec<Step>,
}

impl Profile {
    /// B, the end of ns.
    pub(crate) const fn begin(&self) -> Exact {
        self.entry.to
    }

    /// C, the end of nf.
    pub(crate) fn end(&self) -> Exact {
        self.steps.last().map_or(self.entry.to, |step| step.to)
    }
}

/// Finds the blocks ns and nf.
///
/// # Errors
/// 016, 061, 063 or 067.
pub(crate) fn locate(context: &Context<'_>, words: &Words) -> Result<Range, Alarm> {
    if context.mdi {
        return Err(Alarm::new(number::PROFILE_IN_MDI).because(say::profile_in_mdi()));
    }
    if context.place.program == ProgramId::Dnc {
        return Err(Alarm::new(number::PROFILE_MISSING).because(say::profile_in_dnc()));
    }
    let (Some(ns), Some(nf)) = (words.p, words.q) else {
        return Err(Alarm::new(number::PROFILE_WORDS).because(say::profile_words_missing()));
    };
    if ns == nf {
        return Err(out_of_order(say::profile_of_one_block(ns)));
    }
    let program = program(context)?;
    let all = 0..program.block_count();
    let first = find(program, ns, all.clone()).ok_or_else(|| missing('P', ns))?;
    let Some(last) = find(program, nf, first..all.end) else {
        return Err(match find(program, nf, all) {
            Some(_) => out_of_order(say::profile_end_before_begin(nf, ns)),
            None => missing('Q', nf),
        });
    };
    once(program, 'P', ns)?;
    once(program, 'Q', nf)?;
    let blocks = last - first + 1;
    if blocks > MOST_BLOCKS {
        return Err(out_of_order(say::profile_too_long(
            blocks,
            ns,
            nf,
            MOST_BLOCKS,
        )));
    }
    Ok(Range {
        first,
        last,
        follows: false,
    })
}

/// The next N blocks after the cycle (Huaxing).
///
/// # Errors
/// 016, 061, 063 or 067.
pub(crate) fn following(context: &Context<'_>, words: &Words) -> Result<Range, Alarm> {
    if context.mdi {
        return Err(Alarm::new(number::PROFILE_IN_MDI).because(say::profile_in_mdi()));
    }
    if context.place.program == ProgramId::Dnc {
        return Err(Alarm::new(number::PROFILE_MISSING).because(say::profile_in_dnc()));
    }
    let count = words.n;
    let Some(count @ 2..) = count else {
        return Err(Alarm::new(number::PROFILE_WORDS).because(say::cycle_count_wrong()));
    };
    let first = context.place.block.saturating_add(1);
    let last = context.place.block.saturating_add(count);
    if last >= program(context)?.block_count() {
        let rule = say::cycle_count_too_great(count);
        return Err(Alarm::new(number::PROFILE_MISSING).because(rule));
    }
    if count > MOST_BLOCKS {
        return Err(out_of_order(say::profile_too_long(
            count,
            i64::from(first),
            i64::from(last),
            MOST_BLOCKS,
        )));
    }
    Ok(Range {
        first,
        last,
        follows: true,
    })
}

/// The program of the cycle.
///
/// # Errors
/// 031 if it is missing.
pub(crate) fn program<'a>(context: &Context<'a>) -> Result<&'a Program, Alarm> {
    context
        .programs
        .get(context.place.program)
        .ok_or_else(|| Alarm::new(number::PROGRAM_MISSING).because(say::program_gone()))
}

fn find(program: &Program, number: i64, range: core::ops::Range<u32>) -> Option<u32> {
    program.find_sequence_block(u32::try_from(number).ok()?, range)
}

/// Checks that the number of P or Q occurs once in the program (manual I-3.2.6.7).
fn once(program: &Program, address: char, number: i64) -> Result<(), Alarm> {
    let end = program.block_count();
    let Some(first) = find(program, number, 0..end) else {
        return Ok(());
    };
    let Some(again) = find(program, number, first + 1..end) else {
        return Ok(());
    };
    Err(out_of_order(say::profile_number_twice(
        number,
        address,
        program.block_line(first),
        program.block_line(again),
    )))
}

fn missing(address: char, number: i64) -> Alarm {
    Alarm::new(number::PROFILE_MISSING).because(say::profile_number_missing(address, number))
}

fn out_of_order(detail: Message) -> Alarm {
    Alarm::new(number::PROFILE_RANGE).because(detail)
}

/// Calls `visit` with index, words and code of group 01 of each block of a range, in order.
///
/// # Errors
/// 064 and 066 for codes that a profile cannot contain, and the alarms of the blocks.
fn walk(
    context: &Context<'_>,
    range: Range,
    motion: u8,
    visit: &mut dyn FnMut(u32, &Words, u8) -> Result<(), Alarm>,
) -> Result<(), Alarm> {
    let mut motion = motion;
    let program = program(context)?;
    for index in range.first..=range.last {
        let at = |alarm: Alarm| in_profile(&alarm, program.block_line(index));
        let Some(words) = (context.read)(index, motion).map_err(at)? else {
            continue;
        };
        motion = words.motion.unwrap_or(motion);
        check_codes(context, &words, motion).map_err(at)?;
        visit(index, &words, motion).map_err(at)?;
    }
    Ok(())
}

/// Assigns the alarm of a profile's block to the cycle; its text contains the line.
fn in_profile(alarm: &Alarm, line: u32) -> Alarm {
    let detail = alarm.detail.clone().unwrap_or_else(|| say::as_written(""));
    Alarm::new(alarm.number).because(say::in_profile(line, detail))
}

fn check_codes(context: &Context<'_>, words: &Words, motion: u8) -> Result<(), Alarm> {
    if let Some(code @ (98 | 99)) = words.m {
        return Err(Alarm::new(number::PROFILE_CALL).because(say::profile_calls(code)));
    }
    if special_call::find(words, context)?.is_some() {
        return Err(Alarm::new(number::PROFILE_CALL).because(say::profile_calls_by_code()));
    }
    let foreign = words.one_shot.is_some_and(|code| code != OneShot::Dwell);
    let moves = words.motion.is_some() || (words.one_shot.is_none() && words.has_axis_words());
    if foreign || (moves && motion > 3) {
        return Err(Alarm::new(number::PROFILE_CODE).because(say::profile_code_wrong()));
    }
    Ok(())
}

/// Checks the blocks of a G70, which run as ordinary blocks afterwards.
///
/// # Errors
/// The alarm of a block.
pub(crate) fn check(state: &State, context: &Context<'_>, range: Range) -> Result<(), Alarm> {
    walk(
        context,
        range,
        state.modal.motion,
        &mut |index, words, motion| {
            if index == range.last && motion == 1 && corner::is_asked(words) {
                return Err(last_corner());
            }
            Ok(())
        },
    )
}

/// A corner at the last block lacks a block after it. Arcs use I, K and R differently.
fn last_corner() -> Alarm {
    Alarm::new(number::ARC_DATA).because(say::profile_corner_at_end())
}

/// Evaluates the blocks of a range to a contour, by the rules of ordinary blocks. F, S, T and
/// M of the blocks act in G70 only.
///
/// # Errors
/// 065 for a wrong begin, and the alarms of the blocks.
pub(crate) fn evaluate(
    state: &State,
    context: &Context<'_>,
    range: Range,
) -> Result<Profile, Alarm> {
    let mut scratch = State {
        ahead: Exact::default(),
        ..*state
    };
    let shift = Shift::of(state);
    let program = program(context)?;
    let mut entry = None;
    let mut steps = Vec::new();
    walk(
        context,
        range,
        state.modal.motion,
        &mut |index, words, motion| {
            let line = program.block_line(index);
            let begins = match range.follows {
                // The example in the manual of these lathes has G90 there, with G00 in force.
                true => motion == 0,
                false => matches!(words.motion, Some(0 | 1)),
            };
            if index == range.first && !begins {
                return Err(bad_start(match range.follows {
                    true => say::profile_begin_rapid(),
                    false => say::profile_begin_code(),
                }));
            }
            let words = words.path_only();
            let next = if motion == 1 && corner::is_asked(&words) {
                next_words(context, index + 1..=range.last, motion)?
            } else {
                None
            };
            let inner = Context {
                source: Source {
                    line,
                    ..context.source
                },
                place: Place {
                    block: index,
                    ..context.place
                },
                compensated: Compensated::Never,
                next: next.as_ref(),
                ..*context
            };
            let mut plan = Plan::new(inner.source, scratch.modal);
            block::evaluate(&mut scratch, &inner, &words, &mut plan)?;
            let mut moves = plan.motion;
            while let Some(made) = moves.next() {
                let Some(step) = step(&made.action, shift, scratch.position, line) else {
                    continue;
                };
                if index > range.first {
                    steps.push(step);
                } else if entry.replace(step).is_some() {
                    return Err(bad_start(say::profile_begin_with_corner()));
                }
            }
            Ok(())
        },
    )?;
    let Some(entry) = entry else {
        return Err(bad_start(say::profile_begin_without_axis()));
    };
    if !steps
        .iter()
        .any(|step| !matches!(step.shape, Shape::Dwell { .. }))
    {
        return Err(bad_start(say::profile_without_motion()));
    }
    Ok(Profile {
        start: state.position,
        entry,
        steps,
    })
}

/// The words of the first block of a range that is not skipped.
fn next_words(
    context: &Context<'_>,
    mut range: core::ops::RangeInclusive<u32>,
    motion: u8,
) -> Result<Option<Words>, Alarm> {
    range
        .find_map(|index| (context.read)(index, motion).transpose())
        .transpose()
}

fn step(action: &Action, shift: Shift, rest: Exact, line: u32) -> Option<Step> {
    let (to, shape) = match action {
        Action::Rapid { to } => (*to, Shape::Straight { rapid: true }),
        Action::Line { to, .. } => (*to, Shape::Straight { rapid: false }),
        Action::Arc {
            to,
            center,
            clockwise,
            ..
        } => (
            *to,
            Shape::Arc {
                center: shift.program_center(*center),
                clockwise: *clockwise,
            },
        ),
        Action::Dwell { ms } => {
            return Some(Step {
                to: rest,
                shape: Shape::Dwell { ms: *ms },
                line,
            });
        }
        _ => return None,
    };
    Some(Step {
        to: shift.program(to),
        shape,
        line,
    })
}

/// Alarm 065 with a reason.
pub(crate) fn bad_start(detail: Message) -> Alarm {
    Alarm::new(number::PROFILE_START).because(detail)
}
