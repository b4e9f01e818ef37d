//! Draws a rung: power rails, contacts, coils, boxes, and the power flow.

use std::ops::RangeInclusive;

use egui::{
    Align2, FontId, Pos2, Rect, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};
use gsk_core::plc::address::BitAddress;
use gsk_core::plc::{
    Contact, Element, Ladder, Mnemonic, Operand, PlcAddress, PlcMemory, PowerFlow, RungBody,
    Statement,
};
use gsk_runner::ladder::address_comment;

use super::layout::{self, OUTPUT_COLUMNS, PositionedRung, TITLE_HEIGHT};
use crate::theme;
use gsk_messages::{Language, say};

/// Width of the column with the number of the rung, points.
pub const NUMBER_WIDTH: f32 = 62.0;
/// Distance of the wire in a cell from the cell's top, points.
pub(super) const WIRE_OFFSET: f32 = 30.0;
/// Distance from the last contact to the outputs, points.
pub(super) const LEAD_LENGTH: f32 = 22.0;

/// The data that the drawing of a rung needs besides the rung.
pub struct RungContext<'a> {
    pub ladder: &'a Ladder,
    /// The PLC memory; `None` if the drawn ladder is not the running one.
    pub memory: Option<&'a PlcMemory>,
    pub language: Language,
    pub with_comments: bool,
    /// The selected statement, as an index in the program; `None` without a selection.
    pub selected: Option<usize>,
    /// Numbers of the rungs that are chosen for cut and copy; `None` without a choice.
    pub chosen_rungs: Option<RangeInclusive<u32>>,
    /// Function that returns the forced value of a bit; `None` if the bit is not forced.
    pub forced: &'a dyn Fn(BitAddress) -> Option<bool>,
    /// The address that is searched for; `None` without a search.
    pub searched: Option<PlcAddress>,
    /// Number of the rung that a halted scan executes next; `None` while the scan runs.
    pub next_rung: Option<u32>,
    /// Compiler messages about rungs: number of the rung, whether it is an error, text.
    pub compiler_messages: &'a [(u32, bool, String)],
    /// Minimum distance of the right rail from the left edge, points.
    pub min_width: f32,
}

/// Minimum width of a rung with `columns` columns of contacts, points. `comments`: with
/// comments below the contacts.
pub fn rung_width(columns: usize, comments: bool) -> f32 {
    let cells = (columns + OUTPUT_COLUMNS) as f32 * layout::cell_size(comments).x;
    NUMBER_WIDTH + cells + 2.0 * LEAD_LENGTH
}

/// Draws one rung of the ladder diagram.
pub(super) struct RungPainter<'a> {
    pub(super) ui: &'a Ui,
    pub(super) context: &'a RungContext<'a>,
    power: &'a [PowerFlow],
    /// Number of statements of the rung that are contacts or join contacts.
    contact_count: usize,
    /// Index in the program of the rung's first statement.
    first_statement: usize,
    /// Position of the left rail at the upper edge of the first row.
    origin: Pos2,
    clicked: Option<usize>,
}

