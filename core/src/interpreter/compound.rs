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
use crate::interpreter::canned_cycle::Maker;
use crate::interpreter::context::Context;
use crate::interpreter::context::flow::Flow;
use crate::interpreter::context::place::Place;
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{AxisWords, Contour, OneShot, Words};
use crate::interpreter::cycles::contour::View;
use crate::interpreter::cycles::finishing;
use crate::interpreter::cycles::pattern;
use crate::interpreter::cycles::pecking;
use crate::interpreter::cycles::roughing;
use crate::interpreter::plan::{Motion, Plan};
use crate::interpreter::profile::{self, Range};
use crate::interpreter::threads::compound_thread;
use crate::units::Axis;

/// Fills `plan` for a block of one of these cycles.
///
/// # Errors
/// The alarm of the cycle's words or of its profile.
pub(crate) fn plan(
    code: OneShot,
    state: &mut State,
    context: &Context<'_>,
    words: &Words,
    axes: &AxisWords,
    plan: &mut Plan,
) -> Result<(), Alarm> {
    let writes = &mut plan.writes;
    plan.motion = match code {
        OneShot::Finishing => {
            plan.flow = finishing::plan(state, context, words)?;
            return Ok(());
        }
        OneShot::TurningRough(Contour::Counted) => {
            let passes = roughing::counted(View::Turning, state, context, words)?;
            Motion::cycle(state, Maker::Roughing(passes))?
        }
        OneShot::FacingRough(Contour::Counted) => {
            let passes = roughing::counted(View::Facing, state, context, words)?;
            Motion::cycle(state, Maker::Roughing(passes))?
        }
        OneShot::Pattern(Contour::Counted) => {
            let passes = pattern::counted(state, context, words)?;
            Motion::cycle(state, Maker::Pattern(passes))?
        }
        OneShot::TurningRough(Contour::Named)
        | OneShot::FacingRough(Contour::Named)
        | OneShot::Pattern(Contour::Named) => {
            let view = match code {
                OneShot::FacingRough(_) => View::Facing,
                _ => View::Turning,
            };
            let pattern = matches!(code, OneShot::Pattern(_));
            if words.p.or(words.q).is_none() {
                return if pattern {
                    pattern::store(words, writes)
                } else {
                    roughing::store(view, words, writes)
                };
            }
            let range = profile::locate(context, words)?;
            let maker = if pattern {
                Maker::Pattern(pattern::plan(state, context, words, range, writes)?)
            } else {
                Maker::Roughing(roughing::plan(view, state, context, words, range, writes)?)
            };
            plan.flow = behind(context.place, range);
            Motion::cycle(state, maker)?
        }
        OneShot::FacePecking | OneShot::Grooving => {
            let axis = match code {
                OneShot::FacePecking => Axis::Z,
                _ => Axis::X,
            };
            let pecking = pecking::plan(axis, state, context, words, axes, writes)?;
            begin(state, pecking.map(Maker::Pecking))?
        }
        OneShot::CompoundThread => {
            let cycle = compound_thread::plan(state, context, words, axes, writes)?;
            begin(state, cycle.map(Maker::CompoundThread))?
        }
        _ => return Ok(()),
    };
    if plan.motion.moves() {
        state.return_here();
        // Feed hold stops within the moves of G76 as within other threads.
        plan.whole = code != OneShot::CompoundThread;
    }
    Ok(())
}

/// The motion of a cycle, or none for a block that only sets data.
fn begin(state: &State, maker: Option<Maker>) -> Result<Motion, Alarm> {
    maker.map_or(Ok(Motion::None), |maker| Motion::cycle(state, maker))
}

/// The flow after a cycle over a profile.
fn behind(cycle: Place, profile: Range) -> Flow {
    if profile.last < cycle.block {
        return Flow::Next;
    }
    Flow::Jump(Place {
        block: profile.last + 1,
        ..cycle
    })
}
