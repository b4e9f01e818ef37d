//! Draws the setting pages (manual III-2.5.1).

use gsk_core::cnc::Cnc;
use gsk_messages::say;

use super::frame;
use super::view::PageView;
use crate::face::PageId;
use crate::screen::Screen;

/// Draws the first setting page (设置): the code settings TV, ISO, INCH and SEQ.
pub fn codes(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let settings = cnc.settings();
    let rows = [
        (say::lcd_tv_check(u8::from(settings.parity)), "TVON"),
        (say::lcd_iso_code(u8::from(settings.iso)), "ISO"),
        (say::lcd_inch_programming(u8::from(settings.inch)), "INCH"),
        (say::lcd_auto_numbering(u8::from(settings.numbering)), "SEQ"),
    ];
    let cursor = view.cursors.get(PageId::SetCode).item.min(rows.len() - 1);
    for (index, (text, name)) in rows.into_iter().enumerate() {
        let row = 2 + 2 * index;
        screen.put_message(row, 1, &text);
        if index == cursor {
            screen.put(row, 0, "_");
            frame::setting_line(screen, name, view);
        }
    }
}

/// Draws the second setting page (设置): parameter switch and program switch.
pub fn switches(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let cursor = view.cursors.get(PageId::SetSwitch).item.min(1);
    let rows = [
        (3, say::lcd_parameter_switch(), cnc.is_parameter_switch_on()),
        (6, say::lcd_program_switch(), cnc.is_program_switch_on()),
    ];
    for (index, (row, label, on)) in rows.into_iter().enumerate() {
        if index == cursor {
            screen.put(row, 0, "_");
        }
        screen.put_message(row, 1, &label);
        screen.put_message(row, 12, &say::lcd_switch_off_on());
        screen.put(row, if on { 15 } else { 11 }, "*");
    }
}

/// Draws the page of the electronic disk (电子盘设置): keys that read and save, last result.
pub fn disk(screen: &mut Screen, view: &PageView) {
    for disk in 0..5 {
        screen.put_message(2 + disk, 0, &say::lcd_disk_read(disk, disk));
    }
    for disk in 1..5 {
        screen.put_message(6 + disk, 0, &say::lcd_disk_save(disk + 4, disk));
    }
    if let Some(done) = view.disk_done {
        let text = match done {
            true => say::lcd_disk_done(),
            false => say::lcd_disk_failed(),
        };
        screen.put_message(12, 0, &text);
    }
}
