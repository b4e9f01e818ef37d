//! G71 and G72: roughing along Z or along X (manual I-3.2.6.1, I-3.2.6.2).
//!
//! ```text
//!   X ^  C'___                       A'    1 rapid A -> A' (the allowances)
//!     |       \___________4_/___5___>|     2 infeed Δd, then Δd + e
//!     |        \____3_______/        | 2   3 cut to the contour
//!     |  contour \____________/      v     4 back at 45° by e, 5 rapid to Z_A'
//!     |            \                       6 next level X_A' ± 2Δd·n, …, at last
//!     |             B'                     7 the whole contour, 8 rapid to A
//!     +--------------------------------> Z   G72: the same with X and Z exchanged
//! ```

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::command::Action;
use crate::interpreter::codes::positioning::{check_stroke, current_feed};
use crate::interpreter::context::BlockContext;
use crate::interpreter::cycles::contour::{ContourPoint, CutDirections, CutPlane, find_cut_end};
use crate::interpreter::exact::{CoordinateRange, ExactPoint, UNITS_PER_MM, to_mm};
use crate::interpreter::moves::explanation::{
    Explanation, PassNote, axis_letter, depth_mm, formula_message,
};
use crate::interpreter::moves::{FrameShift, Move};
use crate::interpreter::parameter_writes::ParameterWrites;
use crate::interpreter::profile::{
    self, Profile, ProfileRange, ProfileSegment, StepShape, start_alarm,
};
use crate::interpreter::state::State;
use crate::interpreter::words::SortedWords;
use crate::memory::parameter;
use crate::units::{Axis, Feed, Point};

/// Number of half units of [`ExactPoint`] in a thousandth of a millimetre.
const HALF_UNITS_PER_MICRON: i64 = 2 * UNITS_PER_MM / 1000;

/// Names the next move of a roughing cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum RoughingPhase {
    Approach,
    Infeed,
    Cut,
    Escape { along: i64 },
    Return,
    Entry,
    Contour { step: usize },
    Done,
}

/// The remaining moves of a G71 or G72.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RoughingCycle {
    #[serde(rename = "view")]
    plane: CutPlane,
    #[serde(rename = "signs")]
    directions: CutDirections,
    /// Point A, from which the levels are measured.
    start: ExactPoint,
    /// Point B, at which the contour begins.
    begin: ExactPoint,
    /// The point to which the tool returns: A without the allowances.
    #[serde(rename = "rest")]
    return_point: ExactPoint,
    /// The steps of the contour from B to the end C.
    steps: Vec<ProfileSegment>,
    /// Shift from programmed to machine coordinates.
    #[serde(rename = "home")]
    frame_shift: FrameShift,
    /// Shift from programmed to machine coordinates plus the finishing allowances.
    #[serde(rename = "shift")]
    contour_shift: FrameShift,
    allowance: ExactPoint,
    /// Whether the first block of the profile (ns) is a rapid, so that the infeeds are rapids.
    #[serde(rename = "rapid")]
    is_infeed_rapid: bool,
    feed: Feed,
    /// Δd, the depth of cut, in half units of [`ExactPoint`].
    cut: i64,
    /// e, the retract after a cut, in half units of [`ExactPoint`].
    escape: i64,
    /// Number of the current level, from 1; `levels` is the number of the contour pass, the
    /// last one.
    level: i64,
    levels: i64,
    phase: RoughingPhase,
}

/// Stores the data of a G71 or G72 without P and Q: Δd and e into parameters 051 and 052.
///
/// # Errors
/// 062 for a depth that is not positive or a negative retract.
pub(crate) fn store_data(
    plane: CutPlane,
    words: &SortedWords,
    writes: &mut ParameterWrites,
) -> Result<(), Alarm> {
    let (depth, name) = match plane {
        CutPlane::Turning => (words.u, "U(Δd)"),
        CutPlane::Facing => (words.w, "W(Δd)"),
    };
    if let Some(depth) = depth {
        if depth <= 0 {
            return Err(roughing_alarm(say::cycle_depth_not_positive(
                name,
                to_mm(depth),
            )));
        }
        writes.push_length(parameter::ROUGHING_DEPTH, depth);
    }
    store_retract(words, writes)
}

