//! Evaluates the words of one block into a [`Plan`]. Nothing outside the given state changes,
//! so the caller can take back a block that raises an alarm.
//!
//! Order in a block (manual I-3.3, I-3.5.1, PLC-II 8.1): S, M and T begin together; the
//! motion waits for a tool change, but not for S and M; then M00, M30, M98, M99.

mod block_motion;
mod compound;
mod one_shot;

use crate::alarm::Alarm;
use crate::command::{Action, MotionCode, SpindleCommand};
use crate::interpreter::ModalState;
use crate::interpreter::calls::block_call;
use crate::interpreter::calls::special_call::{self, SpecialCall};
use crate::interpreter::calls::subprogram;
use crate::interpreter::canned_cycle::CycleGenerator;
use crate::interpreter::codes::arc;
use crate::interpreter::codes::corner;
use crate::interpreter::codes::miscellaneous::{self, MCodeFunction};
use crate::interpreter::codes::nose_radius::{check_arc_block, check_call, check_option};
use crate::interpreter::codes::positioning;
use crate::interpreter::codes::positioning::check_stroke;
use crate::interpreter::codes::scale;
use crate::interpreter::codes::spindle_speed;
use crate::interpreter::codes::tool::{self, OffsetExecution, ToolWord};
use crate::interpreter::context::{BlockContext, CompensationMode};
use crate::interpreter::cycles::facing_cycle;
use crate::interpreter::cycles::turning_cycle;
use crate::interpreter::exact::{CoordinateRange, ExactPoint};
use crate::interpreter::flow::Flow;
use crate::interpreter::plan::{Plan, PlannedMotion};
use crate::interpreter::state::State;
use crate::interpreter::threads::tapping;
use crate::interpreter::threads::thread;
use crate::interpreter::threads::thread_cycle;
use crate::interpreter::words::{ArcWords, AxisWords, OneShot, SortedWords};
use crate::model::ModelRecord;
use block_motion::{BlockMotion, find_motion};

/// Evaluates the words of a block: updates `state` and fills `plan` in place, because plans
/// are large to move.
///
/// # Errors
/// The alarm of a word. `state` and `plan` are then unusable: the caller restores them.
pub(crate) fn evaluate(
    state: &mut State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    plan: &mut Plan,
) -> Result<(), Alarm> {
    let special = special_call::find(words, context)?;
    let rest;
    let words = match special {
        Some(call) => {
            rest = call.without_calling_word(words);
            &rest
        }
        None => words,
    };
    let scaled;
    let words = match state.scale {
        Some(factor) => {
            scaled = scale::scale_words(words, factor, context.model.record());
            &scaled
        }
        None => words,
    };
    let (function, interface) = match words.m {
        Some(code) => (
            Some(miscellaneous::classify_m_code(code, context)?),
            miscellaneous::plan_interface(code, words, context)?,
        ),
        None => (None, None),
    };
    check_option(words, context.parameters)?;
    apply_modal_codes(state, words)?;
    // Increments count from the position shown before a T of the same block.
    let base = state.position + state.increment_offset;
    // G50 (G92) gives the tool tip coordinates. They are no increments, also under G91.
    let incremental = state.incremental && words.one_shot != Some(OneShot::Coordinates);
    let axes = words
        .axis_words(context.x_factor, base)
        .with_incremental(incremental);
    let without_k;
    let (all_words, words) = match words.k {
        Some(_) if miscellaneous::is_k_number(words, context.model.record()) => {
            without_k = SortedWords { k: None, ..*words };
            (words, &without_k)
        }
        _ => (words, words),
    };
    let kind = find_motion(state, words, &axes, context.model.record());

    plan.modal = state.modal;
    let offset_travels = plan_tool(state, context, all_words, kind, plan)?;
    if let Some(command) = plan_spindle(state, context, words, kind)? {
        plan.queue_with_tool(Action::Spindle(command));
    }
    match interface {
        Some(outputs @ Action::Outputs { .. }) => plan.queue_with_tool(outputs),
        wait => plan.before.extend(wait),
    }
    let output = match function {
        Some(MCodeFunction::Output(code)) => {
            state.modal.m = Some(code);
            Some(code)
        }
        _ => None,
    };
    match kind {
        BlockMotion::OneShot(code) if code.is_compound() => {
            compound::plan_cycle(code, state, context, words, &axes, plan)?;
        }
        _ => plan.motion = plan_motion(state, context, words, kind, &axes)?,
    }
    plan_thread_travel(context, plan);
    state.is_threading = matches!(kind, BlockMotion::Thread) && plan.motion.has_motion();
    if offset_travels && matches!(kind, BlockMotion::Nothing) {
        plan.motion = PlannedMotion::Single(positioning::plan_rapid(state, state.position));
    }
    if let Some(code) = output {
        plan.queue_with_tool(Action::Miscellaneous { code });
    }
    plan_flow(state, context, words, function, plan)?;
    if let BlockMotion::OneShot(code) = kind {
        plan_block_call(code, state, context, words, plan)?;
    }
    if words.exact_stop && plan.motion.has_motion() && plan.after.is_none() {
        plan.after = Some(Action::Dwell { ms: 0 });
    }
    if let Some(call) = special {
        plan_special(call, state, context, words, plan)?;
    }
    plan.modal = state.modal;
    plan.mark_last_tool();
    if plan.is_done() && matches!(plan.flow, Flow::Next) {
        plan.after = Some(Action::Nothing);
    }
    Ok(())
}

