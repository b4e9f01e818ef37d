//! G33: tapping in Z (manual I-3.2.4.3); G84 and G85 of the Huaxing lathes.
//!
//! ```text
//!   X ^   bottom <======1====== A      1 feed in with the spindle, M05, stop
//!     |          ======2======>        2 reversed, out to A, stop
//!     +--------------------------> Z   L starts: repeat, 360°/L further each time
//! ```

use gsk_messages::say;
use serde::{Deserialize, Serialize};

use crate::alarm::{Alarm, number};
use crate::command::Action;
use crate::interpreter::codes::positioning::check_stroke;
use crate::interpreter::context::BlockContext;
use crate::interpreter::exact::{CoordinateRange, to_mm};
use crate::interpreter::moves::explanation::{Explanation, PassNote, add_start_angle};
use crate::interpreter::moves::{FrameShift, Move};
use crate::interpreter::state::State;
use crate::interpreter::threads::lead_word;
use crate::interpreter::threads::thread;
use crate::interpreter::words::{AxisWords, LeadUnit, SortedWords};
use crate::units::Point;

/// The remaining thread starts of a tapping cycle, all at the same hole.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Tapping {
    bottom: Point,
    /// Programmed Z of the start and of the bottom, in millionths of a millimetre.
    #[serde(rename = "way")]
    z_range: (i64, i64),
    lead: f64,
    start: u32,
    starts: u32,
    /// G code of the cycle, for the explanation.
    #[serde(default = "tapping_code")]
    code: u8,
}

/// Default of a stored cycle: 33, the only tapping code of the GSK980TD.
const fn tapping_code() -> u8 {
    33
}

/// Plans a G33 block; `None` for a block without motion. The cycle ends at the start of the
/// tool.
///
/// # Errors
/// 009 for a motion of X, 011 without a lead, 043 for an end outside the stroke.
pub(crate) fn plan_cycle(
    state: &mut State,
    words: &SortedWords,
    axes: &AxisWords,
    range: CoordinateRange<'_>,
) -> Result<Option<Tapping>, Alarm> {
    let to = check_stroke(axes.resolve_end(state.position), range)?;
    if to.x != state.position.x {
        return Err(Alarm::new(number::BAD_ADDRESS).with_detail(say::tap_moves_x()));
    }
    let lead = thread::current_lead(state)?;
    if to == state.position {
        return Ok(None);
    }
    let starts = u32::try_from(words.l.unwrap_or(1)).unwrap_or(1);
    let tapping = Tapping {
        bottom: FrameShift::from_state(state).to_machine(to),
        z_range: (state.position.z, to.z),
        lead,
        start: 0,
        starts,
        code: tapping_code(),
    };
    state.move_to(axes, state.position);
    Ok(Some(tapping))
}

/// Plans a G84 or G85 block of the Huaxing lathes: tapping with the lead that the block gives.
///
/// # Errors
/// 062 for wrong data, 011 or 043 for the lead, 043 for an end outside the stroke.
pub(crate) fn plan_rigid(
    state: &mut State,
    context: &BlockContext<'_>,
    words: &SortedWords,
    axes: &AxisWords,
    unit: LeadUnit,
) -> Result<Tapping, Alarm> {
    let code = match unit {
        LeadUnit::Millimetres => 84,
        LeadUnit::PerInch => 85,
    };
    let from = state.position;
    let to = check_stroke(axes.resolve_end(from), context.coordinate_range())?;
    let violation = if to.x != from.x {
        Some(say::hole_moves_x())
    } else if to.z == from.z {
        Some(say::cycle_end_at_start("Z"))
    } else {
        None
    };
    if let Some(rule) = violation {
        let rule = say::dialect_decided(say::cycle_in_code(code, rule));
        return Err(Alarm::new(number::CYCLE_DATA).with_detail(rule));
    }
    let tapping = Tapping {
        bottom: FrameShift::from_state(state).to_machine(to),
        z_range: (from.z, to.z),
        lead: lead_word::read_tap_lead(words, unit, code)?,
        start: 0,
        starts: 1,
        code,
    };
    state.move_to(axes, from);
    Ok(tapping)
}

impl Tapping {
    fn tap_action(&self) -> Action {
        Action::Tap {
            to: self.bottom,
            lead: self.lead,
            start_degrees: start_angle_degrees(self.start, self.starts),
        }
    }

    pub(crate) fn next_move(&mut self) -> Option<Move> {
        if self.start >= self.starts {
            return None;
        }
        let note = PassNote::Tap {
            start: self.start + 1,
            starts: self.starts,
            a: self.z_range.0,
            bottom: self.z_range.1,
            code: self.code,
        };
        let action = self.tap_action();
        self.start += 1;
        Some(Move::from_action(action, note))
    }
}

/// The spindle angle, in degrees, of the thread start `start` (from 0) of a thread with
/// `starts` starts.
pub(crate) fn start_angle_degrees(start: u32, starts: u32) -> f64 {
    360.0 * f64::from(start) / f64::from(starts.max(1))
}

/// Explains one thread start of a tapping cycle; `None` for the note of another cycle.
pub(crate) fn explain_tap(note: PassNote) -> Option<Explanation> {
    let PassNote::Tap {
        start,
        starts,
        a,
        bottom,
        code,
    } = note
    else {
        return None;
    };
    Some(Explanation {
        code: if code == 0 { 33 } else { code },
        pass: start.into(),
        passes: Some(starts.into()),
        level: None,
        depth: to_mm(bottom - a).abs(),
        remaining: 0.0,
        formula: add_start_angle(say::explain_tap(to_mm(a), to_mm(bottom)), start, starts),
        words: match code {
            84 => "Z, K",
            85 => "Z, I",
            _ => "Z(W), F(I), L",
        },
    })
}
