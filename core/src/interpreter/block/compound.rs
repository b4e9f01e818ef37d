//! Plans G70 to G76: separates data blocks from cycle blocks, and finds the block after the
//! cycle (manual I-3.2.6).
//!
//! ```text
//!   G71 U2 R1            without P, Q: data into parameters
//!   G71 P10 Q50 U0.5     with them: the cycle, then the block after nf
//!   N10 …                if the profile follows, else the block after the cycle
//!   N50 …
//!
//!   G71 I4 K1 N3 X0.4    Huaxing: the next three blocks are the contour; they
//!   …                    run as ordinary blocks after the cycle
//! ```

use crate::alarm::Alarm;
use crate::interpreter::canned_cycle::CycleGenerator;
use crate::interpreter::context::BlockContext;
use crate::interpreter::cycles::contour::CutPlane;
use crate::interpreter::cycles::finishing;
use crate::interpreter::cycles::pattern;
use crate::interpreter::cycles::pecking;
use crate::interpreter::cycles::roughing;
use crate::interpreter::flow::Flow;
use crate::interpreter::flow::program_position::ProgramPosition;
use crate::interpreter::plan::{Plan, PlannedMotion};
use crate::interpreter::profile::{self, ProfileRange};
use crate::interpreter::state::State;
use crate::interpreter::threads::compound_thread;
use crate::interpreter::words::{AxisWords, ContourSource, OneShot, SortedWords};
use crate::units::Axis;

/// Plans a block of G70 to G76: adds its motion, flow and parameter writes to `plan`.
///
/// # Errors
/// The alarm of the cycle's words or of its profile.
pub(crate) fn plan_cycle(
    code: OneShot,
    state: &mut State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    axes: &AxisWords,
    plan: &mut Plan,
) -> Result<(), Alarm> {
    if reads_named_profile(code) {
        profile::check_call(words)?;
    }
    let writes = &mut plan.writes;
    plan.motion = match code {
        OneShot::Finishing => {
            plan.flow = finishing::plan_finishing(state, context, words)?;
            return Ok(());
        }
        OneShot::TurningRough(ContourSource::Counted) => {
            let passes = roughing::plan_counted(CutPlane::Turning, state, context, words)?;
            PlannedMotion::start_cycle(state, CycleGenerator::Roughing(passes))?
        }
        OneShot::FacingRough(ContourSource::Counted) => {
            let passes = roughing::plan_counted(CutPlane::Facing, state, context, words)?;
            PlannedMotion::start_cycle(state, CycleGenerator::Roughing(passes))?
        }
        OneShot::Pattern(ContourSource::Counted) => {
            let passes = pattern::plan_counted(state, context, words)?;
            PlannedMotion::start_cycle(state, CycleGenerator::Pattern(passes))?
        }
        OneShot::TurningRough(ContourSource::Named)
        | OneShot::FacingRough(ContourSource::Named)
        | OneShot::Pattern(ContourSource::Named) => {
            let view = match code {
                OneShot::FacingRough(_) => CutPlane::Facing,
                _ => CutPlane::Turning,
            };
            let is_pattern = matches!(code, OneShot::Pattern(_));
            if words.p.or(words.q).is_none() {
                return if is_pattern {
                    pattern::store_data(words, writes)
                } else {
                    roughing::store_data(view, words, writes)
                };
            }
            let range = profile::find_range(context, words)?;
            let generator = if is_pattern {
                CycleGenerator::Pattern(pattern::plan_cycle(state, context, words, range, writes)?)
            } else {
                CycleGenerator::Roughing(roughing::plan_cycle(
                    view, state, context, words, range, writes,
                )?)
            };
            plan.flow = flow_after_cycle(context.position, range);
            PlannedMotion::start_cycle(state, generator)?
        }
        OneShot::FacePecking | OneShot::Grooving => {
            let axis = match code {
                OneShot::FacePecking => Axis::Z,
                _ => Axis::X,
            };
            let pecking = pecking::plan_cycle(axis, state, context, words, axes, writes)?;
            start_cycle(state, pecking.map(CycleGenerator::Pecking))?
        }
        OneShot::CompoundThread => {
            let cycle = compound_thread::plan_cycle(state, context, words, axes, writes)?;
            start_cycle(state, cycle.map(CycleGenerator::CompoundThread))?
        }
        _ => return Ok(()),
    };
    if plan.motion.has_motion() {
        state.end_at_position();
        // Feed hold stops within the moves of G76 as within other threads.
        plan.holds_at_move_end = code != OneShot::CompoundThread;
    }
    Ok(())
}

/// Whether a cycle cuts the profile between two sequence numbers.
const fn reads_named_profile(code: OneShot) -> bool {
    matches!(
        code,
        OneShot::Finishing
            | OneShot::TurningRough(ContourSource::Named)
            | OneShot::FacingRough(ContourSource::Named)
            | OneShot::Pattern(ContourSource::Named)
    )
}

/// Starts the cycle of `generator`; `None`, from a block that only sets data, makes no motion.
fn start_cycle(state: &State, generator: Option<CycleGenerator>) -> Result<PlannedMotion, Alarm> {
    generator.map_or(Ok(PlannedMotion::None), |maker| {
        PlannedMotion::start_cycle(state, maker)
    })
}

/// The flow after a cycle over a profile: jumps over the profile if it is after the cycle.
fn flow_after_cycle(cycle: ProgramPosition, profile: ProfileRange) -> Flow {
    if profile.last < cycle.block {
        return Flow::Next;
    }
    Flow::Jump(ProgramPosition {
        block: profile.last + 1,
        ..cycle
    })
}
