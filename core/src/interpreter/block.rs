//! Evaluates the words of one block into a [`Plan`]. Nothing outside the given state changes,
//! so the caller can take back a block that raises an alarm.
//!
//! Order in a block (manual I-3.3, I-3.5.1, PLC-II 8.1): S, M and T begin together; the
//! motion waits for a tool change, but not for S and M; then M00, M30, M98, M99.

use crate::alarm::Alarm;
use crate::command::{Action, SpindleCommand};
use crate::interpreter::Modal;
use crate::interpreter::calls::block_call;
use crate::interpreter::calls::special_call;
use crate::interpreter::calls::subprogram;
use crate::interpreter::canned_cycle::Maker;
use crate::interpreter::codes::arc;
use crate::interpreter::codes::corner;
use crate::interpreter::codes::miscellaneous::{self, Function};
use crate::interpreter::codes::nose_radius::{check_arc_block, check_call, check_option};
use crate::interpreter::codes::positioning;
use crate::interpreter::codes::positioning::within_stroke;
use crate::interpreter::codes::scale;
use crate::interpreter::codes::spindle_speed;
use crate::interpreter::codes::tool::{self, Execution, ToolWord};
use crate::interpreter::compound;
use crate::interpreter::context::exact::{Exact, Reach};
use crate::interpreter::context::flow::Flow;
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{ArcWords, AxisWords, OneShot, Words};
use crate::interpreter::context::{Compensated, Context};
use crate::interpreter::cycles::facing_cycle;
use crate::interpreter::cycles::turning_cycle;
use crate::interpreter::one_shot;
use crate::interpreter::plan::{Motion, Plan};
use crate::interpreter::threads::tapping;
use crate::interpreter::threads::thread;
use crate::interpreter::threads::thread_cycle;
use crate::model::Record;

/// The motion that a block commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Nothing,
    OneShot(OneShot),
    Rapid,
    Line,
    Arc,
    Thread,
    Tap,
    TurningCycle,
    ThreadCycle,
    FacingCycle,
}

