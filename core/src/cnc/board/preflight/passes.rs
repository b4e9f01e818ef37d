//! Searches a program for threads that are more than one straight pass, as far as the text shows
//! it. Macros are checked at their execution.

use crate::command::ThreadPassFeature;

/// Modal state of the blocks read so far that applies to the next thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ThreadScan {
    /// Whether threads have a run-out by No.019, which G76 can change with P.
    has_run_out: bool,
    /// Number of the last G code of the motion group.
    motion: u32,
    /// Whether J of G92 makes a run-out; `None` if J has not been programmed.
    run_out_by_j: Option<bool>,
}

/// The number of a word; `None` for a variable.
type WordValue = Option<f64>;

impl ThreadScan {
    /// Creates the state before the first block; `width` is the run-out width of No.019.
    pub(super) const fn new(width: i32) -> Self {
        Self {
            has_run_out: width != 0,
            motion: 0,
            run_out_by_j: None,
        }
    }

    /// Reads the next block. Returns the feature of its thread that a single pass cannot have;
    /// `None` without one.
    pub(super) fn read_block(&mut self, block: &str) -> Option<ThreadPassFeature> {
        let words = words(block);
        let word = |wanted: char| {
            let entry = words.iter().find(|(letter, _)| *letter == wanted);
            entry.map(|(_, value)| *value)
        };
        let moves = ['X', 'U', 'Z', 'W']
            .into_iter()
            .any(|letter| word(letter).is_some());
        // A variable can have any value: it passes here.
        let is_above =
            |value: WordValue, limit: f64| value.is_some_and(|value| value.abs() > limit);
        let mut compound = false;
        for (letter, value) in &words {
            let code = value.filter(|_| *letter == 'G').map(|code| code as u32);
            match code {
                Some(76) => compound = true,
                Some(code @ (0..=3 | 32..=34)) => (self.motion, self.run_out_by_j) = (code, None),
                Some(code @ (90 | 92 | 94)) => self.motion = code,
                _ => {}
            }
        }
        if compound {
            if !moves {
                if let Some(data) = word('P') {
                    self.has_run_out =
                        is_above(data.map(|data| (data.abs() / 100.0).floor() % 100.0), 0.0);
                }
                return None;
            }
            return self.has_run_out.then_some(ThreadPassFeature::RunOut);
        }
        let run_out = word('J').map(|height| is_above(height, 0.0));
        match self.motion {
            34 if moves => Some(ThreadPassFeature::LeadChange),
            32 if moves && run_out == Some(true) => Some(ThreadPassFeature::RunOut),
            92 => {
                self.run_out_by_j = run_out.or(self.run_out_by_j);
                if moves && self.run_out_by_j.unwrap_or(self.has_run_out) {
                    return Some(ThreadPassFeature::RunOut);
                }
                word('L')
                    .is_some_and(|starts| is_above(starts, 1.0))
                    .then_some(ThreadPassFeature::StartAngle)
            }
            _ => None,
        }
    }
}

/// Splits a block into words, each a letter and a number, without comments.
fn words(block: &str) -> Vec<(char, WordValue)> {
    let mut words = Vec::new();
    let mut comment = false;
    for (at, letter) in block.char_indices() {
        match letter {
            '(' => comment = true,
            ')' => comment = false,
            _ if comment || !letter.is_ascii_alphabetic() => {}
            _ => words.push((letter.to_ascii_uppercase(), number(&block[at + 1..]))),
        }
    }
    words
}

fn number(text: &str) -> WordValue {
    let text = text.trim_start_matches([' ', '\t']);
    let end = text
        .find(|digit: char| !matches!(digit, '0'..='9' | '.' | '-' | '+'))
        .unwrap_or(text.len());
    text[..end].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads these blocks. Returns the feature found in the last one.
    fn read_blocks(width: i32, blocks: &[&str]) -> Option<ThreadPassFeature> {
        let mut threads = ThreadScan::new(width);
        blocks
            .iter()
            .fold(None, |_, block| threads.read_block(block))
    }

    #[test]
    fn run_outs_are_found_where_they_are_certain() {
        let run_out = Some(ThreadPassFeature::RunOut);
        assert_eq!(read_blocks(5, &["G92 X20 Z-20 F2"]), run_out);
        assert_eq!(read_blocks(0, &["G92 X20 Z-20 F2"]), None);
        assert_eq!(read_blocks(5, &["G92 X20 Z-20 F2 J0"]), None);
        assert_eq!(read_blocks(5, &["G92 X20 Z-20 F2 J0", "X19"]), None);
        assert_eq!(
            read_blocks(5, &["G92 X20 Z-20 F2 J0", "G00 X40", "G92 X19 Z-20"]),
            run_out
        );
        assert_eq!(read_blocks(0, &["G92 X20 Z-20 F2", "X19 J1.5"]), run_out);
        assert_eq!(read_blocks(0, &["G32 Z-20 F2 J-1"]), run_out);
        assert_eq!(read_blocks(0, &["G32 Z-20 F2 (J1)"]), None);
        assert_eq!(read_blocks(5, &["G01 X20 Z-20 F2"]), None);
        assert_eq!(
            read_blocks(5, &["G76 P010060 Q100", "G76 X18 Z-20 P1000 Q400 F2"]),
            None
        );
        assert_eq!(
            read_blocks(0, &["G76 P010560 Q100", "G76 X18 Z-20 P1000 Q400 F2"]),
            run_out
        );
        assert_eq!(read_blocks(5, &["G76 X18 Z-20 P1000 Q400 F2"]), run_out);
        assert_eq!(
            read_blocks(5, &["G92 X20 Z-20 F2 J#100"]),
            None,
            "nobody knows yet"
        );
    }

    #[test]
    fn other_starts_and_changing_leads_are_found() {
        assert_eq!(
            read_blocks(0, &["G92 X20 Z-20 F2 L2"]),
            Some(ThreadPassFeature::StartAngle)
        );
        assert_eq!(read_blocks(0, &["G92 X20 Z-20 F2 L1"]), None);
        assert_eq!(
            read_blocks(0, &["G34 Z-20 F2 R0.1"]),
            Some(ThreadPassFeature::LeadChange)
        );
    }
}
