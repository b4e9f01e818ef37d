//! Plans the codes of group 00 that move the tool, set coordinates or wait, and cycles that
//! are not modal. `compound` plans G70 to G76 of the GSK980TD.

use crate::alarm::Alarm;
use crate::interpreter::canned_cycle::CycleGenerator;
use crate::interpreter::codes::coordinates;
use crate::interpreter::codes::dwell;
use crate::interpreter::codes::reference::ReferenceReturn;
use crate::interpreter::codes::scale;
use crate::interpreter::codes::start_return;
use crate::interpreter::codes::zero_offset;
use crate::interpreter::context::BlockContext;
use crate::interpreter::cycles::pecking;
use crate::interpreter::cycles::stepped;
use crate::interpreter::plan::PlannedMotion;
use crate::interpreter::state::State;
use crate::interpreter::threads::counted_thread;
use crate::interpreter::threads::single_pass;
use crate::interpreter::threads::tapping;
use crate::interpreter::words::{AxisWords, OneShot, SortedWords};

/// Plans the motion of a code of group 00 and sets `state.position` to its end.
///
/// # Errors
/// The alarm that the code raises.
pub(crate) fn plan_motion(
    code: OneShot,
    state: &mut State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    axes: &AxisWords,
) -> Result<PlannedMotion, Alarm> {
    let generator = match code {
        OneShot::Dwell => {
            return Ok(PlannedMotion::Single(dwell::plan_dwell(
                words,
                context.model.record(),
            )?));
        }
        OneShot::Coordinates => {
            let relative_follows = context.parameters.g50_sets_relative();
            zero_offset::clear_zero_offset(state);
            let action = coordinates::set_coordinates(state, words, axes, relative_follows)?;
            if let Some(begun) = &mut state.run_start {
                begun.work = state.position;
            }
            return Ok(action.map_or(PlannedMotion::None, PlannedMotion::Single));
        }
        OneShot::Reference(route) => {
            let reference = ReferenceReturn::plan(state, context, route, axes)?;
            return Ok(reference.map_or(PlannedMotion::None, |it| {
                PlannedMotion::Reference(Box::new(it))
            }));
        }
        OneShot::ZeroOffset(code) => {
            return Ok(PlannedMotion::Single(zero_offset::set_zero_offset(
                state, code, axes,
            )));
        }
        OneShot::Scale { on } => {
            scale::set_scale(state, words, on)?;
            return Ok(PlannedMotion::None);
        }
        OneShot::StartReturn(coordinate_system) => {
            return Ok(PlannedMotion::Single(start_return::plan(
                state,
                context,
                axes,
                coordinate_system,
            )?));
        }
        OneShot::Stepped(axis) => {
            CycleGenerator::Stepped(stepped::plan_cycle(axis, state, context, words, axes)?)
        }
        OneShot::DeepHole => {
            CycleGenerator::Pecking(pecking::plan_deep_hole(state, context, words, axes)?)
        }
        OneShot::RigidTap(unit) => {
            CycleGenerator::Tapping(tapping::plan_rigid(state, context, words, axes, unit)?)
        }
        OneShot::CountedThread(unit) => CycleGenerator::CountedThread(counted_thread::plan_cycle(
            state, context, words, axes, unit,
        )?),
        OneShot::ThreadPass(unit) => {
            // The tool does not return: the cycle begins at the state before the pass.
            let mut end_state = *state;
            let pass = single_pass::plan_pass(&mut end_state, context, words, axes, unit)?;
            let motion = PlannedMotion::start_cycle(state, CycleGenerator::SinglePass(pass))?;
            *state = end_state;
            return Ok(motion);
        }
        _ => return Ok(PlannedMotion::None),
    };
    let motion = PlannedMotion::start_cycle(state, generator)?;
    state.end_at_position();
    Ok(motion)
}
