//! Recognises programs of other controls by codes that this control lacks.

use crate::block::{ForeignBlock, ForeignWord, LinePiece};
use crate::dialect::ForeignDialect;
use crate::number::Number;
use crate::o_words::is_o_keyword;
use crate::program_numbers::{has_m, whole};
use crate::source::read_source;

/// The control for which a text seems to be written, with the word that this control lacks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DialectGuess {
    /// The most likely dialect.
    pub dialect: ForeignDialect,
    /// Line of the word in the text, from 1.
    pub line: u32,
    /// The first word that this control does not have.
    pub word: String,
}

/// Features of a text that differ between the dialects.
#[derive(Default)]
struct DialectMarks {
    foreign: Option<(u32, String)>,
    linuxcnc: bool,
    haas: bool,
    /// Modal G90 or G91, as after RS-274 and in Fanuc's system B.
    modal_g90: bool,
    /// Tool change by M06, or centres by G90.1 or G91.1.
    mach3: bool,
    has_program_number: bool,
    one_block_cycle: bool,
}

/// Returns the dialect for which a text seems to be written; `None` if all its words exist on this
/// control.
pub fn guess_dialect(text: &str) -> Option<DialectGuess> {
    let mut marks = DialectMarks::default();
    for part in read_source(text, false) {
        marks.take_block(&part.block);
    }
    let (line, word) = marks.foreign?;
    let dialect = if marks.linuxcnc {
        ForeignDialect::LinuxCnc
    } else if marks.haas {
        ForeignDialect::Haas
    } else if !marks.has_program_number && (marks.mach3 || marks.modal_g90) {
        ForeignDialect::Mach3
    } else if marks.one_block_cycle {
        ForeignDialect::Fanuc10t
    } else {
        ForeignDialect::Fanuc0t
    };
    Some(DialectGuess {
        dialect,
        line,
        word,
    })
}

impl DialectMarks {
    fn take_block(&mut self, block: &ForeignBlock) {
        let moves = block.has_any(b"XUZW");
        self.has_program_number |= block.has(b'O');
        for word in block.words() {
            if is_missing_word(word, block) {
                self.take_foreign(block.line, word.shown());
            }
            if word.letter == b'O' {
                self.haas |= word.shown().len() > 5;
            }
        }
        let has_g = |codes: &[i64]| block.g_codes().any(|code| codes.contains(&code));
        self.linuxcnc |= has_g(&[70, 80, 331]);
        self.haas |= has_m(block, 97) || has_g(&[1540, 1870]);
        self.haas |= has_g(&[530]) && moves && self.has_program_number;
        self.haas |= has_g(&[280]) && !moves && self.has_program_number;
        self.modal_g90 |= has_g(&[900, 910]) && !moves;
        self.mach3 |= has_m(block, 6) || has_g(&[901, 911]);
        let has_depth = block.has(b'D') && (block.has(b'P') || block.has(b'K'));
        if has_g(&[710, 720, 730, 760]) && has_depth {
            self.one_block_cycle = true;
            self.take_foreign(block.line, "D".to_owned());
        }
        let formula = block.pieces.iter().find_map(|piece| match piece {
            LinePiece::Formula(text) if text.trim() != "*" => Some(text.trim()),
            LinePiece::Formula(_) | LinePiece::Word(_) | LinePiece::Text(_) => None,
        });
        if let Some(keyword) = formula.filter(|text| block.has(b'O') && is_o_keyword(text)) {
            self.linuxcnc = true;
            self.take_foreign(block.line, keyword.chars().take(24).collect());
        }
        if let Some(formula) = formula.filter(|text| text.contains(['#', '=', '[', '<'])) {
            self.linuxcnc |= formula.contains('<');
            self.take_foreign(block.line, formula.chars().take(24).collect());
        }
    }

    fn take_foreign(&mut self, line: u32, word: String) {
        self.foreign.get_or_insert((line, word));
    }
}

/// Whether this control does not have a word of a lathe program.
fn is_missing_word(word: &ForeignWord, block: &ForeignBlock) -> bool {
    let number = word.number.and_then(Number::whole);
    match word.letter {
        _ if word.has_comma => true,
        b'G' => {
            let code = word.number.map_or(0, |it| it.micro / 100_000);
            let is_modal_g90 = matches!(code, 900 | 940) && !block.has_any(b"XUZW");
            let exists = matches!(
                code,
                0 | 10 | 20 | 30 | 40 | 280 | 320 | 330 | 340 | 400 | 410 | 420 | 500 | 650 | 700
                    ..=760 | 900 | 920 | 940 | 960 | 970 | 980 | 990
            );
            !exists || is_modal_g90
        }
        b'M' => matches!(number, Some(6 | 97)),
        b'L' => has_m(block, 98) && whole(block, b'P').is_some(),
        _ => false,
    }
}
