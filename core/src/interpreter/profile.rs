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
use crate::command::{Action, MotionCode, ProgramId, SourcePosition};
use crate::interpreter::calls::special_call;
use crate::interpreter::codes::corner;
use crate::interpreter::context::{BlockContext, CompensationMode};
use crate::interpreter::exact::ExactPoint;
use crate::interpreter::flow::program_position::ProgramPosition;
use crate::interpreter::moves::FrameShift;
use crate::interpreter::state::State;
use crate::interpreter::words::{OneShot, SortedWords};
use crate::program::Program;
use crate::units::Point;

/// Greatest number of blocks that a profile may have.
const MAX_BLOCKS: u32 = 100;

/// The indices, from 0, of the first and the last block of a profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ProfileRange {
    pub(crate) first: u32,
    pub(crate) last: u32,
    /// Whether the blocks follow the cycle (Huaxing). Then the first block needs no G00 if G00
    /// is already in force.
    pub(crate) is_after_cycle: bool,
}

/// The form of one step of a contour: a line, an arc or a dwell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum StepShape {
    /// A straight line; `rapid` if it was programmed as a rapid.
    Straight { rapid: bool },
    /// An arc about a programmed centre, in mm, X as a radius.
    Arc { center: Point, clockwise: bool },
    /// The step is a dwell, ms.
    Dwell { ms: u32 },
}

/// One step of a contour, in programmed coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ProfileSegment {
    pub(crate) to: ExactPoint,
    pub(crate) shape: StepShape,
    /// Line of the step's block in the text of the program.
    pub(crate) line: u32,
}

/// A contour: the start A of the cycle, the step to the beginning B, and the steps from B to the
/// end C.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Profile {
    pub(crate) start: ExactPoint,
    pub(crate) entry: ProfileSegment,
    pub(crate) steps: Vec<ProfileSegment>,
}

impl Profile {
    /// B, where the block ns ends and the contour begins.
    pub(crate) const fn begin_point(&self) -> ExactPoint {
        self.entry.to
    }

    /// C, where the block nf and the contour end.
    pub(crate) fn end_point(&self) -> ExactPoint {
        self.steps.last().map_or(self.entry.to, |step| step.to)
    }
}

/// Finds the blocks with the sequence numbers ns (P) and nf (Q).
///
/// # Errors
/// 067 in MDI; 061 without P or Q; 063 for a missing block; 016 for a wrong range.
pub(crate) fn find_range(
    context: &BlockContext<'_>,
    words: &SortedWords,
) -> Result<ProfileRange, Alarm> {
    if context.is_mdi {
        return Err(Alarm::new(number::PROFILE_IN_MDI).with_detail(say::profile_in_mdi()));
    }
    if context.position.program == ProgramId::Dnc {
        return Err(Alarm::new(number::PROFILE_MISSING).with_detail(say::profile_in_dnc()));
    }
    let (Some(ns), Some(nf)) = (words.p, words.q) else {
        return Err(Alarm::new(number::PROFILE_WORDS).with_detail(say::profile_words_missing()));
    };
    if ns == nf {
        return Err(range_alarm(say::profile_of_one_block(ns)));
    }
    let program = find_program(context)?;
    let all_blocks = 0..program.block_count();
    let first =
        find_block(program, ns, all_blocks.clone()).ok_or_else(|| missing_alarm('P', ns))?;
    let Some(last) = find_block(program, nf, first..all_blocks.end) else {
        return Err(match find_block(program, nf, all_blocks) {
            Some(_) => range_alarm(say::profile_end_before_begin(nf, ns)),
            None => missing_alarm('Q', nf),
        });
    };
    check_unique(program, 'P', ns)?;
    check_unique(program, 'Q', nf)?;
    let blocks = last - first + 1;
    if blocks > MAX_BLOCKS {
        return Err(range_alarm(say::profile_too_long(
            blocks, ns, nf, MAX_BLOCKS,
        )));
    }
    Ok(ProfileRange {
        first,
        last,
        is_after_cycle: false,
    })
}

