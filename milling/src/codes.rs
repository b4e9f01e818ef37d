//! Executes the codes of group 00, scaling and rotation.

use gsk_core::alarm::{Alarm, number};
use gsk_core::program::{ProgramBlock, WordNumber};
use gsk_messages::{Message, say};

use crate::memory::{MillOffsetColumn, MillOffsetMemory, parameter};
use crate::modal::{LengthOffset, MillMotion};
use crate::path::travel::{RunContext, StepKind, settle_rotation, target};
use crate::space::{AxisValues, Length, MillAxis, MillPosition, PlanePoint};
use crate::state::MillState;
use crate::transform::{Rotation, Scaling};
use crate::words::{BlockWords, OneShotCode, length};

fn alarm(number: u16, detail: Message) -> Alarm {
    Alarm::new(number).with_detail(detail)
}

/// Executes a code that acts only in its block (group 00). Returns whether it moves an axis.
pub(crate) fn execute_one_shot(
    code: OneShotCode,
    state: &mut MillState,
    words: &BlockWords,
    context: &mut RunContext<'_, '_>,
) -> Result<bool, Alarm> {
    let returns = matches!(
        code,
        OneShotCode::ReferenceCheck
            | OneShotCode::Reference
            | OneShotCode::ReferenceBack
            | OneShotCode::FurtherReference
            | OneShotCode::Coordinates
    );
    if returns && !state.transform.is_none() {
        return Err(alarm(number::BAD_G, say::mill_transform_on()));
    }
    match code {
        OneShotCode::Dwell => return dwell(state, words, context).map(|()| false),
        OneShotCode::OffsetInput => return offset_input(state, words, context).map(|()| false),
        OneShotCode::ReferenceCheck => check_reference(state, words, context)?,
        OneShotCode::Reference => return_to_reference(0, state, words, context)?,
        OneShotCode::FurtherReference => {
            let p = words.letters.p.map_or(2, WordNumber::integer);
            if !(2..=4).contains(&p) {
                return Err(alarm(number::OUT_OF_RANGE, say::mill_reference_number(p)));
            }
            return_to_reference(p as u16 - 1, state, words, context)?;
        }
        OneShotCode::ReferenceBack => return_from_reference(state, words, context)?,
        OneShotCode::Skip => move_until_skip(state, words, context)?,
        OneShotCode::Measure => measure_tool(state, words, context)?,
        OneShotCode::Local => {
            set_local(state, words, context);
            return Ok(false);
        }
        OneShotCode::Machine => move_in_machine_coordinates(state, words, context)?,
        OneShotCode::Coordinates => {
            set_coordinates(state, words, context);
            return Ok(false);
        }
    }
    state.resync(context.memory);
    Ok(words.has_axes())
}

/// Executes G27: moves at rapid to the reference point and checks the position.
fn check_reference(
    state: &mut MillState,
    words: &BlockWords,
    context: &mut RunContext<'_, '_>,
) -> Result<(), Alarm> {
    let programmed = target(state, words);
    let to = state.to_machine(programmed, context.memory);
    context.go(state, to, StepKind::Rapid, true)?;
    let reference = context.memory.point(parameter::REFERENCE);
    let reference = state.axes.wrapped(reference);
    for axis in named_axes(words) {
        let (at, point) = (state.machine.get(axis), reference.get(axis));
        if at != point {
            let name = state.axes.letter(axis);
            let (at, point) = (at.mm(), point.mm());
            let detail = say::mill_not_at_reference(name, at, point);
            return Err(alarm(number::ZERO_RETURN, detail));
        }
    }
    keep_or_cancel_length(state, context);
    Ok(())
}

/// Executes G29: moves over the intermediate point of the last return to the programmed point.
fn return_from_reference(
    state: &mut MillState,
    words: &BlockWords,
    context: &mut RunContext<'_, '_>,
) -> Result<(), Alarm> {
    let programmed = target(state, words);
    let end = programmed + state.frame(context.memory);
    let intermediate = state.intermediate;
    rapid_to_point(state, words, &intermediate, context)?;
    rapid_to_point(state, words, &end, context)
}

