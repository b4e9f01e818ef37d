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
use crate::interpreter::codes::positioning::{feed, within_stroke};
use crate::interpreter::context::Context;
use crate::interpreter::context::exact::{Exact, PER_MM, Reach, mm};
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::moves::{Move, Shift};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::Words;
use crate::interpreter::context::writes::Writes;
use crate::interpreter::cycles::contour::{Flat, Signs, View, end_of_cut};
use crate::interpreter::profile::{self, Profile, Range, Shape, Step, bad_start};
use crate::memory::parameter;
use crate::units::{Axis, Feed, Point};

/// Half units of [`Exact`] in a thousandth of a millimetre.
const PER_MICRON: i64 = 2 * PER_MM / 1000;

/// The next move of a roughing cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    Approach,
    Infeed,
    Cut,
    Escape { along: i64 },
    Return,
    Entry,
    Contour { step: usize },
    Done,
}

/// A running G71 or G72.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Roughing {
    #[serde(rename = "view")]
    view: View,
    #[serde(rename = "signs")]
    signs: Signs,
    /// A and B.
    start: Exact,
    begin: Exact,
    /// Where the tool returns to: A without the allowances.
    #[serde(rename = "rest")]
    rest: Exact,
    /// The contour from B to C.
    steps: Vec<Step>,
    /// The conversion of the frame, and the same with the allowances.
    #[serde(rename = "home")]
    home: Shift,
    #[serde(rename = "shift")]
    shift: Shift,
    allowance: Exact,
    /// Whether ns is a rapid.
    #[serde(rename = "rapid")]
    rapid: bool,
    feed: Feed,
    /// Δd and e, half units.
    cut: i64,
    escape: i64,
    /// Number of the current level, from 1, and number of the contour pass.
    level: i64,
    levels: i64,
    phase: Phase,
}

/// Stores the data of a G71 or G72 without P and Q: Δd and e into parameters 051 and 052.
///
/// # Errors
/// 062 for a depth that is not positive or a negative retract.
pub(crate) fn store(view: View, words: &Words, writes: &mut Writes) -> Result<(), Alarm> {
    let (depth, name) = match view {
        View::Turning => (words.u, "U(Δd)"),
        View::Facing => (words.w, "W(Δd)"),
    };
    if let Some(depth) = depth {
        if depth <= 0 {
            return Err(fault(say::cycle_depth_not_positive(name, mm(depth))));
        }
        writes.push_length(parameter::ROUGHING_DEPTH, depth);
    }
    store_retract(words, writes)
}

/// Stores R(e), which either block of the cycle may hold.
fn store_retract(words: &Words, writes: &mut Writes) -> Result<(), Alarm> {
    if let Some(retract) = words.r {
        if retract < 0 {
            return Err(fault(say::cycle_retract_negative(mm(retract))));
        }
        writes.push_length(parameter::ROUGHING_RETRACT, retract);
    }
    Ok(())
}

/// Plans the cycle over a profile.
///
/// # Errors
/// 062 for a missing depth, 043 for a point outside the stroke, and the alarms of the profile.
pub(crate) fn plan(
    view: View,
    state: &State,
    context: &Context<'_>,
    words: &Words,
    range: Range,
    writes: &mut Writes,
) -> Result<Roughing, Alarm> {
    store_retract(words, writes)?;
    let parameter = |number| i64::from(writes.value(number, context.parameters));
    let (cut, escape) = (
        parameter(parameter::ROUGHING_DEPTH) * PER_MICRON,
        parameter(parameter::ROUGHING_RETRACT) * PER_MICRON,
    );
    let allowance = Exact::new(
        words.u.unwrap_or(0).saturating_mul(context.x_factor),
        words.w.unwrap_or(0),
    );
    let levels = Levels {
        cut,
        escape,
        allowance,
        from: Exact::default(),
    };
    over(view, state, context, range, &levels)
}

