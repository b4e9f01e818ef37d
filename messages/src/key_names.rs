//! The English names of the panel keys that are labelled in Chinese.

use std::borrow::Cow;

/// The Chinese legend of a key, as texts write it in brackets, and the name that English texts
/// put before it: the English line of the key, else the common name of its function.
const KEY_NAMES: [(&str, &str); 55] = [
    ("复位", "RESET"),
    ("输入", "IN"),
    ("输出", "OUT"),
    ("转换", "CHG"),
    ("取消", "CAN"),
    ("插入/修改", "INS/ALT"),
    ("删除", "DEL"),
    ("位置", "POS"),
    ("程序", "PRG"),
    ("刀补", "OFT"),
    ("报警", "ALM"),
    ("设置", "SET"),
    ("参数", "PAR"),
    ("诊断", "DGN"),
    ("上页", "Page up"),
    ("下页", "Page down"),
    ("编辑", "Edit"),
    ("自动", "Auto"),
    ("录入", "MDI"),
    ("机械零点", "Machine zero"),
    ("单步/手轮", "Step/handwheel"),
    ("单步", "Step"),
    ("手轮", "Handwheel"),
    ("手动", "Jog"),
    ("程序零点", "Program zero"),
    ("单段", "Single block"),
    ("跳段", "Block skip"),
    ("机床锁", "Machine lock"),
    ("辅助锁", "Auxiliary lock"),
    ("空运行", "Dry run"),
    ("X 手轮", "Handwheel"),
    ("Y 手轮", "Handwheel"),
    ("Z 手轮", "Handwheel"),
    ("快速", "Rapid"),
    ("主轴正转", "Spindle forward"),
    ("主轴停止", "Spindle stop"),
    ("主轴反转", "Spindle reverse"),
    ("冷却", "Coolant"),
    ("润滑/点动", "Lubrication/jog"),
    ("换刀", "Tool change"),
    ("主轴倍率↑", "Spindle override up"),
    ("主轴倍率↓", "Spindle override down"),
    ("快速倍率↑", "Rapid override up"),
    ("快速倍率↓", "Rapid override down"),
    ("进给倍率↑", "Feed override up"),
    ("进给倍率↓", "Feed override down"),
    ("暂停", "Feed hold"),
    ("运行", "Cycle start"),
    ("急停", "Emergency stop"),
    ("超程解除", "Overtravel release"),
    ("卡盘", "Chuck"),
    ("尾座", "Tailstock"),
    ("示教", "Teach"),
    ("命令", "CMD"),
    ("加工", "OPERT"),
];

/// Puts the English name before the legend of each key that an English text names in brackets:
/// `Press [手动]` becomes `Press [Jog 手动]`. The panel shows the legend, and the name tells a
/// reader without Chinese what the key does.
pub fn add_key_names(text: &str) -> Cow<'_, str> {
    let mut named = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('[') {
        named.push_str(before);
        named.push('[');
        rest = after;
        let legend = after.split_once(']').map(|(legend, _)| legend);
        if let Some(name) = legend.and_then(find_name) {
            named.push_str(name);
            named.push(' ');
        }
    }
    if named.len() + rest.len() == text.len() {
        return Cow::Borrowed(text);
    }
    named.push_str(rest);
    Cow::Owned(named)
}

fn find_name(legend: &str) -> Option<&'static str> {
    let mut names = KEY_NAMES.iter();
    names.find_map(|(known, name)| (*known == legend).then_some(*name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_legend_in_brackets_gets_its_english_name_once() {
        let text = "Press [手动], then hold [← Z] or [X 手轮]; [0.1] stays. An open [复位";
        let named =
            "Press [Jog 手动], then hold [← Z] or [Handwheel X 手轮]; [0.1] stays. An open [复位";
        assert_eq!(add_key_names(text), named);
        assert_eq!(add_key_names(named), named);
        assert!(matches!(add_key_names("no key"), Cow::Borrowed(_)));
    }
}
