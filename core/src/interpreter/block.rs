//! One block: from its words to a plan. Nothing outside the given state
//! changes, so a block that raises an alarm leaves no trace.
//!
//! Order in a block (manual I-3.3): T, then S and M together with the motion,
//! then M00, M30, M98, M99.

use crate::alarm::Alarm;
use crate::command::{Action, Source, SpindleCommand, Timing};
use crate::interpreter::Modal;
use crate::interpreter::exact::Exact;
use crate::interpreter::miscellaneous::{self, Function};
use crate::interpreter::plan::{Motion, Plan};
use crate::interpreter::positioning::within_stroke;
use crate::interpreter::reference::Reference;
use crate::interpreter::state::State;
use crate::interpreter::subprogram::{self, Call, Flow, Place};
use crate::interpreter::tool::{self, Execution, ToolWord};
use crate::interpreter::words::{AxisWords, OneShot, Target, Words};
use crate::interpreter::{
    arc, coordinates, dwell, facing_cycle, numbers, positioning, spindle_speed, turning_cycle,
};
use crate::memory::{Offsets, Parameters};
use crate::program::ProgramMemory;
use crate::units::{Axis, PerAxis};

/// What a block may look at.
pub(crate) struct Context<'a> {
    pub(crate) parameters: &'a Parameters,
    pub(crate) offsets: &'a Offsets,
    pub(crate) programs: &'a ProgramMemory,
    pub(crate) referenced: PerAxis<bool>,
    /// Calls under way, the innermost last.
    pub(crate) calls: &'a [Call],
    pub(crate) source: Source,
    /// Where the block stands.
    pub(crate) place: Place,
    /// Whether the block was keyed in.
    pub(crate) mdi: bool,
    /// 2 under radius programming (001.2), else 1.
    pub(crate) x_factor: i64,
}

/// What the motion words of a block amount to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Nothing,
    OneShot(OneShot),
    Rapid,
    Line,
    Arc,
    TurningCycle,
    FacingCycle,
}

/// Evaluates a block.
pub(crate) fn evaluate(
    state: &mut State,
    context: &Context<'_>,
    words: &Words,
) -> Result<Plan, Alarm> {
    let function = match words.m {
        Some(code) => Some(miscellaneous::function(code, context)?),
        None => None,
    };
    set_modal(state, words);
    let axes = words.axes(context.x_factor);
    let kind = kind(state, words, &axes);

    // Increments count from the position shown before a T of the same block.
    let base = state.position;
    let mut plan = Plan::new(context.source, state.modal);
    let mut travels = false;
    if let Some(t) = words.t {
        let word = ToolWord::read(t, context.parameters.value(84))?;
        let execution = tool_execution(context, kind);
        let before = state.offset;
        tool::select(state, context, word, execution, &mut plan.before);
        travels = execution == Execution::Travel && state.offset != before;
    }
    if let Some(command) = spindle(state, context, words, kind)? {
        plan.before.push_back(Action::Spindle(command));
    }
    let output = match function {
        Some(Function::Output(code)) => {
            state.modal.m = Some(code);
            Some(code)
        }
        _ => None,
    };
    plan.motion = motion(state, context, words, kind, &axes, base)?;
    if travels && kind == Kind::Nothing {
        plan.motion = Motion::One(positioning::rapid(state, state.position));
    }
    if let Some(code) = output {
        let timing = if plan.motion.moves() {
            Timing::WithMotion
        } else {
            Timing::BeforeMotion
        };
        plan.before
            .push_back(Action::Miscellaneous { code, timing });
    }
    follow(state, context, words, function, &mut plan)?;
    plan.modal = state.modal;
    if plan.is_done() && plan.flow == Flow::Next {
        plan.after = Some(Action::Nothing);
    }
    Ok(plan)
}

