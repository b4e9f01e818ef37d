//! Executes a block: modal words, then motion, then M codes and the flow of the program.

use gsk_core::alarm::{Alarm, number};
use gsk_core::compensation::cutter::CutterSide;
use gsk_core::model::MCode;
use gsk_core::program::{ProgramBlock, WordNumber};
use gsk_messages::{Message, say};

use crate::codes;
use crate::cycles::HoleData;
use crate::memory::{MillMemory, parameter};
use crate::modal::{LengthOffset, MillMotion, SpindleState, WorkZero};
use crate::path::travel::{RunContext, StepKind, execute_holes, execute_motion};
use crate::space::{Length, MillPosition};
use crate::state::{MillState, Polar};
use crate::words::{BlockWords, OnOff, OneShotCode};

/// What runs after a block: the next block, a subprogram, another block, or nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum BlockFlow {
    Next,
    /// The program stops at the block (M00).
    Stop,
    /// The program ends with the block (M02, M30).
    End,
    /// The block calls a subprogram, by M98 or an M code with a subprogram.
    Call {
        program: i64,
        runs: u16,
        name: String,
    },
    /// The block calls a macro by M9000 to M9999.
    Macro {
        program: i64,
        runs: u16,
        name: String,
    },
    /// The subprogram returns (M99), to the block with this sequence number if it has P.
    Back(Option<i64>),
}

/// The result of an executed block: what it has moved and which block follows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct BlockResult {
    pub(crate) flow: BlockFlow,
    /// Whether the block moved an axis, so that a modal macro is called after it.
    pub(crate) moved: bool,
}

fn alarm(number: u16, detail: Message) -> Alarm {
    Alarm::new(number).with_detail(detail)
}

/// Executes a block: modal words, motion, M codes. Errors: the alarm that refuses the block.
pub(crate) fn execute_block(
    state: &mut MillState,
    block: &ProgramBlock,
    words: &BlockWords,
    context: &mut RunContext<'_, '_>,
) -> Result<BlockResult, Alarm> {
    words.check()?;
    let flow = block_flow(words, context.memory)?;
    // Words of a macro are its arguments.
    let is_macro = matches!(flow, BlockFlow::Macro { .. });
    if !is_macro {
        words.check_axes()?;
    }
    context.exact = words.exact_stop;
    set_plane(state, words, context)?;
    set_modal(state, words, context)?;
    let length_before = state.length;
    set_length(state, words, context.memory)?;
    set_spindle(state, words, context)?;
    let mut moved = false;
    match (words.scaling, words.rotation) {
        (Some(OnOff::On), _) => codes::start_scaling(state, block, words, context)?,
        (_, Some(OnOff::On)) => codes::start_rotation(state, words, context)?,
        _ if is_macro => {}
        _ => moved = execute_motion_words(state, words, length_before, context)?,
    }
    if !moved {
        context
            .cutter
            .skip_block(state.modal.cutter, context.tracker)?;
    }
    apply_m_after_motion(state, words, context)?;
    Ok(BlockResult { flow, moved })
}

fn execute_motion_words(
    state: &mut MillState,
    words: &BlockWords,
    length_before: Length,
    context: &mut RunContext<'_, '_>,
) -> Result<bool, Alarm> {
    if let Some(code) = words.one_shot {
        if state.length != length_before {
            state.resync(context.memory);
        }
        return codes::execute_one_shot(code, state, words, context);
    }
    let moved = match state.modal.hole {
        Some(hole) => execute_holes(hole, state, words, context)?,
        None => execute_motion(state, words, context)?,
    };
    if moved || state.length == length_before {
        return Ok(moved);
    }
    // Only the length offset changes: the tool moves by it, or the coordinates do with 003.4.
    if context.memory.bit(parameter::OFFSETS, 4) {
        state.resync(context.memory);
        return Ok(false);
    }
    let to = state.to_machine(state.programmed, context.memory);
    let kind = match state.modal.motion {
        MillMotion::Rapid => StepKind::Rapid,
        _ => StepKind::Cut,
    };
    context.go(state, to, kind, false)?;
    Ok(false)
}

