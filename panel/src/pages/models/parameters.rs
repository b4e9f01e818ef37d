//! Draws the parameters that only the selected model has (P parameters): number, value, unit and
//! name.

use gsk_core::cnc::Cnc;
use gsk_messages::say;

use crate::face::PageId;
use crate::pages::frame;
use crate::pages::view::PageView;
use crate::screen::Screen;

/// Screen row of the first parameter, and number of parameters on the screen.
const FIRST_ROW: usize = 2;
const ROWS: usize = 8;
/// Columns of number and unit, and the column before which the value ends.
const NUMBER: usize = 1;
const VALUE_END: usize = 16;
const UNIT: usize = 18;

/// Returns the numbers of the parameters that only this model has, ascending.
pub fn numbers(cnc: &Cnc) -> Vec<u16> {
    let record = cnc.model().record();
    record.parameters().keys().copied().collect()
}

/// Draws the list of the model's own parameters, and the name and range of the one at the
/// cursor.
pub fn draw(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let parameters = cnc.model().record().parameters();
    let last = parameters.len().saturating_sub(1);
    let item = view.cursors.get(PageId::ParModel).item.min(last);
    screen.put_message(1, 0, &say::lcd_model_parameter_heading());
    let first = item / ROWS * ROWS;
    for (index, (number, row)) in parameters.iter().enumerate().skip(first).take(ROWS) {
        let at = FIRST_ROW + index - first;
        if index == item {
            screen.put(at, 0, "_");
        }
        screen.put(at, NUMBER, &format!("P{number:03}"));
        let value = cnc.model().parameter(*number);
        screen.put_right(at, VALUE_END, &value.to_string());
        screen.put(at, UNIT, &row.unit);
    }
    let Some((number, row)) = parameters.iter().nth(item) else {
        return;
    };
    screen.put(10, 0, row.name(screen.language()));
    let (low, high) = row.range;
    screen.put_message(11, 0, &say::lcd_model_parameter_range(low, high));
    let prompt = say::lcd_number_prompt(format!("P{number:03}"));
    frame::input_line(screen, &prompt, view);
}