/// Stores the retract, R(e), which either block of the cycle may contain, into parameter 052.
/// Returns an alarm as error if it is negative.
fn store_retract(words: &SortedWords, writes: &mut ParameterWrites) -> Result<(), Alarm> {
    if let Some(retract) = words.r {
        if retract < 0 {
            return Err(roughing_alarm(say::cycle_retract_negative(to_mm(retract))));
        }
        writes.push_length(parameter::ROUGHING_RETRACT, retract);
    }
    Ok(())
}

/// Plans the G71 or G72 over the profile `range`; U and W are the finishing allowances.
///
/// # Errors
/// 062 for a missing depth, 043 for a point outside the stroke, and the alarms of the profile.
pub(crate) fn plan_cycle(
    plane: CutPlane,
    state: &State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    range: ProfileRange,
    writes: &mut ParameterWrites,
) -> Result<RoughingCycle, Alarm> {
    store_retract(words, writes)?;
    let parameter = |number| i64::from(writes.value_after(number, context.parameters));
    let (cut, escape) = (
        parameter(parameter::ROUGHING_DEPTH) * HALF_UNITS_PER_MICRON,
        parameter(parameter::ROUGHING_RETRACT) * HALF_UNITS_PER_MICRON,
    );
    let allowance = ExactPoint::new(
        words.u.unwrap_or(0).saturating_mul(context.x_factor),
        words.w.unwrap_or(0),
    );
    let levels = RoughingLevels {
        cut,
        escape,
        allowance,
        origin: ExactPoint::default(),
    };
    plan_levels(plane, state, context, range, &levels)
}

/// Plans the G71 or G72 of the Huaxing lathes over the next N blocks. The levels count from
/// the current position, without the allowances. I is the depth of cut, a diameter in G71; K
/// is the retract of the slide.
///
/// # Errors
/// As for [`plan_cycle`].
pub(crate) fn plan_counted(
    plane: CutPlane,
    state: &State,
    context: &BlockContext<'_>,
    words: &SortedWords,
) -> Result<RoughingCycle, Alarm> {
    let range = profile::find_following_range(context, words)?;
    let cut = match (words.i.map(i64::abs), plane) {
        (None | Some(0), _) => return Err(roughing_alarm(say::cycle_depth_missing())),
        (Some(depth), CutPlane::Turning) => depth,
        (Some(depth), CutPlane::Facing) => depth.saturating_mul(2),
    };
    let allowance = ExactPoint::new(words.x.unwrap_or(0), words.z.unwrap_or(0));
    let levels = RoughingLevels {
        cut,
        escape: words.k.unwrap_or(0).abs().saturating_mul(2),
        allowance,
        origin: ExactPoint::default() - allowance,
    };
    plan_levels(plane, state, context, range, &levels)
}

/// Depth of cut, retract, allowances and origin of the levels of a roughing cycle.
struct RoughingLevels {
    /// Δd, the depth of cut, in half units of [`ExactPoint`].
    cut: i64,
    /// e, the retract after a cut, in half units of [`ExactPoint`].
    escape: i64,
    allowance: ExactPoint,
    /// Point from which the levels count, relative to A, without the allowances.
    origin: ExactPoint,
}

/// Plans a roughing cycle over the blocks `range`. Returns an alarm as error if the depth of cut or
/// the feed is missing, or the profile breaks a rule.
fn plan_levels(
    plane: CutPlane,
    state: &State,
    context: &BlockContext<'_>,
    range: ProfileRange,
    levels: &RoughingLevels,
) -> Result<RoughingCycle, Alarm> {
    let cut = levels.cut;
    if cut <= 0 {
        return Err(roughing_alarm(say::cycle_depth_missing()));
    }
    let feed = current_feed(&state.modal)?;
    let profile = profile::evaluate_profile(state, context, range)?;
    check_entry(plane, &profile)?;
    if range.is_after_cycle {
        check_no_rapid(&profile)?;
    }
    let directions = CutDirections::from_profile(plane, &profile)?;
    let return_point = profile.start;
    let profile = Profile {
        start: profile.start + levels.origin,
        ..profile
    };
    let (a, b) = (
        plane.to_plane(profile.start),
        plane.to_plane(profile.begin_point()),
    );
    let distance = (b.depth - a.depth).abs();
    let frame_shift = FrameShift::from_state(state);
    let roughing = RoughingCycle {
        plane,
        directions,
        start: profile.start,
        return_point,
        begin: profile.begin_point(),
        frame_shift,
        contour_shift: frame_shift.moved(levels.allowance),
        allowance: levels.allowance,
        is_infeed_rapid: matches!(profile.entry.shape, StepShape::Straight { rapid: true }),
        feed,
        cut,
        escape: levels.escape,
        level: 1,
        levels: (distance + cut - 1) / cut,
        phase: RoughingPhase::Approach,
        steps: profile.steps,
    };
    roughing.check_stroke(context.coordinate_range())?;
    Ok(roughing)
}

