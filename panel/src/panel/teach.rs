//! Teach-in: the axes are moved by hand, and where they stand is taken into the
//! program (manual PLC-II 3.6).

use gsk_core::cnc::{Cnc, Request};
use gsk_core::program::Editing;
use gsk_core::units::Axis;

use super::Panel;

/// Millimetres of an inch.
const MM_PER_INCH: f64 = 25.4;

impl Panel {
    /// 输入 in a teach-in mode: the axis word at the cursor takes the absolute
    /// coordinate. Nothing is taken while an axis moves.
    pub(super) fn teach(&mut self, cnc: &Cnc, requests: &mut Vec<Request>) {
        if self.view.editor.searching || !self.view.input.is_empty() || cnc.is_moving() {
            return;
        }
        let axis = self.view.editor.editing.as_ref();
        let Some(axis) = axis.and_then(Editing::axis_word) else {
            return;
        };
        let value = programmed(cnc, axis);
        self.edit(cnc, requests, |editing| editing.teach(&value));
    }
}

/// Where an axis stands, as a program says it: diameter or radius, mm or inch.
fn programmed(cnc: &Cnc, axis: Axis) -> String {
    let at = cnc.position_absolute().get(axis);
    let radius = axis == Axis::Z || cnc.parameters().radius_programming();
    let at = if radius { at } else { at * 2.0 };
    if cnc.inch_input() {
        signed(at / MM_PER_INCH, 4)
    } else {
        signed(at, 3)
    }
}

/// A number with fixed decimals, never "-0.000".
fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|byte| matches!(byte, b'0' | b'.')) => digits.to_owned(),
        _ => text,
    }
}
