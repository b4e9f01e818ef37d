//! The picture of the self-test (manual III-3.1).

use crate::screen::Screen;

/// How long it stands, ticks.
pub const POWER_ON_TICKS: u64 = 3000;

/// Draws it.
pub fn draw(english: bool) -> Screen {
    let mut screen = Screen::in_english(english);
    screen.put(4, 13, "GSK980TD");
    screen.put(6, 10, "车床数控系统");
    screen.put(9, 8, "广州数控设备有限公司");
    screen.put(12, 8, "系统自检 初始化 ...");
    screen
}
