//! Defines the keys of the panel. Parsing, painting, lamps, accessibility and the printed list
//! use this one table (manual III-1.2, PLC-I 3.1.2).

mod table;

use serde::{Deserialize, Serialize};

pub use table::KEYS;

/// A key or button of the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Key {
    /// 复位: reset.
    Reset,
    /// Address O.
    O,
    /// Address N.
    N,
    /// Address G.
    G,
    /// Address X.
    X,
    /// Address Z.
    Z,
    /// Compound key D/U: `U`, pressed again `D`.
    U,
    /// Address W.
    W,
    /// Address S.
    S,
    /// Address T.
    T,
    /// Address M.
    M,
    /// Compound key P/Q: `P`, pressed again `Q`.
    P,
    /// Address R.
    R,
    /// Address I.
    I,
    /// Address K.
    K,
    /// Compound key J/C: `J`, pressed again `C`.
    J,
    /// Address F.
    F,
    /// Address L.
    L,
    /// Compound key H/Y: `H`, pressed again `Y`.
    H,
    /// Compound key: `/`, pressed again `#`.
    Slash,
    /// EOB: end of block.
    Eob,
    /// Digit 0.
    Digit0,
    /// Digit 1.
    Digit1,
    /// Digit 2.
    Digit2,
    /// Digit 3.
    Digit3,
    /// Digit 4.
    Digit4,
    /// Digit 5.
    Digit5,
    /// Digit 6.
    Digit6,
    /// Digit 7.
    Digit7,
    /// Digit 8.
    Digit8,
    /// Digit 9.
    Digit9,
    /// Minus sign.
    Minus,
    /// Decimal point.
    Point,
    /// 输入: enter what was typed.
    Input,
    /// 输出: file output; starts the MDI block with 004.2 = 1.
    Output,
    /// 转换: change of presentation, search.
    Change,
    /// 取消: delete the last character typed.
    Cancel,
    /// 插入/修改: insert or alter.
    Insert,
    /// 删除: delete.
    Delete,
    /// Previous page.
    PageUp,
    /// Next page.
    PageDown,
    /// Cursor up.
    Up,
    /// Cursor left.
    Left,
    /// Cursor right.
    Right,
    /// Cursor down.
    Down,
    /// 位置: position pages.
    Position,
    /// 程序: program pages.
    Program,
    /// 刀补: offset pages.
    Offset,
    /// 报警: alarm pages.
    Alarm,
    /// 设置: setting pages.
    Setting,
    /// 参数: parameter pages.
    Parameter,
    /// 诊断: diagnosis pages.
    Diagnosis,
    /// 编辑方式: edit mode.
    Edit,
    /// 自动方式: automatic mode.
    Auto,
    /// 录入方式: MDI mode.
    Mdi,
    /// 机械零点: machine zero mode.
    MachineZero,
    /// 单步/手轮方式: step or handwheel mode.
    Handwheel,
    /// 手动方式: jog mode.
    Jog,
    /// 程序零点: program zero mode.
    ProgramZero,
    /// 单段: single block.
    SingleBlock,
    /// 跳段: block skip.
    BlockSkip,
    /// 机床锁: machine lock.
    MachineLock,
    /// 辅助锁: auxiliary function lock.
    AuxiliaryLock,
    /// 空运行: dry run.
    DryRun,
    /// 增量 0.001: increment 0.001.
    Increment1,
    /// 增量 0.01: increment 0.01.
    Increment10,
    /// 增量 0.1: increment 0.1.
    Increment100,
    /// 手轮 X 轴: handwheel axis X.
    WheelX,
    /// 手轮 Y 轴(未装): handwheel axis Y (not fitted).
    WheelY,
    /// 手轮 Z 轴: handwheel axis Z.
    WheelZ,
    /// X 轴向上: X axis, arrow up.
    XUp,
    /// X 轴向下: X axis, arrow down.
    XDown,
    /// Z 轴向左: Z axis, arrow left.
    ZLeft,
    /// Z 轴向右: Z axis, arrow right.
    ZRight,
    /// Y 轴负向(未装): Y axis minus (not fitted).
    YMinus,
    /// Y 轴正向(未装): Y axis plus (not fitted).
    YPlus,
    /// 手动快速: manual rapid.
    Rapid,
    /// 主轴正转: spindle forward.
    SpindleForward,
    /// 主轴停止: spindle stop.
    SpindleStop,
    /// 主轴反转: spindle reverse.
    SpindleReverse,
    /// 冷却: coolant.
    Coolant,
    /// 润滑/主轴点动: lubrication or spindle jog.
    Lubrication,
    /// 换刀: tool change.
    ToolChange,
    /// 主轴倍率增: spindle override up.
    SpindleOverrideUp,
    /// 主轴倍率减: spindle override down.
    SpindleOverrideDown,
    /// 快速倍率增: rapid override up.
    RapidOverrideUp,
    /// 快速倍率减: rapid override down.
    RapidOverrideDown,
    /// 进给倍率增: feed override up.
    FeedOverrideUp,
    /// 进给倍率减: feed override down.
    FeedOverrideDown,
    /// 暂停(进给保持): feed hold.
    FeedHold,
    /// 运行(循环启动): cycle start.
    CycleStart,
    /// 急停: the mushroom button; pressing latches it, pressing again turns it free.
    EmergencyStop,
    /// 超程解除: bridges the limit switches while held.
    OvertravelRelease,
}

