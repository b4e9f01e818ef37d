//! What can go wrong with the lathe: one table of faults, for training.

use serde::{Deserialize, Serialize};

/// Something broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// The tool post does not turn.
    TurretBlocked,
    /// The tool post's clamp switch never answers.
    TurretUnclamped,
    /// The station switch that answers now goes on answering.
    TurretContactStuck,
    /// No station switch answers.
    TurretContactsOpen,
    /// The spindle does not turn.
    SpindleBlocked,
    /// No gear reports that it is in position.
    GearStuck,
    /// The chuck does not move.
    ChuckStuck,
    /// The encoder gives no counts.
    EncoderLost,
    /// The encoder's counts jitter.
    EncoderNoise,
    /// The encoder gives no one-turn signal.
    SpindleIndexLost,
    /// The X motor gives no one-turn signal.
    IndexX,
    /// The Z motor gives no one-turn signal.
    IndexZ,
    /// The X deceleration switch stays pressed.
    DogX,
    /// The Z deceleration switch stays pressed.
    DogZ,
    /// A limit switch of X is tripped.
    LimitX,
    /// A limit switch of Z is tripped.
    LimitZ,
    /// Alarm of the X drive.
    DriveX,
    /// Alarm of the Z drive.
    DriveZ,
    /// The X slide is jammed: a servo trips, a stepper loses steps.
    SlideX,
    /// The Z slide is jammed.
    SlideZ,
    /// Hydraulic or air pressure is low.
    PressureLow,
    /// The guard door is open.
    DoorOpen,
    /// Every machine contact chatters when it changes.
    InputBounce,
    /// The emergency-stop loop is broken.
    EmergencyStop,
}

/// A fault with its names and what it does.
#[derive(Clone, Copy, Debug)]
pub struct FaultRow {
    /// The fault.
    pub fault: Fault,
    /// The name that scripts use.
    pub name: &'static str,
    /// Chinese label.
    pub zh: &'static str,
    /// English label.
    pub en: &'static str,
    /// What the control makes of it, in Chinese.
    pub effect_zh: &'static str,
    /// What the control makes of it, in English.
    pub effect_en: &'static str,
}

const fn row(
    fault: Fault,
    name: &'static str,
    zh: &'static str,
    en: &'static str,
    effect_zh: &'static str,
    effect_en: &'static str,
) -> FaultRow {
    FaultRow {
        fault,
        name,
        zh,
        en,
        effect_zh,
        effect_en,
    }
}

