//! Explains refused blocks in the notation of other controls: one-block cycles in the
//! two-block form, and each further code that this control does not have.

use gsk_messages::{Message, say};

use super::block::is_address_of_model;
use super::lexer::Lexer;
use super::syntax::Syntax;
use crate::dialect::{self, with_advice};
use crate::model::{GCode, ModelRecord};

/// Greatest number of words read from a block; longer blocks get alarm 012 anyway.
const MAX_WORDS_READ: usize = 40;
/// Greatest number of characters kept of a word's number.
const MAX_NUMBER_CHARS: usize = 16;
/// Greatest number of messages about one block.
const MAX_MESSAGES: usize = 6;

/// A word as written, whether or not the control accepts it.
#[derive(Clone, Debug, PartialEq, Eq)]
struct LooseWord {
    letter: u8,
    number: String,
}

impl LooseWord {
    /// The number of the word as an integer; `None` if it is not one.
    fn integer_code(&self) -> Option<i64> {
        self.number.parse().ok()
    }
}

/// The words of a block as written, without comments.
fn loose_words(text: &str) -> Vec<LooseWord> {
    let mut lexer = Lexer::new(text);
    let mut words: Vec<LooseWord> = Vec::new();
    while words.len() <= MAX_WORDS_READ {
        let (byte, len) = lexer.peek();
        match byte {
            b'\n' | b';' | b'%' => break,
            b'(' => {
                if lexer.skip_comment().is_err() {
                    break;
                }
                continue;
            }
            b'a'..=b'z' | b'A'..=b'Z' => words.push(LooseWord {
                letter: byte.to_ascii_uppercase(),
                number: String::new(),
            }),
            b'0'..=b'9' | b'.' | b'+' | b'-' | b'#' => {
                if let Some(word) = words.last_mut()
                    && word.number.len() < MAX_NUMBER_CHARS
                {
                    word.number.push(byte.into());
                }
            }
            _ => {}
        }
        lexer.at += len;
    }
    words
}

/// A message that shows the two-block form of a roughing or threading cycle that other
/// controls write in one block with D as the depth of cut; `None` for other blocks.
pub(super) fn two_block_form(text: &str, syntax: Syntax) -> Option<Message> {
    let words = loose_words(text);
    let record = syntax.model.record();
    let number = |letter: u8| {
        let word = words.iter().find(|word| word.letter == letter)?;
        Some(word.number.as_str())
    };
    let code = words
        .iter()
        .filter(|word| word.letter == b'G')
        .find_map(|word| {
            let code = word.integer_code()?;
            Some((code, record.g_code(code)?))
        });
    let (code, meaning) = code?;
    let depth = number(b'D')?;
    let rest = |without: &[u8]| {
        let kept = words.iter().filter(|word| !without.contains(&word.letter));
        let kept = kept.filter(|word| !matches!(word.letter, b'G' | b'N' | b'O'));
        let kept: Vec<String> = kept.map(format_word).collect();
        kept.join(" ")
    };
    let (first, second) = match meaning {
        GCode::TurningRough => (format!("U{}", to_millimetres(depth)?), rest(b"D")),
        GCode::FacingRough => (format!("W{}", to_millimetres(depth)?), rest(b"D")),
        GCode::Pattern => {
            let along = |letter, name: &str| number(letter).map(|it| format!("{name}{it} "));
            let (x, z) = (along(b'I', "U"), along(b'K', "W"));
            let (x, z) = (x.unwrap_or_default(), z.unwrap_or_default());
            (format!("{x}{z}R{depth}"), rest(b"DIK"))
        }
        GCode::CompoundThread => {
            let angle = number(b'A').unwrap_or("60");
            let taper = number(b'I').map(|it| format!(" R{it}")).unwrap_or_default();
            let height = number(b'K').and_then(to_micrometres)?;
            let first = to_micrometres(depth)?;
            let second = format!("{}{taper} P{height} Q{first}", rest(b"DAIKPF"));
            let lead = number(b'F').map(|it| format!(" F{it}")).unwrap_or_default();
            (format!("P0100{angle:0>2}"), second + &lead)
        }
        _ => return None,
    };
    let block = |words: &str| format!("G{code:02} {words}");
    Some(say::instead_of_one_block_cycle(
        block(&first),
        block(&second),
    ))
}

fn format_word(word: &LooseWord) -> String {
    format!("{}{}", char::from(word.letter), word.number)
}