/// Finds the blocks of a contour that follow the cycle; N is their number (Huaxing).
///
/// # Errors
/// 067 in MDI; 061 without a valid N; 063 for missing blocks; 016 for too many blocks.
pub(crate) fn find_following_range(
    context: &BlockContext<'_>,
    words: &SortedWords,
) -> Result<ProfileRange, Alarm> {
    if context.is_mdi {
        return Err(Alarm::new(number::PROFILE_IN_MDI).with_detail(say::profile_in_mdi()));
    }
    if context.position.program == ProgramId::Dnc {
        return Err(Alarm::new(number::PROFILE_MISSING).with_detail(say::profile_in_dnc()));
    }
    let count = words.n;
    let Some(count @ 2..) = count else {
        return Err(Alarm::new(number::PROFILE_WORDS).with_detail(say::cycle_count_wrong()));
    };
    let first = context.position.block.saturating_add(1);
    let last = context.position.block.saturating_add(count);
    if last >= find_program(context)?.block_count() {
        let rule = say::cycle_count_too_great(count);
        return Err(Alarm::new(number::PROFILE_MISSING).with_detail(rule));
    }
    if count > MAX_BLOCKS {
        return Err(range_alarm(say::profile_too_long(
            count,
            i64::from(first),
            i64::from(last),
            MAX_BLOCKS,
        )));
    }
    Ok(ProfileRange {
        first,
        last,
        is_after_cycle: true,
    })
}

/// Finds the program that contains the cycle.
///
/// # Errors
/// 031 if the program is missing.
pub(crate) fn find_program<'a>(context: &BlockContext<'a>) -> Result<&'a Program, Alarm> {
    context
        .programs
        .get(context.position.program)
        .ok_or_else(|| Alarm::new(number::PROGRAM_MISSING).with_detail(say::program_gone()))
}

fn find_block(program: &Program, number: i64, range: core::ops::Range<u32>) -> Option<u32> {
    program.find_sequence_block(u32::try_from(number).ok()?, range)
}

/// Checks that the sequence number of P or Q occurs once in the program; alarm 016 if not
/// (manual I-3.2.6.7).
fn check_unique(program: &Program, address: char, number: i64) -> Result<(), Alarm> {
    let end = program.block_count();
    let Some(first) = find_block(program, number, 0..end) else {
        return Ok(());
    };
    let Some(second) = find_block(program, number, first + 1..end) else {
        return Ok(());
    };
    Err(range_alarm(say::profile_number_twice(
        number,
        address,
        program.block_line(first),
        program.block_line(second),
    )))
}

fn missing_alarm(address: char, number: i64) -> Alarm {
    Alarm::new(number::PROFILE_MISSING).with_detail(say::profile_number_missing(address, number))
}

fn range_alarm(detail: Message) -> Alarm {
    Alarm::new(number::PROFILE_RANGE).with_detail(detail)
}

/// Calls `visit` with the index (from 0), the words and the code of group 01 of each block of
/// a range that is not skipped, in order.
///
/// # Errors
/// 064 and 066 for codes that a profile cannot contain, and the alarms of the blocks.
fn visit_blocks(
    context: &BlockContext<'_>,
    range: ProfileRange,
    motion: MotionCode,
    visit: &mut dyn FnMut(u32, &SortedWords, MotionCode) -> Result<(), Alarm>,
) -> Result<(), Alarm> {
    let mut motion = motion;
    let program = find_program(context)?;
    for index in range.first..=range.last {
        let locate_alarm = |alarm: Alarm| profile_alarm(&alarm, program.block_line(index));
        let Some(words) = (context.read_words)(index, motion).map_err(locate_alarm)? else {
            continue;
        };
        motion = words.motion.unwrap_or(motion);
        check_codes(context, &words, motion).map_err(locate_alarm)?;
        visit(index, &words, motion).map_err(locate_alarm)?;
    }
    Ok(())
}

/// Turns the alarm of a block in the profile into an alarm of the cycle. The text names the
/// block's line.
fn profile_alarm(alarm: &Alarm, line: u32) -> Alarm {
    let detail = alarm.detail.clone().unwrap_or_else(|| say::as_written(""));
    Alarm::new(alarm.number).with_detail(say::in_profile(line, detail))
}

/// Returns alarm 064 as error for M98 and M99, which neither the profile nor the block of its
/// cycle can contain (manual I-3.2.6.7).
pub(crate) fn check_call(words: &SortedWords) -> Result<(), Alarm> {
    match words.m {
        Some(code @ (98 | 99)) => {
            Err(Alarm::new(number::PROFILE_CALL).with_detail(say::profile_calls(code)))
        }
        _ => Ok(()),
    }
}

fn check_codes(
    context: &BlockContext<'_>,
    words: &SortedWords,
    motion: MotionCode,
) -> Result<(), Alarm> {
    check_call(words)?;
    if special_call::find(words, context)?.is_some() {
        return Err(Alarm::new(number::PROFILE_CALL).with_detail(say::profile_calls_by_code()));
    }
    let is_foreign = words.one_shot.is_some_and(|code| code != OneShot::Dwell);
    let is_motion = words.motion.is_some() || (words.one_shot.is_none() && words.has_axis_words());
    if is_foreign || (is_motion && !motion.is_contour()) {
        return Err(Alarm::new(number::PROFILE_CODE).with_detail(say::profile_code_wrong()));
    }
    Ok(())
}

