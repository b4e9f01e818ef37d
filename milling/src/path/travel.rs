//! Executes the motion of a block: its end points, and the steps of arcs and holes.

use gsk_core::alarm::{Alarm, number};
use gsk_core::command::SourcePosition;
use gsk_core::compensation::cutter::CutterSide;
use gsk_core::preview::PreviewProgress;
use gsk_core::program::WordNumber;
use gsk_core::units::Feed;
use gsk_messages::say;

use crate::cycles::{Drilling, HoleData, HoleLevel, HoleStep};
use crate::memory::{MillMemory, parameter};
use crate::modal::{Hole, MillMotion, SpindleState};
use crate::path::arc::{self, ArcDefinition};
use crate::path::cutter::CutterStream;
use crate::path::moves::{MillArc, MillMoveKind};
use crate::path::tracker::{PathStep, Tracker};
use crate::space::{Length, MillAxis, MillPosition, PlanePoint, sine_cosine};
use crate::state::{MillState, Polar};
use crate::words::{BlockWords, length};

/// The memory, compensation and path that the blocks of a run read and change, besides the modal
/// state.
pub(crate) struct RunContext<'a, 'b> {
    pub(crate) memory: &'a mut MillMemory,
    pub(crate) cutter: &'a mut CutterStream,
    pub(crate) tracker: &'a mut Tracker<'b>,
    pub(crate) source: SourcePosition,
    /// Whether the current block ends with an exact stop (G09).
    pub(crate) exact: bool,
    /// Asks the caller, before each repeated hole of a block, whether the run continues.
    pub(crate) progress_check: ProgressCheck<'a>,
}

/// Lets the caller stop a run within a block that makes many holes.
pub(crate) struct ProgressCheck<'a> {
    /// Progress callback; returns false to stop the run.
    pub(crate) on_progress: &'a mut ProgressCallback<'a>,
    /// Progress of the preview before the block.
    pub(crate) progress: PreviewProgress,
    /// Set once the caller has stopped the run.
    pub(crate) is_stopped: bool,
}

/// Progress callback; returns whether the run continues.
pub(crate) type ProgressCallback<'a> = dyn FnMut(&PreviewProgress) -> bool + 'a;

/// The kind of a straight step: cut, tap or thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum StepKind {
    Rapid,
    /// The step is a cut at the feed in force.
    Cut,
    /// The step is a cut at another feed, mm/min.
    CutAt(f64),
    /// The step is a tap, in or out, synchronised with the spindle.
    Tap {
        /// Whether the tap moves out of the hole.
        out: bool,
    },
    /// The step cuts a thread with this lead, mm.
    Thread(f64),
}

impl RunContext<'_, '_> {
    /// Asks the caller whether the run continues; returns false to make no more holes of the block.
    fn can_continue(&mut self) -> bool {
        let progress_check = &mut self.progress_check;
        progress_check.progress.moves = self.tracker.moves;
        progress_check.progress.time_s = self.tracker.now;
        progress_check.is_stopped |= !(progress_check.on_progress)(&progress_check.progress);
        !progress_check.is_stopped
    }

    /// Returns a step of this kind without motion, at the current position.
    fn step(&self, state: &MillState, kind: MillMoveKind) -> PathStep {
        PathStep {
            source: self.source,
            kind,
            to: state.machine,
            arc: None,
            feed: None,
            zero: state.zero(self.memory),
            frame: state.frame(self.memory),
            tool: state.modal.tool,
            speed: state.modal.speed,
            exact: self.exact || state.modal.exact_stop || self.memory.bit(parameter::CORNERS, 6),
            rigid_out: None,
            dwell_s: 0.0,
        }
    }

    /// Returns the feed of a tap. A rigid one moves out with the override of 5211.
    fn of_tap(&self, state: &MillState, out: bool, feed: Feed) -> Feed {
        let percent = match self.memory.value(parameter::TAP_OUT) {
            0 => 100,
            percent => percent,
        };
        if !out || !state.modal.rigid || percent == 100 {
            return feed;
        }
        let factor = f64::from(percent) / 100.0;
        match feed {
            Feed::PerMinute(feed) => Feed::PerMinute(feed * factor),
            Feed::PerRevolution(feed) => Feed::PerRevolution(feed * factor),
        }
    }