/// A bit of the X or Y memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Bit {
    /// Byte number.
    pub byte: u16,
    /// Bit number, 0 to 7.
    pub bit: u8,
}

impl Bit {
    /// Creates a bit address.
    pub const fn new(byte: u16, bit: u8) -> Self {
        Self { byte, bit }
    }

    /// Returns whether the bit is set in a memory. Bits outside it are not.
    pub fn is_set_in(self, bytes: &[u8]) -> bool {
        bytes
            .get(usize::from(self.byte))
            .is_some_and(|byte| byte >> self.bit & 1 == 1)
    }
}

/// The effect of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyRole {
    /// Closes an X contact. The ladder does the rest.
    Machine(Bit),
    /// Enters a character. A compound key has a second one, which replaces the first when the
    /// key is pressed again.
    Character(char, Option<char>),
    /// A key of the edit keyboard that acts on the display.
    Edit,
    /// Selects a group of pages.
    Page,
    /// Opens the emergency stop contact and latches.
    EmergencyStop,
    /// Bridges the limit switches.
    OvertravelRelease,
}

/// A row of the key table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KeyRow {
    /// The key.
    pub key: Key,
    /// Its name in operator scripts and in `gsk980td keys`.
    pub id: &'static str,
    /// The lines printed on it.
    pub legend: &'static [&'static str],
    /// Accessible name, Chinese.
    pub name_zh: &'static str,
    /// Accessible name, English.
    pub name_en: &'static str,
    /// Its effect.
    pub role: KeyRole,
    /// The Y bit of the lamp in it.
    pub lamp: Option<Bit>,
    /// The key of a PC keyboard that presses it: modifiers joined with `+`, keys with egui's
    /// names, characters as they are.
    pub pc: &'static str,
}

impl Key {
    /// Returns the key's row in the table.
    pub const fn row(self) -> &'static KeyRow {
        // The table has the order of the enum. A test checks it.
        &KEYS[self as usize]
    }

    /// Returns the name in operator scripts.
    pub const fn id(self) -> &'static str {
        self.row().id
    }

    /// Returns the X contact of a machine key.
    pub const fn contact(self) -> Option<Bit> {
        match self.row().role {
            KeyRole::Machine(bit) => Some(bit),
            _ => None,
        }
    }

    /// Returns whether the key repeats while held: cursor and page keys (manual III-2.6.1).
    pub const fn repeats(self) -> bool {
        matches!(
            self,
            Self::Up | Self::Down | Self::Left | Self::Right | Self::PageUp | Self::PageDown
        )
    }

    /// Returns the key with an id, ignoring case. A compound key also has the id printed on it
    /// (`D/U`).
    pub fn from_id(id: &str) -> Option<Self> {
        let found = KEYS.iter().find(|row| {
            let printed = row.id.len() == 1 && row.legend.len() == 2;
            row.id.eq_ignore_ascii_case(id)
                || printed && row.legend.join("/").eq_ignore_ascii_case(id)
        });
        found.map(|row| row.key)
    }

    /// Returns the key that a PC key presses, by the name of [`KeyRow::pc`].
    pub fn from_pc_key(name: &str) -> Option<Self> {
        KEYS.iter().find(|row| row.pc == name).map(|row| row.key)
    }
}

/// Returns the ids that resemble a word, the nearest first, for error messages.
pub(crate) fn near_ids(word: &str) -> Vec<&'static str> {
    let word = word.to_ascii_uppercase();
    let mut near: Vec<(usize, &'static str)> = KEYS
        .iter()
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

/// Returns the number of insertions, deletions and replacements between two words.
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

/// A lamp of the status strip (manual III-1.2.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StripLamp {
    /// Its name in operator scripts.
    pub id: &'static str,
    /// The label printed beside it.
    pub label: &'static str,
    /// Accessible name, Chinese.
    pub name_zh: &'static str,
    /// Accessible name, English.
    pub name_en: &'static str,
    /// The Y bit that lights it.
    pub lamp: Bit,
    /// Whether it is fitted. The machine has no Y axis.
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

/// Returns the Y bit of a lamp by the id of its key or of the strip.
pub(crate) fn lamp_of(id: &str) -> Option<Bit> {
    if let Some(key) = Key::from_id(id) {
        return key.row().lamp;
    }
    let found = STRIP.iter().find(|lamp| lamp.id.eq_ignore_ascii_case(id));
    found.map(|lamp| lamp.lamp)
}

#[cfg(test)]
mod tests;