fn set_plane(
    state: &mut MillState,
    words: &BlockWords,
    context: &RunContext<'_, '_>,
) -> Result<(), Alarm> {
    let Some(plane) = words.plane else {
        return Ok(());
    };
    let changes = plane != state.modal.plane;
    let transformed =
        state.transform.rotation.is_some() || (changes && state.transform.scaling.is_some());
    if transformed {
        return Err(alarm(number::BAD_G, say::mill_plane_in_transform()));
    }
    if changes && context.cutter.is_on() {
        return Err(alarm(number::BAD_G, say::mill_plane_in_compensation()));
    }
    state.modal.plane = plane;
    Ok(())
}

fn set_modal(
    state: &mut MillState,
    words: &BlockWords,
    context: &mut RunContext<'_, '_>,
) -> Result<(), Alarm> {
    let modal = &mut state.modal;
    modal.incremental = words.incremental.unwrap_or(modal.incremental);
    modal.inch = words.inch.unwrap_or(modal.inch);
    modal.to_r = words.to_r.unwrap_or(modal.to_r);
    modal.exact_stop = words.exact_mode.unwrap_or(modal.exact_stop);
    if let Some(per_revolution) = words.per_revolution
        && per_revolution != modal.per_revolution
    {
        modal.per_revolution = per_revolution;
        // A feed in the other unit is meaningless.
        modal.feed = 0.0;
    }
    if let Some(motion) = words.motion {
        modal.motion = motion;
        modal.hole = None;
    }
    if let Some(f) = words.letters.f {
        let f = if modal.inch { f.inches_to_mm() } else { f };
        // F of a thread is its lead.
        let hole = words.hole.unwrap_or(modal.hole).is_some();
        match modal.motion {
            MillMotion::Thread if !hole => modal.lead = f.value(),
            _ => modal.feed = f.value(),
        }
    }
    if let Some(hole) = words.hole {
        if modal.hole.is_none() && hole.is_some() {
            let across = modal.plane.across();
            state.hole = HoleData {
                initial: state.machine.get(across),
                ..HoleData::default()
            };
        }
        modal.hole = hole;
    }
    modal.rigid &= words.motion.is_none() && words.hole != Some(None);
    match words.polar {
        Some(OnOff::On) => state.polar = Some(Polar::begin()),
        Some(OnOff::Off) => state.polar = None,
        None => {}
    }
    set_zero(state, words, context.memory)?;
    if words.scaling == Some(OnOff::Off) {
        state.transform.scaling = None;
        state.resync(context.memory);
    }
    if words.rotation == Some(OnOff::Off) {
        state.transform.rotation = None;
        state.resync(context.memory);
    }
    set_cutter(state, words, context.memory)
}

fn set_cutter(state: &mut MillState, words: &BlockWords, memory: &MillMemory) -> Result<(), Alarm> {
    let beside = matches!(words.cutter, Some(CutterSide::Left | CutterSide::Right));
    if beside && !memory.bit(parameter::TOOLS, 1) {
        return Err(alarm(number::BAD_G, say::mill_compensation_off()));
    }
    let letters = &words.letters;
    // H names the radius if there is no D.
    let by_h = letters.h.filter(|_| beside);
    if let Some(d) = letters.d.or(by_h.filter(|_| words.length.is_none())) {
        state.modal.d = offset_number(d)?;
    }
    state.modal.cutter = words.cutter.unwrap_or(state.modal.cutter);
    Ok(())
}

fn offset_number(value: WordNumber) -> Result<u16, Alarm> {
    let number = value.integer();
    match u16::try_from(number) {
        Ok(number @ 0..=400) => Ok(number),
        _ => Err(alarm(
            number::BAD_OFFSET,
            say::mill_offset_number(number, 400_u16),
        )),
    }
}