    fn push(&mut self, state: &MillState, step: &PathStep, apart: bool) -> Result<(), Alarm> {
        let radius = match state.modal.cutter {
            CutterSide::On => 0.0,
            _ => self.memory.cutter_radius(state.modal.d),
        };
        // In a mirrored plane left becomes right.
        let side = match (
            state.modal.cutter,
            state.transform.mirrors(state.modal.plane),
        ) {
            (CutterSide::Left, true) => CutterSide::Right,
            (CutterSide::Right, true) => CutterSide::Left,
            (side, _) => side,
        };
        let plane_and_apart = (state.modal.plane, apart);
        self.cutter
            .take(step, (side, radius), plane_and_apart, self.tracker)
    }

    /// Makes a straight step to a point in machine coordinates. `apart` marks a step away from
    /// the contour. Errors: the alarm of feed, compensation or travel limit.
    pub(crate) fn go(
        &mut self,
        state: &mut MillState,
        to: MillPosition,
        kind: StepKind,
        apart: bool,
    ) -> Result<(), Alarm> {
        let mut step = match kind {
            StepKind::Rapid => self.step(state, MillMoveKind::Rapid),
            StepKind::Cut => PathStep {
                feed: Some(rotary_feed(state, &to, feed(state)?)),
                ..self.step(state, MillMoveKind::Feed)
            },
            StepKind::CutAt(feed) => PathStep {
                feed: Some(Feed::PerMinute(feed)),
                ..self.step(state, MillMoveKind::Feed)
            },
            StepKind::Tap { out } => PathStep {
                feed: Some(self.of_tap(state, out, feed(state)?)),
                exact: true,
                rigid_out: state.modal.rigid.then_some(out),
                ..self.step(state, MillMoveKind::Tap)
            },
            StepKind::Thread(lead) => PathStep {
                feed: Some(Feed::PerRevolution(lead)),
                ..self.step(state, MillMoveKind::Thread)
            },
        };
        step.to = to;
        self.push(state, &step, apart)?;
        state.set_machine(to);
        Ok(())
    }

    /// Checks that the spindle turns before a cut, if cuts stop with it (174.7). Errors: alarm
    /// 098, after the time of 4901.
    fn check_spindle(&mut self, state: &MillState) -> Result<(), Alarm> {
        let modal = &state.modal;
        let turns = modal.spindle != SpindleState::Stopped && modal.speed > 0.0;
        if turns || !self.memory.bit(parameter::SPINDLE_CHECK, 7) {
            return Ok(());
        }
        let waited = self.memory.value(parameter::STOPPED_TIME);
        if waited > 0 {
            self.dwell(state, f64::from(waited) / 1000.0)?;
        }
        let detail = say::mill_cut_spindle_stands();
        Err(Alarm::new(number::SPINDLE_STOPPED).with_detail(detail))
    }

    /// Executes a dwell of `seconds`. A dwell of 0 is an exact stop.
    pub(crate) fn dwell(&mut self, state: &MillState, seconds: f64) -> Result<(), Alarm> {
        let step = PathStep {
            dwell_s: seconds,
            ..self.step(state, MillMoveKind::Dwell)
        };
        self.push(state, &step, false)
    }
}

/// Returns the feed in force. Errors: alarm 011 without a feed, or without the spindle that it
/// depends on.
pub(crate) fn feed(state: &MillState) -> Result<Feed, Alarm> {
    let modal = &state.modal;
    let none = |detail| Err(Alarm::new(number::NO_FEED).with_detail(detail));
    if modal.feed <= 0.0 {
        return none(say::mill_no_feed());
    }
    if !modal.per_revolution {
        return Ok(Feed::PerMinute(modal.feed));
    }
    if modal.speed <= 0.0 {
        return none(say::mill_feed_without_speed());
    }
    Ok(Feed::PerRevolution(modal.feed))
}