/// All faults, in the order of the enumeration.
pub static FAULTS: [FaultRow; 24] = [
    row(
        Fault::TurretBlocked,
        "turret-blocked",
        "刀架不转",
        "the tool post does not turn",
        "过 076 时间后信息 1000, TL+ 关闭",
        "message 1000 after 076; TL+ goes off",
    ),
    row(
        Fault::TurretUnclamped,
        "turret-unclamped",
        "刀架锁紧信号不来",
        "no clamp signal of the tool post",
        "*TCP 不来: 过 083 时间后信息 1002, TL- 关闭",
        "*TCP never answers: message 1002 after 083; TL- goes off",
    ),
    row(
        Fault::TurretContactStuck,
        "turret-contact-stuck",
        "刀位信号粘连",
        "station switch stuck",
        "当前刀位的信号保持不变: 换到较低的刀位时检测不到, 信息 1000",
        "the switch that answers now stays so: a lower station is never seen, message 1000",
    ),
    row(
        Fault::TurretContactsOpen,
        "turret-contacts-open",
        "刀位信号断线",
        "station switches dead",
        "检测不到刀位: 过 076 时间后信息 1000",
        "no station is seen: message 1000 after 076",
    ),
    row(
        Fault::SpindleBlocked,
        "spindle-blocked",
        "主轴不转",
        "the spindle does not turn",
        "S 显示 0; 螺纹报警 094, 每转进给报警 011",
        "S reads 0; a thread stops with alarm 094, feed per revolution with 011",
    ),
    row(
        Fault::GearStuck,
        "gear-stuck",
        "换档不到位",
        "gear not in position",
        "M41、M42 一直等待 M41I、M42I (164.6 AGIN = 1)",
        "M41 and M42 wait for M41I, M42I without end (164.6 AGIN = 1)",
    ),
    row(
        Fault::ChuckStuck,
        "chuck-stuck",
        "卡盘不动作",
        "chuck does not move",
        "M12、M13 一直等待 NQPJ、WQPJ (168.2 PB2 = 1)",
        "M12 and M13 wait for NQPJ, WQPJ without end (168.2 PB2 = 1)",
    ),
    row(
        Fault::EncoderLost,
        "encoder-lost",
        "编码器无信号",
        "the encoder gives no counts",
        "S 显示 0; 螺纹报警 094, 每转进给报警 011",
        "S reads 0; a thread stops with alarm 094, feed per revolution with 011",
    ),
    row(
        Fault::EncoderNoise,
        "encoder-noise",
        "编码器干扰",
        "encoder counts jitter",
        "显示的转速和每转进给波动",
        "the speed that is shown and the feed per revolution waver",
    ),
    row(
        Fault::SpindleIndexLost,
        "no-spindle-index",
        "主轴无一转信号",
        "no one-turn signal of the spindle",
        "螺纹切削一直等待一转信号",
        "threads wait for their start without end",
    ),
    row(
        Fault::IndexX,
        "no-index-x",
        "X轴无零脉冲",
        "no one-turn signal of X",
        "X轴回零以低速越过零点, 直到限位: 报警 207; 诊断 008 的 PCX 不变",
        "zero return of X passes the zero at low speed into the limit: alarm 207; PCX of DGN.008 stays as it is",
    ),
    row(
        Fault::IndexZ,
        "no-index-z",
        "Z轴无零脉冲",
        "no one-turn signal of Z",
        "Z轴回零以低速越过零点, 直到限位: 报警 207; 诊断 008 的 PCZ 不变",
        "zero return of Z passes the zero at low speed into the limit: alarm 207; PCZ of DGN.008 stays as it is",
    ),
    row(
        Fault::DogX,
        "dog-stuck-x",
        "X轴减速开关粘连",
        "X deceleration switch stuck",
        "*DECX 一直有效: X轴回零报警 090",
        "*DECX stays valid: zero return of X is alarm 090",
    ),
    row(
        Fault::DogZ,
        "dog-stuck-z",
        "Z轴减速开关粘连",
        "Z deceleration switch stuck",
        "*DECZ 一直有效: Z轴回零报警 090",
        "*DECZ stays valid: zero return of Z is alarm 090",
    ),
    row(
        Fault::LimitX,
        "limit-x",
        "X轴限位开关压合",
        "X limit switch tripped",
        "急停回路断开: 报警 207; 按住超程解除可短接",
        "the emergency-stop loop opens: alarm 207; the release button bridges it",
    ),
    row(
        Fault::LimitZ,
        "limit-z",
        "Z轴限位开关压合",
        "Z limit switch tripped",
        "急停回路断开: 报警 207; 按住超程解除可短接",
        "the emergency-stop loop opens: alarm 207; the release button bridges it",
    ),
    row(
        Fault::DriveX,
        "drive-x",
        "X轴驱动器报警",
        "alarm of the X drive",
        "报警 221, 两个驱动器一起为 252; 全部停止",
        "alarm 221, with both drives 252; everything stops",
    ),
    row(
        Fault::DriveZ,
        "drive-z",
        "Z轴驱动器报警",
        "alarm of the Z drive",
        "报警 222, 两个驱动器一起为 252; 全部停止",
        "alarm 222, with both drives 252; everything stops",
    ),
    row(
        Fault::SlideX,
        "slide-x-jammed",
        "X轴滑板卡住",
        "the X slide is jammed",
        "伺服: 报警 221; 步进: 失步而无报警",
        "a servo trips with alarm 221; a stepper loses steps unseen",
    ),
    row(
        Fault::SlideZ,
        "slide-z-jammed",
        "Z轴滑板卡住",
        "the Z slide is jammed",
        "伺服: 报警 222; 步进: 失步而无报警",
        "a servo trips with alarm 222; a stepper loses steps unseen",
    ),
    row(
        Fault::PressureLow,
        "pressure-low",
        "液压或气压低",
        "hydraulic or air pressure is low",
        "过 069 时间后信息 1014 (168.4 PB3 = 1): 暂停, 主轴和冷却关闭",
        "message 1014 after 069 (168.4 PB3 = 1): hold, spindle and coolant off",
    ),
    row(
        Fault::DoorOpen,
        "door-open",
        "防护门打开",
        "the guard door is open",
        "自动方式信息 1015 (168.6 PB4 = 1): 暂停, 主轴和冷却关闭",
        "message 1015 in automatic (168.6 PB4 = 1): hold, spindle and coolant off",
    ),
    row(
        Fault::InputBounce,
        "input-bounce",
        "输入触点抖动",
        "contacts chatter",
        "触点变化后抖动 30 ms: 020 太小时一次变化读成几次",
        "a contact that changes chatters for 30 ms: one change is read as several unless 020 is long enough",
    ),
    row(
        Fault::EmergencyStop,
        "e-stop",
        "急停回路断开",
        "emergency-stop loop open",
        "报警 207, 脉冲和输出关闭; 回路接通后消失",
        "alarm 207, pulses and outputs off; it goes when the loop closes",
    ),
];

