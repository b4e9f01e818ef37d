//! Handles the graphic pages: entering the extents, drawing the path (manual III-2.5.2).

use gsk_core::cnc::Cnc;
use gsk_core::units::Point;

use super::Panel;
use crate::pages::PageId;
use crate::trace::{PathSegment, PendingMotion};

/// Greatest value that a setting of the graphic accepts, thousandths of a millimetre.
const LARGEST: i64 = 9_999_999;
/// Greatest number without a point that is read as millimetres. Above it is read as
/// thousandths.
const LARGEST_MM: i64 = 9999;

impl Panel {
    /// Handles a key of the graphic page: S starts drawing, T stops it, R clears the path.
    pub(super) fn graphic_command(&mut self, character: char, cnc: &Cnc) {
        match character {
            'S' => {
                self.view.graphic.drawing = true;
                self.traced = Some((cnc.frame(), cnc.position_absolute()));
            }
            'T' => {
                self.view.graphic.drawing = false;
                self.traced = None;
                self.view.trace.confirm_until(u64::MAX);
            }
            'R' => self.view.trace.clear(),
            _ => {}
        }
    }

    /// Appends the motion of the last tick to the path. A new coordinate frame is not motion.
    /// Motion that a pulse board has not executed yet may be cancelled: after a stop the path
    /// ends at the board's position.
    pub(super) fn trace(&mut self, cnc: &Cnc) {
        if !self.view.graphic.drawing {
            return;
        }
        let (frame, to) = (cnc.frame(), cnc.position_absolute());
        let Some((framed, from)) = self.traced.replace((frame, to)) else {
            return;
        };
        let trace = &mut self.view.trace;
        let lag = cnc.board_lag();
        let stops = lag.map_or(self.stops, |lag| lag.resync_count);
        if core::mem::replace(&mut self.stops, stops) != stops {
            let from = frame.to_program(framed.to_machine(from));
            if !trace.end_at_stop(frame.to_machine(to)) && from != to {
                trace.push(from, to, cnc.is_rapid_under_way());
            }
            return;
        }
        let made = lag.map_or(u64::MAX, |lag| self.clock.saturating_sub(lag.ticks + 1));
        trace.confirm_until(made);
        if framed != frame || from == to {
            return;
        }
        let rapid = cnc.is_rapid_under_way();
        let piece = PathSegment { from, to, rapid };
        if lag.is_none() {
            trace.push(from, to, rapid);
        } else {
            let tick = self.clock;
            trace.push_pending(PendingMotion { tick, frame, piece });
        }
    }

    /// Enters the extents `min` to `max` of an opened program, mm with X as a radius, and
    /// starts drawing. Keeps extents that are set.
    pub fn fit_graphic(&mut self, min: Point, max: Point, cnc: &Cnc) {
        let settings = &mut self.view.graphic;
        let unset = settings.scale == 0 && settings.max_x == 0 && settings.max_z == 0;
        if !unset {
            return;
        }
        let x_factor = if cnc.parameters().is_radius_programming() {
            1.0
        } else {
            2.0
        };
        let thousandths = |mm: f64| (mm * 1000.0).round() as i32;
        settings.zx = true;
        settings.min_x = thousandths(min.x * x_factor);
        settings.max_x = thousandths(max.x * x_factor);
        settings.min_z = thousandths(min.z);
        settings.max_z = thousandths(max.z);
        settings.recompute();
        self.graphic_command('S', cnc);
    }

    /// Stores the input line as the graphic setting at the cursor. Ignores invalid values. New
    /// extents recompute scale and centre.
    pub(super) fn set_graphic(&mut self, cnc: &Cnc) {
        let input = self.view.input.trim();
        let settings = &mut self.view.graphic;
        let row = self.view.cursors.get(PageId::GraphPar).item;
        match row {
            // 坐标选择 needs the parameter switch.
            0 if cnc.rights().check_machine_data().is_err() => {}
            0 => match input {
                "0" => settings.zx = false,
                "1" => settings.zx = true,
                _ => {}
            },
            1 => {
                if let Ok(scale) = input.parse()
                    && i64::from(scale) <= LARGEST
                {
                    settings.scale = scale;
                }
            }
            _ => {
                let Some(value) = thousandths(input) else {
                    return;
                };
                match row {
                    2 => settings.center_x = value,
                    3 => settings.center_z = value,
                    4 => settings.max_x = value,
                    5 => settings.max_z = value,
                    6 => settings.min_x = value,
                    _ => settings.min_z = value,
                }
                if row > 3 {
                    settings.recompute();
                }
            }
        }
    }
}

/// Parses a length and returns it in thousandths of a millimetre; `None` if invalid. With a
/// point, or up to 9999, the text is in millimetres, otherwise in thousandths.
fn thousandths(text: &str) -> Option<i32> {
    let (sign, digits) = match text.strip_prefix('-') {
        Some(rest) => (-1, rest),
        None => (1, text),
    };
    let (whole, fraction) = match digits.split_once('.') {
        Some((whole, fraction)) => (whole, Some(fraction)),
        None => (digits, None),
    };
    let all_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let fraction_text = fraction.unwrap_or_default();
    if !all_digits(whole) || !all_digits(fraction_text) || fraction_text.len() > 3 {
        return None;
    }
    if whole.is_empty() && fraction_text.is_empty() {
        return None;
    }
    let number = |text: &str| {
        if text.is_empty() {
            Some(0)
        } else {
            text.parse::<i64>().ok()
        }
    };
    let whole = number(whole)?;
    let value = match fraction {
        None if whole > LARGEST_MM => whole,
        None => whole.checked_mul(1000)?,
        Some(_) => whole
            .checked_mul(1000)?
            .checked_add(number(&format!("{fraction_text:0<3}"))?)?,
    };
    (value <= LARGEST).then_some((sign * value) as i32)
}

#[cfg(test)]
mod tests {
    use super::thousandths;

    #[test]
    fn lengths_with_and_without_a_point() {
        assert_eq!(thousandths("150"), Some(150_000));
        assert_eq!(thousandths("150.000"), Some(150_000));
        assert_eq!(thousandths("150000"), Some(150_000));
        assert_eq!(thousandths("-10"), Some(-10_000));
        assert_eq!(thousandths("-.5"), Some(-500));
        assert_eq!(thousandths("9999.999"), Some(9_999_999));
        assert_eq!(thousandths("10000.0"), None);
        assert_eq!(thousandths("1.2345"), None);
        assert_eq!(thousandths("--1"), None);
        assert_eq!(thousandths("1-"), None);
        assert_eq!(thousandths("."), None);
        assert_eq!(thousandths(""), None);
        assert_eq!(thousandths("99999999999999999999"), None);
    }
}