/// Checks that the first block of the profile (ns) moves only the axis of the levels; alarm
/// 065 if not.
fn check_entry(plane: CutPlane, profile: &Profile) -> Result<(), Alarm> {
    let (a, b) = (
        plane.to_plane(profile.start),
        plane.to_plane(profile.begin_point()),
    );
    if a.along == b.along {
        return Ok(());
    }
    Err(start_alarm(match plane {
        CutPlane::Turning => say::profile_begin_moves_z(),
        CutPlane::Facing => say::profile_begin_moves_x(),
    }))
}

/// Checks that a contour of the Huaxing lathes has no G00 after its first block; alarm 065 if
/// it has.
fn check_no_rapid(profile: &Profile) -> Result<(), Alarm> {
    let mut steps = profile.steps.iter();
    match steps.find(|step| step.shape == StepShape::Straight { rapid: true }) {
        Some(rapid) => Err(start_alarm(say::profile_rapid_inside(rapid.line))),
        None => Ok(()),
    }
}

impl RoughingCycle {
    fn check_stroke(&self, reach: CoordinateRange<'_>) -> Result<(), Alarm> {
        let end = self.steps.last().map_or(self.begin, |step| step.to);
        let start = self.plane.to_plane(self.start);
        let highest = self.plane.to_exact(ContourPoint {
            depth: start.depth + self.directions.depth * (self.cut - self.escape),
            ..start
        });
        for corner in [self.start, self.begin, end, highest] {
            check_stroke(corner + self.allowance, reach)?;
        }
        Ok(())
    }

    /// Depth coordinate of the current level, without the allowance, in half units of
    /// [`ExactPoint`].
    fn level_depth(&self) -> i64 {
        self.plane.to_plane(self.start).depth + self.directions.depth * self.cut * self.level
    }

    /// Depth coordinate after the retract from the current level, in half units of
    /// [`ExactPoint`].
    fn escape_depth(&self) -> i64 {
        self.level_depth() - self.directions.depth * self.escape
    }

    fn pass_note(&self) -> PassNote {
        let axis = self.plane.depth_axis();
        if self.level >= self.levels {
            return PassNote::Contour {
                axis,
                levels: self.levels,
                allowance: self.allowance,
            };
        }
        // Half units are diameters of X and halves of Z.
        let to_programmed = |depth: i64| match axis {
            Axis::X => depth,
            Axis::Z => depth / 2,
        };
        let allowance = self.allowance.get(axis);
        PassNote::Level {
            axis,
            number: self.level,
            levels: self.levels,
            from: self.start.get(axis) + allowance,
            step: to_programmed(self.directions.depth * self.cut),
            last: self.begin.get(axis) + allowance,
        }
    }

    fn machine_point(&self, depth: i64, along: i64) -> Point {
        self.contour_shift
            .to_machine(self.plane.to_exact(ContourPoint { depth, along }))
    }

    /// The move after a level: the next infeed, or the entry of the contour pass.
    fn phase_after_level(&self) -> RoughingPhase {
        if self.level < self.levels {
            RoughingPhase::Infeed
        } else {
            RoughingPhase::Entry
        }
    }