/// Evaluates the words of a block: updates `state` and fills `plan` in place, because plans
/// are large to move.
///
/// # Errors
/// The alarm of a word. `state` and `plan` are then unusable: the caller restores them.
pub(crate) fn evaluate(
    state: &mut State,
    context: &Context<'_>,
    words: &Words,
    plan: &mut Plan,
) -> Result<(), Alarm> {
    let special = special_call::find(words, context)?;
    let rest;
    let words = match special {
        Some(call) => {
            rest = call.without(words);
            &rest
        }
        None => words,
    };
    let scaled;
    let words = match state.scale {
        Some(factor) => {
            scaled = scale::scaled(words, factor, context.model.record());
            &scaled
        }
        None => words,
    };
    let (function, interface) = match words.m {
        Some(code) => (
            Some(miscellaneous::function(code, context)?),
            miscellaneous::interface(code, words, context)?,
        ),
        None => (None, None),
    };
    check_option(words, context.parameters)?;
    set_modal(state, words)?;
    // Increments count from the position shown before a T of the same block.
    let base = state.position + state.ahead;
    // G50 (G92) gives the tool tip coordinates. They are no increments, also under G91.
    let incremental = state.incremental && words.one_shot != Some(OneShot::Coordinates);
    let axes = words.axes(context.x_factor, base).under(incremental);
    let without_k;
    let (all, words) = match words.k {
        Some(_) if miscellaneous::takes_k(words, context.model.record()) => {
            without_k = Words { k: None, ..*words };
            (words, &without_k)
        }
        _ => (words, words),
    };
    let kind = kind(state, words, &axes);

    plan.modal = state.modal;
    let mut travels = false;
    let word = match words.t {
        Some(t) => Some(ToolWord::of_block(t, context)?),
        None if words.m.is_some() => miscellaneous::offset(all, context)?,
        None => None,
    };
    if let Some(word) = word {
        let execution = tool_execution(context, kind);
        let before = state.offset;
        tool::select(state, context, word, execution, &mut plan.before);
        travels = execution == Execution::Travel && state.offset != before;
    }
    if let Some(command) = spindle(state, context, words, kind)? {
        plan.begin_with_tool(Action::Spindle(command));
    }
    match interface {
        Some(outputs @ Action::Outputs { .. }) => plan.begin_with_tool(outputs),
        wait => plan.before.extend(wait),
    }
    let output = match function {
        Some(Function::Output(code)) => {
            state.modal.m = Some(code);
            Some(code)
        }
        _ => None,
    };
    match kind {
        Kind::OneShot(code) if code.is_compound() => {
            compound::plan(code, state, context, words, &axes, plan)?;
        }
        _ => plan.motion = motion(state, context, words, kind, &axes)?,
    }
    if let Motion::Cycle(cycle) = &plan.motion
        && let Some(per_revolution) =
            cycle.thread_per_revolution(context.parameters.run_out_rate() <= 0.0)
    {
        plan.before.push_front(Action::ThreadCycle {
            per_revolution,
            beyond: cycle.beyond_pass(),
        });
    }
    state.threading = matches!(kind, Kind::Thread) && plan.motion.moves();
    if travels && matches!(kind, Kind::Nothing) {
        plan.motion = Motion::One(positioning::rapid(state, state.position));
    }
    if let Some(code) = output {
        plan.begin_with_tool(Action::Miscellaneous { code });
    }
    follow(state, context, words, function, plan)?;
    if let Kind::OneShot(code) = kind {
        follow_call(code, state, context, words, plan)?;
    }
    if words.exact_stop && plan.motion.moves() && plan.after.is_none() {
        plan.after = Some(Action::Dwell { ms: 0 });
    }
    if let Some(call) = special {
        check_call(state, context, plan.motion.is_contour())?;
        plan.flow = subprogram::call_special(context, call)?;
        // A call alone in its block is no stop of single block, as with M98.
        plan.stops = words.count > 1;
        if plan.stops && plan.is_done() {
            plan.after = Some(Action::Nothing);
        }
    }
    plan.modal = state.modal;
    plan.mark_last_tool();
    if plan.is_done() && matches!(plan.flow, Flow::Next) {
        plan.after = Some(Action::Nothing);
    }
    Ok(())
}

