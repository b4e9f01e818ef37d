//! Defines the keys of the panels. Parsing, painting, lamps, accessibility and the printed list
//! use this one table (manual III-1.2, PLC-I 3.1.2). [`crate::face`] lists which of them a
//! control model has, and what is printed on them there.

mod table;

use serde::{Deserialize, Serialize};

pub use table::{KEYS, MODEL_KEYS};

/// A key or button of the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Key {
    /// 复位: resets the control and stops the run.
    Reset,
    /// Types the address letter O, which begins a program number.
    O,
    /// Types the address letter N, which begins a sequence number.
    N,
    /// Types the address letter G.
    G,
    /// Types the address letter X.
    X,
    /// Types the address letter Z.
    Z,
    /// Compound key D/U: types `U`; pressed again, replaces it by `D`.
    U,
    /// Types the address letter W.
    W,
    /// Types the address letter S.
    S,
    /// Types the address letter T.
    T,
    /// Types the address letter M.
    M,
    /// Compound key P/Q: types `P`; pressed again, replaces it by `Q`.
    P,
    /// Types the address letter R.
    R,
    /// Types the address letter I.
    I,
    /// Types the address letter K.
    K,
    /// Compound key J/C: types `J`; pressed again, replaces it by `C`.
    J,
    /// Types the address letter F.
    F,
    /// Types the address letter L.
    L,
    /// Compound key H/Y: types `H`; pressed again, replaces it by `Y`.
    H,
    /// Compound key: types `/`; pressed again, replaces it by `#`.
    Slash,
    /// EOB: enters the end of a block.
    Eob,
    /// Types the digit 0.
    Digit0,
    /// Types the digit 1.
    Digit1,
    /// Types the digit 2.
    Digit2,
    /// Types the digit 3.
    Digit3,
    /// Types the digit 4.
    Digit4,
    /// Types the digit 5.
    Digit5,
    /// Types the digit 6.
    Digit6,
    /// Types the digit 7.
    Digit7,
    /// Types the digit 8.
    Digit8,
    /// Types the digit 9.
    Digit9,
    /// Types a minus sign.
    Minus,
    /// Types a decimal point.
    Point,
    /// 输入: enters the typed value.
    Input,
    /// 输出: sends programs or data through the serial port; starts the MDI block with 004.2 =
    /// 1.
    Output,
    /// 转换: switches between the contents of a page, or between ways to enter values; starts a
    /// search in the program.
    Change,
    /// 取消: deletes the last typed character.
    Cancel,
    /// 插入/修改: switches between inserting and altering program text.
    Insert,
    /// 删除: deletes program text or a whole program.
    Delete,
    /// Page-up key: shows the previous screen or page.
    PageUp,
    /// Page-down key: shows the next screen or page.
    PageDown,
    /// Moves the cursor up.
    Up,
    /// Moves the cursor left.
    Left,
    /// Moves the cursor right.
    Right,
    /// Moves the cursor down.
    Down,
    /// 位置: opens the position pages.
    Position,
    /// 程序: opens the program pages.
    Program,
    /// 刀补: opens the offset pages.
    Offset,
    /// 报警: opens the alarm pages.
    Alarm,
    /// 设置: opens the setting pages.
    Setting,
    /// 参数: opens the parameter pages.
    Parameter,
    /// 诊断: opens the diagnosis pages.
    Diagnosis,
    /// 编辑方式: selects edit mode.
    Edit,
    /// 自动方式: selects automatic mode.
    Auto,
    /// 录入方式: selects MDI mode.
    Mdi,
    /// 机械零点: selects machine zero mode.
    MachineZero,
    /// 单步/手轮方式: selects step or handwheel mode.
    Handwheel,
    /// 手动方式: selects jog mode.
    Jog,
    /// 程序零点: selects program zero mode.
    ProgramZero,
    /// 单段: switches single block on or off.
    SingleBlock,
    /// 跳段: switches block skip on or off.
    BlockSkip,
    /// 机床锁: switches machine lock on or off.
    MachineLock,
    /// 辅助锁: switches the auxiliary function lock on or off.
    AuxiliaryLock,
    /// 空运行: switches dry run on or off.
    DryRun,
    /// 增量 0.001: selects an increment of 0.001 mm for step and handwheel.
    Increment1,
    /// 增量 0.01: selects an increment of 0.01 mm for step and handwheel.
    Increment10,
    /// 增量 0.1: selects an increment of 0.1 mm for step and handwheel.
    Increment100,
    /// 手轮 X 轴: the handwheel moves the X axis.
    WheelX,
    /// 手轮 Y 轴（未装）: selects the Y axis for the handwheel (not fitted).
    WheelY,
    /// 手轮 Z 轴: the handwheel moves the Z axis.
    WheelZ,
    /// X 轴向上: jogs the X axis in the direction of the arrow that points up.
    XUp,
    /// X 轴向下: jogs the X axis in the direction of the arrow that points down.
    XDown,
    /// Z 轴向左: jogs the Z axis in the direction of the arrow that points left.
    ZLeft,
    /// Z 轴向右: jogs the Z axis in the direction of the arrow that points right.
    ZRight,
    /// Y 轴负向（未装）: jogs the Y axis in minus direction (not fitted).
    YMinus,
    /// Y 轴正向（未装）: jogs the Y axis in plus direction (not fitted).
    YPlus,
    /// 手动快速: jogs at rapid rate.
    Rapid,
    /// 主轴正转: starts the spindle forward.
    SpindleForward,
    /// 主轴停止: stops the spindle.
    SpindleStop,
    /// 主轴反转: starts the spindle in reverse.
    SpindleReverse,
    /// 冷却: switches the coolant on or off.
    Coolant,
    /// 润滑/主轴点动: lubrication, or jogs the spindle.
    Lubrication,
    /// 换刀: changes to the next tool.
    ToolChange,
    /// 主轴倍率增: raises the spindle override.
    SpindleOverrideUp,
    /// 主轴倍率减: lowers the spindle override.
    SpindleOverrideDown,
    /// 快速倍率增: raises the rapid override.
    RapidOverrideUp,
    /// 快速倍率减: lowers the rapid override.
    RapidOverrideDown,
    /// 进给倍率增: raises the feed override.
    FeedOverrideUp,
    /// 进给倍率减: lowers the feed override.
    FeedOverrideDown,
    /// 暂停（进给保持）: holds the feed of the running program.
    FeedHold,
    /// 运行（循环启动）: starts the selected program or the MDI block.
    CycleStart,
    /// 急停: the mushroom button. Pressing it latches it; pressing it again releases it.
    EmergencyStop,
    /// 超程解除: bridges the limit switches while it is held.
    OvertravelRelease,
    /// 卡盘 (NC-B08): clamps or releases the chuck.
    Chuck,
    /// 尾座 (NC-B08): moves the tailstock out or in.
    Tailstock,
    /// 示教 (NC-B08): opens the pages for teaching and graphic.
    Teach,
    /// PRGRM 程序 (Huaxing): opens the main function for programs.
    MainProgram,
    /// OPERT 加工 (Huaxing): opens the main function for machining.
    MainOperate,
    /// PARAM 参数 (Huaxing): opens the main function for parameters.
    MainParameter,
    /// F1 (Huaxing): triggers the action of the first soft key label.
    Soft1,
    /// F2 (Huaxing): triggers the action of the second soft key label.
    Soft2,
    /// F3 (Huaxing): triggers the action of the third soft key label.
    Soft3,
    /// F4 (Huaxing): triggers the action of the fourth soft key label.
    Soft4,
    /// F5 (Huaxing): triggers the action of the fifth soft key label.
    Soft5,
}

