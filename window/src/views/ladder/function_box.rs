//! Draws the box of a function instruction: its operands and their current values.

use egui::{Align2, FontId, Rect, Stroke, StrokeKind, pos2, vec2};
use gsk_core::plc::{Operand, Statement};

use super::draw::{LEAD_LENGTH, RungPainter, WIRE_OFFSET};
use super::layout::{HEADING_HEIGHT, LINE_HEIGHT};
use super::operand_value;
use crate::theme;
use gsk_messages::say;
use gsk_runner::ladder::{operand_line_count, operand_role};

impl RungPainter<'_> {
    /// Draws a function instruction as a box between the bus and the right rail, at x
    /// coordinates `bus` and `right`; `live`: power arrives.
    pub(super) fn draw_function(
        &mut self,
        output: &Statement,
        at: usize,
        row: usize,
        (bus, right): (f32, f32),
        live: bool,
    ) {
        let y = self.wire_y(row);
        let lines = operand_line_count(output);
        let corner = pos2(bus + LEAD_LENGTH, y - WIRE_OFFSET + 8.0);
        let size = vec2(
            right - 10.0 - corner.x,
            HEADING_HEIGHT + lines as f32 * LINE_HEIGHT + 2.0,
        );
        let rect = Rect::from_min_size(corner, size);
        self.draw_wire(pos2(bus, y), pos2(rect.left(), y), live);
        self.draw_wire(pos2(rect.right(), y), pos2(right, y), live);
        let painter = self.ui.painter().with_clip_rect(rect.expand(1.0));
        let colour = if live {
            theme::LADDER_LIVE
        } else {
            theme::LADDER_RAIL
        };
        painter.rect_filled(rect, 3.0, theme::LADDER_BOX_GROUND);
        painter.rect_stroke(rect, 3.0, Stroke::new(1.4, colour), StrokeKind::Inside);
        let head = pos2(rect.left() + 8.0, rect.top() + 3.0);
        let name = output.mnemonic.row().name;
        painter.text(
            head,
            Align2::LEFT_TOP,
            name,
            FontId::monospace(theme::LABEL_SIZE),
            colour,
        );
        let kinds = output.mnemonic.row().operands;
        let mut top = rect.top() + HEADING_HEIGHT;
        for (kind, operand) in kinds.iter().zip(&output.operands) {
            let role = operand_role(*kind, self.context.language);
            let font = FontId::proportional(theme::ANNOTATION_SIZE);
            painter.text(
                pos2(rect.left() + 8.0, top),
                Align2::LEFT_TOP,
                role,
                font,
                theme::LADDER_COMMENT,
            );
            let text = operand.to_string();
            let forced = match operand {
                Operand::Bit(bit) => (self.context.forced)(*bit).is_some(),
                _ => false,
            };
            let ink = if forced { theme::FORCED } else { theme::TEXT };
            let x = rect.left() + 74.0;
            painter.text(
                pos2(x, top),
                Align2::LEFT_TOP,
                text,
                FontId::monospace(theme::LABEL_SIZE),
                ink,
            );
            let held = self
                .context
                .memory
                .and_then(|memory| operand_value::format_operand(output, *kind, operand, memory));
            if let Some(held) = held {
                let at = pos2(rect.right() - 8.0, top);
                painter.text(
                    at,
                    Align2::RIGHT_TOP,
                    held,
                    FontId::monospace(theme::LABEL_SIZE),
                    theme::LADDER_LIVE,
                );
            }
            top += LINE_HEIGHT;
        }
        if !output.table.is_empty() {
            let words = say::ladder_operand_table().text(self.context.language);
            let font = FontId::proportional(theme::ANNOTATION_SIZE);
            painter.text(
                pos2(rect.left() + 8.0, top),
                Align2::LEFT_TOP,
                words,
                font,
                theme::LADDER_COMMENT,
            );
            let entries: Vec<String> = output.table.iter().map(ToString::to_string).collect();
            let at = pos2(rect.left() + 74.0, top);
            painter.text(
                at,
                Align2::LEFT_TOP,
                entries.join(" "),
                FontId::monospace(theme::ANNOTATION_SIZE),
                theme::TEXT,
            );
        }
        self.add_selectable(at, rect, &output.to_string());
    }
}
