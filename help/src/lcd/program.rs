//! Finds the topics of program words on the LCD: codes, addresses and macro B statements. Also
//! handles the page of taught blocks.

use gsk_core::model::ModelId;
use gsk_panel::lcd::COLUMNS;
use gsk_panel::pages::PageId;
use gsk_panel::screen::Screen;

use super::words;
use crate::models::topic_of;
use crate::subject::Subject;
use crate::table::{Topic, topic};

/// LCD rows inside the frame of a page, from 0.
const INSIDE: core::ops::RangeInclusive<usize> = 1..=12;
/// First LCD row, from 0, of the program text on the page that also shows the position.
const BELOW_POSITION: usize = 5;
/// Words that begin a macro B statement.
const STATEMENTS: [&str; 6] = ["IF", "WHILE", "GOTO", "THEN", "END", "DO"];

/// Returns the topic about the program word at a row and column of the LCD, from 0. Returns
/// `None` where the page shows no program.
pub fn word_topic(
    model: ModelId,
    page: PageId,
    screen: &Screen,
    row: usize,
    column: usize,
) -> Option<&'static Topic> {
    if !INSIDE.contains(&row) {
        return None;
    }
    let only_codes = match page {
        PageId::Teach => return topic(Subject::Notion("teaching")),
        PageId::Prg => false,
        PageId::PosPrg if row >= BELOW_POSITION => false,
        PageId::Mdi | PageId::PosRel | PageId::PosAbs => true,
        _ => return None,
    };
    let all = words(screen, row, 0..COLUMNS);
    let pointed = all.iter().rfind(|word| word.at <= column)?;
    let inside = column.saturating_sub(pointed.at);
    let text: Vec<char> = pointed.text.chars().collect();
    if inside >= text.len() || !pointed.text.is_ascii() || is_in_comment(screen, row, column) {
        return None;
    }
    let statement = STATEMENTS.iter().any(|it| pointed.text.starts_with(it));
    if statement || pointed.text.starts_with('#') {
        return topic(Subject::Notion("macro B"));
    }
    let at = (0..=inside).rfind(|at| text[*at].is_ascii_uppercase() || text[*at] == '/')?;
    let digits: String = text[at + 1..]
        .iter()
        .take_while(|it| it.is_ascii_digit())
        .collect();
    let letter = text[at];
    let is_code = matches!(letter, 'G' | 'M') && !digits.is_empty();
    if only_codes && !is_code {
        return None;
    }
    address_topic(model, letter, &digits)
}

/// Whether a position is within a comment of the program, which may begin in a row above.
fn is_in_comment(screen: &Screen, row: usize, column: usize) -> bool {
    let rows = *INSIDE.start()..=row;
    let cells = rows.flat_map(|at| {
        let end = if at == row { column + 1 } else { COLUMNS };
        (0..end).map(move |column| screen.cell(at, column).character)
    });
    cells.fold(false, |is_inside, character| match character {
        '(' => true,
        ')' | ';' => false,
        _ => is_inside,
    })
}

/// Returns the topic about a program word by its address and the digits after it: the code, or
/// else the key of the address.
pub fn address_topic(model: ModelId, address: char, digits: &str) -> Option<&'static Topic> {
    if matches!(address, 'G' | 'M') && !digits.is_empty() {
        return topic_of(model, Subject::Code(&format!("{address}{digits:0>2}")));
    }
    let code = matches!(address, 'S' | 'T' | 'F').then(|| address.to_string());
    let code = code.and_then(|code| topic_of(model, Subject::Code(&code)));
    // The second letters of compound keys.
    let key = match address {
        'D' => 'U',
        'Q' => 'P',
        'C' => 'J',
        'Y' => 'H',
        address => address,
    };
    code.or_else(|| topic(Subject::Key(&key.to_string())))
}
