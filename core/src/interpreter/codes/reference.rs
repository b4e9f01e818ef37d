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
use crate::interpreter::context::Context;
use crate::interpreter::context::emission::Emission;
use crate::interpreter::context::exact::{Exact, PER_MM};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{AxisWords, Return, Target};
use crate::memory::parameter;
use crate::model::{ControlModel, ncb08};
use crate::units::{Axis, PerAxis, Point};

/// The reference point that the parameters of a model set, machine coordinates in units of
/// [`Exact`].
fn reference_point(model: &ControlModel, axis: Axis) -> i64 {
    let number = match axis {
        Axis::X => ncb08::REFERENCE_X,
        Axis::Z => ncb08::REFERENCE_Z,
    };
    i64::from(model.parameter(number)) * (PER_MM / 1000)
}

impl Return {
    /// Whether the return leads to machine zero, so that an axis without a reference seeks it.
    const fn seeks(self) -> bool {
        matches!(self, Self::MachineZero | Self::Named)
    }
}

/// A running return to the reference point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Reference {
    intermediate: Point,
    reference: Point,
    axes: PerAxis<bool>,
    /// Whether an axis seeks its reference point.
    #[serde(rename = "seeks")]
    seeks: bool,
    frame: Option<Action>,
    step: u8,
}

impl Reference {
    /// Plans the return of the programmed axes; `None` if the block names no axis.
    ///
    /// # Errors
    /// 012 for axis words that the code does not take, 043 for an I outside the stroke, 090 or
    /// 093 for an axis without a reference that cannot seek it.
    pub(crate) fn plan(
        state: &mut State,
        context: &Context<'_>,
        way: Return,
        axes: &AxisWords,
    ) -> Result<Option<Self>, Alarm> {
        let direct = way == Return::Direct;
        if direct && axes.any() {
            let rule = say::return_with_axis_words();
            return Err(Alarm::new(number::TOO_MANY_WORDS).because(rule));
        }
        if !matches!(way, Return::Direct | Return::Named) && !axes.any() {
            return Ok(None);
        }
        let named = way == Return::Named;
        let all = direct || (named && !axes.any());
        let takes = |target| all || target != Target::None;
        let moved = PerAxis::new(takes(axes.x), takes(axes.z));
        let referenced = context.referenced;
        let sought = PerAxis::new(moved.x && !referenced.x, moved.z && !referenced.z);
        for (axis, name) in [(Axis::X, "X"), (Axis::Z, "Z")] {
            let cannot_seek = !way.seeks() || !context.parameters.has_zero_switch(axis);
            if *sought.get(axis) && cannot_seek {
                let number = match way {
                    Return::MachineZero | Return::Named => number::ZERO_UNDEFINED,
                    Return::Parameters | Return::Direct => number::ZERO_RETURN,
                };
                return Err(Alarm::new(number).because(say::zero_undefined_of_axis(name)));
            }
        }
        let through = match named {
            true => state.position,
            false => positioning::within_stroke(axes.target(state.position), context.reach())?,
        };
        let intermediate = state.machine(through);
        let mut reference = intermediate;
        let before = (state.zero, state.offset);
        for (axis, number) in [
            (Axis::X, parameter::X_AT_REFERENCE),
            (Axis::Z, parameter::Z_AT_REFERENCE),
        ] {
            if !*moved.get(axis) {
                continue;
            }
            if !*sought.get(axis) {
                let at = match way {
                    Return::MachineZero | Return::Named => 0,
                    Return::Parameters | Return::Direct => reference_point(context.model, axis),
                };
                reference.set(axis, at);
            }
            state.offset.set(axis, 0);
            *state.untravelled.get_mut(axis) = false;
            if way.seeks() && context.parameters.reference_sets_coordinates() {
                // The parameters count in 0.001 mm, or in 0.0001 inch (004.0 SCW).
                let increment = if context.parameters.inch_machine() {
                    PER_MM * 254 / 100_000
                } else {
                    PER_MM / 1000
                };
                let coordinate = i64::from(context.parameters.value(number)) * increment;
                let factor = if axis == Axis::X { context.x_factor } else { 1 };
                state.zero.set(axis, -coordinate * factor);
                state.zero_offset.set(axis, 0);
            }
        }
        if state.offset == Exact::default() {
            // The nose radius stays in force: the compensation acts again with the next move.
            state.modal.offset = 0;
        }
        state.stand_at(reference);
        let seeks = sought.x || sought.z;
        let changes = !seeks && before != (state.zero, state.offset);
        let frame = changes.then(|| Action::Frame {
            frame: state.frame(),
            program_zero: None,
            relative: way.seeks()
                && context.parameters.reference_sets_coordinates()
                && context.parameters.g50_sets_relative(),
        });
        Ok(Some(Self {
            intermediate: intermediate.point(),
            reference: reference.point(),
            axes: moved,
            seeks,
            frame,
            step: u8::from(direct || named),
        }))
    }

    pub(crate) fn next(&mut self) -> Option<Emission> {
        let step = self.step;
        self.step = step.saturating_add(1);
        match step {
            0 => Some(Emission::stopping(Action::Rapid {
                to: self.intermediate,
            })),
            1 => Some(Emission::passing(Action::Rapid { to: self.reference })),
            2 => {
                let PerAxis { x, z } = self.axes;
                Some(Emission::passing(if self.seeks {
                    Action::ZeroReturn { x, z }
                } else {
                    Action::Referenced { x, z }
                }))
            }
            _ => self.frame.take().map(Emission::passing),
        }
    }

    /// Whether the coordinates are known only when the return is finished.
    pub(crate) const fn seeks(&self) -> bool {
        self.seeks
    }

    pub(crate) fn is_done(&self) -> bool {
        self.step > 2 && self.frame.is_none()
    }
}
