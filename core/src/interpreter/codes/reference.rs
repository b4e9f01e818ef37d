//! G28 and other returns to the reference point (manual I-3.2.7).
//!
//! ```text
//!   A ----rapid----> I ----rapid----> R     I intermediate point (X Z U W),
//!                    ^                ^     in the programmed axes only
//!          single block stops         lamps light, tool offset cancelled
//! ```
//!
//! An axis without a reference point seeks it from I on like a manual return (switch and zero
//! signal). Its coordinates are known only after that, so the reader waits until the return is
//! finished.
//!
//! On the NC-B08 R is the reference point of its parameters P108 and P109. G27 moves there
//! without I. An axis without a reference is not sought. G74 of the Huaxing lathes moves
//! straight to machine zero, in the programmed axes or in both.

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::command::Action;
use crate::interpreter::codes::positioning;
use crate::interpreter::context::BlockContext;
use crate::interpreter::exact::{ExactPoint, UNITS_PER_MM};
use crate::interpreter::moves::planned_action::PlannedAction;
use crate::interpreter::state::State;
use crate::interpreter::words::{AxisTarget, AxisWords, ReturnRoute};
use crate::memory::parameter;
use crate::model::{ControlModel, ncb08};
use crate::units::{Axis, PerAxis, Point};

/// Reads the reference point of an axis from the parameters of the NC-B08: machine coordinate
/// in units of [`ExactPoint`].
fn find_reference_point(model: &ControlModel, axis: Axis) -> i64 {
    let number = match axis {
        Axis::X => ncb08::REFERENCE_X,
        Axis::Z => ncb08::REFERENCE_Z,
    };
    i64::from(model.parameter(number)) * (UNITS_PER_MM / 1000)
}

impl ReturnRoute {
    /// Whether the return leads to machine zero, so that an axis without a reference seeks it.
    const fn can_seek(self) -> bool {
        matches!(self, Self::MachineZero | Self::NamedAxes)
    }
}

/// A running return to the reference point: the moves of the block that are left.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ReferenceReturn {
    intermediate: Point,
    reference: Point,
    axes: PerAxis<bool>,
    /// Whether at least one axis seeks its reference point at the end of the return.
    #[serde(rename = "seeks")]
    is_seeking: bool,
    frame: Option<Action>,
    step: u8,
}

impl ReferenceReturn {
    /// Plans the return of the programmed axes; `None` if the block names no axis.
    ///
    /// # Errors
    /// 012 for axis words that the code does not take, 043 for an intermediate point outside
    /// the stroke, 090 or 093 for an axis without a reference that cannot seek one.
    pub(crate) fn plan(
        state: &mut State,
        context: &BlockContext<'_>,
        route: ReturnRoute,
        axes: &AxisWords,
    ) -> Result<Option<Self>, Alarm> {
        let is_direct = route == ReturnRoute::Direct;
        if is_direct && axes.has_any() {
            let rule = say::return_with_axis_words();
            return Err(Alarm::new(number::TOO_MANY_WORDS).with_detail(rule));
        }
        if !matches!(route, ReturnRoute::Direct | ReturnRoute::NamedAxes) && !axes.has_any() {
            return Ok(None);
        }
        let is_named = route == ReturnRoute::NamedAxes;
        let moves_all_axes = is_direct || (is_named && !axes.has_any());
        let is_moved = |target| moves_all_axes || target != AxisTarget::None;
        let moved_axes = PerAxis::new(is_moved(axes.x), is_moved(axes.z));
        let referenced = context.referenced;
        let sought_axes =
            PerAxis::new(moved_axes.x && !referenced.x, moved_axes.z && !referenced.z);
        for (axis, name) in [(Axis::X, "X"), (Axis::Z, "Z")] {
            let cannot_seek = !route.can_seek() || !context.parameters.has_zero_switch(axis);
            if *sought_axes.get(axis) && cannot_seek {
                let number = match route {
                    ReturnRoute::MachineZero | ReturnRoute::NamedAxes => number::ZERO_UNDEFINED,
                    ReturnRoute::Parameters | ReturnRoute::Direct => number::ZERO_RETURN,
                };
                return Err(Alarm::new(number).with_detail(say::zero_undefined_of_axis(name)));
            }
        }
        let via = match is_named {
            true => state.position,
            false => positioning::check_stroke(
                axes.resolve_end(state.position),
                context.coordinate_range(),
            )?,
        };
        let intermediate = state.to_machine(via);
        let mut reference = intermediate;
        let before = (state.zero, state.offset);
        for (axis, number) in [
            (Axis::X, parameter::X_AT_REFERENCE),
            (Axis::Z, parameter::Z_AT_REFERENCE),
        ] {
            if !*moved_axes.get(axis) {
                continue;
            }
            if !*sought_axes.get(axis) {
                let target = match route {
                    ReturnRoute::MachineZero | ReturnRoute::NamedAxes => 0,
                    ReturnRoute::Parameters | ReturnRoute::Direct => {
                        find_reference_point(context.model, axis)
                    }
                };
                reference.set(axis, target);
            }
            state.offset.set(axis, 0);
            *state.untravelled.get_mut(axis) = false;
            if route.can_seek() && context.parameters.reference_sets_coordinates() {
                // The parameters count in 0.001 mm, or in 0.0001 inch (004.0 SCW).
                let increment = if context.parameters.is_inch_machine() {
                    UNITS_PER_MM * 254 / 100_000
                } else {
                    UNITS_PER_MM / 1000
                };
                let coordinate = i64::from(context.parameters.value(number)) * increment;
                let factor = if axis == Axis::X { context.x_factor } else { 1 };
                state.zero.set(axis, -coordinate * factor);
                state.zero_offset.set(axis, 0);
            }
        }
        if state.offset == ExactPoint::default() {
            // The nose radius stays in force: the compensation acts again with the next move.
            state.modal.offset = 0;
        }
        state.set_machine_position(reference);
        let is_seeking = sought_axes.x || sought_axes.z;
        let has_new_frame = !is_seeking && before != (state.zero, state.offset);
        let frame = has_new_frame.then(|| Action::Frame {
            frame: state.frame(),
            program_zero: None,
            relative: route.can_seek()
                && context.parameters.reference_sets_coordinates()
                && context.parameters.g50_sets_relative(),
        });
        Ok(Some(Self {
            intermediate: intermediate.to_point(),
            reference: reference.to_point(),
            axes: moved_axes,
            is_seeking,
            frame,
            step: u8::from(is_direct || is_named),
        }))
    }

    pub(crate) fn next_action(&mut self) -> Option<PlannedAction> {
        let step = self.step;
        self.step = step.saturating_add(1);
        match step {
            0 => Some(PlannedAction::with_stop(Action::Rapid {
                to: self.intermediate,
            })),
            1 => Some(PlannedAction::without_stop(Action::Rapid {
                to: self.reference,
            })),
            2 => {
                let PerAxis { x, z } = self.axes;
                Some(PlannedAction::without_stop(if self.is_seeking {
                    Action::ZeroReturn { x, z }
                } else {
                    Action::Referenced { x, z }
                }))
            }
            _ => self.frame.take().map(PlannedAction::without_stop),
        }
    }

    /// Whether an axis seeks its reference point, so that the coordinates are known only when
    /// the return is finished.
    pub(crate) const fn is_seeking(&self) -> bool {
        self.is_seeking
    }

    pub(crate) fn is_done(&self) -> bool {
        self.step > 2 && self.frame.is_none()
    }
}