/// G groups 01 and 03, and F.
fn set_modal(state: &mut State, words: &Words) {
    if let Some(code) = words.motion {
        state.modal.motion = code;
        if code <= 3 {
            state.cycle.clear();
        }
    }
    if matches!(
        words.one_shot,
        Some(OneShot::Reference | OneShot::Coordinates)
    ) {
        state.cycle.clear();
    }
    if let Some(per_revolution) = words.per_revolution {
        reread_feed(&mut state.modal, per_revolution);
    }
    if let Some(feed) = words.f {
        state.modal.feed = feed;
    }
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
        code @ (90 | 94) => {
            let programmed = axes.any() || words.r.is_some();
            // An empty block repeats the cycle, and so does its bare G code.
            let repeats = (words.count == 0 || words.motion.is_some()) && state.cycle.is_set();
            match code {
                90 if programmed || repeats => Kind::TurningCycle,
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
        _ => Execution::Travel,
    }
}

/// The S of a G50 block limits, any other S sets the speed.
fn spindle(
    state: &mut State,
    context: &Context<'_>,
    words: &Words,
    kind: Kind,
) -> Result<Option<SpindleCommand>, Alarm> {
    if kind != Kind::OneShot(OneShot::Coordinates) {
        return spindle_speed::evaluate(state, context, words);
    }
    let command = spindle_speed::evaluate(state, context, &Words { s: None, ..*words })?;
    let Some(limit) = words.s.map(|speed| speed as f64) else {
        return Ok(command);
    };
    state.spindle_limit = Some(limit);
    Ok(Some(SpindleCommand::Limit(limit)))
}

/// The motion of a block; leaves the position at its end.
fn motion(
    state: &mut State,
    context: &Context<'_>,
    words: &Words,
    kind: Kind,
    axes: &AxisWords,
    base: Exact,
) -> Result<Motion, Alarm> {
    match kind {
        Kind::Nothing => Ok(Motion::None),
        Kind::OneShot(OneShot::Dwell) => Ok(Motion::One(dwell::dwell(words))),
        Kind::OneShot(OneShot::Coordinates) => {
            let relative_follows = context.parameters.g50_sets_relative();
            let action = coordinates::set(state, words, axes, relative_follows)?;
            Ok(action.map_or(Motion::None, Motion::One))
        }
        Kind::OneShot(OneShot::Reference) => {
            let reference = Reference::plan(state, context, axes, base)?;
            Ok(reference.map_or(Motion::None, Motion::Reference))
        }
        Kind::Rapid => {
            let end = end_point(state, axes, base, context.x_factor)?;
            let action = positioning::rapid(state, end);
            arrive(state, axes, end);
            Ok(Motion::One(action))
        }
        Kind::Line => {
            if words.r.or(words.i).or(words.k).is_some() {
                return Err(Alarm::new(numbers::ARC_DATA)
                    .because("chamfers and corner arcs (I, K, R with G01) are not built yet"));
            }
            let end = end_point(state, axes, base, context.x_factor)?;
            let action = positioning::line(state, end)?;
            arrive(state, axes, end);
            Ok(Motion::One(action))
        }
        Kind::Arc => {
            let end = end_point(state, axes, base, context.x_factor)?;
            let clockwise = state.modal.motion == 2;
            let Some(center) = arc::center(state.position, end, words, clockwise)? else {
                return Ok(Motion::None);
            };
            let action = Action::Arc {
                to: state.machine(end).point(),
                center: state.frame().machine(center),
                clockwise,
                feed: positioning::feed(&state.modal)?,
            };
            arrive(state, axes, end);
            Ok(Motion::One(action))
        }
        Kind::TurningCycle | Kind::FacingCycle => {
            let data = state.cycle.take(words, axes, base, state.position);
            let cycle = match kind {
                Kind::TurningCycle => turning_cycle::plan(state, data, context.x_factor)?,
                _ => facing_cycle::plan(state, data, context.x_factor)?,
            };
            state.untravelled = PerAxis::new(false, false);
            Ok(Motion::Box(cycle))
        }
    }
}

fn end_point(state: &State, axes: &AxisWords, base: Exact, x_factor: i64) -> Result<Exact, Alarm> {
    within_stroke(axes.target(base, state.position), x_factor)
}

/// The motion will end at a point; its axes have travelled their offset.
fn arrive(state: &mut State, axes: &AxisWords, end: Exact) {
    state.position = end;
    for axis in [Axis::X, Axis::Z] {
        if axes.get(axis) != Target::None {
            *state.untravelled.get_mut(axis) = false;
        }
    }
}

/// M00, M30, M98, M99: after the motion.
fn follow(
    state: &mut State,
    context: &Context<'_>,
    words: &Words,
    function: Option<Function>,
    plan: &mut Plan,
) -> Result<(), Alarm> {
    // The P of a G04 without X, U is its time.
    let dwells = words.one_shot == Some(OneShot::Dwell) && words.x.or(words.u).is_none();
    let p = words.p.filter(|_| !dwells);
    match function {
        Some(Function::Stop) => plan.after = Some(Action::ProgramStop),
        Some(Function::End) => {
            plan.after = Some(Action::End {
                counts: true,
                m30: true,
            });
            plan.flow = Flow::End;
            state.cycle.clear();
        }
        Some(Function::Call) => {
            plan.flow = subprogram::call(context, p)?;
            plan.stops = !words.bare_call();
        }
        Some(Function::Return) => {
            plan.flow = subprogram::back(context, p)?;
            plan.stops = !words.bare_call();
            if subprogram::repeats(context, plan.flow) {
                plan.after = Some(Action::Repeat);
            }
        }
        Some(Function::Output(_)) | None => return Ok(()),
    }
    if plan.stops && plan.is_done() {
        plan.after = Some(Action::Nothing);
    }
    Ok(())
}