/// Names and faults, for the list of a script.
const fn names() -> [(&'static str, Fault); FAULTS.len()] {
    let mut names = [("", Fault::EmergencyStop); FAULTS.len()];
    let mut at = 0;
    while at < names.len() {
        names[at] = (FAULTS[at].name, FAULTS[at].fault);
        at += 1;
    }
    names
}

impl Fault {
    /// Every fault with the name scripts use.
    pub const ALL: [(&'static str, Self); FAULTS.len()] = names();

    /// Its row of the table.
    pub fn row(self) -> &'static FaultRow {
        // The table stands in the order of the enumeration (tested below).
        &FAULTS[self as usize]
    }

    /// The fault of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        FAULTS
            .iter()
            .find(|row| row.name == name)
            .map(|row| row.fault)
    }
}

/// The faults that stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Faults(u32);

impl Faults {
    /// Whether a fault stands.
    pub const fn has(self, fault: Fault) -> bool {
        self.0 >> (fault as u32) & 1 == 1
    }

    /// How many stand.
    pub const fn count(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Breaks or mends something.
    pub const fn set(&mut self, fault: Fault, on: bool) {
        let mask = 1 << (fault as u32);
        self.0 = if on { self.0 | mask } else { self.0 & !mask };
    }
}

/// Contacts that chatter, and counts that jitter: always the same way, so that
/// a run can be repeated.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Disturbance {
    /// Level of X0 and X1 before the last change of each contact, as bits.
    last: u16,
    /// How long each contact goes on chattering, ms.
    chatter: [u8; 16],
    seed: u32,
}

/// How long a contact chatters, ms, and how long each of its levels lasts.
const CHATTER_MS: u8 = 30;
const CHATTER_LEVEL_MS: u8 = 5;
/// Most counts that the encoder is off.
const NOISE_COUNTS: i64 = 40;

impl Disturbance {
    /// A contact that has changed reads wrong half of the time for a while.
    pub fn bounce(&mut self, contacts: &mut [u8], on: bool) {
        let [low, high, ..] = contacts else { return };
        let now = u16::from_le_bytes([*low, *high]);
        let changed = now ^ self.last;
        self.last = now;
        if !on {
            self.chatter = [0; 16];
            return;
        }
        let mut seen = now;
        for (bit, left) in self.chatter.iter_mut().enumerate() {
            if changed >> bit & 1 == 1 {
                *left = CHATTER_MS;
            }
            if *left / CHATTER_LEVEL_MS % 2 == 1 {
                seen ^= 1 << bit;
            }
            *left = left.saturating_sub(1);
        }
        [*low, *high] = seen.to_le_bytes();
    }

    /// How many counts the encoder is off in this tick.
    pub const fn noise(&mut self, on: bool) -> i64 {
        if !on {
            return 0;
        }
        // Numerical Recipes' linear congruence.
        self.seed = self
            .seed
            .wrapping_mul(1_664_525)
            .wrapping_add(1_013_904_223);
        (self.seed >> 16) as i64 % (2 * NOISE_COUNTS + 1) - NOISE_COUNTS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_stands_in_the_order_of_the_faults() {
        for (at, row) in FAULTS.iter().enumerate() {
            assert_eq!(row.fault as usize, at, "{}", row.name);
            assert_eq!(Fault::from_name(row.name), Some(row.fault));
            assert_eq!(row.fault.row().name, row.name);
            let texts = [row.zh, row.en, row.effect_zh, row.effect_en];
            assert!(texts.iter().all(|text| !text.is_empty()), "{}", row.name);
        }
    }

    #[test]
    fn a_changed_contact_chatters_and_comes_to_rest() {
        let mut disturbance = Disturbance::default();
        let mut levels = Vec::new();
        for _ in 0..40 {
            let mut contacts = [0b1000, 0];
            disturbance.bounce(&mut contacts, true);
            levels.push(contacts[0]);
        }
        let changes = levels.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!(changes >= 4, "{levels:?}");
        assert_eq!(levels[35..], [0b1000; 5]);
    }
}
