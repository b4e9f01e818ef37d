//! The section of a form in a program: the comment that holds its values, its blocks, and the
//! comment at its end with a check sum of the blocks.
//!
//! ```text
//! (FORM turn STOCK=50 D=40 L=30 ...)
//! (FORM+ TOOL=1 ...)
//! G00 X90. Z100.
//! ...
//! (FORM END 1F3A09C2)
//! ```

use core::ops::Range;

use gsk_messages::say;

use crate::blocks;
use crate::error::FormError;
use crate::kind::FormKind;
use crate::values::FormValues;

/// Greatest length of a comment line.
const LONGEST_LINE: usize = 70;
const BEGIN: &str = "(FORM ";
const MORE: &str = "(FORM+ ";
const END: &str = "(FORM END";
/// Distance between the sequence numbers that sections begin with.
const NUMBER_STEP: u32 = 10;
/// Greatest count of sequence numbers of a section.
const NUMBERS: u32 = 4;

/// A section of a form that was found in a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormSection {
    /// The lines of the section, from 0, with both comments.
    pub lines: Range<usize>,
    /// The values of the form.
    pub values: Result<FormValues, FormError>,
    /// Whether the blocks were changed since the form wrote them.
    pub is_edited: bool,
}

/// Writes the section of a form: comments and blocks, each line with a line feed.
///
/// # Errors
/// The field whose value breaks a rule.
pub fn write_form(values: &FormValues) -> Result<String, FormError> {
    let blocks = blocks::form_blocks(values)?.into_lines();
    let mut text = String::new();
    let mut line = format!("{BEGIN}{}", values.form().word());
    for field in values.shown_fields() {
        let word = format!("{}={}", field.id, values.text(field));
        for piece in split_word(&word) {
            if line.len() + 1 + piece.len() >= LONGEST_LINE {
                text.push_str(&format!("{line})\n"));
                line = MORE.trim_end().to_owned();
            }
            line.push(' ');
            line.push_str(piece);
        }
    }
    text.push_str(&format!("{line})\n"));
    for block in &blocks {
        text.push_str(block);
        text.push('\n');
    }
    text.push_str(&format!("{END} {:08X})\n", check_sum(&blocks)));
    Ok(text)
}

/// A word in pieces that fit into a line; all but the first begin with the `/` of a point.
fn split_word(word: &str) -> Vec<&str> {
    let longest = LONGEST_LINE - MORE.len() - 1;
    let mut pieces = Vec::new();
    let mut rest = word;
    while rest.len() > longest {
        let fitting = rest.get(1..longest).and_then(|it| it.rfind('/'));
        let Some(at) = fitting else {
            break;
        };
        let (piece, more) = rest.split_at(at + 1);
        pieces.push(piece);
        rest = more;
    }
    pieces.push(rest);
    pieces
}

/// A whole program with one section: name, section, end.
pub fn whole_program(number: u16, section: &str) -> String {
    format!("O{number:04}\n{section}M05\nM30\n%\n")
}

/// Finds the sections of forms in a program.
pub fn find_sections(text: &str) -> Vec<FormSection> {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let mut found = Vec::new();
    let mut at = 0;
    while at < lines.len() {
        let line = lines[at];
        let first = at;
        at += 1;
        if !line.starts_with(BEGIN) || line.starts_with(END) {
            continue;
        }
        let mut head = comment_words(line, BEGIN).to_owned();
        while let Some(more) = lines.get(at).filter(|it| it.starts_with(MORE)) {
            let more = comment_words(more, MORE);
            if !more.starts_with('/') {
                head.push(' ');
            }
            head.push_str(more);
            at += 1;
        }
        let rest = &lines[at..];
        let is_begin = |it: &&str| it.starts_with(BEGIN) && !it.starts_with(END);
        let next = rest.iter().position(is_begin).unwrap_or(rest.len());
        let end = rest[..next].iter().position(|it| it.starts_with(END));
        let (blocks, is_edited) = match end {
            Some(end) => {
                let sum = comment_words(rest[end], END).trim();
                let sum = u32::from_str_radix(sum, 16).ok();
                (end + 1, sum != Some(check_sum(&rest[..end])))
            }
            // Without its end a section is its comment alone.
            None => (0, true),
        };
        found.push(FormSection {
            lines: first..at + blocks,
            values: read_head(&head),
            is_edited,
        });
        at += blocks;
    }
    found
}

fn comment_words<'a>(line: &'a str, begin: &str) -> &'a str {
    let words = line.get(begin.len()..).unwrap_or("");
    words.split(')').next().unwrap_or("")
}

fn read_head(head: &str) -> Result<FormValues, FormError> {
    let mut words = head.split_whitespace();
    let name = words.next().unwrap_or("");
    let form = FormKind::from_word(name);
    let form = form.ok_or_else(|| FormError::new("", say::form_unknown(name)))?;
    let mut values = FormValues::new(form);
    for word in words {
        let (id, value) = (word.split_once('='))
            .ok_or_else(|| FormError::new("", say::form_word_unreadable(word)))?;
        values.set_text(id, value)?;
    }
    Ok(values)
}

/// FNV-1a of the characters of the blocks, without blanks.
fn check_sum(blocks: &[impl AsRef<str>]) -> u32 {
    let bytes = blocks.iter().flat_map(|block| block.as_ref().bytes());
    let visible = bytes.filter(|byte| !byte.is_ascii_whitespace());
    visible.fold(0x811C_9DC5, |sum, byte| {
        (sum ^ u32::from(byte)).wrapping_mul(0x0100_0193)
    })
}

/// The first sequence number for a section that no block of the program has.
pub fn free_sequence_number(text: &str) -> u16 {
    let numbers: Vec<u32> = (text.lines())
        .filter_map(|line| {
            let digits = line.trim_start().strip_prefix(['N', 'n'])?;
            let digits: String = digits.chars().take_while(char::is_ascii_digit).collect();
            digits.parse().ok()
        })
        .collect();
    let is_free = |first: u32| (first..first + NUMBERS).all(|it| !numbers.contains(&it));
    let mut candidates = (100..9_990).step_by(NUMBER_STEP as usize);
    candidates.find(|it| is_free(*it)).unwrap_or(100) as u16
}