    pub(crate) fn next_move(&mut self) -> Option<Move> {
        let note = self.pass_note();
        let start = self.plane.to_plane(self.start);
        let line = |to| Move::line(to, self.feed, note);
        let (next_move, next_phase) = match self.phase {
            RoughingPhase::Approach => (
                Move::rapid(self.contour_shift.to_machine(self.start), note),
                self.phase_after_level(),
            ),
            RoughingPhase::Infeed => {
                let to = self.machine_point(self.level_depth(), start.along);
                (self.infeed_move(to, note), RoughingPhase::Cut)
            }
            RoughingPhase::Cut => {
                let along = find_cut_end(
                    self.plane,
                    self.directions,
                    self.begin,
                    &self.steps,
                    self.level_depth(),
                );
                (
                    line(self.machine_point(self.level_depth(), along)),
                    RoughingPhase::Escape { along },
                )
            }
            RoughingPhase::Escape { along } => {
                let back = along - self.directions.along * self.escape;
                // Never beyond Z_A'.
                let back = match self.directions.along {
                    1 => back.max(start.along),
                    _ => back.min(start.along),
                };
                (
                    line(self.machine_point(self.escape_depth(), back)),
                    RoughingPhase::Return,
                )
            }
            RoughingPhase::Return => {
                let to = self.machine_point(self.escape_depth(), start.along);
                self.level += 1;
                (Move::rapid(to, note), self.phase_after_level())
            }
            RoughingPhase::Entry => {
                let to = self.contour_shift.to_machine(self.begin);
                (
                    self.infeed_move(to, note),
                    RoughingPhase::Contour { step: 0 },
                )
            }
            RoughingPhase::Contour { step } => match self.steps.get(step) {
                Some(contour_step) => (
                    step_move(contour_step, self.contour_shift, self.feed, note),
                    RoughingPhase::Contour { step: step + 1 },
                ),
                None => (
                    Move::rapid(self.frame_shift.to_machine(self.return_point), note),
                    RoughingPhase::Done,
                ),
            },
            RoughingPhase::Done => return None,
        };
        self.phase = next_phase;
        Some(next_move)
    }

    /// An infeed to `to`: a rapid if the first block of the profile (ns) is one, else a cut.
    fn infeed_move(&self, to: Point, note: PassNote) -> Move {
        if self.is_infeed_rapid {
            Move::rapid(to, note)
        } else {
            Move::line(to, self.feed, note)
        }
    }
}

/// Makes the move for one step of a contour that is shifted by `shift`, at the feed of the
/// cycle.
pub(crate) fn step_move(
    step: &ProfileSegment,
    shift: FrameShift,
    feed: Feed,
    note: PassNote,
) -> Move {
    let to = shift.to_machine(step.to);
    match step.shape {
        StepShape::Straight { .. } => Move::line(to, feed, note),
        StepShape::Arc { center, clockwise } => Move::from_action(
            Action::Arc {
                to,
                center: shift.center_to_machine(center),
                clockwise,
                feed,
            },
            note,
        ),
        StepShape::Dwell { ms } => Move::from_action(Action::Dwell { ms }, note),
    }
}

fn roughing_alarm(detail: Message) -> Alarm {
    Alarm::new(number::CYCLE_DATA).with_detail(detail)
}

/// Explains a level of G71 or G72; `None` for the note of another move.
pub(crate) fn explain_level(note: PassNote) -> Option<Explanation> {
    let PassNote::Level {
        axis,
        number,
        levels,
        from,
        step,
        last,
    } = note
    else {
        return None;
    };
    let level = from + step * number;
    let axis_name = axis_letter(axis);
    Some(Explanation {
        code: roughing_code(axis),
        pass: number.unsigned_abs(),
        passes: Some(levels.unsigned_abs()),
        level: Some(to_mm(level)),
        depth: depth_mm(axis, step * number).abs(),
        remaining: depth_mm(axis, last - level).abs(),
        formula: formula_message(format!(
            "{axis_name}{number} = {:.3} {:+.3}·{number} = {:.3}",
            to_mm(from),
            to_mm(step),
            to_mm(level)
        )),
        words: match axis {
            Axis::X => "U(Δd), 051",
            Axis::Z => "W(Δd), 051",
        },
    })
}

/// Explains the contour pass of G71 or G72; `None` for the note of another move.
pub(crate) fn explain_contour_pass(note: PassNote) -> Option<Explanation> {
    let PassNote::Contour {
        axis,
        levels,
        allowance,
    } = note
    else {
        return None;
    };
    Some(Explanation {
        code: roughing_code(axis),
        pass: levels.unsigned_abs(),
        passes: Some(levels.unsigned_abs()),
        level: None,
        depth: 0.0,
        remaining: 0.0,
        formula: say::explain_contour(to_mm(allowance.x), to_mm(allowance.z)),
        words: "U(Δu), W(Δw)",
    })
}

const fn roughing_code(axis: Axis) -> u8 {
    match axis {
        Axis::X => 71,
        Axis::Z => 72,
    }
}
