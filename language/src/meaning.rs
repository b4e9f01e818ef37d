//! Describes words and codes of the control in one line each (manual I-2, I-3, I-4).

use gsk_core::model::ModelId;
use gsk_messages::{Message, say};

use crate::words::ParsedWord;

/// Returns the meaning of a word: of its code if it is a G or M word, else of its address.
/// `None` if the GSK980TD does not have the code or address.
pub fn word_meaning(word: &ParsedWord<'_>) -> Option<Message> {
    match (word.address, word.number()) {
        ('G', Some(number)) => gsk980td_g_meaning(number),
        ('M', Some(number)) => gsk980td_m_meaning(number),
        (address, _) => letter_meaning(address, ModelId::default()),
    }
}

/// Returns the meaning of a G or M code on a model. `None` if the model does not have the
/// code.
pub fn code_meaning(address: char, number: u32, model: ModelId) -> Option<Message> {
    let record = model.record();
    let meaning = match address {
        'G' => record.g_code(number.into())?.text(),
        'M' => {
            let number = u8::try_from(number).ok()?;
            record.m_function(number)?.meaning.text()
        }
        _ => return None,
    };
    // The texts about the GSK980TD say more than those for all models.
    let own = match (model, address) {
        (ModelId::Gsk980td, 'G') => gsk980td_g_meaning(number),
        (ModelId::Gsk980td, _) => gsk980td_m_meaning(number),
        _ => None,
    };
    Some(own.unwrap_or(meaning))
}

fn gsk980td_g_meaning(number: u32) -> Option<Message> {
    Some(match number {
        0 => say::code_g00(),
        1 => say::code_g01(),
        2 => say::code_g02(),
        3 => say::code_g03(),
        4 => say::code_g04(),
        28 => say::code_g28(),
        32 => say::code_g32(),
        33 => say::code_g33(),
        34 => say::code_g34(),
        40 => say::code_g40(),
        41 => say::code_g41(),
        42 => say::code_g42(),
        50 => say::code_g50(),
        65 => say::code_g65(),
        70 => say::code_g70(),
        71 => say::code_g71(),
        72 => say::code_g72(),
        73 => say::code_g73(),
        74 => say::code_g74(),
        75 => say::code_g75(),
        76 => say::code_g76(),
        90 => say::code_g90(),
        92 => say::code_g92(),
        94 => say::code_g94(),
        96 => say::code_g96(),
        97 => say::code_g97(),
        98 => say::code_g98(),
        99 => say::code_g99(),
        _ => return None,
    })
}

fn gsk980td_m_meaning(number: u32) -> Option<Message> {
    Some(match number {
        0 => say::code_m00(),
        3 => say::code_m03(),
        4 => say::code_m04(),
        5 => say::code_m05(),
        8 => say::code_m08(),
        9 => say::code_m09(),
        10 => say::code_m10(),
        11 => say::code_m11(),
        12 => say::code_m12(),
        13 => say::code_m13(),
        30 => say::code_m30(),
        32 => say::code_m32(),
        33 => say::code_m33(),
        41 => say::code_m41(),
        42 => say::code_m42(),
        43 => say::code_m43(),
        44 => say::code_m44(),
        98 => say::code_m98(),
        99 => say::code_m99(),
        _ => return None,
    })
}

/// Returns the meaning of words with this address on a model; `None` if the model does not
/// have the address.
pub fn letter_meaning(address: char, model: ModelId) -> Option<Message> {
    if model.is_mill()
        && let Some(meaning) = mill_letter_meaning(address)
    {
        return Some(meaning);
    }
    Some(match address {
        'F' => say::word_f(),
        'H' => say::word_h(),
        'I' => say::word_i(),
        'J' => say::word_j(),
        'K' => say::word_k(),
        'L' => say::word_l(),
        'N' => say::word_n(),
        'O' => say::word_o(),
        'P' => say::word_p(),
        'Q' => say::word_q(),
        'R' => say::word_r(),
        'S' => say::word_s(),
        'T' => say::word_t(),
        'U' => say::word_u(),
        'W' => say::word_w(),
        'X' => say::word_x(),
        'Z' => say::word_z(),
        _ => return None,
    })
}

/// The meaning of an address on a mill if it differs from that on a lathe; `None` for other
/// addresses.
fn mill_letter_meaning(address: char) -> Option<Message> {
    Some(match address {
        'D' => say::mill_word_d(),
        'F' => say::mill_word_f(),
        'H' => say::mill_word_h(),
        'I' | 'J' | 'K' => say::mill_word_ijk(address),
        'L' => say::mill_word_l(),
        'P' => say::mill_word_p(),
        'Q' => say::mill_word_q(),
        'R' => say::mill_word_r(),
        'S' => say::mill_word_s(),
        'T' => say::mill_word_t(),
        'X' | 'Y' | 'Z' => say::mill_word_axis(address),
        'A' | 'B' | 'C' => say::mill_word_further(address),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::words::words;
    use gsk_messages::Language;

    #[test]
    fn codes_are_distinguished_by_their_numbers() {
        let line = "N10 G1 X20. G71 M03 M61 T0101 G5";
        let meanings: Vec<Option<String>> = words(line)
            .map(|word| word_meaning(&word).map(|meaning| meaning.text(Language::En)))
            .collect();
        let begins = |index: usize, words: &str| {
            let meaning = meanings[index].as_deref().unwrap_or_default();
            assert!(meaning.starts_with(words), "{meaning}");
        };
        begins(0, "N: ");
        begins(1, "G01: straight cut");
        begins(2, "X: end point");
        begins(3, "G71: roughing");
        begins(4, "M03: spindle forward");
        begins(6, "T: ");
        assert_eq!((&meanings[5], &meanings[7]), (&None, &None));
    }

    #[test]
    fn every_code_of_a_model_has_its_line() {
        for model in ModelId::ALL {
            let record = model.record();
            let g = record.g.keys().map(|number| ('G', *number));
            for (letter, number) in g.chain(record.m.keys().map(|number| ('M', *number))) {
                let meaning = code_meaning(letter, number.into(), model);
                assert!(meaning.is_some(), "{letter}{number} of {model:?}");
            }
        }
        assert_eq!(code_meaning('G', 5, ModelId::Gsk980td), None);
    }
}
