//! The states of the link in words, and what to do in each.

use gsk_core::machine::link::{Input, LinkState, Output};

use crate::cli::Language;
use crate::window::texts::say;

/// Name of a state.
pub const fn state(state: LinkState, language: Language) -> &'static str {
    let chinese = match state {
        LinkState::Off => "未连接",
        LinkState::Opening => "打开端口",
        LinkState::Identify => "识别",
        LinkState::Configure => "核对参数",
        LinkState::Locked => "位置未知",
        LinkState::Ready => "就绪",
        LinkState::Moving => "运动中",
        LinkState::Homing => "返回机械零点",
        LinkState::Verify => "校验位置",
        LinkState::Tripped => "已停止",
        LinkState::Fault => "故障",
        LinkState::Lost => "通信中断",
    };
    say(language, chinese, state.name())
}

/// What the operator can do now; empty when nothing is needed.
pub const fn advice(state: LinkState, language: Language) -> &'static str {
    let (chinese, english) = match state {
        LinkState::Configure => (
            "参数不符时, 核对后写入驱动板。",
            "If settings differ, look at them and write them into the board.",
        ),
        LinkState::Locked => (
            "没有人知道滑板的位置: 按 [机械零点], 两轴返回机械零点。可以慢速手动移动。",
            "Nobody knows where the slides stand: make the machine zero return of both axes. \
             They may be moved by hand, slowly.",
        ),
        LinkState::Tripped => (
            "限位、急停或电脑无响应停止了驱动板: 排除原因, 按 [复位], 离开限位。",
            "A limit, the emergency stop or a silent PC stopped the board: take away the cause, \
             press RESET, move off a limit.",
        ),
        LinkState::Fault => (
            "报警页面有说明: 排除原因, 按 [复位], 再返回机械零点。",
            "The alarm page says why: take away the cause, press RESET, make the machine zero \
             return.",
        ),
        LinkState::Lost | LinkState::Off => (
            "检查电缆和电源, 重新连接, 再返回机械零点。",
            "Look at cable and power, reconnect, make the machine zero return.",
        ),
        LinkState::Opening
        | LinkState::Identify
        | LinkState::Ready
        | LinkState::Moving
        | LinkState::Homing
        | LinkState::Verify => ("", ""),
    };
    say(language, chinese, english)
}

/// Inputs of the board that stand in one row, and their name in Chinese and English.
pub const INPUTS: [(&[Input], &str, &str); 5] = [
    (&[Input::LimitX, Input::LimitZ], "限位 X / Z", "limit X / Z"),
    (
        &[Input::DecelerationX, Input::DecelerationZ],
        "减速开关 *DECX / *DECZ",
        "deceleration *DECX / *DECZ",
    ),
    (
        &[Input::ZeroX, Input::ZeroZ],
        "零点信号 XPC / ZPC",
        "zero signal XPC / ZPC",
    ),
    (&[Input::EmergencyStop], "急停", "emergency stop"),
    (&[Input::DriveAlarm], "驱动器报警", "alarm of the drives"),
];

/// What an output switches.
pub const fn output(output: Output) -> &'static str {
    match output {
        Output::Enable => "nEN",
        Output::SpindleForward => "M03",
        Output::SpindleReverse => "M04",
        Output::SpindleSpeed => "SVC",
        Output::Coolant => "M08",
    }
}

/// What a setting of a line board means.
pub const fn setting(number: u16, language: Language) -> &'static str {
    let (chinese, english) = match number {
        0 => ("脉冲宽度 µs", "length of a pulse, µs"),
        1 => ("驱动器保持使能", "drives stay on"),
        2 => ("脉冲电平", "level of the pulses"),
        3 => ("轴方向", "directions of the axes"),
        4 => ("使能电平", "level of the enable output"),
        5 => ("限位电平", "level of the limit inputs"),
        10 => ("报告内容", "what a report tells"),
        11 => ("转角偏差", "how corners are joined"),
        13 => ("单位 mm", "reports in mm"),
        20 => ("软限位", "soft limits of its own"),
        21 => ("硬限位", "limit inputs act"),
        22 => ("返回零点", "reference return, starts locked"),
        23..=27 => (
            "返回零点的方向、速度",
            "reference return: directions, speeds",
        ),
        30 | 31 => ("主轴输出范围", "range of the spindle output"),
        32 => ("车床或激光方式", "modes of its own"),
        100 => ("X 脉冲/mm", "X, pulses per mm"),
        102 => ("Z 脉冲/mm", "Z, pulses per mm"),
        110 => ("X 最高速度 mm/min", "X, highest rate, mm/min"),
        112 => ("Z 最高速度 mm/min", "Z, highest rate, mm/min"),
        120 => ("X 加速度 mm/s²", "X, acceleration, mm/s²"),
        122 => ("Z 加速度 mm/s²", "Z, acceleration, mm/s²"),
        1000 => ("驱动板自行运动", "motion the board makes by itself"),
        1001 => ("运动学", "how the axes hang together"),
        _ => ("", ""),
    };
    say(language, chinese, english)
}
