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
use crate::interpreter::codes::positioning::within_stroke;
use crate::interpreter::context::Context;
use crate::interpreter::context::exact::Reach;
use crate::interpreter::context::explanation::Note;
use crate::interpreter::context::moves::{Move, Shift};
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::{AxisWords, LeadUnit, Words};
use crate::interpreter::threads::lead_word;
use crate::interpreter::threads::thread;
use crate::units::Point;

/// A running tapping cycle: the remaining starts at the same hole.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Tapping {
    bottom: Point,
    /// Programmed Z of the start and of the bottom, units of [`Exact`].
    #[serde(rename = "way")]
    way: (i64, i64),
    lead: f64,
    start: u32,
    starts: u32,
    /// Its G code, for the explanation.
    #[serde(default = "tapping_code")]
    code: u8,
}

/// G33, the only tapping code of the GSK980TD.
const fn tapping_code() -> u8 {
    33
}

/// Plans a G33 block; `None` without motion. The tool ends at its start.
///
/// # Errors
/// 009 for a motion of X, 011 without a lead, 043 for an end outside the stroke.
pub(crate) fn plan(
    state: &mut State,
    words: &Words,
    axes: &AxisWords,
    reach: Reach<'_>,
) -> Result<Option<Tapping>, Alarm> {
    let to = within_stroke(axes.target(state.position), reach)?;
    if to.x != state.position.x {
        return Err(Alarm::new(number::BAD_ADDRESS).because(say::tap_moves_x()));
    }
    let lead = thread::lead(state)?;
    if to == state.position {
        return Ok(None);
    }
    let starts = u32::try_from(words.l.unwrap_or(1)).unwrap_or(1);
    let tapping = Tapping {
        bottom: Shift::of(state).machine(to),
        way: (state.position.z, to.z),
        lead,
        start: 0,
        starts,
        code: tapping_code(),
    };
    state.arrive(axes, state.position);
    Ok(Some(tapping))
}

/// Plans a G84 or G85 block of the Huaxing lathes: a tap with the lead in its words.
///
/// # Errors
/// 062 for wrong data, 011 or 043 for the lead, 043 for an end outside the stroke.
pub(crate) fn rigid(
    state: &mut State,
    context: &Context<'_>,
    words: &Words,
    axes: &AxisWords,
    unit: LeadUnit,
) -> Result<Tapping, Alarm> {
    let code = match unit {
        LeadUnit::Millimetres => 84,
        LeadUnit::PerInch => 85,
    };
    let from = state.position;
    let to = within_stroke(axes.target(from), context.reach())?;
    let broken = if to.x != from.x {
        Some(say::hole_moves_x())
    } else if to.z == from.z {
        Some(say::cycle_end_at_start("Z"))
    } else {
        None
    };
    if let Some(rule) = broken {
        let rule = say::dialect_decided(say::cycle_in_code(code, rule));
        return Err(Alarm::new(number::CYCLE_DATA).because(rule));
    }
    let tapping = Tapping {
        bottom: Shift::of(state).machine(to),
        way: (from.z, to.z),
        lead: lead_word::tap_lead(words, unit, code)?,
        start: 0,
        starts: 1,
        code,
    };
    state.arrive(axes, from);
    Ok(tapping)
}

impl Tapping {
    fn tap(&self) -> Action {
        Action::Tap {
            to: self.bottom,
            lead: self.lead,
            start_degrees: phase(self.start, self.starts),
        }
    }

    pub(crate) fn make(&mut self) -> Option<Move> {
        if self.start >= self.starts {
            return None;
        }
        let note = Note::Tap {
            start: self.start + 1,
            starts: self.starts,
            a: self.way.0,
            bottom: self.way.1,
            code: self.code,
        };
        let action = self.tap();
        self.start += 1;
        Some(Move::of(action, note))
    }
}

/// The start angle of a start, counted from 0, of a multi-start thread, degrees.
pub(crate) fn phase(start: u32, starts: u32) -> f64 {
    360.0 * f64::from(start) / f64::from(starts.max(1))
}
