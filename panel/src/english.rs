//! The English words of the LCD (184.0 CH_EN = 1). Each takes at most the cells of the
//! Chinese it stands for and is filled up with blanks, so that every page keeps its
//! layout; the titles stand alone in their row and may be longer.

use std::borrow::Cow;

use crate::glyphs;

/// Texts that stand alone.
const TITLES: [(&str, &str); 6] = [
    ("程序", "PROGRAM"),
    ("偏置", "OFFSET"),
    ("设置", "SETTING"),
    ("图形", "GRAPHIC"),
    ("诊断", "DIAGNOSIS"),
    ("电子盘设置", "ELECTRONIC DISK"),
];

/// Words and phrases anywhere in a text; the longest that fits a place counts.
const PHRASES: [(&str, &str); 119] = [
    ("现在位置", "POSITION"),
    ("相对坐标", "RELATIVE"),
    ("相对位置", "RELATIVE"),
    ("绝对坐标", "ABSOLUTE"),
    ("机床坐标", "MACHINE"),
    ("余移动量", "TO GO"),
    ("编程速率:", "PRG.FEED:"),
    ("实际速率:", "ACT.FEED:"),
    ("手动速率:", "JOG FEED:"),
    ("单步增量:", "STEP    :"),
    ("手轮增量:", "MPG STEP:"),
    ("进给倍率:", "FEED OVR:"),
    ("快速倍率:", "RAP. OVR:"),
    ("主轴倍率:", "SPD. OVR:"),
    ("G功能码:", "G CODES:"),
    ("加工件数:", "PARTS   :"),
    ("切削时间:", "CUT TIME:"),
    ("编辑方式", "EDIT"),
    ("自动方式", "AUTO"),
    ("录入方式", "MDI"),
    ("单步方式", "STEP"),
    ("手轮方式", "HANDLE"),
    ("手动方式", "JOG"),
    ("机械回零", "MACH.REF"),
    ("程序回零", "PROG.REF"),
    ("准备未绪", "NOTREADY"),
    ("报警", "ALM"),
    ("暂停", "HOLD"),
    ("输入", "RECV"),
    ("输出", "SEND"),
    ("串口未连接", "NO PORT"),
    ("通信出错", "COMM ERR"),
    ("程序段值", "BLOCK"),
    ("模态值", "MODAL"),
    ("系统版本号", "VERSION"),
    ("已存程序数", "PROGRAMS"),
    ("已用存储量", "CHARACTERS"),
    ("剩余", "FREE"),
    ("程序目录表", "DIRECTORY"),
    ("宏变量", "MACRO"),
    ("外部信息", "MESSAGES"),
    ("报警信息", "ALARMS"),
    ("密码设置", "PASSWORD"),
    ("状态参数", "PAR.BITS"),
    ("数据参数", "PAR.DATA"),
    ("螺距补偿参数", "PITCH ERRORS"),
    ("PLC信号状态", "PLC SIGNALS"),
    ("PLC数值诊断", "PLC VALUES"),
    ("机床面板", "PANEL"),
    ("系统版本信息", "VERSION"),
    ("序号", "NO. "),
    ("数 据", "DATA"),
    ("数据", "DATA"),
    ("地址", "ADR"),
    ("检索", "FIND"),
    ("当前值", "NOW"),
    ("预定值", "PRESET"),
    ("坐标选择", "PLANE"),
    ("缩放比例", "SCALE"),
    ("图形中心", "CENTRE"),
    ("图形参数", "GRAPHIC"),
    ("X轴工件座标值", "X OF THE WORK"),
    ("Z轴工件座标值", "Z OF THE WORK"),
    ("X最大值", "X MAX"),
    ("Z最大值", "Z MAX"),
    ("X最小值", "X MIN"),
    ("Z最小值", "Z MIN"),
    ("作图", "DRAW"),
    ("停止", "STOP"),
    ("清除", "CLR"),
    ("驱动单元和编码器的信号", "DRIVES AND ENCODER"),
    ("X轴驱动器无报警", "X DRIVE IS WELL"),
    ("Z轴驱动器无报警", "Z DRIVE IS WELL"),
    ("主轴编码器一转信号", "SPINDLE ONE TURN"),
    ("X轴零点信号", "X ZERO"),
    ("Z轴零点信号", "Z ZERO"),
    ("主轴编码器计数", "ENCODER COUNT"),
    ("低8位", "LOW"),
    ("高8位", "HIGH"),
    ("机床侧的输入信号", "MACHINE INPUTS"),
    ("输出到机床侧的信号", "MACHINE OUTPUTS"),
    ("I/O板", "I/O"),
    ("操作级别已改变", "LEVEL CHANGED"),
    ("操作级别", "LEVEL"),
    ("密码错误", "WRONG"),
    ("两次输入的密码不一致", "THE TWO DIFFER"),
    ("已取消密码用户更改数据的权限", "THE RIGHTS ARE GIVEN UP"),
    ("密码已更改", "CHANGED"),
    ("输入密码", "PASSWORD"),
    ("更改密码", "NEW ONE"),
    ("确认密码", "CONFIRM"),
    ("提示:", "HINT:"),
    ("机床锁住", "MCH.LOCK"),
    ("辅助锁住", "AUX.LOCK"),
    ("单程序段", "SINGLE"),
    ("空运行", "DRYRUN"),
    ("程序选跳", "SKIP"),
    ("键", "K"),
    ("关    开", "OFF   ON"),
    ("关  开", "OFF ON"),
    ("产品型号", "MODEL"),
    ("软件版本号", "SOFTWARE"),
    ("硬件版本号", "HARDWARE"),
    ("梯形图设计单位", "LADDER FROM"),
    ("梯形图版本号", "LADDER NO."),
    ("梯形图设计者", "LADDER BY"),
    ("备注", "NOTE"),
    ("奇偶校检", "TV CHECK"),
    ("代码", "CODE"),
    ("英制编程", "INCHES"),
    ("公制", "MM"),
    ("英制", "INCH"),
    ("自动序号", "AUTO NO."),
    ("参数开关", "PAR.SW."),
    ("程序开关", "PROG.SW."),
    ("读 电子盘", "FROM DISK"),
    ("数据参数写入", "INTO"),
    ("保存RAM中数据参数到电子盘", "SAVE RAM ON DISK"),
    ("操作已经成功完成", "DONE"),
];

