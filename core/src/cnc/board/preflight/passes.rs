//! Finds threads that are more than one straight pass, as far as the text shows it. Macros
//! are checked at their execution.

use crate::command::BeyondPass;

/// State that earlier blocks have left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Threads {
    /// Whether threads have a run-out by No.019, which G76 P sets.
    tails: bool,
    /// The last motion code.
    motion: u32,
    /// Whether J of G92 makes a run-out; `None`: J was not given.
    j: Option<bool>,
}

/// The number after a letter; `None` for a variable.
type Value = Option<f64>;

impl Threads {
    /// State at the start; `width` is No.019.
    pub(super) const fn new(width: i32) -> Self {
        Self {
            tails: width != 0,
            motion: 0,
            j: None,
        }
    }

    /// Reads the next block. Returns the feature that a single pass cannot have.
    pub(super) fn look(&mut self, block: &str) -> Option<BeyondPass> {
        let words = words(block);
        let word = |wanted: char| {
            let found = words.iter().find(|(letter, _)| *letter == wanted);
            found.map(|(_, value)| *value)
        };
        let moves = ['X', 'U', 'Z', 'W']
            .into_iter()
            .any(|letter| word(letter).is_some());
        // A variable can have any value: it passes here.
        let is_more = |value: Value, least: f64| value.is_some_and(|value| value.abs() > least);
        let mut compound = false;
        for (letter, value) in &words {
            let code = value.filter(|_| *letter == 'G').map(|code| code as u32);
            match code {
                Some(76) => compound = true,
                Some(code @ (0..=3 | 32..=34)) => (self.motion, self.j) = (code, None),
                Some(code @ (90 | 92 | 94)) => self.motion = code,
                _ => {}
            }
        }
        if compound {
            if !moves {
                if let Some(data) = word('P') {
                    self.tails =
                        is_more(data.map(|data| (data.abs() / 100.0).floor() % 100.0), 0.0);
                }
                return None;
            }
            return self.tails.then_some(BeyondPass::RunOut);
        }
        let tail = word('J').map(|height| is_more(height, 0.0));
        match self.motion {
            34 if moves => Some(BeyondPass::LeadChange),
            32 if moves && tail == Some(true) => Some(BeyondPass::RunOut),
            92 => {
                self.j = tail.or(self.j);
                if moves && self.j.unwrap_or(self.tails) {
                    return Some(BeyondPass::RunOut);
                }
                word('L')
                    .is_some_and(|starts| is_more(starts, 1.0))
                    .then_some(BeyondPass::Start)
            }
            _ => None,
        }
    }
}

/// Letters and numbers of a block without comments.
fn words(block: &str) -> Vec<(char, Value)> {
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

fn number(text: &str) -> Value {
    let text = text.trim_start_matches([' ', '\t']);
    let end = text
        .find(|digit: char| !matches!(digit, '0'..='9' | '.' | '-' | '+'))
        .unwrap_or(text.len());
    text[..end].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The refusal of the last of these blocks.
    fn look(width: i32, blocks: &[&str]) -> Option<BeyondPass> {
        let mut threads = Threads::new(width);
        blocks.iter().fold(None, |_, block| threads.look(block))
    }

    #[test]
    fn run_outs_are_found_where_they_are_certain() {
        let tail = Some(BeyondPass::RunOut);
        assert_eq!(look(5, &["G92 X20 Z-20 F2"]), tail);
        assert_eq!(look(0, &["G92 X20 Z-20 F2"]), None);
        assert_eq!(look(5, &["G92 X20 Z-20 F2 J0"]), None);
        assert_eq!(look(5, &["G92 X20 Z-20 F2 J0", "X19"]), None);
        assert_eq!(
            look(5, &["G92 X20 Z-20 F2 J0", "G00 X40", "G92 X19 Z-20"]),
            tail
        );
        assert_eq!(look(0, &["G92 X20 Z-20 F2", "X19 J1.5"]), tail);
        assert_eq!(look(0, &["G32 Z-20 F2 J-1"]), tail);
        assert_eq!(look(0, &["G32 Z-20 F2 (J1)"]), None);
        assert_eq!(look(5, &["G01 X20 Z-20 F2"]), None);
        assert_eq!(
            look(5, &["G76 P010060 Q100", "G76 X18 Z-20 P1000 Q400 F2"]),
            None
        );
        assert_eq!(
            look(0, &["G76 P010560 Q100", "G76 X18 Z-20 P1000 Q400 F2"]),
            tail
        );
        assert_eq!(look(5, &["G76 X18 Z-20 P1000 Q400 F2"]), tail);
        assert_eq!(
            look(5, &["G92 X20 Z-20 F2 J#100"]),
            None,
            "nobody knows yet"
        );
    }

    #[test]
    fn other_starts_and_changing_leads_are_found() {
        assert_eq!(look(0, &["G92 X20 Z-20 F2 L2"]), Some(BeyondPass::Start));
        assert_eq!(look(0, &["G92 X20 Z-20 F2 L1"]), None);
        assert_eq!(look(0, &["G34 Z-20 F2 R0.1"]), Some(BeyondPass::LeadChange));
    }
}