/// The address of a bit in the X or Y memory of the PLC.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Bit {
    /// Number of the byte in its PLC area, from 0.
    pub byte: u16,
    /// Number of the bit in its byte, 0 to 7.
    pub bit: u8,
}

impl Bit {
    /// Creates the address of bit `bit` (0 to 7) of byte `byte`.
    pub const fn new(byte: u16, bit: u8) -> Self {
        Self { byte, bit }
    }

    /// Returns whether the bit is set in `bytes`, a copy of the memory from byte 0; `false`
    /// beyond its end.
    pub fn is_set_in(self, bytes: &[u8]) -> bool {
        bytes
            .get(usize::from(self.byte))
            .is_some_and(|byte| byte >> self.bit & 1 == 1)
    }
}

/// The effect of a panel key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyRole {
    /// Closes this X contact while held. The ladder does the rest.
    Machine(Bit),
    /// Enters the first character. A compound key has a second one, which replaces the first
    /// when the key is pressed again.
    Character(char, Option<char>),
    /// Acts on the display; a key of the edit keyboard other than a character or page key.
    Edit,
    /// The key opens a group of pages on the LCD.
    Page,
    /// The key triggers the action of the soft key label at this position, from 0.
    Soft(u8),
    /// Latches and opens the emergency stop contact, until the key is pressed again.
    EmergencyStop,
    /// The key bridges the limit switches while it is held.
    OvertravelRelease,
}