/// Applies the modal G codes and F to the state. In a thread block F and I set the lead
/// instead of the feed.
fn set_modal(state: &mut State, words: &Words) -> Result<(), Alarm> {
    if let Some(code) = words.motion {
        state.modal.motion = code;
        if !matches!(code, 90 | 92 | 94) {
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
    if thread::takes_lead(words, state.modal.motion) {
        return thread::take_lead(state, words);
    }
    if let Some(feed) = words.f {
        state.modal.feed = feed;
    }
    Ok(())
}

/// The control holds one F register: mm/min in G98, 0.0001 mm/rev in G99. Without
/// a new F the same number is read in the other unit: F1 of G99 becomes F10000
/// (manual III-2.1.1).
fn reread_feed(modal: &mut Modal, per_revolution: bool) {
    const UNITS_PER_MM: f64 = 10_000.0;
    match (modal.feed_per_revolution, per_revolution) {
        (true, false) => modal.feed *= UNITS_PER_MM,
        (false, true) => modal.feed /= UNITS_PER_MM,
        _ => {}
    }
    modal.feed_per_revolution = per_revolution;
}

fn kind(state: &State, words: &Words, axes: &AxisWords) -> Kind {
    if let Some(code) = words.one_shot {
        return Kind::OneShot(code);
    }
    match state.modal.motion {
        0 if axes.any() => Kind::Rapid,
        1 if axes.any() => Kind::Line,
        2 | 3 if axes.any() || words.i.is_some() || words.k.is_some() => Kind::Arc,
        32 | 34 if axes.any() => Kind::Thread,
        33 if axes.any() => Kind::Tap,
        code @ (90 | 92 | 94) => {
            let run_out = code == 92 && words.j.or(words.k).or(words.l).is_some();
            let programmed = axes.any() || words.r.is_some() || run_out;
            // An empty block repeats the cycle, and so does its bare G code.
            let repeats = (words.count == 0 || words.motion.is_some()) && state.cycle.is_set();
            match code {
                90 if programmed || repeats => Kind::TurningCycle,
                92 if programmed || repeats => Kind::ThreadCycle,
                94 if programmed || repeats => Kind::FacingCycle,
                _ => Kind::Nothing,
            }
        }
        _ => Kind::Nothing,
    }
}

fn tool_execution(context: &Context<'_>, kind: Kind) -> Execution {
    match kind {
        Kind::OneShot(OneShot::Dwell) | Kind::Arc => Execution::Not,
        Kind::OneShot(_) => Execution::Shift,
        _ if context.parameters.offset_by_shift() => Execution::Shift,
        // The tool shifts the coordinates; the slides do not travel.
        _ if context.model.record().offsets_by_shift => Execution::Shift,
        _ => Execution::Travel,
    }
}

/// The spindle command of a block. S of a G50 block limits the speed, any other S sets it.
fn spindle(
    state: &mut State,
    context: &Context<'_>,
    words: &Words,
    kind: Kind,
) -> Result<Option<SpindleCommand>, Alarm> {
    if !matches!(kind, Kind::OneShot(OneShot::Coordinates)) {
        return spindle_speed::evaluate(state, context, words);
    }
    let command = spindle_speed::evaluate(state, context, &Words { s: None, ..*words })?;
    let Some(limit) = words.s.map(|speed| speed as f64) else {
        return Ok(command);
    };
    state.spindle_limit = Some(limit);
    Ok(Some(SpindleCommand::Limit(limit)))
}

/// Plans the motion of a block and sets `state.position` to its end.
#[expect(
    clippy::inline_always,
    reason = "called, it costs a twentieth of the time of a block"
)]
#[inline(always)]
fn motion(
    state: &mut State,
    context: &Context<'_>,
    words: &Words,
    kind: Kind,
    axes: &AxisWords,
) -> Result<Motion, Alarm> {
    match kind {
        Kind::Thread => Ok(thread::plan(state, words, axes, context.reach())?.into()),
        Kind::Tap => match tapping::plan(state, words, axes, context.reach())? {
            Some(tapping) => Motion::cycle(state, Maker::Tapping(tapping)),
            None => Ok(Motion::None),
        },
        Kind::OneShot(code) => one_shot::motion(code, state, context, words, axes),
        Kind::Nothing => Ok(Motion::None),
        Kind::Rapid => {
            let end = end_point(state, axes, context.reach())?;
            let action = positioning::rapid(state, end);
            state.arrive(axes, end);
            Ok(Motion::One(action))
        }
        Kind::Line => {
            let end = end_point(state, axes, context.reach())?;
            if corner::is_asked(words) {
                return Ok(corner::plan(state, context, words, axes, end)?.into());
            }
            let action = positioning::line(state, end)?;
            state.arrive(axes, end);
            Ok(Motion::One(action))
        }
        Kind::Arc => {
            let end = end_point(state, axes, context.reach())?;
            let record = context.model.record();
            let Some(action) = arc(state, context.compensated, record, words.arc(), end)? else {
                return Ok(Motion::None);
            };
            state.arrive(axes, end);
            Ok(Motion::One(action))
        }
        Kind::ThreadCycle => {
            let data = state.cycle.take_thread(words, axes, state.position);
            let cycle = thread_cycle::plan(state, context.parameters, data, context.reach())?;
            let motion = Motion::cycle(state, Maker::Thread(cycle));
            state.return_here();
            motion
        }
        Kind::TurningCycle | Kind::FacingCycle => {
            let data = state.cycle.take(words, axes, state.position);
            let mut cycle = match kind {
                Kind::TurningCycle => turning_cycle::plan(state, data, context.reach())?,
                _ => facing_cycle::plan(state, data, context.reach())?,
            };
            if state.compensates() && context.compensated != Compensated::Never {
                let start = state.machine(state.position).point();
                cycle.follow_nose(start, state.nose);
            }
            state.return_here();
            Ok(Motion::Box(Box::new(cycle)))
        }
    }
}

