//! Draws the box of a function instruction: its operands and their current values.

use egui::{Align2, Color32, FontId, Rect, Stroke, StrokeKind, pos2, vec2};
use gsk_core::plc::{Operand, Statement};

use super::draw::{ADDRESS, COMMENT, HELD, LEAD, LIVE, Pen, RAIL, WIRE};
use super::layout::{HEADING, LINE};
use super::value;
use gsk_messages::say;

impl Pen<'_> {
    /// Draws a function instruction between the bus and the right rail.
    pub(super) fn function(
        &mut self,
        output: &Statement,
        at: usize,
        row: usize,
        (bus, right): (f32, f32),
        live: bool,
    ) {
        let y = self.wire_y(row);
        let lines = value::operand_count(output);
        let corner = pos2(bus + LEAD, y - WIRE + 8.0);
        let size = vec2(right - 10.0 - corner.x, HEADING + lines as f32 * LINE + 2.0);
        let place = Rect::from_min_size(corner, size);
        self.wire(pos2(bus, y), pos2(place.left(), y), live);
        self.wire(pos2(place.right(), y), pos2(right, y), live);
        let painter = self.ui.painter().with_clip_rect(place.expand(1.0));
        let colour = if live { LIVE } else { RAIL };
        painter.rect_filled(place, 3.0, Color32::from_gray(30));
        painter.rect_stroke(place, 3.0, Stroke::new(1.4, colour), StrokeKind::Inside);
        let head = pos2(place.left() + 8.0, place.top() + 3.0);
        let name = output.mnemonic.row().name;
        painter.text(
            head,
            Align2::LEFT_TOP,
            name,
            FontId::monospace(13.0),
            colour,
        );
        let kinds = output.mnemonic.row().operands;
        let mut top = place.top() + HEADING;
        for (kind, operand) in kinds.iter().zip(&output.operands) {
            let role = value::role(*kind, self.sheet.language);
            let font = FontId::proportional(12.0);
            painter.text(
                pos2(place.left() + 8.0, top),
                Align2::LEFT_TOP,
                role,
                font,
                COMMENT,
            );
            let text = operand.to_string();
            let forced = match operand {
                Operand::Bit(bit) => (self.sheet.forced)(*bit).is_some(),
                _ => false,
            };
            let ink = if forced { HELD } else { ADDRESS };
            let x = place.left() + 74.0;
            painter.text(
                pos2(x, top),
                Align2::LEFT_TOP,
                text,
                FontId::monospace(13.0),
                ink,
            );
            let held = self
                .sheet
                .memory
                .and_then(|memory| value::held(output, *kind, operand, memory));
            if let Some(held) = held {
                let at = pos2(place.right() - 8.0, top);
                painter.text(at, Align2::RIGHT_TOP, held, FontId::monospace(13.0), LIVE);
            }
            top += LINE;
        }
        if !output.table.is_empty() {
            let words = say::ladder_operand_table().text(self.sheet.language);
            let font = FontId::proportional(12.0);
            painter.text(
                pos2(place.left() + 8.0, top),
                Align2::LEFT_TOP,
                words,
                font,
                COMMENT,
            );
            let entries: Vec<String> = output.table.iter().map(ToString::to_string).collect();
            let at = pos2(place.left() + 74.0, top);
            painter.text(
                at,
                Align2::LEFT_TOP,
                entries.join(" "),
                FontId::monospace(12.0),
                ADDRESS,
            );
        }
        self.choose(at, place, &output.to_string());
    }
}
