//! Subprograms and repetitions by LinuxCNC's o-words become programs that M98 calls.

use std::collections::{BTreeMap, BTreeSet};

use crate::block::split_block;
use crate::source::SourcePart;

/// First program number for repetitions and for subprograms with a name.
const FIRST_NUMBER: u32 = 9501;
/// Greatest program number, and greatest number of repetitions.
const MAX_NUMBER: u32 = 9999;
/// The keywords that follow an o-word.
const KEYWORDS: [&str; 15] = [
    "sub",
    "endsub",
    "call",
    "return",
    "if",
    "elseif",
    "else",
    "endif",
    "while",
    "endwhile",
    "do",
    "repeat",
    "endrepeat",
    "break",
    "continue",
];

/// An o-word: `o100 repeat [5]`.
#[derive(Debug, PartialEq, Eq)]
struct OWord {
    /// Number or name, in lower case.
    label: String,
    keyword: String,
    /// What follows the keyword.
    rest: String,
}

/// Whether a text after an O number is the keyword of an o-word.
pub(crate) fn is_o_keyword(text: &str) -> bool {
    let word: String = text
        .trim_start()
        .chars()
        .take_while(char::is_ascii_alphabetic)
        .collect();
    KEYWORDS.contains(&word.to_ascii_lowercase().as_str())
}

fn parse(text: &str) -> Option<OWord> {
    let text = text.trim().to_lowercase();
    let rest = text.strip_prefix('o')?.trim_start();
    let end = match rest.starts_with('<') {
        true => rest.find('>')? + 1,
        false => rest.find(|it: char| !it.is_ascii_digit())?,
    };
    let (label, rest) = rest.split_at(end);
    let rest = rest.trim_start();
    let end = rest.find(|it: char| !it.is_ascii_alphabetic());
    let (keyword, rest) = rest.split_at(end.unwrap_or(rest.len()));
    let is_known = !label.is_empty() && KEYWORDS.contains(&keyword);
    is_known.then(|| OWord {
        label: label.to_owned(),
        keyword: keyword.to_owned(),
        rest: rest.trim().to_owned(),
    })
}

/// Program numbers of the labels that a text defines.
fn number_subprograms(parts: &[SourcePart]) -> BTreeMap<String, u32> {
    let words = parts.iter().filter_map(|part| parse(&part.block.text()));
    let labels: BTreeSet<String> = words
        .filter(|word| word.keyword == "sub")
        .map(|word| word.label)
        .collect();
    let own = |label: &String| {
        label
            .parse()
            .ok()
            .filter(|it| (1..FIRST_NUMBER).contains(it))
    };
    let mut free = FIRST_NUMBER..=MAX_NUMBER;
    let numbered = labels.into_iter().filter_map(|label| {
        let number = own(&label).or_else(|| free.next())?;
        Some((label, number))
    });
    numbered.collect()
}