/// Selects the work zero that the block names, G54 to G59 or G54.1.
fn set_zero(state: &mut MillState, words: &BlockWords, memory: &MillMemory) -> Result<(), Alarm> {
    let zero = match words.zero {
        _ if words.additional => {
            let p = words.letters.p.map(WordNumber::integer);
            match p.and_then(|p| u8::try_from(p).ok()) {
                Some(p @ 1..=48) => WorkZero(WorkZero::FIRST_ADDITIONAL + p - 1),
                _ => {
                    let detail = say::mill_additional_zero();
                    return Err(alarm(number::OUT_OF_RANGE, detail));
                }
            }
        }
        Some(zero) => zero,
        None => return Ok(()),
    };
    state.modal.zero = zero;
    state.held_zero = None;
    if memory.bit(parameter::ZEROS, 4) {
        state.shift = MillPosition::default();
    }
    state.resync(memory);
    Ok(())
}

/// Sets the tool length offset of G43, G44, G49 and H.
fn set_length(state: &mut MillState, words: &BlockWords, memory: &MillMemory) -> Result<(), Alarm> {
    let modal = &mut state.modal;
    let changes = words.length.is_some() || modal.length != LengthOffset::Off;
    if let Some(h) = words.letters.h.filter(|_| changes) {
        modal.h = offset_number(h)?;
    }
    modal.length = words.length.unwrap_or(modal.length);
    let length = match (modal.length, modal.h) {
        (LengthOffset::Off, _) | (_, 0) => Length::ZERO,
        (LengthOffset::Plus, h) => memory.tool_length(h),
        (LengthOffset::Minus, h) => -memory.tool_length(h),
    };
    // An offset that G10 has changed acts from the next H or G43 on.
    if words.length.is_some() || words.letters.h.is_some() {
        state.length = length;
    }
    Ok(())
}

/// Carries out the S, T and M codes that act before the motion.
fn set_spindle(
    state: &mut MillState,
    words: &BlockWords,
    context: &RunContext<'_, '_>,
) -> Result<(), Alarm> {
    let modal = &mut state.modal;
    if let Some(s) = words.letters.s {
        modal.speed = s.value();
    }
    if let Some(t) = words.letters.t {
        check_pockets(context.memory)?;
        modal.called = u16::try_from(t.integer()).unwrap_or(u16::MAX);
        if !state.changes_tools {
            modal.tool = modal.called;
        }
    }
    let Some(m) = words.letters.m else {
        return Ok(());
    };
    let code = m.integer();
    modal.m = u16::try_from(code).unwrap_or(u16::MAX);
    match m_function(code, context.memory)? {
        Some(MCode::SpindleForward) => modal.spindle = SpindleState::Forward,
        Some(MCode::SpindleReverse) => modal.spindle = SpindleState::Reverse,
        Some(MCode::CoolantOn) => modal.coolant = true,
        Some(MCode::RigidTapping) => modal.rigid = true,
        Some(MCode::ToolChange) => {
            state.changes_tools = true;
            modal.tool = modal.called;
        }
        _ => {}
    }
    Ok(())
}

/// Checks the numbers of the first and the last tool pocket. Errors: alarm 032 if the first is
/// not smaller (5025, 5026).
fn check_pockets(memory: &MillMemory) -> Result<(), Alarm> {
    let first = memory.value(parameter::FIRST_POCKET);
    let last = memory.value(parameter::LAST_POCKET);
    // As delivered both are 0: the machine has no magazine.
    if first >= last && (first, last) != (0, 0) {
        let detail = say::mill_pockets(first, last);
        return Err(alarm(number::BAD_TOOL, detail));
    }
    Ok(())
}

