//! Executes the codes of group 00, scaling and rotation.

use gsk_core::alarm::{Alarm, number};
use gsk_core::program::{Block, Number};
use gsk_messages::{Message, say};

use crate::memory::{Column, parameter};
use crate::modal::{LengthOffset, Motion};
use crate::space::{Axis, Each, Flat, Length, Position};
use crate::state::State;
use crate::transform::{Rotation, Scaling};
use crate::travel::{Scene, Way, settle_rotation, target};
use crate::words::{OneShot, Words, length};

fn alarm(number: u16, detail: Message) -> Alarm {
    Alarm::new(number).because(detail)
}

/// Executes a code of group 00. Returns whether it moves an axis.
pub(crate) fn one_shot(
    code: OneShot,
    state: &mut State,
    words: &Words,
    scene: &mut Scene<'_, '_>,
) -> Result<bool, Alarm> {
    let returns = matches!(
        code,
        OneShot::ReferenceCheck
            | OneShot::Reference
            | OneShot::ReferenceBack
            | OneShot::FurtherReference
            | OneShot::Coordinates
    );
    if returns && !state.transform.is_none() {
        return Err(alarm(number::BAD_G, say::mill_transform_on()));
    }
    match code {
        OneShot::Dwell => return dwell(state, words, scene).map(|()| false),
        OneShot::OffsetInput => return offset_input(state, words, scene).map(|()| false),
        OneShot::ReferenceCheck => {
            let programmed = target(state, words);
            let to = state.place(programmed, scene.memory);
            scene.go(state, to, Way::Rapid, true)?;
            let reference = scene.memory.point(parameter::REFERENCE);
            let reference = state.axes.rolled(reference);
            for axis in named(words) {
                let (at, point) = (state.machine.get(axis), reference.get(axis));
                if at != point {
                    let name = state.axes.letter(axis);
                    let (at, point) = (at.mm(), point.mm());
                    let detail = say::mill_not_at_reference(name, at, point);
                    return Err(alarm(number::ZERO_RETURN, detail));
                }
            }
            keep_or_cancel_length(state, scene);
        }
        OneShot::Reference => reference(0, state, words, scene)?,
        OneShot::FurtherReference => {
            let p = words.letters.p.map_or(2, Number::integer);
            if !(2..=4).contains(&p) {
                return Err(alarm(number::OUT_OF_RANGE, say::mill_reference_number(p)));
            }
            reference(p as u16 - 1, state, words, scene)?;
        }
        OneShot::ReferenceBack => {
            let programmed = target(state, words);
            let end = programmed + state.frame(scene.memory);
            let intermediate = state.intermediate;
            to_point(state, words, &intermediate, scene)?;
            to_point(state, words, &end, scene)?;
        }
        OneShot::Skip => {
            // Without a signal the move ends at its programmed point.
            settle_rotation(state, scene.memory);
            let programmed = target(state, words);
            let to = state.place(programmed, scene.memory);
            let way = if scene.memory.bit(parameter::SKIP, 2) {
                Way::CutAt(scene.memory.value(parameter::SKIP_FEED).into())
            } else {
                Way::Cut
            };
            scene.go(state, to, way, true)?;
            state.skipped = state.work(scene.memory);
        }
        OneShot::Measure => measure(state, words, scene)?,
        OneShot::Local => {
            for axis in named(words) {
                let value = words.letters.axes.get(axis);
                let value = value.map(|it| state.word(axis, it));
                let before = if state.modal.incremental {
                    state.local.get(axis)
                } else {
                    Length::ZERO
                };
                state.local.set(axis, before + value.unwrap_or_default());
            }
            state.resync(scene.memory);
            return Ok(false);
        }
        OneShot::Machine => {
            if state.modal.incremental {
                return Err(alarm(number::BAD_G, say::mill_machine_incremental()));
            }
            let mut to = state.machine;
            for axis in named(words) {
                let value = words.letters.axes.get(axis);
                let value = value.map(|it| state.word(axis, it)).unwrap_or_default();
                let from = state.machine.get(axis);
                to.set(axis, state.axes.towards(axis, from, value));
            }
            let way = match state.modal.motion {
                Motion::Rapid => Way::Rapid,
                _ => Way::Cut,
            };
            scene.go(state, to, way, true)?;
            keep_or_cancel_length(state, scene);
        }
        OneShot::Coordinates => {
            let work = state.work(scene.memory);
            for axis in named(words) {
                let value = words.letters.axes.get(axis);
                let value = value.map(|it| state.word(axis, it));
                let by = work.get(axis) - value.unwrap_or_default();
                state.shift.set(axis, state.shift.get(axis) + by);
            }
            state.resync(scene.memory);
            return Ok(false);
        }
    }
    state.resync(scene.memory);
    Ok(words.has_axes())
}

