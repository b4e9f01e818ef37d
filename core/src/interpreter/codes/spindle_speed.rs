//! S with G96 and G97: spindle speed and constant surface speed (manual I-3.2.8, I-3.4).
//!
//! ```text
//!   G97 S  r/min        n = 1000 v / (pi |X|)     X the programmed diameter
//!   G96 S  m/min        G50 S: greatest n, 043: smallest n under G96
//! ```

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::SpindleCommand;
use crate::interpreter::context::BlockContext;
use crate::interpreter::exact::to_mm;
use crate::interpreter::state::State;
use crate::interpreter::words::SortedWords;

/// Greatest spindle speed that S can command, r/min.
const MAX_SPEED_RPM: f64 = 9999.0;

/// Plans the spindle command for S, G96 and G97 of a block; `None` if they change nothing.
///
/// # Errors
/// 002 for an unknown step of a stepped spindle.
pub(crate) fn plan_spindle(
    state: &mut State,
    context: &BlockContext<'_>,
    words: &SortedWords,
) -> Result<Option<SpindleCommand>, Alarm> {
    let was_surface_speed = state.modal.surface_speed;
    let is_surface_speed = words.surface.unwrap_or(was_surface_speed);
    state.modal.surface_speed = is_surface_speed;
    if !context.parameters.has_analog_spindle() {
        return plan_stepped_speed(state, words.s);
    }
    let command = match words.s.map(|speed| speed as f64) {
        Some(speed) if is_surface_speed => {
            state.surface = speed;
            SpindleCommand::Surface(speed)
        }
        Some(speed) => SpindleCommand::Speed(speed),
        None if is_surface_speed == was_surface_speed => return Ok(None),
        None if is_surface_speed => SpindleCommand::Surface(state.surface),
        // G97 without S keeps the last speed of G96, rounded to a whole number.
        None => SpindleCommand::Speed(libm::round(rpm_at_diameter(
            state.surface,
            to_mm(state.position.x),
            state.spindle_limit,
            context.parameters.lowest_surface_speed_rpm(),
        ))),
    };
    if let SpindleCommand::Surface(speed) | SpindleCommand::Speed(speed) = command {
        state.modal.spindle = speed;
    }
    Ok(Some(command))
}

/// Plans the command for a stepped spindle: the last two digits of S choose one of four outputs, 00
/// none. `None` for a block without S. Returns an alarm as error for other digits.
fn plan_stepped_speed(state: &mut State, s: Option<i64>) -> Result<Option<SpindleCommand>, Alarm> {
    let Some(s) = s else {
        return Ok(None);
    };
    let step = match u8::try_from(s % 100) {
        Ok(step) if step <= 4 => step,
        _ => {
            return Err(Alarm::new(number::BAD_VALUE).with_detail(say::spindle_step_unknown(s)));
        }
    };
    state.modal.spindle = f64::from(step);
    Ok(Some(SpindleCommand::Step(step)))
}

/// Spindle speed of G96 at a programmed diameter, r/min. `surface` is m/min, `diameter` mm,
/// `limit` (G50 S) and `lowest` (043) r/min.
pub(crate) fn rpm_at_diameter(surface: f64, diameter: f64, limit: Option<f64>, lowest: f64) -> f64 {
    let circumference = core::f64::consts::PI * diameter.abs();
    let required_rpm = if circumference > 0.0 {
        1000.0 * surface / circumference
    } else {
        MAX_SPEED_RPM
    };
    let speed = if surface > 0.0 {
        required_rpm.max(lowest).min(MAX_SPEED_RPM)
    } else {
        0.0
    };
    limit.map_or(speed, |limit| speed.min(limit))
}