/// Plans the tool change and the offset of the block. Returns true if the slides must travel a
/// change of the offset in this block. Returns the alarm of a wrong T or offset word as error.
#[inline]
fn plan_tool(
    state: &mut State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    kind: BlockMotion,
    plan: &mut Plan,
) -> Result<bool, Alarm> {
    let word = match words.t {
        Some(t) => Some(ToolWord::from_block(t, context)?),
        None if words.m.is_some() => miscellaneous::read_offset_word(words, context)?,
        None => None,
    };
    let Some(word) = word else {
        return Ok(false);
    };
    let execution = find_offset_execution(context, kind);
    let before = state.offset;
    tool::apply_tool_word(state, context, word, execution, &mut plan.before);
    Ok(execution == OffsetExecution::Travel && state.offset != before)
}

/// Plans the call of a program that an M or T word makes by parameters of macro B. Returns an alarm
/// as error if the program does not exist or the call is not permitted here.
fn plan_special(
    call: SpecialCall,
    state: &State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    plan: &mut Plan,
) -> Result<(), Alarm> {
    check_call(state, context, plan.motion.is_contour())?;
    plan.flow = subprogram::plan_special_call(&context.call_context(), call)?;
    // A call alone in its block is no stop of single block, as with M98.
    plan.is_stop = words.count > 1;
    if plan.is_stop && plan.is_done() {
        plan.after = Some(Action::Nothing);
    }
    Ok(())
}

/// Plans an action before the motion of a thread cycle that announces its travel per
/// revolution.
#[inline]
fn plan_thread_travel(context: &BlockContext<'_>, plan: &mut Plan) {
    if let PlannedMotion::Cycle(cycle) = &plan.motion
        && let Some(per_revolution) =
            cycle.thread_travel_per_revolution(context.parameters.run_out_rate() <= 0.0)
    {
        plan.before.push_front(Action::ThreadCycle {
            per_revolution,
            extra_feature: cycle.beyond_pass(),
        });
    }
}

/// Applies the modal G codes and F to the state. In a thread block F and I set the lead instead of
/// the feed. Returns the alarm of a wrong lead as error.
fn apply_modal_codes(state: &mut State, words: &SortedWords) -> Result<(), Alarm> {
    if let Some(code) = words.motion {
        state.modal.motion = code;
        if !code.is_canned_cycle() {
            state.cycle.clear_end();
        }
    }
    if words.one_shot.is_some_and(|code| code != OneShot::Dwell) {
        state.cycle.clear_end();
    }
    if let Some(incremental) = words.incremental {
        state.incremental = incremental;
    }
    if let Some(code) = words.nose {
        state.modal.nose_compensation = code;
    }
    if let Some(per_revolution) = words.per_revolution {
        reread_feed(&mut state.modal, per_revolution);
    }
    if thread::is_lead_block(words, state.modal.motion) {
        return thread::store_lead(state, words);
    }
    if let Some(feed) = words.f {
        state.modal.feed = feed;
    }
    Ok(())
}