/// Plans the cycle of the Huaxing lathes over the next blocks. Its levels count from the
/// current position, without the allowances. I is a diameter in G71, K the retract of the
/// slide.
///
/// # Errors
/// As for [`plan`].
pub(crate) fn counted(
    view: View,
    state: &State,
    context: &Context<'_>,
    words: &Words,
) -> Result<Roughing, Alarm> {
    let range = profile::following(context, words)?;
    let cut = match (words.i.map(i64::abs), view) {
        (None | Some(0), _) => return Err(fault(say::cycle_depth_missing())),
        (Some(depth), View::Turning) => depth,
        (Some(depth), View::Facing) => depth.saturating_mul(2),
    };
    let allowance = Exact::new(words.x.unwrap_or(0), words.z.unwrap_or(0));
    let levels = Levels {
        cut,
        escape: words.k.unwrap_or(0).abs().saturating_mul(2),
        allowance,
        from: Exact::default() - allowance,
    };
    over(view, state, context, range, &levels)
}

/// Depth and start of the levels of a roughing cycle.
struct Levels {
    /// Δd and e, half units.
    cut: i64,
    escape: i64,
    allowance: Exact,
    /// Level 0 relative to A, without the allowances.
    from: Exact,
}

/// The cycle over a range of blocks.
fn over(
    view: View,
    state: &State,
    context: &Context<'_>,
    range: Range,
    levels: &Levels,
) -> Result<Roughing, Alarm> {
    let cut = levels.cut;
    if cut <= 0 {
        return Err(fault(say::cycle_depth_missing()));
    }
    let feed = feed(&state.modal)?;
    let profile = profile::evaluate(state, context, range)?;
    check_entry(view, &profile)?;
    if range.follows {
        check_cuts(&profile)?;
    }
    let signs = Signs::of(view, &profile)?;
    let rest = profile.start;
    let profile = Profile {
        start: profile.start + levels.from,
        ..profile
    };
    let (a, b) = (view.flat(profile.start), view.flat(profile.begin()));
    let distance = (b.depth - a.depth).abs();
    let home = Shift::of(state);
    let roughing = Roughing {
        view,
        signs,
        start: profile.start,
        rest,
        begin: profile.begin(),
        home,
        shift: home.moved(levels.allowance),
        allowance: levels.allowance,
        rapid: matches!(profile.entry.shape, Shape::Straight { rapid: true }),
        feed,
        cut,
        escape: levels.escape,
        level: 1,
        levels: (distance + cut - 1) / cut,
        phase: Phase::Approach,
        steps: profile.steps,
    };
    roughing.check_stroke(context.reach())?;
    Ok(roughing)
}

/// Checks that ns moves only the axis of the levels; alarm 065.
fn check_entry(view: View, profile: &Profile) -> Result<(), Alarm> {
    let (a, b) = (view.flat(profile.start), view.flat(profile.begin()));
    if a.along == b.along {
        return Ok(());
    }
    Err(bad_start(match view {
        View::Turning => say::profile_begin_moves_z(),
        View::Facing => say::profile_begin_moves_x(),
    }))
}

/// Checks that a contour of the Huaxing lathes has no G00 from B on.
fn check_cuts(profile: &Profile) -> Result<(), Alarm> {
    let mut steps = profile.steps.iter();
    match steps.find(|step| step.shape == Shape::Straight { rapid: true }) {
        Some(rapid) => Err(bad_start(say::profile_rapid_inside(rapid.line))),
        None => Ok(()),
    }
}

impl Roughing {
    fn check_stroke(&self, reach: Reach<'_>) -> Result<(), Alarm> {
        let end = self.steps.last().map_or(self.begin, |step| step.to);
        let start = self.view.flat(self.start);
        let highest = self.view.exact(Flat {
            depth: start.depth + self.signs.depth * (self.cut - self.escape),
            ..start
        });
        for corner in [self.start, self.begin, end, highest] {
            within_stroke(corner + self.allowance, reach)?;
        }
        Ok(())
    }

