//! Draws the inputs and outputs of a control model: number, pin of the connector, assigned signal
//! and level of each, and address and parameter of the contact at the cursor.

use gsk_core::cnc::Cnc;
use gsk_core::model::ControlModel;
use gsk_messages::say;

use crate::face::{ContactMeaning, ContactRow, PageId, face_of};
use crate::pages::frame;
use crate::pages::view::PageView;
use crate::screen::{COLUMNS, CellStyle, Screen};

/// Number of contacts on one screen, and in one of its two columns.
const SCREEN: usize = 16;
const COLUMN: usize = 8;
/// Screen row of the first contact in the list.
const FIRST_ROW: usize = 2;
/// Columns of a half of the list, from its left edge: number, pin, sign of an inverted signal,
/// meaning, level.
const NUMBER: usize = 1;
const PIN: usize = 5;
const SIGN: usize = 7;
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
    /// Function that returns the parameter with the signal of a contact by its index.
    parameter: &'a dyn Fn(u8) -> Option<u16>,
}

/// The signal of a contact.
struct ContactSignal {
    meaning: ContactMeaning,
    /// The parameter with the signal, and its value; `None` if no parameter assigns it.
    parameter: Option<(u16, i32)>,
}

impl ContactList<'_> {
    /// Returns the signal of a contact: the one of its parameter, or of its row.
    fn signal(&self, index: usize, model: &ControlModel) -> ContactSignal {
        let row = self.rows.get(index);
        let own = row.map_or(ContactMeaning::Free, |row| row.meaning);
        let Some(parameter) = (self.parameter)(index as u8) else {
            return ContactSignal {
                meaning: own,
                parameter: None,
            };
        };
        let value = model.parameter(parameter);
        // The row whose parameter has this signal as delivered names it.
        let is_its_row = |index: u8| {
            let number = (self.parameter)(index);
            let parameters = model.record().parameters();
            let row = number.and_then(|number| parameters.get(&number));
            value != 0 && row.is_some_and(|it| it.delivered == value.abs())
        };
        let mut rows = self.rows.iter().zip(0_u8..);
        let named = rows.find_map(|(row, index)| is_its_row(index).then_some(row.meaning));
        let mut spare = face_of(model.id()).spare_signals.iter();
        let spare = spare
            .find_map(|(signal, meaning)| (*signal == value.unsigned_abs()).then_some(*meaning));
        ContactSignal {
            meaning: named.or(spare).unwrap_or(ContactMeaning::Free),
            parameter: Some((parameter, value)),
        }
    }
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
        parameter: &|number| cnc.model().input_parameter(number),
    };
    draw(screen, view, &list, cnc.model());
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
        parameter: &|number| cnc.model().output_parameter(number),
    };
    draw(screen, view, &list, cnc.model());
}

fn draw(screen: &mut Screen, view: &PageView, list: &ContactList<'_>, model: &ControlModel) {
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
        let signal = list.signal(index, model);
        if signal.parameter.is_some_and(|(_, value)| value < 0) {
            screen.put(row_at, left + SIGN, "-");
        }
        put_meaning(screen, row_at, left + MEANING, signal.meaning);
        let on = (list.is_on)(number);
        let style = if on {
            CellStyle::Inverse
        } else {
            CellStyle::Plain
        };
        screen.put_as(row_at, left + LEVEL, if on { "1" } else { "0" }, style);
    }
    if list.rows.is_empty() {
        return;
    }
    let number = item as u8;
    let name = format!("{}{item}", list.letter);
    let level = u8::from((list.is_on)(number));
    let end = screen.put_message(
        11,
        0,
        &say::lcd_contact_signal(name, (list.address)(number), level),
    );
    let signal = list.signal(item, model);
    put_meaning(screen, 11, end + 2, signal.meaning);
    if let Some((number, value)) = signal.parameter {
        screen.put_right(11, COLUMNS, &format!("P{number}={value}"));
    }
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
