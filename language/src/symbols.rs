//! Lists the outline of a text: programs, tools, referenced blocks, titles.

use gsk_core::model::ModelId;

use crate::structure::Structure;
use crate::text::{TextDocument, TextRange};
use crate::words::{SpanKind, spans};

/// The kind of a symbol in the outline of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SymbolKind {
    /// The symbol is a program that begins with an O word.
    Program,
    /// The symbol is a T word, which calls a tool.
    Tool,
    /// The symbol is a block to which a word refers.
    Block,
    /// The symbol is a comment alone on its line.
    Title,
}

/// A symbol of the outline with its children.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// The displayed name of the symbol: `O0001`, `T0101`, `N10`, or the comment.
    pub name: String,
    /// Whether the symbol is a program, tool, block or comment.
    pub kind: SymbolKind,
    /// The range of the name in the text.
    pub range: TextRange,
    /// The last line that belongs to the symbol, from 0.
    pub last_line: u32,
    /// The symbols inside this one, such as the blocks of a program.
    pub children: Vec<Symbol>,
}

/// Returns the outline of a text. Symbols within a program that has an O word are the children
/// of that program.
pub fn symbols(text: &TextDocument, structure: &Structure, model: ModelId) -> Vec<Symbol> {
    let naming = model.record().program_naming();
    let mut all = Vec::new();
    for (index, part) in structure.parts.iter().enumerate() {
        let mut children = child_symbols(text, structure, index);
        children.sort_by(|one, other| one.range.cmp(&other.range));
        let Some((number, range)) = part.number.zip(part.name.clone()) else {
            all.extend(children);
            continue;
        };
        // The comment beside the O word often names the program.
        let line = text.line(range.line);
        let comment = line.find('(').and_then(|at| line.get(at..)).unwrap_or("");
        let comment = comment
            .split(')')
            .next()
            .unwrap_or("")
            .trim_start_matches('(');
        all.push(Symbol {
            name: format!("{} {}", naming.name(number), comment.trim())
                .trim_end()
                .to_owned(),
            kind: SymbolKind::Program,
            range,
            last_line: part.to.saturating_sub(1).max(part.from),
            children,
        });
    }
    all
}

/// Returns what a search through many texts finds: programs, and blocks with a number that a
/// comment names, beside the block or alone on the line above it.
pub fn named_symbols(text: &TextDocument, structure: &Structure, model: ModelId) -> Vec<Symbol> {
    let mut found: Vec<Symbol> = symbols(text, structure, model)
        .into_iter()
        .filter(|it| it.kind == SymbolKind::Program)
        .map(|it| Symbol {
            children: Vec::new(),
            ..it
        })
        .collect();
    for block in &structure.blocks {
        let line = block.word.line;
        let beside = comment_of(text.line(line));
        let title = || {
            let at = structure
                .titles
                .binary_search_by_key(&line.checked_sub(1)?, |it| it.range.line);
            Some(structure.titles.get(at.ok()?)?.text.clone())
        };
        if let Some(comment) = beside.or_else(title) {
            found.push(Symbol {
                name: format!("N{} {comment}", block.number),
                kind: SymbolKind::Block,
                range: block.word.clone(),
                last_line: line,
                children: Vec::new(),
            });
        }
    }
    found
}

/// The text of the first comment of a line; `None` without one.
fn comment_of(line: &str) -> Option<String> {
    if !line.contains(['(', '（']) {
        return None;
    }
    let spans = spans(line);
    let comment = spans.iter().find(|it| it.kind == SpanKind::Comment)?;
    let comment = line.get(comment.range.clone())?;
    let comment = comment.trim_matches(['(', ')', '（', '）']).trim();
    (!comment.is_empty()).then(|| comment.to_owned())
}

fn child_symbols(text: &TextDocument, structure: &Structure, part: usize) -> Vec<Symbol> {
    let symbol = |name: String, kind, range: &TextRange| Symbol {
        name,
        kind,
        range: range.clone(),
        last_line: range.line,
        children: Vec::new(),
    };
    let tools = structure.tools.iter().filter(|tool| tool.part == part);
    let mut found: Vec<Symbol> = tools
        .map(|tool| symbol(format!("T{}", tool.value), SymbolKind::Tool, &tool.range))
        .collect();
    let references = structure.references.iter();
    let mut targets: Vec<&TextRange> = references
        .flat_map(|reference| structure.referenced_blocks(reference))
        .filter(|block| block.part == part)
        .map(|block| &block.digits)
        .collect();
    targets.sort();
    targets.dedup();
    found.extend(targets.into_iter().map(|digits| {
        let line = text.line(digits.line);
        let number = line.get(digits.from as usize..digits.to as usize);
        symbol(
            format!("N{}", number.unwrap_or("")),
            SymbolKind::Block,
            digits,
        )
    }));
    let lines = structure.parts.get(part).map_or(0..0, |it| it.from..it.to);
    let titles = structure.titles.iter();
    let titles = titles.filter(|title| lines.contains(&title.range.line));
    found.extend(titles.map(|it| symbol(it.text.clone(), SymbolKind::Title, &it.range)));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_hold_tools_targets_and_titles() {
        let text = TextDocument::new(
            "O0001 (shaft)\n(ROUGHING)\nT0101\nG71 P10 Q20\nN10 G0 X1\nN20 X5\nN30 M98 P2\nM30\n\
             O0002\nM99\n",
        );
        let symbols = symbols(&text, &Structure::read(&text), ModelId::Gsk980td);
        let names: Vec<&str> = symbols.iter().map(|it| it.name.as_str()).collect();
        assert_eq!(names, ["O0001 shaft", "O0002"]);
        let children: Vec<&str> = symbols[0]
            .children
            .iter()
            .map(|it| it.name.as_str())
            .collect();
        assert_eq!(children, ["ROUGHING", "T0101", "N10", "N20"]);
    }

    #[test]
    fn blocks_named_by_comments_are_found() {
        let text = TextDocument::new(
            "O0001 (shaft)\n(ROUGHING)\nN10 T0101\nN20 G00 X5 (near)\nN30 X6\nM30\n",
        );
        let found = named_symbols(&text, &Structure::read(&text), ModelId::Gsk980td);
        let names: Vec<&str> = found.iter().map(|it| it.name.as_str()).collect();
        assert_eq!(names, ["O0001 shaft", "N10 ROUGHING", "N20 near"]);
    }
}