/// Stores G98 or G99 and converts the feed. The control has one F register: mm/min in G98,
/// 0.0001 mm/rev in G99. Without a new F the same number counts in the other unit: F1 of G99
/// becomes F10000 (manual III-2.1.1).
fn reread_feed(modal: &mut ModalState, per_revolution: bool) {
    const UNITS_PER_MM: f64 = 10_000.0;
    match (modal.feed_per_revolution, per_revolution) {
        (true, false) => modal.feed *= UNITS_PER_MM,
        (false, true) => modal.feed /= UNITS_PER_MM,
        _ => {}
    }
    modal.feed_per_revolution = per_revolution;
}

fn find_offset_execution(context: &BlockContext<'_>, kind: BlockMotion) -> OffsetExecution {
    match kind {
        BlockMotion::OneShot(OneShot::Dwell) | BlockMotion::Arc => OffsetExecution::ToolOnly,
        BlockMotion::OneShot(_) => OffsetExecution::Shift,
        _ if context.parameters.is_offset_by_shift() => OffsetExecution::Shift,
        // The tool shifts the coordinates; the slides do not travel.
        _ if context.model.record().offsets_by_shift => OffsetExecution::Shift,
        _ => OffsetExecution::Travel,
    }
}

/// Plans the spindle command of a block. S of a G50 block limits the spindle speed, any other S
/// sets the speed. `None` if nothing changes. Returns the alarm of a wrong S as error.
fn plan_spindle(
    state: &mut State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    kind: BlockMotion,
) -> Result<Option<SpindleCommand>, Alarm> {
    if !matches!(kind, BlockMotion::OneShot(OneShot::Coordinates)) {
        return spindle_speed::plan_spindle(state, context, words);
    }
    let command = spindle_speed::plan_spindle(state, context, &SortedWords { s: None, ..*words })?;
    let Some(limit) = words.s.map(|speed| speed as f64) else {
        return Ok(command);
    };
    state.spindle_limit = Some(limit);
    Ok(Some(SpindleCommand::Limit(limit)))
}

/// Plans the motion of a block and sets `state.position` to its end. Returns the alarm of a wrong
/// word or of an end point outside the stroke as error.
#[expect(
    clippy::inline_always,
    reason = "called, it costs a twentieth of the time of a block"
)]
#[inline(always)]
fn plan_motion(
    state: &mut State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    kind: BlockMotion,
    axes: &AxisWords,
) -> Result<PlannedMotion, Alarm> {
    match kind {
        BlockMotion::Thread => {
            Ok(thread::plan_thread(state, words, axes, context.coordinate_range())?.into())
        }
        BlockMotion::Tap => {
            match tapping::plan_cycle(state, words, axes, context.coordinate_range())? {
                Some(tapping) => {
                    PlannedMotion::start_cycle(state, CycleGenerator::Tapping(tapping))
                }
                None => Ok(PlannedMotion::None),
            }
        }
        BlockMotion::OneShot(code) => one_shot::plan_motion(code, state, context, words, axes),
        BlockMotion::Nothing => Ok(PlannedMotion::None),
        BlockMotion::Rapid => {
            let end = find_end_point(state, axes, context.coordinate_range())?;
            let action = positioning::plan_rapid(state, end);
            state.move_to(axes, end);
            Ok(PlannedMotion::Single(action))
        }
        BlockMotion::Line => {
            let end = find_end_point(state, axes, context.coordinate_range())?;
            if corner::has_corner_words(words) {
                return Ok(corner::plan(state, context, words, axes, end)?.into());
            }
            let action = positioning::plan_line(state, end)?;
            state.move_to(axes, end);
            Ok(PlannedMotion::Single(action))
        }
        BlockMotion::Arc => {
            let end = find_end_point(state, axes, context.coordinate_range())?;
            let record = context.model.record();
            let Some(action) =
                plan_arc(state, context.compensation, record, words.arc_words(), end)?
            else {
                return Ok(PlannedMotion::None);
            };
            state.move_to(axes, end);
            Ok(PlannedMotion::Single(action))
        }
        BlockMotion::ThreadCycle => {
            let data = state.cycle.store_thread_words(words, axes, state.position);
            let cycle = thread_cycle::plan_cycle(
                state,
                context.parameters,
                data,
                context.coordinate_range(),
            )?;
            let motion = PlannedMotion::start_cycle(state, CycleGenerator::Thread(cycle));
            state.end_at_position();
            motion
        }
        BlockMotion::TurningCycle | BlockMotion::FacingCycle => {
            let data = state.cycle.store_words(words, axes, state.position);
            let mut cycle = match kind {
                BlockMotion::TurningCycle => {
                    turning_cycle::plan_cycle(state, data, context.coordinate_range())?
                }
                _ => facing_cycle::plan_cycle(state, data, context.coordinate_range())?,
            };
            if state.is_compensating() && context.compensation != CompensationMode::Never {
                let start = state.to_machine(state.position).to_point();
                cycle.shift_for_nose(start, state.nose);
            }
            state.end_at_position();
            Ok(PlannedMotion::Box(Box::new(cycle)))
        }
    }
}