/// The arc from the current position to `end`; `None` if it has no length.
///
/// # Errors
/// The alarm of the arc's data, of the feed or of the nose radius compensation.
pub(super) fn arc(
    state: &State,
    compensated: Compensated,
    record: &Record,
    words: ArcWords,
    end: Exact,
) -> Result<Option<Action>, Alarm> {
    check_arc_block(state, compensated, end, words)?;
    let clockwise = state.modal.motion == 2;
    let turn = arc::Turn::of(record, clockwise);
    let Some(center) = arc::center(state.position, end, words, turn)? else {
        return Ok(None);
    };
    Ok(Some(Action::Arc {
        to: state.machine(end).point(),
        center: state.frame().machine(center),
        clockwise,
        feed: positioning::feed(&state.modal)?,
    }))
}

fn end_point(state: &State, axes: &AxisWords, reach: Reach<'_>) -> Result<Exact, Alarm> {
    within_stroke(axes.target(state.position), reach)
}

/// Plans the flow after G20, G24 and G25 to G27 of the Huaxing lathes.
fn follow_call(
    code: OneShot,
    state: &State,
    context: &Context<'_>,
    words: &Words,
    plan: &mut Plan,
) -> Result<(), Alarm> {
    plan.flow = match code {
        OneShot::BlockCall => block_call::call(context, words)?,
        OneShot::Repeat { comes_back } => block_call::repeat(context, words, comes_back)?,
        OneShot::EndlessLoop => block_call::endless(context, words)?,
        OneShot::SubprogramEnd => subprogram::back(context, None)?,
        // The return runs without nose radius compensation.
        OneShot::StartReturn(_) => {
            plan.apart = true;
            return Ok(());
        }
        _ => return Ok(()),
    };
    check_call(state, context, plan.motion.is_contour())?;
    plan.stops = false;
    if subprogram::repeats(context, &plan.flow) {
        plan.after = Some(Action::Repeat);
    }
    Ok(())
}

/// Plans what happens after the motion: M00, M30, M98 or M99.
fn follow(
    state: &mut State,
    context: &Context<'_>,
    words: &Words,
    function: Option<Function>,
    plan: &mut Plan,
) -> Result<(), Alarm> {
    // In G04 without X and U, P is the dwell time.
    let dwells = matches!(words.one_shot, Some(OneShot::Dwell)) && words.x.or(words.u).is_none();
    let p = words.p.filter(|_| !dwells);
    match function {
        Some(Function::Stop) => plan.after = Some(Action::ProgramStop),
        Some(Function::End) => {
            plan.after = Some(Action::End {
                counts: true,
                m30: true,
                m02: words.m == Some(2),
            });
            plan.flow = Flow::End;
            state.cycle.clear();
        }
        Some(Function::Call) => {
            check_call(state, context, plan.motion.is_contour())?;
            plan.flow = subprogram::call(context, p)?;
            plan.stops = !words.bare_call();
        }
        Some(Function::Return) => {
            if !context.calls.is_empty() {
                check_call(state, context, plan.motion.is_contour())?;
            }
            plan.flow = subprogram::back(context, p)?;
            plan.stops = !words.bare_call();
            if subprogram::repeats(context, &plan.flow) {
                plan.after = Some(Action::Repeat);
            }
        }
        Some(Function::Output(_) | Function::Interface) | None => return Ok(()),
    }
    if plan.stops && plan.is_done() {
        plan.after = Some(Action::Nothing);
    }
    Ok(())
}