/// Moves at rapid to a point in machine coordinates, in the axes of the block.
fn to_point(
    state: &mut State,
    words: &Words,
    point: &Position,
    scene: &mut Scene<'_, '_>,
) -> Result<(), Alarm> {
    let mut to = state.machine;
    for axis in named(words) {
        let from = to.get(axis);
        to.set(axis, state.axes.nearest(axis, from, point.get(axis)));
    }
    scene.go(state, to, Way::Rapid, true)
}

/// The axes that a block names.
fn named(words: &Words) -> impl Iterator<Item = Axis> {
    let axes = words.letters.axes;
    Axis::ALL
        .into_iter()
        .filter(move |axis| axes.get(*axis).is_some())
}

fn dwell(state: &State, words: &Words, scene: &mut Scene<'_, '_>) -> Result<(), Alarm> {
    let seconds = match (words.letters.p, words.letters.axes.get(Axis::X)) {
        (Some(ms), _) => ms.value() / 1000.0,
        (None, Some(seconds)) => seconds.value(),
        (None, None) => 0.0,
    };
    if seconds < 0.0 {
        return Err(alarm(number::OUT_OF_RANGE, say::mill_dwell_negative()));
    }
    scene.dwell(state, seconds)
}

/// G10, memory of type C: lengths and radii, each with its wear.
fn offset_input(state: &State, words: &Words, scene: &mut Scene<'_, '_>) -> Result<(), Alarm> {
    let letters = &words.letters;
    let column = match letters.l.map(Number::integer) {
        Some(10) => Column::Length,
        Some(11) => Column::LengthWear,
        Some(12) => Column::Radius,
        Some(13) => Column::RadiusWear,
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
            .map(|it| scene.memory.offset(it))
            .unwrap_or_default();
        value = value + *before.column(column);
    }
    scene.memory.set_offset(p, column, value, inch)
}

/// G28, G30: over the intermediate point to a reference point.
fn reference(
    index: u16,
    state: &mut State,
    words: &Words,
    scene: &mut Scene<'_, '_>,
) -> Result<(), Alarm> {
    let programmed = target(state, words);
    let by = state.place(programmed, scene.memory);
    let reference = scene.memory.point(parameter::REFERENCE + index);
    let mut over = state.machine;
    for axis in named(words) {
        over.set(axis, by.get(axis));
        state.intermediate.set(axis, by.get(axis));
    }
    scene.go(state, over, Way::Rapid, true)?;
    to_point(state, words, &reference, scene)?;
    if scene.memory.bit(parameter::LOCAL, 0) {
        for axis in named(words) {
            state.local.set(axis, Length::ZERO);
        }
    }
    keep_or_cancel_length(state, scene);
    Ok(())
}

/// A reference return and G53 cancel the length offset, unless 013.7 keeps it.
fn keep_or_cancel_length(state: &mut State, scene: &Scene<'_, '_>) {
    if !scene.memory.bit(parameter::LENGTHS, 7) {
        state.modal.length = LengthOffset::Off;
        state.length = Length::ZERO;
    }
}

/// G37: at rapid to a short distance before the point, then at the feed of 5040. The preview
/// takes the signal to come at the point.
fn measure(state: &mut State, words: &Words, scene: &mut Scene<'_, '_>) -> Result<(), Alarm> {
    let mut axes = named(words);
    let (Some(axis), None) = (axes.next(), axes.next()) else {
        return Err(alarm(number::OUT_OF_RANGE, say::mill_measure_axis()));
    };
    let programmed = target(state, words);
    let to = state.place(programmed, scene.memory);
    let before = scene.memory.length(parameter::MEASURE_BEFORE);
    let forward = to.get(axis) > state.machine.get(axis);
    let mut near = to;
    near.set(axis, to.get(axis) + if forward { -before } else { before });
    scene.go(state, near, Way::Rapid, true)?;
    let feed = scene.memory.value(parameter::MEASURE_FEED);
    scene.go(state, to, Way::CutAt(feed.into()), true)
}

