//! What the compiler and the control say, in the language of the window.

use gsk_core::memory::Refusal;
use gsk_core::plc::{CompileError, Fault, Rule};

use crate::cli::Language;
use crate::window::chinese;
use crate::window::texts::say;

/// An error or warning of the compiler: its code, in Chinese what the rule is, and
/// what is wrong here.
pub fn finding(error: &CompileError, language: Language) -> String {
    let (code, message) = (error.code, chinese::say(&error.message, language));
    match language {
        Language::Zh => format!("{code} {}: {message}", rule(code)),
        Language::En => format!("{code} {message}"),
    }
}

/// The closing line of a compilation without errors, in Chinese in the words of the
/// manufacturer's tool.
pub fn compiled(warnings: usize, language: Language) -> String {
    match language {
        Language::Zh => gsk_core::plc::summary(0, warnings),
        Language::En => format!("compiled: errors 0, warnings {warnings}"),
    }
}

const fn rule(rule: Rule) -> &'static str {
    match rule {
        Rule::E00 => "不是指令",
        Rule::E01 => "END1、END2 缺少、重复或次序错",
        Rule::E02 => "梯级没有唯一的结果, 或输出之后还有触点",
        Rule::E03 => "操作数不合法",
        Rule::E04 => "标号、子程序、定时器号或信息重复, 或没有定义",
        Rule::E05 => "跳转或调用超出所在部分",
        Rule::E06 => "操作数个数、长度代码或表的大小错",
        Rule::E07 => "程序或第一级过长",
        Rule::W01 => "线圈由两个 OUT 写入",
        Rule::W02 => "标号没有使用",
        Rule::W03 => "梯级没有作用",
        Rule::W04 => "第一级超过 400 步",
    }
}

/// Why the control would not take a ladder, and what to do.
pub const fn refusal(refusal: Refusal, language: Language) -> &'static str {
    match refusal {
        Refusal::Mode => say(language, "保存须在编辑方式", "saving wants edit mode"),
        Refusal::Running => say(
            language,
            "保存须在停止状态",
            "saving wants the machine at rest",
        ),
        Refusal::ParameterSwitch => say(
            language,
            "保存须打开参数开关",
            "saving wants the parameter switch on",
        ),
        Refusal::Level => say(
            language,
            "操作级别不够, 须 3 级",
            "the operation level is too low: 3 is wanted",
        ),
        Refusal::Alarm | Refusal::ProgramSwitch | Refusal::Locked => say(
            language,
            "存储器保护 KEY1 (G46.3) 有效",
            "memory protection KEY1 (G46.3) stands",
        ),
    }
}

/// Why the ladder stands still.
pub fn fault(fault: Fault, language: Language) -> String {
    match (language, fault) {
        (Language::Zh, Fault::Watchdog { line }) => {
            format!("PLC 监视: 梯形图在第 {line} 行循环不止")
        }
        (Language::En, fault) => fault.to_string(),
    }
}
