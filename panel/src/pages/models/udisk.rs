//! Draws the files on the U disk.

use gsk_messages::say;

use crate::face::PageId;
use crate::pages::frame;
use crate::pages::view::PageView;
use crate::screen::Screen;

/// Screen row of the first file, and number of files on the screen.
const FIRST_ROW: usize = 2;
const ROWS: usize = 9;
/// LCD column before which the number of characters of a file ends.
const SIZE_END: usize = 37;

/// Draws the list of files, and the actions of the keys for the file at the cursor.
pub fn draw(screen: &mut Screen, view: &PageView) {
    let Some(disk) = &view.udisk else {
        screen.put_message(6, 2, &say::lcd_udisk_missing());
        return;
    };
    let files = &disk.files;
    screen.put_message(1, 0, &say::lcd_udisk_heading());
    let item = view.cursors.get(PageId::Udisk).item;
    let item = item.min(files.len().saturating_sub(1));
    let first = item / ROWS * ROWS;
    for (index, file) in files.iter().enumerate().skip(first).take(ROWS) {
        let row = FIRST_ROW + index - first;
        if index == item {
            screen.put(row, 0, "_");
        }
        screen.put(row, 1, &file.name);
        screen.put_right(row, SIZE_END, &file.text.chars().count().to_string());
    }
    screen.put_message(12, 0, &say::lcd_udisk_keys());
    if let Some(done) = view.disk_done {
        let text = match done {
            true => say::lcd_disk_done(),
            false => say::lcd_disk_failed(),
        };
        screen.put_message(11, 0, &text);
    }
    frame::input_line(screen, &say::lcd_address_prompt(), view);
}
