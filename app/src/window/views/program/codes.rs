//! What words and codes mean on this control (manual I-2, I-3, I-4).

use gsk_messages::{Message, say};

use super::words::Word;

/// What a word means: its code, where the control has it, else its letter.
pub fn meaning(word: Word<'_>) -> Option<Message> {
    let number = word.value.parse::<u16>().ok();
    match (word.address, number) {
        ('G', Some(number)) => code(number),
        ('M', Some(number)) => function(number),
        (address, _) => letter(address),
    }
}

fn code(number: u16) -> Option<Message> {
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

fn function(number: u16) -> Option<Message> {
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

fn letter(address: char) -> Option<Message> {
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

#[cfg(test)]
mod tests {
    use super::super::words::words;
    use super::*;
    use gsk_messages::Language;

    #[test]
    fn codes_are_told_apart_by_their_numbers() {
        let line = "N10 G1 X20. G71 M03 M61 T0101 G5";
        let told: Vec<Option<String>> = words(line)
            .map(|word| meaning(word).map(|said| said.text(Language::En)))
            .collect();
        let begins = |index: usize, words: &str| {
            let said = told[index].as_deref().unwrap_or_default();
            assert!(said.starts_with(words), "{said}");
        };
        begins(0, "N: ");
        begins(1, "G01: straight cut");
        begins(2, "X: end point");
        begins(3, "G71: roughing");
        begins(4, "M03: spindle forward");
        begins(6, "T: ");
        assert_eq!((&told[5], &told[7]), (&None, &None));
    }
}
