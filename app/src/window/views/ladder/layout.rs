//! How much room a rung takes, in cells, and where it stands.

use std::sync::Arc;

use egui::{Vec2, vec2};
use gsk_core::plc::{Element, Ladder, Network, RungBody, Statement};

use super::value::operand_count;

/// Height of a title or a mark, points.
pub const TITLE: f32 = 26.0;
/// Room between two rungs, points.
pub const BETWEEN: f32 = 14.0;
/// Height of a line in a box, points.
pub const LINE: f32 = 16.0;
/// Height of the heading of a box, points.
pub const HEADING: f32 = 20.0;
/// Cells that the outputs take at the right.
pub const OUTPUT_COLUMNS: usize = 2;

/// The cell of one contact, points.
pub const fn cell(comments: bool) -> Vec2 {
    if comments {
        vec2(104.0, 76.0)
    } else {
        vec2(104.0, 48.0)
    }
}

/// A rung and its place in the drawing.
#[derive(Clone, Debug)]
pub struct Placed {
    /// The rung.
    pub network: Network,
    /// Its upper edge, points from the top.
    pub top: f32,
    /// With title and the room below, points.
    pub height: f32,
    /// Columns of contacts.
    pub columns: usize,
}

/// All rungs of a ladder, placed.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// The ladder they are of.
    pub ladder: Arc<Ladder>,
    comments: bool,
    /// The rungs from top to bottom.
    pub rungs: Vec<Placed>,
    /// Height of all, points.
    pub height: f32,
    /// Columns of contacts of the widest rung.
    pub columns: usize,
}

impl Drawing {
    /// Places the rungs of a ladder.
    pub fn new(ladder: &Arc<Ladder>, comments: bool) -> Self {
        let mut top = 0.0;
        let mut columns = 1;
        let place = |network: Network| {
            let (wide, rows) = size(&network, comments);
            columns = columns.max(wide);
            let title = if network.title.is_some() { TITLE } else { 0.0 };
            let body = match network.body {
                RungBody::Structure(_) => TITLE,
                RungBody::Rung { .. } => rows as f32 * cell(comments).y,
            };
            let height = title + body + BETWEEN;
            let placed = Placed {
                network,
                top,
                height,
                columns: wide,
            };
            top += height;
            placed
        };
        let rungs = ladder.networks().map(place).collect();
        Self {
            ladder: Arc::clone(ladder),
            comments,
            rungs,
            height: top,
            columns,
        }
    }

    /// Whether it is the drawing of this ladder.
    pub fn is_of(&self, ladder: &Arc<Ladder>, comments: bool) -> bool {
        self.comments == comments && Arc::ptr_eq(&self.ladder, ladder)
    }

    /// The rungs that lie between two heights.
    pub fn between(&self, from: f32, to: f32) -> &[Placed] {
        let first = self
            .rungs
            .partition_point(|rung| rung.top + rung.height < from);
        let end = self.rungs.partition_point(|rung| rung.top < to);
        self.rungs.get(first..end).unwrap_or_default()
    }

    /// One rung.
    pub fn rung(&self, number: u32) -> Option<&Placed> {
        let at = self
            .rungs
            .partition_point(|rung| rung.network.number < number);
        self.rungs
            .get(at)
            .filter(|rung| rung.network.number == number)
    }
}

/// Columns and rows of contacts and outputs.
fn size(network: &Network, comments: bool) -> (usize, usize) {
    match &network.body {
        RungBody::Structure(_) => (0, 1),
        RungBody::Rung { contacts, outputs } => {
            let (columns, rows) = contacts
                .iter()
                .map(cells)
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

/// Columns and rows of contacts.
pub fn cells(element: &Element) -> (usize, usize) {
    match element {
        Element::Contact(_) => (1, 1),
        Element::Series(members) => members
            .iter()
            .map(|member| cells(&member.element))
            .fold((0, 0), |(wide, high), (columns, rows)| {
                (wide + columns, high.max(rows))
            }),
        Element::Parallel(members) => members
            .iter()
            .map(|member| cells(&member.element))
            .fold((0, 0), |(wide, high), (columns, rows)| {
                (wide.max(columns), high + rows)
            }),
    }
}

/// Rows of an output: a coil has one, a box as many as its lines need.
pub fn output_rows(output: &Statement, comments: bool) -> usize {
    let lines = operand_count(output);
    if lines == 0 {
        return 1;
    }
    // The room below a rung takes the rest.
    let height = HEADING + lines as f32 * LINE + 4.0;
    (height / cell(comments).y).ceil() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing(rung: &str) -> Drawing {
        let ladder = Ladder::compile(&format!("END1\n{rung}\nEND2")).unwrap();
        Drawing::new(&Arc::new(ladder), false)
    }

    #[test]
    fn branches_lie_below_each_other_and_contacts_behind_each_other() {
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
            assert_eq!(size(&placed.network, false), (columns, rows), "{rung}");
        }
    }

    #[test]
    fn rungs_are_found_by_height_and_number() {
        let drawing = drawing("LD R1.0\nOUT R2.0\nLD R1.1\nTMRB T1 DT1 R2.1");
        assert_eq!(drawing.rungs.len(), 4);
        let third = drawing.rung(3).unwrap();
        let found = drawing.between(third.top + 1.0, third.top + 2.0);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].network.number, 3);
        assert!(drawing.rung(9).is_none());
        assert_eq!(drawing.between(0.0, drawing.height).len(), 4);
    }
}
