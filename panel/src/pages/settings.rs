//! The setting pages (manual III-2.5.1).

use gsk_core::cnc::Cnc;

use super::frame;
use super::table::PageId;
use super::view::View;
use crate::screen::Screen;

/// What the page of the disks says after an operation.
const DONE: &str = "操作已经成功完成";
const FAILED: &str = "操作出错,请再试一次";

/// 设置: codes.
pub fn codes(screen: &mut Screen, view: &View, cnc: &Cnc) {
    let settings = cnc.settings();
    let rows = [
        ("奇偶校检  =", settings.parity, "", "TVON"),
        ("ISO 代码  =", settings.iso, " (0:EIA  1:ISO)", "ISO"),
        ("英制编程  =", settings.inch, " (0:公制 1:英制)", "INCH"),
        ("自动序号  =", settings.numbering, "", "SEQ"),
    ];
    let cursor = view.cursors.get(PageId::SetCode).item.min(rows.len() - 1);
    for (index, (label, value, note, prompt)) in rows.into_iter().enumerate() {
        let row = 2 + 2 * index;
        let value = u8::from(value);
        screen.put(row, 1, &format!("{label}{value}{note}"));
        if index == cursor {
            screen.put(row, 0, "_");
            frame::input_line(screen, &format!("序号{prompt}="), view);
        }
    }
}

/// 设置: parameter switch and program switch.
pub fn switches(screen: &mut Screen, view: &View, cnc: &Cnc) {
    let cursor = view.cursors.get(PageId::SetSwitch).item.min(1);
    let rows = [
        (3, "参数开关:", cnc.parameter_switch()),
        (6, "程序开关:", cnc.program_switch()),
    ];
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
pub fn disk(screen: &mut Screen, view: &View) {
    for disk in 0..5 {
        let text = format!("{disk}:读 电子盘N{disk} 数据参数写入RAM;");
        screen.put(2 + disk, 0, &text);
    }
    for disk in 1..5 {
        let text = format!("{}:保存RAM中数据参数到电子盘N{disk};", disk + 4);
        screen.put(6 + disk, 0, &text);
    }
    if let Some(done) = view.disk_done {
        screen.put(12, 0, if done { DONE } else { FAILED });
    }
}
