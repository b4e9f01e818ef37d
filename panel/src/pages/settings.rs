//! The setting pages (manual III-2.5.1).

use gsk_core::cnc::Cnc;

use super::frame;
use super::table::PageId;
use super::view::View;
use crate::screen::Screen;

/// Status parameter 174, bit 3: power-on state of the program switch.
const PROGRAM_SWITCH: (u16, u8) = (174, 3);

/// 设置: codes.
pub fn codes(screen: &mut Screen, view: &View, cnc: &Cnc) {
    let inch = u8::from(cnc.modal().inch);
    let rows = [
        ("奇偶校检  =", 0, "", "TVON"),
        ("ISO 代码  =", 1, " (0:EIA  1:ISO)", "ISO"),
        ("英制编程  =", inch, " (0:公制 1:英制)", "INCH"),
        ("自动序号  =", 0, "", "SEQ"),
    ];
    let cursor = view.cursors.get(PageId::SetCode).item.min(rows.len() - 1);
    for (index, (label, value, note, prompt)) in rows.into_iter().enumerate() {
        let row = 2 + 2 * index;
        screen.put(row, 1, &format!("{label}{value}{note}"));
        if index == cursor {
            screen.put(row, 0, "_");
            frame::input_line(screen, &format!("序号{prompt}="), view);
        }
    }
}

/// 设置: parameter switch and program switch.
pub fn switches(screen: &mut Screen, view: &View, cnc: &Cnc) {
    let program = cnc.parameters().bit(PROGRAM_SWITCH.0, PROGRAM_SWITCH.1);
    let cursor = view.cursors.get(PageId::SetSwitch).item.min(1);
    let rows = [(3, "参数开关:", false), (6, "程序开关:", program)];
    for (index, (row, label, on)) in rows.into_iter().enumerate() {
        if index == cursor {
            screen.put(row, 0, "_");
        }
        screen.put(row, 1, label);
        screen.put(row, 12, "关  开");
        screen.put(row, if on { 15 } else { 11 }, "*");
    }
}

/// 电子盘设置.
pub fn disk(screen: &mut Screen) {
    for disk in 0..5 {
        let text = format!("{disk}:读 电子盘N{disk} 数据参数写入RAM;");
        screen.put(2 + disk, 0, &text);
    }
    for disk in 1..5 {
        let text = format!("{}:保存RAM中数据参数到电子盘N{disk};", disk + 4);
        screen.put(6 + disk, 0, &text);
    }
}

/// 密码设置.
pub fn password(screen: &mut Screen, view: &View) {
    let rows = [
        "操作级别    : 3",
        "输入密码    :",
        "更改密码    :",
        "确认密码    :",
    ];
    for (index, text) in rows.into_iter().enumerate() {
        screen.put(3 + 2 * index, 1, text);
    }
    let cursor = view.cursors.get(PageId::Password).item.min(3);
    screen.put(3 + 2 * cursor, 0, "_");
    screen.put(11, 0, "提示:");
}
