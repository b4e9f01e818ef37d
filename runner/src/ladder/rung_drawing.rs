//! Draws a rung as SVG for the printed ladder.

use std::fmt::Write;

use gsk_core::plc::address::BitAddress;
use gsk_core::plc::{Contact, Element, Ladder, Mnemonic, Operand, PlcAddress, Statement};
use gsk_messages::{Language, say};

use super::address_text::address_comment;
use super::operand_role::{operand_line_count, operand_role};

/// Width and height of the cell of a contact, units of the picture.
const CELL: (usize, usize) = (96, 66);
/// Distance of the wire from the upper edge of its cell.
const WIRE: usize = 24;
/// Width of the column with the row number.
const NUMBER_WIDTH: usize = 40;
/// Distance from the last contact to the outputs.
const LEAD: usize = 18;
/// Columns that the outputs take.
const OUTPUT_COLUMNS: usize = 2;
/// Height of an operand line and of the heading of a box.
const LINE: usize = 12;
/// Distance of the upper edge of a box above the wire.
const BOX_ABOVE: usize = 14;

/// Draws one rung; all rungs of a page have the same width.
pub(super) struct RungDrawing<'a> {
    ladder: &'a Ladder,
    language: Language,
    /// Columns of contacts on the page.
    columns: usize,
    svg: String,
}

impl<'a> RungDrawing<'a> {
    pub(super) const fn new(ladder: &'a Ladder, language: Language, columns: usize) -> Self {
        Self {
            ladder,
            language,
            columns,
            svg: String::new(),
        }
    }

    /// Returns the picture of a rung.
    pub(super) fn draw(
        &mut self,
        number: u32,
        contacts: &[Element],
        outputs: &[Statement],
    ) -> String {
        let right = NUMBER_WIDTH + (self.columns + OUTPUT_COLUMNS) * CELL.0 + LEAD;
        let contact_rows = contacts.iter().map(|element| element.size().1).max();
        let output_rows: usize = outputs.iter().map(output_rows).sum();
        let rows = contact_rows.unwrap_or(0).max(output_rows).max(1);
        let height = rows * CELL.1;
        let _ = write!(
            self.svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {height}\" \
             fill=\"none\" stroke=\"#000\" font-size=\"11\">",
            right + 2
        );
        self.text((4, 14), "r", "start", &format!("{number:04}"));
        for x in [NUMBER_WIDTH, right] {
            self.line((x, 0), (x, height), 2);
        }
        let mut column = 0;
        for element in contacts {
            let wide = element.size().0;
            self.element(element, column, 0, wide);
            column += wide;
        }
        self.outputs(outputs, column, right);
        self.svg.push_str("</svg>");
        core::mem::take(&mut self.svg)
    }

    fn outputs(&mut self, outputs: &[Statement], column: usize, right: usize) {
        let bus = right - OUTPUT_COLUMNS * CELL.0 - LEAD / 2;
        if outputs.is_empty() {
            return;
        }
        self.line((left(column), WIRE), (bus, WIRE), 1);
        let mut row = 0;
        let mut last = 0;
        for output in outputs {
            last = row * CELL.1 + WIRE;
            self.output(output, last, (bus, right));
            row += output_rows(output);
        }
        self.line((bus, WIRE), (bus, last), 1);
    }

    fn element(&mut self, element: &Element, column: usize, row: usize, wide: usize) {
        let y = row * CELL.1 + WIRE;
        match element {
            Element::Contact(contact) => {
                self.contact(contact, left(column), y);
                self.line((left(column + 1), y), (left(column + wide), y), 1);
            }
            Element::Series(members) => {
                let mut at = column;
                for member in members {
                    let own = member.element.size().0;
                    self.element(&member.element, at, row, own);
                    at += own;
                }
                self.line((left(at), y), (left(column + wide), y), 1);
            }
            Element::Parallel(members) => {
                let mut at = row;
                let mut last = y;
                for member in members {
                    self.element(&member.element, column, at, wide);
                    last = at * CELL.1 + WIRE;
                    at += member.element.size().1;
                }
                for x in [left(column), left(column + wide)] {
                    self.line((x, y), (x, last), 1);
                }
            }
        }
    }

    fn contact(&mut self, contact: &Contact, x: usize, y: usize) {
        let middle = x + CELL.0 / 2;
        self.line((x, y), (middle - 6, y), 1);
        self.line((middle + 6, y), (x + CELL.0, y), 1);
        for bar in [middle - 6, middle + 6] {
            self.line((bar, y - 8), (bar, y + 8), 2);
        }
        if contact.normally_closed {
            self.line((middle - 8, y + 9), (middle + 8, y - 9), 1);
        }
        self.names(contact.bit, middle, y);
    }

    /// Writes the address above the wire and the comment, in up to two lines, below.
    fn names(&mut self, bit: BitAddress, middle: usize, y: usize) {
        self.text((middle, y - 12), "a", "middle", &bit.to_string());
        let comment = address_comment(self.ladder, PlcAddress::Bit(bit), self.language);
        for (index, line) in two_lines(&comment).into_iter().enumerate() {
            self.text((middle, y + 20 + index * 11), "n", "middle", &line);
        }
    }