/// Returns the feed of a cut in which only rotary axes move. An F in inches is converted back,
/// because the feed of a rotary axis is in degrees.
fn rotary_feed(state: &MillState, to: &MillPosition, feed: Feed) -> Feed {
    let moves = |axis: &MillAxis| to.get(*axis) != state.machine.get(*axis);
    let mut moving = state.axes.all().filter(moves).peekable();
    let turns = moving.peek().is_some() && moving.all(|axis| state.axes.is_rotary(axis));
    match feed {
        Feed::PerMinute(feed) if turns && state.modal.inch => Feed::PerMinute(feed / MM_PER_INCH),
        feed => feed,
    }
}

const MM_PER_INCH: f64 = 25.4;

/// Permitted leads of threads, mm.
const LEAD_RANGE: core::ops::RangeInclusive<f64> = 0.001..=500.0;

/// Returns the lead of G33, mm. Errors: alarm 011 without a lead, 043 outside the range, 094
/// while the spindle is stopped.
fn thread_lead(state: &MillState) -> Result<f64, Alarm> {
    let modal = &state.modal;
    if modal.lead == 0.0 {
        return Err(Alarm::new(number::NO_FEED).with_detail(say::mill_thread_without_lead()));
    }
    if !LEAD_RANGE.contains(&modal.lead) {
        let detail = say::thread_lead_out_of_range(modal.lead);
        return Err(Alarm::new(number::OUT_OF_RANGE).with_detail(detail));
    }
    if modal.spindle == SpindleState::Stopped || modal.speed <= 0.0 {
        return Err(Alarm::new(number::THREAD_SPEED).with_detail(say::thread_spindle_stands()));
    }
    Ok(modal.lead)
}

/// Returns the point that the axis words of a block name, before scaling and rotation.
pub(crate) fn target(state: &mut MillState, words: &BlockWords) -> MillPosition {
    let modal = &state.modal;
    let mut to = state.programmed;
    let word = |axis: MillAxis| words.letters.axes.get(axis);
    for axis in MillAxis::ALL {
        if let Some(value) = word(axis) {
            let value = state.axis_value(axis, value);
            let from = to.get(axis);
            to.set(
                axis,
                if modal.incremental {
                    from + value
                } else {
                    state.axes.towards(axis, from, value)
                },
            );
        }
    }
    let [first, second, _] = modal.plane.axes();
    let (radius, angle) = (word(first), word(second));
    let Some(polar) = &mut state.polar else {
        return to;
    };
    if radius.is_none() && angle.is_none() {
        return to;
    }
    if let Some(radius) = radius {
        polar.radius = length(radius, modal.inch);
    }
    if let Some(angle) = angle.map(WordNumber::value) {
        polar.degrees = angle
            + if modal.incremental {
                polar.degrees
            } else {
                0.0
            };
    }
    let center = match modal.incremental {
        true => state.programmed.flat(modal.plane),
        false => PlanePoint::default(),
    };
    let (sine, cosine) = sine_cosine(polar.degrees);
    let offset = PlanePoint::new(cosine, sine).scaled(polar.radius.mm());
    state.axes.moved_to(to, modal.plane, center + offset)
}

/// Sets the centre of a rotation (G68) before the first motion: if that is incremental, to the
/// position of the tool.
pub(crate) fn settle_rotation(state: &mut MillState, memory: &MillMemory) {
    let Some(rotation) = &mut state.transform.rotation else {
        return;
    };
    let Some(tool_at_start) = rotation.tool_at_start.take() else {
        return;
    };
    if state.modal.incremental {
        rotation.center = tool_at_start;
        state.resync(memory);
    }
}

