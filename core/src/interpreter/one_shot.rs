//! Plans the codes of group 00 that move the tool, set coordinates or wait, and cycles that
//! are not modal. `compound` plans G70 to G76 of the GSK980TD.

use crate::alarm::Alarm;
use crate::interpreter::canned_cycle::Maker;
use crate::interpreter::codes::coordinates;
use crate::interpreter::codes::dwell;
use crate::interpreter::codes::reference::Reference;
use crate::interpreter::codes::scale;
use crate::interpreter::codes::start_return;
use crate::interpreter::codes::zero_offset;
use crate::interpreter::context::Context;
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{AxisWords, OneShot, Words};
use crate::interpreter::cycles::pecking;
use crate::interpreter::cycles::stepped;
use crate::interpreter::plan::Motion;
use crate::interpreter::threads::counted_thread;
use crate::interpreter::threads::single_pass;
use crate::interpreter::threads::tapping;

/// Plans the motion of a code of group 00 and sets `state.position` to its end.
///
/// # Errors
/// The alarm of the code.
pub(crate) fn motion(
    code: OneShot,
    state: &mut State,
    context: &Context<'_>,
    words: &Words,
    axes: &AxisWords,
) -> Result<Motion, Alarm> {
    let maker = match code {
        OneShot::Dwell => return Ok(Motion::One(dwell::dwell(words, context.model.record())?)),
        OneShot::Coordinates => {
            let relative_follows = context.parameters.g50_sets_relative();
            zero_offset::forget(state);
            let action = coordinates::set(state, words, axes, relative_follows)?;
            if let Some(begun) = &mut state.begun {
                begun.work = state.position;
            }
            return Ok(action.map_or(Motion::None, Motion::One));
        }
        OneShot::Reference(way) => {
            let reference = Reference::plan(state, context, way, axes)?;
            return Ok(reference.map_or(Motion::None, |it| Motion::Reference(Box::new(it))));
        }
        OneShot::ZeroOffset(code) => return Ok(Motion::One(zero_offset::set(state, code, axes))),
        OneShot::Scale { on } => {
            scale::set(state, words, on)?;
            return Ok(Motion::None);
        }
        OneShot::StartReturn(by) => {
            return Ok(Motion::One(start_return::plan(state, context, axes, by)?));
        }
        OneShot::Stepped(axis) => Maker::Stepped(stepped::plan(axis, state, context, words, axes)?),
        OneShot::DeepHole => Maker::Pecking(pecking::deep_hole(state, context, words, axes)?),
        OneShot::RigidTap(unit) => {
            Maker::Tapping(tapping::rigid(state, context, words, axes, unit)?)
        }
        OneShot::CountedThread(unit) => {
            Maker::CountedThread(counted_thread::plan(state, context, words, axes, unit)?)
        }
        OneShot::ThreadPass(unit) => {
            // The tool does not return: the cycle begins at the state before the pass.
            let mut after = *state;
            let pass = single_pass::plan(&mut after, context, words, axes, unit)?;
            let motion = Motion::cycle(state, Maker::SinglePass(pass))?;
            *state = after;
            return Ok(motion);
        }
        _ => return Ok(Motion::None),
    };
    let motion = Motion::cycle(state, maker)?;
    state.return_here();
    Ok(motion)
}