/// The greatest P of G51, and of parameter 5411.
const SCALE_OF_ALL: i64 = 99_999_999;
/// The greatest I, J, K: 9.999, or 9.99999 in units of 0.00001.
const AXIS_SCALE: [i64; 2] = [9999, 999_999];
/// The greatest angle of G68, degrees.
const GREATEST_ANGLE: f64 = 360.0;

/// Executes G51.
pub(crate) fn scale(
    state: &mut State,
    block: &Block,
    words: &Words,
    scene: &Scene<'_, '_>,
) -> Result<(), Alarm> {
    let letters = &words.letters;
    let codes = block.g_codes().count();
    let by_axis = letters.center.0.iter().any(Option::is_some);
    let each = scene.memory.bit(parameter::TRANSFORM, 4);
    if codes > 1 || !block.has_only(b"GXYZPIJK") || (by_axis && !each) {
        let detail = say::mill_scaling_alone();
        return Err(alarm(number::TOO_MANY_WORDS, detail));
    }
    if letters.center.0.iter().flatten().any(|it| it.has_point()) {
        return Err(alarm(number::BAD_POINT, say::mill_scale_with_point()));
    }
    let fine = scene.memory.bit(parameter::SCALE_UNIT, 7);
    let factor = |units: i64| units as f64 * if fine { 0.000_01 } else { 0.001 };
    // 562.0 to 562.2: whether X, Y and Z are scaled.
    let is_scaled = |axis: Axis| scene.memory.bit(parameter::TRANSFORM, axis as u8);
    let units = |axis: Axis| {
        let own = || {
            scene
                .memory
                .value(parameter::of(parameter::AXIS_SCALE, axis))
                .into()
        };
        letters.center.get(axis).map_or_else(own, Number::integer)
    };
    let of_all = match letters.p {
        Some(p) if !by_axis => Some(p.integer()),
        None if !each => Some(scene.memory.value(parameter::SCALE).into()),
        _ => None,
    };
    let written = match of_all {
        Some(units) => [units; 3],
        None => Axis::BASIC.map(units),
    };
    let greatest = match of_all {
        Some(_) => SCALE_OF_ALL,
        None => AXIS_SCALE[usize::from(fine)],
    };
    let scaled = Axis::BASIC.into_iter().zip(written);
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
    let factors = Axis::BASIC.map(|axis| match is_scaled(axis) {
        true => factor(written[axis as usize]),
        false => 1.0,
    });
    let mut center = state.work(scene.memory);
    for axis in named(words) {
        let value = words
            .letters
            .axes
            .get(axis)
            .map(|it| length(it, state.modal.inch));
        center.set(axis, value.unwrap_or_default());
    }
    state.transform.scaling = Some(Scaling {
        center,
        factors: Each::basic(factors, 1.0),
    });
    state.resync(scene.memory);
    Ok(())
}

/// Executes G68.
pub(crate) fn rotate(state: &mut State, words: &Words, scene: &Scene<'_, '_>) -> Result<(), Alarm> {
    if state.transform.scaling.is_some() && scene.cutter.is_on() {
        return Err(alarm(number::BAD_G, say::mill_rotation_in_compensation()));
    }
    let plane = state.modal.plane;
    let [first, second, _] = plane.axes();
    let work = state.work(scene.memory);
    let inch = state.modal.inch;
    let before = state.transform.rotation;
    // A programmed centre is scaled. The tool position is scaled already.
    let along = |axis: Axis| match words.letters.axes.get(axis) {
        Some(value) => {
            let mut point = work;
            point.set(axis, length(value, inch));
            state.transform.scaled(point)[axis as usize]
        }
        None => work.get(axis).mm(),
    };
    let center = Flat::new(along(first), along(second));
    let angle = match words.letters.r {
        Some(r) => r.value(),
        None => f64::from(scene.memory.value(parameter::ANGLE)) / 1000.0,
    };
    if angle.abs() > GREATEST_ANGLE {
        let detail = say::mill_angle_out_of_range(angle);
        return Err(alarm(number::OUT_OF_RANGE, detail));
    }
    let adds = scene.memory.bit(parameter::TRANSFORM, 7) && state.modal.incremental;
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
        stood: Some(work.flat(plane)),
    });
    state.resync(scene.memory);
    Ok(())
}