/// Executes G00 to G03 and G33 of a block. Returns whether the block moves an axis.
pub(crate) fn execute_motion(
    state: &mut MillState,
    words: &BlockWords,
    context: &mut RunContext<'_, '_>,
) -> Result<bool, Alarm> {
    let round = words.letters.r.is_some() || words.letters.center.0.iter().any(Option::is_some);
    let motion = state.modal.motion;
    let is_needed = words.has_axes() || (round && matches!(motion, MillMotion::Arc { .. }));
    if !is_needed {
        return Ok(false);
    }
    settle_rotation(state, context.memory);
    let programmed = target(state, words);
    let to = state.to_machine(programmed, context.memory);
    match motion {
        MillMotion::Rapid => context.go(state, to, StepKind::Rapid, false)?,
        MillMotion::Line => {
            context.check_spindle(state)?;
            context.go(state, to, StepKind::Cut, false)?;
        }
        MillMotion::Arc { clockwise } => {
            context.check_spindle(state)?;
            arc_to(state, words, to, clockwise, context)?;
        }
        MillMotion::Thread => context.go(state, to, StepKind::Thread(thread_lead(state)?), true)?,
    }
    state.set_programmed(programmed);
    Ok(true)
}

fn arc_to(
    state: &mut MillState,
    words: &BlockWords,
    to: MillPosition,
    clockwise: bool,
    context: &mut RunContext<'_, '_>,
) -> Result<(), Alarm> {
    let modal = &state.modal;
    let plane = modal.plane;
    let [first, second, _] = plane.axes();
    let center_word = |axis| {
        words
            .letters
            .center
            .get(axis)
            .map(|it| length(it, modal.inch).mm())
    };
    let circle = match words.letters.r {
        Some(r) => {
            let factor = |axis| state.transform.factor(axis).abs();
            let factor = factor(first).max(factor(second));
            ArcDefinition::Radius(length(r, modal.inch).mm() * factor)
        }
        None if center_word(first).or(center_word(second)).is_none() => {
            let detail = say::mill_arc_without_center();
            return Err(Alarm::new(number::ARC_DATA).with_detail(detail));
        }
        None => {
            let to_center = PlanePoint::new(
                center_word(first).unwrap_or(0.0),
                center_word(second).unwrap_or(0.0),
            );
            ArcDefinition::Center(state.transform.transform_distance(plane, to_center))
        }
    };
    let clockwise = clockwise != state.transform.mirrors(plane);
    let tolerance = context.memory.length(parameter::ARC_ERROR).mm();
    let ends = (state.machine.flat(plane), to.flat(plane));
    let center = arc::arc_center(ends.0, ends.1, circle, clockwise, tolerance)?;
    let kind = if clockwise {
        MillMoveKind::Clockwise
    } else {
        MillMoveKind::CounterClockwise
    };
    let step = PathStep {
        to,
        arc: Some(MillArc { plane, center }),
        feed: Some(feed(state)?),
        ..context.step(state, kind)
    };
    context.push(state, &step, false)?;
    state.set_machine(to);
    Ok(())
}

/// Stores the words of a hole cycle for this and the following holes.
pub(crate) fn take_hole_data(state: &mut MillState, words: &BlockWords) -> Result<(), Alarm> {
    let (modal, letters) = (&state.modal, &words.letters);
    let level = |value: WordNumber| HoleLevel {
        value: length(value, modal.inch),
        incremental: modal.incremental,
    };
    let across = letters.axes.get(modal.plane.across());
    let data = &mut state.hole;
    data.r = letters.r.map(level).or(data.r);
    data.bottom = across.map(level).or(data.bottom);
    data.q = letters.q.map(|q| length(q, modal.inch)).or(data.q);
    if let Some(p) = letters.p {
        if p.millionths() < 0 {
            let detail = say::mill_dwell_negative();
            return Err(Alarm::new(number::OUT_OF_RANGE).with_detail(detail));
        }
        data.dwell_s = p.value() / 1000.0;
    }
    Ok(())
}

/// Greatest number of holes in one block.
const MAX_HOLES: i64 = 9999;

