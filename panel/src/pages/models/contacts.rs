//! Draws the inputs and outputs of a control model: number, pin of the connector, meaning and
//! level of each, and the signal of the contact at the cursor.

use gsk_core::cnc::Cnc;
use gsk_messages::say;

use crate::face::{ContactMeaning, ContactRow, PageId, face_of};
use crate::pages::frame;
use crate::pages::view::PageView;
use crate::screen::{CellStyle, Screen};

/// Number of contacts on one screen, and in one of its two columns.
const SCREEN: usize = 16;
const COLUMN: usize = 8;
/// Screen row of the first contact in the list.
const FIRST_ROW: usize = 2;
/// Columns of a half of the list, from its left edge: number, pin, meaning, level.
const NUMBER: usize = 1;
const PIN: usize = 5;
const MEANING: usize = 8;
const LEVEL: usize = 18;

/// What the list shows for inputs, or for outputs.
struct ContactList<'a> {
    page: PageId,
    letter: char,
    rows: &'a [ContactRow],
    is_on: &'a dyn Fn(u8) -> bool,
    /// Function that returns the PLC address of a contact by its index.
    address: &'a dyn Fn(u8) -> String,
}

/// Draws the page with the inputs of the model.
pub fn inputs(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let list = ContactList {
        page: PageId::Inputs,
        letter: 'X',
        rows: face_of(cnc.model().id()).inputs,
        is_on: &|number| cnc.input_level(number),
        address: &|number| {
            let (byte, bit) = cnc.model().record().input_contact(number);
            format!("X{byte}.{bit}")
        },
    };
    draw(screen, view, &list);
}

/// Draws the page with the outputs of the model.
pub fn outputs(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let list = ContactList {
        page: PageId::Outputs,
        letter: 'Y',
        rows: face_of(cnc.model().id()).outputs,
        is_on: &|number| cnc.model_output(number),
        address: &|number| {
            let (byte, bit) = Cnc::output_signal(number);
            format!("F{byte}.{bit}")
        },
    };
    draw(screen, view, &list);
}

fn draw(screen: &mut Screen, view: &PageView, list: &ContactList<'_>) {
    let last = list.rows.len().saturating_sub(1);
    let item = view.cursors.get(list.page).item.min(last);
    screen.put_message(1, 0, &say::lcd_contact_heading());
    let first = item / SCREEN * SCREEN;
    for (index, row) in list.rows.iter().enumerate().skip(first).take(SCREEN) {
        let (half, line) = ((index - first) / COLUMN, (index - first) % COLUMN);
        let (left, row_at) = (half * 20, FIRST_ROW + line);
        if index == item {
            screen.put(row_at, left, "_");
        }
        let number = index as u8;
        screen.put(row_at, left + NUMBER, &format!("{}{index}", list.letter));
        if row.pin != 0 {
            screen.put(row_at, left + PIN, &format!("{:2}", row.pin));
        }
        put_meaning(screen, row_at, left + MEANING, row.meaning);
        let on = (list.is_on)(number);
        let style = if on {
            CellStyle::Inverse
        } else {
            CellStyle::Plain
        };
        screen.put_as(row_at, left + LEVEL, if on { "1" } else { "0" }, style);
    }
    let Some(row) = list.rows.get(item) else {
        return;
    };
    let number = item as u8;
    let name = format!("{}{item}", list.letter);
    let level = u8::from((list.is_on)(number));
    let end = screen.put_message(
        11,
        0,
        &say::lcd_contact_signal(name, (list.address)(number), level),
    );
    put_meaning(screen, 11, end + 2, row.meaning);
    frame::input_line(screen, &say::lcd_number_prompt(format!("{item:03}")), view);
}

fn put_meaning(screen: &mut Screen, row: usize, column: usize, meaning: ContactMeaning) {
    match meaning {
        ContactMeaning::Free => {
            screen.put(row, column, "-");
        }
        ContactMeaning::Code(code) => {
            screen.put(row, column, code);
        }
        ContactMeaning::Signal(name) => {
            screen.put_message(row, column, &name());
        }
    }
}
