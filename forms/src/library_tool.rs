//! Takes the values of a tool into a form.

use gsk_workpiece::tool::{Insert, Tool};

use crate::blocks::side;
use crate::kind::FormKind;
use crate::tool_path::CutSide;
use crate::values::FormValues;

impl FormValues {
    /// Whether the form cuts with a tool of this kind.
    pub fn fits_tool(&self, tool: &Tool) -> bool {
        let is_inside = match self.form() {
            FormKind::Face | FormKind::PartOff => false,
            FormKind::Bore => true,
            FormKind::Turn | FormKind::Contour | FormKind::Groove | FormKind::Thread => {
                side(self) == CutSide::Inside
            }
            FormKind::Drill | FormKind::Center => {
                return matches!(tool.insert, Insert::Drill { .. });
            }
        };
        let is_kind = match self.form() {
            FormKind::Groove | FormKind::PartOff => matches!(tool.insert, Insert::Grooving { .. }),
            FormKind::Thread => matches!(tool.insert, Insert::Threading { .. }),
            _ => matches!(tool.insert, Insert::Turning { .. }),
        };
        is_kind && tool.is_internal() == is_inside
    }

    /// Sets the fields that a tool decides: its T number, nose radius, width, diameter and point
    /// angle. Returns `false`, and sets nothing, if the form does not cut with such a tool or a
    /// value is outside the range of its field.
    pub fn take_tool(&mut self, tool: &Tool, station: Option<u8>) -> bool {
        if !self.fits_tool(tool) {
            return false;
        }
        let mut values = self.clone();
        let mut fields = match tool.insert {
            Insert::Turning { .. } => vec![("NOSE", tool.nose())],
            Insert::Grooving { width, .. } => vec![("TW", width)],
            Insert::Threading { .. } => Vec::new(),
            Insert::Drill {
                diameter, point, ..
            } => vec![("D", diameter), ("POINT", point)],
        };
        fields.extend(station.map(|it| ("TOOL", f64::from(it))));
        for (id, value) in fields {
            // The nose radius of a form has three decimals, and so have its lengths.
            let text = format!("{value:.3}");
            if values.field(id).is_ok() && values.set_text(id, &text).is_err() {
                return false;
            }
        }
        *self = values;
        true
    }
}
