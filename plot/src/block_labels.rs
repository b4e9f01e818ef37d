//! Collects the numbers of blocks at their ends, thinned so that they can be read.
//!
//! While the path grows, one number is kept for each cell of the size of a number. The layout
//! decides which of the neighbouring numbers are drawn.

use std::collections::BTreeMap;

use gsk_core::command::{ProgramId, SourcePosition};
use gsk_core::units::Point;

/// Maximum number of stored labels, with which a picture is full.
const MAX_LABELS: usize = 1 << 16;

/// Size of the smallest cell of the label grid, mm.
const FINEST_MM: f64 = 1.0 / 1024.0;

/// The number that labels a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BlockLabelNumber {
    /// The block is labelled with its sequence number (N word).
    Sequence(u32),
    /// The block has no N word and is labelled with its line number, from 1.
    Line(u32),
}

/// A label at the end point of its block.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BlockLabel {
    position: Point,
    number: BlockLabelNumber,
    /// Number of this label in the order in which labels were added, from 1.
    order: u64,
}

/// The labels of the blocks of a path, at most one in each cell of a grid.
#[derive(Clone, Debug)]
pub(super) struct BlockLabels {
    /// The label in each cell of the grid, by the indices of the cell in X and Z.
    labels_by_cell: BTreeMap<(i32, i32), BlockLabel>,
    cell_mm: f64,
    /// The block in progress, and the end of its last move; `None` before the first.
    current: Option<(SourcePosition, Point)>,
    /// The block that has set the current sequence number: program, N word and line; `None` before
    /// the first one.
    sequence_start: Option<(ProgramId, Option<u32>, u32)>,
    count: u64,
}

impl Default for BlockLabels {
    fn default() -> Self {
        Self {
            labels_by_cell: BTreeMap::new(),
            cell_mm: FINEST_MM,
            current: None,
            sequence_start: None,
            count: 0,
        }
    }
}

impl BlockLabels {
    /// Adds a move of the block `source` that ends at `to`. A new block ends the one before,
    /// which then gets its label.
    pub fn add_move(&mut self, source: SourcePosition, to: Point) {
        if let Some((block, end)) = self.current
            && (block.program, block.line) != (source.program, source.line)
        {
            self.add_label(block, end);
        }
        self.current = Some((source, to));
    }

    /// Ends the last block and adds its label.
    pub fn end(&mut self) {
        if let Some((block, end)) = self.current.take() {
            self.add_label(block, end);
        }
    }

    /// Enlarges the grid cells to the height of a label, mm.
    pub fn fit_cells(&mut self, height_mm: f64) {
        if self.cell_mm * 2.0 <= height_mm {
            self.coarsen(height_mm);
        }
    }

    /// Returns the end points of blocks with their labels, earlier blocks first.
    pub fn all(&self) -> Vec<(Point, String)> {
        let mut labels: Vec<&BlockLabel> = self.labels_by_cell.values().collect();
        labels.sort_by_key(|label| label.order);
        let words = labels.into_iter().map(|label| match label.number {
            BlockLabelNumber::Sequence(number) => (label.position, format!("N{number}")),
            BlockLabelNumber::Line(line) => (label.position, line.to_string()),
        });
        words.collect()
    }

    fn add_label(&mut self, block: SourcePosition, at: Point) {
        // A block without N has the number of the last N before it.
        let sequence = block.sequence.map(u32::from);
        let now = (block.program, sequence, block.line);
        let same = self
            .sequence_start
            .is_some_and(|(program, sequence, _)| (program, sequence) == (now.0, now.1));
        if !same {
            self.sequence_start = Some(now);
        }
        let number = match sequence {
            Some(sequence) if self.sequence_start == Some(now) => {
                BlockLabelNumber::Sequence(sequence)
            }
            _ => BlockLabelNumber::Line(block.line),
        };
        self.count += 1;
        let label = BlockLabel {
            position: at,
            number,
            order: self.count,
        };
        let cell = self.cell_at(at);
        self.labels_by_cell.entry(cell).or_insert(label);
        if self.labels_by_cell.len() > MAX_LABELS {
            self.coarsen(self.cell_mm * 2.0);
        }
    }

    fn cell_at(&self, at: Point) -> (i32, i32) {
        // The cast saturates far beyond any machine.
        let cell = |value: f64| (value / self.cell_mm).floor() as i32;
        (cell(at.x), cell(at.z))
    }

    /// Enlarges the grid cells as much as possible, to at most `most_mm`.
    fn coarsen(&mut self, most_mm: f64) {
        while self.cell_mm * 2.0 <= most_mm {
            self.cell_mm *= 2.0;
        }
        let mut labels: Vec<BlockLabel> = std::mem::take(&mut self.labels_by_cell)
            .into_values()
            .collect();
        labels.sort_by_key(|label| label.order);
        for label in labels {
            let cell = self.cell_at(label.position);
            self.labels_by_cell.entry(cell).or_insert(label);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::command::SequenceNumber;

    fn source(line: u32, sequence: Option<u32>) -> SourcePosition {
        SourcePosition {
            program: ProgramId::External,
            line,
            sequence: sequence.map(SequenceNumber::from),
        }
    }

    fn words(labels: &BlockLabels) -> Vec<String> {
        labels.all().into_iter().map(|(_, words)| words).collect()
    }

    #[test]
    fn a_block_is_called_by_its_own_number_or_its_line() {
        let mut labels = BlockLabels::default();
        let at = |z: f64| Point::new(10.0, z);
        labels.add_move(source(1, None), at(0.0));
        labels.add_move(source(2, Some(10)), at(-1.0));
        // A cycle: the block ends with its last move.
        labels.add_move(source(2, Some(10)), at(-2.0));
        // N10 is the last number before it.
        labels.add_move(source(3, Some(10)), at(-3.0));
        labels.add_move(source(4, Some(20)), at(-4.0));
        labels.end();
        assert_eq!(words(&labels), ["1", "N10", "3", "N20"]);
        assert_eq!(labels.all()[1].0, at(-2.0));
    }

    #[test]
    fn numbers_over_each_other_are_kept_once_and_bounded() {
        let mut labels = BlockLabels::default();
        labels.fit_cells(1.0);
        for round in 0..1000 {
            labels.add_move(source(1 + round % 2, None), Point::new(5.0, 0.1));
        }
        labels.end();
        assert_eq!(words(&labels), ["1"]);
        for line in 0..140_000 {
            labels.add_move(source(line, None), Point::new(f64::from(line) * 2.0, 0.0));
        }
        assert!(labels.labels_by_cell.len() <= MAX_LABELS);
    }
}