    /// Depth of the current level, without the allowance.
    fn depth(&self) -> i64 {
        self.view.flat(self.start).depth + self.signs.depth * self.cut * self.level
    }

    /// Depth after the escape from the current level.
    fn escaped(&self) -> i64 {
        self.depth() - self.signs.depth * self.escape
    }

    fn note(&self) -> Note {
        let axis = self.view.depth_axis();
        if self.level >= self.levels {
            return Note::Contour {
                axis,
                levels: self.levels,
                allowance: self.allowance,
            };
        }
        // Half units are diameters of X and halves of Z.
        let shown = |depth: i64| match axis {
            Axis::X => depth,
            Axis::Z => depth / 2,
        };
        let by = self.allowance.get(axis);
        Note::Level {
            axis,
            number: self.level,
            levels: self.levels,
            from: self.start.get(axis) + by,
            step: shown(self.signs.depth * self.cut),
            last: self.begin.get(axis) + by,
        }
    }

    fn at(&self, depth: i64, along: i64) -> Point {
        self.shift.machine(self.view.exact(Flat { depth, along }))
    }

    /// The move after a level.
    fn next_level(&self) -> Phase {
        if self.level < self.levels {
            Phase::Infeed
        } else {
            Phase::Entry
        }
    }

    pub(crate) fn make(&mut self) -> Option<Move> {
        let note = self.note();
        let start = self.view.flat(self.start);
        let line = |to| Move::line(to, self.feed, note);
        let (made, phase) = match self.phase {
            Phase::Approach => (
                Move::rapid(self.shift.machine(self.start), note),
                self.next_level(),
            ),
            Phase::Infeed => {
                let to = self.at(self.depth(), start.along);
                (self.infeed(to, note), Phase::Cut)
            }
            Phase::Cut => {
                let along =
                    end_of_cut(self.view, self.signs, self.begin, &self.steps, self.depth());
                (line(self.at(self.depth(), along)), Phase::Escape { along })
            }
            Phase::Escape { along } => {
                let back = along - self.signs.along * self.escape;
                // Never beyond Z_A'.
                let back = match self.signs.along {
                    1 => back.max(start.along),
                    _ => back.min(start.along),
                };
                (line(self.at(self.escaped(), back)), Phase::Return)
            }
            Phase::Return => {
                let to = self.at(self.escaped(), start.along);
                self.level += 1;
                (Move::rapid(to, note), self.next_level())
            }
            Phase::Entry => {
                let to = self.shift.machine(self.begin);
                (self.infeed(to, note), Phase::Contour { step: 0 })
            }
            Phase::Contour { step } => match self.steps.get(step) {
                Some(found) => (
                    follow(found, self.shift, self.feed, note),
                    Phase::Contour { step: step + 1 },
                ),
                None => (Move::rapid(self.home.machine(self.rest), note), Phase::Done),
            },
            Phase::Done => return None,
        };
        self.phase = phase;
        Some(made)
    }

    /// An infeed: a rapid if ns is one.
    fn infeed(&self, to: Point, note: Note) -> Move {
        if self.rapid {
            Move::rapid(to, note)
        } else {
            Move::line(to, self.feed, note)
        }
    }
}

/// The move of one step of a shifted contour, at the feed of the cycle.
pub(crate) fn follow(step: &Step, shift: Shift, feed: Feed, note: Note) -> Move {
    let to = shift.machine(step.to);
    match step.shape {
        Shape::Straight { .. } => Move::line(to, feed, note),
        Shape::Arc { center, clockwise } => Move::of(
            Action::Arc {
                to,
                center: shift.center(center),
                clockwise,
                feed,
            },
            note,
        ),
        Shape::Dwell { ms } => Move::of(Action::Dwell { ms }, note),
    }
}

fn fault(detail: Message) -> Alarm {
    Alarm::new(number::CYCLE_DATA).because(detail)
}
