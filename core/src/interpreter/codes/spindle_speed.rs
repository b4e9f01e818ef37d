//! S with G96 and G97: spindle speed and constant surface speed (manual I-3.2.8, I-3.4).
//!
//! ```text
//!   G97 S  r/min        n = 1000 v / (pi |X|)     X the programmed diameter
//!   G96 S  m/min        G50 S: greatest n, 043: smallest n under G96
//! ```

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::SpindleCommand;
use crate::interpreter::context::Context;
use crate::interpreter::context::exact::mm;
use crate::interpreter::context::state::State;
use crate::interpreter::context::words::Words;

/// Greatest spindle speed, r/min.
const GREATEST_SPEED: f64 = 9999.0;

/// The spindle command of the S, G96 and G97 of a block; `None` without a change.
///
/// # Errors
/// 002 for an unknown step of a stepped spindle.
pub(crate) fn evaluate(
    state: &mut State,
    context: &Context<'_>,
    words: &Words,
) -> Result<Option<SpindleCommand>, Alarm> {
    let was_surface = state.modal.surface_speed;
    let surface = words.surface.unwrap_or(was_surface);
    state.modal.surface_speed = surface;
    if !context.parameters.analog_spindle() {
        return stepped(state, words.s);
    }
    let command = match words.s.map(|speed| speed as f64) {
        Some(speed) if surface => {
            state.surface = speed;
            SpindleCommand::Surface(speed)
        }
        Some(speed) => SpindleCommand::Speed(speed),
        None if surface == was_surface => return Ok(None),
        None if surface => SpindleCommand::Surface(state.surface),
        // G97 without S keeps the last speed of G96, rounded to a whole number.
        None => SpindleCommand::Speed(libm::round(speed_at(
            state.surface,
            mm(state.position.x),
            state.spindle_limit,
            context.parameters.surface_lowest(),
        ))),
    };
    if let SpindleCommand::Surface(speed) | SpindleCommand::Speed(speed) = command {
        state.modal.spindle = speed;
    }
    Ok(Some(command))
}

/// The command for a stepped spindle: the last two digits of S choose one of four outputs.
fn stepped(state: &mut State, s: Option<i64>) -> Result<Option<SpindleCommand>, Alarm> {
    let Some(s) = s else {
        return Ok(None);
    };
    let step = match u8::try_from(s % 100) {
        Ok(step) if step <= 4 => step,
        _ => {
            return Err(Alarm::new(number::BAD_VALUE).because(say::spindle_step_unknown(s)));
        }
    };
    state.modal.spindle = f64::from(step);
    Ok(Some(SpindleCommand::Step(step)))
}

/// Spindle speed of G96 at a programmed diameter, r/min. `surface` is m/min, `diameter` mm,
/// `limit` (G50 S) and `lowest` (043) r/min.
pub(crate) fn speed_at(surface: f64, diameter: f64, limit: Option<f64>, lowest: f64) -> f64 {
    let around = core::f64::consts::PI * diameter.abs();
    let wanted = if around > 0.0 {
        1000.0 * surface / around
    } else {
        GREATEST_SPEED
    };
    let speed = if surface > 0.0 {
        wanted.max(lowest).min(GREATEST_SPEED)
    } else {
        0.0
    };
    limit.map_or(speed, |limit| speed.min(limit))
}