/// Checks the codes of the profile of a G70. The blocks run as ordinary blocks afterwards.
///
/// # Errors
/// The alarm of a block.
pub(crate) fn check_blocks(
    state: &State,
    context: &BlockContext<'_>,
    range: ProfileRange,
) -> Result<(), Alarm> {
    visit_blocks(
        context,
        range,
        state.modal.motion,
        &mut |index, words, motion| {
            if index == range.last && motion == MotionCode::Line && corner::has_corner_words(words)
            {
                return Err(last_corner_alarm());
            }
            Ok(())
        },
    )
}

/// Returns the alarm for a corner in the last block of a profile, which has no next block. In arcs
/// I, K and R have another meaning.
fn last_corner_alarm() -> Alarm {
    Alarm::new(number::ARC_DATA).with_detail(say::profile_corner_at_end())
}

/// Evaluates the blocks of a range to a contour, by the rules of ordinary blocks. F, S, T and
/// M of the blocks act in G70 only.
///
/// # Errors
/// 065 for a wrong first block, and the alarms of the blocks.
pub(crate) fn evaluate_profile(
    state: &State,
    context: &BlockContext<'_>,
    range: ProfileRange,
) -> Result<Profile, Alarm> {
    let mut profile_state = State {
        increment_offset: ExactPoint::default(),
        ..*state
    };
    let shift = FrameShift::from_state(state);
    let program = find_program(context)?;
    let mut entry = None;
    let mut steps = Vec::new();
    visit_blocks(
        context,
        range,
        state.modal.motion,
        &mut |index, words, motion| {
            let line = program.block_line(index);
            let is_begin = match range.is_after_cycle {
                // The example in the manual of these lathes has G90 there, with G00 in force.
                true => motion == MotionCode::Rapid,
                false => matches!(words.motion, Some(MotionCode::Rapid | MotionCode::Line)),
            };
            if index == range.first && !is_begin {
                return Err(start_alarm(match range.is_after_cycle {
                    true => say::profile_begin_rapid(),
                    false => say::profile_begin_code(),
                }));
            }
            let words = words.path_only();
            let next = if motion == MotionCode::Line && corner::has_corner_words(&words) {
                find_next_words(context, index + 1..=range.last, motion)?
            } else {
                None
            };
            let inner = BlockContext {
                source: SourcePosition {
                    line,
                    ..context.source
                },
                position: ProgramPosition {
                    block: index,
                    ..context.position
                },
                compensation: CompensationMode::Never,
                next: next.as_ref(),
                ..*context
            };
            for action in (context.plan_profile_block)(&mut profile_state, &inner, &words)? {
                let Some(step) = step_from_action(&action, shift, profile_state.position, line)
                else {
                    continue;
                };
                if index > range.first {
                    steps.push(step);
                } else if entry.replace(step).is_some() {
                    return Err(start_alarm(say::profile_begin_with_corner()));
                }
            }
            Ok(())
        },
    )?;
    let Some(entry) = entry else {
        return Err(start_alarm(say::profile_begin_without_axis()));
    };
    if !steps
        .iter()
        .any(|step| !matches!(step.shape, StepShape::Dwell { .. }))
    {
        return Err(start_alarm(say::profile_without_motion()));
    }
    Ok(Profile {
        start: state.position,
        entry,
        steps,
    })
}

/// Reads the words of the first block of a range that is not skipped; `None` if there is none.
fn find_next_words(
    context: &BlockContext<'_>,
    mut range: core::ops::RangeInclusive<u32>,
    motion: MotionCode,
) -> Result<Option<SortedWords>, Alarm> {
    range
        .find_map(|index| (context.read_words)(index, motion).transpose())
        .transpose()
}

fn step_from_action(
    action: &Action,
    shift: FrameShift,
    current: ExactPoint,
    line: u32,
) -> Option<ProfileSegment> {
    let (to, shape) = match action {
        Action::Rapid { to } => (*to, StepShape::Straight { rapid: true }),
        Action::Line { to, .. } => (*to, StepShape::Straight { rapid: false }),
        Action::Arc {
            to,
            center,
            clockwise,
            ..
        } => (
            *to,
            StepShape::Arc {
                center: shift.center_to_program(*center),
                clockwise: *clockwise,
            },
        ),
        Action::Dwell { ms } => {
            return Some(ProfileSegment {
                to: current,
                shape: StepShape::Dwell { ms: *ms },
                line,
            });
        }
        _ => return None,
    };
    Some(ProfileSegment {
        to: shift.to_program(to),
        shape,
        line,
    })
}

/// Alarm 065, wrong first block of a profile, with the reason `detail`.
pub(crate) fn start_alarm(detail: Message) -> Alarm {
    Alarm::new(number::PROFILE_START).with_detail(detail)
}