/// Draws a rung with its upper left corner at `corner`. Returns the index of the statement that was
/// clicked; `None` without one.
pub fn draw_rung(
    ui: &Ui,
    sheet: &RungContext<'_>,
    placed: &PositionedRung,
    corner: Pos2,
    power: &[PowerFlow],
) -> Option<usize> {
    let network = &placed.network;
    let painter = ui.painter();
    let left = corner.x + NUMBER_WIDTH;
    let mut top = corner.y;
    if let Some(title) = &network.title {
        let at = pos2(left + 8.0, top + TITLE_HEIGHT / 2.0);
        let font = FontId::proportional(theme::TITLE_SIZE);
        let colour = theme::LADDER_TITLE;
        painter.text(at, Align2::LEFT_CENTER, title, font, colour);
        top += TITLE_HEIGHT;
    }
    let right = corner.x
        + sheet
            .min_width
            .max(rung_width(placed.columns, sheet.with_comments));
    let body = Rect::from_min_max(pos2(corner.x, top), pos2(right, corner.y + placed.height));
    if sheet.next_rung == Some(network.number) {
        let mark = Rect::from_min_size(body.min, vec2(5.0, body.height() - layout::RUNG_GAP));
        painter.rect_filled(mark, 1.0, theme::FORCED);
    }
    let chosen = sheet.chosen_rungs.as_ref();
    if chosen.is_some_and(|it| it.contains(&network.number)) {
        let size = vec2(NUMBER_WIDTH - 8.0, body.height() - layout::RUNG_GAP);
        let mark = Rect::from_min_size(body.min + vec2(6.0, 0.0), size);
        painter.rect_filled(mark, 2.0, theme::ladder_hover());
    }
    let number = format!("{:04}", network.number);
    let at = pos2(corner.x + 12.0, top + 8.0);
    painter.text(
        at,
        Align2::LEFT_TOP,
        number,
        FontId::monospace(theme::LABEL_SIZE),
        theme::LADDER_COMMENT,
    );
    let rails = egui::Rangef::new(corner.y, corner.y + placed.height);
    for x in [left, right] {
        painter.vline(x, rails, Stroke::new(2.0, theme::LADDER_RAIL));
    }
    let complaint = sheet
        .compiler_messages
        .iter()
        .find(|(rung, ..)| *rung == network.number);
    if let Some((_, error, words)) = complaint {
        let colour = if *error {
            theme::LADDER_RUNG_ERROR
        } else {
            theme::FORCED
        };
        painter.rect_stroke(
            body.shrink(2.0),
            2.0,
            Stroke::new(1.0, colour),
            StrokeKind::Inside,
        );
        let at = pos2(left + 8.0, corner.y + placed.height - 2.0);
        painter.text(
            at,
            Align2::LEFT_BOTTOM,
            words,
            FontId::proportional(theme::ANNOTATION_SIZE),
            colour,
        );
    }
    let output_count = match &network.body {
        RungBody::Structure(_) => 0,
        RungBody::Rung { outputs, .. } => outputs.len(),
    };
    let mut pen = RungPainter {
        ui,
        context: sheet,
        power,
        contact_count: network.statements().len().saturating_sub(output_count),
        first_statement: network.first,
        origin: pos2(left, top),
        clicked: None,
    };
    match &network.body {
        RungBody::Structure(mark) => pen.draw_structure_mark(mark, right),
        RungBody::Rung { contacts, outputs } => pen.draw_body(contacts, outputs, right),
    }
    pen.clicked
}