/// Executes G31: moves until a signal. Without one the move ends at its programmed point.
fn move_until_skip(
    state: &mut MillState,
    words: &BlockWords,
    context: &mut RunContext<'_, '_>,
) -> Result<(), Alarm> {
    settle_rotation(state, context.memory);
    let programmed = target(state, words);
    let to = state.to_machine(programmed, context.memory);
    let kind = if context.memory.bit(parameter::SKIP, 2) {
        StepKind::CutAt(context.memory.speed(parameter::SKIP_FEED))
    } else {
        StepKind::Cut
    };
    context.go(state, to, kind, true)?;
    state.skipped = state.work(context.memory);
    Ok(())
}

/// Executes G52: sets the local coordinate system.
fn set_local(state: &mut MillState, words: &BlockWords, context: &RunContext<'_, '_>) {
    for axis in named_axes(words) {
        let value = words.letters.axes.get(axis);
        let value = value.map(|it| state.axis_value(axis, it));
        let before = if state.modal.incremental {
            state.local.get(axis)
        } else {
            Length::ZERO
        };
        state.local.set(axis, before + value.unwrap_or_default());
    }
    state.resync(context.memory);
}

/// Executes G53: moves in machine coordinates.
fn move_in_machine_coordinates(
    state: &mut MillState,
    words: &BlockWords,
    context: &mut RunContext<'_, '_>,
) -> Result<(), Alarm> {
    if state.modal.incremental {
        return Err(alarm(number::BAD_G, say::mill_machine_incremental()));
    }
    let mut to = state.machine;
    for axis in named_axes(words) {
        let value = words.letters.axes.get(axis);
        let value = value
            .map(|it| state.axis_value(axis, it))
            .unwrap_or_default();
        let from = state.machine.get(axis);
        to.set(axis, state.axes.towards(axis, from, value));
    }
    let kind = match state.modal.motion {
        MillMotion::Rapid => StepKind::Rapid,
        _ => StepKind::Cut,
    };
    context.go(state, to, kind, true)?;
    keep_or_cancel_length(state, context);
    Ok(())
}

/// Executes G92: shifts the work coordinates so that the position has the programmed values.
fn set_coordinates(state: &mut MillState, words: &BlockWords, context: &RunContext<'_, '_>) {
    let work = state.work(context.memory);
    for axis in named_axes(words) {
        let value = words.letters.axes.get(axis);
        let value = value.map(|it| state.axis_value(axis, it));
        let by = work.get(axis) - value.unwrap_or_default();
        state.shift.set(axis, state.shift.get(axis) + by);
    }
    state.resync(context.memory);
}

/// Moves at rapid to a point in machine coordinates, in the axes of the block.
fn rapid_to_point(
    state: &mut MillState,
    words: &BlockWords,
    point: &MillPosition,
    context: &mut RunContext<'_, '_>,
) -> Result<(), Alarm> {
    let mut to = state.machine;
    for axis in named_axes(words) {
        let from = to.get(axis);
        to.set(axis, state.axes.nearest(axis, from, point.get(axis)));
    }
    context.go(state, to, StepKind::Rapid, true)
}

/// Returns the axes that have a word in the block.
fn named_axes(words: &BlockWords) -> impl Iterator<Item = MillAxis> {
    let axes = words.letters.axes;
    MillAxis::ALL
        .into_iter()
        .filter(move |axis| axes.get(*axis).is_some())
}

fn dwell(
    state: &MillState,
    words: &BlockWords,
    context: &mut RunContext<'_, '_>,
) -> Result<(), Alarm> {
    let seconds = match (words.letters.p, words.letters.axes.get(MillAxis::X)) {
        (Some(ms), _) => ms.value() / 1000.0,
        (None, Some(seconds)) => seconds.value(),
        (None, None) => 0.0,
    };
    if seconds < 0.0 {
        return Err(alarm(number::OUT_OF_RANGE, say::mill_dwell_negative()));
    }
    context.dwell(state, seconds)
}