/// Converts a number as written to millimetres; without a point it counts units of 0.001 mm.
/// `None` if the text is not a number.
fn to_millimetres(number: &str) -> Option<String> {
    if number.contains('.') {
        return Some(number.to_owned());
    }
    let thousandths: i64 = number.parse().ok()?;
    let millimetres = format!("{}.{:03}", thousandths / 1000, thousandths.abs() % 1000);
    Some(
        millimetres
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_owned(),
    )
}

/// Converts a number as written to units of 0.001 mm; `None` if the text is not a number.
fn to_micrometres(number: &str) -> Option<i64> {
    if !number.contains('.') {
        return number.parse().ok();
    }
    let millimetres = crate::units::parse_finite(number)?;
    Some(libm::round(millimetres * 1000.0) as i64)
}

/// Messages about the unknown words of a block. If the block is refused for one of them
/// (`is_one_reported`), that one is left out: the first unknown address, otherwise the first
/// unknown code. `has_m` returns whether an M code exists.
pub(crate) fn further_foreign_words(
    text: &str,
    record: &ModelRecord,
    has_m: &dyn Fn(u8) -> bool,
    is_one_reported: bool,
) -> Vec<Message> {
    let words = loose_words(text);
    let mut seen: Vec<&LooseWord> = Vec::new();
    let mut found = Vec::new();
    let mut first_address = None;
    for word in &words {
        if seen.contains(&word) {
            continue;
        }
        seen.push(word);
        let message = match (word.letter, word.integer_code()) {
            (letter, _) if !is_address_of_model(letter, record) => {
                first_address = first_address.or(Some(found.len()));
                let rule = say::address_unknown(char::from(letter));
                with_advice(rule, dialect::advice_for_address(letter))
            }
            (b'G', Some(code @ 0..=999)) if record.g_code(code).is_none() => {
                with_advice(say::g_unknown(code), dialect::advice_for_g_code(code))
            }
            (b'M', Some(code)) => match u8::try_from(code) {
                Ok(code) if !has_m(code) => {
                    with_advice(say::m_unknown(code), dialect::advice_for_m_code(code))
                }
                _ => continue,
            },
            _ => continue,
        };
        found.push(message);
        if found.len() > MAX_MESSAGES {
            break;
        }
    }
    if is_one_reported && !found.is_empty() {
        found.remove(first_address.unwrap_or(0));
    }
    found.truncate(MAX_MESSAGES);
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Language;

    fn two_block_text(text: &str) -> Option<String> {
        let message = two_block_form(text, Syntax::default())?;
        Some(message.text(Language::En))
    }

    #[test]
    fn cycles_of_one_block_have_a_form_of_two() {
        let check_form = |text: &str, first: &str, second: &str| {
            let form = two_block_text(text).expect(text);
            assert!(form.contains(first) && form.contains(second), "{form}");
        };
        let g71 = "N5 G71 P10 Q20 U0.4 W0.1 D2000 F120;";
        check_form(g71, "G71 U2", "G71 P10 Q20 U0.4 W0.1 F120");
        check_form("G72 P1 Q2 W.1 D1.5", "G72 W1.5", "G72 P1 Q2 W.1");
        check_form(
            "G73 P1 Q2 I5. K2. U.4 D3",
            "G73 U5. W2. R3",
            "G73 P1 Q2 U.4",
        );
        let g76 = "G76 X18.05 Z-20 K0.974 D400 A60 F1.5";
        check_form(g76, "G76 P010060", "G76 X18.05 Z-20 P974 Q400 F1.5");
        assert_eq!(two_block_text("G71 P10 Q20"), None);
        assert_eq!(two_block_text("G01 X5 D2000"), None);
        assert_eq!(two_block_text("(G71 D1) G01 X5"), None);
    }

    #[test]
    fn every_foreign_word_of_a_block_is_found_once() {
        let record = Syntax::default().model.record();
        let found = |text: &str| further_foreign_words(text, record, &|code| code != 6, true).len();
        assert_eq!(found("G21 G17 G40 G80 M06 T0101"), 3);
        assert_eq!(found("G00 X5 Y1 Y2 A5"), 2);
        assert_eq!(found("G21 G21"), 0);
        let text = "G53 X0 Z0 D1";
        let also = further_foreign_words(text, record, &|_| true, true);
        assert!(also[0].text(Language::En).starts_with("G53"), "{also:?}");
        assert_eq!(found("G01 X5"), 0);
        // The block is refused for its comma: both codes are further ones.
        let also = further_foreign_words("G21 G01 X5,C2 M06", record, &|code| code != 6, false);
        assert_eq!(also.len(), 3, "{also:?}");
        assert!(found(&"G21 G17 Y1 A1 B1 C1 D1 E1 V1 ".repeat(9)) <= MAX_MESSAGES);
    }
}