impl RungPainter<'_> {
    fn draw_structure_mark(&mut self, mark: &Statement, right: f32) {
        let rect = Rect::from_min_max(self.origin, pos2(right, self.origin.y + TITLE_HEIGHT));
        let middle = rect.center();
        let stroke = Stroke::new(1.0, theme::LADDER_DEAD);
        self.ui.painter().hline(rect.x_range(), middle.y, stroke);
        let words = mark.to_string();
        let font = FontId::monospace(theme::LABEL_SIZE);
        let words = self.ui.painter().layout_no_wrap(words, font, theme::TEXT);
        let back = Rect::from_center_size(middle, words.size() + vec2(20.0, 4.0));
        self.ui
            .painter()
            .rect_filled(back, 3.0, theme::LADDER_MARK_GROUND);
        let corner = back.center() - words.size() / 2.0;
        self.ui.painter().galley(corner, words, theme::TEXT);
        self.add_selectable(0, back, &mark.to_string());
    }

    fn draw_body(&mut self, contacts: &[Element], outputs: &[Statement], right: f32) {
        let mut column = 0;
        let mut live = true;
        for element in contacts {
            let (wide, _) = element.size();
            live = self.draw_element(element, column, 0, wide, true);
            column += wide;
        }
        let is_running = self.context.memory.is_some();
        let live = live && is_running;
        if outputs.is_empty() {
            return;
        }
        let cell = layout::cell_size(self.context.with_comments);
        let from = self.cell_corner(column, 0).x;
        let bus = right - OUTPUT_COLUMNS as f32 * cell.x - LEAD_LENGTH;
        self.draw_wire(pos2(from, self.wire_y(0)), pos2(bus, self.wire_y(0)), live);
        let of_contacts = self.contact_count;
        let mut row = 0;
        let mut last = 0;
        for (index, output) in outputs.iter().enumerate() {
            let power = self
                .power
                .get(of_contacts + index)
                .copied()
                .unwrap_or_default();
            self.draw_output(output, of_contacts + index, row, (bus, right), power);
            last = row;
            row += layout::output_rows(output, self.context.with_comments);
        }
        self.draw_wire(
            pos2(bus, self.wire_y(0)),
            pos2(bus, self.wire_y(last)),
            live,
        );
    }

    /// Draws contacts from cell `column`, `row` on, in `wide` columns; `live`: power arrives
    /// on the left. Returns true if power leaves on the right.
    fn draw_element(
        &mut self,
        element: &Element,
        column: usize,
        row: usize,
        wide: usize,
        live: bool,
    ) -> bool {
        match element {
            Element::Contact(contact) => {
                let out = self.draw_contact(contact, column, row, live);
                self.extend_wire(column + 1, column + wide, row, out);
                out
            }
            Element::Series(members) => {
                let mut at = column;
                let mut live = live;
                for member in members {
                    let (own, _) = member.element.size();
                    live = self.draw_element(&member.element, at, row, own, live);
                    at += own;
                }
                self.extend_wire(at, column + wide, row, live);
                live
            }
            Element::Parallel(members) => {
                let mut at = row;
                let mut last = row;
                let mut out = false;
                for member in members {
                    out |= self.draw_element(&member.element, column, at, wide, live);
                    last = at;
                    at += member.element.size().1;
                }
                for (column, live) in [(column, live), (column + wide, out)] {
                    let x = self.cell_corner(column, 0).x;
                    self.draw_wire(pos2(x, self.wire_y(row)), pos2(x, self.wire_y(last)), live);
                }
                out
            }
        }
    }

    fn draw_contact(&mut self, contact: &Contact, column: usize, row: usize, live: bool) -> bool {
        let cell = layout::cell_size(self.context.with_comments);
        let corner = self.cell_corner(column, row);
        let y = self.wire_y(row);
        let middle = corner.x + cell.x / 2.0;
        let power = self.power.get(contact.at).copied().unwrap_or_default();
        let out = live && power.closed;
        let rect = Rect::from_min_size(corner, cell);
        let symbol = Rect::from_center_size(pos2(middle, y), vec2(18.0, 22.0));
        self.draw_search_mark(rect, PlcAddress::Bit(contact.bit));
        self.draw_wire(pos2(corner.x, y), pos2(symbol.left(), y), live);
        self.draw_wire(pos2(symbol.right(), y), pos2(rect.right(), y), out);
        let is_running = self.context.memory.is_some();
        let closed = is_running && power.closed;
        let painter = self.ui.painter();
        if closed {
            painter.rect_filled(
                symbol.shrink2(vec2(2.0, 3.0)),
                0.0,
                theme::ladder_live_ground(),
            );
        }
        let colour = if closed {
            theme::LADDER_LIVE
        } else {
            theme::LADDER_RAIL
        };
        let stroke = Stroke::new(2.0, colour);
        for x in [symbol.left(), symbol.right()] {
            painter.vline(x, symbol.y_range(), stroke);
        }
        if contact.normally_closed {
            let line = [
                symbol.left_bottom() + vec2(1.0, 0.0),
                symbol.right_top() - vec2(1.0, 0.0),
            ];
            painter.line_segment(line, Stroke::new(1.6, colour));
        }
        self.draw_names(contact.bit, corner, cell);
        let kind = if contact.normally_closed {
            say::ladder_normally_closed().text(self.context.language)
        } else {
            say::ladder_normally_open().text(self.context.language)
        };
        self.add_selectable(contact.at, rect, &format!("{} {kind}", contact.bit));
        out
    }

    /// Draws the address of a contact above the wire and its comment below.
    fn draw_names(&self, bit: BitAddress, corner: Pos2, cell: egui::Vec2) {
        let painter = self.ui.painter();
        let forced = (self.context.forced)(bit);
        let colour = if forced.is_some() {
            theme::FORCED
        } else {
            theme::TEXT
        };
        let text = match forced {
            Some(state) => format!("{bit}={}", u8::from(state)),
            None => bit.to_string(),
        };
        let at = pos2(corner.x + cell.x / 2.0, corner.y + 3.0);
        painter.text(
            at,
            Align2::CENTER_TOP,
            text,
            FontId::monospace(theme::LABEL_SIZE),
            colour,
        );
        if self.context.with_comments {
            let words = address_comment(
                self.context.ladder,
                PlcAddress::Bit(bit),
                self.context.language,
            );
            let at = pos2(corner.x + cell.x / 2.0, corner.y + WIRE_OFFSET + 14.0);
            self.draw_two_lines(&words, at, cell.x - 8.0);
        }
    }

    fn draw_two_lines(&self, words: &str, at: Pos2, width: f32) {
        let font = FontId::proportional(theme::ANNOTATION_SIZE);
        let mut job =
            egui::text::LayoutJob::simple(words.to_owned(), font, theme::LADDER_COMMENT, width);
        job.wrap.max_rows = 2;
        job.wrap.break_anywhere = self.context.language == Language::Zh;
        job.halign = egui::Align::Center;
        let galley = self.ui.painter().layout_job(job);
        self.ui.painter().galley(at, galley, theme::LADDER_COMMENT);
    }

    fn draw_output(
        &mut self,
        output: &Statement,
        at: usize,
        row: usize,
        (bus, right): (f32, f32),
        power: PowerFlow,
    ) {
        let y = self.wire_y(row);
        let live = power.live && self.context.memory.is_some();
        let sign = match output.mnemonic {
            Mnemonic::Out => "",
            Mnemonic::Set => "S",
            Mnemonic::Rst => "R",
            _ => return self.draw_function(output, at, row, (bus, right), live),
        };
        let Some(Operand::Bit(bit)) = output.operands.first().copied() else {
            return;
        };
        let cell = layout::cell_size(self.context.with_comments);
        let middle = right - cell.x / 2.0 - 6.0;
        let corner = pos2(middle - cell.x / 2.0, y - WIRE_OFFSET);
        let rect = Rect::from_min_size(corner, cell);
        self.draw_search_mark(rect, PlcAddress::Bit(bit));
        self.draw_wire(pos2(bus, y), pos2(middle - 11.0, y), live);
        self.draw_wire(pos2(middle + 11.0, y), pos2(right, y), live);
        let on = self.context.memory.is_some() && power.closed;
        let colour = if on {
            theme::LADDER_LIVE
        } else {
            theme::LADDER_RAIL
        };
        let painter = self.ui.painter();
        if on {
            painter.circle_filled(pos2(middle, y), 10.0, theme::ladder_live_ground());
        }
        painter.circle_stroke(pos2(middle, y), 11.0, Stroke::new(2.0, colour));
        painter.text(
            pos2(middle, y),
            Align2::CENTER_CENTER,
            sign,
            FontId::proportional(theme::LABEL_SIZE),
            colour,
        );
        self.draw_names(bit, corner, cell);
        let kind = output.mnemonic.row().name;
        self.add_selectable(at, rect, &format!("{bit} {kind}"));
    }

    /// Draws the background of an element whose address is searched for.
    fn draw_search_mark(&self, rect: Rect, subject: PlcAddress) {
        let rect = rect.shrink2(vec2(3.0, 1.0));
        if self.context.searched == Some(subject) {
            self.ui
                .painter()
                .rect_filled(rect, 3.0, theme::LADDER_FOUND_GROUND);
        }
    }

    /// Makes a rectangle selectable by pointer and keyboard, for the rung's statement with
    /// index `at`, from 0; `name` is for screen readers.
    pub(super) fn add_selectable(&mut self, at: usize, rect: Rect, name: &str) {
        let index = self.first_statement + at;
        let id = self.ui.scope_id().with(("statement", index));
        // Tab reaches only elements in view: a ladder has thousands of elements.
        let sense = match self.ui.clip_rect().contains_rect(rect) {
            true => Sense::click(),
            false => Sense::CLICK,
        };
        let response = self.ui.interact(rect, id, sense);
        let chosen = self.context.selected == Some(index);
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, name));
        if response.has_focus() || chosen {
            let stroke = Stroke::new(1.4, theme::LADDER_SELECTED);
            self.ui
                .painter()
                .rect_stroke(rect, 3.0, stroke, StrokeKind::Inside);
        } else if response.hovered() {
            let stroke = Stroke::new(1.0, theme::ladder_hover());
            self.ui
                .painter()
                .rect_stroke(rect, 3.0, stroke, StrokeKind::Inside);
        }
        if response.clicked() {
            self.clicked = Some(index);
        }
    }

    /// Draws a wire from one column to another; `live`: power flows through it.
    fn extend_wire(&self, from: usize, to: usize, row: usize, live: bool) {
        if from < to {
            let y = self.wire_y(row);
            self.draw_wire(
                pos2(self.cell_corner(from, row).x, y),
                pos2(self.cell_corner(to, row).x, y),
                live,
            );
        }
    }

    pub(super) fn draw_wire(&self, from: Pos2, to: Pos2, live: bool) {
        let stroke = if live && self.context.memory.is_some() {
            Stroke::new(2.4, theme::LADDER_LIVE)
        } else {
            Stroke::new(1.4, theme::LADDER_DEAD)
        };
        self.ui.painter().line_segment([from, to], stroke);
    }

    fn cell_corner(&self, column: usize, row: usize) -> Pos2 {
        let cell = layout::cell_size(self.context.with_comments);
        self.origin + vec2(column as f32 * cell.x, row as f32 * cell.y)
    }

    pub(super) fn wire_y(&self, row: usize) -> f32 {
        self.cell_corner(0, row).y + WIRE_OFFSET
    }
}