/// Executes G10: writes the length, radius or one of their wears into the tool offset memory.
fn offset_input(
    state: &MillState,
    words: &BlockWords,
    context: &mut RunContext<'_, '_>,
) -> Result<(), Alarm> {
    let letters = &words.letters;
    let memory = context.memory.offset_memory;
    let column = match (memory, letters.l.map(WordNumber::integer)) {
        (MillOffsetMemory::A, None) | (MillOffsetMemory::B | MillOffsetMemory::C, Some(10)) => {
            MillOffsetColumn::Length
        }
        (MillOffsetMemory::B | MillOffsetMemory::C, Some(11)) => MillOffsetColumn::LengthWear,
        (MillOffsetMemory::C, Some(12)) => MillOffsetColumn::Radius,
        (MillOffsetMemory::C, Some(13)) => MillOffsetColumn::RadiusWear,
        _ => return Err(alarm(number::OUT_OF_RANGE, say::mill_offset_input_l())),
    };
    let (Some(p), Some(r)) = (letters.p, letters.r) else {
        return Err(alarm(number::OUT_OF_RANGE, say::mill_offset_input_words()));
    };
    let p = p.integer();
    let inch = state.modal.inch;
    let mut value = length(r, inch);
    if state.modal.incremental {
        let mut before = u16::try_from(p)
            .map(|it| context.memory.offset(it))
            .unwrap_or_default();
        value = value + *before.column(column);
    }
    context.memory.set_offset(p, column, value, inch)
}

/// Executes G28 and G30: moves over the intermediate point to reference point `index`.
fn return_to_reference(
    index: u16,
    state: &mut MillState,
    words: &BlockWords,
    context: &mut RunContext<'_, '_>,
) -> Result<(), Alarm> {
    let programmed = target(state, words);
    let by = state.to_machine(programmed, context.memory);
    let reference = context.memory.point(parameter::REFERENCE + index);
    let mut intermediate_point = state.machine;
    for axis in named_axes(words) {
        intermediate_point.set(axis, by.get(axis));
        state.intermediate.set(axis, by.get(axis));
    }
    context.go(state, intermediate_point, StepKind::Rapid, true)?;
    rapid_to_point(state, words, &reference, context)?;
    if index == 0 {
        for axis in named_axes(words) {
            context.tracker.set_homed(axis);
        }
    }
    if context.memory.bit(parameter::LOCAL, 0) {
        for axis in named_axes(words) {
            state.local.set(axis, Length::ZERO);
        }
    }
    keep_or_cancel_length(state, context);
    Ok(())
}

/// Cancels the length offset after a reference return or G53, unless 013.7 keeps it.
fn keep_or_cancel_length(state: &mut MillState, context: &RunContext<'_, '_>) {
    if !context.memory.bit(parameter::LENGTHS, 7) {
        state.modal.length = LengthOffset::Off;
        state.length = Length::ZERO;
    }
}

/// Executes G37: moves at rapid to a short distance before the point, then at the feed of
/// 5040. The preview takes the signal to come at the point.
fn measure_tool(
    state: &mut MillState,
    words: &BlockWords,
    context: &mut RunContext<'_, '_>,
) -> Result<(), Alarm> {
    let mut axes = named_axes(words);
    let (Some(axis), None) = (axes.next(), axes.next()) else {
        return Err(alarm(number::OUT_OF_RANGE, say::mill_measure_axis()));
    };
    let programmed = target(state, words);
    let to = state.to_machine(programmed, context.memory);
    let before = context.memory.length(parameter::MEASURE_BEFORE);
    let forward = to.get(axis) > state.machine.get(axis);
    let mut near = to;
    near.set(axis, to.get(axis) + if forward { -before } else { before });
    context.go(state, near, StepKind::Rapid, true)?;
    let feed = context.memory.speed(parameter::MEASURE_FEED);
    context.go(state, to, StepKind::CutAt(feed), true)
}

/// The greatest scale: P of G51 and parameter 5411, in the unit of 60036.7.
const MAX_SCALE: i64 = 99_999_999;
/// The greatest scale of an axis (I, J, K): 9.999, or 9.99999 in units of 0.00001.
const AXIS_SCALE: [i64; 2] = [9999, 999_999];
/// The greatest angle of rotation (R of G68), degrees.
const MAX_ANGLE: f64 = 360.0;