/// Plans the arc from the current position to `end`; `None` for an arc of no length.
///
/// # Errors
/// The alarm of the arc's data, of the feed or of the nose radius compensation.
pub(super) fn plan_arc(
    state: &State,
    compensation: CompensationMode,
    record: &ModelRecord,
    words: ArcWords,
    end: ExactPoint,
) -> Result<Option<Action>, Alarm> {
    check_arc_block(state, compensation, end, words)?;
    let clockwise = state.modal.motion == MotionCode::ArcClockwise;
    let turn = arc::ArcTurn::from_record(record, clockwise);
    let Some(center) = arc::find_center(state.position, end, words, turn)? else {
        return Ok(None);
    };
    Ok(Some(Action::Arc {
        to: state.to_machine(end).to_point(),
        center: state.frame().to_machine(center),
        clockwise,
        feed: positioning::current_feed(&state.modal)?,
    }))
}

fn find_end_point(
    state: &State,
    axes: &AxisWords,
    reach: CoordinateRange<'_>,
) -> Result<ExactPoint, Alarm> {
    check_stroke(axes.resolve_end(state.position), reach)
}

/// Plans the flow after G20, G24 and G25 to G27 of the Huaxing lathes. Returns the alarm of a wrong
/// target or of a call that is not permitted here as error.
fn plan_block_call(
    code: OneShot,
    state: &State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    plan: &mut Plan,
) -> Result<(), Alarm> {
    plan.flow = match code {
        OneShot::BlockCall => block_call::plan_call(context, words)?,
        OneShot::Repeat {
            returns: comes_back,
        } => block_call::plan_repeat(context, words, comes_back)?,
        OneShot::EndlessLoop => block_call::plan_endless_jump(context, words)?,
        OneShot::SubprogramEnd => subprogram::plan_return(&context.call_context(), None)?,
        // The return runs without nose radius compensation.
        OneShot::StartReturn(_) => {
            plan.is_uncompensated = true;
            return Ok(());
        }
        _ => return Ok(()),
    };
    check_call(state, context, plan.motion.is_contour())?;
    plan.is_stop = false;
    if subprogram::is_restart(&context.call_context(), &plan.flow) {
        plan.after = Some(Action::Repeat);
    }
    Ok(())
}

/// Plans the M00, M30, M98 or M99 of the block, which act after the motion. Returns the alarm of a
/// missing target or of a call that is not permitted here as error.
fn plan_flow(
    state: &mut State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    function: Option<MCodeFunction>,
    plan: &mut Plan,
) -> Result<(), Alarm> {
    // In G04 without X and U, P is the dwell time.
    let is_dwell = matches!(words.one_shot, Some(OneShot::Dwell)) && words.x.or(words.u).is_none();
    let p = words.p.filter(|_| !is_dwell);
    match function {
        Some(MCodeFunction::Stop) => plan.after = Some(Action::ProgramStop),
        Some(MCodeFunction::End) => {
            plan.after = Some(Action::End {
                counts: true,
                m30: true,
                m02: words.m == Some(2),
            });
            plan.flow = Flow::End;
            state.cycle.clear();
        }
        Some(MCodeFunction::Call) => {
            check_call(state, context, plan.motion.is_contour())?;
            plan.flow = subprogram::plan_call(&context.call_context(), p)?;
            plan.is_stop = !words.is_bare_call();
        }
        Some(MCodeFunction::Return) => {
            if !context.calls.is_empty() {
                check_call(state, context, plan.motion.is_contour())?;
            }
            plan.flow = subprogram::plan_return(&context.call_context(), p)?;
            plan.is_stop = !words.is_bare_call();
            if subprogram::is_restart(&context.call_context(), &plan.flow) {
                plan.after = Some(Action::Repeat);
            }
        }
        Some(MCodeFunction::Output(_) | MCodeFunction::Interface) | None => return Ok(()),
    }
    if plan.is_stop && plan.is_done() {
        plan.after = Some(Action::Nothing);
    }
    Ok(())
}