    fn output(&mut self, output: &Statement, y: usize, (bus, right): (usize, usize)) {
        let sign = match output.mnemonic {
            Mnemonic::Out => "",
            Mnemonic::Set => "S",
            Mnemonic::Rst => "R",
            _ => return self.function_box(output, y, (bus, right)),
        };
        let Some(Operand::Bit(bit)) = output.operands.first().copied() else {
            return;
        };
        let middle = right - CELL.0 / 2 - 4;
        self.line((bus, y), (middle - 9, y), 1);
        self.line((middle + 9, y), (right, y), 1);
        let _ = write!(
            self.svg,
            "<circle cx=\"{middle}\" cy=\"{y}\" r=\"9\" stroke-width=\"2\"/>"
        );
        self.text((middle, y + 4), "a", "middle", sign);
        self.names(bit, middle, y);
    }

    fn function_box(&mut self, output: &Statement, y: usize, (bus, right): (usize, usize)) {
        let (x, top) = (bus + 14, y - BOX_ABOVE);
        let (width, height) = (right - 8 - x, box_height(output));
        self.line((bus, y), (x, y), 1);
        self.line((x + width, y), (right, y), 1);
        let _ = write!(
            self.svg,
            "<rect x=\"{x}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"/>"
        );
        let mut line = top + 12;
        self.text((x + 6, line), "a", "start", output.mnemonic.row().name);
        let kinds = output.mnemonic.row().operands;
        for (kind, operand) in kinds.iter().zip(&output.operands) {
            line += LINE;
            let role = operand_role(*kind, self.language);
            self.text((x + 6, line), "n", "start", &role);
            self.text((x + 70, line), "a", "start", &operand.to_string());
        }
        if !output.table.is_empty() {
            line += LINE;
            let role = say::ladder_operand_table().text(self.language);
            self.text((x + 6, line), "n", "start", &role);
            let entries: Vec<String> = output.table.iter().map(ToString::to_string).collect();
            self.text((x + 70, line), "n", "start", &entries.join(" "));
        }
    }

    fn line(&mut self, from: (usize, usize), to: (usize, usize), width: usize) {
        if from != to {
            let ((x1, y1), (x2, y2)) = (from, to);
            let _ = write!(
                self.svg,
                "<path d=\"M{x1} {y1}L{x2} {y2}\" stroke-width=\"{width}\"/>"
            );
        }
    }

    fn text(&mut self, (x, y): (usize, usize), class: &str, anchor: &str, text: &str) {
        if text.is_empty() {
            return;
        }
        let text = text
            .replace('&', "&amp;")
            .replace('<', "&lt;")
            .replace('>', "&gt;");
        let _ = write!(
            self.svg,
            "<text class=\"{class}\" x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" fill=\"#000\" \
             stroke=\"none\">{text}</text>"
        );
    }
}

const fn left(column: usize) -> usize {
    NUMBER_WIDTH + column * CELL.0
}

fn box_height(output: &Statement) -> usize {
    (operand_line_count(output) + 1) * LINE + 4
}

/// Returns the number of rows of cells that an output takes.
fn output_rows(output: &Statement) -> usize {
    match operand_line_count(output) {
        0 => 1,
        _ => (WIRE - BOX_ABOVE + box_height(output) + 2).div_ceil(CELL.1),
    }
}

/// Breaks a comment into at most two lines of the width of a cell, at a space where one is near.
fn two_lines(comment: &str) -> Vec<String> {
    let width = |character: char| if character.is_ascii() { 5 } else { 9 };
    let mut lines = vec![String::new()];
    let mut used = 0;
    for character in comment.chars() {
        used += width(character);
        if used > CELL.0 - 4 && lines.len() < 2 {
            let current = lines.pop().unwrap_or_default();
            let (kept, rest) = match current.rsplit_once(' ') {
                Some((kept, rest)) if !kept.is_empty() => (kept, rest),
                _ => (current.as_str(), ""),
            };
            lines.push(kept.to_owned());
            used = rest.chars().map(width).sum::<usize>() + width(character);
            lines.push(rest.to_owned());
        } else if used > CELL.0 - 4 {
            break;
        }
        if let Some(line) = lines.last_mut() {
            line.push(character);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_ends_above_the_cell_of_the_next_output() {
        let ladder = gsk_core::setup::standard_ladder();
        let boxes = ladder.statements().iter();
        for output in boxes.filter(|output| operand_line_count(output) > 0) {
            let end = WIRE - BOX_ABOVE + box_height(output);
            assert!(end < output_rows(output) * CELL.1, "{output:?}");
        }
    }

    #[test]
    fn long_comments_take_two_lines_and_end_there() {
        assert_eq!(two_lines("Key: edit"), ["Key: edit"]);
        let lines = two_lines("Feed override restored at power-on");
        assert_eq!(lines.len(), 2);
        assert_eq!(lines[0], "Feed override");
        let chinese = two_lines("系统占用通过六十五号参数修改的换档时间一和二");
        assert_eq!(
            chinese.iter().map(|it| it.chars().count()).sum::<usize>(),
            20
        );
    }
}