/// Executes the hole cycle at the positions of a block. Returns whether the block moves an axis.
pub(crate) fn execute_holes(
    hole: Hole,
    state: &mut MillState,
    words: &BlockWords,
    context: &mut RunContext<'_, '_>,
) -> Result<bool, Alarm> {
    take_hole_data(state, words)?;
    let is_needed = words.has_axes() || words.letters.r.is_some();
    let count = words.letters.center.get(MillAxis::Z).or(words.letters.l);
    let count = count.map_or(1, WordNumber::integer);
    if !(0..=MAX_HOLES).contains(&count) {
        let detail = say::mill_repeats_out_of_range(count, MAX_HOLES);
        return Err(Alarm::new(number::OUT_OF_RANGE).with_detail(detail));
    }
    if !is_needed || count == 0 {
        return Ok(false);
    }
    settle_rotation(state, context.memory);
    let across = state.modal.plane.across();
    let mut positioning_words = *words;
    positioning_words.letters.axes.set(across, None);
    for hole_of_block in 0..count {
        if hole_of_block > 0 && !context.can_continue() {
            break;
        }
        let programmed = target(state, &positioning_words);
        let mut over = state.to_machine(programmed, context.memory);
        over.set(across, state.machine.get(across));
        let wrapped = state.axes.wrapped(over);
        if wrapped != over {
            // The other steps of the hole must not turn the axis again.
            context.go(state, over, StepKind::Rapid, true)?;
            over = wrapped;
        }
        let levels = hole_levels(hole, state, context.memory)?;
        let HoleData {
            initial,
            q,
            dwell_s,
            ..
        } = state.hole;
        let drilling = Drilling {
            hole,
            plane: state.modal.plane,
            over,
            initial,
            r: levels.0,
            bottom: levels.1,
            q,
            dwell_s,
            to_r: state.modal.to_r,
            spindle: state.modal.spindle,
            rigid: state.modal.rigid,
            memory: context.memory,
        };
        for part in drilling.steps()? {
            match part {
                HoleStep::Rapid(to) => context.go(state, to, StepKind::Rapid, true)?,
                HoleStep::Feed(to) => {
                    context.check_spindle(state)?;
                    context.go(state, to, StepKind::Cut, true)?;
                }
                HoleStep::Tap { to, out } => context.go(state, to, StepKind::Tap { out }, true)?,
                HoleStep::Dwell(seconds) => context.dwell(state, seconds)?,
                HoleStep::Spindle(spindle) => state.modal.spindle = spindle,
            }
        }
        state.set_programmed(programmed);
        let level = state.transform.undo(state.work(context.memory)).get(across);
        state.programmed.set(across, level);
    }
    Ok(true)
}

/// Returns the R level and the bottom of a hole, machine coordinates. Those of G76 are not
/// scaled.
fn hole_levels(
    hole: Hole,
    state: &MillState,
    memory: &MillMemory,
) -> Result<(Length, Length), Alarm> {
    let across = state.modal.plane.across();
    let data = &state.hole;
    let scales = hole != Hole::FineBore;
    let level = |level: HoleLevel, from: Length| {
        let HoleLevel { value, incremental } = level;
        if incremental {
            let factor = if scales {
                state.transform.factor(across)
            } else {
                1.0
            };
            let scaled = Length::from_mm(value.mm() * factor);
            return from + state.axes.rounded(across, scaled);
        }
        let mut point = state.programmed;
        point.set(across, value);
        let point = if scales {
            state.transform.apply(point, &state.axes)
        } else {
            point
        };
        (point + state.frame(memory)).get(across)
    };
    let r = data.r.map_or(data.initial, |r| level(r, data.initial));
    let Some(bottom) = data.bottom else {
        let detail = say::mill_hole_without_bottom(hole.code(), state.axes.letter(across));
        return Err(Alarm::new(number::CYCLE_DATA).with_detail(detail));
    };
    Ok((r, level(bottom, r)))
}

impl Polar {
    /// Creates polar coordinates with radius and angle 0.
    pub(crate) const fn begin() -> Self {
        Self {
            radius: Length::ZERO,
            degrees: 0.0,
        }
    }
}