/// Moves subprograms and repeated blocks after the main program. Returns the lines of the words
/// that were replaced, with the words. Other o-words, and all of a text whose o-words do not
/// match, stay.
pub(crate) fn replace_o_words(parts: &mut Vec<SourcePart>) -> Vec<(u32, String)> {
    let numbers = number_subprograms(parts);
    let used = numbers.values().filter(|it| **it >= FIRST_NUMBER).count() as u32;
    let mut next = FIRST_NUMBER + used;
    // The main program, then the bodies that are open: label, closing keyword, blocks.
    let mut main = Vec::new();
    let mut open: Vec<(String, &str, Vec<SourcePart>)> = Vec::new();
    let mut closed = Vec::new();
    let mut replaced = Vec::new();
    for part in parts.iter() {
        let mut part = part.clone();
        let line = part.block.line;
        let mut set = |part: &mut SourcePart, text: String, word: &OWord| {
            part.block = split_block(line, &text);
            replaced.push((line, format!("o{} {}", word.label, word.keyword)));
        };
        let word = parse(&part.block.text());
        let mut begins = None;
        let mut ends = false;
        match &word {
            Some(word) if word.keyword == "sub" => {
                let Some(number) = numbers.get(&word.label) else {
                    return Vec::new();
                };
                begins = Some((word.label.clone(), "endsub", format!("O{number:04}")));
            }
            Some(word) if word.keyword == "repeat" => {
                let count = word.rest.trim_start_matches('[').trim_end_matches(']');
                let count = count.trim().parse().ok();
                if let Some(count) = count.filter(|it| (1..=MAX_NUMBER).contains(it))
                    && next <= MAX_NUMBER
                {
                    let call = match count {
                        1 => format!("M98 P{next:04}"),
                        _ => format!("M98 P{count}{next:04}"),
                    };
                    begins = Some((word.label.clone(), "endrepeat", format!("O{next:04}")));
                    next += 1;
                    let mut caller = part.clone();
                    set(&mut caller, call, word);
                    body(&mut main, &mut open).push(caller);
                }
            }
            Some(word) if word.keyword == "call" && word.rest.is_empty() => {
                if let Some(number) = numbers.get(&word.label) {
                    set(&mut part, format!("M98 P{number:04}"), word);
                }
            }
            Some(word) if word.keyword == "endsub" || word.keyword == "endrepeat" => {
                match open.last() {
                    Some((label, closing, _))
                        if *label == word.label && *closing == word.keyword =>
                    {
                        set(&mut part, "M99".to_owned(), word);
                        ends = true;
                    }
                    // The end of a repetition that stays.
                    _ if word.keyword == "endrepeat" => {}
                    _ => return Vec::new(),
                }
            }
            _ => {}
        }
        if let (Some((label, closing, head)), Some(word)) = (begins, &word) {
            set(&mut part, head, word);
            open.push((label, closing, vec![part]));
            continue;
        }
        body(&mut main, &mut open).push(part);
        if ends && let Some((_, _, blocks)) = open.pop() {
            closed.extend(blocks);
        }
    }
    if replaced.is_empty() || !open.is_empty() {
        return Vec::new();
    }
    name_main_program(&mut main, &numbers);
    let is_end = main
        .last()
        .is_some_and(|part| part.block.text().trim() == "%");
    let end = if is_end { main.pop() } else { None };
    for blocks in [&mut main, &mut closed] {
        if let Some(last) = blocks.last_mut().filter(|it| !it.separator.contains('\n')) {
            last.separator.push_str(last.line_end);
        }
    }
    main.extend(closed);
    main.extend(end);
    *parts = main;
    replaced
}

/// Gives the main program a number: without one, the file has that of its first subprogram.
fn name_main_program(main: &mut Vec<SourcePart>, numbers: &BTreeMap<String, u32>) {
    let is_leader = |part: &SourcePart| part.block.text().trim() == "%";
    let begin = usize::from(main.first().is_some_and(is_leader));
    let Some(first) = main.get(begin) else {
        return;
    };
    let mut head = first.clone();
    let number = (1..).find(|number| numbers.values().all(|it| it != number));
    let line = head.block.line;
    head.block = split_block(line, &format!("O{:04}", number.unwrap_or(1)));
    head.separator = head.line_end.to_owned();
    main.insert(begin, head);
}

/// The blocks to which the next one belongs.
fn body<'a>(
    main: &'a mut Vec<SourcePart>,
    open: &'a mut [(String, &str, Vec<SourcePart>)],
) -> &'a mut Vec<SourcePart> {
    open.last_mut().map_or(main, |(_, _, blocks)| blocks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::read_source;

    fn replace(text: &str) -> (String, usize) {
        let mut parts = read_source(text, true);
        let replaced = replace_o_words(&mut parts);
        let text = parts
            .iter()
            .map(|it| format!("{}{}", it.block.text(), it.separator));
        (text.collect(), replaced.len())
    }

    #[test]
    fn subprograms_and_repetitions_follow_the_main_program() {
        let (text, count) = replace(
            "o100 sub\nG1 Z-5\no100 endsub\no<groove> sub\nG1 X9\no<groove> endsub\n\
             G0 X30\no100 call\no7 repeat [3]\nG0 Z1\no<groove> call\no7 endrepeat\nM2",
        );
        assert_eq!(
            text,
            "O0001\nG0 X30\nM98 P0100\nM98 P39502\nM2\n\
             O0100\nG1 Z-5\nM99\nO9501\nG1 X9\nM99\nO9502\nG0 Z1\nM98 P9501\nM99\n"
        );
        assert_eq!(count, 9);
    }

    #[test]
    fn other_o_words_and_unmatched_ones_stay() {
        for text in [
            "o1 while [#1 GT 2]\nG0 X#1\no1 endwhile\nM2\n",
            "o1 repeat [#2]\nG0 X1\no1 endrepeat\nM2\n",
            "o1 sub\nG0 X1\nM2\n",
            "o2 call [5]\nM2\n",
            "O1000\nG0 X1\nM2\n",
        ] {
            assert_eq!(replace(text), (text.to_owned(), 0));
        }
    }
}
