//! Finds foldable ranges: profiles of cycles, loops, the blocks of each tool, and programs.

use crate::structure::Structure;
use crate::text::{TextDocument, TextRange};

/// Returns the first and last line (from 0) of each part of the text that an editor can fold,
/// sorted by first line.
pub fn folds(text: &TextDocument, structure: &Structure) -> Vec<(u32, u32)> {
    let mut folds = Vec::new();
    for (index, part) in structure.parts.iter().enumerate() {
        let end = last_line(text, part.from, part.to.min(structure.block_lines.1));
        if part.name.is_some() {
            folds.push((part.from, end));
        }
        let tools = structure.tools.iter().filter(|tool| tool.part == index);
        let mut lines: Vec<u32> = tools.map(|tool| tool.range.line).collect();
        lines.dedup();
        let next = lines
            .iter()
            .skip(1)
            .copied()
            .chain([part.to.min(structure.block_lines.1)]);
        let sections = lines.iter().copied().zip(next);
        folds.extend(sections.map(|(from, next)| (from, last_line(text, from, next))));
    }
    for cycle in &structure.cycles {
        let line = |number| {
            let found = structure.blocks_in_part(number, cycle.part).next();
            found.map(|block| block.digits.line)
        };
        let (first, last) = (line(cycle.profile.0), line(cycle.profile.1));
        folds.extend(first.zip(last));
    }
    let ends = |begin: &TextRange, end: &TextRange| (begin.line, end.line);
    folds.extend(structure.loops.iter().map(|it| ends(&it.begin, &it.end)));
    folds.retain(|(from, to)| from < to);
    folds.sort_unstable();
    folds.dedup();
    folds
}

/// The last line that has text between line `from` and line `before`, which is excluded;
/// `from` if there is none.
fn last_line(text: &TextDocument, from: u32, before: u32) -> u32 {
    let mut lines = (from..before).rev();
    lines
        .find(|line| !text.line(*line).trim().is_empty())
        .unwrap_or(from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profiles_tools_loops_and_programs_fold() {
        let text = TextDocument::new(
            "O0001\nT0101\nG71 P10 Q20\nN10 G0 X1\nG1 Z-1\nN20 X5\nT0202\nWHILE [#1 LT 3] DO 1\n\
             #1=#1+1\nEND 1\nM30\n\nO0002\nM99\n",
        );
        let structure = Structure::read(&text);
        let wanted = [(0, 10), (1, 5), (3, 5), (6, 10), (7, 9), (12, 13)];
        assert_eq!(folds(&text, &structure), wanted);
    }
}