/// Starts scaling about a point (G51).
pub(crate) fn start_scaling(
    state: &mut MillState,
    block: &ProgramBlock,
    words: &BlockWords,
    context: &RunContext<'_, '_>,
) -> Result<(), Alarm> {
    let letters = &words.letters;
    let codes = block.g_codes().count();
    let by_axis = letters.center.0.iter().any(Option::is_some);
    let each = context.memory.bit(parameter::TRANSFORM, 4);
    if codes > 1 || !block.has_only(b"GXYZPIJK") || (by_axis && !each) {
        let detail = say::mill_scaling_alone();
        return Err(alarm(number::TOO_MANY_WORDS, detail));
    }
    if letters.center.0.iter().flatten().any(|it| it.has_point()) {
        return Err(alarm(number::BAD_POINT, say::mill_scale_with_point()));
    }
    let fine = context.memory.bit(parameter::SCALE_UNIT, 7);
    let factor = |units: i64| units as f64 * if fine { 0.000_01 } else { 0.001 };
    // 562.0 to 562.2: whether X, Y and Z are scaled.
    let is_scaled = |axis: MillAxis| context.memory.bit(parameter::TRANSFORM, axis as u8);
    let units = |axis: MillAxis| {
        let own = || {
            context
                .memory
                .value(parameter::axis_parameter(parameter::AXIS_SCALE, axis))
                .into()
        };
        letters
            .center
            .get(axis)
            .map_or_else(own, WordNumber::integer)
    };
    let of_all = match letters.p {
        Some(p) if !by_axis => Some(p.integer()),
        None if !each => Some(context.memory.value(parameter::SCALE).into()),
        _ => None,
    };
    let written = match of_all {
        Some(units) => [units; 3],
        None => MillAxis::BASIC.map(units),
    };
    let greatest = match of_all {
        Some(_) => MAX_SCALE,
        None => AXIS_SCALE[usize::from(fine)],
    };
    let scaled = MillAxis::BASIC.into_iter().zip(written);
    for (_, units) in scaled.filter(|(axis, _)| is_scaled(*axis)) {
        if units == 0 {
            return Err(alarm(number::OUT_OF_RANGE, say::mill_scale_nothing()));
        }
        let negative = of_all.is_some() && units < 0;
        if negative || units.abs() > greatest {
            let detail = say::mill_scale_out_of_range(units, greatest);
            return Err(alarm(number::OUT_OF_RANGE, detail));
        }
    }
    let factors = MillAxis::BASIC.map(|axis| match is_scaled(axis) {
        true => factor(written[axis as usize]),
        false => 1.0,
    });
    let mut center = state.work(context.memory);
    for axis in named_axes(words) {
        let value = words
            .letters
            .axes
            .get(axis)
            .map(|it| length(it, state.modal.inch));
        center.set(axis, value.unwrap_or_default());
    }
    state.transform.scaling = Some(Scaling {
        center,
        factors: AxisValues::basic(factors, 1.0),
    });
    state.resync(context.memory);
    Ok(())
}

/// Starts a rotation about a point (G68).
pub(crate) fn start_rotation(
    state: &mut MillState,
    words: &BlockWords,
    context: &RunContext<'_, '_>,
) -> Result<(), Alarm> {
    if state.transform.scaling.is_some() && context.cutter.is_on() {
        return Err(alarm(number::BAD_G, say::mill_rotation_in_compensation()));
    }
    let plane = state.modal.plane;
    let [first, second, _] = plane.axes();
    let work = state.work(context.memory);
    let inch = state.modal.inch;
    let before = state.transform.rotation;
    // A programmed centre is scaled. The tool position is scaled already.
    let along = |axis: MillAxis| match words.letters.axes.get(axis) {
        Some(value) => {
            let mut point = work;
            point.set(axis, length(value, inch));
            state.transform.scaled(point)[axis as usize]
        }
        None => work.get(axis).mm(),
    };
    let center = PlanePoint::new(along(first), along(second));
    let angle = match words.letters.r {
        Some(r) => r.value(),
        None => f64::from(context.memory.value(parameter::ANGLE)) / 1000.0,
    };
    if angle.abs() > MAX_ANGLE {
        let detail = say::mill_angle_out_of_range(angle);
        return Err(alarm(number::OUT_OF_RANGE, detail));
    }
    let adds = context.memory.bit(parameter::TRANSFORM, 7) && state.modal.incremental;
    let programmed = match before {
        Some(before) if adds => before.programmed + angle,
        _ => angle,
    };
    state.transform.rotation = Some(Rotation {
        plane,
        center,
        degrees: if state.transform.mirrors(plane) {
            -programmed
        } else {
            programmed
        },
        programmed,
        tool_at_start: Some(work.flat(plane)),
    });
    state.resync(context.memory);
    Ok(())
}