/// Carries out the M codes that act after the motion.
fn apply_m_after_motion(
    state: &mut MillState,
    words: &BlockWords,
    context: &RunContext<'_, '_>,
) -> Result<(), Alarm> {
    let Some(m) = words.letters.m else {
        return Ok(());
    };
    match m_function(m.integer(), context.memory)? {
        Some(MCode::SpindleStop) => state.modal.spindle = SpindleState::Stopped,
        Some(MCode::CoolantOff) => state.modal.coolant = false,
        _ => {}
    }
    Ok(())
}

/// Returns the function of an M code; `None` if it calls a program or only the ladder knows it.
fn m_function(code: i64, memory: &MillMemory) -> Result<Option<MCode>, Alarm> {
    if memory.model.is_macro_m_code(code) || memory.model.m_subprogram(code).is_some() {
        return Ok(None);
    }
    let known = u8::try_from(code)
        .ok()
        .and_then(|it| memory.model.record().m_function(it));
    match known {
        Some(function) => Ok(Some(function.meaning)),
        None if is_ladder_code(code, memory) => Ok(None),
        None => Err(alarm(number::BAD_M, say::mill_m_unknown(code))),
    }
}

/// Returns whether only the ladder knows the M code `code`, so that its effect is unknown
/// here.
pub(crate) fn is_ladder_code(code: i64, memory: &MillMemory) -> bool {
    let record = memory.model.record();
    let Ok(code) = u8::try_from(code) else {
        return false;
    };
    let left = |(first, last): (u8, u8)| (first..=last).contains(&code);
    let calls = memory.model.m_subprogram(code.into()).is_some();
    !calls && record.m_function(code).is_none() && record.ladder_m.is_some_and(left)
}

/// Returns the number of runs of a call: L, or else `by_p`, the digits of P before the last
/// four.
fn run_count(words: &BlockWords, by_p: i64) -> Result<u16, Alarm> {
    let runs = words.letters.l.map_or(by_p.max(1), WordNumber::integer);
    match u16::try_from(runs) {
        Ok(runs @ 1..=9999) => Ok(runs),
        _ => Err(alarm(
            number::OUT_OF_RANGE,
            say::mill_repeats_out_of_range(runs, 9999),
        )),
    }
}

/// Determines what runs after a block, by its M code.
pub(crate) fn block_flow(words: &BlockWords, memory: &MillMemory) -> Result<BlockFlow, Alarm> {
    let Some(code) = words.letters.m.map(WordNumber::integer) else {
        return Ok(BlockFlow::Next);
    };
    // P of a block with G04 is its time.
    let p = words
        .letters
        .p
        .filter(|_| words.one_shot != Some(OneShotCode::Dwell));
    let p = p.map(WordNumber::integer);
    let name = format!("M{code}");
    if let Some(program) = memory.model.m_subprogram(code) {
        let runs = run_count(words, 1)?;
        return Ok(BlockFlow::Call {
            program,
            runs,
            name,
        });
    }
    if memory.model.is_macro_m_code(code) {
        let runs = run_count(words, 1)?;
        return Ok(BlockFlow::Macro {
            program: code,
            runs,
            name,
        });
    }
    Ok(match m_function(code, memory)? {
        Some(MCode::Stop) => BlockFlow::Stop,
        Some(MCode::End) => BlockFlow::End,
        Some(MCode::Call) => {
            let Some(p) = p else {
                let detail = say::call_without_program();
                return Err(alarm(number::CALL_WITHOUT_P, detail));
            };
            BlockFlow::Call {
                program: p % 10_000,
                runs: run_count(words, p / 10_000)?,
                name: format!("M98 P{p}"),
            }
        }
        Some(MCode::Return) => BlockFlow::Back(p),
        _ => BlockFlow::Next,
    })
}

/// Returns address and value of the words of a block that a macro receives as arguments.
pub(crate) fn arguments(block: &ProgramBlock) -> impl Iterator<Item = (u8, f64)> {
    let words = block.words().iter();
    let words = words.filter(|word| !matches!(word.address, b'G' | b'L' | b'M' | b'P'));
    words.map(|word| (word.address, word.value.value()))
}
