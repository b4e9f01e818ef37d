//! Takes rungs out of the source text of a ladder, and puts rungs into it.

use std::ops::Range;

use crate::ladder::Ladder;

impl Ladder {
    /// Returns the source text of the rungs `first` to `last`, counted from 1, with the title and
    /// the remarks directly above the first one; empty without such rungs.
    #[must_use]
    pub fn source_of_rungs(&self, first: u32, last: u32) -> String {
        let Some(range) = self.lines_of_rungs(first, last) else {
            return String::new();
        };
        let mut text: String = self
            .numbered_lines()
            .filter(|(number, _)| range.contains(number))
            .map(|(_, line)| line)
            .collect();
        end_line(&mut text);
        text
    }

    /// Returns the source text without the rungs `first` to `last`, their titles and remarks. The
    /// new text is not checked.
    #[must_use]
    pub fn source_without_rungs(&self, first: u32, last: u32) -> String {
        let range = self.lines_of_rungs(first, last).unwrap_or(0..0);
        self.numbered_lines()
            .filter(|(number, _)| !range.contains(number))
            .map(|(_, line)| line)
            .collect()
    }

    /// Returns the source text with `lines` after the rung `number`, or before the first rung
    /// with 0. The new text is not checked.
    #[must_use]
    pub fn source_with_rungs_after(&self, number: u32, lines: &str) -> String {
        let own = self.lines_of_rungs(number.max(1), number.max(1));
        let own = own.unwrap_or(0..u32::MAX);
        let before = if number == 0 { own.start } else { own.end };
        let mut text = String::with_capacity(self.source().len() + lines.len() + 1);
        let mut is_inserted = false;
        for (number, line) in self.numbered_lines() {
            if number >= before && !is_inserted {
                is_inserted = true;
                text.push_str(lines);
                end_line(&mut text);
            }
            text.push_str(line);
        }
        if !is_inserted {
            end_line(&mut text);
            text.push_str(lines);
            end_line(&mut text);
        }
        text
    }

    /// The lines of the source with their numbers, from 1, and their line ends.
    fn numbered_lines(&self) -> impl Iterator<Item = (u32, &str)> {
        (1..).zip(self.source().split_inclusive('\n'))
    }

    /// The lines of these rungs, from 1, with the title and the remarks above the first one.
    fn lines_of_rungs(&self, first: u32, last: u32) -> Option<Range<u32>> {
        let statements = self.statements().iter();
        let mut chosen = statements.filter(|it| (first..=last).contains(&it.rung));
        let start = chosen.next()?.line;
        let end = chosen.next_back().map_or(start, |statement| statement.line);
        let before: Vec<&str> = self.source().lines().take(start as usize - 1).collect();
        let above = before.iter().rev().take_while(|line| {
            let line = line.trim_start();
            line.starts_with(';') || line.to_ascii_uppercase().starts_with(".NET")
        });
        let above = u32::try_from(above.count()).unwrap_or(0);
        Some(start - above..end + 1)
    }
}

fn end_line(text: &mut String) {
    if !text.is_empty() && !text.ends_with('\n') {
        text.push('\n');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: &str = ".CMT X0.5 \"急停\" \"Stop\"\nEND1\n\n.NET \"A\"\n; first\nLD X0.5\nOUT R1.0\n\
                          LD R1.0\nOUT R1.1\n\n.NET \"B\"\nLD R1.1\nOUT R1.2\nEND2\n";

    fn ladder() -> Ladder {
        Ladder::compile(SOURCE).unwrap()
    }

    #[test]
    fn rungs_take_their_titles_and_remarks_with_them() {
        let ladder = ladder();
        let a = ".NET \"A\"\n; first\nLD X0.5\nOUT R1.0\n";
        assert_eq!(ladder.source_of_rungs(2, 2), a);
        let both = format!("{a}LD R1.0\nOUT R1.1\n");
        assert_eq!(ladder.source_of_rungs(2, 3), both);
        assert_eq!(
            ladder.source_of_rungs(4, 4),
            ".NET \"B\"\nLD R1.1\nOUT R1.2\n"
        );
        assert_eq!(ladder.source_of_rungs(9, 12), "");
        assert_eq!(ladder.source_without_rungs(2, 3), SOURCE.replace(&both, ""));
        assert_eq!(ladder.source_without_rungs(9, 9), SOURCE);
    }

    #[test]
    fn a_cut_and_pasted_rung_gives_the_same_text_again() {
        let ladder = ladder();
        for rung in 2..=4 {
            let cut = ladder.source_of_rungs(rung, rung);
            let rest = Ladder::compile(&ladder.source_without_rungs(rung, rung)).unwrap();
            let again = rest.source_with_rungs_after(rung - 1, &cut);
            let again = Ladder::compile(&again).unwrap();
            assert_eq!(again.to_source(), ladder.to_source(), "rung {rung}");
        }
    }

    #[test]
    fn rungs_are_inserted_at_the_start_and_at_the_end() {
        let ladder = Ladder::compile("LD X0.0\nOUT R1.0\nEND1\nEND2").unwrap();
        let rung = "LD X0.1\nOUT R1.1";
        let first = ladder.source_with_rungs_after(0, rung);
        assert_eq!(first, "LD X0.1\nOUT R1.1\nLD X0.0\nOUT R1.0\nEND1\nEND2");
        let last = ladder.source_with_rungs_after(3, "SP P1\nSPE");
        assert_eq!(last, "LD X0.0\nOUT R1.0\nEND1\nEND2\nSP P1\nSPE\n");
    }
}