/// A row of the key table: names, legend, PC key and role of a panel key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KeyRow {
    /// The key that this row describes.
    pub key: Key,
    /// The key's name in operator scripts and in `gsk980td keys`.
    pub id: &'static str,
    /// The lines of text printed on the key, from the top.
    pub legend: &'static [&'static str],
    /// The key's accessible name in Chinese.
    pub name_zh: &'static str,
    /// The key's accessible name in English.
    pub name_en: &'static str,
    /// The effect of pressing the key.
    pub role: KeyRole,
    /// The Y bit that lights the lamp in the key; `None` if the key has no lamp.
    pub lamp: Option<Bit>,
    /// The key of a PC keyboard that presses this key: modifiers joined with `+`, keys with
    /// egui's names, characters as they are.
    pub pc: &'static str,
}

impl Key {
    /// Returns the row of the key table that describes this key.
    pub const fn row(self) -> &'static KeyRow {
        // Both tables have the order of the enum. A test checks it.
        let index = self as usize;
        if index < KEYS.len() {
            &KEYS[index]
        } else {
            &MODEL_KEYS[index - KEYS.len()]
        }
    }

    /// Returns the key's name in operator scripts, for example `RESET`.
    pub const fn id(self) -> &'static str {
        self.row().id
    }

    /// Returns the PLC input (X address) that this machine key closes; `None` for other keys.
    pub const fn contact(self) -> Option<Bit> {
        match self.row().role {
            KeyRole::Machine(bit) => Some(bit),
            _ => None,
        }
    }

    /// Returns whether the key repeats while it is held: cursor and page keys do (manual
    /// III-2.6.1).
    pub const fn repeats(self) -> bool {
        matches!(
            self,
            Self::Up | Self::Down | Self::Left | Self::Right | Self::PageUp | Self::PageDown
        )
    }

    /// Returns the key with this name in operator scripts, ignoring case; `None` if no key has
    /// it. A compound key is also found by its legend (`D/U`).
    pub fn from_id(id: &str) -> Option<Self> {
        let found = all_rows().find(|row| {
            let printed = row.id.len() == 1 && row.legend.len() == 2;
            row.id.eq_ignore_ascii_case(id)
                || printed && row.legend.join("/").eq_ignore_ascii_case(id)
        });
        found.map(|row| row.key)
    }

    /// Returns the panel key that a key of the PC keyboard presses, by its name as in
    /// [`KeyRow::pc`]; `None` if it presses none.
    pub fn from_pc_key(name: &str) -> Option<Self> {
        all_rows().find(|row| row.pc == name).map(|row| row.key)
    }
}

