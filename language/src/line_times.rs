//! Machine time by the lines of a text, from which that of each tool is added up.

use gsk_core::command::{ProgramId, Source};

use crate::structure::Structure;

/// Machine time by the lines of a text. What lies between two moves belongs to the second
/// one, what is done in a subprogram to the line of the text that was met last.
///
/// It needs no [`Structure`]: the look through a program and the reading of its structure
/// can go on side by side.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineTimes {
    /// Of each line that was met, s.
    seconds: Vec<f64>,
    /// The line in work, from 0.
    current: Option<usize>,
    /// Machine time up to which the sums reach, s.
    until_s: f64,
}

impl LineTimes {
    /// A move or dwell that ends at a machine time, s.
    pub(crate) fn take(&mut self, source: Source, end_s: f64) {
        if source.program == ProgramId::External {
            let line = source.line.saturating_sub(1) as usize;
            self.current = Some(line);
            if line >= self.seconds.len() {
                self.seconds.resize(line + 1, 0.0);
            }
        }
        self.wait_until(end_s);
    }

    /// Time passes without a move.
    pub(crate) fn wait_until(&mut self, time_s: f64) {
        let passed = time_s - self.until_s;
        if passed <= 0.0 {
            return;
        }
        self.until_s = time_s;
        if let Some(seconds) = self.current.and_then(|at| self.seconds.get_mut(at)) {
            *seconds += passed;
        }
    }

    /// From each T word of the text on to the next one, s, in the order of
    /// [`Structure::tools`].
    pub fn by_tool(&self, structure: &Structure) -> Vec<f64> {
        let begins = structure.tools.iter().map(|tool| tool.place.line as usize);
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