/// Further phrases: results, the picture of the power-on, names of parameters.
const MORE: [(&str, &str); 14] = [
    ("操作出错,请再试一次", "FAILED, TRY AGAIN"),
    ("车床数控系统", "LATHE CNC"),
    ("广州数控设备有限公司", "GSK CNC EQUIPMENT"),
    ("系统自检", "SELFTEST"),
    ("初始化", "START"),
    ("模拟主轴", "ANALOG"),
    ("模拟", "ANLG"),
    ("半径编程", "RADIUS"),
    ("半径", "RAD."),
    ("手轮", "MPG"),
    ("刀补方式", "OFSMODE"),
    ("刀补", "OFS."),
    ("螺补", "PEC"),
    ("主轴摸拟调正数据", "SPINDLE GAIN"),
];

/// A text of the LCD in English; what has no English stays.
pub fn english(text: &str) -> Cow<'_, str> {
    if text.is_ascii() {
        return Cow::Borrowed(text);
    }
    if let Some((_, title)) = TITLES.iter().find(|(chinese, _)| *chinese == text) {
        return Cow::Borrowed(title);
    }
    let mut all = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let here = PHRASES.iter().chain(&MORE);
        let fitting = here.filter(|(chinese, _)| rest.starts_with(chinese));
        let Some((chinese, word)) = fitting.max_by_key(|(chinese, _)| chinese.len()) else {
            all.push(first);
            rest = &rest[first.len_utf8()..];
            continue;
        };
        all.push_str(word);
        let blanks = glyphs::text_columns(chinese).saturating_sub(word.len());
        all.extend(core::iter::repeat_n(' ', blanks));
        rest = &rest[chinese.len()..];
    }
    Cow::Owned(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pages::{self, PAGES, PageId, View};
    use gsk_core::cnc::Cnc;
    use gsk_core::setup::Setup;

    #[test]
    fn words_keep_their_place() {
        assert_eq!(
            english("序号    数据        序号    数据"),
            "NO.     DATA        NO.     DATA"
        );
        assert_eq!(english("现在位置(相对坐标)"), "POSITION(RELATIVE)");
        assert_eq!(english("程序"), "PROGRAM");
        assert_eq!(english("G00 X1"), "G00 X1");
        for (chinese, word) in PHRASES.iter().chain(&MORE) {
            let room = glyphs::text_columns(chinese);
            assert!(word.is_ascii() && word.len() <= room, "{chinese} {word}");
        }
    }

    #[test]
    fn no_page_shows_chinese_in_english() {
        let mut setup = Setup::default();
        setup.parameters.set_bit(184, 0, true).unwrap();
        let cnc = Cnc::new(setup);
        for row in PAGES {
            let screen = pages::draw(row.page, &View::default(), &cnc);
            for line in screen.text().lines() {
                // The ladder's own header is what its author wrote.
                let own = row.page == PageId::Version
                    && ["LADDER", "NOTE"].iter().any(|label| line.contains(label));
                assert!(line.is_ascii() || own, "{}: {line}", row.name);
            }
        }
        assert!(pages::power_on(true).text().is_ascii());
    }
}
