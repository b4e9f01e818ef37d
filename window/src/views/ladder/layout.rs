//! Computes the size of rungs in cells and their position in the drawing.

use std::sync::Arc;

use egui::{Vec2, vec2};
use gsk_core::plc::{Element, Ladder, Network, RungBody, Statement};

use gsk_runner::ladder::operand_line_count;

/// Height of a title or a structure mark, points.
pub const TITLE_HEIGHT: f32 = 26.0;
/// Distance between two rungs, points.
pub const RUNG_GAP: f32 = 14.0;
/// Height of an operand line in a box, points.
pub const LINE_HEIGHT: f32 = 16.0;
/// Height of the heading of a box, points.
pub const HEADING_HEIGHT: f32 = 20.0;
/// Columns of cells that the outputs take on the right.
pub const OUTPUT_COLUMNS: usize = 2;

/// Size of the cell of one contact, points. `comments`: with comments below the contacts.
pub const fn cell_size(comments: bool) -> Vec2 {
    if comments {
        vec2(104.0, 76.0)
    } else {
        vec2(104.0, 48.0)
    }
}

/// A rung and its vertical position in the drawing.
#[derive(Clone, Debug)]
pub struct PositionedRung {
    pub network: Network,
    /// Distance of the upper edge from the top of the drawing, points.
    pub top: f32,
    /// Height including the title and the distance to the next rung, points.
    pub height: f32,
    /// Number of columns that the contacts of the rung need.
    pub columns: usize,
}

/// The positions of all rungs in the drawing of a ladder.
#[derive(Clone, Debug)]
pub struct LadderDrawing {
    /// The ladder that is drawn.
    pub ladder: Arc<Ladder>,
    with_comments: bool,
    pub rungs: Vec<PositionedRung>,
    /// Total height of all rungs, points.
    pub height: f32,
    /// Number of columns that the contacts of the widest rung need.
    pub columns: usize,
}

impl LadderDrawing {
    /// Computes the positions of the rungs. `with_comments`: with comments below the contacts.
    pub fn new(ladder: &Arc<Ladder>, with_comments: bool) -> Self {
        let mut top = 0.0;
        let mut columns = 1;
        let position_rung = |network: Network| {
            let (wide, rows) = rung_size(&network, with_comments);
            columns = columns.max(wide);
            let title = if network.title.is_some() {
                TITLE_HEIGHT
            } else {
                0.0
            };
            let body = match network.body {
                RungBody::Structure(_) => TITLE_HEIGHT,
                RungBody::Rung { .. } => rows as f32 * cell_size(with_comments).y,
            };
            let height = title + body + RUNG_GAP;
            let placed = PositionedRung {
                network,
                top,
                height,
                columns: wide,
            };
            top += height;
            placed
        };
        let rungs = ladder.networks().map(position_rung).collect();
        Self {
            ladder: Arc::clone(ladder),
            with_comments,
            rungs,
            height: top,
            columns,
        }
    }

    /// Whether the drawing was made from this ladder with this choice of comments.
    pub fn is_current(&self, ladder: &Arc<Ladder>, comments: bool) -> bool {
        self.with_comments == comments && Arc::ptr_eq(&self.ladder, ladder)
    }

    /// The rungs between two distances from the top of the drawing, points.
    pub fn rungs_between(&self, from: f32, to: f32) -> &[PositionedRung] {
        let first = self
            .rungs
            .partition_point(|rung| rung.top + rung.height < from);
        let end = self.rungs.partition_point(|rung| rung.top < to);
        self.rungs.get(first..end).unwrap_or_default()
    }

    /// The rung with this number; `None` if the ladder has none.
    pub fn rung(&self, number: u32) -> Option<&PositionedRung> {
        let at = self
            .rungs
            .partition_point(|rung| rung.network.number < number);
        self.rungs
            .get(at)
            .filter(|rung| rung.network.number == number)
    }
}

/// Number of columns of contacts, and number of rows of contacts and outputs.
fn rung_size(network: &Network, comments: bool) -> (usize, usize) {
    match &network.body {
        RungBody::Structure(_) => (0, 1),
        RungBody::Rung { contacts, outputs } => {
            let (columns, rows) = contacts
                .iter()
                .map(Element::size)
                .fold((0, 0), |(wide, high), (columns, rows)| {
                    (wide + columns, high.max(rows))
                });
            let outputs = outputs
                .iter()
                .map(|output| output_rows(output, comments))
                .sum();
            (columns, rows.max(outputs).max(1))
        }
    }
}

/// Number of rows that an output takes: one for a coil; for a box as many as its lines need.
pub fn output_rows(output: &Statement, comments: bool) -> usize {
    let lines = operand_line_count(output);
    if lines == 0 {
        return 1;
    }
    // A small excess fits into the distance to the next rung.
    let height = HEADING_HEIGHT + lines as f32 * LINE_HEIGHT + 4.0;
    (height / cell_size(comments).y).ceil() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing(rung: &str) -> LadderDrawing {
        let ladder = Ladder::compile(&format!("END1\n{rung}\nEND2")).unwrap();
        LadderDrawing::new(&Arc::new(ladder), false)
    }

    #[test]
    fn branches_add_rows_and_contacts_in_series_add_columns() {
        for (rung, columns, rows) in [
            ("LD R1.0\nOUT R2.0", 1, 1),
            ("LD R1.0\nAND R1.1\nOR R1.2\nOUT R2.0", 2, 2),
            (
                "LD R1.0\nOR R1.1\nLD R1.2\nAND R1.3\nLD R1.4\nORB\nANB\nOUT R2.0",
                3,
                2,
            ),
            ("LD R1.0\nOUT R2.0\nOUT R2.1\nSET R2.2", 1, 3),
        ] {
            let drawing = drawing(rung);
            let placed = drawing.rung(2).unwrap();
            assert_eq!(rung_size(&placed.network, false), (columns, rows), "{rung}");
        }
    }

    #[test]
    fn rungs_are_found_by_height_and_number() {
        let drawing = drawing("LD R1.0\nOUT R2.0\nLD R1.1\nTMRB T1 DT1 R2.1");
        assert_eq!(drawing.rungs.len(), 4);
        let third = drawing.rung(3).unwrap();
        let found = drawing.rungs_between(third.top + 1.0, third.top + 2.0);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].network.number, 3);
        assert!(drawing.rung(9).is_none());
        assert_eq!(drawing.rungs_between(0.0, drawing.height).len(), 4);
    }
}
