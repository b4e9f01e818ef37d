//! Signature help: the words of the code at the cursor with their meanings.

use gsk_messages::{Message, say};

use crate::ReadingContext;
use crate::codes::BlockForm;
use crate::meaning::code_meaning;
use crate::text::{Position, TextDocument};
use crate::words::{SpanKind, block_at, spans};

/// A block of a code with the words that it reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CodeSignature {
    /// The code and the letters of its words: `G71 U R F S T`.
    pub label: String,
    /// What the code does, and which of its blocks this is.
    pub about: String,
    /// The words: the range of each letter in the label, and its meaning.
    pub words: Vec<SignatureWord>,
}

/// A word of a signature.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignatureWord {
    /// First and last byte of the letter in the label, from 0; the last one is excluded.
    pub label_range: (u32, u32),
    /// The letter and the meaning of the word with its unit.
    pub meaning: String,
}

/// The signatures of the code at the cursor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignatureHelp {
    /// One signature for each block of the code.
    pub signatures: Vec<CodeSignature>,
    /// Index of the signature of the block at the cursor.
    pub active: usize,
    /// Index of the word at the cursor in that signature; `None` if the code does not read it.
    pub active_word: Option<usize>,
}

/// Returns the words of the code that reads the block at a position; `None` for a block
/// without such a code, and in comments.
pub fn signature_help(
    text: &TextDocument,
    at: Position,
    context: ReadingContext,
) -> Option<SignatureHelp> {
    let line = text.line(at.line);
    let byte = line.floor_char_boundary((at.byte as usize).min(line.len()));
    let before = &line[..byte];
    let typed = spans(before);
    let touched = typed.last();
    if touched.is_some_and(|it| it.kind == SpanKind::Comment && !ends_comment(before)) {
        return None;
    }
    let whole = spans(line);
    let block = block_at(&whole, line, byte);
    let form = BlockForm::find(text, at.line, &block, context.model)?;
    if form.forms.is_empty() {
        return None;
    }
    let signatures: Vec<CodeSignature> = (0..form.forms.len())
        .map(|index| signature(&form, index, context))
        .collect();
    // The word that ends at the cursor or begins there, else the next one that is not written.
    let ending = touched.filter(|it| it.range.end == byte);
    let beginning = || block.iter().find(|it| it.range.start == byte);
    let letter = ending
        .or_else(beginning)
        .and_then(|it| line.get(it.range.clone())?.chars().next())
        .map(|letter| letter.to_ascii_uppercase());
    let words = form.form();
    let active_word = match letter {
        Some(letter) if letter != 'G' && letter != 'M' => {
            words.iter().position(|word| word.letter == letter)
        }
        _ => {
            let written: Vec<char> = block
                .iter()
                .filter_map(|it| line.get(it.range.clone())?.chars().next())
                .map(|letter| letter.to_ascii_uppercase())
                .collect();
            words
                .iter()
                .position(|word| !written.contains(&word.letter))
        }
    };
    Some(SignatureHelp {
        signatures,
        active: form.index,
        active_word,
    })
}

fn ends_comment(text: &str) -> bool {
    text.ends_with([')', '）'])
}

fn signature(form: &BlockForm, index: usize, context: ReadingContext) -> CodeSignature {
    let mut label = form.name.clone();
    let mut words = Vec::new();
    for word in form.forms.get(index).copied().unwrap_or_default() {
        label.push(' ');
        let from = label.len() as u32;
        label.push(word.letter);
        words.push(SignatureWord {
            label_range: (from, from + 1),
            meaning: format!(
                "{}: {}",
                word.letter,
                (word.meaning)().text(context.language)
            ),
        });
    }
    let address = form.name.chars().next().unwrap_or('G');
    let number = form.name.get(1..).and_then(|it| it.parse().ok());
    let meaning = number.and_then(|number| code_meaning(address, number, context.model));
    let block: Option<Message> = match (form.forms.len(), index) {
        (1, _) => None,
        (_, 0) => Some(say::signature_first_block()),
        _ => Some(say::signature_second_block()),
    };
    let about: Vec<String> = block
        .into_iter()
        .chain(meaning)
        .map(|it| it.text(context.language))
        .collect();
    CodeSignature {
        label,
        about: about.join(" · "),
        words,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CONTEXT;

    /// The label of the active signature and the letter of the active word.
    fn help(text: &str, line: u32, byte: u32) -> Option<(String, Option<String>)> {
        let text = TextDocument::new(text);
        let help = signature_help(&text, Position { line, byte }, CONTEXT)?;
        let active = help.signatures.get(help.active)?;
        let word = help.active_word.and_then(|it| active.words.get(it));
        Some((active.label.clone(), word.map(|it| it.meaning.clone())))
    }

    fn begins(found: Option<(String, Option<String>)>, label: &str, word: &str) {
        let (shown, active) = found.expect("a signature");
        assert_eq!(shown, label);
        let active = active.unwrap_or_default();
        assert!(active.starts_with(word), "{active}");
    }

    #[test]
    fn the_two_blocks_of_a_cycle_are_distinguished() {
        let text = "G71 U2 \nG71 P10 Q20 U0.5 \nG76 P011060 Q100 R0.1\nG76 X1 P974 \nG00 X50\n";
        begins(help(text, 0, 6), "G71 U R F S T", "U: depth of each pass");
        begins(help(text, 0, 7), "G71 U R F S T", "R: ");
        begins(
            help(text, 1, 16),
            "G71 P Q U W F S T",
            "U: finishing allowance",
        );
        begins(
            help(text, 1, 4),
            "G71 P Q U W F S T",
            "P: number N of the first",
        );
        begins(
            help(text, 1, 17),
            "G71 P Q U W F S T",
            "W: finishing allowance",
        );
        begins(help(text, 2, 11), "G76 P Q R", "P: finishing passes");
        begins(
            help(text, 3, 11),
            "G76 X Z U W R P Q F I",
            "P: height of the thread",
        );
        assert_eq!(help("(a) \n", 0, 2), None);
        assert_eq!(help("T0101\n", 0, 5), None);
    }

    #[test]
    fn a_second_block_follows_the_first_one() {
        begins(help("G71 U2 R1\nG71 \n", 1, 4), "G71 P Q U W F S T", "P: ");
        begins(help("G71 \n", 0, 4), "G71 U R F S T", "U: ");
        begins(
            help("G92 X20 Z-9 F2\nX19.5 K\n", 1, 7),
            "G92 X Z U W R F I J K L",
            "K: run-out",
        );
        begins(help("M98 P\n", 0, 5), "M98 P", "P: number of calls");
    }
}