/// Returns the rows of all keys: those of the GSK980TD, and those of other models only.
pub fn all_rows() -> impl Iterator<Item = &'static KeyRow> {
    KEYS.iter().chain(&MODEL_KEYS)
}

/// Returns at most five script names of keys that resemble `word`, the nearest first, for
/// error messages.
pub(crate) fn near_ids(word: &str) -> Vec<&'static str> {
    let word = word.to_ascii_uppercase();
    let mut near: Vec<(usize, &'static str)> = all_rows()
        .map(|row| {
            let named = row.name_en.to_ascii_uppercase().replace(' ', "");
            let distance = if named.contains(&word) && word.len() > 2 {
                1
            } else {
                distance(&word, row.id)
            };
            (distance, row.id)
        })
        .filter(|(distance, _)| *distance <= if word.len() > 3 { 2 } else { 1 })
        .collect();
    near.sort_by_key(|(distance, id)| (*distance, id.chars().next() != word.chars().next()));
    near.into_iter().map(|(_, id)| id).take(5).collect()
}

/// Returns the least number of insertions, deletions and replacements of characters that turn
/// `a` into `b`.
pub(crate) fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = i;
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

/// A lamp of the status strip above the LCD (manual III-1.2.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StripLamp {
    /// The lamp's name in operator scripts.
    pub id: &'static str,
    /// The text printed beside the lamp.
    pub label: &'static str,
    /// The lamp's accessible name in Chinese.
    pub name_zh: &'static str,
    /// The lamp's accessible name in English.
    pub name_en: &'static str,
    /// The Y bit that lights the lamp while it is 1.
    pub lamp: Bit,
    /// Whether the lamp is fitted. Those of the Y axis, which the machine does not have, are
    /// not.
    pub fitted: bool,
}

const fn strip(
    id: &'static str,
    label: &'static str,
    name_zh: &'static str,
    name_en: &'static str,
    lamp: Bit,
) -> StripLamp {
    StripLamp {
        id,
        label,
        name_zh,
        name_en,
        lamp,
        fitted: true,
    }
}

/// The lamps of the status strip, from left to right.
pub const STRIP: [StripLamp; 9] = [
    strip(
        "XZERO",
        "X零点",
        "X 轴回零结束",
        "X at zero",
        Bit::new(4, 7),
    ),
    StripLamp {
        fitted: false,
        ..strip(
            "YZERO",
            "Y零点",
            "Y 轴回零结束",
            "Y at zero",
            Bit::new(4, 6),
        )
    },
    strip(
        "ZZERO",
        "Z零点",
        "Z 轴回零结束",
        "Z at zero",
        Bit::new(4, 5),
    ),
    strip("S-RT", "快速", "快速", "Rapid", Bit::new(4, 4)),
    strip("S-SBK", "单段", "单段", "Single block", Bit::new(4, 3)),
    strip("S-BDT", "跳段", "跳段", "Block skip", Bit::new(4, 2)),
    strip("S-MLK", "机床锁", "机床锁", "Machine lock", Bit::new(4, 1)),
    strip(
        "S-AFL",
        "MST",
        "辅助锁",
        "Auxiliary function lock",
        Bit::new(4, 0),
    ),
    strip("S-DRN", "空运行", "空运行", "Dry run", Bit::new(9, 1)),
];

/// Returns the Y bit that lights a lamp, by the script name of its key or of the strip's lamp;
/// `None` if no lamp has this name.
pub(crate) fn lamp_of(id: &str) -> Option<Bit> {
    if let Some(key) = Key::from_id(id) {
        return key.row().lamp;
    }
    let found = STRIP.iter().find(|lamp| lamp.id.eq_ignore_ascii_case(id));
    found.map(|lamp| lamp.lamp)
}

#[cfg(test)]
mod tests;
