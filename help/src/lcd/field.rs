//! Finds a field of a page by the label to its left or above it.

use core::ops::{Range, RangeInclusive};

use gsk_messages::{Language, Message, say};
use gsk_panel::lcd::COLUMNS;
use gsk_panel::pages::PageId;
use gsk_panel::screen::Screen;

use super::words;
use crate::subject::Subject;
use crate::table::{Topic, topic, topics};

/// LCD rows that every page has, from 0: title, input line, and state with mode.
const TITLE_ROW: usize = 0;
const INPUT_ROW: usize = 13;
const STATE_ROW: usize = 14;
/// Page name in the subjects of fields that several pages share.
const ANY: &str = "*";

/// Where labels are column headings: page, row of the headings, rows below them (from 0).
const HEADINGS: [(PageId, usize, RangeInclusive<usize>); 12] = [
    (PageId::Oft, 1, 2..=9),
    (PageId::Macro, 1, 2..=9),
    (PageId::Pitch, 1, 2..=9),
    (PageId::PlcValues, 1, 2..=9),
    (PageId::ParBit, 1, 2..=9),
    (PageId::ParData, 1, 2..=9),
    (PageId::Dgn, 1, 2..=9),
    (PageId::PlcBits, 1, 2..=9),
    (PageId::PosAll, 2, 3..=6),
    (PageId::PosAll, 7, 8..=11),
    (PageId::PosPrg, 1, 2..=4),
    (PageId::Dir, 4, 5..=12),
];

/// Texts of the operating mode in the state row, and the subjects that explain them.
const MODES: [(fn() -> Message, Subject<'static>); 12] = [
    (say::lcd_mode_teach_handwheel, Subject::Notion("teach-in")),
    (say::lcd_mode_teach_jog, Subject::Notion("teach-in")),
    (say::lcd_mode_teach_step, Subject::Notion("teach-in")),
    (say::lcd_mode_auto, Subject::Key("AUTO")),
    (say::lcd_mode_dnc, Subject::Notion("DNC")),
    (say::lcd_mode_edit, Subject::Key("EDIT")),
    (say::lcd_mode_handwheel, Subject::Key("HND")),
    (say::lcd_mode_jog, Subject::Key("JOG")),
    (say::lcd_mode_machine_zero, Subject::Key("ZRN")),
    (say::lcd_mode_mdi, Subject::Key("MDI")),
    (say::lcd_mode_program_zero, Subject::Key("PZRN")),
    (say::lcd_mode_step, Subject::Key("HND")),
];
/// LCD columns, from 0, that contain the operating mode.
const MODE_COLUMNS: Range<usize> = 20..30;

/// Returns the topic about the field of a page at a row and column of the LCD, from 0; `None`
/// if no topic is about it.
pub fn field_topic(
    page: PageId,
    screen: &Screen,
    row: usize,
    column: usize,
) -> Option<&'static Topic> {
    if row == STATE_ROW && MODE_COLUMNS.contains(&column) {
        let shown = screen.row(row);
        let is = |text: &fn() -> Message, language| shown.contains(&text().text(language));
        let mode = MODES
            .iter()
            .find(|(text, _)| is(text, Language::Zh) || is(text, Language::En));
        return mode.and_then(|(_, subject)| topic(*subject));
    }
    let all = words(screen, row, 0..COLUMNS);
    let word = all.iter().rfind(|word| word.at <= column)?;
    let head = HEADINGS
        .iter()
        .find(|(of, _, below)| *of == page && below.contains(&row));
    if let Some((_, head, _)) = head {
        return headed(page, screen, *head, word.at + word.text.len() / 2);
    }
    let labels = labels(page, screen, row);
    let left = labels.iter().rfind(|label| label.columns.start <= column);
    left.or(labels.first().filter(|_| INSIDE.contains(&row)))
        .map(|label| label.topic)
}

/// LCD rows inside the frame of a page, from 0.
const INSIDE: RangeInclusive<usize> = 1..=12;

/// Returns the topic of the column heading in `row` whose middle is nearest to the column
/// `middle`; `None` if the row has no heading.
fn headed(page: PageId, screen: &Screen, row: usize, middle: usize) -> Option<&'static Topic> {
    let labels = labels(page, screen, row);
    let nearest = labels.into_iter().min_by_key(|label| {
        let columns = &label.columns;
        (columns.start + columns.end).abs_diff(2 * middle)
    });
    nearest.map(|label| label.topic)
}

/// A label on the LCD: its columns, and the topic about its field.
struct Label {
    columns: Range<usize>,
    topic: &'static Topic,
}

/// Returns the labels in a row from left to right. Labels of this page alone exclude those
/// that several pages share.
fn labels(page: PageId, screen: &Screen, row: usize) -> Vec<Label> {
    let cells: Vec<(usize, char)> = (0..COLUMNS)
        .map(|column| (column, screen.cell(row, column).character))
        .filter(|(_, character)| !matches!(character, '\0' | ' ' | '_'))
        .collect();
    let of = |name: &str| {
        let mut found = Vec::new();
        for topic in topics() {
            if let Subject::Field(on, label) = topic.subject
                && on == name
                && (name != ANY || is_possible_in(label, row))
            {
                found.extend(in_row(&cells, label).map(|columns| Label { columns, topic }));
            }
        }
        found
    };
    let framed = matches!(row, TITLE_ROW | INPUT_ROW | STATE_ROW);
    let mut labels = if framed { Vec::new() } else { of(page.name()) };
    if labels.is_empty() {
        labels = of(ANY);
    }
    // Of labels that begin in one column, the longest wins: 主轴转速 before 转速.
    labels.sort_by_key(|label| {
        let Range { start, end } = label.columns;
        (start, core::cmp::Reverse(end))
    });
    let mut until = 0;
    labels.retain(|label| {
        let free = label.columns.start >= until;
        if free {
            until = label.columns.end;
        }
        free
    });
    labels
}

/// Returns whether a label that pages share is possible in a row: O, N, S and T in their rows
/// of the frame, coordinate letters inside the frame.
fn is_possible_in(label: &str, row: usize) -> bool {
    match label {
        "O" | "N" => row == TITLE_ROW,
        "S" | "T" => row == INPUT_ROW,
        _ if row == TITLE_ROW => false,
        _ if label.len() == 1 => INSIDE.contains(&row),
        _ => true,
    }
}

/// Returns the columns at which a row contains a label, in any of its languages. Blanks are
/// ignored. Letters inside a longer word do not match.
fn in_row<'a>(
    cells: &'a [(usize, char)],
    label: &'a str,
) -> impl Iterator<Item = Range<usize>> + 'a {
    label.split('|').flat_map(move |label| {
        let label: Vec<char> = label.chars().filter(|it| !it.is_whitespace()).collect();
        let length = label.len();
        (0..cells.len()).filter_map(move |at| {
            let matched = cells.get(at..at + length)?;
            if !matched.iter().map(|(_, it)| it).eq(&label) {
                return None;
            }
            let (start, last) = (matched.first()?.0, matched.last()?.0);
            let joined = |neighbour: Option<&(usize, char)>, own: Option<&char>, column: usize| {
                neighbour.is_some_and(|(at, it)| *at == column && it.is_ascii_alphabetic())
                    && own.is_some_and(char::is_ascii_alphabetic)
            };
            let before = at.checked_sub(1).and_then(|at| cells.get(at));
            let in_longer = start
                .checked_sub(1)
                .is_some_and(|column| joined(before, label.first(), column))
                || joined(cells.get(at + length), label.last(), last + 1);
            (!in_longer).then_some(start..last + 1)
        })
    })
}
