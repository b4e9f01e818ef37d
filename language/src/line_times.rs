//! Adds up machine time by the lines of a text and by tool.

use gsk_core::command::{ProgramId, SourcePosition};

use crate::structure::Structure;

/// Machine time by the lines of a text. Time between two moves counts for the second move.
/// Time in a subprogram counts for the last executed line of the text.
///
/// The times do not need a [`Structure`], so a thread can run the preview while another reads
/// the structure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineTimes {
    /// Machine time of each line, s, by the index of the line from 0.
    seconds: Vec<f64>,
    /// Index of the line that was executed last, from 0; `None` before the first.
    current: Option<usize>,
    /// Machine time up to which the times of lines are complete, s.
    until_s: f64,
}

impl LineTimes {
    /// Adds a move or dwell that ends at machine time `end_s`, s, to the time of its line.
    pub(crate) fn add_move(&mut self, source: SourcePosition, end_s: f64) {
        if source.program == ProgramId::External {
            let line = source.line.saturating_sub(1) as usize;
            self.current = Some(line);
            if line >= self.seconds.len() {
                self.seconds.resize(line + 1, 0.0);
            }
        }
        self.advance_to(end_s);
    }

    /// Adds the time without a move, up to machine time `time_s`, s, to the current line.
    pub(crate) fn advance_to(&mut self, time_s: f64) {
        let passed = time_s - self.until_s;
        if passed <= 0.0 {
            return;
        }
        self.until_s = time_s;
        if let Some(seconds) = self.current.and_then(|at| self.seconds.get_mut(at)) {
            *seconds += passed;
        }
    }

    /// Returns the machine time from each T word of the text to the next one, s, in the order
    /// of [`Structure::tools`].
    pub fn by_tool(&self, structure: &Structure) -> Vec<f64> {
        let begins = structure.tools.iter().map(|tool| tool.range.line as usize);
        let ends = begins.clone().skip(1).chain([usize::MAX]);
        let from = |begin: usize, end: usize| {
            let end = end.min(self.seconds.len());
            self.seconds.get(begin..end).unwrap_or(&[]).iter().sum()
        };
        begins
            .zip(ends)
            .map(|(begin, end)| from(begin, end))
            .collect()
    }
}
